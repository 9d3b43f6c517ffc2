//! The best developable surface: a fine chain through the rulings of the
//! target, pulled smooth first and then let go.

use super::chain::{Chain, Part};
use super::engine::{Effort, Fitted, Sample};
use super::problem::Freedom;
use crate::geometry::cone::{Frame, Strain};
use crate::methods::Control;
use crate::solver::Stop;
use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

/// Weights of the pull, one stage each: from a chain that only follows the
/// large shape to a free one. Which way leads down farthest differs from strip
/// to strip.
const PULLS: [&[f64]; 3] = [
    &[1e-6, 1e-7, 1e-8, 1e-9, 1e-10, LEAST_PULL],
    &[1e-8, 1e-9, 1e-10, LEAST_PULL],
    &[1e-10, LEAST_PULL],
];
/// What is left of the pull: it keeps a fine chain on a strip that is not
/// developable from turning to and fro.
const LEAST_PULL: f64 = 1e-11;
/// A stage.
const STAGE: Effort = Effort {
    iterations: 15,
    reduction: 1e-2,
    smoothing: 0.0,
    allowed: 0.0,
    power: None,
    slowest: None,
};
/// The last stage.
pub(super) const LAST: Effort = Effort {
    smoothing: LEAST_PULL,
    ..STAGE
};

/// A chain with one patch between each two neighbouring rulings, from frames
/// estimated there. It need not be near the rulings far from its middle.
pub(super) fn chain_through(rulings: &[[Point3<f64>; 2]]) -> Option<Chain> {
    let frames = frames(rulings)?;
    let parts: Vec<Part> = frames.windows(2).map(|w| between(&w[0], &w[1])).collect();
    Some(Chain::link(&parts))
}

/// A frame in the middle of each ruling.
fn frames(rulings: &[[Point3<f64>; 2]]) -> Option<Vec<Frame>> {
    let middles: Vec<_> = rulings
        .iter()
        .map(|[a, b]| nalgebra::center(a, b))
        .collect();
    let last = rulings.len() - 1;
    let frame = |i: usize| {
        let ruling = rulings[i][1] - rulings[i][0];
        let ahead: Vector3<f64> = middles[(i + 1).min(last)] - middles[i.saturating_sub(1)];
        Frame::new(middles[i], ruling, ruling.cross(&ahead))
    };
    (0..=last).map(frame).collect()
}

/// The patch that best carries one frame into the next.
pub(super) fn between(a: &Frame, b: &Frame) -> Part {
    let t = 0.5 * (a.tangent() + b.tangent());
    let way = b.point - a.point;
    let length = way.dot(&t).max(f64::MIN_POSITIVE);
    let along = way.dot(&(a.ruling + b.ruling)) / 2.0;
    Part {
        frame: *a,
        strain: Strain {
            g: (b.ruling - a.ruling).dot(&t) / length,
            k: (a.normal - b.normal).dot(&t) / length,
        },
        arc: [0.0, length],
        base: 0.0,
        shared: [0.0, along],
    }
}

/// Fits the fine chain to a sample whose points start on given patches.
///
/// # Errors
/// When the control says so.
pub(super) fn floor(
    sample: &Sample,
    start: &Chain,
    homes: &[u32],
    control: &dyn Control,
) -> Result<Fitted, Stop> {
    let freedom = Freedom {
        joints: false,
        ..Freedom::full(start.len())
    };
    let settled = Fitted::settle(sample, start, homes);
    let pulled = |pulls: &&[f64]| {
        pulls.iter().try_fold(settled.clone(), |fitted, smoothing| {
            let effort = Effort {
                smoothing: *smoothing,
                ..STAGE
            };
            fitted.relaxed(sample, &freedom, effort, control)
        })
    };
    let all = PULLS
        .par_iter()
        .map(pulled)
        .collect::<Result<Vec<_>, Stop>>()?;
    // A fine chain may have patches without points.
    let order = |f: &Fitted| (f.holds_an_apex(), f.rms(sample));
    let better = |a: &Fitted, b: &Fitted| {
        let (a, b) = (order(a), order(b));
        a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
    };
    let mut best = all.into_iter().min_by(better).unwrap_or(settled);
    while let Some(long) = overlong(&best.chain) {
        best = best.split(sample, long);
    }
    // Where the rulings were guessed badly, joints that stand still hold the
    // chain back.
    let free = Freedom::full(best.chain.len());
    let loose = best.relaxed(sample, &free, LAST, control)?;
    Ok(std::cmp::min_by(best, loose, better))
}

/// A patch that is much longer than they are on average: an end that took what
/// the others left.
fn overlong(chain: &Chain) -> Option<usize> {
    /// So much longer.
    const OVERLONG: f64 = 2.0;
    /// Of so many patches at most.
    const MOST: usize = 60;
    let length = |i: usize| chain.reach[i][1] - chain.reach[i][0];
    let mean = (0..chain.len()).map(length).sum::<f64>() / chain.len() as f64;
    let longest = (0..chain.len()).max_by(|a, b| length(*a).total_cmp(&length(*b)))?;
    (length(longest) > OVERLONG * mean && chain.len() < MOST).then_some(longest)
}
