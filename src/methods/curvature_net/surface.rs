//! The smooth surface: C¹ bicubic Hermite patches on a regular net.

use super::net::{Layout, Net};
use crate::geometry::SurfaceJet;
use nalgebra::{Point3, Vector3};

/// Point and derivatives by the parameters at one vertex.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Vertex {
    /// The place, as a vector from the origin.
    pub point: Vector3<f64>,
    /// ∂S/∂u.
    pub du: Vector3<f64>,
    /// ∂S/∂v.
    pub dv: Vector3<f64>,
    /// ∂²S/∂u∂v.
    pub duv: Vector3<f64>,
}

/// A C¹ surface of bicubic patches, one for each quad of the net.
///
/// Patch (i, j) covers a rectangle of the parameters of `widths[0][i]` by
/// `widths[1][j]`; it is the bicubic that has the values and derivatives of its
/// four vertices, so that neighbours share them along their common border.
#[derive(Debug, Clone, PartialEq)]
pub struct Surface {
    layout: Layout,
    widths: [Vec<f64>; 2],
    vertices: Vec<Vertex>,
}

/// The four cubics of Hermite's interpolation on [0, 1] for the values and
/// slopes at both ends, and a derivative of them.
fn hermite(t: f64, derivative: usize) -> [f64; 4] {
    match derivative {
        0 => [
            (1.0 + 2.0 * t) * (1.0 - t) * (1.0 - t),
            t * t * (3.0 - 2.0 * t),
            t * (1.0 - t) * (1.0 - t),
            t * t * (t - 1.0),
        ],
        1 => [
            6.0 * t * (t - 1.0),
            6.0 * t * (1.0 - t),
            (1.0 - t) * (1.0 - 3.0 * t),
            t * (3.0 * t - 2.0),
        ],
        2 => [12.0 * t - 6.0, 6.0 - 12.0 * t, 6.0 * t - 4.0, 6.0 * t - 2.0],
        _ => [12.0, -12.0, 6.0, 6.0],
    }
}

/// The weights of both ends' values and slopes for the derivative of a cubic
/// on an interval of this width, `t` its share.
pub(super) fn weights(t: f64, width: f64, derivative: usize) -> [f64; 4] {
    let scale = width.powi(-i32::try_from(derivative).unwrap_or(0));
    let [a, b, c, d] = hermite(t, derivative).map(|w| w * scale);
    [a, b, c * width, d * width]
}

impl Surface {
    /// A surface from its vertices, row after row.
    #[must_use]
    pub(super) fn new(layout: Layout, widths: [Vec<f64>; 2], vertices: Vec<Vertex>) -> Self {
        Surface {
            layout,
            widths,
            vertices,
        }
    }

    /// The shape of the net.
    #[must_use]
    pub fn layout(&self) -> Layout {
        self.layout
    }

    /// Widths of the rows and columns of patches in the parameters.
    #[must_use]
    pub fn widths(&self) -> &[Vec<f64>; 2] {
        &self.widths
    }

    /// The vertices, row after row.
    #[must_use]
    pub fn vertices(&self) -> &[Vertex] {
        &self.vertices
    }

    /// Point and derivatives by the surface's parameters at the share `at` of
    /// patch (i, j), each in [0, 1].
    #[must_use]
    pub fn jet(&self, patch: [usize; 2], at: [f64; 2]) -> SurfaceJet {
        let corners = self.layout.corners(patch[0], patch[1]);
        let sizes = [0, 1].map(|d| self.widths[d][patch[d]]);
        let [wu, wv] = [0, 1].map(|d| [0, 1, 2].map(|order| weights(at[d], sizes[d], order)));
        let sum = |a: usize, b: usize| self.blend(&corners, &wu[a], &wv[b]);
        SurfaceJet {
            point: Point3::from(sum(0, 0)),
            du: sum(1, 0),
            dv: sum(0, 1),
            duu: sum(2, 0),
            duv: sum(1, 1),
            dvv: sum(0, 2),
        }
    }

    fn blend(&self, corners: &[usize; 4], wu: &[f64; 4], wv: &[f64; 4]) -> Vector3<f64> {
        corners
            .iter()
            .enumerate()
            .fold(Vector3::zeros(), |sum, (c, vertex)| {
                let (i, j) = (c % 2, c / 2);
                let k = &self.vertices[*vertex];
                sum + (k.point * wu[i] + k.du * wu[2 + i]) * wv[j]
                    + (k.dv * wu[i] + k.duv * wu[2 + i]) * wv[2 + j]
            })
    }

    /// The same surface with every patch split in four.
    #[must_use]
    pub fn split(&self) -> Surface {
        let layout = self.layout.split();
        let widths = [0, 1].map(|d| {
            let halves = self.widths[d].iter().flat_map(|w| [0.5 * w, 0.5 * w]);
            halves.collect::<Vec<_>>()
        });
        let vertices = (0..layout.vertex_count())
            .map(|k| {
                let at = [k / layout.columns, k % layout.columns];
                let counts = self.layout.patch_counts();
                // The last row and column of an open net end the last patch.
                let patch = [0, 1].map(|d| (at[d] / 2).min(counts[d] - 1));
                let share = [0, 1].map(|d| {
                    let halves = at[d] - 2 * patch[d];
                    [0.0, 0.5, 1.0][halves.min(2)]
                });
                let jet = self.jet(patch, share);
                Vertex {
                    point: jet.point.coords,
                    du: jet.du,
                    dv: jet.dv,
                    duv: jet.duv,
                }
            })
            .collect();
        Surface {
            layout,
            widths,
            vertices,
        }
    }

    /// The same surface, scaled and then moved.
    pub(super) fn mapped(&self, size: f64, by: &Vector3<f64>) -> Surface {
        let map = |k: &Vertex| Vertex {
            point: k.point * size + by,
            du: k.du * size,
            dv: k.dv * size,
            duv: k.duv * size,
        };
        Surface {
            layout: self.layout,
            widths: self.widths.clone(),
            vertices: self.vertices.iter().map(map).collect(),
        }
    }

    /// The vertices with their frames.
    #[must_use]
    pub fn net(&self) -> Net {
        let unit = |v: Vector3<f64>| v.try_normalize(0.0).unwrap_or(v);
        let frame = |k: &Vertex| [unit(k.du), unit(k.dv)];
        let normal = |k: &Vertex| unit(k.du.cross(&k.dv));
        Net {
            rows: self.layout.rows,
            columns: self.layout.columns,
            closed: self.layout.closed,
            points: self
                .vertices
                .iter()
                .map(|k| Point3::from(k.point))
                .collect(),
            tangents: self.vertices.iter().map(frame).collect(),
            normals: self.vertices.iter().map(normal).collect(),
        }
    }

    /// All numbers of the vertices in order: point, du, dv, duv.
    pub(super) fn unknowns(&self) -> Vec<f64> {
        let parts = |k: &Vertex| [k.point, k.du, k.dv, k.duv];
        let all = self.vertices.iter().flat_map(parts);
        all.flat_map(|v| [v.x, v.y, v.z]).collect()
    }

    /// The same net with other numbers.
    pub(super) fn with_unknowns(&self, x: &[f64]) -> Surface {
        let vertices = x.chunks_exact(UNKNOWNS).map(|k| {
            let part = |i: usize| Vector3::new(k[3 * i], k[3 * i + 1], k[3 * i + 2]);
            Vertex {
                point: part(0),
                du: part(1),
                dv: part(2),
                duv: part(3),
            }
        });
        Surface {
            layout: self.layout,
            widths: self.widths.clone(),
            vertices: vertices.collect(),
        }
    }
}

/// Numbers at a vertex: four vectors.
pub(super) const UNKNOWNS: usize = 12;

#[cfg(test)]
mod tests {
    use super::*;

    fn patch() -> Surface {
        let layout = Layout {
            rows: 3,
            columns: 3,
            closed: [false, true],
        };
        let vector = |k: usize, s: f64| {
            let x = k as f64;
            Vector3::new((s * x).sin(), (s * x + 0.3).cos(), s * x * x)
        };
        let vertices = (0..9).map(|k| Vertex {
            point: vector(k, 1.0),
            du: vector(k, 0.7),
            dv: vector(k, 0.4),
            duv: vector(k, 0.2),
        });
        let widths = [vec![1.0, 0.5], vec![0.8, 1.1, 0.9]];
        Surface::new(layout, widths, vertices.collect())
    }

    #[test]
    fn splitting_changes_nothing_of_the_shape() {
        let whole = patch();
        let split = whole.split();
        for (i, j) in whole.layout().patches() {
            let a = whole.jet([i, j], [0.8, 0.3]);
            let b = split.jet([2 * i + 1, 2 * j], [0.6, 0.6]);
            for (a, b) in [
                (a.point.coords, b.point.coords),
                (a.duv, b.duv),
                (a.duu, b.duu),
            ] {
                assert!((a - b).norm() < 1e-12 * (1.0 + a.norm()));
            }
        }
    }

    #[test]
    fn patches_meet_with_all_first_derivatives() {
        let s = patch();
        let (a, b) = (s.jet([0, 2], [0.4, 1.0]), s.jet([0, 0], [0.4, 0.0]));
        assert!((a.point - b.point).norm() < 1e-14);
        assert!((a.du - b.du).norm() + (a.dv - b.dv).norm() < 1e-13);
        assert!((a.duv - b.duv).norm() < 1e-13);
    }

    #[test]
    fn derivatives_agree_with_differences() {
        let (s, at, h) = (patch(), [0.3, 0.6], 1e-5);
        let widths = [s.widths()[0][1], s.widths()[1][0]];
        let jet = |du: f64, dv: f64| s.jet([1, 0], [at[0] + du * h, at[1] + dv * h]);
        let (ahead, behind) = (jet(1.0, 0.0), jet(-1.0, 0.0));
        let slope = |a: Vector3<f64>, b: Vector3<f64>| (a - b) / (2.0 * h * widths[0]);
        let here = jet(0.0, 0.0);
        assert!((slope(ahead.point.coords, behind.point.coords) - here.du).norm() < 1e-8);
        assert!((slope(ahead.du, behind.du) - here.duu).norm() < 1e-8);
        assert!((slope(ahead.dv, behind.dv) - here.duv).norm() < 1e-8);
    }
}
