//! Feet of points on a moving ruled surface, each search beginning where the
//! last one ended.

use super::ruled::Ruled;
use crate::geometry::BSplineCurve;
use nalgebra::Point3;

/// Steps of one renewal; from the feet of the last step one or two do.
const STEPS: usize = 8;
/// A step of a parameter below this is rounding.
const SMALL: f64 = 1e-10;
/// Rulings or points of a curve that are looked at before the first step, for
/// each region.
const LOOKED_AT: usize = 40;

/// Share along a segment of the foot of a point, in [0, 1].
pub(super) fn share([a, b]: [Point3<f64>; 2], point: &Point3<f64>) -> f64 {
    let way = b - a;
    let share = (point - a).dot(&way) / way.norm_squared().max(f64::MIN_POSITIVE);
    share.clamp(0.0, 1.0)
}

/// Rulings to begin at.
pub(super) struct Grid {
    rulings: Vec<(f64, [Point3<f64>; 2])>,
}

impl Grid {
    /// Evenly over the parameter.
    pub(super) fn new(surface: &Ruled, regions: usize) -> Grid {
        let count = LOOKED_AT * regions;
        let at = |i: usize| i as f64 / count as f64;
        Grid {
            rulings: (0..=count)
                .map(|i| (at(i), surface.ruling(at(i))))
                .collect(),
        }
    }

    /// (u, v) of the nearest point of the rulings.
    pub(super) fn on_surface(&self, point: &Point3<f64>) -> [f64; 2] {
        let foot = |(u, ruling): &(f64, [Point3<f64>; 2])| {
            let v = share(*ruling, point);
            let apart = (ruling[0] + (ruling[1] - ruling[0]) * v - point).norm_squared();
            (apart, [*u, v])
        };
        let nearest = self
            .rulings
            .iter()
            .map(foot)
            .min_by(|a, b| a.0.total_cmp(&b.0));
        nearest.map_or([0.0; 2], |(_, place)| place)
    }

    /// u of the nearest end on a side.
    pub(super) fn on_side(&self, side: usize, point: &Point3<f64>) -> f64 {
        let apart = |(_, ends): &&(f64, [Point3<f64>; 2])| (ends[side] - point).norm_squared();
        let nearest = self
            .rulings
            .iter()
            .min_by(|a, b| apart(a).total_cmp(&apart(b)));
        nearest.map_or(0.0, |(u, _)| *u)
    }
}

/// The foot on the surface near (u, v), both in [0, 1]: Newton's method, Gauss
/// and Newton's where the point lies beyond the centre of curvature.
pub(super) fn on_surface(surface: &Ruled, point: &Point3<f64>, near: [f64; 2]) -> [f64; 2] {
    let [mut u, mut v] = near;
    for _ in 0..STEPS {
        let jet = surface.jet(u, v);
        let off = point - jet.point;
        let slope = [off.dot(&jet.u), off.dot(&jet.v)];
        let gauss = [
            jet.u.norm_squared(),
            jet.u.dot(&jet.v),
            jet.v.norm_squared(),
        ];
        let newton = [
            gauss[0] - off.dot(&jet.uu),
            gauss[1] - off.dot(&jet.uv),
            gauss[2],
        ];
        let determinant = |h: &[f64; 3]| h[0] * h[2] - h[1] * h[1];
        /// Share of Gauss and Newton's determinant that Newton's must have.
        const SAFE: f64 = 0.1;
        let safe = newton[0] > 0.0 && determinant(&newton) > SAFE * determinant(&gauss);
        let h = if safe { newton } else { gauss };
        let step = [
            (slope[0] * h[2] - slope[1] * h[1]) / determinant(&h),
            (slope[1] * h[0] - slope[0] * h[1]) / determinant(&h),
        ];
        if !step.iter().all(|s| s.is_finite()) {
            break;
        }
        let next = (u + step[0]).clamp(0.0, 1.0);
        // v by itself: where u was cut off it is another one.
        let there = share(surface.ruling(next), point);
        let moved = (next - u).abs().max((there - v).abs());
        [u, v] = [next, there];
        if moved < SMALL {
            break;
        }
    }
    [u, v]
}

/// The foot on a curve near u, as on the surface.
pub(super) fn on_curve(curve: &BSplineCurve, point: &Point3<f64>, near: f64) -> f64 {
    let mut u = near;
    for _ in 0..STEPS {
        let jet = curve.derivatives(u);
        let off = point - jet.point;
        let (slope, speed) = (off.dot(&jet.d1), jet.d1.norm_squared());
        let newton = speed - off.dot(&jet.d2);
        /// As on the surface.
        const SAFE: f64 = 0.1;
        let step = slope / if newton > SAFE * speed { newton } else { speed };
        if !step.is_finite() {
            break;
        }
        let next = (u + step).clamp(0.0, 1.0);
        let moved = (next - u).abs();
        u = next;
        if moved < SMALL {
            break;
        }
    }
    u
}
