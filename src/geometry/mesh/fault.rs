//! What can be wrong with a mesh, and where.

use thiserror::Error;

/// Why vertices and faces make no mesh at all.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum MeshError {
    /// A coordinate is NaN or infinite.
    #[error("vertex {vertex} has a coordinate that is not a finite number")]
    NotFinite {
        /// Index of the vertex.
        vertex: usize,
    },
    /// A face has a corner that is no vertex.
    #[error(
        "corner {corner} of face {face} is vertex {vertex}, but there are {vertices} vertices \
         (counted from 0)"
    )]
    OutOfRange {
        /// Index of the face.
        face: usize,
        /// Which of its corners.
        corner: usize,
        /// The index found there.
        vertex: usize,
        /// How many vertices there are.
        vertices: usize,
    },
    /// A face has the same vertex at two corners.
    #[error("face {face} has vertex {vertex} at two of its corners")]
    RepeatedCorner {
        /// Index of the face.
        face: usize,
        /// The vertex.
        vertex: usize,
    },
}

/// What keeps a mesh from being a clean surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum MeshFault {
    /// There is no face.
    #[error("the mesh has no faces")]
    NoFaces,
    /// Three or more faces meet at an edge.
    #[error(
        "{faces} faces meet at the edge between the vertices {} and {}, the first of them face \
         {face}",
        edge[0],
        edge[1]
    )]
    NonManifoldEdge {
        /// The edge's vertices, the smaller first.
        edge: [usize; 2],
        /// How many faces meet there.
        faces: usize,
        /// The first of them.
        face: usize,
    },
    /// The faces at a vertex are two fans or more that touch in it alone.
    #[error("{fans} separate parts of the mesh touch in vertex {vertex} alone")]
    NonManifoldVertex {
        /// The vertex.
        vertex: usize,
        /// How many fans of faces there are.
        fans: usize,
    },
    /// The faces cannot all be turned the same way: a Möbius band.
    #[error(
        "the faces cannot all be turned the same way: going round, face {face} meets face {other} \
         back to front at the edge between the vertices {} and {} (a Möbius band)",
        edge[0],
        edge[1]
    )]
    NotOrientable {
        /// The face at which it shows.
        face: usize,
        /// Its neighbour that contradicts it.
        other: usize,
        /// The edge between them, the smaller vertex first.
        edge: [usize; 2],
    },
    /// A face without area.
    #[error("face {face} has no area")]
    DegenerateFace {
        /// The face.
        face: usize,
    },
    /// A vertex that no face uses.
    #[error("vertex {vertex} belongs to no face")]
    UnusedVertex {
        /// The vertex.
        vertex: usize,
    },
    /// Two vertices in one place.
    #[error("the vertices {first} and {second} are in the same place")]
    DuplicateVertices {
        /// The smaller index.
        first: usize,
        /// The larger index.
        second: usize,
    },
}
