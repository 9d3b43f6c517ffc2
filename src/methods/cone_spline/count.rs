//! How many patches: as few as a tolerance asks for, or as many as the noise
//! lets one tell apart.

use super::engine::Fitted;
use super::ladder::Ladder;
use super::minimax::{self, eighth_powers, minimax};
use super::problem::Freedom;
use super::request::Norm;
use super::segments::Aim;
use crate::solver::Stop;
use rayon::prelude::*;

/// Patches whose joints need not meet come so much nearer than a chain.
const SLACK: f64 = 1.3;
/// With this factor above the tolerance more starts may keep it.
const CLOSE: f64 = 1.5;
/// A patch more that gains less than this share is not worth it …
const GAIN: f64 = 0.03;
/// … so many times in a row.
const PATIENCE: usize = 3;
/// Differences below this share of the longest side are of no use to a yard:
/// with less noise than that no patch is added.
const USELESS: f64 = 1e-4;

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
    if norm == Norm::EighthPowers {
        let shape = (ladder.sample, &freedom);
        return eighth_powers(&rung.fitted, shape, ladder.control);
    }
    let all: Vec<&Fitted> = std::iter::once(&rung.fitted)
        .chain(&rung.others)
        .filter(|f| f.worth(ladder.sample).is_finite())
        .collect();
    let shape = (ladder.sample, &freedom);
    let lower = |f: &&Fitted| minimax(f, shape, (enough, minimax::FEW), ladder.control);
    let short = all
        .par_iter()
        .map(lower)
        .collect::<Result<Vec<_>, Stop>>()?;
    let height = |f: &Fitted| height(ladder, f);
    let best = short
        .into_iter()
        .min_by(|a, b| height(a).total_cmp(&height(b)));
    match best {
        Some(best) => lowered(ladder, &best, &freedom, enough),
        None => Ok(rung.fitted),
    }
}

/// The largest distance of a chain that can be rolled.
fn height(ladder: &Ladder, fitted: &Fitted) -> f64 {
    fitted.max().max(fitted.worth(ladder.sample))
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
    minimax(fitted, shape, (enough, minimax::ROUNDS), ladder.control)
}

/// The same, with more starts where the tolerance is near.
fn within(ladder: &mut Ladder, patches: usize, norm: Norm, tolerance: f64) -> Result<Fitted, Stop> {
    let found = best(ladder, patches, norm, tolerance)?;
    let over = height(ladder, &found) / tolerance;
    if !(1.0..CLOSE).contains(&over) && over.is_finite() {
        return Ok(found);
    }
    ladder.improve(patches)?;
    best(ladder, patches, norm, tolerance)
}

/// As few patches as keep every point within a tolerance, from where the
/// division of the best developable says, up and then down. Where none does,
/// as few as come nearest to it.
///
/// # Errors
/// When the control says so.
pub(super) fn for_tolerance(
    ladder: &mut Ladder,
    tolerance: f64,
    norm: Norm,
    floor: f64,
) -> Result<usize, Stop> {
    let near = SLACK * tolerance.max(floor);
    let enough = |k: &usize| ladder.segments.value(Aim::Max, *k) <= near;
    let mut count = (1..=ladder.most()).find(enough).unwrap_or(ladder.most());
    // Of an exact spline the right number may be found and those next to it not.
    let few: Vec<usize> = (1..=count).collect();
    ladder.solve(&few)?;
    for k in few {
        let fitted = ladder.rung(k)?.fitted;
        if height(ladder, &fitted) <= tolerance {
            return fewer(ladder, k, norm, tolerance);
        }
    }
    let (mut least, mut nearest, mut waited) = (f64::INFINITY, count, 0);
    loop {
        let found = within(ladder, count, norm, tolerance)?;
        let reached = height(ladder, &found);
        if reached <= tolerance {
            return fewer(ladder, count, norm, tolerance);
        }
        if reached < (1.0 - GAIN) * least {
            (least, nearest, waited) = (reached, count, 0);
        } else {
            waited += 1;
        }
        if count == ladder.most() || (waited >= PATIENCE && floor > tolerance) {
            return Ok(nearest);
        }
        count += 1;
    }
}

/// The least number, counting down from one that keeps a tolerance, that does.
fn fewer(ladder: &mut Ladder, mut count: usize, norm: Norm, tolerance: f64) -> Result<usize, Stop> {
    while count > 1 {
        let found = within(ladder, count - 1, norm, tolerance)?;
        if height(ladder, &found) > tolerance {
            break;
        }
        count -= 1;
    }
    Ok(count)
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
