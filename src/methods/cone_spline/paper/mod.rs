//! The method of Zhang, Bo, Zheng & Zhang (*Cone spline surface fitting*, in
//! Chinese), kept as the reference that this crate's own solver is measured
//! against.
//!
//! 1. A developable B-spline ruled surface near the strip ([`ruled`]): through
//!    the rulings of a fine chain, the smoothest that is about as good as the
//!    own solver's floor (the paper takes it from elsewhere).
//! 2. The axes of the osculating cones of its rulings ([`axes`]), gathered by
//!    K-means into as many regions as asked ([`clusters`]), each with a cone
//!    ([`cone`]).
//! 3. L-BFGS on control points and cones, the surface near the strip and each
//!    region near its cone, with growing weights ([`objective`],
//!    [`constraint`], [`optimise`]).
//! 4. Rigid motions of the exact cones into a chain ([`stitch`]), which is
//!    then moved as a whole to where it lies best: stitching gathers errors.
//!
//! Choices that the paper leaves open, and what of its text was mended, stand
//! with their reasons where they are made.
//!
//! # Limits, all of the method
//! It needs the number of patches. It has no planes (a flat region becomes a
//! wide cone) and no cylinders of its own. The regions are found once, by
//! likeness of axes and above all by place, and their joints do not move
//! afterwards. A surface that is conical to 10⁻⁵ only is not the chain that
//! its cones make: what the stitching adds is measured, not minimised.

mod axes;
mod clusters;
mod cone;
mod constraint;
mod feet;
mod objective;
mod optimise;
mod ruled;
mod stitch;
#[cfg(test)]
mod tests;

use super::distances;
use super::engine::{Effort, Fitted};
use super::fit::can_be_rolled;
use super::floor::floor;
use super::outcome::{ErrorPoint, Floor, Outcome, Report};
use super::problem::Freedom;
use super::report;
use super::request::{Classes, Goal, Norm, Options, Request};
use super::sheet;
use super::simplify::without_far_apex;
use super::strip::{Strip, oriented};
use super::target::Target;
use crate::methods::{Control, FitError, Issue};
use crate::solver::Stop;
use cone::Cone;
use nalgebra::Point3;
use objective::Data;
use optimise::{failed, optimise};
use ruled::Ruled;

/// Rulings whose axes are looked at, for each region.
const AXES: usize = 40;
/// Pulls that make the fine chain smooth (see [`floor`]), the strongest first.
const PULLS: [f64; 5] = [1e-6, 1e-7, 1e-8, 1e-9, 1e-10];
/// The smooth chain's root mean square against the fine one's, and what may be
/// added in the unit of the fit: axes follow from second derivatives, and a
/// chain that follows noise has none to rely on.
const WORSE: f64 = 1.1;
const SMALL: f64 = 1e-4;
/// Points of the strip's outline at most, each side.
const MOST_ON_A_SIDE: usize = 1000;

/// What the paper's method cannot do of what is asked.
pub(super) fn check_options(options: &Options) -> Vec<Issue> {
    let issue = |name: &str, code: &'static str, message: &str, hint: &str| Issue {
        path: vec!["options".to_owned(), name.to_owned()],
        code,
        message: message.to_owned(),
        hint: Some(hint.to_owned()),
    };
    let mut issues = Vec::new();
    let count = "the paper's solver needs the number of patches";
    match options.goal {
        Goal::Pieces(_) => {}
        Goal::Tolerance(_) => {
            let hint = "give \"pieces\" instead, or take the solver \"own\"";
            issues.push(issue("tolerance", "unexpected", count, hint));
        }
        Goal::Noise => {
            let hint = "give \"pieces\", or take the solver \"own\"";
            issues.push(issue("pieces", "missing", count, hint));
        }
    }
    let refused = [
        (
            options.norm == Some(Norm::Minimax),
            "norm",
            "the paper's solver minimises squares",
        ),
        (
            options.classes != Classes::default(),
            "classes",
            "the paper's solver cannot choose the kinds of its patches",
        ),
        (
            options.simplify,
            "simplify",
            "the paper's solver does not simplify",
        ),
        (
            options.robust,
            "robust",
            "the paper's solver counts every vertex in full",
        ),
    ];
    let hint = "leave it out, or take the solver \"own\"";
    issues.extend(
        (refused.iter().filter(|(asked, ..)| *asked))
            .map(|(_, name, message)| issue(name, "unexpected", message, hint)),
    );
    issues
}

/// Fits so many patches to a strip that is made ready.
///
/// # Errors
/// [`FitError::Stopped`] when the control says so, [`FitError::Numerical`]
/// where the rulings of the target span no strip or the cones found do not
/// make one.
pub(super) fn fit_target(
    request: &Request,
    pieces: usize,
    target: &Target,
    control: &dyn Control,
) -> Result<Outcome, FitError> {
    let target = oriented(target);
    let strip = Strip::new(&target)
        .ok_or_else(|| FitError::Numerical("the rulings span no strip".to_owned()))?;
    control.progress("developing", 10.0);
    let fine = floor(&strip.sample, &strip.start, &strip.sample_homes, control)?;
    let unit = in_unit(&target, &strip);
    let smooth = smoothest(&strip, &fine, control)?;
    let surface = Ruled::through(&rulings(&target, &strip, &smooth)).map_err(failed)?;
    control.progress("dividing", 20.0);
    let axes = axes::along(&surface, AXES * pieces);
    let starts = clusters::regions(&axes, pieces);
    let cones: Vec<Cone> = (starts.windows(2))
        .map(|w| Cone::near(&axes[w[0]..w[1]], &surface))
        .collect();
    let count = axes.len() as f64;
    let breaks: Vec<f64> = starts.iter().map(|i| *i as f64 / count).collect();
    let surface = surface.with_regions(&breaks).map_err(failed)?;
    control.progress("fitting", 40.0);
    let points = strip.sample.points.len() as f64;
    let weights: Vec<f64> = strip.sample.weights.iter().map(|w| w * points).collect();
    let data = Data {
        points: &strip.sample.points,
        weights: &weights,
        sides: unit.sides.each_ref().map(Vec::as_slice),
        ends: unit.ends.each_ref().map(Vec::as_slice),
    };
    let found = optimise((&surface, &cones), &breaks, data, control)?;
    control.progress("measuring", 90.0);
    let none = || {
        FitError::Numerical(format!(
            "the paper's solver found no {pieces} cones that could be rolled; ask for another \
             number of patches, or take the solver \"own\""
        ))
    };
    let mut chain = stitch::stitched(&found.surface, &found.cones, &breaks).ok_or_else(none)?;
    // Its cones of flat and of cylindrical regions have their apices anywhere.
    for strain in &mut chain.strains {
        *strain = without_far_apex(*strain);
    }
    let rigid = Freedom {
        strains: vec![[false; 2]; pieces],
        joints: false,
    };
    let stitched = Fitted::settle_anew(&strip.sample, &chain);
    let moved = stitched.relaxed(&strip.sample, &rigid, Effort::FULL, control)?;
    let length = 1.0 / strip.scale;
    let figures = |f: &Fitted| strip.sample.figures(&f.distances).map(|d| d * length);
    let ([max, mean, rms], [least, middle, root]) = (figures(&moved), figures(&fine));
    let outcome = report::outcome(
        request,
        &target,
        report::Fitted {
            chain: strip.restored(&moved.chain),
            error_curve: vec![ErrorPoint {
                patches: pieces,
                max,
                mean,
                rms,
            }],
            floor: Floor {
                max: least.min(max),
                mean: middle.min(mean),
                rms: root.min(rms),
                patches: fine.chain.len(),
            },
            reachable: true,
            report: Report {
                pieces_from: "asked",
                norm: "least_squares",
                noise: None,
                outliers: Vec::new(),
                iterations: found.iterations,
                termination: found.termination,
            },
        },
    );
    let mut outcome = match outcome {
        Ok(outcome) if can_be_rolled(&outcome) => outcome,
        Ok(_) | Err(FitError::Numerical(_)) => return Err(none()),
        Err(other) => return Err(other),
    };
    if !found.is_conical() {
        outcome.warnings.push(format!(
            "The paper's solver ended with {:.0e} left of its constraints, not below 1e-5: its \
             regions are not yet cones, and stitching moved them.",
            found.broken
        ));
    }
    Ok(outcome)
}

/// The fine chain as smooth as may be without becoming worse than it is.
fn smoothest(strip: &Strip, fine: &Fitted, control: &dyn Control) -> Result<Fitted, Stop> {
    let freedom = Freedom {
        joints: false,
        ..Freedom::full(fine.chain.len())
    };
    let enough = WORSE * fine.rms(&strip.sample) + SMALL;
    for smoothing in PULLS {
        let effort = Effort {
            smoothing,
            ..Effort::FULL
        };
        let smooth = fine.relaxed(&strip.sample, &freedom, effort, control)?;
        if smooth.worth(&strip.sample) <= enough {
            return Ok(smooth);
        }
    }
    Ok(fine.clone())
}

/// The outline of a target in the unit of the fit.
struct InUnit {
    sides: [Vec<Point3<f64>>; 2],
    ends: [Vec<Point3<f64>>; 2],
}

fn in_unit(target: &Target, strip: &Strip) -> InUnit {
    let unit = |list: &Vec<Point3<f64>>| {
        let step = list.len().div_ceil(MOST_ON_A_SIDE).max(1);
        list.iter()
            .step_by(step)
            .map(|p| strip.in_unit(p))
            .collect()
    };
    InUnit {
        sides: target.sides.each_ref().map(unit),
        ends: target.ends.each_ref().map(unit),
    }
}

/// The rulings of the fine chain between the sides of the strip or, where it
/// cannot be cut there, those that the target came with.
fn rulings(target: &Target, strip: &Strip, fine: &Fitted) -> Vec<[Point3<f64>; 2]> {
    let chain = strip.restored(&fine.chain);
    let homes = distances::homes(&chain, &target.points);
    let fits = distances::fits(&homes, &target.weights, chain.len());
    let cut: Vec<[Point3<f64>; 2]> = match sheet::sheets(&chain, target, &fits, None) {
        Ok(sheets) => sheets.rulings.iter().map(|r| [r.from, r.to]).collect(),
        Err(_) => target.rulings.clone(),
    };
    cut.iter().map(|r| r.map(|p| strip.in_unit(&p))).collect()
}
