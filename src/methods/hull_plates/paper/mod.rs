//! The method of Zheng & Bo (2018, "Quasi-developable surface construction
//! based on boundary curve and its application in ship hull design"), kept as
//! the reference that this crate's own solver is measured against.
//!
//! 1. Greedy first rulings between the slightly extended profiles
//!    ([`first_rulings`]); D₁ and D₂ interpolate their ends at the mean of the
//!    two arc-length parameters.
//! 2. L-BFGS on the control points of D₁ and D₂ and one normal for each of the
//!    sampled rulings ([`objective`], [`optimise`]).
//! 3. Data points take the parameters of their feet on D₁ and D₂ and are
//!    interpolated once more ([`data`]): the boundaries pass through the
//!    profiles' points again.
//! 4. With a threshold, points further than that from D₁ or D₂ are replaced by
//!    their feet first, and 2 to 4 are repeated until the plate's twist meets
//!    the limit.
//!
//! Choices that the paper leaves open stand as constants with their reasons.
//!
//! Limits, all of the method: the plate passes the profiles at the data points
//! only, and its boundaries end where the outermost rulings do, on extensions
//! and past the profiles' ends. The threshold decides which points move, not
//! how far: measure the deviation, do not promise it. Nothing keeps the
//! regression curve out of the plate but fairness.

mod data;
mod feet;
mod first_rulings;
mod objective;
mod optimise;

use super::profile::Profile;
use super::twist::twist_angle;
use crate::geometry::bspline::interpolate_at;
use crate::geometry::{BSplineCurve, SplineError};
use crate::methods::{Control, FitError};
use crate::solver::Report;
use nalgebra::Point3;

/// What is asked of the reference solver; lengths in unit scale.
#[derive(Debug, Clone, Copy)]
pub(super) struct Settings<'a> {
    /// Points given on the pair's profiles; fewer than two mean that the
    /// profile is sampled.
    pub(super) given: [&'a [Point3<f64>]; 2],
    /// `None`: boundaries interpolate the data points. Else data points
    /// further than this from the approximating boundaries are moved (the
    /// paper: 4e-4).
    pub(super) threshold: Option<f64>,
    /// Largest twist, radians, at which moving points ends.
    pub(super) twist_limit: f64,
    /// Share of a profile's length by which it may be extended at each end
    /// (the paper: "slightly"; [`EXTENSION`]).
    pub(super) extension: f64,
}

/// Extension for callers without a wish. On the trawler's three plates 5 %
/// gives 3.8°, 2.1°, 16.6° through the points and 7.7° for the last with moved
/// points; without extension the last has 19.5° and 17.2°, with 8 % the first
/// one 17.6°.
pub(super) const EXTENSION: f64 = 0.05;

/// The plate `(1−v) D₁(u) + v D₂(u)`, unit scale.
#[derive(Debug, Clone)]
pub(super) struct PaperPlate {
    /// D₁: cubic, on [0, 1].
    pub(super) first: BSplineCurve,
    /// D₂, on the same knots.
    pub(super) second: BSplineCurve,
    /// L-BFGS iterations of all rounds.
    pub(super) iterations: usize,
    /// The minimisation behind the returned plate.
    pub(super) report: Report,
}

/// Rounds of moving data points. The threshold is halved from round to round:
/// with the same one a second round would move the same points.
const ROUNDS: i32 = 5;
/// Rulings at which the twist of a round's plate is looked at.
const CHECKED_RULINGS: usize = 1001;

/// The paper's plate between two profiles; with a threshold the one of least
/// twist among the rounds.
///
/// # Errors
/// [`FitError::Stopped`] when the control says so, [`FitError::Numerical`]
/// where an interpolation breaks down in the very first round.
pub(super) fn solve(
    profiles: &[Profile],
    pair: [usize; 2],
    settings: &Settings<'_>,
    control: &dyn Control,
) -> Result<PaperPlate, FitError> {
    let pair = pair.map(|k| &profiles[k]);
    let given = [0, 1].map(|k| data::points_of(pair[k], settings.given[k]));
    let mut near = first_boundaries(pair, settings.extension).map_err(broken)?;
    let mut targets = given.clone();
    let (mut best, mut iterations): (Option<(f64, PaperPlate)>, usize) = (None, 0);
    let rounds = if settings.threshold.is_some() {
        ROUNDS
    } else {
        1
    };
    for round in 0..rounds {
        let (approximating, report) = optimise::optimise(&near, &targets, control)?;
        near = approximating;
        iterations += report.iterations;
        if let Some(threshold) = settings.threshold {
            let threshold = threshold * 0.5_f64.powi(round);
            targets = [0, 1].map(|k| data::moved(&near[k], &given[k], threshold));
        }
        let [first, second] = match interpolated(&near, &targets) {
            Ok(both) => both,
            // A later round that breaks down leaves the earlier ones.
            Err(e) if best.is_none() => return Err(broken(e)),
            Err(_) => break,
        };
        let twist = largest_twist(&first, &second);
        if best.as_ref().is_none_or(|(least, _)| twist < *least) {
            best = Some((
                twist,
                PaperPlate {
                    first,
                    second,
                    iterations,
                    report,
                },
            ));
        }
        if twist <= settings.twist_limit {
            break;
        }
    }
    let plate = best.map(|(_, plate)| PaperPlate {
        iterations,
        ..plate
    });
    plate.ok_or_else(|| FitError::Numerical("the paper's solver made no plate".into()))
}

fn broken(e: SplineError) -> FitError {
    FitError::Numerical(format!(
        "the paper's boundary curves could not be interpolated: {e}"
    ))
}

/// D₁ and D₂ through the ends of the greedy rulings.
fn first_boundaries(pair: [&Profile; 2], extension: f64) -> Result<[BSplineCurve; 2], SplineError> {
    let rulings = first_rulings::first_rulings(pair, extension);
    let mean = |r: &first_rulings::Ruling| 0.5 * (r.0 + r.1);
    let (low, high) = (mean(&rulings[0]), mean(&rulings[rulings.len() - 1]));
    let mut parameters: Vec<f64> = rulings
        .iter()
        .map(|r| (mean(r) - low) / (high - low))
        .collect();
    // Exactly the domain's end, whatever the division made of it.
    if let Some(last) = parameters.last_mut() {
        *last = 1.0;
    }
    let ends = |k: usize| -> Vec<Point3<f64>> {
        let fraction = |r: &first_rulings::Ruling| if k == 0 { r.0 } else { r.1 };
        rulings
            .iter()
            .map(|r| first_rulings::extended(pair[k], fraction(r)).0)
            .collect()
    };
    Ok([
        interpolate_at(&parameters, &ends(0), 3)?,
        interpolate_at(&parameters, &ends(1), 3)?,
    ])
}

/// The plate's boundaries through the data points, on common knots.
fn interpolated(
    near: &[BSplineCurve; 2],
    targets: &[Vec<Point3<f64>>; 2],
) -> Result<[BSplineCurve; 2], SplineError> {
    let first = data::through(&near[0], &targets[0])?;
    let second = data::through(&near[1], &targets[1])?;
    data::on_common_knots([first, second])
}

/// Largest |θ| at even parameters, radians.
fn largest_twist(first: &BSplineCurve, second: &BSplineCurve) -> f64 {
    let twist = |i: usize| {
        let u = i as f64 / (CHECKED_RULINGS - 1) as f64;
        let (a, b) = (first.derivatives(u), second.derivatives(u));
        twist_angle(&(b.point - a.point), &a.d1, &b.d1).abs()
    };
    (0..CHECKED_RULINGS).map(twist).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests;
