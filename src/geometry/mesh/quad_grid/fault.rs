//! What keeps a surface from being a regular net, and where.

use thiserror::Error;

/// What keeps a surface from being a regular net of quads.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum QuadGridFault {
    /// A face has not four corners.
    #[error("face {face} has {corners} corners: only quads make rows and columns")]
    NotAQuad {
        /// The face.
        face: usize,
        /// How many corners it has.
        corners: usize,
    },
    /// The mesh is in parts.
    #[error("the mesh is in {parts} parts; face {face} is the first of the second part")]
    Parts {
        /// How many.
        parts: usize,
        /// The first face of the second part.
        face: usize,
    },
    /// Inner vertices without four neighbours.
    #[error(
        "{} not four faces around {}: {}",
        if vertices.len() == 1 { "an inner vertex has" } else { "inner vertices have" },
        if vertices.len() == 1 { "it" } else { "them" },
        list(vertices, |(vertex, faces)| format!("vertex {vertex} has {faces}"))
    )]
    Singular {
        /// The vertices with their numbers of faces, ascending.
        vertices: Vec<(usize, usize)>,
    },
    /// The boundary turns inwards.
    #[error(
        "the boundary is ragged, it turns inwards at {}",
        list(vertices, |(vertex, faces)| format!("vertex {vertex} with {faces} faces"))
    )]
    Ragged {
        /// Boundary vertices with more than two faces, ascending.
        vertices: Vec<(usize, usize)>,
    },
    /// The boundary has too many loops.
    #[error(
        "the boundary has {} loops, which begin at the vertices {}: a net has one (a sheet), \
         two (a tube) or none (a torus)",
        starts.len(),
        list(starts, usize::to_string)
    )]
    Loops {
        /// The smallest vertex of each loop.
        starts: Vec<usize>,
    },
    /// The boundary has not the corners of a sheet or a tube.
    #[error(
        "the boundary has {} corners{}, but {} has {}",
        corners.len(),
        if corners.is_empty() { String::new() } else { format!(" ({})", list(corners, |v| format!("vertex {v}"))) },
        if *wanted == 4 { "a sheet" } else { "a tube" },
        if *wanted == 4 { "four" } else { "none" }
    )]
    Corners {
        /// Boundary vertices with a single face, ascending.
        corners: Vec<usize>,
        /// How many there should be.
        wanted: usize,
    },
    /// Going round comes back to another place.
    #[error(
        "going round along the faces from vertex {vertex} comes back beside it: the rows run on \
         as a spiral"
    )]
    Spiral {
        /// Where it shows.
        vertex: usize,
    },
    /// A closed direction is too short.
    #[error("going round at vertex {vertex} takes {count} faces: a closed row needs three")]
    Short {
        /// A vertex of the row.
        vertex: usize,
        /// Its number of faces.
        count: usize,
    },
}

/// Names that many; a thousand would hide the rest of the message.
const NAMED: usize = 8;

fn list<T>(items: &[T], name: impl Fn(&T) -> String) -> String {
    let mut names: Vec<String> = items.iter().take(NAMED).map(name).collect();
    if items.len() > NAMED {
        names.push(format!("and {} more", items.len() - NAMED));
    }
    names.join(", ")
}
