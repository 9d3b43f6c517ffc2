//! The cone that osculates a ruled surface along a ruling (sec. 2.1 (1)): its
//! axis goes through the centres of curvature at both ends,
//! Cᵢ = Pᵢ + Nᵢ/ρᵢ, ρᵢ the principal curvature of larger size.

use super::ruled::{Jet, Ruled};
use nalgebra::{Point3, Vector3};

/// Radii of curvature are cut off at so many units (a strip is about one
/// long): the paper has no planes, and one flat ruling would otherwise make
/// all other axes alike (its features are divided by the largest).
const LARGEST_RADIUS: f64 = 5.0;

/// A ruling with the axis of the cone along it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Axis {
    /// Parameter of the ruling.
    pub(super) u: f64,
    /// Its end on side 0.
    pub(super) place: Point3<f64>,
    /// Unit direction of the axis, from side 0 to side 1. Where the surface
    /// turns its hollow side it jumps to its opposite, which is the same axis.
    pub(super) direction: Vector3<f64>,
    /// The axis' Plücker moment a × d, a any of its points. (The paper writes
    /// a × b, b a second point, which depends on the choice of both.)
    pub(super) moment: Vector3<f64>,
}

/// Axes at `count` rulings, evenly over the parameter.
pub(super) fn along(surface: &Ruled, count: usize) -> Vec<Axis> {
    let at = |i: usize| {
        let u = (i as f64 + 0.5) / count as f64;
        let ends = [0.0, 1.0].map(|v| centre(&surface.jet(u, v)));
        let way = ends[1] - ends[0];
        let direction = way.try_normalize(0.0).unwrap_or_else(Vector3::z);
        Axis {
            u,
            place: surface.sides[0].point(u),
            direction,
            moment: ends[0].coords.cross(&direction),
        }
    };
    (0..count).map(at).collect()
}

/// The centre of the larger principal curvature.
fn centre(jet: &Jet) -> Point3<f64> {
    let Some(normal) = jet.u.cross(&jet.v).try_normalize(0.0) else {
        return jet.point;
    };
    let [e, f, g] = [
        jet.u.norm_squared(),
        jet.u.dot(&jet.v),
        jet.v.norm_squared(),
    ];
    let [l, m] = [jet.uu.dot(&normal), jet.uv.dot(&normal)];
    // With the second form [l, m; m, 0]: mean and Gauss curvature.
    let area = e * g - f * f;
    let (mean, gauss) = (0.5 * (l * g - 2.0 * f * m) / area, -m * m / area);
    let root = (mean * mean - gauss).max(0.0).sqrt();
    let curvature = mean + root.copysign(mean);
    let radius = if curvature.abs() * LARGEST_RADIUS < 1.0 {
        LARGEST_RADIUS.copysign(curvature)
    } else {
        1.0 / curvature
    };
    jet.point + normal * radius
}
