//! The smallest largest distance, by Lawson's reweighting (Lawson 1961): least
//! squares whose weights grow with the distances end at the minimax fit.

use super::engine::{Effort, Fitted, Sample};
use super::problem::Freedom;
use crate::methods::Control;
use crate::solver::Stop;

/// Most reweightings. Convergence is linear; the last of them change the
/// largest distance by some 1e-3 of itself.
const ROUNDS: usize = 60;
/// Rounds without gain after which it ends.
const PATIENCE: usize = 12;
/// A gain is a fall by this share.
const GAIN: f64 = 1e-3;
/// Share of the original weights that stays, so that every patch stays held.
const KEPT: f64 = 1e-4;
/// Largest distances below this are rounding.
const EXACT: f64 = 1e-12;

/// Lowers the largest distance from a least-squares fit, as far as it goes or
/// to `enough`.
///
/// # Errors
/// When the control says so.
pub(super) fn minimax(
    fitted: &Fitted,
    (sample, freedom): (&Sample, &Freedom),
    effort: Effort,
    enough: f64,
    control: &dyn Control,
) -> Result<Fitted, Stop> {
    let mut best = fitted.clone();
    let mut best_max = fitted.max();
    let mut current = fitted.clone();
    let mut weights = sample.weights.clone();
    let mut waited = 0;
    for _ in 0..ROUNDS {
        if best_max <= enough.max(EXACT) || waited > PATIENCE {
            break;
        }
        reweight(&mut weights, &current.distances, &sample.weights);
        current = current.weighted(sample, &weights, (freedom, effort), control)?;
        let max = current.max();
        waited = if max < best_max * (1.0 - GAIN) {
            0
        } else {
            waited + 1
        };
        if max < best_max && current.worth(sample).is_finite() {
            best_max = max;
            best = current.clone();
        }
    }
    best.iterations = current.iterations;
    Ok(best)
}

/// w ← w |d|, adding up to 1.
fn reweight(weights: &mut [f64], distances: &[f64], original: &[f64]) {
    let product = |(w, d): (&f64, &f64)| w * d.abs();
    let sum: f64 = weights.iter().zip(distances).map(product).sum();
    if sum > 0.0 {
        for ((w, d), o) in weights.iter_mut().zip(distances).zip(original) {
            *w = (1.0 - KEPT) * *w * d.abs() / sum + KEPT * o;
        }
    }
}
