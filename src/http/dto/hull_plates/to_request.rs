//! From the job of `hull_plates` on the wire to
//! [`methods::hull_plates::Request`](crate::methods::hull_plates::Request).
//!
//! Bounds of single values are in the schema and checked there; this module
//! checks what needs two values at once (the unit and a coordinate, knots and
//! degree, a pin and the number of plates), each with its JSON pointer.

use super::super::curves::{Spline, check_points};
use super::super::job::Units;
use super::{
    BoundaryMode, BoundaryOption, EndsOption, HullPlatesInput, HullPlatesOptions,
    PinnedRulingOption, ProfileCurve, SolverOption,
};
use crate::geometry::BSplineCurve;
use crate::http::problem::FieldError;
use crate::http::strict_json::MAX_POINTS;
use crate::methods::hull_plates::request::{
    Boundary, Ends, Options, PinnedRuling, Profile, ProfileShape, Request, Solver,
};
use nalgebra::Point3;

/// The method's request out of a job's input and options.
///
/// # Errors
/// Every rule that is broken, with its JSON pointer into the job.
pub fn to_request(
    input: &HullPlatesInput,
    options: &HullPlatesOptions,
    units: Units,
) -> Result<Request, Vec<FieldError>> {
    let mut faults = Vec::new();
    check_point_count(input, &mut faults);
    let profiles: Vec<Profile> = (input.profiles.iter().enumerate())
        .filter_map(|(i, p)| profile(p, &format!("/input/profiles/{i}"), units, &mut faults))
        .collect();
    let options = to_options(options, input.profiles.len(), units, &mut faults);
    if faults.is_empty() {
        Ok(Request { profiles, options })
    } else {
        Err(faults)
    }
}

fn check_point_count(input: &HullPlatesInput, faults: &mut Vec<FieldError>) {
    let count = |p: &ProfileCurve| {
        p.points.as_ref().map_or(0, Vec::len)
            + p.bspline.as_ref().map_or(0, |s| s.control_points.len())
    };
    let total: usize = input.profiles.iter().map(count).sum();
    if total > MAX_POINTS {
        let message = format!("the profiles have {total} points, at most {MAX_POINTS} are taken");
        faults.push(FieldError::new("/input/profiles", "too-many", message));
    }
}

fn profile(
    given: &ProfileCurve,
    at: &str,
    units: Units,
    faults: &mut Vec<FieldError>,
) -> Option<Profile> {
    let shape = match (&given.points, &given.bspline) {
        (Some(points), None) => {
            check_points(points, &format!("{at}/points"), units, faults);
            ProfileShape::Points(points.iter().map(|p| (*p).into()).collect())
        }
        (None, Some(spline)) => ProfileShape::BSpline(spline_curve(
            spline,
            &format!("{at}/bspline"),
            units,
            faults,
        )?),
        (Some(_), Some(_)) => {
            let message = "a profile has either \"points\" or \"bspline\", this one has both";
            faults.push(FieldError::new(at, "ambiguous", message));
            return None;
        }
        (None, None) => {
            let message = "a profile needs \"points\" or \"bspline\"";
            faults.push(FieldError::new(at, "missing", message));
            return None;
        }
    };
    Some(Profile {
        name: given.name.clone(),
        shape,
    })
}

/// Checks counts and order with pointers of their own; what remains is said by
/// the constructor.
fn spline_curve(
    spline: &Spline,
    at: &str,
    units: Units,
    faults: &mut Vec<FieldError>,
) -> Option<BSplineCurve> {
    let before = faults.len();
    check_points(
        &spline.control_points,
        &format!("{at}/control_points"),
        units,
        faults,
    );
    let (n, degree) = (spline.control_points.len(), spline.degree);
    if spline.knots.len() != n + degree + 1 {
        let message = format!(
            "{n} control points of degree {degree} need {} knots, there are {}",
            n + degree + 1,
            spline.knots.len()
        );
        faults.push(FieldError::new(
            format!("{at}/knots"),
            "wrong-count",
            message,
        ));
    }
    if let Some(i) = spline.knots.windows(2).position(|k| k[0] > k[1]) {
        let message = format!(
            "knots must not decrease: {} > {}",
            spline.knots[i],
            spline.knots[i + 1]
        );
        faults.push(FieldError::new(
            format!("{at}/knots/{}", i + 1),
            "not-sorted",
            message,
        ));
    }
    if let Some(weights) = &spline.weights {
        check_weights(weights, n, at, faults);
    }
    if faults.len() > before {
        return None;
    }
    let points: Vec<Point3<f64>> = spline.control_points.iter().map(|p| (*p).into()).collect();
    match BSplineCurve::new(degree, spline.knots.clone(), points, spline.weights.clone()) {
        Ok(curve) => Some(curve),
        Err(error) => {
            faults.push(FieldError::new(at, "invalid-spline", error.to_string()));
            None
        }
    }
}

fn check_weights(weights: &[f64], n: usize, at: &str, faults: &mut Vec<FieldError>) {
    let at = format!("{at}/weights");
    if weights.len() != n {
        let message = format!(
            "{n} control points need {n} weights, there are {}",
            weights.len()
        );
        faults.push(FieldError::new(at.clone(), "wrong-count", message));
    }
    if let Some(i) = weights.iter().position(|w| *w <= 0.0) {
        let message = format!("weights must be greater than 0, this one is {}", weights[i]);
        faults.push(FieldError::new(
            format!("{at}/{i}"),
            "out-of-range",
            message,
        ));
    }
}

fn to_options(
    given: &HullPlatesOptions,
    profiles: usize,
    units: Units,
    faults: &mut Vec<FieldError>,
) -> Options {
    Options {
        boundary: boundary(given.boundary, faults),
        max_twist_deg: given.max_twist_deg,
        thickness: given.thickness,
        min_bend_radius: given.min_bend_radius,
        pinned_rulings: pins(&given.pinned_rulings, profiles, units, faults),
        ends: match given.ends {
            EndsOption::Fan => Ends::Fan,
            EndsOption::Extend => Ends::Extend,
        },
        max_fan_percent: given.max_fan_percent,
        max_extension_percent: given.max_extension_percent,
        min_clearance_percent: given.min_clearance_percent,
        solver: match given.solver {
            SolverOption::Own => Solver::Own,
            SolverOption::Paper => Solver::Paper,
        },
    }
}

fn boundary(given: BoundaryOption, faults: &mut Vec<FieldError>) -> Boundary {
    let at = "/options/boundary/value";
    match (given.mode, given.value) {
        (BoundaryMode::Tolerance, Some(length)) => Boundary::Tolerance(length),
        (BoundaryMode::Tolerance, None) => {
            let message = "the mode \"tolerance\" needs a \"value\", a length in the job's unit";
            faults.push(FieldError::new(at, "missing", message));
            Boundary::Exact
        }
        (mode, value) => {
            if value.is_some() {
                let message = "a \"value\" goes with the mode \"tolerance\" only";
                faults.push(FieldError::new(at, "unexpected", message));
            }
            if mode == BoundaryMode::Exact {
                Boundary::Exact
            } else {
                Boundary::Auto
            }
        }
    }
}

fn pins(
    given: &[PinnedRulingOption],
    profiles: usize,
    units: Units,
    faults: &mut Vec<FieldError>,
) -> Vec<PinnedRuling> {
    let plates = profiles.saturating_sub(1);
    for (i, pin) in given.iter().enumerate() {
        let at = format!("/options/pinned_rulings/{i}");
        if pin.plate >= plates {
            let message = format!(
                "there is no plate {}; plates are 0 to {}",
                pin.plate,
                plates.saturating_sub(1)
            );
            faults.push(FieldError::new(
                format!("{at}/plate"),
                "out-of-range",
                message,
            ));
        }
        for (name, point) in [("from", pin.from), ("to", pin.to)] {
            let mut inner = Vec::new();
            check_points(&[point], &at, units, &mut inner);
            faults.extend(inner.into_iter().map(|mut fault| {
                fault.pointer =
                    fault
                        .pointer
                        .replacen(&format!("{at}/0/"), &format!("{at}/{name}/"), 1);
                fault
            }));
        }
    }
    given
        .iter()
        .map(|pin| PinnedRuling {
            plate: pin.plate,
            from: pin.from.into(),
            to: pin.to.into(),
        })
        .collect()
}
