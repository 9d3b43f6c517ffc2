//! What "fair" means: energies of a curve, as sums of squares.
//!
//! # The geometric energy
//! ∫ |(dk/ds)_⊥|² ds for the curvature vector k = d²r/ds²: its change along
//! the curve, across the tangent. In the plane this is ∫ κ′² ds, in space
//! ∫ κ′² + κ²τ² ds. It is 0 on straight lines and circles, belongs to the
//! shape and not to the parameter, and has no trouble where κ = 0 and the
//! torsion is not defined. With v = |r′| and P = 1 − ttᵀ
//!
//! (dk/ds)_⊥ = v⁻³ P (r‴ − 3 (r′·r″)/(r′·r′) r″),
//!
//! and, as ds = v du, the residual at a node with weight w is √w v^½ times
//! that. (Moreton & Séquin, *Functional optimization for fair surface
//! design*, 1992, call its minimisers minimum variation curves.)
//!
//! A **weight along the curve** keeps one sharp bend, such as the nose of an
//! aerofoil, from setting the scale for all of the curve: [`relief`].
//!
//! As the energy does not feel the parameter, a second, weak residual
//! (r′·r″)/(r′·r′) asks for even speed; it is 0 on every shape that runs at
//! constant speed and so does not choose among shapes.
//!
//! # The paper's energy
//! ∫ α|r′|² + β|r″|² + γ|r‴|² du (Jing, Xi & Tang 1998, eq. 1): quadratic in
//! the coefficients, exact by Gauss quadrature.

use super::space::{Space, Vector};
use crate::geometry::bspline::BasisJet;
use crate::numerics::{EnvelopeMatrix, GaussLegendre};
use nalgebra::SMatrix;

/// Weights of the paper's energy: tension α, bending β, jerk γ.
pub(super) type Quadratic = [f64; 3];

/// Weight of the wish for even speed. It holds the tangential freedom, which
/// nothing else does; figures do not change between 1e-4 and 1.
const EVEN_SPEED: f64 = 1e-2;

/// Weight of ∫ κ′² ds where the curvature is κ: 1 where the curve is gentle,
/// falling as |κ|⁻³ beyond `gentle` (1/length), at once: at a third of it the
/// weight is 0.99. κ′² ds has the dimension
/// length⁻³, so that a bend ten times as sharp, ten times as small, then
/// counts as much as the great one that it resembles.
pub(super) fn relief(curvature: f64, gentle: f64) -> f64 {
    let sharpness = curvature / gentle;
    (1.0 + sharpness.powi(4)).powf(-0.75)
}

/// Spans to each side over which the curvature is averaged for [`relief`].
const REACH: usize = 2;

/// A node of the quadrature with the functions that act there.
#[derive(Debug, Clone)]
pub(super) struct Node {
    /// Parameter.
    pub(super) u: f64,
    /// Quadrature weight du.
    pub(super) weight: f64,
    /// Functions and three derivatives.
    pub(super) basis: BasisJet<4>,
}

/// The nodes of a space, as many a span as make polynomial integrands exact.
pub(super) fn nodes(space: &Space) -> Vec<Node> {
    // The square of a derivative of order 1 has degree 2p − 2 in a span.
    let rule = GaussLegendre::new(space.degree());
    let mut nodes = Vec::new();
    for [a, b] in space.spans() {
        for (u, weight) in rule.on(a, b) {
            nodes.push(Node {
                u,
                weight,
                basis: space.basis(u),
            });
        }
    }
    nodes
}

/// Derivatives of the curve at a node.
pub(super) fn derivatives<const D: usize>(
    space: &Space,
    node: &Node,
    x: &[Vector<D>],
) -> [Vector<D>; 3] {
    [1, 2, 3].map(|k| space.combine(node.basis.first, node.basis.derivative(k), x))
}

/// The change of curvature across the tangent, times v^½, with its derivatives
/// by r′, r″ and r‴.
#[derive(Debug, Clone, Copy)]
pub(super) struct Variation<const D: usize> {
    /// v^½ (dk/ds)_⊥.
    pub(super) value: Vector<D>,
    /// ∂value/∂r′, ∂value/∂r″, ∂value/∂r‴.
    pub(super) by: [SMatrix<f64, D, D>; 3],
}

/// Squares of speeds below this (unit scale: the curve is about 1 long and
/// runs at speed about 1) count as this: a cusp has no curvature.
const SLOWEST: f64 = 1e-12;

/// Value of [`Variation`] alone.
pub(super) fn variation_value<const D: usize>(d: &[Vector<D>; 3]) -> Vector<D> {
    let [r1, r2, r3] = d;
    let q = r1.norm_squared().max(SLOWEST);
    let m = r3 - r2 * (3.0 * r1.dot(r2) / q);
    (m - r1 * (r1.dot(&m) / q)) * q.powf(-1.25)
}

/// The residual and its Jacobian at one node.
pub(super) fn variation<const D: usize>(d: &[Vector<D>; 3]) -> Variation<D> {
    let [r1, r2, r3] = d;
    let one = SMatrix::<f64, D, D>::identity();
    let q = r1.norm_squared().max(SLOWEST);
    let a = r1.dot(r2) / q;
    let m = r3 - r2 * (3.0 * a);
    let along = r1.dot(&m) / q;
    let scale = q.powf(-1.25);
    let value = (m - r1 * along) * scale;
    // dm = dr‴ − 3a dr″ − 3 r″ da, da = (r″·dr′ + r′·dr″ − 2a r′·dr′)/q.
    let da = [(r2 - r1 * (2.0 * a)).transpose() / q, r1.transpose() / q];
    let dm = [r2 * da[0] * -3.0, r2 * da[1] * -3.0 - one * (3.0 * a), one];
    // w = m − r′ (r′·m)/q.
    let across = one - r1 * r1.transpose() / q;
    let mut by = dm.map(|dm| across * dm * scale);
    let turn = -one * along - r1 * (m - r1 * (2.0 * along)).transpose() / q;
    by[0] += turn * scale - value * r1.transpose() * (2.5 / q);
    Variation { value, by }
}

/// The wish for even speed, (r′·r″)/(r′·r′), and its derivatives by r′ and r″.
pub(super) fn unevenness<const D: usize>(d: &[Vector<D>; 3]) -> (f64, [Vector<D>; 2]) {
    let [r1, r2, _] = d;
    let q = r1.norm_squared().max(SLOWEST);
    let value = r1.dot(r2) / q;
    (value, [(r2 - r1 * (2.0 * value)) / q, r1 / q])
}

/// The energy of a curve in a space, with a weight a node.
#[derive(Debug, Clone)]
pub(super) struct Energy {
    /// Quadrature nodes.
    pub(super) nodes: Vec<Node>,
    /// Weight of the change of curvature at each node ([`relief`]).
    pub(super) relief: Vec<f64>,
    /// The paper's energy in place of the geometric one.
    pub(super) quadratic: Option<Quadratic>,
    /// ω² at the nodes, from [`Self::spare_arcs`]; empty: 0.
    turning: Vec<f64>,
}

/// A quadratic model about the current coefficients: cost, gradient/2 and the
/// Gauss–Newton matrix of ‖residuals‖², coordinates interleaved.
pub(super) struct Model {
    /// Matrix JᵀJ.
    pub(super) matrix: EnvelopeMatrix,
    /// Jᵀ residuals.
    pub(super) gradient: Vec<f64>,
}

impl Energy {
    /// The energy with weight 1 everywhere; the paper's if `quadratic`.
    pub(super) fn new(space: &Space, quadratic: Option<Quadratic>) -> Self {
        let nodes = nodes(space);
        let relief = vec![1.0; nodes.len()];
        Energy {
            nodes,
            relief,
            quadratic,
            turning: Vec::new(),
        }
    }

    /// From now on the jerk of the paper's energy is r‴ + ω² r′ with ω² =
    /// |r″_⊥|²/|r′|² of the present shape: what r‴ is more than on the arc of
    /// the present curvature, on which r‴ = −ω² r′.
    pub(super) fn spare_arcs<const D: usize>(&mut self, space: &Space, x: &[Vector<D>]) {
        let turning = |node: &Node| {
            let d = derivatives(space, node, x);
            curvature(&d).powi(2) * d[0].norm_squared()
        };
        self.turning = self.nodes.iter().map(turning).collect();
    }

    /// ω² at a node.
    fn turning(&self, node: usize) -> f64 {
        self.turning.get(node).copied().unwrap_or(0.0)
    }

    /// Weighs sharp bends of the present shape down; see [`relief`].
    pub(super) fn relieve<const D: usize>(&mut self, space: &Space, x: &[Vector<D>], gentle: f64) {
        if self.quadratic.is_some() {
            return;
        }
        let bent: Vec<[f64; 2]> = self
            .nodes
            .iter()
            .map(|node| {
                let d = derivatives(space, node, x);
                let length = node.weight * d[0].norm();
                [length, length * curvature(&d)]
            })
            .collect();
        let reach = REACH * space.degree();
        for (k, weight) in self.relief.iter_mut().enumerate() {
            let near = &bent[k.saturating_sub(reach)..(k + reach + 1).min(bent.len())];
            let [length, turn] = near
                .iter()
                .fold([0.0; 2], |s, n| [s[0] + n[0], s[1] + n[1]]);
            *weight = relief(turn / length.max(f64::MIN_POSITIVE), gentle);
        }
    }

    /// Takes the weights along the curve from an energy on the same domain.
    pub(super) fn relieve_as(&mut self, other: &Energy) {
        let mut k = 0;
        for (weight, node) in self.relief.iter_mut().zip(&self.nodes) {
            while k + 1 < other.nodes.len() && other.nodes[k].u < node.u {
                k += 1;
            }
            *weight = other.relief[k];
        }
    }

    /// ∫ weight · |(dk/ds)_⊥|² ds, and the unevenness with its own weight.
    pub(super) fn cost<const D: usize>(&self, space: &Space, x: &[Vector<D>]) -> [f64; 2] {
        let mut sums = [0.0; 2];
        for (k, (node, relief)) in self.nodes.iter().zip(&self.relief).enumerate() {
            let mut d = derivatives(space, node, x);
            if self.quadratic.is_some() {
                d[2] += d[0] * self.turning(k);
            }
            sums[0] += node.weight
                * match &self.quadratic {
                    None => relief * variation_value(&d).norm_squared(),
                    Some(weights) => {
                        let square = |(w, d): (&f64, &Vector<D>)| w * d.norm_squared();
                        weights.iter().zip(&d).map(square).sum()
                    }
                };
            if self.quadratic.is_some() {
                // It depends on the parameter and needs no help with it.
                continue;
            }
            let uneven = unevenness(&d).0;
            sums[1] += EVEN_SPEED * node.weight * uneven * uneven;
        }
        sums
    }

    /// Adds `stiffness` times the energy, and the wish for even speed, to a
    /// model of the cost.
    pub(super) fn add<const D: usize>(
        &self,
        space: &Space,
        x: &[Vector<D>],
        stiffness: [f64; 2],
        model: &mut Model,
    ) {
        let mut block = Block::<D>::new(space.degree() + 1);
        for (k, (node, relief)) in self.nodes.iter().zip(&self.relief).enumerate() {
            let d = derivatives(space, node, x);
            block.clear(node.basis.first);
            let strength = stiffness[0] * node.weight;
            match &self.quadratic {
                None => push_variation(&mut block, &node.basis, &d, strength * relief),
                Some(weights) => {
                    let omega = self.turning(k);
                    push_quadratic(&mut block, (&node.basis, omega), &d, (weights, strength));
                }
            }
            if self.quadratic.is_some() {
                block.scatter(space, model);
                continue;
            }
            let (uneven, by) = unevenness(&d);
            let strength = stiffness[1] * EVEN_SPEED * node.weight;
            block.push(
                &node.basis,
                &[by[0], by[1], Vector::zeros()],
                uneven,
                strength,
            );
            block.scatter(space, model);
        }
    }
}

fn push_variation<const D: usize>(
    block: &mut Block<D>,
    basis: &BasisJet<4>,
    d: &[Vector<D>; 3],
    strength: f64,
) {
    let v = variation(d);
    for c in 0..D {
        let by = v.by.map(|m| m.row(c).transpose());
        block.push(basis, &by, v.value[c], strength);
    }
}

fn push_quadratic<const D: usize>(
    block: &mut Block<D>,
    (basis, turning): (&BasisJet<4>, f64),
    d: &[Vector<D>; 3],
    (weights, strength): (&Quadratic, f64),
) {
    for (k, weight) in weights.iter().enumerate().filter(|(_, w)| **w > 0.0) {
        for c in 0..D {
            let mut by = [Vector::zeros(); 3];
            by[k][c] = 1.0;
            let mut value = d[k][c];
            if k == 2 {
                by[0][c] = turning;
                value += turning * d[0][c];
            }
            block.push(basis, &by, value, strength * weight);
        }
    }
}

/// |κ| from the derivatives.
pub(super) fn curvature<const D: usize>(d: &[Vector<D>; 3]) -> f64 {
    let q = d[0].norm_squared().max(SLOWEST);
    (d[1] - d[0] * (d[0].dot(&d[1]) / q)).norm() / q
}

/// The share of one node in a model: dense and small, scattered at the end.
pub(super) struct Block<const D: usize> {
    first: usize,
    count: usize,
    matrix: Vec<f64>,
    gradient: Vec<f64>,
    row: Vec<f64>,
}

impl<const D: usize> Block<D> {
    /// Memory for `functions` functions.
    pub(super) fn new(functions: usize) -> Self {
        let size = functions * D;
        Block {
            first: 0,
            count: functions,
            matrix: vec![0.0; size * size],
            gradient: vec![0.0; size],
            row: vec![0.0; size],
        }
    }

    /// Empties the block for the functions from `first` on.
    pub(super) fn clear(&mut self, first: usize) {
        self.first = first;
        self.matrix.fill(0.0);
        self.gradient.fill(0.0);
    }

    /// Adds `strength · residual²` for a residual with the derivatives `by`
    /// with respect to r′, r″, r‴.
    pub(super) fn push<const ROWS: usize>(
        &mut self,
        basis: &BasisJet<ROWS>,
        by: &[Vector<D>; 3],
        residual: f64,
        strength: f64,
    ) {
        self.push_with_point(basis, (&Vector::zeros(), by), residual, strength);
    }

    /// The same for a residual that depends on the point too, with derivative
    /// `at`.
    pub(super) fn push_with_point<const ROWS: usize>(
        &mut self,
        basis: &BasisJet<ROWS>,
        (at, by): (&Vector<D>, &[Vector<D>; 3]),
        residual: f64,
        strength: f64,
    ) {
        for j in 0..self.count {
            let mut g = at * basis.values()[j];
            // Residuals of r′ and r″ alone come with a jet of fewer rows.
            for (k, by) in by.iter().enumerate().take(ROWS - 1) {
                g += by * basis.derivative(k + 1)[j];
            }
            self.row[j * D..(j + 1) * D].copy_from_slice(g.as_slice());
        }
        self.add_row(residual, strength);
    }

    fn add_row(&mut self, residual: f64, strength: f64) {
        let size = self.row.len();
        for a in 0..size {
            let share = strength * self.row[a];
            self.gradient[a] += share * residual;
            let line = &mut self.matrix[a * size..=a * size + a];
            for (slot, r) in line.iter_mut().zip(&self.row) {
                *slot += share * r;
            }
        }
    }

    /// Adds the block to the model.
    pub(super) fn scatter(&self, space: &Space, model: &mut Model) {
        let size = self.row.len();
        let place = |a: usize| space.unknown(self.first + a / D) * D + a % D;
        for a in 0..size {
            let i = place(a);
            model.gradient[i] += self.gradient[a];
            for b in 0..=a {
                model.matrix.add(i, place(b), self.matrix[a * size + b]);
            }
        }
    }
}

/// Adds `scale · rowᵀ row` for functions from `first` on.
pub(super) fn add_outer(
    space: &Space,
    matrix: &mut EnvelopeMatrix,
    first: usize,
    row: &[f64],
    scale: f64,
) {
    for (a, ra) in row.iter().enumerate() {
        let i = space.unknown(first + a);
        for (b, rb) in row[..=a].iter().enumerate() {
            matrix.add(i, space.unknown(first + b), scale * ra * rb);
        }
    }
}
