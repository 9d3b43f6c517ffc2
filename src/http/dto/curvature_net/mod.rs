//! The job of `curvature_net` on the wire. Bounds of single values are written
//! here, as the schema that is published and checked; its way into the
//! method's request is [`to_request`].

mod diagnostics;
mod drawing;
mod result;
mod specific;
mod to_request;

pub use diagnostics::CurvatureNetDiagnostics;
pub use result::CurvatureNetResult;
pub use to_request::to_request;

use super::curves::Point;
use super::index::Index;
use super::mesh::MeshInput;
use super::surface_input::SurfaceInput;
use crate::methods::curvature_net::request::{Direction, Options};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// What `curvature_net` takes: exactly one of `mesh` and `grid`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct CurvatureNetInput {
    /// A mesh of quads in which every inner vertex has four neighbours: a
    /// four-sided piece, a ring or a torus. Vertices and faces may come in any
    /// order.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mesh: Option<MeshInput>,
    /// Rows of points, all of one length.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(min_items = 2, max_items = 1000)]
    pub grid: Option<Vec<Vec<Point>>>,
    /// Directions in which a grid closes: `u` from its last row to its first,
    /// `v` from the end of each row to its beginning. The first row or column
    /// is not repeated.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schema(max_items = 2)]
    pub closed: Vec<DirectionWord>,
}

/// A direction of the net: `u` from row to row, `v` along a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum DirectionWord {
    /// From row to row.
    U,
    /// Along a row.
    V,
}

impl From<DirectionWord> for Direction {
    fn from(word: DirectionWord) -> Self {
        match word {
            DirectionWord::U => Direction::U,
            DirectionWord::V => Direction::V,
        }
    }
}

impl From<Direction> for DirectionWord {
    fn from(direction: Direction) -> Self {
        match direction {
            Direction::U => DirectionWord::U,
            Direction::V => DirectionWord::V,
        }
    }
}

/// What is asked of the surface. Lengths in the job's unit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields, default)]
#[schema(default)]
pub struct CurvatureNetOptions {
    /// How often each quad is split in four. Without it until there are 256
    /// patches.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(minimum = 0, maximum = 7, value_type = Option<u32>)]
    pub levels: Option<Index>,
    /// How strongly the net is held to the start, or to the target, against
    /// the usual.
    #[schema(minimum = 0.001, maximum = 1000)]
    pub closeness: f64,
    /// What goes first where a net cannot both keep its shape and be without
    /// umbilics.
    pub umbilics: UmbilicsWord,
    /// A surface that the net keeps close to instead of the start.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub target: Option<TargetOption>,
    /// Whether the exact cyclide spline is asked, not only the smooth surface.
    pub cyclide: bool,
    /// Directions along which conical strips with flat patterns are asked.
    #[schema(max_items = 2)]
    pub strips: Vec<DirectionWord>,
    /// Distances of offsets along the normals (u × v), none 0.
    #[schema(max_items = 20)]
    pub offsets: Vec<f64>,
    /// The support structure: strips along the normals of all lines.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub supports: Option<SupportsOption>,
    /// Which algorithm makes the smooth surface.
    pub solver: CurvatureNetSolver,
}

/// What goes first: `avoid`, that the net has no umbilic, its shape goes as far
/// as it must; or `keep_shape`, umbilics stay where the curvatures of the start
/// pass each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum UmbilicsWord {
    /// No umbilics.
    #[default]
    Avoid,
    /// The shape.
    KeepShape,
}

/// A surface to keep close to: exactly one of `mesh` and `surface`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct TargetOption {
    /// A mesh of triangles and quads.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mesh: Option<MeshInput>,
    /// A B-spline surface.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub surface: Option<SurfaceInput>,
}

/// Strips that stand on all lines along the normals.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct SupportsOption {
    /// Their height along the normals (u × v), a length; negative: against
    /// them.
    pub height: f64,
}

/// Which algorithm makes the smooth surface: `own`, this service's, or
/// `paper`, the Bézier patches of Zheng & Bo 2019, for comparison only.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum CurvatureNetSolver {
    /// This service's own.
    #[default]
    Own,
    /// The paper's.
    Paper,
}

impl Default for CurvatureNetOptions {
    fn default() -> Self {
        let Options {
            levels: _,
            closeness,
            umbilics: _,
            target: _,
            cyclide,
            strips: _,
            offsets: _,
            supports: _,
            solver: _,
        } = Options::default();
        CurvatureNetOptions {
            levels: None,
            closeness,
            umbilics: UmbilicsWord::Avoid,
            target: None,
            cyclide,
            strips: Vec::new(),
            offsets: Vec::new(),
            supports: None,
            solver: CurvatureNetSolver::Own,
        }
    }
}
