//! The contract of a method: errors that point, scale, threads, cancelling.

use super::super::request::Request;
use super::super::validate;
use super::*;
use crate::methods::FitError;
use crate::solver::{Control, Stop};
use std::sync::atomic::{AtomicUsize, Ordering};

#[test]
fn issues_name_their_place() {
    let mut request = Request::through(half_circle(13), 2);
    request.points[4].y = f64::NAN;
    request.options.tolerance = Some(-1.0);
    request.options.locked = vec![99];
    request.options.stiffness = vec![1.0];
    let paths: Vec<String> = validate(&request)
        .iter()
        .map(|i| i.path.join("/"))
        .collect();
    for want in [
        "input/points/4",
        "options/tolerance",
        "options/locked/0",
        "options/stiffness",
    ] {
        assert!(paths.iter().any(|p| p == want), "{want} not in {paths:?}");
    }
    let same = Request::through(vec![Point3::new(1.0, 1.0, 0.0); 5], 2);
    assert_eq!(validate(&same)[0].code, "too-few-points");
    assert_eq!(
        validate(&Request::through(Vec::new(), 2))[0].code,
        "too-few-points"
    );
    assert!(validate(&Request::through(half_circle(13), 2)).is_empty());
}

/// Code and place of every issue.
fn issues(request: &Request) -> Vec<(&'static str, String)> {
    let each = validate(request).into_iter();
    each.map(|i| (i.code, i.path.join("/"))).collect()
}

#[test]
fn wishes_that_contradict_each_other_are_named() {
    let line = |n: u32| {
        (0..n)
            .map(|k| Point3::new(f64::from(k), 0.0, 0.0))
            .collect()
    };
    let mut closed = Request::through(line(6), 2);
    closed.closed = Some(true);
    assert_eq!(issues(&closed), [("collinear", "input/points".into())]);
    closed.closed = None;
    assert!(issues(&closed).is_empty());

    let mut request = Request::through(half_circle(13), 2);
    request.options.straight = vec![[0, 4]];
    request.options.locked = vec![0, 2, 4];
    request.options.end_curvatures = [Some(1.0), None];
    let found = issues(&request);
    assert_eq!(
        found,
        [
            ("contradiction", "options/straight/0".into()),
            ("contradiction", "options/end_curvatures/0".into())
        ]
    );
    request.options.locked = vec![0, 4];
    request.options.end_curvatures = [None; 2];
    assert!(issues(&request).is_empty());
    request.options.end_tangents = [Some(nalgebra::Vector3::y()), None];
    assert_eq!(
        issues(&request),
        [("contradiction", "options/end_tangents/0".into())]
    );
    // What is wrong by itself.
    let mut request = Request::through(half_circle(13), 2);
    request.options.tolerances = vec![0.1; 12];
    request.options.straight = vec![[5, 5]];
    request.options.degree = Some(2);
    request.options.freedom = [false, false, true];
    let found: Vec<&str> = issues(&request).iter().map(|i| i.0).collect();
    for want in ["wrong-count", "empty-stretch", "out-of-range", "no-freedom"] {
        assert!(found.contains(&want), "{want} not in {found:?}");
    }
}

#[test]
fn few_points_and_lines() {
    for n in 2..6 {
        let line = (0..n)
            .map(|k| Point3::new(f64::from(k), 2.0 * f64::from(k), 1.0))
            .collect();
        let o = fitted(&Request::through(line, 3));
        assert!(o.move_figures.max < 1e-5, "{n} points on a line");
        assert_eq!((o.after.extrema, o.after.inflections), (0, 0));
    }
    let zigzag = [(0.0, 0.0), (1.0, 1.0), (2.0, 0.0), (3.0, 1.0)];
    let mut request = Request::through(
        zigzag
            .iter()
            .map(|(x, y)| Point3::new(*x, *y, 0.0))
            .collect(),
        2,
    );
    request.options.tolerance = Some(0.1);
    assert!(fitted(&request).within_limits);
}

#[test]
fn scale_and_place_do_not_matter() {
    let points = frame(200, 0.005, 81);
    let own = fitted(&Request::through(points.clone(), 2));
    let far: Vec<Point3<f64>> = points
        .iter()
        .map(|p| Point3::new(p.x * 1000.0 + 1e6, p.y * 1000.0 - 1e6, 0.0))
        .collect();
    let o = fitted(&Request::through(far, 2));
    assert!((o.report.noise / own.report.noise / 1000.0 - 1.0).abs() < 1e-3);
    let ratio = o.after.curvature_variation / own.after.curvature_variation * 1e9;
    assert!((ratio - 1.0).abs() < 1e-2, "ratio {ratio}");
}

#[test]
fn repeated_points_count_once() {
    let points = frame(100, 0.005, 83);
    let twice: Vec<Point3<f64>> = points.iter().flat_map(|p| [*p, *p]).collect();
    let o = fitted(&Request::through(twice, 2));
    assert_eq!(o.moves.len(), 200);
    assert_eq!(o.warnings.len(), 1);
    assert_eq!(o.curve, fitted(&Request::through(points, 2)).curve);
}

#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    let mut request = Request::through(frame(9000, 0.005, 91), 2);
    let with = |threads: usize, request: &Request| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("threads can be had")
            .install(|| fitted(request))
    };
    assert_eq!(with(1, &request), with(3, &request));
    request.options.tolerance = Some(0.03);
    request.points.truncate(5000);
    assert_eq!(with(1, &request), with(2, &request));
}

/// Stops at the n-th check.
struct Patience(AtomicUsize);

impl Control for Patience {
    fn check(&self) -> Result<(), Stop> {
        let left = self
            .0
            .fetch_update(Ordering::SeqCst, Ordering::SeqCst, |n| n.checked_sub(1));
        left.map(|_| ()).map_err(|_| Stop::Cancelled)
    }
    fn progress(&self, _: &'static str, _: f64) {}
}

#[test]
fn a_stop_is_heard_wherever_it_comes() {
    let mut request = Request::through(frame(300, 0.005, 95), 2);
    request.options.tolerance = Some(0.016);
    for patience in [0, 1, 5, 12, 20] {
        let stopped = fit(&request, &Patience(AtomicUsize::new(patience)));
        assert_eq!(
            stopped,
            Err(FitError::Stopped(Stop::Cancelled)),
            "after {patience}"
        );
    }
    request.ordered = false;
    for patience in [0, 3, 9] {
        let stopped = fit(&request, &Patience(AtomicUsize::new(patience)));
        assert_eq!(
            stopped,
            Err(FitError::Stopped(Stop::Cancelled)),
            "after {patience}"
        );
    }
}
