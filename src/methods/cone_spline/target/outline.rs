//! The outline of a strip: a closed loop of vertices with the surface to its
//! left, by arc length.

use crate::geometry::Manifold;
use nalgebra::{Point3, Vector3};

/// A closed loop of vertices.
#[derive(Debug, Clone)]
pub(super) struct Outline {
    /// Vertices of the mesh, in order.
    pub(super) vertices: Vec<usize>,
    /// The same as points.
    pub(super) points: Vec<Point3<f64>>,
    /// Unit normals of the surface there.
    pub(super) normals: Vec<Vector3<f64>>,
    /// Arc length from the first vertex to each; the whole length at the end.
    lengths: Vec<f64>,
}

impl Outline {
    /// The outline of a surface with one boundary.
    pub(super) fn of(surface: &Manifold) -> Self {
        let vertices = surface
            .boundary_loops()
            .first()
            .cloned()
            .unwrap_or_default();
        Self::along(surface, vertices)
    }

    /// One loop of the boundary.
    pub(super) fn along(surface: &Manifold, vertices: Vec<usize>) -> Self {
        let mesh = surface.mesh();
        let all = mesh.vertex_normals();
        let points: Vec<_> = vertices.iter().map(|v| mesh.vertices()[*v]).collect();
        let mut lengths = vec![0.0];
        for (i, p) in points.iter().enumerate() {
            let next = points[(i + 1) % points.len()];
            lengths.push(lengths[i] + (next - p).norm());
        }
        Outline {
            normals: vertices.iter().map(|v| all[*v]).collect(),
            vertices,
            points,
            lengths,
        }
    }

    pub(super) fn len(&self) -> usize {
        self.vertices.len()
    }

    /// The whole length.
    pub(super) fn length(&self) -> f64 {
        self.lengths[self.len()]
    }

    /// Length from one vertex of the loop forwards to another.
    pub(super) fn between(&self, from: usize, to: usize) -> f64 {
        (self.lengths[to] - self.lengths[from]).rem_euclid(self.length())
    }

    /// The point at an arc length, round and round.
    pub(super) fn point(&self, arc: f64) -> Point3<f64> {
        let arc = arc.rem_euclid(self.length());
        let after = self.lengths.partition_point(|l| *l <= arc);
        let i = after.clamp(1, self.len()) - 1;
        let span = self.lengths[i + 1] - self.lengths[i];
        let share = if span > 0.0 {
            (arc - self.lengths[i]) / span
        } else {
            0.0
        };
        self.points[i].lerp(&self.points[(i + 1) % self.len()], share)
    }

    /// The vertices of the loop from one forwards to another, both included.
    pub(super) fn stretch(&self, from: usize, to: usize) -> Vec<usize> {
        let count = (to + self.len() - from) % self.len();
        (0..=count).map(|i| (from + i) % self.len()).collect()
    }

    /// Where vertices of the mesh stand in the loop.
    pub(super) fn indices_of(&self, vertices: [usize; 4]) -> [usize; 4] {
        vertices.map(|v| self.vertices.iter().position(|w| *w == v).unwrap_or(0))
    }

    /// For each vertex the angle by which the loop turns within the surface,
    /// seen over a length to either side: positive at outward corners.
    pub(super) fn turns(&self, reach: f64) -> Vec<f64> {
        let reach = reach.min(0.25 * self.length());
        let turn = |i: usize| {
            let (arc, p) = (self.lengths[i], self.points[i]);
            let normal = self.normal_near(i, reach);
            let back = p - self.point(arc - reach);
            let on = self.point(arc + reach) - p;
            let within = |d: Vector3<f64>| d - normal * normal.dot(&d);
            let (back, on) = (within(back), within(on));
            normal.dot(&back.cross(&on)).atan2(back.dot(&on))
        };
        (0..self.len()).map(turn).collect()
    }

    /// The mean normal of the vertices within a length of one.
    fn normal_near(&self, index: usize, reach: f64) -> Vector3<f64> {
        let mut sum = self.normals[index];
        let n = self.len();
        let half = n / 2;
        for step in 1..half.max(1) {
            let i = (index + step) % n;
            if self.between(index, i) > reach {
                break;
            }
            sum += self.normals[i];
        }
        for step in 1..half.max(1) {
            let i = (index + n - step) % n;
            if self.between(i, index) > reach {
                break;
            }
            sum += self.normals[i];
        }
        sum.try_normalize(0.0).unwrap_or(self.normals[index])
    }
}
