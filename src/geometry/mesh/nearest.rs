//! The point of a mesh that is nearest to a query.
//!
//! The triangles lie in the order of a median split under a tree of boxes; a
//! query walks it nearest first and drops what cannot hold a nearer point.

use super::Mesh;
use crate::geometry::BoundingBox;
use crate::geometry::closest::BoxTree;
use nalgebra::{Point3, Vector3};

/// A mesh prepared for many queries.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshIndex {
    vertices: Vec<Point3<f64>>,
    normals: Vec<Vector3<f64>>,
    /// Corners and face of every triangle, in the order of the tree.
    triangles: Vec<([usize; 3], usize)>,
    tree: BoxTree,
}

/// The nearest point of a mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nearest {
    /// The point.
    pub point: Point3<f64>,
    /// The mean of the corners' unit normals there, unit; that of the triangle
    /// where these cancel.
    pub normal: Vector3<f64>,
    /// Corners of the triangle that it lies on.
    pub corners: [usize; 3],
    /// Shares of these corners, not negative, with the sum 1.
    pub shares: [f64; 3],
    /// The face that the triangle belongs to.
    pub face: usize,
    /// Its distance from the query.
    pub distance: f64,
}

impl MeshIndex {
    /// Prepares a mesh, its quads cut along their shorter diagonals; `None`
    /// for one without faces.
    #[must_use]
    pub fn new(mesh: &Mesh) -> Option<Self> {
        let mut triangles = mesh.triangles();
        if triangles.is_empty() {
            return None;
        }
        let vertices = mesh.vertices();
        order(&mut triangles, vertices);
        let boxes: Vec<BoundingBox> = triangles
            .iter()
            .filter_map(|(corners, _)| BoundingBox::of(corners.iter().map(|c| &vertices[*c])))
            .collect();
        Some(MeshIndex {
            tree: BoxTree::of(&boxes),
            normals: mesh.vertex_normals(),
            vertices: vertices.to_vec(),
            triangles,
        })
    }

    /// The nearest point.
    #[must_use]
    pub fn nearest(&self, query: &Point3<f64>) -> Nearest {
        let mut best = (f64::INFINITY, 0, [1.0, 0.0, 0.0]);
        self.tree.visit(query, |leaf, bound| {
            if bound >= best.0 {
                return false;
            }
            if let Some(leaf) = leaf {
                let corners = self.triangles[leaf].0.map(|c| self.vertices[c]);
                let shares = shares(&corners, query);
                let distance = (blend(&corners, shares) - query).norm();
                if distance < best.0 {
                    best = (distance, leaf, shares);
                }
            }
            true
        });
        let (distance, leaf, shares) = best;
        let (corners, face) = self.triangles[leaf];
        Nearest {
            point: blend(&corners.map(|c| self.vertices[c]), shares),
            normal: self.normal(corners, shares),
            corners,
            shares,
            face,
            distance,
        }
    }

    fn normal(&self, corners: [usize; 3], shares: [f64; 3]) -> Vector3<f64> {
        let pairs = corners.iter().zip(shares);
        let mean: Vector3<f64> = pairs.map(|(c, s)| self.normals[*c] * s).sum();
        let [a, b, c] = corners.map(|c| self.vertices[c]);
        let flat = (b - a).cross(&(c - a));
        // Normals that cancel leave no direction but rounding.
        let mean = if mean.norm() > 1e-6 { mean } else { flat };
        mean.try_normalize(0.0).unwrap_or_else(Vector3::z)
    }
}

/// Halves along the longest side of the middles' box, down to one triangle.
fn order(triangles: &mut [([usize; 3], usize)], vertices: &[Point3<f64>]) {
    if triangles.len() < 2 {
        return;
    }
    let middle = |t: &([usize; 3], usize)| {
        let sum: Vector3<f64> = t.0.iter().map(|c| vertices[*c].coords).sum();
        Point3::from(sum / 3.0)
    };
    let middles: Vec<Point3<f64>> = triangles.iter().map(middle).collect();
    let axis = BoundingBox::of(&middles).map_or(0, |b| (b.max - b.min).imax());
    triangles.sort_by(|a, b| {
        middle(a)[axis]
            .total_cmp(&middle(b)[axis])
            .then(a.1.cmp(&b.1))
    });
    // The tree is complete: its left half has a power of two of leaves.
    let half = triangles.len().next_power_of_two() / 2;
    let (left, right) = triangles.split_at_mut(half);
    order(left, vertices);
    order(right, vertices);
}

fn blend(corners: &[Point3<f64>; 3], shares: [f64; 3]) -> Point3<f64> {
    let pairs = corners.iter().zip(shares);
    Point3::from(pairs.map(|(c, s)| c.coords * s).sum::<Vector3<f64>>())
}

/// Shares of the corners at the point of a triangle that is nearest (Ericson,
/// *Real-Time Collision Detection*, 2005, §5.1.5).
fn shares([a, b, c]: &[Point3<f64>; 3], query: &Point3<f64>) -> [f64; 3] {
    let (ab, ac) = (b - a, c - a);
    let along = |from: &Point3<f64>| [ab.dot(&(query - from)), ac.dot(&(query - from))];
    let ([d1, d2], [d3, d4], [d5, d6]) = (along(a), along(b), along(c));
    let share = |value: f64, other: f64| {
        let sum = value + other;
        if sum > 0.0 { value / sum } else { 0.0 }
    };
    if d1 <= 0.0 && d2 <= 0.0 {
        return [1.0, 0.0, 0.0];
    }
    if d3 >= 0.0 && d4 <= d3 {
        return [0.0, 1.0, 0.0];
    }
    let on_ab = d1 * d4 - d3 * d2;
    if on_ab <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let t = share(d1, -d3);
        return [1.0 - t, t, 0.0];
    }
    if d6 >= 0.0 && d5 <= d6 {
        return [0.0, 0.0, 1.0];
    }
    let on_ac = d5 * d2 - d1 * d6;
    if on_ac <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let t = share(d2, -d6);
        return [1.0 - t, 0.0, t];
    }
    let on_bc = d3 * d6 - d5 * d4;
    if on_bc <= 0.0 && d4 >= d3 && d5 >= d6 {
        let t = share(d4 - d3, d5 - d6);
        return [0.0, 1.0 - t, t];
    }
    let sum = on_ab + on_ac + on_bc;
    let (v, w) = (on_ac / sum, on_ab / sum);
    [1.0 - v - w, v, w]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::mesh::Face;

    fn wave() -> Mesh {
        let point = |k: usize| {
            let (i, j) = ((k / 12) as f64, (k % 12) as f64);
            Point3::new(i, j, (0.7 * i).sin() + (0.5 * j).cos())
        };
        let quad = |k: usize| Face::Quad([k, k + 12, k + 13, k + 1]);
        let faces = (0..9 * 12).filter(|k| k % 12 < 11).map(quad);
        Mesh::new((0..120).map(point).collect(), faces.collect()).expect("a mesh")
    }

    #[test]
    fn no_triangle_is_nearer() {
        let mesh = wave();
        let index = MeshIndex::new(&mesh).expect("faces");
        for k in 0..60 {
            let x = f64::from(k);
            let query = Point3::new(
                5.0 + 7.0 * (1.3 * x).sin(),
                6.0 + 8.0 * (0.9 * x).cos(),
                3.0 * (0.4 * x).sin(),
            );
            let found = index.nearest(&query);
            // Every triangle by brute force, on a fine lattice of shares.
            let least = mesh
                .triangles()
                .iter()
                .flat_map(|(corners, _)| {
                    let corners = corners.map(|c| mesh.vertices()[c]);
                    (0..=20).flat_map(move |i| {
                        (0..=20 - i).map(move |j| {
                            let (s, t) = (f64::from(i) / 20.0, f64::from(j) / 20.0);
                            (blend(&corners, [1.0 - s - t, s, t]) - query).norm()
                        })
                    })
                })
                .fold(f64::INFINITY, f64::min);
            assert!(
                found.distance <= least + 1e-12,
                "{query}: {found:?}, {least}"
            );
            assert!((found.point - query).norm() - found.distance < 1e-12);
            assert!((found.shares.iter().sum::<f64>() - 1.0).abs() < 1e-12);
            assert!((found.normal.norm() - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn a_point_above_a_face_falls_along_its_normal() {
        let flat = Mesh::new(
            vec![
                Point3::origin(),
                Point3::new(2.0, 0.0, 0.0),
                Point3::new(0.0, 2.0, 0.0),
            ],
            vec![Face::Triangle([0, 1, 2])],
        );
        let index = MeshIndex::new(&flat.expect("a mesh")).expect("a face");
        let found = index.nearest(&Point3::new(0.5, 0.5, 3.0));
        assert!((found.point - Point3::new(0.5, 0.5, 0.0)).norm() < 1e-15);
        assert!((found.distance - 3.0).abs() < 1e-15);
        assert_eq!(found.normal, Vector3::z());
    }
}
