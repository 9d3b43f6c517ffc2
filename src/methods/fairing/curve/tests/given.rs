//! What the user may prescribe.

use super::super::request::Request;
use super::*;
use nalgebra::Vector3;

fn request() -> Request {
    Request::through(frame(200, 0.005, 51), 2)
}

#[test]
fn locked_points_stay() {
    for tolerance in [None, Some(0.016)] {
        let mut request = request();
        request.options.locked = vec![0, 61, 199];
        request.options.tolerance = tolerance;
        let o = fitted(&request);
        for i in [0, 61, 199] {
            assert!(
                o.moves[i].off_curve < 1e-8,
                "point {i} moved {}",
                o.moves[i].off_curve
            );
        }
    }
}

#[test]
fn end_tangents_and_curvatures_hold() {
    for tolerance in [None, Some(0.016)] {
        let mut request = request();
        request.options.tolerance = tolerance;
        let tangent = Vector3::new((-0.4_f64).cos(), (-0.4_f64).sin(), 0.0);
        request.options.end_tangents[0] = Some(tangent * 3.0);
        request.options.end_curvatures[1] = Some(0.4);
        let o = fitted(&request);
        assert!(
            o.report.tangent_error_deg.is_some_and(|e| e < 1e-3),
            "{:?}",
            o.report
        );
        let last = o.comb.last().expect("a comb has teeth");
        assert!(
            (last.curvature - 0.4).abs() < 1e-3,
            "κ at the end {}",
            last.curvature
        );
    }
}

#[test]
fn straight_stretches_are_straight_and_knuckles_sharp() {
    let mut noise = Noise(61);
    let y = |x: f64| {
        if x < 0.0 {
            0.1 * x
        } else {
            0.03 * x * x * x + 0.1 * x
        }
    };
    let points: Vec<Point3<f64>> = (0..61)
        .map(|k| {
            let x = f64::from(k) / 6.0 - 5.0;
            Point3::new(x, y(x) + 0.003 * noise.normal(), 0.0)
        })
        .collect();
    let mut request = Request::through(points, 2);
    request.options.straight = vec![[0, 30]];
    let o = fitted(&request);
    assert!(
        o.report.straightness.is_some_and(|s| s < 1e-3),
        "{:?}",
        o.report.straightness
    );
    assert!(o.move_figures.max < 0.02);

    let y = |x: f64| {
        if x < 0.0 {
            0.2 * x
        } else {
            0.02 * x * x - 0.5 * x
        }
    };
    let corner = (0..41).map(|k| {
        let x = f64::from(k) / 4.0 - 5.0;
        Point3::new(x, y(x) + 0.003 * noise.normal(), 0.0)
    });
    let mut request = Request::through(corner.collect(), 2);
    request.options.knuckles = vec![20];
    let o = fitted(&request);
    let kinks = o.curve.kinks(0.1);
    assert_eq!(kinks.len(), 1);
    assert!((o.curve.point(kinks[0]).x).abs() < 0.05);
    assert!(o.move_figures.max < 0.015, "{:?}", o.move_figures);
}

#[test]
fn points_that_may_move_only_up_and_down_do() {
    let mut noise = Noise(71);
    let points: Vec<Point3<f64>> = (0..41)
        .map(|k| {
            let x = f64::from(k) / 4.0 - 5.0;
            Point3::new(x, 0.1 * x * x + 0.3 * x.sin() + 0.02 * noise.normal(), 0.0)
        })
        .collect();
    for tolerance in [None, Some(0.05)] {
        let mut request = Request::through(points.clone(), 2);
        request.options.freedom = [false, true, false];
        request.options.tolerance = tolerance;
        let o = fitted(&request);
        assert!(o.within_limits);
        for m in &o.moves {
            assert!((m.now.x - m.given.x).abs() < 1e-6, "point {} slid", m.index);
            assert!(tolerance.is_none_or(|t| (m.now.y - m.given.y).abs() <= t));
        }
    }
}

#[test]
fn each_point_its_own_tolerance_and_weight() {
    let mut request = request();
    request.options.tolerances = (0..200)
        .map(|k| if k < 100 { 0.016 } else { 0.03 })
        .collect();
    let o = fitted(&request);
    assert!(o.within_limits);
    assert!(
        o.moves
            .iter()
            .all(|m| m.off_curve <= m.tolerance.unwrap_or(0.0))
    );
    let far = |o: &Outcome| {
        o.moves[100..]
            .iter()
            .map(|m| m.distance)
            .fold(0.0, f64::max)
    };
    assert!(far(&o) > 0.017, "the wider half uses its room");

    let mut request = self::request();
    request.options.stiffness = (0..200).map(|k| if k == 50 { 1e4 } else { 1.0 }).collect();
    let heavy = fitted(&request).moves[50].distance;
    let light = fitted(&self::request()).moves[50].distance;
    assert!(heavy < 0.2 * light, "{heavy} against {light}");
}

#[test]
fn the_number_of_control_points_and_the_degree_are_kept() {
    for (degree, count) in [(3, 14), (5, 20), (7, 16)] {
        let mut request = request();
        request.options.degree = Some(degree);
        request.options.control_points = Some(count);
        let o = fitted(&request);
        assert_eq!(o.curve.degree(), degree);
        assert_eq!(o.curve.control_points().len(), count);
        assert_eq!(o.report.control_points_from, "asked");
    }
}
