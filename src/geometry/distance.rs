//! How far one curve strays from another: the directed distance
//! `max over C of the distance to T`, proven, and its mean along C.
//!
//! Between two parameters of C, `h` apart, with feet on T, the distance stays
//! below the smaller of two bounds (`d` the larger of the two end distances):
//!
//! * `(d_a + d_b + |C′| h)/2`, for no distance grows faster than C runs;
//! * `d + (|C″| + |T″| s²) h²/8 + (jumps of T′) |s| h/4`, by carrying the foot
//!   along T at the rate `s = Δfoot/h`: the vector from C to the carried point
//!   strays from its chord by no more than its second derivative and its kinks
//!   allow, and the foot proper is nearer still.
//!
//! The interval of the largest bound is halved until that bound is within the
//! resolution of the largest distance found. A narrow peak between samples
//! cannot hide, whatever the sampling.

use super::closest::{Closest, CurveIndex};
use super::{BSplineCurve, Tolerance};
use crate::numerics::GaussLegendre;
use nalgebra::Point3;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Most halvings: beyond that the answer says that it is not certain.
const MAX_HALVINGS: usize = 20_000;

/// Panels for mean and root mean square, at least; the mean of a rectified
/// wave with a dozen zeros is then good to some 1e-3 of itself.
const PANELS: usize = 128;

/// Gauss nodes a panel.
const NODES: usize = 4;

/// How far a curve strays from another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurveDistance {
    /// The largest distance found.
    pub max: f64,
    /// No point of the first curve is further from the second than this.
    pub upper_bound: f64,
    /// Whether `upper_bound − max` is within the resolution.
    pub certain: bool,
    /// Where on the first curve: parameter.
    pub at: f64,
    /// Where on the first curve: point.
    pub point: Point3<f64>,
    /// The foot on the second curve: parameter.
    pub foot: f64,
    /// Mean distance, weighted by the first curve's arc length.
    pub mean: f64,
    /// Root mean square of the distance, weighted likewise.
    pub rms: f64,
}

/// Distance of `from` to `to`, the largest proven to `resolution`.
#[must_use]
pub fn directed_distance(
    from: &BSplineCurve,
    to: &BSplineCurve,
    resolution: Tolerance,
) -> CurveDistance {
    directed_distance_between(&CurveIndex::new(from), &CurveIndex::new(to), resolution)
}

/// The same for curves that are prepared already.
#[must_use]
pub fn directed_distance_between(
    from: &CurveIndex,
    to: &CurveIndex,
    resolution: Tolerance,
) -> CurveDistance {
    let (best, upper_bound) = Chase { from, to }.largest(resolution.length());
    let (mean, rms) = mean_distance(from, to);
    CurveDistance {
        max: best.foot.distance,
        upper_bound,
        certain: upper_bound - best.foot.distance <= resolution.length(),
        at: best.u,
        point: from.curve().point(best.u),
        foot: best.foot.parameter,
        mean,
        rms,
    }
}

/// A parameter of C with its foot on T.
#[derive(Debug, Clone, Copy)]
struct Sample {
    u: f64,
    foot: Closest,
}

/// An interval of C, ordered by its bound, earlier ones first among equals.
struct Interval {
    bound: f64,
    ends: [Sample; 2],
    leaf: usize,
}

impl Ord for Interval {
    fn cmp(&self, other: &Self) -> Ordering {
        let start = |i: &Interval| i.ends[0].u;
        self.bound
            .total_cmp(&other.bound)
            .then(start(other).total_cmp(&start(self)))
    }
}
impl PartialOrd for Interval {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl PartialEq for Interval {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}
impl Eq for Interval {}

/// The hunt for the largest distance.
struct Chase<'a> {
    from: &'a CurveIndex,
    to: &'a CurveIndex,
}

impl Chase<'_> {
    /// The furthest sample and a bound that nothing exceeds.
    fn largest(&self, resolution: f64) -> (Sample, f64) {
        let leaves = self.from.leaves();
        let mut left = self.sample(leaves[0].u[0], None);
        let mut best = left;
        let mut heap = BinaryHeap::new();
        for (leaf, piece) in leaves.iter().enumerate() {
            let right = self.sample(piece.u[1], Some(left.foot.parameter));
            best = further(best, right);
            heap.push(self.interval(leaf, [left, right]));
            left = right;
        }
        let mut halvings_left = MAX_HALVINGS;
        while let Some(widest) = heap.pop() {
            let [a, b] = widest.ends;
            let middle = 0.5 * (a.u + b.u);
            let settled = widest.bound <= best.foot.distance + resolution;
            if settled || halvings_left == 0 || middle <= a.u || middle >= b.u {
                return (best, widest.bound.max(best.foot.distance));
            }
            halvings_left -= 1;
            let m = self.sample(middle, Some(0.5 * (a.foot.parameter + b.foot.parameter)));
            best = further(best, m);
            heap.push(self.interval(widest.leaf, [a, m]));
            heap.push(self.interval(widest.leaf, [m, b]));
        }
        (best, best.foot.distance)
    }

    fn sample(&self, u: f64, hint: Option<f64>) -> Sample {
        let point = self.from.curve().point(u);
        let foot = match hint {
            Some(hint) => self.to.closest_near(&point, hint),
            None => self.to.closest(&point),
        };
        Sample { u, foot }
    }

    fn interval(&self, leaf: usize, ends: [Sample; 2]) -> Interval {
        let [a, b] = ends;
        let piece = &self.from.leaves()[leaf];
        let h = b.u - a.u;
        let sum = a.foot.distance + b.foot.distance;
        let running = 0.5 * (sum + piece.speed * h);
        let rate = ((b.foot.parameter - a.foot.parameter) / h).abs();
        let (second, jumps) = self.roughness(a.foot.parameter, b.foot.parameter);
        let carried = a.foot.distance.max(b.foot.distance)
            + 0.125 * (piece.second + second * rate * rate) * h * h
            + 0.25 * jumps * rate * h;
        Interval {
            bound: running.min(carried),
            ends,
            leaf,
        }
    }

    /// The bound on `|T″|` and the sum of the jumps of `T′` between two
    /// parameters of T.
    fn roughness(&self, s: f64, t: f64) -> (f64, f64) {
        let (first, last) = (self.to.leaf_at(s.min(t)), self.to.leaf_at(s.max(t)));
        let leaves = &self.to.leaves()[first..=last];
        let second = leaves.iter().map(|leaf| leaf.second).fold(0.0, f64::max);
        (second, leaves[1..].iter().map(|leaf| leaf.jump).sum())
    }
}

fn further(best: Sample, other: Sample) -> Sample {
    if other.foot.distance > best.foot.distance {
        other
    } else {
        best
    }
}

/// Mean and root mean square over the arc length of `from`.
fn mean_distance(from: &CurveIndex, to: &CurveIndex) -> (f64, f64) {
    let rule = GaussLegendre::new(NODES);
    let parts = PANELS.div_ceil(from.leaves().len());
    let (mut length, mut sum, mut squares) = (0.0, 0.0, 0.0);
    let mut hint = to.closest(&from.curve().start()).parameter;
    for leaf in from.leaves() {
        let [a, b] = leaf.u;
        let border = |k: usize| a + (b - a) * k as f64 / parts as f64;
        for (u, w) in (0..parts).flat_map(|k| rule.on(border(k), border(k + 1))) {
            let jet = from.curve().derivatives_in_span(leaf.span, u);
            let foot = to.closest_near(&jet.point, hint);
            hint = foot.parameter;
            let weight = w * jet.d1.norm();
            length += weight;
            sum += weight * foot.distance;
            squares += weight * foot.distance * foot.distance;
        }
    }
    if length > 0.0 {
        (sum / length, (squares / length).sqrt())
    } else {
        // A curve that is one point.
        let d = to.closest(&from.curve().start()).distance;
        (d, d)
    }
}

#[cfg(test)]
mod tests;
