//! Lengths, areas and normals of a mesh, and faults that need them.

use super::{Mesh, MeshFault};
use crate::geometry::{BoundingBox, Tolerance};
use nalgebra::{Point3, Vector3};

impl Mesh {
    /// The triangles: those given, and each quad cut along its shorter
    /// diagonal (the one from its first corner where both are equal). With
    /// each the face it comes from.
    #[must_use]
    pub fn triangles(&self) -> Vec<([usize; 3], usize)> {
        let mut triangles = Vec::with_capacity(2 * self.faces.len());
        for (f, face) in self.faces.iter().enumerate() {
            match *face.corners() {
                [a, b, c, d] => {
                    let length = |i: usize, j: usize| (self.vertices[i] - self.vertices[j]).norm();
                    let halves = if length(a, c) <= length(b, d) {
                        [[a, b, c], [a, c, d]]
                    } else {
                        [[a, b, d], [b, c, d]]
                    };
                    triangles.extend(halves.map(|t| (t, f)));
                }
                [a, b, c] => triangles.push(([a, b, c], f)),
                _ => {}
            }
        }
        triangles
    }

    /// The area vector of a face, exact also for a quad that is not flat: half
    /// the cross product of its diagonals.
    #[must_use]
    pub fn area_vector(&self, face: usize) -> Vector3<f64> {
        let p = |v: usize| self.vertices[v];
        match *self.faces[face].corners() {
            [a, b, c, d] => (p(c) - p(a)).cross(&(p(d) - p(b))) * 0.5,
            [a, b, c] => triangle_area([p(a), p(b), p(c)]),
            _ => Vector3::zeros(),
        }
    }

    /// For each vertex a third of the area of every triangle around it.
    #[must_use]
    pub fn vertex_areas(&self) -> Vec<f64> {
        let mut areas = vec![0.0; self.vertices.len()];
        for (corners, _) in self.triangles() {
            let area = triangle_area(corners.map(|v| self.vertices[v])).norm();
            for corner in corners {
                areas[corner] += area / 3.0;
            }
        }
        areas
    }

    /// For each vertex the unit normal, faces weighted by their areas; zero
    /// where there is none. The faces must be turned the same way.
    #[must_use]
    pub fn vertex_normals(&self) -> Vec<Vector3<f64>> {
        let mut normals = vec![Vector3::zeros(); self.vertices.len()];
        for (f, face) in self.faces.iter().enumerate() {
            let area = self.area_vector(f);
            for corner in face.corners() {
                normals[*corner] += area;
            }
        }
        for normal in &mut normals {
            *normal = normal.try_normalize(0.0).unwrap_or_else(Vector3::zeros);
        }
        normals
    }

    /// The box around all vertices; `None` if there are none.
    #[must_use]
    pub fn bounding_box(&self) -> Option<BoundingBox> {
        BoundingBox::of(&self.vertices)
    }

    /// Faces without area: one of their heights is below the tolerance.
    #[must_use]
    pub fn degenerate_faces(&self, tolerance: Tolerance) -> Vec<MeshFault> {
        let thin = |face: &usize| {
            let points: Vec<_> = self.points_of(*face).collect();
            let sides = (0..points.len()).map(|i| points[i] - points[(i + 1) % points.len()]);
            let longest = sides.map(|s| s.norm()).fold(0.0, f64::max);
            self.area_vector(*face).norm() <= 0.5 * longest * tolerance.length()
        };
        let faces = (0..self.faces.len()).filter(thin);
        faces
            .map(|face| MeshFault::DegenerateFace { face })
            .collect()
    }

    /// Vertices that no face uses.
    #[must_use]
    pub fn unused_vertices(&self) -> Vec<MeshFault> {
        let mut used = vec![false; self.vertices.len()];
        for corner in self.faces.iter().flat_map(|f| f.corners().to_vec()) {
            used[corner] = true;
        }
        let unused = (0..used.len()).filter(|v| !used[*v]);
        unused
            .map(|vertex| MeshFault::UnusedVertex { vertex })
            .collect()
    }

    /// Vertices in the very place of another with a smaller index.
    #[must_use]
    pub fn duplicate_vertices(&self) -> Vec<MeshFault> {
        let by_place = |a: &usize, b: &usize| {
            let (p, q) = (self.vertices[*a], self.vertices[*b]);
            let order = p
                .iter()
                .zip(q.iter())
                .map(|(x, y)| (x + 0.0).total_cmp(&(y + 0.0)));
            order
                .fold(std::cmp::Ordering::Equal, std::cmp::Ordering::then)
                .then(a.cmp(b))
        };
        let mut order: Vec<usize> = (0..self.vertices.len()).collect();
        order.sort_unstable_by(by_place);
        let same = |a: usize, b: usize| self.vertices[a] == self.vertices[b];
        let groups = order.chunk_by(|a, b| same(*a, *b));
        let mut faults: Vec<_> = groups
            .flat_map(|g| g[1..].iter().map(|second| (g[0], *second)))
            .collect();
        faults.sort_unstable_by_key(|(_, second)| *second);
        faults
            .into_iter()
            .map(|(first, second)| MeshFault::DuplicateVertices { first, second })
            .collect()
    }
}

/// The area vector of a triangle.
fn triangle_area([a, b, c]: [Point3<f64>; 3]) -> Vector3<f64> {
    (b - a).cross(&(c - a)) * 0.5
}
