//! The hull that plates belong to: which way is along it, which way is inside.

use super::stations::round_stations;
use crate::geometry::{BoundingBox, RuledSurface};
use crate::numerics::GaussLegendre;
use nalgebra::{Point3, Vector3};

/// Stations along the hull, about.
const STATIONS: f64 = 20.0;
/// A half hull may cross its centre plane by this share of its length.
const ACROSS_CENTRE: f64 = 0.01;
/// Below this mean cosine between normals and the way outwards, a plate has no
/// inside: it stands edge on.
const EDGE_ON: f64 = 0.05;
/// Nodes a knot span, for a mean.
const NODES: usize = 3;

/// Axes, centre and stations of a hull.
#[derive(Debug, Clone, PartialEq)]
pub struct HullFrame {
    /// The coordinate along the hull: that of its longest side.
    axis: usize,
    /// The middle of the whole hull.
    centre: Point3<f64>,
    stations: Vec<f64>,
}

/// Which side of a plate lies up in its pattern.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// The side towards the hull's middle.
    Inside,
    /// The plate stands edge on to the middle: the side of `Su × Sv`, from
    /// which the first boundary lies below the second and runs to the right.
    FirstBelow,
}

impl HullFrame {
    /// Of the hull that these plates make. Where they lie on one side of the
    /// centre plane (y = 0 with x along the hull), they are half of it. `None`
    /// without plates.
    #[must_use]
    pub fn around(plates: &[RuledSurface]) -> Option<Self> {
        let boxes = plates.iter().map(|p| {
            let first = p.first().bounding_box();
            first.union(&p.second().bounding_box())
        });
        let all = boxes.reduce(|a, b: BoundingBox| a.union(&b))?;
        let size = all.max - all.min;
        let axis = size.imax();
        let mut centre = all.center();
        let athwart = match axis {
            0 => Some(1),
            1 => Some(0),
            _ => None,
        };
        if let Some(k) = athwart {
            let margin = ACROSS_CENTRE * size[axis];
            if all.min[k] >= -margin || all.max[k] <= margin {
                centre[k] = 0.0;
            }
        }
        Some(HullFrame {
            axis,
            centre,
            stations: round_stations([all.min[axis], all.max[axis]], STATIONS),
        })
    }

    /// The coordinate along the hull: 0 for x.
    #[must_use]
    pub fn axis(&self) -> usize {
        self.axis
    }

    /// Round values of it.
    #[must_use]
    pub fn stations(&self) -> &[f64] {
        &self.stations
    }

    /// The cosine between the normal `Su × Sv` and the way outwards, from the
    /// hull's middle line, as a mean over a plate.
    pub(super) fn outwards(&self, plate: &RuledSurface, breaks: &[f64]) -> f64 {
        let rule = GaussLegendre::new(NODES);
        let (mut sum, mut whole) = (0.0, 0.0);
        for span in breaks.windows(2) {
            for (u, weight) in rule.on(span[0], span[1]) {
                let s = plate.ruling(u).surface(0.5);
                let mut arm: Vector3<f64> = s.point - self.centre;
                arm[self.axis] = 0.0;
                let normal = s.du.cross(&s.dv) * weight;
                sum += normal.dot(&arm);
                whole += normal.norm() * arm.norm();
            }
        }
        if whole > 0.0 { sum / whole } else { 0.0 }
    }

    /// The side of a plate to look at, and whether that is the side of
    /// `Su × Sv`.
    pub(super) fn side(&self, plate: &RuledSurface, breaks: &[f64]) -> (Side, bool) {
        let outwards = self.outwards(plate, breaks);
        if outwards.abs() < EDGE_ON {
            (Side::FirstBelow, true)
        } else {
            (Side::Inside, outwards < 0.0)
        }
    }
}
