//! How well neighbours join, measured on what is returned of them.

use super::super::outcome::{Join, Kind, Patch, Ruling};
use nalgebra::{Point3, Unit, Vector3};

/// Places along a ruling where it is measured.
const PLACES: usize = 5;

/// Angle and gap at every inner ruling.
pub(super) fn measure(patches: &[Patch], rulings: &[Ruling]) -> Vec<Join> {
    patches
        .windows(2)
        .zip(&rulings[1..])
        .map(|(pair, ruling)| {
            let mut join = Join {
                ruling: ruling.id,
                angle_deg: 0.0,
                gap: 0.0,
            };
            for i in 0..PLACES {
                let share = i as f64 / (PLACES - 1) as f64;
                let place = ruling.from + (ruling.to - ruling.from) * share;
                let [a, b] = [0, 1].map(|k| Tangent::of(&pair[k], &place, k == 0));
                join.gap = join.gap.max(a.gap).max(b.gap);
                let angle = a.normal.cross(&b.normal).norm();
                join.angle_deg = join.angle_deg.max(angle.asin().to_degrees());
            }
            join
        })
        .collect()
}

/// A patch at a place that should lie on it.
struct Tangent {
    /// Unit normal of the patch there.
    normal: Vector3<f64>,
    /// Distance of the place from the patch's cone, cylinder or plane.
    gap: f64,
}

impl Tangent {
    /// From apex, axis, angle and radius; of a plane, from its surface's
    /// corners.
    fn of(patch: &Patch, place: &Point3<f64>, at_end: bool) -> Tangent {
        match (patch.kind, patch.apex, patch.axis) {
            (Kind::Cone, Some(apex), Some(axis)) => {
                let half = patch.half_angle_deg.unwrap_or_default().to_radians();
                cone(place - apex, &axis.direction, half)
            }
            (Kind::Cylinder, _, Some(axis)) => {
                let from = place - axis.point;
                let across = from - from.dot(&axis.direction) * axis.direction;
                Tangent {
                    normal: Unit::new_normalize(across).into_inner(),
                    gap: (across.norm() - patch.radius.unwrap_or_default()).abs(),
                }
            }
            _ => plane(patch, place, at_end),
        }
    }
}

/// Distance and normal of a cone by the angle between the line from the apex
/// and the axis.
fn cone(from_apex: Vector3<f64>, axis: &Vector3<f64>, half: f64) -> Tangent {
    let along = from_apex.dot(axis);
    let radial = from_apex - along * axis;
    let out = Unit::new_normalize(radial).into_inner();
    let (sin, cos) = half.sin_cos();
    Tangent {
        normal: cos * out - sin * axis,
        gap: (cos * radial.norm() - sin * along).abs(),
    }
}

fn plane(patch: &Patch, place: &Point3<f64>, at_end: bool) -> Tangent {
    let points = patch.surface.control_points();
    let n = points.len();
    let (near, far) = if at_end {
        ([points[n - 2], points[n - 1]], points[0])
    } else {
        ([points[0], points[1]], points[n - 1])
    };
    let normal = Unit::new_normalize((near[1] - near[0]).cross(&(far - near[0]))).into_inner();
    Tangent {
        normal,
        gap: (place - near[0]).dot(&normal).abs(),
    }
}
