//! The residuals of mirrored frames, with their derivatives.

use super::super::net::{Layout, Net};
use crate::solver::{Blocks, LeastSquares};
use nalgebra::{Matrix3, Point3, Quaternion, UnitQuaternion, Vector3};

/// Unknowns of a vertex: its way, then the turn of its frame.
pub(super) const UNKNOWNS: usize = 6;
/// Residuals of an edge: the mirror, then the changes along it.
const ROWS: usize = 4 + UNKNOWNS;

/// A net of frames that want to be mirror images of each other.
pub(super) struct MirroredFrames {
    layout: Layout,
    points: Vec<Point3<f64>>,
    frames: Vec<Quaternion<f64>>,
    edges: Vec<Edge>,
    /// The mean edge: the unit of the ways.
    unit: f64,
    /// Weights of closeness and fairness against the mirrors.
    pub soft: Soft,
}

/// Weights of what is faded out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Soft {
    pub closeness: f64,
    pub fairness: f64,
}

#[derive(Debug, Clone, Copy)]
struct Edge {
    ends: [usize; 2],
    /// 0 along u, 1 along v.
    direction: usize,
    /// σ.
    sign: f64,
}

/// A vertex on its way.
struct Vertex {
    point: Point3<f64>,
    frame: Quaternion<f64>,
    turn: Vector3<f64>,
}

impl MirroredFrames {
    /// The problem with a net as its start; its frames are made orthonormal.
    pub(super) fn new(net: &Net, soft: Soft) -> Self {
        let layout = net.layout();
        let frames: Vec<_> = (net.tangents.iter().zip(&net.normals))
            .map(|([u, _], n)| frame_of(u, n))
            .collect();
        let sign = |ends: [usize; 2], direction: usize| {
            let between = frames[ends[0]] * axis(direction) * frames[ends[1]].conjugate();
            let chord = net.points[ends[1]] - net.points[ends[0]];
            if between.imag().dot(&chord) < 0.0 {
                -1.0
            } else {
                1.0
            }
        };
        let edges = [0, 1]
            .into_iter()
            .flat_map(|direction| layout.edges(direction).map(move |ends| (ends, direction)));
        let edges = edges
            .map(|(ends, direction)| Edge {
                ends,
                direction,
                sign: sign(ends, direction),
            })
            .collect();
        MirroredFrames {
            layout,
            points: net.points.clone(),
            unit: net.mean_edge(),
            edges,
            soft,
            frames,
        }
    }

    /// The net at `x`.
    pub(super) fn net(&self, x: &[f64]) -> Net {
        let Layout {
            rows,
            columns,
            closed,
        } = self.layout;
        let mut net = Net {
            rows,
            columns,
            closed,
            ..Net::default()
        };
        for index in 0..self.points.len() {
            let vertex = self.vertex(x, index);
            let turn = UnitQuaternion::from_quaternion(vertex.frame);
            let [u, v, n] = [Vector3::x(), Vector3::y(), Vector3::z()].map(|t| turn * t);
            net.points.push(vertex.point);
            net.tangents.push([u, v]);
            net.normals.push(n);
        }
        net
    }

    /// The largest residual of a mirror at `x`, with its edge's ends.
    pub(super) fn worst_mirror(&self, x: &[f64]) -> (f64, [usize; 2]) {
        let off = |edge: &Edge| {
            let [a, b] = edge.ends.map(|i| self.vertex(x, i));
            let r = self.mirror(edge, &a, &b).0;
            (r.iter().fold(0.0, |m: f64, r| m.max(r.abs())), edge.ends)
        };
        let worse = |m: (f64, [usize; 2]), n: (f64, [usize; 2])| if n.0 > m.0 { n } else { m };
        self.edges.iter().map(off).fold((0.0, [0, 0]), worse)
    }

    fn vertex(&self, x: &[f64], index: usize) -> Vertex {
        let own = &x[UNKNOWNS * index..UNKNOWNS * (index + 1)];
        let way = Vector3::from_column_slice(&own[..3]);
        let turn = Vector3::from_column_slice(&own[3..]);
        let turned = Quaternion::from_parts(1.0, turn * 0.5) * self.frames[index];
        Vertex {
            point: self.points[index] + way * self.unit,
            frame: turned / (1.0 + 0.25 * turn.norm_squared()).sqrt(),
            turn,
        }
    }

    /// σ q₁ a q̄₂ − e, with the chord.
    fn mirror(&self, edge: &Edge, a: &Vertex, b: &Vertex) -> ([f64; 4], Vector3<f64>) {
        let between = a.frame * axis(edge.direction) * b.frame.conjugate() * edge.sign;
        let chord = b.point - a.point;
        let off = between.imag() - chord.normalize();
        ([between.scalar(), off.x, off.y, off.z], chord)
    }

    fn push_edge(&self, edge: &Edge, x: &[f64], blocks: &mut Blocks) {
        let [a, b] = edge.ends.map(|i| self.vertex(x, i));
        let (mirror, chord) = self.mirror(edge, &a, &b);
        let mut residuals = [0.0; ROWS];
        residuals[..4].copy_from_slice(&mirror);
        let fairness = self.soft.fairness;
        for k in 0..UNKNOWNS {
            let [from, to] = edge.ends.map(|i| x[UNKNOWNS * i + k]);
            residuals[4 + k] = fairness * (to - from);
        }
        let mut columns = [0; 2 * UNKNOWNS];
        for k in 0..UNKNOWNS {
            columns[k] = UNKNOWNS * edge.ends[0] + k;
            columns[UNKNOWNS + k] = UNKNOWNS * edge.ends[1] + k;
        }
        let mut jacobian = [[0.0; 2 * UNKNOWNS]; ROWS];
        if blocks.wants_jacobian() {
            self.mirror_derivatives(edge, (&a, &b), &chord, &mut jacobian);
            for k in 0..UNKNOWNS {
                jacobian[4 + k][k] = -fairness;
                jacobian[4 + k][UNKNOWNS + k] = fairness;
            }
        }
        blocks.push(&residuals, &columns, jacobian.as_flattened());
    }

    fn mirror_derivatives(
        &self,
        edge: &Edge,
        (a, b): (&Vertex, &Vertex),
        chord: &Vector3<f64>,
        jacobian: &mut [[f64; 2 * UNKNOWNS]; ROWS],
    ) {
        let length = chord.norm();
        let e = chord / length;
        let turn_of_chord = (Matrix3::identity() - e * e.transpose()) * (self.unit / length);
        let axis = axis(edge.direction) * edge.sign;
        for k in 0..3 {
            for r in 0..3 {
                jacobian[1 + r][k] = turn_of_chord[(r, k)];
                jacobian[1 + r][UNKNOWNS + k] = -turn_of_chord[(r, k)];
            }
            let by_a = self.turned(a, edge.ends[0], k) * axis * b.frame.conjugate();
            let by_b = a.frame * axis * self.turned(b, edge.ends[1], k).conjugate();
            for (by, column) in [(by_a, 3 + k), (by_b, UNKNOWNS + 3 + k)] {
                jacobian[0][column] = by.scalar();
                for r in 0..3 {
                    jacobian[1 + r][column] = by.imag()[r];
                }
            }
        }
    }

    /// ∂q/∂ω_k.
    fn turned(&self, vertex: &Vertex, index: usize, k: usize) -> Quaternion<f64> {
        let square = 1.0 + 0.25 * vertex.turn.norm_squared();
        let mut direction = Vector3::zeros();
        direction[k] = 0.5 / square.sqrt();
        Quaternion::from_imag(direction) * self.frames[index]
            - vertex.frame * (0.25 * vertex.turn[k] / square)
    }
}

impl LeastSquares for MirroredFrames {
    fn dimension(&self) -> usize {
        UNKNOWNS * self.points.len()
    }

    fn evaluate(&self, x: &[f64], blocks: &mut Blocks) {
        for edge in &self.edges {
            self.push_edge(edge, x, blocks);
        }
        let closeness = self.soft.closeness;
        for (column, x) in x.iter().enumerate() {
            blocks.push(&[closeness * x], &[column], &[closeness]);
        }
    }
}

/// The axis of the frame along u or v as a quaternion.
fn axis(direction: usize) -> Quaternion<f64> {
    if direction == 0 {
        Quaternion::new(0.0, 1.0, 0.0, 0.0)
    } else {
        Quaternion::new(0.0, 0.0, 1.0, 0.0)
    }
}

/// The frame with the given normal and the tangent along u nearest to the
/// given one.
fn frame_of(u: &Vector3<f64>, n: &Vector3<f64>) -> Quaternion<f64> {
    let n = n.normalize();
    let u = (u - n * n.dot(u)).normalize();
    UnitQuaternion::from_basis_unchecked(&[u, n.cross(&u), n]).into_inner()
}
