use super::*;
use crate::geometry::conformance::{curve_laws, samples};
use nalgebra::{Vector3, point};
use proptest::prelude::*;

/// The law: certain, on the curve, and nothing sampled is nearer.
fn check(name: &str, curve: &BSplineCurve, query: &Point3<f64>) {
    let index = CurveIndex::new(curve);
    let c = index.closest(query);
    let [a, b] = curve.domain();
    let size = query
        .coords
        .amax()
        .max(curve.bounding_box().max.coords.amax())
        .max(1.0);
    assert!(
        (curve.point(c.parameter) - c.point).norm() <= 1e-12 * size,
        "{name}"
    );
    assert!(
        ((c.point - query).norm() - c.distance).abs() <= 1e-14 * size,
        "{name}"
    );
    let nearest = (0..=2000)
        .map(|i| (curve.point(a + (b - a) * f64::from(i) / 2000.0) - query).norm())
        .fold(f64::INFINITY, f64::min);
    assert!(
        c.distance <= nearest + 1e-12 * size,
        "{name} {query}: {c:?} but {nearest}"
    );
    assert!(
        c.lower_bound <= nearest + 1e-12 * size,
        "{name} {query}: {c:?} but {nearest}"
    );
    for hint in [a, 0.5 * (a + b), c.parameter] {
        let hinted = index.closest_near(query, hint);
        assert!(
            (hinted.distance - c.distance).abs() <= 1e-12 * size,
            "{name} hinted at {hint}"
        );
        assert!(hinted.certain || !c.certain);
    }
    assert!(c.certain, "{name} {query}: {c:?}");
}

#[test]
fn certain_and_optimal_on_the_zoo() {
    for (name, curve) in samples::curves() {
        let box_ = curve.bounding_box();
        let (center, reach) = (box_.center(), box_.diagonal());
        for i in 0..40 {
            let t = f64::from(i);
            let offset = Vector3::new((1.7 * t).sin(), (2.9 * t).cos(), (0.9 * t + 1.0).sin());
            check(&name, &curve, &(center + offset * (reach * 0.05 * t)));
        }
    }
}

#[test]
fn points_of_the_curve_find_themselves() {
    for (name, curve) in samples::curves() {
        let index = CurveIndex::new(&curve);
        let [a, b] = curve.domain();
        for i in 0..=50 {
            let p = curve.point(a + (b - a) * f64::from(i) / 50.0);
            let c = index.closest(&p);
            let size = p.coords.amax().max(1.0);
            assert!(c.distance < 1e-14 * size && c.certain, "{name}: {c:?}");
        }
    }
}

#[test]
fn the_centre_of_a_circle_is_answered_with_an_honest_doubt() {
    let index = CurveIndex::new(&samples::quarter_circle(2.0));
    let c = index.closest(&point![0., 0., 1.]);
    assert!((c.distance - 2.0).abs() < 1e-14);
    assert!(!c.certain && c.lower_bound > 1.99 && c.lower_bound <= 2.0);
    let coarse = Tolerance::absolute(1e-3).expect("positive");
    let index = CurveIndex::with_resolution(&samples::quarter_circle(2.0), coarse);
    assert!(index.closest(&point![0., 0., 1.]).certain);
}

/// Two arms of a hairpin, one a hair nearer: the local method from the wrong
/// side would stay there.
#[test]
fn the_nearer_arm_of_a_hairpin_wins_by_a_hair() {
    let points = vec![
        point![0., 1., 0.],
        point![9., 1., 0.],
        point![9., -1., 0.],
        point![0., -1., 0.],
    ];
    let knots = vec![0., 0., 0., 0., 1., 1., 1., 1.];
    let curve = BSplineCurve::new(3, knots, points, None).expect("valid");
    let index = CurveIndex::new(&curve);
    for hair in [1e-2, 1e-6, 1e-9, 1e-11] {
        let up = index.closest_near(&point![2., hair, 0.], 0.9);
        let down = index.closest_near(&point![2., -hair, 0.], 0.1);
        assert!(up.certain && up.parameter < 0.5, "{hair:e}: {up:?}");
        assert!(down.certain && down.parameter > 0.5, "{hair:e}: {down:?}");
    }
}

#[test]
fn nonsense_in_is_doubt_out() {
    let c = CurveIndex::new(&samples::wild(3)).closest(&point![f64::NAN, 0., 0.]);
    assert!(!c.certain);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, rng_seed: proptest::test_runner::RngSeed::Fixed(1887), ..Default::default() })]
    #[test]
    fn random_curves(c in curve_laws::any_curve(), q in prop::array::uniform3(-15.0..15.0f64)) {
        check("random", &c, &Point3::from(q));
    }
}
