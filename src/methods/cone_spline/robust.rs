//! Vertices far off lose their hold on the shape (Tukey's biweight; Beaton &
//! Tukey 1974).

use super::chain::Chain;
use super::engine::{Effort, Fitted, Sample};
use super::floor::floor;
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
/// Fits from the start without what lies far off.
const AGAIN: usize = 2;
/// Standard deviations below this, in the unit of the fit, are of no use to a
/// yard. Of a strip without noise the distances of the fine chain are smaller
/// by far, but not alike everywhere: those at its ends are no outliers.
const USELESS: f64 = 1e-4;

/// The share of its weight that each distance keeps.
pub(super) fn shares(distances: &[f64]) -> Vec<f64> {
    let mut sizes: Vec<f64> = distances.iter().map(|d| d.abs()).collect();
    let middle = sizes.len() / 2;
    let median = match sizes.is_empty() {
        true => 0.0,
        false => *sizes.select_nth_unstable_by(middle, f64::total_cmp).1,
    };
    let cut = CUT * (NORMAL * median).max(USELESS);
    let share = |d: &f64| (1.0 - (d / cut).powi(2)).max(0.0).powi(2);
    distances.iter().map(share).collect()
}

/// Fits the fine chain again without what lies far off, and leaves that out of
/// the sample, whose points start on given patches of a given chain.
///
/// # Errors
/// When the control says so.
pub(super) fn cleaned(
    sample: &mut Sample,
    fine: Fitted,
    (start, homes): (&Chain, &[u32]),
    control: &dyn Control,
) -> Result<Fitted, Stop> {
    let freedom = Freedom {
        joints: false,
        ..Freedom::full(fine.chain.len())
    };
    let effort = Effort {
        iterations: 8,
        ..super::floor::LAST
    };
    let counted = |distances: &[f64]| -> Vec<f64> {
        let shares = shares(distances);
        sample
            .weights
            .iter()
            .zip(&shares)
            .map(|(w, s)| w * s)
            .collect()
    };
    let mut best = fine;
    for _ in 0..ROUNDS {
        let weights = counted(&best.distances);
        best = best.weighted(sample, &weights, (&freedom, effort), control)?;
    }
    // What was far off has bent the fine chain, and left it so: once more from
    // the start without that, then all points are judged anew.
    let mut weights = counted(&best.distances);
    for _ in 0..AGAIN {
        let (part, homes, _) = without_lost(sample, &weights, homes);
        best = floor(&part, start, &homes, control)?;
        let judged = Fitted::settle_anew(sample, &best.chain);
        weights = counted(&judged.distances);
    }
    let (part, _, kept) = without_lost(sample, &weights, homes);
    let judged = Fitted::settle_anew(sample, &best.chain);
    let homes: Vec<u32> = kept.iter().map(|i| judged.homes[*i]).collect();
    *sample = part;
    Ok(Fitted::settle(sample, &best.chain, &homes))
}

/// The points that still have a weight, with their homes and indices.
fn without_lost(sample: &Sample, weights: &[f64], homes: &[u32]) -> (Sample, Vec<u32>, Vec<usize>) {
    let total: f64 = weights.iter().sum();
    let kept: Vec<usize> = (0..weights.len()).filter(|i| weights[*i] > 0.0).collect();
    let weighted = Sample {
        points: sample.points.clone(),
        weights: weights.iter().map(|w| w / total).collect(),
        area: sample.area,
    };
    let homes = kept.iter().map(|i| homes[*i]).collect();
    (weighted.only(&kept), homes, kept)
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
