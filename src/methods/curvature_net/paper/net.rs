//! A net of bicubic Bézier patches that share the control points of their
//! borders.

use crate::methods::curvature_net::lines::border::BorderJet;
use crate::methods::curvature_net::net::Layout;
use crate::methods::curvature_net::surface::{Surface, Vertex};
use nalgebra::{Point3, Vector3};

/// Control points in rows and columns; every third one of both is a vertex of
/// the net. In a closed direction the first is not repeated.
#[derive(Debug, Clone)]
pub(super) struct BezierNet {
    /// Of the vertices.
    pub(super) layout: Layout,
    pub(super) points: Vec<Vector3<f64>>,
}

/// One side of a border: its four control points, and the four next to them.
#[derive(Debug, Clone, Copy)]
pub(super) struct Side {
    pub(super) on: [usize; 4],
    pub(super) beside: [usize; 4],
}

/// Bernstein's cubics and their derivatives by t.
fn bernstein(t: f64) -> [[f64; 4]; 3] {
    let s = 1.0 - t;
    [
        [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t],
        [
            -3.0 * s * s,
            3.0 * s * (s - 2.0 * t),
            3.0 * t * (2.0 * s - t),
            3.0 * t * t,
        ],
        [6.0 * s, 6.0 * (t - 2.0 * s), 6.0 * (s - 2.0 * t), 6.0 * t],
    ]
}

impl BezierNet {
    /// Bilinear patches: each quad cut into 3 × 3 (Zheng & Bo 2019, §2).
    pub(super) fn new(layout: Layout, vertices: &[Point3<f64>]) -> Self {
        let mut net = BezierNet {
            layout,
            points: Vec::new(),
        };
        let [rows, columns] = net.counts();
        for k in 0..rows * columns {
            let (i, j) = (k / columns, k % columns);
            let (s, t) = ((i % 3) as f64 / 3.0, (j % 3) as f64 / 3.0);
            let corner = |di: usize, dj: usize| {
                let last = |d: usize, at: usize| {
                    if layout.closed[d] {
                        at
                    } else {
                        at.min([layout.rows, layout.columns][d] - 1)
                    }
                };
                vertices[layout.vertex(last(0, i / 3 + di), last(1, j / 3 + dj))].coords
            };
            let first = corner(0, 0) * (1.0 - t) + corner(0, 1) * t;
            let second = corner(1, 0) * (1.0 - t) + corner(1, 1) * t;
            net.points.push(first * (1.0 - s) + second * s);
        }
        net
    }

    /// Rows and columns of control points.
    pub(super) fn counts(&self) -> [usize; 2] {
        let open = self.layout.closed.map(|closed| usize::from(!closed));
        let [n, m] = self.layout.patch_counts();
        [3 * n + open[0], 3 * m + open[1]]
    }

    /// Index of a control point, wrapped round where the net closes.
    pub(super) fn index(&self, i: usize, j: usize) -> usize {
        let [rows, columns] = self.counts();
        (i % rows) * columns + j % columns
    }

    /// Index of a vertex's control point.
    pub(super) fn vertex(&self, v: usize) -> usize {
        let columns = self.layout.columns;
        self.index(3 * (v / columns), 3 * (v % columns))
    }

    /// Both sides of all borders.
    pub(super) fn sides(&self) -> Vec<Side> {
        let mut sides = Vec::new();
        for direction in [0, 1] {
            let counts = self.counts();
            for [a, _] in self.layout.edges(direction) {
                let columns = self.layout.columns;
                let at = [3 * (a / columns), 3 * (a % columns)];
                let across = 1 - direction;
                let line = |step: usize| -> [usize; 4] {
                    std::array::from_fn(|k| {
                        let mut at = at;
                        at[direction] += k;
                        at[across] += step;
                        self.index(at[0], at[1])
                    })
                };
                let closed = self.layout.closed[across];
                if closed || at[across] + 1 < counts[across] {
                    sides.push(Side {
                        on: line(0),
                        beside: line(1),
                    });
                }
                if closed || at[across] > 0 {
                    sides.push(Side {
                        on: line(0),
                        beside: line(counts[across] - 1),
                    });
                }
            }
        }
        sides
    }

    /// Triples of control points across the borders, and of vertices along the
    /// lines of the net.
    pub(super) fn triples(&self) -> [Vec<[usize; 3]>; 2] {
        let [rows, columns] = self.counts();
        let (mut across, mut along) = (Vec::new(), Vec::new());
        for direction in [0, 1] {
            let count = [rows, columns][direction];
            let closed = self.layout.closed[direction];
            for k in 0..rows * columns {
                let at = [k / columns, k % columns];
                let inner = closed || (at[direction] > 0 && at[direction] + 1 < count);
                if !at[direction].is_multiple_of(3) || !inner {
                    continue;
                }
                let triple = |step: usize| {
                    [count - step, 0, step].map(|by| {
                        let mut at = at;
                        at[direction] += by;
                        self.index(at[0], at[1])
                    })
                };
                // `count - step` is a step back; an open line has none round
                // its end, but is not asked for one.
                across.push(triple(1));
                if at[1 - direction].is_multiple_of(3) {
                    along.push(triple(3));
                }
            }
        }
        [across, along]
    }

    /// The same surface with every patch split in four.
    pub(super) fn split(&self) -> BezierNet {
        let once = self.split_along(0);
        once.split_along(1)
    }

    fn split_along(&self, direction: usize) -> BezierNet {
        let mut layout = self.layout;
        let split = layout.split();
        match direction {
            0 => layout.rows = split.rows,
            _ => layout.columns = split.columns,
        }
        let mut halves = BezierNet {
            layout,
            points: Vec::new(),
        };
        let [rows, columns] = halves.counts();
        let lines = self.counts()[1 - direction];
        halves.points = vec![Vector3::zeros(); rows * columns];
        for line in 0..lines {
            let place = |net: &BezierNet, k: usize| match direction {
                0 => net.index(k, line),
                _ => net.index(line, k),
            };
            for patch in 0..self.layout.patch_counts()[direction] {
                let [a, b, c, d] = [0, 1, 2, 3].map(|k| self.points[place(self, 3 * patch + k)]);
                let middle = |a: Vector3<f64>, b: Vector3<f64>| (a + b) * 0.5;
                let (ab, bc, cd) = (middle(a, b), middle(b, c), middle(c, d));
                let (abc, bcd) = (middle(ab, bc), middle(bc, cd));
                let all = [a, ab, abc, middle(abc, bcd), bcd, cd, d];
                for (k, p) in all.into_iter().enumerate() {
                    let at = place(&halves, 6 * patch + k);
                    halves.points[at] = p;
                }
            }
        }
        halves
    }

    /// The C¹ surface with the vertices and the mean derivatives of the patches
    /// around each.
    pub(super) fn smooth(&self) -> Surface {
        let widths = self.layout.patch_counts().map(|n| vec![1.0; n]);
        let [rows, columns] = self.counts();
        let vertices = (0..self.layout.vertex_count()).map(|v| {
            let at = [3 * (v / self.layout.columns), 3 * (v % self.layout.columns)];
            let steps = [0, 1].map(|d| {
                let count = [rows, columns][d];
                let on = (self.layout.closed[d] || at[d] + 1 < count).then_some((1, 1.0));
                let back = (self.layout.closed[d] || at[d] > 0).then_some((count - 1, -1.0));
                on.into_iter().chain(back).collect::<Vec<_>>()
            });
            let point = |i: usize, j: usize| self.points[self.index(at[0] + i, at[1] + j)];
            let here = point(0, 0);
            let mean = |all: Vec<Vector3<f64>>| {
                let count = all.len().max(1) as f64;
                all.into_iter().sum::<Vector3<f64>>() / count
            };
            let du = steps[0]
                .iter()
                .map(|(i, s)| (point(*i, 0) - here) * (3.0 * s));
            let dv = steps[1]
                .iter()
                .map(|(j, s)| (point(0, *j) - here) * (3.0 * s));
            let duv = steps[0].iter().flat_map(|(i, s)| {
                steps[1].iter().map(move |(j, t)| {
                    (point(*i, *j) - point(*i, 0) - point(0, *j) + here) * (9.0 * s * t)
                })
            });
            Vertex {
                point: here,
                du: mean(du.collect()),
                dv: mean(dv.collect()),
                duv: mean(duv.collect()),
            }
        });
        Surface::new(self.layout, widths, vertices.collect())
    }
}

impl Side {
    /// Derivatives along and across at the share `t`.
    pub(super) fn jet(&self, point: impl Fn(usize) -> Vector3<f64>, t: f64) -> BorderJet {
        let b = bernstein(t);
        let on = self.on.map(&point);
        let across: [Vector3<f64>; 4] =
            std::array::from_fn(|k| (point(self.beside[k]) - on[k]) * 3.0);
        let sum = |points: &[Vector3<f64>; 4], w: &[f64; 4]| {
            points
                .iter()
                .zip(w)
                .map(|(p, w)| p * *w)
                .sum::<Vector3<f64>>()
        };
        BorderJet {
            along: sum(&on, &b[1]),
            across: sum(&across, &b[0]),
            along_change: sum(&on, &b[2]),
            across_change: sum(&across, &b[1]),
        }
    }

    /// Derivatives by the control points, `on` first, of a value with these
    /// derivatives by the jet.
    pub(super) fn row(t: f64, by: &[Vector3<f64>; 4]) -> [f64; 24] {
        let b = bernstein(t);
        let mut row = [0.0; 24];
        for k in 0..4 {
            let across = (by[1] * b[0][k] + by[3] * b[1][k]) * 3.0;
            let on = by[0] * b[1][k] + by[2] * b[2][k] - across;
            row[3 * k..3 * k + 3].copy_from_slice(on.as_slice());
            row[12 + 3 * k..15 + 3 * k].copy_from_slice(across.as_slice());
        }
        row
    }
}
