//! What makes a region conical and its joints smooth (sec. 2.2.3), with
//! gradients. For a ruling with ends A on side 0 and B on side 1,
//! L = (A − B)/|A − B|, and a cone (M, V, θ, d), V̂ = V/|V|:
//!
//! ```text
//! F_angle  = Σ (V̂·L − cos θ)²                      (the paper lacks the minus)
//! F_d1     = Σ (D²(M, L) − d²)²
//! F_d2     = Σ (D²(M + c V̂, L) − (d − c sin θ)²)²
//! F_smooth = |Nᵢ × Nⱼ|²,  N the unit direction of Q − M,
//! ```
//!
//! D the distance of a point from the ruling's line, Q its foot on the line.

use super::cone::{Cone, NUMBERS};
use nalgebra::{Point3, Vector3};

/// β: the paper gives no value. On strips like its own 1 lets the distances,
/// which are small and squared twice, say too little beside the angles (the
/// stitching then moves more), and 100 slows the descent without gain.
pub(super) const BETA: f64 = 10.0;
/// c, in the unit of the strip, which is about one long; the paper gives no
/// value, and 0.1 does as well.
pub(super) const BEYOND: f64 = 0.3;

/// A ruling's line.
#[derive(Debug, Clone, Copy)]
pub(super) struct Line {
    from: Point3<f64>,
    direction: Vector3<f64>,
    length: f64,
}

/// Derivatives by the ruling's ends on side 0 and side 1.
pub(super) type ByEnds = [Vector3<f64>; 2];

impl Line {
    pub(super) fn new([a, b]: [Point3<f64>; 2]) -> Line {
        let way = a - b;
        let length = way.norm().max(f64::MIN_POSITIVE);
        Line {
            from: a,
            direction: way / length,
            length,
        }
    }

    /// From the line's foot of a point to the point, and how far along the
    /// line that foot lies from A.
    fn across(&self, point: &Point3<f64>) -> (Vector3<f64>, f64) {
        let q = point - self.from;
        let along = q.dot(&self.direction);
        (q - along * self.direction, along)
    }

    /// Adds h·d(across) for an h perpendicular to the line.
    fn pull(&self, h: &Vector3<f64>, along: f64, by_ends: &mut ByEnds) -> Vector3<f64> {
        let turn = h * (along / self.length);
        by_ends[0] -= h + turn;
        by_ends[1] += turn;
        *h
    }

    /// Adds h·dL.
    fn turn(&self, h: &Vector3<f64>, by_ends: &mut ByEnds) {
        let across = (h - self.direction * h.dot(&self.direction)) / self.length;
        by_ends[0] += across;
        by_ends[1] -= across;
    }
}

/// F_angle + β F_d1 + β F_d2 of one ruling; derivatives times `weight` are
/// added.
pub(super) fn conical(
    line: &Line,
    cone: &Cone,
    weight: f64,
    by_ends: &mut ByEnds,
    by_cone: &mut [f64],
) -> f64 {
    let size = cone.along.norm().max(f64::MIN_POSITIVE);
    let axis = cone.along / size;
    let (sin, cos) = cone.angle.sin_cos();
    let mut by_axis = Vector3::zeros();
    let mut by_point = Vector3::zeros();
    let (mut by_angle, mut by_distance) = (0.0, 0.0);

    let off = axis.dot(&line.direction) - cos;
    let w = 2.0 * weight * off;
    by_axis += w * line.direction;
    line.turn(&(w * axis), by_ends);
    by_angle += w * sin;
    let mut value = off * off;

    for beyond in [0.0, BEYOND] {
        let (across, along) = line.across(&(cone.point + beyond * axis));
        let reach = cone.distance - beyond * sin;
        let off = across.norm_squared() - reach * reach;
        value += BETA * off * off;
        let w = 2.0 * weight * BETA * off;
        let h = line.pull(&(2.0 * w * across), along, by_ends);
        by_point += h;
        by_axis += beyond * h;
        by_distance -= w * 2.0 * reach;
        by_angle += w * 2.0 * reach * beyond * cos;
    }

    let by_along = (by_axis - axis * by_axis.dot(&axis)) / size;
    for k in 0..3 {
        by_cone[k] += by_point[k];
        by_cone[3 + k] += by_along[k];
    }
    by_cone[6] += by_angle;
    by_cone[7] += by_distance;
    value
}

/// F_smooth of a joint's ruling; derivatives times `weight` are added.
pub(super) fn smooth(
    line: &Line,
    cones: [&Cone; 2],
    weight: f64,
    by_ends: &mut ByEnds,
    by_cones: &mut [f64],
) -> f64 {
    let feet = cones.map(|c| line.across(&c.point));
    let sizes = feet.map(|(across, _)| across.norm().max(f64::MIN_POSITIVE));
    let normals = [0, 1].map(|i| feet[i].0 / sizes[i]);
    let along = normals[0].dot(&normals[1]);
    for i in 0..2 {
        // |N₀ × N₁|² = 1 − (N₀·N₁)².
        let slope = (normals[1 - i] - along * normals[i]) / sizes[i];
        let h = line.pull(&(-2.0 * weight * along * slope), feet[i].1, by_ends);
        for k in 0..3 {
            by_cones[i * NUMBERS + k] += h[k];
        }
    }
    normals[0].cross(&normals[1]).norm_squared()
}
