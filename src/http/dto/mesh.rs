//! Meshes on the wire.

use super::curves::Point;
use super::index::Index;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// A mesh: vertices, and faces by the indices of their corners.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct MeshInput {
    /// The vertices.
    #[schema(min_items = 3, max_items = 1_000_000)]
    pub vertices: Vec<Point>,
    /// The corners of each face in order round it, counted from 0.
    #[schema(min_items = 1, max_items = 1_000_000)]
    pub faces: Vec<Vec<Index>>,
}
