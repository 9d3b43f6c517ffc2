//! Near-degenerate inputs, each frozen once it had been thought of or had
//! failed, and sweeps that hold a promise over many orders of magnitude.

use super::{curve_laws, samples};
use crate::geometry::{
    ArcLength, BSplineCurve, CurveIndex, Knots, Parametrization, RuledSurface, Tolerance,
    directed_distance, interpolate, interpolation_parameters,
};
use nalgebra::{Point3, Vector3, point};

/// Neighbouring points from equal spacing down to a billionth of it.
#[test]
fn interpolation_of_points_that_crowd() {
    for exponent in 0..=9 {
        let gap = 10f64.powi(-exponent);
        let mut points: Vec<Point3<f64>> = (0..8)
            .map(f64::from)
            .map(|t| point![t, t.sin(), 0.1 * t * t])
            .collect();
        points.insert(4, points[3] + Vector3::new(0.6, 0.8, 0.0) * gap);
        for parametrization in [Parametrization::ChordLength, Parametrization::Centripetal] {
            let u = interpolation_parameters(&points, parametrization).expect("distinct");
            let c = interpolate(&points, 3, parametrization).expect("distinct");
            for (u, p) in u.iter().zip(&points) {
                assert!((c.point(*u) - p).norm() < 1e-10, "gap {gap:e}");
            }
        }
    }
}

/// Two inner knots ever closer together: every law of curves still holds but
/// differences, which have no room.
#[test]
fn knots_that_almost_coincide() {
    for exponent in [2, 4, 8, 12, 15] {
        let close = 0.4 + 10f64.powi(-exponent);
        let knots = Knots::clamped(3, [0., 1.], &[0.4, close, 0.7]).expect("sorted");
        let points = (0..7)
            .map(f64::from)
            .map(|t| point![t, t.cos(), 0.0])
            .collect();
        let c = BSplineCurve::from_knots(knots, points, None).expect("valid");
        let (left, right) = c.split(close).expect("inside");
        assert_eq!(left.end(), right.start());
        assert!((left.end() - c.point(close)).norm() < 1e-12);
        let raised = c.elevated().expect("degree 4");
        for i in 0..=100 {
            let u = f64::from(i) / 100.0;
            assert!(
                (raised.point(u) - c.point(u)).norm() < 1e-10,
                "10^-{exponent} at {u}"
            );
        }
        let arc = ArcLength::new(&c);
        assert!(
            (arc.length_at(arc.parameter_at(0.4 * arc.total())) / arc.total() - 0.4).abs() < 1e-12
        );
        assert!(CurveIndex::new(&c).closest(&point![3.0, 0.5, 0.2]).certain);
    }
}

/// One millionth to a million of the size: figures scale with the model.
#[test]
fn arc_length_and_distance_scale_with_the_model() {
    let c = samples::wild(3);
    let total = ArcLength::new(&c).total();
    let other = c.translated(&Vector3::new(0.01, 0.02, 0.0));
    let at = |factor: f64| {
        let resolution = Tolerance::absolute(1e-6 * factor).expect("positive");
        directed_distance(&c.scaled(factor), &other.scaled(factor), resolution)
    };
    let one = at(1.0);
    assert!(one.certain);
    for exponent in [-6, -3, 3, 6] {
        let factor = 10f64.powi(exponent);
        let length = ArcLength::new(&c.scaled(factor)).total();
        assert!((length / factor / total - 1.0).abs() < 1e-12);
        let d = at(factor);
        assert!(
            d.certain && (d.max / factor - one.max).abs() < 2e-6,
            "{d:?} {one:?}"
        );
        assert!((d.mean / factor - one.mean).abs() < 1e-9);
    }
}

/// Meeting tips: the ruling has no length at the end.
#[test]
fn a_tip_has_no_normal_and_no_panic() {
    let tip = point![1., 0., 0.];
    let line = |from| BSplineCurve::line(from, tip, 3).expect("valid");
    let s = RuledSurface::new(line(point![0., 0., 0.]), line(point![0., 1., 0.])).expect("valid");
    assert_eq!(s.bend_curvature(1.0, 0.5), None);
    assert_eq!(s.twist(1.0), 0.0);
    assert_eq!(s.to_bspline().expect("valid").normal(1.0, 0.5), None);
    assert!(s.twist(0.999_999).abs() < 1e-9);
}

/// A closed curve: start and end are one place and both are right.
#[test]
fn a_closed_curve_answers_with_either_end() {
    let points: Vec<Point3<f64>> = (0..=16)
        .map(|i| f64::from(i) * std::f64::consts::TAU / 16.0)
        .map(|t| point![t.cos(), t.sin(), 0.0])
        .collect();
    let c = interpolate(&points, 3, Parametrization::ChordLength).expect("distinct");
    curve_laws::check("closed", &c);
    let found = CurveIndex::new(&c).closest(&point![2., 0., 0.]);
    // The interpolant meets the axis at the seam, but not quite at a right angle.
    assert!(
        found.certain && found.distance <= 1.0 && found.distance > 1.0 - 1e-4,
        "{found:?}"
    );
}

/// A point that is a curve: every query has an answer.
#[test]
fn a_curve_of_one_point() {
    let p = point![0.1, 0.2, 0.3];
    let c = BSplineCurve::line(p, p, 3).expect("valid");
    let found = CurveIndex::new(&c).closest(&point![0.1, 0.2, 1.3]);
    assert!(found.certain && (found.distance - 1.0).abs() < 1e-15);
    let fine = Tolerance::absolute(1e-9).expect("positive");
    let d = directed_distance(&c, &samples::line(), fine);
    assert!(d.certain && d.max.is_finite() && (d.mean - d.max).abs() < 1e-15);
    assert!(c.kinks(0.1).is_empty());
}

/// Largest degree: the arrays on the stack are full.
#[test]
fn the_largest_degree() {
    let c = samples::wild(9);
    assert!(c.elevated().is_err());
    let fine = c.insert_knots(&[0.3, 0.3, 0.9]).expect("inside");
    for i in 0..=50 {
        let u = f64::from(i) / 50.0;
        let (a, b) = (c.derivatives(u), fine.derivatives(u));
        assert!((a.point - b.point).norm() < 1e-13 && (a.d1 - b.d1).norm() < 1e-10);
    }
    assert!(CurveIndex::new(&c).closest(&point![3., 0.4, 0.1]).certain);
}
