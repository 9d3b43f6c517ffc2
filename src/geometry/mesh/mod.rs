//! Polygon meshes of triangles and quads: vertices, faces, and what hangs
//! together with what.
//!
//! A [`Mesh`] is a list whose indices are right, and no more. [`Topology`]
//! tells its edges and what meets at each of them, whatever the mesh is like;
//! a [`Manifold`] is a mesh that is a surface: two faces an edge at most, one
//! fan of faces a vertex, all faces turned the same way, its boundary in
//! closed loops. What keeps a mesh from being one is a [`MeshFault`] that names
//! the vertex, the edge or the face.
//!
//! Everything runs in `O(n log n)` of the faces, and the order of faces and
//! vertices never changes a length or an area, only which of equals comes
//! first.

mod face;
mod fault;
mod manifold;
mod measure;
mod nearest;
mod quad_grid;
#[cfg(test)]
mod tests;
mod topology;

pub use face::Face;
pub use fault::{MeshError, MeshFault};
pub use manifold::Manifold;
pub use nearest::{MeshIndex, Nearest};
pub use quad_grid::{QuadGrid, QuadGridFault};
pub use topology::Topology;

use nalgebra::Point3;

/// A mesh whose coordinates are finite and whose indices are right: every
/// corner is a vertex, and no face has a vertex twice.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mesh {
    vertices: Vec<Point3<f64>>,
    faces: Vec<Face>,
}

impl Mesh {
    /// A mesh of these vertices and faces.
    ///
    /// # Errors
    /// [`MeshError`] for the first coordinate or index that cannot be.
    pub fn new(vertices: Vec<Point3<f64>>, faces: Vec<Face>) -> Result<Mesh, MeshError> {
        let odd = |p: &Point3<f64>| p.iter().any(|x| !x.is_finite());
        if let Some(vertex) = vertices.iter().position(odd) {
            return Err(MeshError::NotFinite { vertex });
        }
        for (face, corners) in faces.iter().enumerate() {
            check(face, corners.corners(), vertices.len())?;
        }
        Ok(Mesh { vertices, faces })
    }

    /// The vertices.
    #[must_use]
    pub fn vertices(&self) -> &[Point3<f64>] {
        &self.vertices
    }

    /// The faces.
    #[must_use]
    pub fn faces(&self) -> &[Face] {
        &self.faces
    }

    /// The corners of a face as points, in their order.
    pub fn points_of(&self, face: usize) -> impl ExactSizeIterator<Item = Point3<f64>> + '_ {
        let corners = self.faces[face].corners();
        corners.iter().map(|v| self.vertices[*v])
    }
}

fn check(face: usize, corners: &[usize], vertices: usize) -> Result<(), MeshError> {
    for (corner, vertex) in corners.iter().copied().enumerate() {
        if vertex >= vertices {
            return Err(MeshError::OutOfRange {
                face,
                corner,
                vertex,
                vertices,
            });
        }
        if corners[..corner].contains(&vertex) {
            return Err(MeshError::RepeatedCorner { face, vertex });
        }
    }
    Ok(())
}
