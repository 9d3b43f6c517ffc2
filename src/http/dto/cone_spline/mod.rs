//! The job of `cone_spline` on the wire. Bounds of single values are written
//! here, as the schema that is published and checked; its way into the
//! method's request is [`to_request`].

mod diagnostics;
mod drawing;
mod patch;
mod result;
mod to_request;

pub use diagnostics::ConeSplineDiagnostics;
pub use result::ConeSplineResult;
pub use to_request::to_request;

use super::curves::Point;
use super::index::Index;
use super::mesh::MeshInput;
use super::surface_input::SurfaceInput;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;
use uuid::Uuid;

/// What `cone_spline` takes: exactly one of `mesh`, `surface` and `job`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ConeSplineInput {
    /// Your name for the strip; patches are called after it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(min_length = 1, max_length = 100, examples("shoulder"))]
    pub name: Option<String>,
    /// The strip as a mesh of triangles and quads: one piece with four corners
    /// (or running out in a point), or a ring. Vertices and faces may come in
    /// any order.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mesh: Option<MeshInput>,
    /// The strip as a ruled surface: degree `[p, 1]`, two rows of control
    /// points, v along the rulings.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub surface: Option<SurfaceInput>,
    /// A finished `hull_plates` job of yours. Its plate is put into the job in
    /// the place of this when it is posted, as a `surface` in this job's unit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub job: Option<Uuid>,
    /// Which plate of that job, counted from 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(minimum = 0, maximum = 1000, value_type = Option<u32>)]
    pub plate: Option<Index>,
}

/// What is asked of the patches. Lengths in the job's unit. At most one of
/// `tolerance` and `pieces`; without either as many patches as the noise of the
/// vertices lets one tell apart.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields, default)]
#[schema(default)]
pub struct ConeSplineOptions {
    /// As few patches as keep every vertex within this length.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(exclusive_minimum = 0)]
    pub tolerance: Option<f64>,
    /// Exactly so many patches.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(minimum = 1, maximum = 60, value_type = Option<u32>)]
    pub pieces: Option<Index>,
    /// What is made small. Without it the largest distance where a `tolerance`
    /// is given; with `pieces` eighth powers where the distances come from the
    /// shape; else, and where they come from noise, the squares.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub norm: Option<NormOption>,
    /// Which kinds of patches may be used.
    #[schema(min_items = 1, max_items = 3)]
    pub classes: Vec<KindWord>,
    /// Whether cones become cylinders, and both become planes, where the
    /// tolerance (else the error reached) allows it.
    pub simplify: bool,
    /// Whether vertices far off lose their hold on the shape (Tukey).
    pub robust: bool,
    /// Where a ring is to be cut: through the vertex nearest to this point.
    /// Without it the shortest way across.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cut: Option<Point>,
    /// Plate thickness, for the strain of bending; a length.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(exclusive_minimum = 0)]
    pub thickness: Option<f64>,
    /// The least bend radius that the yard can roll; a length.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(exclusive_minimum = 0)]
    pub min_bend_radius: Option<f64>,
    /// Which algorithm fits. The paper's needs `pieces` and knows neither
    /// `norm`, `classes`, `simplify` nor `robust`.
    pub solver: ConeSplineSolver,
}

impl Default for ConeSplineOptions {
    fn default() -> Self {
        ConeSplineOptions {
            tolerance: None,
            pieces: None,
            norm: None,
            classes: vec![KindWord::Cone, KindWord::Cylinder, KindWord::Plane],
            simplify: false,
            robust: false,
            cut: None,
            thickness: None,
            min_bend_radius: None,
            solver: ConeSplineSolver::Own,
        }
    }
}

/// Which algorithm fits: `own`, this service's, or `paper`, the clustered axes
/// and stitched cones of Zhang, Bo, Zheng & Zhang, for comparison only.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum ConeSplineSolver {
    /// This service's own.
    #[default]
    Own,
    /// The paper's.
    Paper,
}

/// What is made small.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum NormOption {
    /// The sum of squared distances, by area.
    LeastSquares,
    /// The sum of their eighth powers: nearly the least largest distance.
    EighthPowers,
    /// The largest distance of a vertex.
    Minimax,
}

/// What a patch is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum KindWord {
    /// Part of a cone of revolution.
    Cone,
    /// Part of a cylinder of revolution.
    Cylinder,
    /// Flat.
    Plane,
}
