//! How many patches: as few as a tolerance asks for, or as many as the noise
//! lets one tell apart.

use super::engine::{Effort, Fitted};
use super::ladder::Ladder;
use super::minimax::minimax;
use super::problem::Freedom;
use super::request::Norm;
use super::segments::Aim;
use crate::solver::Stop;

/// Patches whose joints need not meet come so much nearer than a chain.
const SLACK: f64 = 1.3;
/// A patch more that gains less than this share is not worth it …
const GAIN: f64 = 0.03;
/// … so many times in a row.
const PATIENCE: usize = 3;
/// Differences below this share of the longest side are of no use to a yard:
/// with less noise than that no patch is added.
const USELESS: f64 = 1e-4;

/// The chain that was chosen.
#[derive(Debug, Clone)]
pub(super) struct Choice {
    pub(super) fitted: Fitted,
    /// Whether the tolerance is kept or could be.
    pub(super) reachable: bool,
}

/// The best chain of so many patches in a norm; the search for the least
/// largest distance ends at `enough`.
///
/// # Errors
/// When the control says so.
pub(super) fn best(
    ladder: &mut Ladder,
    patches: usize,
    norm: Norm,
    enough: f64,
) -> Result<Fitted, Stop> {
    let rung = ladder.rung(patches)?;
    if norm == Norm::LeastSquares || rung.fitted.max() <= enough {
        return Ok(rung.fitted);
    }
    // The largest distance cannot fall below the least root mean square.
    if enough > 0.0 && rung.fitted.rms(ladder.sample) > enough {
        return Ok(rung.fitted);
    }
    let freedom = ladder.freedom(patches);
    let mut best = lowered(ladder, &rung.fitted, &freedom, enough)?;
    if let Some(other) = rung.other.filter(|_| best.max() > enough) {
        let lowered = lowered(ladder, &other, &freedom, enough)?;
        if lowered.max() < best.max() && lowered.worth(ladder.sample).is_finite() {
            best = lowered;
        }
    }
    Ok(best)
}

/// A fit with its largest distance lowered as far as it goes or to `enough`.
///
/// # Errors
/// When the control says so.
pub(super) fn lowered(
    ladder: &Ladder,
    fitted: &Fitted,
    freedom: &Freedom,
    enough: f64,
) -> Result<Fitted, Stop> {
    let shape = (ladder.sample, freedom);
    minimax(fitted, shape, Effort::STEP, enough, ladder.control)
}

/// As few patches as keep every point within a tolerance, from where the
/// division of the best developable says, up and then down.
///
/// # Errors
/// When the control says so.
pub(super) fn for_tolerance(
    ladder: &mut Ladder,
    tolerance: f64,
    norm: Norm,
    floor: f64,
) -> Result<Choice, Stop> {
    let near = SLACK * tolerance.max(floor);
    let enough = |k: &usize| ladder.segments.value(Aim::Max, *k) <= near;
    let mut count = (1..=ladder.most()).find(enough).unwrap_or(ladder.most());
    let mut found = best(ladder, count, norm, tolerance)?;
    let height = |f: &Fitted, l: &Ladder| f.max().max(f.worth(l.sample));
    let mut waited = 0;
    let mut least = found.clone();
    while height(&found, ladder) > tolerance {
        if count == ladder.most() || (waited >= PATIENCE && floor > tolerance) {
            return Ok(Choice {
                fitted: least,
                reachable: false,
            });
        }
        count += 1;
        found = best(ladder, count, norm, tolerance)?;
        if height(&found, ladder) < (1.0 - GAIN) * height(&least, ladder) {
            waited = 0;
            least = found.clone();
        } else {
            waited += 1;
        }
    }
    while count > 1 {
        let fewer = best(ladder, count - 1, norm, tolerance)?;
        if height(&fewer, ladder) > tolerance {
            break;
        }
        (found, count) = (fewer, count - 1);
    }
    Ok(Choice {
        fitted: found,
        reachable: true,
    })
}

/// As many patches as the noise lets one tell apart: the least of
/// N ln rms² + (3K + 4) ln N.
///
/// # Errors
/// When the control says so.
pub(super) fn for_noise(ladder: &mut Ladder) -> Result<usize, Stop> {
    let points = ladder.sample.weights.iter().filter(|w| **w > 0.0).count() as f64;
    let criterion = |rms: f64, k: usize| {
        let square = rms * rms + USELESS * USELESS;
        points * square.ln() + (3 * k + 4) as f64 * points.ln()
    };
    let (mut least, mut chosen, mut waited) = (f64::INFINITY, 1, 0);
    let batch = 4;
    let mut from = 1;
    while waited < PATIENCE && from <= ladder.most() {
        let counts: Vec<usize> = (from..from + batch)
            .filter(|k| *k <= ladder.most())
            .collect();
        ladder.solve(&counts)?;
        for k in &counts {
            let value = criterion(ladder.rung(*k)?.fitted.rms(ladder.sample), *k);
            if value < least {
                (least, chosen, waited) = (value, *k, 0);
            } else {
                waited += 1;
            }
        }
        from += batch;
    }
    Ok(chosen)
}
