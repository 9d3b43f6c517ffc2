//! The zoo: exact, smooth, kinked, rational, degenerate and far-off splines.

use crate::geometry::{BSplineCurve, Knots, Parametrization, interpolate, join_c0};
use nalgebra::{Point3, point};

/// From (0,0,0) to (3,4,0), length 5.
pub(crate) fn line() -> BSplineCurve {
    BSplineCurve::line(point![0., 0., 0.], point![3., 4., 0.], 1).expect("valid")
}

/// A quarter of a circle in the plane z = 1, exact.
pub(crate) fn quarter_circle(radius: f64) -> BSplineCurve {
    let points = vec![
        point![radius, 0., 1.],
        point![radius, radius, 1.],
        point![0., radius, 1.],
    ];
    let weights = vec![1.0, 0.5_f64.sqrt(), 1.0];
    BSplineCurve::new(2, vec![0., 0., 0., 1., 1., 1.], points, Some(weights)).expect("valid")
}

/// A half circle of two rational pieces with a double knot.
pub(crate) fn half_circle() -> BSplineCurve {
    let xy = [[1., 0.], [1., 1.], [0., 1.], [-1., 1.], [-1., 0.]];
    let points = xy.iter().map(|p| point![p[0], p[1], 0.0]).collect();
    let h = 0.5_f64.sqrt();
    let knots = vec![0., 0., 0., 0.5, 0.5, 1., 1., 1.];
    BSplineCurve::new(2, knots, points, Some(vec![1., h, 1., h, 1.])).expect("valid")
}

/// An irregular space curve of the given degree with simple and double knots.
pub(crate) fn wild(degree: usize) -> BSplineCurve {
    let mut inner = vec![0.11, 0.4, 0.45, 0.8];
    if degree > 1 {
        inner.insert(1, 0.4);
    }
    let knots = Knots::clamped(degree, [0., 1.], &inner).expect("valid");
    let at = |i: usize| {
        let t = i as f64;
        point![
            t + 0.4 * (2.1 * t).sin(),
            (1.3 * t).cos() * 1.5,
            0.3 * t * (0.7 * t).sin()
        ]
    };
    let points: Vec<Point3<f64>> = (0..knots.control_count()).map(at).collect();
    BSplineCurve::from_knots(knots, points, None).expect("valid")
}

/// [`wild`] with weights from 1/2 to 2.
pub(crate) fn wild_rational(degree: usize) -> BSplineCurve {
    let c = wild(degree);
    let weights = (0..c.control_points().len())
        .map(|i| 2f64.powf((i as f64 * 1.7).sin()))
        .collect();
    let knots = c.knot_vector().clone();
    BSplineCurve::from_knots(knots, c.control_points().to_vec(), Some(weights)).expect("valid")
}

/// A cubic that runs straight, stands still (a fan's apex) and goes on round a
/// corner.
pub(crate) fn standing() -> BSplineCurve {
    let (a, b) = (point![0., 0., 0.], point![1.1, 0.3, 0.7]);
    let piece = |from, to, domain| {
        BSplineCurve::line(from, to, 3)
            .and_then(|l| l.on_domain(domain))
            .expect("valid")
    };
    let pieces = [
        piece(a, b, [0., 0.3]),
        piece(b, b, [0.3, 0.5]),
        piece(b, point![1.0, 2., 0.5], [0.5, 1.]),
    ];
    join_c0(&pieces).expect("they meet")
}

/// Interpolation of points on a helix, far from the origin.
pub(crate) fn far_helix() -> BSplineCurve {
    let points: Vec<_> = (0..40)
        .map(|i| i as f64 * 0.2)
        .map(|t| point![1e6 + t.cos(), -1e6 + t.sin(), 1e6 + 0.3 * t])
        .collect();
    interpolate(&points, 3, Parametrization::ChordLength).expect("distinct points")
}

/// All sample curves with names.
pub(crate) fn curves() -> Vec<(String, BSplineCurve)> {
    let mut curves = vec![
        ("line".to_owned(), line()),
        ("quarter circle".into(), quarter_circle(2.0)),
        ("half circle".into(), half_circle()),
        ("standing".into(), standing()),
        ("far helix".into(), far_helix()),
    ];
    for degree in 1..=7 {
        curves.push((format!("wild {degree}"), wild(degree)));
        curves.push((format!("wild rational {degree}"), wild_rational(degree)));
    }
    curves
}
