//! The smallest largest distance, by bisection: for an allowed distance, least
//! squares of what lies beyond it end at zero if a chain keeps it.
//!
//! Near the least largest distance few points stand out, by little, and the
//! Gauss–Newton steps on those alone go straight there; reweighting all points
//! (Lawson 1961) takes some hundred steps for the same.

use super::engine::{Effort, Fitted, Sample};
use super::problem::Freedom;
use crate::methods::Control;
use crate::solver::Stop;

/// Bisections that tell which of several starts leads lower.
pub(super) const FEW: usize = 3;
/// Most bisections.
pub(super) const ROUNDS: usize = 14;
/// The end of the bisection: so near is the bound to what was reached.
const NEAR: f64 = 5e-3;
/// A chain keeps what is allowed when it is beyond by no more than this share.
const KEPT: f64 = 1e-3;
/// Where between the bounds the next try lies: most are too low, and those
/// cost more steps.
const LOWER: f64 = 0.4;
/// A try.
const TRY: Effort = Effort {
    iterations: 40,
    reduction: 1e-3,
    smoothing: 0.0,
    allowed: 0.0,
    power: None,
    slowest: None,
};
/// The power of distances whose sum is nearly their largest.
pub(super) const EIGHTH: f64 = 8.0;
/// Largest distances below this are rounding.
const EXACT: f64 = 1e-12;

/// The least sum of eighth powers from the least squares, by way of the fourth.
///
/// # Errors
/// When the control says so.
pub(super) fn eighth_powers(
    fitted: &Fitted,
    (sample, freedom): (&Sample, &Freedom),
    control: &dyn Control,
) -> Result<Fitted, Stop> {
    let mut best = fitted.clone();
    for power in [4.0, EIGHTH] {
        if best.max() <= EXACT {
            break;
        }
        let effort = Effort {
            power: Some(power),
            ..Effort::FULL
        };
        best = best.relaxed(sample, freedom, effort, control)?;
    }
    Ok(best)
}

/// Lowers the largest distance from a least-squares fit, as far as it goes or
/// to `enough`, in so many bisections at most.
///
/// # Errors
/// When the control says so.
pub(super) fn minimax(
    fitted: &Fitted,
    (sample, freedom): (&Sample, &Freedom),
    (enough, rounds): (f64, usize),
    control: &dyn Control,
) -> Result<Fitted, Stop> {
    let mut best = fitted.clone();
    let mut iterations = fitted.iterations;
    let mut low = if fitted.worth(sample).is_finite() {
        fitted.rms(sample)
    } else {
        0.0
    };
    for _ in 0..rounds {
        let high = best.max();
        if high <= enough.max(EXACT) || high - low <= NEAR * high {
            break;
        }
        if enough > 0.0 && low >= enough {
            break;
        }
        // Also below what is enough: there fewer steps lead past it.
        let allowed = high - LOWER * (high - low);
        let effort = Effort { allowed, ..TRY };
        let tried = best.relaxed(sample, freedom, effort, control)?;
        iterations += tried.iterations - best.iterations;
        let max = tried.max();
        if max > allowed * (1.0 + KEPT) {
            low = allowed;
        }
        if max < high && tried.worth(sample).is_finite() {
            best = tried;
        }
    }
    best.iterations = iterations;
    Ok(best)
}

/// The least largest distance of many points, from that of a part of them:
/// those that lie farthest join the part until none lies beyond (Remez 1934).
///
/// # Errors
/// When the control says so.
pub(super) fn exchanged(
    fitted: &Fitted,
    (all, kept): (&Sample, &[usize]),
    freedom: &Freedom,
    control: &dyn Control,
) -> Result<Fitted, Stop> {
    /// Exchanges; with each fewer points lie beyond.
    const EXCHANGES: usize = 3;
    /// Points join that lie beyond this share of the largest distance …
    const FAR: f64 = 0.9;
    /// … as many of the farthest at most.
    const MOST: usize = 4000;
    let mut part = kept.to_vec();
    let mut current = Fitted::settle_anew(all, &fitted.chain);
    let mut best = current.clone();
    for _ in 0..EXCHANGES {
        let among = part.iter().map(|i| current.distances[*i].abs());
        let known = among.fold(0.0, f64::max);
        if current.max() <= (1.0 + KEPT) * known {
            break;
        }
        let mut far: Vec<usize> = (0..all.points.len())
            .filter(|i| current.distances[*i].abs() > FAR * known)
            .collect();
        far.sort_by(|a, b| {
            let [a, b] = [a, b].map(|i| current.distances[*i].abs());
            b.total_cmp(&a)
        });
        part.extend(far.into_iter().take(MOST));
        part.sort_unstable();
        part.dedup();
        let sample = all.only(&part);
        let homes: Vec<u32> = part.iter().map(|i| current.homes[*i]).collect();
        let start = Fitted::settle(&sample, &current.chain, &homes);
        let lower = minimax(&start, (&sample, freedom), (0.0, ROUNDS), control)?;
        current = Fitted::settle(all, &lower.chain, &current.homes);
        current.iterations = lower.iterations;
        if current.max() < best.max() && current.worth(all).is_finite() {
            best = current.clone();
        }
    }
    Ok(best)
}
