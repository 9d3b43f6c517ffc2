//! Shapes whose answer is known: the right verdict, with its reason.

use crate::checker::Found;
use crate::support::*;
use mouldloft::methods::hull_plates::outcome::Outcome;
use mouldloft::methods::hull_plates::request::{Options, Request};
use std::f64::consts::{FRAC_PI_2, SQRT_2};

/// Twist of a shape that is developable, degrees: what splines to 1e-5 rad leave.
const NONE: f64 = 0.01;

fn developable(request: &Request) -> (Outcome, Found) {
    let outcome = fitted(request);
    let found = sound(request, &outcome).remove(0);
    assert!(outcome.within_limits, "{:?}", outcome.summary);
    assert!(found.twist_max <= NONE, "{found:?}");
    assert_eq!(found.crossings, 0, "{found:?}");
    (outcome, found)
}

fn undevelopable(request: &Request, bottleneck: f64) {
    let outcome = fitted(request);
    let found = sound(request, &outcome).remove(0);
    let plate = &outcome.plates[0];
    assert!(!outcome.within_limits);
    assert!(found.twist_max > 6.0, "{found:?}");
    assert!(
        plate.diagnostics.bottleneck_deg > bottleneck,
        "{:?}",
        plate.diagnostics
    );
    assert!(
        plate.sentence.contains("no set of rulings"),
        "{}",
        plate.sentence
    );
    assert!(
        outcome.summary[0].contains("outside limits"),
        "{}",
        outcome.summary[0]
    );
}

fn skew_lines() -> [Points; 2] {
    [
        line([0., 0., 0.], [10., 0., 0.], 5),
        line([0., 0., 5.], [5., 8., 5.], 5),
    ]
}

#[test]
fn skew_lines_are_outside() {
    undevelopable(&request(&skew_lines(), exact()), 20.0);
}

#[test]
fn skew_lines_stay_outside_when_extended_or_moved_a_little() {
    use mouldloft::methods::hull_plates::request::{Boundary, Ends};
    let options = Options {
        ends: Ends::Extend,
        ..exact()
    };
    undevelopable(&request(&skew_lines(), options), 20.0);
    let options = Options {
        boundary: Boundary::Tolerance(0.001),
        ..Options::default()
    };
    undevelopable(&request(&skew_lines(), options), 20.0);
}

#[test]
fn a_hyperbolic_paraboloid_is_outside() {
    let curves = [
        line([0., 0., 0.], [1., 0., 0.], 5),
        line([0., 1., 0.], [1., 1., 1.], 5),
    ];
    undevelopable(&request(&curves, exact()), 20.0);
}

#[test]
fn a_twisted_plate_has_its_area() {
    // Any ruling of a hyperbolic paraboloid's two edges makes a plate; whatever
    // it is, its area is a matter of integration.
    let curves = [
        line([0., 0., 0.], [1., 0., 0.], 5),
        line([0., 1., 0.], [1., 1., 1.], 5),
    ];
    let outcome = fitted(&request(&curves, exact()));
    let (reported, found) = (
        outcome.plates[0].diagnostics.area,
        measured(&outcome)[0].area,
    );
    assert!(
        (reported - found).abs() <= 0.005 * found,
        "{reported} {found}"
    );
}

#[test]
fn a_plane_is_within() {
    let curves = [
        along(9, |t| [10. * t, 0.3 * (3. * t).sin(), 0.]),
        along(12, |t| [10. * t, 2. + 0.8 * t * t, 0.]),
    ];
    let (outcome, found) = developable(&request(&curves, exact()));
    assert!(found.clearance > 1.0 / 7.0 - 1e-4, "{found:?}");
    // Fair rulings: ends move along both curves at about the same pace.
    let rulings = &outcome.plates[0].rulings;
    let worst = rulings
        .iter()
        .map(|r| (r.to.x - r.from.x).abs())
        .fold(0.0, f64::max);
    assert!(worst < 2.0, "a ruling leans by {worst}");
}

#[test]
fn a_meeting_tip_is_within() {
    // A vertical cylinder over a parabola, cut level and by a slope: both
    // edges end in one point.
    let plan = |t: f64| (10. * t, 3. * (1. - t * t));
    let curves = [
        along(15, |t| [plan(t).0, plan(t).1, 2.]),
        along(15, |t| [plan(t).0, plan(t).1, 2. * t]),
    ];
    let (_, found) = developable(&request(&curves, exact()));
    assert!(found.area > 5.0 && found.area.is_finite());
}

fn arc(radius: f64, z: f64, from: f64, to: f64, n: usize) -> Points {
    along(n, |t| {
        let a = from + (to - from) * t;
        [radius * a.cos(), radius * a.sin(), z]
    })
}

#[test]
fn a_cone_is_within() {
    let curves = [
        arc(4., 0., 0., FRAC_PI_2, 17),
        arc(2., 2., 0., FRAC_PI_2, 17),
    ];
    developable(&request(&curves, exact()));
}

#[test]
fn a_cylinder_is_within() {
    let curves = [
        arc(5., 0., 0., FRAC_PI_2, 17),
        arc(5., 4., 0., FRAC_PI_2, 17),
    ];
    developable(&request(&curves, exact()));
}

#[test]
fn a_sheared_cylinder_is_within() {
    let near = arc(5., 0., 0., FRAC_PI_2, 17);
    let far: Points = near
        .iter()
        .map(|p| p + nalgebra::Vector3::new(1., -2., 4.))
        .collect();
    developable(&request(&[near, far], exact()));
}

#[test]
fn a_rational_cylinder_has_its_radius() {
    let request = of_splines(vec![quarter(5., 0.), quarter(5., 4.)], exact());
    let (outcome, found) = developable(&request);
    for radius in [
        outcome.plates[0].diagnostics.min_bend_radius,
        found.bend_radius,
    ] {
        assert!((radius - 5.0).abs() < 5e-3, "{radius}");
    }
}

#[test]
fn a_rational_cone_has_its_radius() {
    let request = of_splines(vec![quarter(4., 0.), quarter(2., 2.)], exact());
    let (outcome, found) = developable(&request);
    // Normal curvature of a cone of half angle 45° at radius 2.
    let expected = 2.0 * SQRT_2;
    let d = &outcome.plates[0].diagnostics;
    assert!(
        (d.min_bend_radius - expected).abs() < 5e-3,
        "{}",
        d.min_bend_radius
    );
    assert!(
        (found.bend_radius - expected).abs() < 0.05,
        "{}",
        found.bend_radius
    );
    // Rulings of this cone are 2·√2 long and it ends at half its height.
    assert!((found.clearance - 1.0).abs() < 0.05, "{found:?}");
}

#[test]
fn a_bend_radius_below_the_least_is_a_fault_with_its_number() {
    let options = Options {
        min_bend_radius: Some(6.0),
        thickness: Some(0.01),
        ..exact()
    };
    let request = of_splines(vec![quarter(5., 0.), quarter(5., 4.)], options);
    let outcome = fitted(&request);
    let plate = &outcome.plates[0];
    assert!(!outcome.within_limits && !plate.within_limits);
    assert!(
        plate.sentence.contains("radius") && plate.sentence.contains('6'),
        "{}",
        plate.sentence
    );
    let strain = plate.diagnostics.bend_strain_percent.unwrap();
    assert!(
        (strain - 0.1).abs() < 1e-3,
        "t / 2R = 0.01 / 10: {strain} %"
    );
}

#[test]
fn two_point_curves_are_enough() {
    let parallel = [
        line([0., 0., 0.], [9., 0., 0.], 2),
        line([0., 2., 1.], [9., 2., 1.], 2),
    ];
    let (_, found) = developable(&request(&parallel, exact()));
    assert!(
        (found.area - 9.0 * 5.0_f64.sqrt()).abs() < 1e-6,
        "{found:?}"
    );
    let mixed = [
        line([0., 0., 0.], [9., 0., 0.], 2),
        along(7, |t| [9. * t, 2., t * t]),
    ];
    sound(
        &request(&mixed, exact()),
        &fitted(&request(&mixed, exact())),
    );
}
