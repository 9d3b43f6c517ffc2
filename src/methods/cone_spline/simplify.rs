//! Cones become cylinders, and both become planes, where that keeps the limit.

use super::count::lowered;
use super::engine::{Effort, Fitted};
use super::ladder::Ladder;
use super::problem::Freedom;
use super::request::{Classes, Norm};
use crate::solver::Stop;

/// The effort of one attempt.
const ATTEMPT: Effort = Effort {
    iterations: 20,
    reduction: 1e-3,
    smoothing: 0.0,
    allowed: 0.0,
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
            let tried = attempt(ladder, &best, &narrower, norm, limit)?;
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

fn attempt(
    ladder: &Ladder,
    fitted: &Fitted,
    freedom: &Freedom,
    norm: Norm,
    limit: f64,
) -> Result<Fitted, Stop> {
    let mut chain = fitted.chain.clone();
    for (strain, free) in chain.strains.iter_mut().zip(&freedom.strains) {
        strain.g *= f64::from(free[0]);
        strain.k *= f64::from(free[1]);
    }
    let start = Fitted::settle(ladder.sample, &chain, &fitted.homes);
    let squares = start.relaxed(ladder.sample, freedom, ATTEMPT, ladder.control)?;
    if norm == Norm::LeastSquares || squares.max() <= limit {
        return Ok(squares);
    }
    lowered(ladder, &squares, freedom, limit)
}
