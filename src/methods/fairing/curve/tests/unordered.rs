//! Points without order.

use super::super::request::Request;
use super::*;
use crate::methods::FitError;

fn unordered(points: Vec<Point3<f64>>, dimension: usize) -> Request {
    Request {
        ordered: false,
        ..Request::through(points, dimension)
    }
}

#[test]
fn the_same_curve_as_with_order() {
    for count in [150, 3000] {
        let points = frame(count, 0.005, 13);
        let ordered = fitted(&Request::through(points.clone(), 2));
        let found = fitted(&unordered(shuffled(points), 2));
        assert!(!found.closed);
        assert_eq!(found.after.inflections, 2);
        let ratio = found.after.curvature_variation / ordered.after.curvature_variation;
        assert!((0.95..1.05).contains(&ratio), "{count}: ratio {ratio}");
        assert!((found.after.length / ordered.after.length - 1.0).abs() < 2e-3);
    }
}

#[test]
fn loops_are_seen_to_be_closed() {
    let mut noise = Noise(2);
    let points: Vec<Point3<f64>> = (0..400)
        .map(|_| {
            let t = 2.0 * std::f64::consts::PI * noise.uniform();
            Point3::new(3.0 * t.cos() + 0.02 * noise.normal(), 2.0 * t.sin(), 0.0)
        })
        .collect();
    let o = fitted(&unordered(points, 2));
    assert!(o.closed);
    assert_eq!(o.after.inflections, 0);
}

#[test]
fn space_curves_too() {
    let mut noise = Noise(8);
    let points: Vec<Point3<f64>> = (0..500)
        .map(|_| {
            let t = 9.0 * noise.uniform();
            let e = 0.01;
            Point3::new(
                t.cos() + e * noise.normal(),
                t.sin() + e * noise.normal(),
                0.4 * t,
            )
        })
        .collect();
    let o = fitted(&unordered(points, 3));
    assert!(!o.closed);
    assert!((o.after.length / (9.0 * 1.16_f64.sqrt()) - 1.0).abs() < 0.02);
}

#[test]
fn parts_and_branches_are_refused_by_name() {
    let code = |points: Vec<Point3<f64>>| match fit(&unordered(points, 2), &Unwatched) {
        Err(FitError::Invalid(issues)) => issues[0].code,
        other => panic!("not refused: {:?}", other.map(|o| o.summary)),
    };
    let line = |n: usize, from: (f64, f64), to: (f64, f64)| {
        (0..n).map(move |k| {
            let t = k as f64 / (n - 1) as f64;
            Point3::new(
                from.0 + t * (to.0 - from.0),
                from.1 + t * (to.1 - from.1),
                0.0,
            )
        })
    };
    let two = line(80, (0.0, 0.0), (10.0, 0.0)).chain(line(80, (0.0, 8.0), (10.0, 9.0)));
    assert_eq!(code(two.collect()), "several-parts");
    let tee = line(200, (0.0, 0.0), (10.0, 0.0)).chain(line(80, (5.0, 0.1), (5.0, 5.0)));
    assert_eq!(code(tee.collect()), "branch");
    // A loop with a tail: the tail is neither noise nor a hairpin.
    let around = (0..600).map(|k| {
        let angle = std::f64::consts::TAU * f64::from(k) / 600.0;
        Point3::new(3.0 * angle.cos(), 2.0 * angle.sin(), 0.0)
    });
    let tail = line(60, (3.05, 0.0), (5.0, 0.4));
    assert_eq!(code(around.chain(tail).collect()), "branch");
}
