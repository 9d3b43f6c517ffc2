//! The net: vertices with frames, in rows and columns.

use nalgebra::{Point3, Vector3};

/// A regular net of points with frames, row after row. In a closed direction
/// the first row or column is not repeated at the end.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Net {
    /// Number of rows of vertices; u runs from row to row.
    pub rows: usize,
    /// Number of vertices in a row; v runs along a row.
    pub columns: usize,
    /// Whether u closes, whether v closes.
    pub closed: [bool; 2],
    /// The vertices.
    pub points: Vec<Point3<f64>>,
    /// Unit tangents along u and v.
    pub tangents: Vec<[Vector3<f64>; 2]>,
    /// Unit normals, along `tangents[0] × tangents[1]`.
    pub normals: Vec<Vector3<f64>>,
}

/// The shape of a net: which vertex has which neighbours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Layout {
    /// Number of rows of vertices.
    pub rows: usize,
    /// Number of vertices in a row.
    pub columns: usize,
    /// Whether u closes, whether v closes.
    pub closed: [bool; 2],
}

impl Layout {
    /// Number of vertices.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.rows * self.columns
    }

    /// Rows and columns of patches.
    #[must_use]
    pub fn patch_counts(&self) -> [usize; 2] {
        [
            self.rows - usize::from(!self.closed[0]),
            self.columns - usize::from(!self.closed[1]),
        ]
    }

    /// Index of the vertex in row `i` and column `j`, both wrapped round where
    /// the net closes.
    #[must_use]
    pub fn vertex(&self, i: usize, j: usize) -> usize {
        (i % self.rows) * self.columns + j % self.columns
    }

    /// The corners of patch (i, j): (0, 0), (1, 0), (0, 1), (1, 1) in (u, v).
    #[must_use]
    pub fn corners(&self, i: usize, j: usize) -> [usize; 4] {
        [(i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)].map(|(i, j)| self.vertex(i, j))
    }

    /// All patches, row after row.
    pub fn patches(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        let [n, m] = self.patch_counts();
        (0..n).flat_map(move |i| (0..m).map(move |j| (i, j)))
    }

    /// Every edge in direction u (0) or v (1) with its two ends.
    pub fn edges(self, direction: usize) -> impl Iterator<Item = [usize; 2]> {
        let [n, m] = self.patch_counts();
        let (n, m) = if direction == 0 {
            (n, self.columns)
        } else {
            (self.rows, m)
        };
        (0..n).flat_map(move |i| {
            (0..m).map(move |j| {
                let next = if direction == 0 {
                    self.vertex(i + 1, j)
                } else {
                    self.vertex(i, j + 1)
                };
                [self.vertex(i, j), next]
            })
        })
    }

    /// The shape after every patch is split in four.
    #[must_use]
    pub fn split(&self) -> Layout {
        let [n, m] = self.patch_counts();
        Layout {
            rows: 2 * n + usize::from(!self.closed[0]),
            columns: 2 * m + usize::from(!self.closed[1]),
            closed: self.closed,
        }
    }
}

impl Net {
    /// Its shape.
    #[must_use]
    pub fn layout(&self) -> Layout {
        Layout {
            rows: self.rows,
            columns: self.columns,
            closed: self.closed,
        }
    }

    /// The mean length of the straight edges.
    #[must_use]
    pub fn mean_edge(&self) -> f64 {
        let edges = [0, 1].into_iter().flat_map(|d| self.layout().edges(d));
        let (sum, count) = edges.fold((0.0, 0.0), |(sum, count), [a, b]| {
            (sum + (self.points[b] - self.points[a]).norm(), count + 1.0)
        });
        if count > 0.0 { sum / count } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tube_has_as_many_columns_of_patches_as_of_vertices() {
        let tube = Layout {
            rows: 3,
            columns: 4,
            closed: [false, true],
        };
        assert_eq!(tube.patch_counts(), [2, 4]);
        assert_eq!(tube.corners(1, 3), [7, 11, 4, 8]);
        assert_eq!((tube.edges(0).count(), tube.edges(1).count()), (8, 12));
        let split = tube.split();
        assert_eq!((split.rows, split.columns), (5, 8));
        assert_eq!(split.patches().count(), 32);
    }
}
