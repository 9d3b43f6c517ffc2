//! A strip as few cones of revolution, cylinders and planes, joined with one
//! tangent plane.
//!
//! # The job
//! A plate roll makes cones and cylinders. Given a strip (a mesh or a ruled
//! surface), find the fewest patches that stay within a tolerance of it, joined
//! G¹, and all that a workshop needs to roll them.
//!
//! # Formulas
//! A frame travels along the strip: point p, ruling r, normal n, t = n × r, with
//! constant strain (g, k) on each patch:
//!
//! p′ = t, r′ = g t, t′ = −g r + k n, n′ = −k t.
//!
//! The rulings p + λ r then sweep a cone of revolution; with g = 0 a cylinder,
//! with k = 0 a plane; where k changes its sign a ruling is a reflection line.
//! A spline of K patches is a frame and (gᵢ, kᵢ, sᵢ):
//!
//! Fᵢ₊₁ = Fᵢ · exp(sᵢ ξᵢ) · slide(dᵢ),
//!
//! dᵢ a fixed slide along the ruling that keeps p on the strip. Every G¹ cone
//! spline is such a chain: 3K + 3 unknowns, joins exact to rounding.
//!
//! Residuals are the distances of the strip's vertices, weighted by area, in
//! closed form with closed derivatives (`geometry::cone`).
//!
//! # What was changed against the paper, and why
//! * The paper fits a B-spline ruled surface with penalties for being conical,
//!   then stitches cones by rigid motions, which drifts. Here every chain that
//!   is looked at is a cone spline, so nothing is left to stitch.
//! * Its K-means on axes finds patches that look alike, not patches that fit,
//!   and knows no planes. Here dynamic programming over the cost of every
//!   interval finds the best division for every number of patches at once.
//! * The largest distance is made least too, by a bisection over what is
//!   allowed (`minimax`), or nearly, by eighth powers of the distances.
//! * A chain counts only if the area that the strip takes up on it is that of
//!   the strip, and no ruling of a joint passes an apex; the returned cones are
//!   measured, and joins of more than 1e-10 are not handed out.
//! * The number of patches follows from a tolerance, or from the noise.
//!
//! The paper's own way is kept (`paper`) to be measured against.
//!
//! # Limits
//! * With too few patches for its shape a strip may lead to no chain that can
//!   be rolled, which is then said.
//! * Cones whose apex is 1e5 strip lengths away, and cylinders of such a
//!   radius, are made cylinders and planes: written by that apex they would
//!   lose more digits than joins of 1e-10 allow.
//! * The floor is the best of the fits made, no proven bound; strips of more
//!   than some thousand vertices are divided on a part of them.
//! * The error curve is by least squares, whatever norm the answer is for.
//!
//! # Sources
//! Zhang, Bo, Zheng & Zhang, *Cone spline surface fitting* (in Chinese); Chen,
//! Lee, Leopoldseder, Pottmann, Randrup & Wallner 1999 (GMIP 61); Leopoldseder
//! & Pottmann 1998.

mod chain;
mod count;
mod distances;
mod engine;
mod fit;
#[cfg(test)]
mod fit_tests;
mod floor;
mod ladder;
mod minimax;
pub mod outcome;
#[cfg(test)]
mod page_tests;
mod paper;
mod problem;
mod report;
pub mod request;
mod robust;
mod segments;
mod sheet;
mod simplify;
mod strip;
pub mod target;

pub use outcome::Outcome;
pub use request::Request;

use super::{Control, FitError, Issue};
use request::{Goal, MOST_PIECES, Solver};
use target::Target;

/// Fits patches to a strip.
///
/// # Errors
/// [`FitError::Invalid`] where the input is no strip or an option breaks a
/// rule, [`FitError::Stopped`] when the control says so, [`FitError::Numerical`]
/// where nothing that could be rolled comes near the strip.
pub fn fit(request: &Request, control: &dyn Control) -> Result<Outcome, FitError> {
    control.progress("reading", 0.0);
    let issues = check_options(request);
    if !issues.is_empty() {
        return Err(FitError::Invalid(issues));
    }
    let target = Target::of(request, control)?;
    let outcome = match (request.options.solver, request.options.goal) {
        (Solver::Paper, Goal::Pieces(pieces)) => {
            paper::fit_target(request, pieces, &target, control)?
        }
        _ => fit::fit_target(request, &target, control)?,
    };
    control.progress("done", 100.0);
    Ok(outcome)
}

/// Every issue of a request; none: it can be fitted.
#[must_use]
pub fn validate(request: &Request) -> Vec<Issue> {
    let mut issues = check_options(request);
    if let Err(FitError::Invalid(more)) = Target::of(request, &crate::solver::Unwatched) {
        issues.extend(more);
    }
    issues
}

/// Rules that options break.
fn check_options(request: &Request) -> Vec<Issue> {
    let options = &request.options;
    let issue = |name: &str, code: &'static str, message: String, hint: &str| Issue {
        path: vec!["options".to_owned(), name.to_owned()],
        code,
        message,
        hint: Some(hint.to_owned()),
    };
    let mut issues = Vec::new();
    match options.goal {
        Goal::Pieces(pieces) if !(1..=MOST_PIECES).contains(&pieces) => issues.push(issue(
            "pieces",
            "pieces-out-of-range",
            format!("{pieces} patches were asked for."),
            &format!("Ask for 1 to {MOST_PIECES}."),
        )),
        Goal::Tolerance(tolerance) if !is_length(tolerance) => issues.push(issue(
            "tolerance",
            "not-a-length",
            format!("The tolerance is {tolerance}."),
            "Give a length above 0, in the unit of the strip.",
        )),
        _ => {}
    }
    for (name, value) in [
        ("thickness", options.thickness),
        ("min_bend_radius", options.min_bend_radius),
    ] {
        if let Some(value) = value.filter(|v| !is_length(*v)) {
            issues.push(issue(
                name,
                "not-a-length",
                format!("The value is {value}."),
                "Give a length above 0, in the unit of the strip.",
            ));
        }
    }
    let classes = options.classes;
    if !(classes.cones || classes.cylinders || classes.planes) {
        issues.push(issue(
            "classes",
            "no-class",
            "No kind of patch is allowed.".to_owned(),
            "Allow cones, cylinders or planes.",
        ));
    }
    if options.solver == Solver::Paper {
        issues.extend(paper::check_options(options));
    }
    issues
}

fn is_length(value: f64) -> bool {
    value.is_finite() && value > 0.0
}
