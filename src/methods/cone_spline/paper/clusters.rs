//! Regions of rulings whose axes are alike (sec. 2.1 (2)): K-means on
//! g = (d/R, m/R, k p/P), R and P the largest sizes, k = [`PLACE`].
//!
//! What was mended: d and −d, m and −m are one axis, so features are compared
//! with either sign; a region is one run of rulings, so rulings are given to
//! the centres in their order along the strip, the best way by dynamic
//! programming; the start is an even division, not a draw.

use super::axes::Axis;
use nalgebra::{SVector, Vector3};

/// k: how much more the place counts than the axis.
const PLACE: f64 = 10.0;
/// A region has so many rulings at least.
pub(super) const LEAST: usize = 4;
/// Rounds at most; runs of rulings settle in far fewer.
const ROUNDS: usize = 100;

type Feature = SVector<f64, 9>;

/// Where the regions begin, and the number of rulings: `regions + 1` indices.
/// `axes` holds at least `regions × `[`LEAST`].
pub(super) fn regions(axes: &[Axis], regions: usize) -> Vec<usize> {
    let features = features(axes);
    let mut starts: Vec<usize> = (0..=regions)
        .map(|i| i * features.len() / regions)
        .collect();
    for _ in 0..ROUNDS {
        let centres: Vec<Feature> = (starts.windows(2))
            .map(|w| mean(&features[w[0]..w[1]]))
            .collect();
        let next = assigned(&features, &centres);
        if next == starts {
            break;
        }
        starts = next;
    }
    starts
}

fn features(axes: &[Axis]) -> Vec<Feature> {
    let largest = |size: fn(&Axis) -> f64| {
        let all = axes.iter().map(size);
        all.fold(f64::MIN_POSITIVE, f64::max)
    };
    let line = largest(|a| a.direction.norm_squared() + a.moment.norm_squared()).sqrt();
    let place = largest(|a| a.place.coords.norm_squared()).sqrt() / PLACE;
    let feature = |a: &Axis| {
        let [d, m, p] = [a.direction / line, a.moment / line, a.place.coords / place];
        Feature::from_iterator(d.iter().chain(&m).chain(&p).copied())
    };
    axes.iter().map(feature).collect()
}

/// The feature with the sign of its axis that is nearer to another.
fn turned(feature: &Feature, to: &Feature) -> Feature {
    let line = |f: &Feature| f.fixed_rows::<6>(0).into_owned();
    let sign = if line(feature).dot(&line(to)) < 0.0 {
        -1.0
    } else {
        1.0
    };
    let mut turned = *feature;
    turned.fixed_rows_mut::<6>(0).scale_mut(sign);
    turned
}

/// Mean of a run, signs as the one in its middle has them.
fn mean(run: &[Feature]) -> Feature {
    let middle = run[run.len() / 2];
    let sum: Feature = run.iter().map(|f| turned(f, &middle)).sum();
    sum / run.len() as f64
}

/// The runs that lie nearest to the centres, one after the other.
fn assigned(features: &[Feature], centres: &[Feature]) -> Vec<usize> {
    let (n, k) = (features.len(), centres.len());
    // sums[c][i]: the first i rulings, all in region c.
    let sum = |c: &Feature| {
        let mut total = 0.0;
        let costs = features.iter().map(|f| (turned(f, c) - c).norm_squared());
        let running = costs.map(|cost| {
            total += cost;
            total
        });
        std::iter::once(0.0).chain(running).collect::<Vec<f64>>()
    };
    let sums: Vec<Vec<f64>> = centres.iter().map(sum).collect();
    let mut best = sums[0].clone();
    best[..LEAST].fill(f64::INFINITY);
    let mut from = vec![vec![0; n + 1]];
    for sums in &sums[1..] {
        let (mut next, mut origin) = (vec![f64::INFINITY; n + 1], vec![0; n + 1]);
        // The least of best[j] − sums[j] over the j that leave enough rulings.
        let mut least = (f64::INFINITY, 0);
        for i in LEAST..=n {
            let j = i - LEAST;
            let value = best[j] - sums[j];
            if value < least.0 {
                least = (value, j);
            }
            (next[i], origin[i]) = (least.0 + sums[i], least.1);
        }
        best = next;
        from.push(origin);
    }
    let mut starts = vec![n];
    for origin in from.iter().skip(1).rev() {
        starts.push(origin[starts[starts.len() - 1]]);
    }
    starts.push(0);
    starts.reverse();
    debug_assert_eq!(starts.len(), k + 1);
    starts
}

/// Mean direction and moment of a region's axes, not normalised.
pub(super) fn mean_axis(axes: &[Axis]) -> [Vector3<f64>; 2] {
    let middle = &axes[axes.len() / 2];
    let mut sums = [Vector3::zeros(); 2];
    for axis in axes {
        let along = axis.direction.dot(&middle.direction) + axis.moment.dot(&middle.moment);
        let sign = 1.0_f64.copysign(along) / axes.len() as f64;
        sums[0] += sign * axis.direction;
        sums[1] += sign * axis.moment;
    }
    sums
}
