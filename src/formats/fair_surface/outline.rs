//! The outline of a trimmed surface as closed polygons in (u, v), and what
//! lies inside.

use super::FairSurfaceDrawing;
use crate::geometry::Axis;

/// Closed polygons; a place is inside when a ray from it crosses them an odd
/// number of times.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::formats) struct Outline {
    /// The outer one first, then holes; each of at least three corners.
    pub rings: Vec<Vec<[f64; 2]>>,
}

impl Outline {
    /// The outline of a drawing, moved into the domain of the surface;
    /// polygons of fewer than three corners, or with corners that are not
    /// finite, are none.
    pub fn of(drawing: &FairSurfaceDrawing) -> Self {
        let [us, vs] = [Axis::U, Axis::V].map(|axis| drawing.surface.domain(axis));
        let usable =
            |ring: &&Vec<[f64; 2]>| ring.len() > 2 && ring.iter().flatten().all(|c| c.is_finite());
        let inside = |ring: &Vec<[f64; 2]>| {
            let corner = |c: &[f64; 2]| [c[0].clamp(us[0], us[1]), c[1].clamp(vs[0], vs[1])];
            ring.iter().map(corner).collect::<Vec<_>>()
        };
        let whole = vec![
            [us[0], vs[0]],
            [us[1], vs[0]],
            [us[1], vs[1]],
            [us[0], vs[1]],
        ];
        let outer = Some(&drawing.outer).filter(usable).map_or(whole, inside);
        let mut rings = vec![outer];
        rings.extend(drawing.holes.iter().filter(usable).map(inside));
        Outline { rings }
    }

    /// Whether a place is inside.
    pub fn contains(&self, [u, v]: [f64; 2]) -> bool {
        let mut inside = false;
        for [a, b] in self.edges() {
            if (a[1] > v) != (b[1] > v) {
                let crossing = a[0] + (v - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
                inside ^= u < crossing;
            }
        }
        inside
    }

    /// All edges.
    pub fn edges(&self) -> impl Iterator<Item = [[f64; 2]; 2]> + '_ {
        self.rings.iter().flat_map(|ring| {
            let next = ring.iter().cycle().skip(1);
            ring.iter().zip(next).map(|(a, b)| [*a, *b])
        })
    }
}

/// The distance of a place from a segment.
pub(super) fn distance_to_segment(p: [f64; 2], [a, b]: [[f64; 2]; 2]) -> f64 {
    let [dx, dy] = [b[0] - a[0], b[1] - a[1]];
    let length = dx * dx + dy * dy;
    let along = ((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / length;
    let t = if length > 0.0 {
        along.clamp(0.0, 1.0)
    } else {
        0.0
    };
    (p[0] - a[0] - t * dx).hypot(p[1] - a[1] - t * dy)
}
