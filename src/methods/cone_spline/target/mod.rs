//! A strip made ready for fitting.

use nalgebra::Point3;

/// A strip with its corners found: two long sides, two short ends, and a first
/// guess of its rulings. Lengths in the unit of the request.
#[derive(Debug, Clone, PartialEq)]
pub struct Target {
    /// All vertices of the mesh, in the order of the request.
    pub points: Vec<Point3<f64>>,
    /// Area of each vertex: a third of its triangles.
    pub weights: Vec<f64>,
    /// Consistently oriented; the normals of the strip follow from it.
    pub triangles: Vec<[usize; 3]>,
    /// The two long sides, both from the start end to the finish end.
    pub sides: [Vec<Point3<f64>>; 2],
    /// The short sides at start and finish, from side 0 to side 1. With the
    /// long sides they close the outline; at least two points each.
    pub ends: [Vec<Point3<f64>>; 2],
    /// About 40 rulings from side 0 to side 1, monotone along both, the first
    /// and the last near the ends.
    pub rulings: Vec<[Point3<f64>; 2]>,
    /// What the user should know about the input.
    pub warnings: Vec<String>,
    /// Whether it was a ring before it was cut.
    pub closed: bool,
}
