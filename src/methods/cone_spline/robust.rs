//! Vertices far off lose their hold on the shape (Tukey's biweight; Beaton &
//! Tukey 1974).

use super::engine::{Effort, Fitted, Sample};
use super::problem::Freedom;
use crate::methods::Control;
use crate::solver::Stop;

/// Beyond so many standard deviations a distance does not count: 95 % as good
/// as least squares where all is normal.
const CUT: f64 = 4.685;
/// Standard deviation per median of the absolute values, of normal errors.
const NORMAL: f64 = 1.4826;
/// Changes of the weights; they settle in a few.
const ROUNDS: usize = 5;
/// Standard deviations below this are rounding: nothing is an outlier.
const EXACT: f64 = 1e-9;

/// The share of its weight that each distance keeps.
pub(super) fn shares(distances: &[f64]) -> Vec<f64> {
    let mut sizes: Vec<f64> = distances.iter().map(|d| d.abs()).collect();
    let middle = sizes.len() / 2;
    let median = match sizes.is_empty() {
        true => 0.0,
        false => *sizes.select_nth_unstable_by(middle, f64::total_cmp).1,
    };
    let cut = CUT * (NORMAL * median).max(EXACT);
    let share = |d: &f64| (1.0 - (d / cut).powi(2)).max(0.0).powi(2);
    distances.iter().map(share).collect()
}

/// Fits the fine chain again without what lies far off, and leaves that out of
/// the sample.
///
/// # Errors
/// When the control says so.
pub(super) fn cleaned(
    sample: &mut Sample,
    floor: Fitted,
    control: &dyn Control,
) -> Result<Fitted, Stop> {
    let freedom = Freedom {
        joints: false,
        ..Freedom::full(floor.chain.len())
    };
    let effort = Effort {
        iterations: 8,
        ..super::floor::LAST
    };
    let mut best = floor;
    let mut weights = sample.weights.clone();
    for _ in 0..ROUNDS {
        let shares = shares(&best.distances);
        let kept = sample.weights.iter().zip(&shares).map(|(w, s)| w * s);
        weights = kept.collect();
        best = best.weighted(sample, &weights, (&freedom, effort), control)?;
    }
    let total: f64 = weights.iter().sum();
    let kept: Vec<usize> = (0..weights.len()).filter(|i| weights[*i] > 0.0).collect();
    sample.weights = weights.iter().map(|w| w / total).collect();
    *sample = sample.only(&kept);
    let homes: Vec<u32> = kept.iter().map(|i| best.homes[*i]).collect();
    Ok(Fitted::settle(sample, &best.chain, &homes))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_lies_far_off_keeps_nothing() {
        let mut distances: Vec<f64> = (0..99).map(|i| 0.01 * (f64::from(i) * 0.7).sin()).collect();
        distances.push(1.0);
        let shares = shares(&distances);
        assert_eq!(shares[99], 0.0);
        assert!(shares[..99].iter().all(|s| *s > 0.5));
    }
}
