//! Requests, shapes and the checks that every outcome must pass.

use crate::checker::{Found, Nearest, Spline, leaves, measure};
use mouldloft::geometry::BSplineCurve;
use mouldloft::methods::hull_plates::fit;
use mouldloft::methods::hull_plates::outcome::{Outcome, Plate};
use mouldloft::methods::hull_plates::request::{
    Boundary, Ends, Options, Profile, ProfileShape, Request,
};
use mouldloft::methods::{FitError, Issue};
use mouldloft::solver::Unwatched;
use nalgebra::{Point3, Vector3};

pub type Points = Vec<Point3<f64>>;

/// Share of the model within which boundaries count as met.
pub const MET: f64 = 1e-6;

pub fn exact() -> Options {
    Options {
        boundary: Boundary::Exact,
        ..Options::default()
    }
}

/// A request for profiles through points, named after their places.
pub fn request(curves: &[Points], options: Options) -> Request {
    let profiles = curves
        .iter()
        .enumerate()
        .map(|(k, points)| Profile {
            name: format!("curve {k}"),
            shape: ProfileShape::Points(points.clone()),
        })
        .collect();
    Request { profiles, options }
}

pub fn of_splines(curves: Vec<BSplineCurve>, options: Options) -> Request {
    let profiles = curves
        .into_iter()
        .enumerate()
        .map(|(k, curve)| Profile {
            name: format!("curve {k}"),
            shape: ProfileShape::BSpline(curve),
        })
        .collect();
    Request { profiles, options }
}

pub fn fitted(request: &Request) -> Outcome {
    fit(request, &Unwatched).unwrap_or_else(|e| panic!("{e:?}"))
}

/// The issues of a request that must be refused.
pub fn issues(request: &Request) -> Vec<Issue> {
    match fit(request, &Unwatched) {
        Err(FitError::Invalid(issues)) => issues,
        other => panic!("not refused: {other:?}"),
    }
}

/// `n` points of a curve over [0, 1].
pub fn along(n: usize, curve: impl Fn(f64) -> [f64; 3]) -> Points {
    (0..n)
        .map(|i| Point3::from(curve(i as f64 / (n - 1) as f64)))
        .collect()
}

pub fn line(a: [f64; 3], b: [f64; 3], n: usize) -> Points {
    along(n, |t| [0, 1, 2].map(|k| a[k] + t * (b[k] - a[k])))
}

/// The trawler of Zheng & Bo 2018, table 1, feet: main deck, upper chine,
/// lower chine, profile.
pub fn trawler() -> Vec<Points> {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/src/http/examples/trawler.json"
    );
    let text = std::fs::read_to_string(path).unwrap();
    let job: serde_json::Value = serde_json::from_str(&text).unwrap();
    let profiles = job["input"]["profiles"].as_array().unwrap();
    let curves: Vec<Points> = profiles.iter().map(|p| points_of(&p["points"])).collect();
    assert_eq!(curves.iter().map(Vec::len).collect::<Vec<_>>(), [13; 4]);
    curves
}

pub fn points_of(value: &serde_json::Value) -> Points {
    let number = |v: &serde_json::Value| v.as_f64().unwrap();
    value
        .as_array()
        .unwrap()
        .iter()
        .map(|p| Point3::new(number(&p[0]), number(&p[1]), number(&p[2])))
        .collect()
}

/// The longest side of the bounding box.
pub fn model_size(curves: &[Points]) -> f64 {
    let side = |k: usize| {
        let values = || curves.iter().flatten().map(|p| p[k]);
        values().fold(f64::MIN, f64::max) - values().fold(f64::MAX, f64::min)
    };
    side(0).max(side(1)).max(side(2))
}

pub fn measured(outcome: &Outcome) -> Vec<Found> {
    outcome.plates.iter().map(|p| measure(&p.surface)).collect()
}

/// What holds of every outcome: finite figures, sentences, the shared curves,
/// the report's figures equal to the checker's, the verdict equal to both.
pub fn sound(request: &Request, outcome: &Outcome) -> Vec<Found> {
    let found = measured(outcome);
    assert_eq!(outcome.plates.len() + 1, request.profiles.len());
    assert_eq!(outcome.profiles.len(), request.profiles.len());
    assert_eq!(outcome.summary.len(), outcome.plates.len() + 1);
    assert!(
        outcome.summary.iter().all(|s| s.ends_with('.')),
        "{:?}",
        outcome.summary
    );
    for (plate, f) in outcome.plates.iter().zip(&found) {
        eprintln!(
            "{}: twist {:.4}° mean {:.4}°, clearance {:.4} at {:.4}, fans {:.2?} %, {:?}",
            plate.name,
            f.twist_max,
            f.twist_mean,
            f.clearance,
            f.clearance_at,
            f.fans,
            plate.diagnostics.termination
        );
    }
    for (plate, found) in outcome.plates.iter().zip(&found) {
        honest(request, plate, found);
    }
    let all = outcome.plates.iter().all(|p| p.within_limits);
    assert_eq!(outcome.within_limits, all);
    watertight(request, outcome);
    found
}

fn honest(request: &Request, plate: &Plate, found: &Found) {
    let (d, o) = (&plate.diagnostics, &request.options);
    let finite = plate
        .surface
        .control_points()
        .iter()
        .all(|p| p.coords.iter().all(|c| c.is_finite()));
    assert!(finite, "{}: a control point is not finite", plate.name);
    let near = |a: f64, b: f64, share: f64, least: f64| (a - b).abs() <= share * b.abs() + least;
    assert!(
        near(d.twist_max_deg, found.twist_max, 0.01, 2e-3),
        "{}: reported twist_max {}, worst at {}; {found:?}",
        plate.name,
        d.twist_max_deg,
        d.twist_max_u
    );
    assert!(
        near(d.twist_mean_deg, found.twist_mean, 0.02, 2e-3),
        "{}: reported twist_mean {}, worst at {}; {found:?}",
        plate.name,
        d.twist_mean_deg,
        d.twist_max_u
    );
    assert!(
        near(d.area, found.area, 0.05, 0.0),
        "{}: area {} but {}",
        plate.name,
        d.area,
        found.area
    );
    assert_eq!(
        d.crossing_rulings == 0,
        found.crossings == 0,
        "{}: {found:?}",
        plate.name
    );
    assert!(plate.sentence.contains(&plate.name), "{}", plate.sentence);
    if plate.within_limits {
        assert!(found.twist_max <= o.max_twist_deg + 1e-3 && found.crossings == 0);
    } else {
        assert!(
            plate.sentence.contains(';'),
            "no reason given: {}",
            plate.sentence
        );
    }
    for range in &found.fan_ranges {
        let reported = plate
            .fans
            .iter()
            .any(|f| f.u_range[0] <= range[0] + 1e-9 && f.u_range[1] >= range[1] - 1e-9);
        assert!(
            reported,
            "{}: {range:?} stands still but is no fan: {:?}",
            plate.name, plate.fans
        );
    }
    assert!(
        plate
            .fans
            .iter()
            .all(|f| f.swept_percent <= o.max_fan_percent + 1e-6)
    );
    assert!(
        found.fans[2] <= 1e-3,
        "{}: a fan inside the plate {found:?}",
        plate.name
    );
    assert!(plate.rulings.windows(2).all(|w| w[0].u <= w[1].u));
}

/// Both plates at a shared profile pass through the one delivered curve.
fn watertight(request: &Request, outcome: &Outcome) {
    for (k, profile) in outcome.profiles.iter().enumerate() {
        let shared = Spline::of(&profile.curve);
        let before = k
            .checked_sub(1)
            .map(|i| Spline::edges(&outcome.plates[i].surface)[1].clone());
        let after = outcome
            .plates
            .get(k)
            .map(|p| Spline::edges(&p.surface)[0].clone());
        for edge in [before, after].into_iter().flatten() {
            let (off, _) = leaves(&shared, &edge);
            assert!(
                off <= MET * outcome.model_size,
                "{}: {off:e} off its plate",
                profile.name
            );
            if request.options.ends == Ends::Fan {
                let (off, _) = leaves(&edge, &shared);
                assert!(
                    off <= MET * outcome.model_size,
                    "{}: plate {off:e} off",
                    profile.name
                );
            }
        }
    }
}

/// Deviation of profile `k` as the checker sees it: at the points, along the
/// curve (of both neighbouring plates), mean along the curve.
pub fn moved(outcome: &Outcome, k: usize, given: &Points) -> [f64; 3] {
    let curve = Spline::through(given);
    let before = k
        .checked_sub(1)
        .map(|i| Spline::edges(&outcome.plates[i].surface)[1].clone());
    let after = outcome
        .plates
        .get(k)
        .map(|p| Spline::edges(&p.surface)[0].clone());
    let mut worst = [0.0_f64; 3];
    for edge in [before, after].into_iter().flatten() {
        let nearest = Nearest::new(&edge);
        let points = given
            .iter()
            .map(|p| nearest.to(&p.coords).0)
            .fold(0.0, f64::max);
        let (max, mean) = leaves(&curve, &edge);
        worst = [worst[0].max(points), worst[1].max(max), worst[2].max(mean)];
    }
    worst
}

/// How far the edges' ends lie from the given curves' ends, at most.
pub fn end_offset(outcome: &Outcome, curves: &[Points]) -> f64 {
    let mut worst = 0.0_f64;
    for (i, plate) in outcome.plates.iter().enumerate() {
        for (edge, given) in Spline::edges(&plate.surface).iter().zip(&curves[i..]) {
            let off = |a: Vector3<f64>, b: &Point3<f64>| (a - b.coords).norm();
            worst = worst
                .max(off(edge.start(), &given[0]))
                .max(off(edge.end(), &given[given.len() - 1]));
        }
    }
    worst
}

/// Quarter circle about the z axis as a rational quadratic.
pub fn quarter(radius: f64, z: f64) -> BSplineCurve {
    let points = [[radius, 0.0, z], [radius, radius, z], [0.0, radius, z]].map(Point3::from);
    let weights = vec![1.0, std::f64::consts::FRAC_1_SQRT_2, 1.0];
    BSplineCurve::new(
        2,
        vec![0., 0., 0., 1., 1., 1.],
        points.to_vec(),
        Some(weights),
    )
    .unwrap()
}
