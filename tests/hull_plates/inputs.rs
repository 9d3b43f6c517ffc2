//! Input that is broken, odd, large or far away.

use crate::support::*;
use mouldloft::methods::Issue;
use mouldloft::methods::hull_plates::request::{Boundary, Options, PinnedRuling, Request};
use mouldloft::methods::hull_plates::validate;
use nalgebra::{Point3, Vector3};
use std::time::{Duration, Instant};

fn refused(request: &Request, code: &str, place: &str) -> Issue {
    let issues = issues(request);
    let found = issues
        .iter()
        .find(|i| i.code == code && i.path.join("/") == place);
    let issue = found
        .unwrap_or_else(|| panic!("no {code} at {place}: {issues:?}"))
        .clone();
    assert!(!issue.message.is_empty());
    // Validation alone says the same.
    assert!(validate(request).is_err());
    issue
}

fn pair() -> Vec<Points> {
    trawler()[1..3].to_vec()
}

#[test]
fn no_profile_and_one_profile_are_refused() {
    refused(&request(&[], exact()), "too-few-profiles", "input/profiles");
    let one = refused(
        &request(&pair()[..1], exact()),
        "too-few-profiles",
        "input/profiles",
    );
    assert!(one.message.contains('1'), "{}", one.message);
}

#[test]
fn profiles_without_points_are_refused() {
    let mut curves = pair();
    curves[1].clear();
    refused(
        &request(&curves, exact()),
        "too-few-points",
        "input/profiles/1/points",
    );
    curves[1] = vec![Point3::new(1., 2., 3.); 5];
    refused(
        &request(&curves, exact()),
        "too-few-points",
        "input/profiles/1/points",
    );
    let nothing = vec![vec![Point3::origin(); 3]; 2];
    refused(&request(&nothing, exact()), "no-extent", "input/profiles");
}

#[test]
fn opposite_directions_are_refused() {
    let mut curves = pair();
    curves[1].reverse();
    let issue = refused(
        &request(&curves, exact()),
        "opposite-direction",
        "input/profiles/1",
    );
    assert!(issue.hint.unwrap().contains("reverse"));
}

#[test]
fn the_same_curve_twice_is_refused() {
    let curves = vec![pair()[0].clone(); 2];
    refused(&request(&curves, exact()), "same-curve", "input/profiles/1");
}

#[test]
fn numbers_that_are_not_finite_are_refused_with_their_place() {
    for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for axis in 0..3 {
            let mut curves = pair();
            curves[1][4][axis] = value;
            refused(
                &request(&curves, exact()),
                "not-finite",
                "input/profiles/1/points/4",
            );
        }
    }
    // Finite, but their differences are not.
    let mut curves = pair();
    curves[0][0].x = -1e308;
    curves[1][12].x = 1e308;
    assert!(!issues(&request(&curves, exact())).is_empty());
}

#[test]
fn options_out_of_range_are_refused() {
    let with = |change: &dyn Fn(&mut Options), place: &str| {
        let mut options = exact();
        change(&mut options);
        refused(
            &request(&pair(), options),
            "out-of-range",
            &format!("options/{place}"),
        );
    };
    for value in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        with(
            &|o| o.boundary = Boundary::Tolerance(value),
            "boundary/value",
        );
        with(&|o| o.max_twist_deg = value, "max_twist_deg");
        with(&|o| o.thickness = Some(value), "thickness");
        with(&|o| o.min_bend_radius = Some(value), "min_bend_radius");
    }
    with(&|o| o.max_twist_deg = 46.0, "max_twist_deg");
    with(&|o| o.max_fan_percent = 51.0, "max_fan_percent");
    with(&|o| o.max_extension_percent = 21.0, "max_extension_percent");
    with(
        &|o| o.min_clearance_percent = Some(0.0),
        "min_clearance_percent",
    );
}

#[test]
fn repeated_points_count_once_and_are_named() {
    let clean = pair();
    let mut curves = clean.clone();
    let double = curves[0][5];
    curves[0].insert(5, double);
    curves[0].insert(5, double);
    let asked = request(&curves, exact());
    let outcome = fitted(&asked);
    assert_eq!(outcome.warnings.len(), 2, "{:?}", outcome.warnings);
    assert!(
        outcome.warnings[0].contains("/input/profiles/0/points/6"),
        "{:?}",
        outcome.warnings
    );
    assert_eq!(validate(&asked).unwrap(), outcome.warnings);
    let without = fitted(&request(&clean, exact()));
    assert_eq!(outcome.plates, without.plates);
}

#[test]
fn ten_thousand_points_finish_soon() {
    let plan = |t: f64| (40. * t, 5. * (1. - t.powi(3)));
    let curves = [
        along(10_000, |t| [plan(t).0, plan(t).1, 4. + t * t]),
        along(10_000, |t| [plan(t).0, 0.9 * plan(t).1, 1. + 0.6 * t * t]),
    ];
    let asked = request(&curves, exact());
    let begin = Instant::now();
    let outcome = fitted(&asked);
    let took = begin.elapsed();
    // Far above what it takes, far below what anything quadratic would.
    assert!(took < Duration::from_secs(30), "{took:?}");
    assert!(outcome.within_limits, "{:?}", outcome.summary);
    assert!(measured(&outcome)[0].twist_max <= 6.0);
}

#[test]
fn coordinates_near_a_million_lose_nothing() {
    let near = pair();
    let far: Vec<Points> = near
        .iter()
        .map(|c| c.iter().map(|p| p + Vector3::new(1e6, -1e6, 1e6)).collect())
        .collect();
    let asked = request(&far, exact());
    let outcome = fitted(&asked);
    let found = sound(&asked, &outcome);
    let here = measured(&fitted(&request(&near, exact())));
    assert!(
        (found[0].twist_max - here[0].twist_max).abs() < 1e-3,
        "{found:?} {here:?}"
    );
    for (k, given) in far.iter().enumerate() {
        let [points, curve, _] = moved(&outcome, k, given);
        assert!(points.max(curve) <= MET * 70.0);
    }
}

fn pin(curves: &[Points], from: usize, to: usize) -> PinnedRuling {
    PinnedRuling {
        plate: 0,
        from: curves[0][from],
        to: curves[1][to],
    }
}

#[test]
fn pinned_rulings_are_there() {
    use crate::checker::{Nearest, Spline};
    let curves = pair();
    let pins = vec![pin(&curves, 3, 3), pin(&curves, 6, 6)];
    let asked = request(
        &curves,
        Options {
            pinned_rulings: pins.clone(),
            ..exact()
        },
    );
    let outcome = fitted(&asked);
    sound(&asked, &outcome);
    let reported = outcome.plates[0].diagnostics.pinned_deviation.unwrap();
    let [first, second] = Spline::edges(&outcome.plates[0].surface);
    let nearest = Nearest::new(&first);
    let off = pins.iter().map(|p| {
        let (distance, u) = nearest.to(&p.from.coords);
        distance.max((second.at(u).point - p.to.coords).norm())
    });
    let off = off.fold(0.0, f64::max);
    assert!(
        off <= 1e-4 * 70.0,
        "a pinned ruling is {off} ft off (reported {reported})"
    );
    assert!(
        (off - reported).abs() <= 1e-2 * off + 1e-4,
        "{off} {reported}"
    );
}

#[test]
fn pins_that_cannot_be_are_refused() {
    let curves = pair();
    let with = |pins: Vec<PinnedRuling>| {
        request(
            &curves,
            Options {
                pinned_rulings: pins,
                ..exact()
            },
        )
    };
    let crossing = with(vec![pin(&curves, 3, 6), pin(&curves, 6, 3)]);
    refused(&crossing, "crossing-pins", "options/pinned_rulings/1");
    let nowhere = PinnedRuling {
        plate: 1,
        ..pin(&curves, 3, 3)
    };
    refused(
        &with(vec![nowhere]),
        "no-such-plate",
        "options/pinned_rulings/0/plate",
    );
    let off = PinnedRuling {
        from: Point3::new(35., 0., 0.),
        ..pin(&curves, 3, 3)
    };
    refused(
        &with(vec![off]),
        "off-the-profile",
        "options/pinned_rulings/0/from",
    );
}
