//! The workshop sheet of a patch on the wire.

use super::super::curves::{Point, finite};
use super::super::flat::FlatPoint;
use super::super::index::IndexPair;
use super::KindWord;
use crate::methods::cone_spline::outcome::{Axis, BendSide, FlatSector, Grid, Kind, Patch, Trim};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// The sheet a workshop rolls a patch from.
///
/// Coordinates (s, λ): λ is the length along a ruling from the patch's base
/// line, growing from side 0 of the strip to side 1; s is the arc length along
/// that base line from the patch's first ruling.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ConePatch {
    /// Its name.
    pub name: String,
    /// What it is.
    pub kind: KindWord,
    /// Apex of a cone; else null.
    pub apex: Option<Point>,
    /// Axis of a cone or cylinder; else null.
    pub axis: Option<ConeAxis>,
    /// Angle between a cone's rulings and its axis, degrees; else null.
    pub half_angle_deg: Option<f64>,
    /// Radius of a cylinder; else null.
    pub radius: Option<f64>,
    /// Distance from a cone's apex along the rulings, least and largest; for
    /// cylinders and planes λ, least and largest.
    #[schema(min_items = 2, max_items = 2, value_type = Vec<f64>)]
    pub slant_range: [f64; 2],
    /// Radius of the circle about the axis at either end of the slant range;
    /// null for planes.
    #[schema(min_items = 2, max_items = 2, value_type = Option<Vec<f64>>)]
    pub end_radii: Option<[f64; 2]>,
    /// By how much it is rolled about its axis, degrees.
    pub turn_deg: f64,
    /// Least radius of curvature on it; null for planes.
    pub min_bend_radius: Option<f64>,
    /// Strain of the outer fibre, percent; null without a thickness.
    pub bend_strain_percent: Option<f64>,
    /// Towards which side it is bent, `front` being where the strip's normals
    /// point; null for planes.
    pub bend_side: Option<BendSideWord>,
    /// Its first and last ruling.
    pub rulings: IndexPair,
    /// Its edges along side 0 and side 1 of the strip.
    #[schema(min_items = 2, max_items = 2, value_type = Vec<ConeTrim>)]
    pub trims: [ConeTrim; 2],
    /// Its whole outline in (s, λ); the first point is not repeated.
    pub outline: Vec<FlatPoint>,
    /// The same in the parameters (u, v) of its surface, point for point: the
    /// loop that trims it.
    #[serde(default)]
    pub outline_uv: Vec<FlatPoint>,
    /// Its flat shape on its own.
    pub flat: ConeFlat,
    /// Lines to mark for the rolls in the flat pattern, from side 0 to side 1.
    #[schema(value_type = Vec<Vec<FlatPoint>>)]
    pub bend_lines: Vec<[FlatPoint; 2]>,
    /// Area inside the outline.
    pub area: f64,
    /// Places all over it with their distances; values to colour by.
    pub grid: ConeGrid,
    /// Vertices of the strip that belong to it.
    pub vertices: usize,
    /// Largest distance of those.
    pub error_max: f64,
    /// Mean distance of those, by area.
    pub error_mean: f64,
}

/// Places on a patch inside its outline.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ConeGrid {
    /// Places in a row, which runs along a ruling from side 0 of the strip to
    /// side 1.
    pub across: usize,
    /// The places, row after row; in a corner of the strip a row shrinks to a
    /// point.
    pub points: Vec<Point>,
    /// Signed distance of the strip at each: that of its vertices
    /// (`vertex_distances`), between them as over its triangles.
    pub distances: Vec<f64>,
}

/// A line in space.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ConeAxis {
    /// The point of it nearest to the middle of the patch's first ruling.
    pub point: Point,
    /// Unit direction: from a cone's apex into the cone; along a cylinder's
    /// rulings from side 0 to side 1.
    #[schema(min_items = 3, max_items = 3, value_type = Vec<f64>)]
    pub direction: [f64; 3],
}

/// An edge of a patch along one side of the strip.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ConeTrim {
    /// In space, on the patch.
    pub points: Vec<Point>,
    /// In (s, λ), point for point.
    pub parameters: Vec<FlatPoint>,
}

/// Towards which side a patch is bent.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum BendSideWord {
    /// Its axis lies on the side of the strip's normals.
    Front,
    /// Its axis lies on the other side.
    Back,
}

/// The flat shape of a patch.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(tag = "shape", rename_all = "snake_case")]
pub enum ConeFlat {
    /// A sector of a ring, of a cone.
    Ring {
        /// The unrolled apex, in the flat pattern.
        center: FlatPoint,
        /// Inner and outer radius: the slant range.
        #[schema(min_items = 2, max_items = 2, value_type = Vec<f64>)]
        radii: [f64; 2],
        /// Direction of the first ruling from the centre, degrees.
        start_deg: f64,
        /// Signed angle from the first ruling to the last, degrees.
        angle_deg: f64,
    },
    /// A rectangle, of a cylinder or plane.
    Rectangle {
        /// Along the arc.
        length: f64,
        /// Along the rulings.
        height: f64,
    },
}

impl From<&Patch> for ConePatch {
    fn from(p: &Patch) -> Self {
        ConePatch {
            name: p.name.clone(),
            kind: p.kind.into(),
            apex: p.apex.map(Into::into),
            axis: p.axis.as_ref().map(Into::into),
            half_angle_deg: p.half_angle_deg,
            radius: p.radius,
            slant_range: p.slant_range,
            end_radii: p.end_radii,
            turn_deg: p.turn_deg,
            min_bend_radius: finite(p.min_bend_radius),
            bend_strain_percent: p.bend_strain_percent,
            bend_side: p.bend_side.map(Into::into),
            rulings: p.rulings.into(),
            trims: p.trims.each_ref().map(Into::into),
            outline: p.outline.iter().map(|p| (*p).into()).collect(),
            outline_uv: p.outline_uv.iter().map(|p| (*p).into()).collect(),
            flat: (&p.flat).into(),
            bend_lines: p.bend_lines.iter().map(|l| l.map(Into::into)).collect(),
            area: p.area,
            grid: (&p.grid).into(),
            vertices: p.vertices,
            error_max: p.error_max,
            error_mean: p.error_mean,
        }
    }
}

impl From<&Grid> for ConeGrid {
    fn from(grid: &Grid) -> Self {
        ConeGrid {
            across: grid.across,
            points: grid.points.iter().map(|p| (*p).into()).collect(),
            distances: grid.distances.clone(),
        }
    }
}

impl From<Kind> for KindWord {
    fn from(kind: Kind) -> Self {
        match kind {
            Kind::Cone => KindWord::Cone,
            Kind::Cylinder => KindWord::Cylinder,
            Kind::Plane => KindWord::Plane,
        }
    }
}

impl From<BendSide> for BendSideWord {
    fn from(side: BendSide) -> Self {
        match side {
            BendSide::Front => BendSideWord::Front,
            BendSide::Back => BendSideWord::Back,
        }
    }
}

impl From<&Axis> for ConeAxis {
    fn from(axis: &Axis) -> Self {
        ConeAxis {
            point: axis.point.into(),
            direction: axis.direction.into(),
        }
    }
}

impl From<&Trim> for ConeTrim {
    fn from(trim: &Trim) -> Self {
        ConeTrim {
            points: trim.points.iter().map(|p| (*p).into()).collect(),
            parameters: trim.parameters.iter().map(|p| (*p).into()).collect(),
        }
    }
}

impl From<&FlatSector> for ConeFlat {
    fn from(flat: &FlatSector) -> Self {
        match *flat {
            FlatSector::Ring {
                center,
                radii,
                start_deg,
                angle_deg,
            } => ConeFlat::Ring {
                center: center.into(),
                radii,
                start_deg,
                angle_deg,
            },
            FlatSector::Rectangle { length, height } => ConeFlat::Rectangle { length, height },
        }
    }
}
