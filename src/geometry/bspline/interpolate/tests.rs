use super::*;
use nalgebra::{point, vector};

fn helix(n: usize) -> Vec<Point3<f64>> {
    (0..n)
        .map(|i| i as f64 * 0.3)
        .map(|t| point![t.cos(), t.sin(), 0.2 * t])
        .collect()
}

#[test]
fn passes_through_its_points() {
    for parametrization in [
        Parametrization::ChordLength,
        Parametrization::Centripetal,
        Parametrization::Uniform,
    ] {
        for degree in 1..=5 {
            let points = helix(23);
            let u = interpolation_parameters(&points, parametrization).expect("distinct");
            let c = interpolate(&points, degree, parametrization).expect("distinct");
            assert_eq!(c.control_points().len(), 23);
            for (u, p) in u.iter().zip(&points) {
                assert!((c.point(*u) - p).norm() < 1e-13, "degree {degree}");
            }
        }
    }
}

/// Piegl & Tiller, example 9.1: chord-length parameters of five points.
#[test]
fn parameters_of_the_nurbs_book() {
    let flat = [[0., 0.], [3., 4.], [-1., 4.], [-4., 0.], [-4., -3.]];
    let points: Vec<_> = flat.iter().map(|p| point![p[0], p[1], 0.0]).collect();
    let u = interpolation_parameters(&points, Parametrization::ChordLength).expect("distinct");
    for (got, want) in u.iter().zip([0.0, 5.0, 9.0, 14.0, 17.0]) {
        assert!((got - want / 17.0).abs() < 1e-15);
    }
}

#[test]
fn few_points_give_the_polynomial_through_them() {
    let line = interpolate(
        &[point![0., 0., 0.], point![3., 6., 9.]],
        3,
        Default::default(),
    )
    .expect("two points");
    assert_eq!(line.degree(), 3);
    assert!((line.control_points()[1] - point![1., 2., 3.]).norm() < 1e-15);
    let three = helix(3);
    let c = interpolate(&three, 3, Parametrization::Uniform).expect("three points");
    assert_eq!(c.control_points().len(), 4);
    assert!((c.point(0.5) - three[1]).norm() < 1e-15);
    assert!(c.derivative3(0.3).norm() < 1e-12);
}

#[test]
fn bad_points_are_refused_with_their_index() {
    let p = point![1., 2., 3.];
    let e = |points: &[Point3<f64>]| {
        interpolate(points, 3, Parametrization::ChordLength).expect_err("bad points")
    };
    assert_eq!(
        e(&[]),
        SplineError::TooFewPoints {
            given: 0,
            needed: 2
        }
    );
    assert_eq!(
        e(&[p]),
        SplineError::TooFewPoints {
            given: 1,
            needed: 2
        }
    );
    let q = point![2., 2., 2.];
    assert_eq!(e(&[p, q, q]), SplineError::RepeatedPoint { index: 2 });
    assert_eq!(
        e(&[p, q, point![f64::NAN, 0., 0.]]),
        SplineError::PointNotFinite { index: 2 }
    );
    // So close that the parameter cannot tell them apart.
    let far = point![1e20, 0., 0.];
    assert_eq!(e(&[far, p, q]), SplineError::RepeatedPoint { index: 2 });
}

#[test]
fn ten_thousand_points() {
    let points = helix(10_000);
    let u = interpolation_parameters(&points, Parametrization::ChordLength).expect("distinct");
    let c = interpolate(&points, 3, Parametrization::ChordLength).expect("distinct");
    let worst = u.iter().zip(&points).map(|(u, p)| (c.point(*u) - p).norm());
    assert!(worst.fold(0.0, f64::max) < 1e-9);
}

#[test]
fn the_complete_cubic_reproduces_a_cubic() {
    let f = |t: f64| point![t, t * t - t, t * t * t];
    let d = |t: f64| vector![1.0, 2.0 * t - 1.0, 3.0 * t * t];
    for inner in [&[][..], &[0.5], &[-0.5, 0.1, 0.7, 1.9]] {
        let mut u = vec![-1.0];
        u.extend_from_slice(inner);
        u.push(2.0);
        let points: Vec<_> = u.iter().map(|t| f(*t)).collect();
        let c = complete_cubic(&u, &points, d(-1.0), d(2.0)).expect("increasing");
        for i in 0..=30 {
            let t = -1.0 + 0.1 * i as f64;
            let jet = c.derivatives(t);
            assert!((jet.point - f(t)).norm() < 1e-13);
            assert!((jet.d1 - d(t)).norm() < 1e-12);
        }
    }
    let two = [f(0.0), f(1.0)];
    assert!(complete_cubic(&[0.0, 0.0], &two, d(0.0), d(1.0)).is_err());
    assert!(complete_cubic(&[0.0], &two, d(0.0), d(1.0)).is_err());
}
