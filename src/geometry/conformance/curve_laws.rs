//! The laws of curves, run on the zoo and on random curves.

use super::samples;
use crate::geometry::{BSplineCurve, Knots};
use nalgebra::{Point3, Vector3};
use proptest::prelude::*;

/// Parameters between and on the knots.
fn parameters(c: &BSplineCurve) -> Vec<f64> {
    let mut u = c.knot_vector().breakpoints();
    let [a, b] = c.domain();
    u.extend((0..=37).map(|i| a + (b - a) * i as f64 / 37.0));
    u.sort_by(f64::total_cmp);
    u
}

/// The scale of rounding: the largest coordinate, or the size if larger.
fn size(c: &BSplineCurve) -> f64 {
    c.control_points()
        .iter()
        .map(|p| p.coords.amax())
        .fold(c.bounding_box().diagonal(), f64::max)
}

/// Largest distance of points of equal parameter, relative to the size.
fn apart(a: &BSplineCurve, b: &BSplineCurve, map: impl Fn(f64) -> f64) -> f64 {
    let worst = parameters(a)
        .into_iter()
        .map(|u| (a.point(u) - b.point(map(u))).norm());
    worst.fold(0.0, f64::max) / size(a)
}

/// All laws at once.
pub(crate) fn check(name: &str, c: &BSplineCurve) {
    ends(name, c);
    derivatives(name, c);
    boxed(name, c);
    reversal(name, c);
    refinement(name, c);
    elevation(name, c);
    splitting(name, c);
    moving(name, c);
}

fn ends(name: &str, c: &BSplineCurve) {
    let [a, b] = c.domain();
    assert_eq!(c.point(a), c.start(), "{name}");
    assert_eq!(c.point(b), c.end(), "{name}");
    assert_eq!(c.point(a - 1.0), c.start(), "{name}: before the domain");
    assert_eq!(c.point(b + 1.0), c.end(), "{name}: beyond the domain");
    assert_eq!(c.derivatives(b), c.derivatives_left(b), "{name}");
    assert_eq!(c.derivatives(a), c.derivatives_left(a), "{name}");
}

/// First and second derivatives against differences inside each span.
fn derivatives(name: &str, c: &BSplineCurve) {
    for piece in c.knot_vector().breakpoints().windows(2) {
        let width = piece[1] - piece[0];
        let h = 1e-4 * width;
        for share in [0.01, 0.3, 0.5, 0.77, 0.99] {
            let u = piece[0] + share * width;
            let (lo, at, hi) = (c.derivatives(u - h), c.derivatives(u), c.derivatives(u + h));
            let d1 = (hi.point - lo.point) / (2.0 * h);
            let d2 = (hi.d1 - lo.d1) / (2.0 * h);
            let d3 = (hi.d2 - lo.d2) / (2.0 * h);
            let noise = 1e-15 * size(c) / h;
            close(name, u, d1, at.d1, noise, size(c) / width);
            close(
                name,
                u,
                d2,
                at.d2,
                noise / width * 10.0,
                size(c) / width / width,
            );
            close(
                name,
                u,
                d3,
                c.derivative3(u),
                noise / width / width * 100.0,
                size(c) / width.powi(3),
            );
        }
    }
}

/// Differences are good to h² times the third derivative, which the sizes
/// bound by a factor of the degree.
fn close(name: &str, u: f64, got: Vector3<f64>, want: Vector3<f64>, noise: f64, scale: f64) {
    let error = (got - want).norm();
    let allowed = 1e-5 * (scale + want.norm()) + 10.0 * noise;
    assert!(
        error <= allowed,
        "{name} at {u}: {got} for {want}, off {error:e} of {allowed:e}"
    );
}

fn boxed(name: &str, c: &BSplineCurve) {
    let b = c.bounding_box();
    for u in parameters(c) {
        assert!(b.contains(&c.point(u), 1e-14 * size(c)), "{name} at {u}");
    }
}

fn reversal(name: &str, c: &BSplineCurve) {
    let r = c.reversed();
    let [a, b] = c.domain();
    assert_eq!(r.domain(), c.domain());
    // Mirrored knots are rounded, which clustered knots amplify.
    assert!(apart(c, &r, |u| a + (b - u)) < 1e-12, "{name}");
    assert!(apart(c, &r.reversed(), |u| u) < 1e-12, "{name}");
}

fn refinement(name: &str, c: &BSplineCurve) {
    let [a, b] = c.domain();
    let inside = |s: f64| a + (b - a) * s;
    let fine = c
        .insert_knots(&[inside(0.9), inside(0.37), inside(0.371)])
        .expect("inside");
    assert_eq!(fine.control_points().len(), c.control_points().len() + 3);
    assert!(
        apart(c, &fine, |u| u) < 1e-14,
        "{name}: {:e}",
        apart(c, &fine, |u| u)
    );
    let bezier: Vec<f64> = c
        .knot_vector()
        .distinct()
        .into_iter()
        .filter(|(t, _)| *t > a && *t < b)
        .flat_map(|(t, m)| vec![t; c.degree() - m])
        .collect();
    let pieces = c.insert_knots(&bezier).expect("inside");
    assert!(apart(c, &pieces, |u| u) < 1e-14, "{name}");
    assert!(c.insert_knots(&[a]).is_err() && c.insert_knots(&[f64::NAN]).is_err());
    assert!(c.insert_knots(&vec![inside(0.37); c.degree() + 1]).is_err());
    if c.weights().is_none() {
        let tail = c.degree() + 1;
        let n = c.control_points().len();
        let early = c.insert_knots(&[inside(1e-3)]).expect("inside");
        assert_eq!(
            early.control_points()[tail + 1..],
            c.control_points()[tail..n],
            "{name}"
        );
    }
}

fn elevation(name: &str, c: &BSplineCurve) {
    let e = c.elevated().expect("below the largest degree");
    assert_eq!(e.degree(), c.degree() + 1);
    let error = apart(c, &e, |u| u);
    assert!(error < 1e-13, "{name}: {error:e}");
}

fn splitting(name: &str, c: &BSplineCurve) {
    let [a, b] = c.domain();
    let mut at: Vec<f64> = vec![a + 0.2 * (b - a), a + 0.77 * (b - a)];
    let breakpoints = c.knot_vector().breakpoints();
    at.extend(&breakpoints[1..breakpoints.len() - 1]);
    for u in at {
        let (left, right) = c.split(u).expect("inside");
        assert_eq!((left.domain(), right.domain()), ([a, u], [u, b]), "{name}");
        assert_eq!(left.end(), right.start(), "{name}");
        assert!(
            apart(&left, c, |u| u) < 1e-13 && apart(&right, c, |u| u) < 1e-13,
            "{name}"
        );
        let whole = crate::geometry::join_c0(&[left, right]).expect("they meet");
        assert!(apart(&whole, c, |u| u) < 1e-13, "{name}");
    }
    assert!(c.split(a).is_err() && c.split(b).is_err() && c.split(f64::NAN).is_err());
    let part = c.restricted(a + 0.3 * (b - a), b).expect("inside");
    assert!(apart(&part, c, |u| u) < 1e-13, "{name}");
}

fn moving(name: &str, c: &BSplineCurve) {
    let by = Vector3::new(1.0, -2.0, 0.5);
    let moved = c.translated(&by).scaled(2.0);
    for u in parameters(c) {
        let want = (c.point(u) + by) * 2.0;
        assert!(
            (moved.point(u) - want).norm() < 1e-14 * (size(c) + 4.0) * 2.0,
            "{name}"
        );
    }
    let [a, b] = [3.0, 4.5];
    let other = c.on_domain([a, b]).expect("not empty");
    let [p, q] = c.domain();
    assert!(
        apart(c, &other, |u| a + (u - p) / (q - p) * (b - a)) < 1e-12,
        "{name}"
    );
}

#[test]
fn the_zoo_keeps_the_laws() {
    for (name, c) in samples::curves() {
        check(&name, &c);
    }
}

#[test]
fn equal_control_points_stand_exactly_still() {
    let c = samples::standing();
    let at = c.point(0.3);
    for i in 0..=100 {
        let jet = c.derivatives(0.3 + 0.2 * i as f64 / 100.0 * 0.999);
        assert_eq!(
            (jet.point, jet.d1, jet.d2),
            (at, Vector3::zeros(), Vector3::zeros())
        );
    }
    // The same with weights that differ: the apex of a rational cone.
    let apex = Point3::new(0.1, 0.7, 1.0 / 3.0);
    let knots = Knots::clamped(3, [0., 1.], &[]).expect("valid");
    let weights = Some(vec![1.0, 0.3, 1.7, 0.9]);
    let c = BSplineCurve::from_knots(knots, vec![apex; 4], weights).expect("valid");
    for i in 0..=100 {
        let jet = c.derivatives(i as f64 / 100.0);
        assert_eq!(
            (jet.point, jet.d1, jet.d2),
            (apex, Vector3::zeros(), Vector3::zeros())
        );
    }
    let standing = samples::standing().elevated().expect("degree 4");
    assert_eq!(standing.derivatives(0.4).d1, Vector3::zeros());
}

#[test]
fn circles_are_round() {
    for c in [
        samples::quarter_circle(2.0),
        samples::half_circle().scaled(2.0),
    ] {
        for u in parameters(&c) {
            let jet = c.derivatives(u);
            assert!((jet.point.coords.xy().norm() - 2.0).abs() < 1e-15 * 4.0);
            let curvature = jet.d1.cross(&jet.d2).norm() / jet.d1.norm().powi(3);
            assert!((curvature - 0.5).abs() < 1e-14);
        }
    }
}

/// Random curves of any degree, with clustered and repeated knots.
pub(crate) fn any_curve() -> impl Strategy<Value = BSplineCurve> {
    let knot = prop_oneof![(1u32..8).prop_map(|k| f64::from(k) / 8.0), 0.001..0.999f64];
    (1usize..=6, prop::collection::vec(knot, 0..8), any::<bool>()).prop_flat_map(
        |(degree, mut inner, rational)| {
            inner.sort_by(f64::total_cmp);
            let kept = inner.chunk_by(|a, b| a == b);
            let inner: Vec<f64> = kept
                .flat_map(|run| run.iter().take(degree).copied())
                .collect();
            let knots = Knots::clamped(degree, [0.0, 1.0], &inner).expect("valid");
            let n = knots.control_count();
            let points = prop::collection::vec(prop::array::uniform3(-10.0..10.0f64), n);
            let weights = prop::collection::vec(0.25..4.0f64, n);
            (points, weights).prop_map(move |(points, weights)| {
                let points = points.into_iter().map(Point3::from).collect();
                let weights = rational.then_some(weights);
                BSplineCurve::from_knots(knots.clone(), points, weights).expect("valid")
            })
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 100, failure_persistence: None, rng_seed: proptest::test_runner::RngSeed::Fixed(1887), ..Default::default() })]
    #[test]
    fn random_curves_keep_the_laws(c in any_curve()) {
        ends("random", &c);
        boxed("random", &c);
        reversal("random", &c);
        refinement("random", &c);
        splitting("random", &c);
        moving("random", &c);
        let e = c.elevated().expect("below the largest degree");
        prop_assert!(apart(&c, &e, |u| u) < 1e-10);
    }
}
