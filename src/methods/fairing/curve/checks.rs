//! What can be wrong with a request, each with its place.

use super::input::{Prepared, degree_of};
use super::request::Request;
use crate::methods::Issue;

/// Coordinates beyond this have no room left for the sixth digit.
const FARTHEST: f64 = 1e12;
fn path(segments: &[&str]) -> Vec<String> {
    segments.iter().map(|s| (*s).to_string()).collect()
}

/// All that is wrong with a request.
pub(super) struct Complaints(pub(super) Vec<Issue>);

impl Complaints {
    /// One more.
    pub(super) fn add(
        &mut self,
        at: &[&str],
        code: &'static str,
        message: String,
        hint: Option<&str>,
    ) {
        self.0.push(Issue {
            path: path(at),
            code,
            message,
            hint: hint.map(Into::into),
        });
    }
}

pub(super) fn check_points(request: &Request, issues: &mut Complaints) {
    if !(2..=3).contains(&request.dimension) {
        let message = format!("the dimension is {}; it must be 2 or 3", request.dimension);
        issues.add(&["input", "dimension"], "out-of-range", message, None);
    }
    if request.points.len() < 2 {
        let message = format!("{} point(s) given; a curve needs two", request.points.len());
        issues.add(&["input", "points"], "too-few-points", message, None);
    }
    for (i, p) in request.points.iter().enumerate() {
        let used = &p.coords.as_slice()[..request.dimension.clamp(2, 3)];
        let at = i.to_string();
        if used.iter().any(|c| !c.is_finite()) {
            let message = format!("point {i} has a coordinate that is not a finite number");
            issues.add(&["input", "points", &at], "not-finite", message, None);
        } else if used.iter().any(|c| c.abs() > FARTHEST) {
            let message = format!("point {i} lies beyond {FARTHEST:e}");
            issues.add(&["input", "points", &at], "out-of-range", message, None);
        }
    }
}

pub(super) fn check_options(request: &Request, issues: &mut Complaints) {
    let o = &request.options;
    let count = request.points.len();
    let hint = Some("give a length in the unit of the points, 0 to pass through them");
    if let Some(t) = o.tolerance
        && !(t >= 0.0 && t.is_finite())
    {
        let message = format!("the tolerance is {t}; it must not be negative");
        issues.add(&["options", "tolerance"], "out-of-range", message, hint);
    }
    let lists = [
        ("tolerances", &o.tolerances, 0.0),
        ("stiffness", &o.stiffness, f64::MIN_POSITIVE),
    ];
    for (name, values, least) in lists {
        if !values.is_empty() && values.len() != count {
            let message = format!("{name} has {} values for {count} points", values.len());
            issues.add(&["options", name], "wrong-count", message, None);
        }
        for (i, v) in values.iter().enumerate() {
            if !(*v >= least && v.is_finite()) {
                let message = format!("the value for point {i} is {v}");
                let hint = Some("tolerances must be ≥ 0, stiffnesses > 0");
                issues.add(
                    &["options", name, &i.to_string()],
                    "out-of-range",
                    message,
                    hint,
                );
            }
        }
    }
    if !o.freedom.iter().take(request.dimension.min(3)).any(|f| *f) {
        let message = "no axis is free: no point may move".to_string();
        let hint = Some("name at least one of the axes x, y, z that the points have");
        issues.add(&["options", "freedom"], "no-freedom", message, hint);
    }
    check_shape_options(request, issues);
}

fn check_shape_options(request: &Request, issues: &mut Complaints) {
    let o = &request.options;
    if let Some(d) = o.degree
        && !(3..=7).contains(&d)
    {
        let message = format!("the degree is {d}; it must lie between 3 and 7");
        issues.add(&["options", "degree"], "out-of-range", message, None);
    }
    let degree = degree_of(o);
    if let Some(n) = o.control_points
        && !(n > degree && n <= MOST_CONTROL_POINTS)
    {
        let message = format!("{n} control points asked with degree {degree}");
        let hint = Some("more than the degree, at most 20,000");
        issues.add(
            &["options", "control_points"],
            "out-of-range",
            message,
            hint,
        );
    }
    if let Some(e) = o.energy {
        let all = [
            ("tension", e.tension),
            ("bending", e.bending),
            ("jerk", e.jerk),
        ];
        for (name, v) in all {
            if !(v >= 0.0 && v.is_finite()) {
                let message = format!("{name} is {v}; it must not be negative");
                issues.add(&["options", "energy", name], "out-of-range", message, None);
            }
        }
        if all.iter().all(|(_, v)| *v == 0.0) {
            let message = "all weights of the energy are 0: every curve would be fair".into();
            issues.add(&["options", "energy"], "no-energy", message, None);
        }
    }
    check_ends(request, issues);
}

fn check_ends(request: &Request, issues: &mut Complaints) {
    let o = &request.options;
    for (k, end) in ["0", "1"].into_iter().enumerate() {
        if let Some(t) = o.end_tangents[k]
            && !(t.iter().all(|c| c.is_finite()) && t.norm() > 0.0)
        {
            let message = "the end tangent must be a finite vector other than 0".to_string();
            issues.add(
                &["options", "end_tangents", end],
                "out-of-range",
                message,
                None,
            );
        }
        if let Some(c) = o.end_curvatures[k]
            && !c.is_finite()
        {
            let message = "the end curvature must be a finite number".to_string();
            issues.add(
                &["options", "end_curvatures", end],
                "out-of-range",
                message,
                None,
            );
        }
    }
}

/// A control net beyond this is a mistake.
const MOST_CONTROL_POINTS: usize = 20_000;

pub(super) fn check_indices(request: &Request, issues: &mut Complaints) {
    let o = &request.options;
    let count = request.points.len();
    let check = |issues: &mut Complaints, at: &[&str], i: usize| {
        if i >= count {
            let message = format!("there is no point {i}; there are {count}, counted from 0");
            issues.add(at, "no-such-point", message, None);
        }
    };
    for (name, list) in [("locked", &o.locked), ("knuckles", &o.knuckles)] {
        for (k, i) in list.iter().enumerate() {
            check(issues, &["options", name, &k.to_string()], *i);
        }
    }
    for (k, [a, b]) in o.straight.iter().enumerate() {
        let at = k.to_string();
        check(issues, &["options", "straight", &at, "0"], *a);
        check(issues, &["options", "straight", &at, "1"], *b);
        if a >= b {
            let message = format!("the straight stretch runs from point {a} to point {b}");
            let hint = Some("name its first point first");
            issues.add(
                &["options", "straight", &at],
                "empty-stretch",
                message,
                hint,
            );
        }
    }
    let needs_order = [
        ("knuckles", o.knuckles.is_empty()),
        ("straight", o.straight.is_empty()),
    ];
    for (name, empty) in needs_order {
        if !request.ordered && !empty {
            let message = format!("{name} need points in their order");
            issues.add(&["options", name], "needs-order", message, None);
        }
    }
}

/// Checks that need the points without repetitions.
pub(super) fn check_kept(request: &Request, prepared: &Prepared, issues: &mut Complaints) {
    let closed = prepared.closed == Some(true);
    if closed && prepared.kept.len() < 3 {
        let message = format!(
            "{} distinct points; a closed curve needs three",
            prepared.kept.len()
        );
        issues.add(&["input", "points"], "too-few-points", message, None);
    }
    for k in 0..2 {
        let end = k.to_string();
        if closed && request.options.end_tangents[k].is_some() {
            let message = "a closed curve has no ends".to_string();
            issues.add(&["options", "end_tangents", &end], "no-ends", message, None);
        }
        if closed && request.options.end_curvatures[k].is_some() {
            let message = "a closed curve has no ends".to_string();
            issues.add(
                &["options", "end_curvatures", &end],
                "no-ends",
                message,
                None,
            );
        }
    }
}
