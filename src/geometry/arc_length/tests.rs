use super::*;
use crate::geometry::conformance::samples;
use crate::geometry::{Parametrization, interpolate};
use nalgebra::{Point3, point};

fn check_inverse(arc: &ArcLength, tolerance: f64) {
    let n = 500;
    let mut before = -1.0;
    for i in 0..=n {
        let s = arc.total() * i as f64 / n as f64;
        let u = arc.parameter_at(s);
        let back = arc.length_at(u);
        assert!(
            (back - s).abs() <= tolerance * arc.total(),
            "{s} → {u} → {back}"
        );
        assert!(u >= before, "the inverse must not fall");
        before = u;
    }
}

#[test]
fn a_quarter_circle_and_a_straight_line() {
    let arc = ArcLength::new(&samples::quarter_circle(2.0));
    assert!((arc.total() - std::f64::consts::PI).abs() < 1e-12);
    check_inverse(&arc, 1e-13);
    let line = ArcLength::new(&samples::line());
    assert!((line.total() - 5.0).abs() < 1e-14);
    assert!((line.parameter_at(1.25) - 0.25).abs() < 1e-15);
}

/// y = x² on [0, 1]: √5/2 + asinh(2)/4.
#[test]
fn a_parabola() {
    let points = vec![point![0., 0., 0.], point![0.5, 0., 0.], point![1., 1., 0.]];
    let c = BSplineCurve::new(2, vec![0., 0., 0., 1., 1., 1.], points, None).expect("valid");
    let arc = ArcLength::new(&c);
    let exact = |x: f64| 0.5 * x * (1.0 + 4.0 * x * x).sqrt() + 0.25 * (2.0 * x).asinh();
    for i in 0..=100 {
        let x = i as f64 / 100.0;
        assert!((arc.length_at(x) - exact(x)).abs() < 1e-13);
    }
    check_inverse(&arc, 1e-13);
}

#[test]
fn an_interpolated_helix_is_as_long_as_the_helix_to_the_interpolation_error() {
    let points: Vec<Point3<f64>> = (0..400)
        .map(|i| i as f64 * 0.02)
        .map(|t| point![t.cos(), t.sin(), 0.5 * t])
        .collect();
    let c = interpolate(&points, 5, Parametrization::ChordLength).expect("distinct");
    let arc = ArcLength::new(&c);
    let want = 399.0 * 0.02 * 1.25_f64.sqrt();
    assert!((arc.total() - want).abs() < 1e-8, "{} {want}", arc.total());
    check_inverse(&arc, 1e-12);
}

/// (t², t³): speed t √(4 + 9 t²), zero at the start.
#[test]
fn zero_speed_at_an_end_and_inside() {
    let z = point![0., 0., 0.];
    let cusp = vec![z, z, point![1. / 3., 0., 0.], point![1., 1., 0.]];
    let c = BSplineCurve::new(3, vec![0., 0., 0., 0., 1., 1., 1., 1.], cusp, None).expect("valid");
    let arc = ArcLength::new(&c);
    let exact = |t: f64| ((4.0 + 9.0 * t * t).powf(1.5) - 8.0) / 27.0;
    for i in 0..=50 {
        let t = i as f64 / 50.0;
        assert!((arc.length_at(t) - exact(t)).abs() < 1e-13);
    }
    check_inverse(&arc, 1e-13);
    // There and back on one straight piece: the speed |1 − 2t| has a corner.
    let turn = vec![z, point![1., 0., 0.], z];
    let c = BSplineCurve::new(2, vec![0., 0., 0., 1., 1., 1.], turn, None).expect("valid");
    let arc = ArcLength::new(&c);
    assert!((arc.total() - 1.0).abs() < 1e-12);
    check_inverse(&arc, 1e-12);
}

#[test]
fn a_standstill_and_a_point() {
    let (a, b, c) = (point![0., 0., 0.], point![1., 0., 0.], point![3., 0., 0.]);
    let stop =
        BSplineCurve::new(1, vec![0., 0., 1., 2., 3., 3.], vec![a, b, b, c], None).expect("valid");
    let arc = ArcLength::new(&stop);
    assert!((arc.total() - 3.0).abs() < 1e-14);
    assert!((arc.length_at(1.5) - 1.0).abs() < 1e-15);
    assert!((arc.parameter_at(1.0) - 1.0).abs() < 1e-14);
    assert!((arc.parameter_at(2.0) - 2.5).abs() < 1e-14);
    let point = BSplineCurve::new(1, vec![0., 0., 1., 1.], vec![b, b], None).expect("valid");
    let arc = ArcLength::new(&point);
    assert_eq!(
        (arc.total(), arc.parameter_at(0.0), arc.parameter_at(0.5)),
        (0.0, 0.0, 1.0)
    );
}

#[test]
fn every_sample_curve_agrees_with_a_fine_polygon() {
    for (name, c) in samples::curves() {
        let arc = ArcLength::new(&c);
        let [a, b] = c.domain();
        let n = 20_000;
        let at = |i: usize| c.point(a + (b - a) * i as f64 / n as f64);
        let polygon: f64 = (0..n).map(|i| (at(i + 1) - at(i)).norm()).sum();
        let error = (arc.total() - polygon).abs() / polygon;
        assert!(error < 1e-6, "{name}: {error:e}");
        check_inverse(&arc, 1e-11);
    }
}
