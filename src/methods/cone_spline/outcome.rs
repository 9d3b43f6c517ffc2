//! What the method gives. Lengths in the unit of the request, angles in
//! degrees; nothing here depends on time or thread count.

use crate::geometry::BSplineSurface;
use nalgebra::{Point2, Point3, Vector3};

/// A strip as patches, with the proof.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// Whether every limit that was asked is kept.
    pub within_limits: bool,
    /// The verdict, then what a loftsman should know.
    pub summary: Vec<String>,
    /// What the user should know about the input.
    pub warnings: Vec<String>,
    /// The longest side of the strip's bounding box.
    pub model_size: f64,
    /// From the start of the strip to its finish.
    pub patches: Vec<Patch>,
    /// The rulings that bound the patches, one more than there are patches:
    /// patch `i` lies between ruling `i` and `i + 1`.
    pub rulings: Vec<Ruling>,
    /// One per inner ruling, measured on the patches that are returned.
    pub joins: Vec<Join>,
    /// The flat pattern: one piece, or several where it would overlap itself.
    pub pattern: Vec<FlatPiece>,
    /// What numbers of patches give by least squares, whatever norm this answer
    /// is for; only of those that can be rolled.
    pub error_curve: Vec<ErrorPoint>,
    /// Distance from the vertices of the strip to the patches.
    pub to_surface: Distance,
    /// Distance from the patches to the strip's triangles.
    pub to_mesh: Distance,
    /// Signed distance of every vertex, in the order of [`super::target::Target::points`];
    /// positive on the side of the strip's normals.
    pub vertex_distances: Vec<f64>,
    /// The best developable surface found, which more patches can hardly beat.
    pub floor: Floor,
    /// `false`: the tolerance lies below what patches can reach.
    pub reachable: bool,
    /// How the fit came about.
    pub report: Report,
}

/// Places on a patch inside its outline.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// Places in a row, which runs along a ruling from side 0 to side 1.
    pub across: usize,
    /// The places, row after row, the first row at the least s. A row shrinks
    /// to a point in a corner of the strip.
    pub points: Vec<Point3<f64>>,
    /// The signed distance of the strip there: that of its vertices, between
    /// them as over its triangles.
    pub distances: Vec<f64>,
}

/// What a patch is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Part of a cone of revolution.
    Cone,
    /// Part of a cylinder of revolution.
    Cylinder,
    /// Flat.
    Plane,
}

impl Kind {
    /// A stable word.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Kind::Cone => "cone",
            Kind::Cylinder => "cylinder",
            Kind::Plane => "plane",
        }
    }
}

/// Towards which side a patch is bent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BendSide {
    /// Its axis lies on the side of the strip's normals.
    Front,
    /// Its axis lies on the other side.
    Back,
}

impl BendSide {
    /// A stable word.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            BendSide::Front => "front",
            BendSide::Back => "back",
        }
    }
}

/// One patch: the sheet a workshop rolls it from.
///
/// Coordinates (s, λ): λ is the length along a ruling from the patch's base
/// line, growing from side 0 of the strip to side 1; s is the arc length along
/// that base line from the patch's first ruling. A ruling at s is at
/// `point + s…`: in 3-D an arc about the axis, in the flat a straight line.
#[derive(Debug, Clone, PartialEq)]
pub struct Patch {
    /// `"1"`, `"2"`, … or with the strip's name before it.
    pub name: String,
    /// What it is.
    pub kind: Kind,
    /// Apex of a cone.
    pub apex: Option<Point3<f64>>,
    /// Axis of a cone or cylinder.
    pub axis: Option<Axis>,
    /// Angle between a cone's rulings and its axis.
    pub half_angle_deg: Option<f64>,
    /// Radius of a cylinder.
    pub radius: Option<f64>,
    /// Distance from a cone's apex along the rulings, least and largest; for
    /// cylinders and planes λ, least and largest.
    pub slant_range: [f64; 2],
    /// Radius of the circle about the axis at either end of the slant range;
    /// `None` for planes.
    pub end_radii: Option<[f64; 2]>,
    /// By how much it is rolled, about its axis.
    pub turn_deg: f64,
    /// Least radius of curvature on it; infinite for planes.
    pub min_bend_radius: f64,
    /// Outer-fibre strain thickness / (2 R), percent, when a thickness is given.
    pub bend_strain_percent: Option<f64>,
    /// Towards which side it is bent; `None` for planes.
    pub bend_side: Option<BendSide>,
    /// Indices of its first and last ruling in [`Outcome::rulings`].
    pub rulings: [usize; 2],
    /// Its edges along side 0 and side 1 of the strip.
    pub trims: [Trim; 2],
    /// Its whole outline in (s, λ), closed (the first point is not repeated).
    pub outline: Vec<Point2<f64>>,
    /// The same in the parameters (u, v) of its surface, point for point.
    pub outline_uv: Vec<Point2<f64>>,
    /// Its flat shape on its own.
    pub flat: FlatSector,
    /// Lines to mark for the rolls, in the coordinates of the strip's flat
    /// pattern, from side 0 to side 1.
    pub bend_lines: Vec<[Point2<f64>; 2]>,
    /// The exact surface: degree `[2, 1]`, rational, u along the arc from the
    /// first ruling, v from the least λ to the largest; its trimmed part is
    /// inside the outline.
    pub surface: BSplineSurface,
    /// Area inside the outline.
    pub area: f64,
    /// Places all over it, to show it by.
    pub grid: Grid,
    /// Vertices of the strip that belong to it.
    pub vertices: usize,
    /// Largest distance of those.
    pub error_max: f64,
    /// Mean distance of those, by area.
    pub error_mean: f64,
}

/// A line in space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Axis {
    /// The point of it nearest to the middle of the patch's first ruling.
    pub point: Point3<f64>,
    /// Unit direction: from a cone's apex into the cone; along a cylinder's
    /// rulings from side 0 to side 1.
    pub direction: Vector3<f64>,
}

/// A ruling, from side 0 to side 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ruling {
    /// Its number, from the start of the strip.
    pub id: usize,
    /// End on side 0.
    pub from: Point3<f64>,
    /// End on side 1.
    pub to: Point3<f64>,
    /// The same in the flat pattern (of the piece that ends there, where the
    /// pattern is cut at this ruling).
    pub flat: [Point2<f64>; 2],
}

/// An edge of a patch along one long side.
#[derive(Debug, Clone, PartialEq)]
pub struct Trim {
    /// In space, on the patch.
    pub points: Vec<Point3<f64>>,
    /// In (s, λ), point for point.
    pub parameters: Vec<Point2<f64>>,
}

/// The flat shape of one patch: a sector of a ring, or a rectangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FlatSector {
    /// Of a cone: in the strip's flat pattern.
    Ring {
        /// The unrolled apex.
        center: Point2<f64>,
        /// Inner and outer radius: the slant range.
        radii: [f64; 2],
        /// Direction of the first ruling, from the centre, degrees.
        start_deg: f64,
        /// Signed angle from the first ruling to the last, degrees.
        angle_deg: f64,
    },
    /// Of a cylinder or plane.
    Rectangle {
        /// Along the arc.
        length: f64,
        /// Along the rulings.
        height: f64,
    },
}

/// Two neighbouring patches, measured on what is returned of them: apex, axis,
/// angle, radius.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Join {
    /// The ruling where they meet.
    pub ruling: usize,
    /// Largest angle between their normals along it.
    pub angle_deg: f64,
    /// Largest distance of the ruling from either.
    pub gap: f64,
}

/// A flat pattern, true to size.
#[derive(Debug, Clone, PartialEq)]
pub struct FlatPiece {
    /// First patch and one past the last.
    pub patches: [usize; 2],
    /// Closed outline (the first point is not repeated).
    pub outline: Vec<Point2<f64>>,
    /// Area.
    pub area: f64,
}

/// What a number of patches gives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorPoint {
    /// Number of patches.
    pub patches: usize,
    /// Largest distance of a vertex.
    pub max: f64,
    /// Mean distance, by area.
    pub mean: f64,
    /// Root mean square, by area.
    pub rms: f64,
}

/// Figures of a distance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Distance {
    /// Largest.
    pub max: f64,
    /// Where the largest begins.
    pub at: Point3<f64>,
    /// The vertex of the strip there, when it begins at one.
    pub vertex: Option<usize>,
    /// Mean, by area.
    pub mean: f64,
    /// Root mean square, by area.
    pub rms: f64,
}

/// The best developable surface found for the strip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Floor {
    /// Largest distance of a vertex.
    pub max: f64,
    /// Mean distance, by area.
    pub mean: f64,
    /// Root mean square, by area.
    pub rms: f64,
    /// Patches of the fine chain behind it.
    pub patches: usize,
}

/// How the fit came about.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// `"asked"`, `"the tolerance"`, `"the noise"`.
    pub pieces_from: &'static str,
    /// `"least_squares"`, `"eighth_powers"` or `"minimax"`.
    pub norm: &'static str,
    /// Standard deviation of the vertices across the surface, where the number
    /// of patches follows from it.
    pub noise: Option<f64>,
    /// Vertices that lost their hold on the shape (`robust`).
    pub outliers: Vec<usize>,
    /// Iterations of the solver, all stages together.
    pub iterations: usize,
    /// Why the last stage stopped.
    pub termination: &'static str,
}
