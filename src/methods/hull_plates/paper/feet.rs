//! Foot points of data points on a moving curve, by Newton's method, each
//! search beginning where the last one ended (sec. 2.3.2).
//!
//! Limits: the foot is the local one near the start; only a fresh search on a
//! grid of parameters ([`first`]) looks along the whole curve.

use crate::geometry::BSplineCurve;
use nalgebra::Point3;

/// Newton steps of one renewal; from a foot of the last step two or three do.
const STEPS: usize = 12;
/// A parameter step below this is rounding.
const SMALL_STEP: f64 = 1e-13;
/// Parameters tried for each data point before the first Newton step. The
/// paper takes as many as there are data points; twenty curves' worth costs
/// nothing and does not miss the foot at a sharp bend of the bow.
const TRIED_PER_POINT: usize = 20;

/// The parameter in [0, 1] of the foot of `x` near `u`.
pub(super) fn near(curve: &BSplineCurve, x: &Point3<f64>, mut u: f64) -> f64 {
    for _ in 0..STEPS {
        let jet = curve.derivatives(u);
        let off = x - jet.point;
        let (slope, speed2) = (off.dot(&jet.d1), jet.d1.norm_squared());
        let newton = speed2 - off.dot(&jet.d2);
        // Where the point lies beyond the centre of curvature Newton would go
        // away from the foot: Gauss–Newton's denominator is always positive.
        let step = slope
            / if newton > 0.1 * speed2 {
                newton
            } else {
                speed2
            };
        if !step.is_finite() {
            break;
        }
        let next = (u + step).clamp(0.0, 1.0);
        let moved = (next - u).abs();
        u = next;
        if moved < SMALL_STEP {
            break;
        }
    }
    u
}

/// Feet of all points, from the nearest of evenly spread parameters.
pub(super) fn first(curve: &BSplineCurve, points: &[Point3<f64>]) -> Vec<f64> {
    let count = TRIED_PER_POINT * points.len().max(2);
    let tried: Vec<(f64, Point3<f64>)> = (0..=count)
        .map(|i| {
            let u = i as f64 / count as f64;
            (u, curve.point(u))
        })
        .collect();
    let nearest = |x: &Point3<f64>| {
        let distance = |p: &Point3<f64>| (p - x).norm_squared();
        let best = tried
            .iter()
            .min_by(|a, b| distance(&a.1).total_cmp(&distance(&b.1)));
        near(curve, x, best.map_or(0.0, |b| b.0))
    };
    points.iter().map(nearest).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{CurveIndex, Parametrization, interpolate};

    #[test]
    fn feet_agree_with_the_certified_closest_points() {
        let bend = [(0.0, 0.0), (0.4, 0.05), (0.8, 0.0), (0.9, 0.3), (1.0, 0.8)];
        let points: Vec<_> = bend
            .iter()
            .map(|(x, y)| Point3::new(*x, *y, 0.1 * x * y))
            .collect();
        let curve = interpolate(&points, 3, Parametrization::ChordLength).expect("distinct points");
        let queries: Vec<_> = points
            .iter()
            .map(|p| p + nalgebra::Vector3::new(0.01, -0.02, 0.01))
            .collect();
        let index = CurveIndex::new(&curve);
        for (x, u) in queries.iter().zip(first(&curve, &queries)) {
            let certified = index.closest(x).distance;
            assert!((x - curve.point(u)).norm() < certified + 1e-12);
        }
    }
}
