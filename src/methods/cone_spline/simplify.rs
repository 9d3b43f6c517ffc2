//! Cones become cylinders, and both become planes, where that keeps the limit.

use super::engine::{Effort, Fitted, Sample};
use super::ladder::Ladder;
use super::minimax::{ROUNDS, eighth_powers, minimax};
use super::problem::Freedom;
use super::request::{Classes, Norm};
use crate::geometry::cone::Strain;
use crate::methods::Control;
use crate::solver::Stop;

/// The effort of one attempt.
const ATTEMPT: Effort = Effort {
    iterations: 20,
    reduction: 1e-3,
    smoothing: 0.0,
    allowed: 0.0,
    power: None,
    slowest: None,
};

/// Which of g and k a simpler kind keeps, the simplest first.
const PLANE: [bool; 2] = [true, false];
const CYLINDER: [bool; 2] = [false, true];

/// The chain with as many simple patches as keep all distances within `limit`.
///
/// # Errors
/// When the control says so.
pub(super) fn simplified(
    ladder: &Ladder,
    fitted: Fitted,
    (classes, norm): (Classes, Norm),
    limit: f64,
) -> Result<Fitted, Stop> {
    let mut freedom = ladder.freedom(fitted.chain.len());
    let mut best = fitted;
    for (kind, allowed) in [(PLANE, classes.planes), (CYLINDER, classes.cylinders)] {
        for patch in by_harm(&best, kind) {
            let simple = freedom.strains[patch] != [true, true];
            if !allowed || simple {
                continue;
            }
            let mut narrower = freedom.clone();
            narrower.strains[patch] = kind;
            let shape = (ladder.sample, &narrower);
            let tried = attempt(&best, shape, norm, limit, ladder.control)?;
            if tried.max() <= limit && tried.worth(ladder.sample).is_finite() {
                (best, freedom) = (tried, narrower);
            }
        }
    }
    Ok(best)
}

/// Patches by what losing the g or the k moves on them, least first.
fn by_harm(fitted: &Fitted, kind: [bool; 2]) -> Vec<usize> {
    let harm = |i: &usize| {
        let (strain, [low, high]) = (fitted.chain.strains[*i], fitted.chain.reach[*i]);
        let length = high - low;
        if kind == PLANE {
            strain.k.abs() * length * length
        } else {
            strain.g.abs() * length
        }
    };
    let mut order: Vec<usize> = (0..fitted.chain.len()).collect();
    order.sort_by(|a, b| harm(a).total_cmp(&harm(b)));
    order
}

/// The chain without cones whose apex, or cylinders whose axis, is so far away
/// that writing them by it would cost more digits than a yard sees: those are
/// made cylinders and planes, and the chain fitted again.
///
/// # Errors
/// When the control says so.
pub(super) fn near(
    fitted: Fitted,
    (sample, free): (&Sample, [bool; 2]),
    (classes, norm): (Classes, Norm),
    limit: f64,
    control: &dyn Control,
) -> Result<Fitted, Stop> {
    let kind = |strain: &Strain| {
        let [cone, bent] = [strain.g, strain.k].map(|v| v.abs() >= FARTHEST);
        if !cone && !bent && classes.planes {
            [false, false]
        } else if !cone && classes.cylinders {
            [false, free[1] && strain.k != 0.0]
        } else {
            [free[0] && strain.g != 0.0, free[1] && strain.k != 0.0]
        }
    };
    let freedom = Freedom {
        strains: fitted.chain.strains.iter().map(kind).collect(),
        joints: true,
    };
    let values = |s: &Strain| [s.g, s.k];
    let lost = |(strain, free): (&Strain, &[bool; 2])| {
        (values(strain).iter().zip(free)).any(|(v, free)| *v != 0.0 && !free)
    };
    let mut pairs = fitted.chain.strains.iter().zip(&freedom.strains);
    if !pairs.any(lost) {
        return Ok(fitted);
    }
    let moved = attempt(&fitted, (sample, &freedom), norm, limit, control)?;
    // Where nothing that can be rolled is left, digits are the lesser loss.
    Ok(if moved.worth(sample).is_finite() {
        moved
    } else {
        fitted
    })
}

/// The cylinder or plane that a cone with a far apex is taken for.
pub(super) fn without_far_apex(strain: Strain) -> Strain {
    let [cone, bent] = [strain.g, strain.k].map(|v| v.abs() >= FARTHEST);
    Strain {
        g: if cone { strain.g } else { 0.0 },
        k: if cone || bent { strain.k } else { 0.0 },
    }
}

/// Curvatures, in the unit of the fit, below which an apex or an axis is far
/// away: of coordinates 1e5 times the strip, rounding takes 1e-11 of it.
const FARTHEST: f64 = 1e-5;

fn attempt(
    fitted: &Fitted,
    (sample, freedom): (&Sample, &Freedom),
    norm: Norm,
    limit: f64,
    control: &dyn Control,
) -> Result<Fitted, Stop> {
    let mut chain = fitted.chain.clone();
    for (strain, free) in chain.strains.iter_mut().zip(&freedom.strains) {
        strain.g *= f64::from(free[0]);
        strain.k *= f64::from(free[1]);
    }
    let start = Fitted::settle(sample, &chain, &fitted.homes);
    let squares = start.relaxed(sample, freedom, ATTEMPT, control)?;
    if squares.max() <= limit {
        return Ok(squares);
    }
    let shape = (sample, freedom);
    match norm {
        Norm::LeastSquares => Ok(squares),
        Norm::EighthPowers => eighth_powers(&squares, shape, control),
        Norm::Minimax => minimax(&squares, shape, (limit, ROUNDS), control),
    }
}
