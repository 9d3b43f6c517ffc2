//! A target in the unit of the fit: about one across, its centre at the
//! origin, turned round so that the same strip begins at the same end.

use super::chain::Chain;
use super::engine::Sample;
use super::floor::chain_through;
use super::target::Target;
use nalgebra::{Point3, Vector3, center};
use rayon::prelude::*;

/// Root mean square distance from the centre in the unit of the fit; that of a
/// strip of length 1 is 0.29 or a little more. It does not depend on the pose,
/// as a bounding box does.
const SPREAD: f64 = 0.3;
/// Two ends differ when a length differs by this share of the strip.
const DIFFERENT: f64 = 1e-7;
/// More points are thinned out until the last fit.
const MOST_POINTS: usize = 6000;

/// What is fitted.
#[derive(Debug, Clone)]
pub(super) struct Strip {
    /// All points, in the unit of the fit.
    pub(super) all: Sample,
    /// Those that the search looks at: all, or some.
    pub(super) sample: Sample,
    /// The chain through the target's rulings.
    pub(super) start: Chain,
    /// The patch of that chain where each of all points lies.
    pub(super) homes: Vec<u32>,
    /// The same for the sample.
    pub(super) sample_homes: Vec<u32>,
    /// Which of all points are in the sample.
    pub(super) kept: Vec<usize>,
    /// Unit of the fit per unit of the request.
    pub(super) scale: f64,
    centre: Vector3<f64>,
}

impl Strip {
    /// `None` where the rulings do not span a strip.
    pub(super) fn new(target: &Target) -> Option<Strip> {
        let (centre, spread) = centre(target);
        let scale = SPREAD / spread;
        if !scale.is_finite() {
            return None;
        }
        let unit = |p: &Point3<f64>| Point3::from((p.coords - centre) * scale);
        let total: f64 = target.weights.iter().sum();
        let all = Sample {
            points: target.points.iter().map(unit).collect(),
            weights: target.weights.iter().map(|w| w / total).collect(),
            area: total * scale * scale,
        };
        let rulings: Vec<_> = target
            .rulings
            .iter()
            .map(|r| [unit(&r[0]), unit(&r[1])])
            .collect();
        let start = chain_through(&rulings)?;
        let near = |p: &Point3<f64>| nearest_patch(&rulings, p);
        let homes: Vec<u32> = all.points.par_iter().map(near).collect();
        let kept = kept(all.points.len());
        Some(Strip {
            sample: all.only(&kept),
            sample_homes: kept.iter().map(|i| homes[*i]).collect(),
            kept,
            all,
            start,
            homes,
            scale,
            centre,
        })
    }

    /// Whether the sample left points out from the start.
    pub(super) fn is_thinned(&self) -> bool {
        self.sample_homes.len() < self.homes.len()
    }

    /// A point of the request in the unit of the fit.
    pub(super) fn in_unit(&self, point: &Point3<f64>) -> Point3<f64> {
        Point3::from((point.coords - self.centre) * self.scale)
    }

    /// A chain in the unit of the request.
    pub(super) fn restored(&self, chain: &Chain) -> Chain {
        chain.scaled(1.0 / self.scale, &self.centre)
    }
}

/// Centre of area and root mean square distance from it.
fn centre(target: &Target) -> (Vector3<f64>, f64) {
    let total: f64 = target.weights.iter().sum();
    let weighted = || target.points.iter().zip(&target.weights);
    let centre: Vector3<f64> = weighted().map(|(p, w)| p.coords * *w).sum::<Vector3<f64>>() / total;
    let square: f64 = weighted()
        .map(|(p, w)| w * (p.coords - centre).norm_squared())
        .sum();
    (centre, (square / total).sqrt())
}

/// The patch between the two neighbouring rulings nearest to a point.
fn nearest_patch(rulings: &[[Point3<f64>; 2]], point: &Point3<f64>) -> u32 {
    let apart = |ruling: &[Point3<f64>; 2]| {
        let way = ruling[1] - ruling[0];
        let share = (point - ruling[0]).dot(&way) / way.norm_squared().max(f64::MIN_POSITIVE);
        (ruling[0] + way * share.clamp(0.0, 1.0) - point).norm()
    };
    let distances: Vec<f64> = rulings.iter().map(apart).collect();
    let sum = |i: &usize| distances[*i] + distances[i + 1];
    let best = (0..rulings.len() - 1).min_by(|a, b| sum(a).total_cmp(&sum(b)));
    best.unwrap_or(0) as u32
}

/// Which points the search looks at. The choice must not follow the rows of a
/// mesh, so it is by a hash of the index (the finaliser of MurmurHash3).
fn kept(count: usize) -> Vec<usize> {
    if count <= MOST_POINTS {
        return (0..count).collect();
    }
    let hash = |i: &usize| {
        let mut h = *i as u64 + 1;
        for factor in [0xff51_afd7_ed55_8ccd, 0xc4ce_b9fe_1a85_ec53_u64] {
            h = (h ^ (h >> 33)).wrapping_mul(factor);
        }
        (h >> 33) as f64 / (1_u64 << 31) as f64
    };
    let share = MOST_POINTS as f64 / count as f64;
    (0..count).filter(|i| hash(i) < share).collect()
}

/// The same strip with its normals r × t on the side of its triangles', and
/// beginning at an end that the shape alone decides.
pub(super) fn oriented(target: &Target) -> Target {
    let mut turned = target.clone();
    if facing(&turned) < 0.0 {
        swap_sides(&mut turned);
    }
    if begins_at_the_far_end(&turned) {
        turned.sides.iter_mut().for_each(|s| s.reverse());
        turned.ends.swap(0, 1);
        turned.rulings.reverse();
        swap_sides(&mut turned);
    }
    turned
}

/// Exchanges the long sides, which turns the normals.
fn swap_sides(target: &mut Target) {
    target.sides.swap(0, 1);
    target.ends.iter_mut().for_each(|e| e.reverse());
    target.rulings.iter_mut().for_each(|r| r.swap(0, 1));
}

/// By how much the triangles' normals agree with r × t near them.
fn facing(target: &Target) -> f64 {
    let middles: Vec<Point3<f64>> = target.rulings.iter().map(|[a, b]| center(a, b)).collect();
    let normal = |i: usize| {
        let [a, b] = [target.rulings[i], target.rulings[i + 1]];
        let ruling = (a[1] - a[0]) + (b[1] - b[0]);
        ruling.cross(&(middles[i + 1] - middles[i]))
    };
    let area = |t: &[usize; 3]| {
        let [a, b, c] = t.map(|v| target.points[v]);
        let home = nearest_patch(
            &target.rulings,
            &Point3::from((a.coords + b.coords + c.coords) / 3.0),
        );
        (b - a)
            .cross(&(c - a))
            .dot(&normal(home as usize).normalize())
    };
    // A strip is oriented as a whole: some triangles tell.
    const ENOUGH: usize = 2000;
    let step = target.triangles.len().div_ceil(ENOUGH).max(1);
    target.triangles.iter().step_by(step).map(area).sum()
}

/// Whether the finish is the wider end or, of two alike, the one nearer to the
/// centre.
fn begins_at_the_far_end(target: &Target) -> bool {
    let (centre, spread) = centre(target);
    let width = |end: &[Point3<f64>]| match end {
        [a, .., b] => (b - a).norm(),
        _ => 0.0,
    };
    let far = |end: &[Point3<f64>]| match end {
        [a, .., b] => (center(a, b).coords - centre).norm(),
        _ => 0.0,
    };
    let [first, last] = [&target.ends[0], &target.ends[1]];
    let wider = width(last) - width(first);
    let nearer = far(first) - far(last);
    if wider.abs() > DIFFERENT * spread {
        wider > 0.0
    } else {
        nearer > DIFFERENT * spread
    }
}
