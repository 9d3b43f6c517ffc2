//! What must hold besides the springs: locked points, end tangents, end
//! curvatures, straight stretches. Each is a residual with a great weight and
//! a multiplier (method of multipliers, Hestenes 1969), so that it is met to
//! rounding without a weight that would ruin the condition of the system.

use super::energy::{Block, Model, Node};
use super::space::{Space, Vector};
use crate::geometry::bspline::BasisJet;
use nalgebra::SMatrix;

/// Weight of a hold against the stiffness of the curve there: each step of the multipliers takes off what is left by about
/// this factor or more.
const HOLD: f64 = 1e3;
/// Weight of straightness against the same: no multiplier, but enough that
/// what is left of a bend cannot be seen (κL of 1e-4); a hundred times more
/// and the line turns too slowly to where its points are.
const STRAIGHT: f64 = 1e-2;

/// One condition at a parameter.
#[derive(Debug, Clone)]
pub(super) enum Condition<const D: usize> {
    /// The tangent has this direction (unit length).
    Direction(Vector<D>),
    /// The curvature has this value: signed in the plane (positive: to the
    /// left), its amount in space.
    Curvature(f64),
    /// The curve passes here, as far as the axes with a 1 go.
    Place(Vector<D>, Vector<D>),
}

/// A condition with its place and multiplier.
#[derive(Debug, Clone)]
struct Hold<const D: usize> {
    u: f64,
    follows: bool,
    condition: Condition<D>,
    shift: Vector<D>,
    weight: f64,
}

/// All conditions of a curve.
#[derive(Debug, Clone)]
pub(super) struct Holds<const D: usize> {
    holds: Vec<Hold<D>>,
    /// Nodes of the straight stretches with their weights.
    straight: Vec<(Node, f64)>,
}

/// A residual of up to D components with derivatives by r′ and r″.
struct Residual<const D: usize> {
    value: Vector<D>,
    by: [SMatrix<f64, D, D>; 2],
    /// Derivative by the point itself: a diagonal.
    at: Vector<D>,
}

impl<const D: usize> Holds<D> {
    /// No condition.
    pub(super) fn none() -> Self {
        Holds {
            holds: Vec::new(),
            straight: Vec::new(),
        }
    }

    /// Whether nothing is held.
    pub(super) fn is_empty(&self) -> bool {
        self.holds.is_empty() && self.straight.is_empty()
    }

    /// Adds a condition at parameter `u`; `follows`: of a point whose foot
    /// moves ([`Self::follow`]).
    pub(super) fn push(&mut self, u: f64, condition: Condition<D>, follows: bool) {
        self.holds.push(Hold {
            u,
            follows,
            condition,
            shift: Vector::zeros(),
            weight: 1.0,
        });
    }

    /// Weighs the conditions against the stiffness of the coefficients that
    /// they act on; the multipliers stay what they are.
    pub(super) fn weigh(&mut self, space: &Space, stiffness: f64, of_each: &[f64]) {
        let local = |u: f64| {
            let basis = space.basis::<1>(u);
            let of = |k: usize| of_each[space.unknown(basis.first + k)];
            (0..basis.count).map(of).fold(f64::MIN_POSITIVE, f64::max)
        };
        let [a, b] = space.domain();
        let span = (b - a) / space.unknowns() as f64;
        for hold in &mut self.holds {
            // A tangent turns by the move of a coefficient over a span, a
            // curvature by that over its square.
            let order = match hold.condition {
                Condition::Place(..) => 0,
                Condition::Direction(_) => 2,
                Condition::Curvature(_) => 4,
            };
            let weight = HOLD * stiffness * local(hold.u) * span.powi(order);
            hold.shift *= hold.weight / weight;
            hold.weight = weight;
        }
        for (node, weight) in &mut self.straight {
            *weight = STRAIGHT * stiffness * local(node.u);
        }
    }

    /// Moves the conditions that belong to points to their new feet.
    pub(super) fn follow(&mut self, feet: impl Iterator<Item = f64>) {
        let places = self.holds.iter_mut().filter(|h| h.follows);
        for (hold, u) in places.zip(feet) {
            hold.u = u;
        }
    }

    /// Forgets the straight stretches, whose nodes belong to a space.
    pub(super) fn unstraighten(&mut self) {
        self.straight.clear();
    }

    /// Asks for a straight line between two parameters, given the nodes of
    /// the whole curve.
    pub(super) fn straighten(&mut self, nodes: &[Node], [from, to]: [f64; 2]) {
        let inside = |n: &&Node| n.u > from && n.u < to;
        let found = nodes.iter().filter(inside).map(|n| (n.clone(), 1.0));
        self.straight.extend(found);
    }

    /// Weighted squares.
    pub(super) fn cost(&self, space: &Space, x: &[Vector<D>]) -> f64 {
        let mut sum = 0.0;
        for hold in &self.holds {
            let r = hold.residual(space, x).1;
            sum += hold.weight * (r.value + hold.shift).norm_squared();
        }
        for (node, weight) in &self.straight {
            let r = bend(&pair(space, &node.basis, x));
            sum += weight * node.weight * r.value.norm_squared();
        }
        sum
    }

    /// Adds the conditions to a model.
    pub(super) fn add(&self, space: &Space, x: &[Vector<D>], model: &mut Model) {
        let mut block = Block::<D>::new(space.degree() + 1);
        for hold in &self.holds {
            let (basis, r) = hold.residual(space, x);
            block.clear(basis.first);
            push(&mut block, &basis, &r, &hold.shift, hold.weight);
            block.scatter(space, model);
        }
        for (node, weight) in &self.straight {
            let r = bend(&pair(space, &node.basis, x));
            block.clear(node.basis.first);
            let strength = weight * node.weight;
            push(&mut block, &node.basis, &r, &Vector::zeros(), strength);
            block.scatter(space, model);
        }
    }

    /// The largest residual.
    pub(super) fn residual(&self, space: &Space, x: &[Vector<D>]) -> f64 {
        let each = self
            .holds
            .iter()
            .map(|h| h.residual(space, x).1.value.norm());
        each.fold(0.0, f64::max)
    }

    /// The step of the multipliers. Returns the largest residual.
    pub(super) fn tighten(&mut self, space: &Space, x: &[Vector<D>]) -> f64 {
        let mut worst = 0.0_f64;
        for hold in &mut self.holds {
            let value = hold.residual(space, x).1.value;
            hold.shift += value;
            worst = worst.max(value.norm());
        }
        worst
    }
}

impl<const D: usize> Hold<D> {
    fn residual(&self, space: &Space, x: &[Vector<D>]) -> (BasisJet<3>, Residual<D>) {
        let basis = space.basis::<3>(self.u);
        let d = pair(space, &basis, x);
        let residual = match &self.condition {
            Condition::Direction(t) => sideways(&d, t),
            Condition::Place(p, mask) => Residual {
                value: (space.combine(basis.first, basis.values(), x) - p).component_mul(mask),
                by: [SMatrix::zeros(); 2],
                at: *mask,
            },
            Condition::Curvature(k) if *k == 0.0 => bend(&d),
            Condition::Curvature(k) => curvature_error(&d, *k),
        };
        (basis, residual)
    }
}

fn pair<const D: usize, const R: usize>(
    space: &Space,
    basis: &BasisJet<R>,
    x: &[Vector<D>],
) -> [Vector<D>; 2] {
    [1, 2].map(|k| space.combine(basis.first, basis.derivative(k), x))
}

fn push<const D: usize, const R: usize>(
    block: &mut Block<D>,
    basis: &BasisJet<R>,
    r: &Residual<D>,
    shift: &Vector<D>,
    strength: f64,
) {
    for c in 0..D {
        let by = [
            r.by[0].row(c).transpose(),
            r.by[1].row(c).transpose(),
            Vector::zeros(),
        ];
        let mut at = Vector::zeros();
        at[c] = r.at[c];
        block.push_with_point(basis, (&at, &by), r.value[c] + shift[c], strength);
    }
}

/// t − wanted for the unit tangent t: not r′ across the wanted direction,
/// which a curve can also make small by standing still.
fn sideways<const D: usize>(d: &[Vector<D>; 2], wanted: &Vector<D>) -> Residual<D> {
    let one = SMatrix::<f64, D, D>::identity();
    let speed = d[0].norm().max(f64::MIN_POSITIVE);
    let t = d[0] / speed;
    Residual {
        value: t - wanted,
        by: [(one - t * t.transpose()) / speed, SMatrix::zeros()],
        at: Vector::zeros(),
    }
}

/// The curvature vector P r″/(r′·r′): zero on a straight line.
fn bend<const D: usize>(d: &[Vector<D>; 2]) -> Residual<D> {
    let [r1, r2] = d;
    let one = SMatrix::<f64, D, D>::identity();
    let q = r1.norm_squared().max(f64::MIN_POSITIVE);
    let a = r1.dot(r2) / q;
    let value = (r2 - r1 * a) / q;
    let turn = -one * a - r1 * (r2 - r1 * (2.0 * a)).transpose() / q;
    Residual {
        value,
        by: [
            turn / q - value * r1.transpose() * (2.0 / q),
            (one - r1 * r1.transpose() / q) / q,
        ],
        at: Vector::zeros(),
    }
}

/// κ − wanted, in the first component.
fn curvature_error<const D: usize>(d: &[Vector<D>; 2], wanted: f64) -> Residual<D> {
    let [r1, r2] = d;
    let (q, s, a) = (r1.norm_squared(), r2.norm_squared(), r1.dot(r2));
    let q = q.max(f64::MIN_POSITIVE);
    // Area of the parallelogram of r′ and r″ and its derivatives; with a sign
    // in the plane.
    let (area, by1, by2) = if D == 2 {
        let mut turned = [Vector::<D>::zeros(); 2];
        (turned[0][0], turned[0][1]) = (r2[1], -r2[0]);
        (turned[1][0], turned[1][1]) = (-r1[1], r1[0]);
        (r1[0] * r2[1] - r1[1] * r2[0], turned[0], turned[1])
    } else {
        let area = (q * s - a * a).max(f64::MIN_POSITIVE).sqrt();
        (area, (r1 * s - r2 * a) / area, (r2 * q - r1 * a) / area)
    };
    let cube = q.powf(1.5);
    let curvature = area / cube;
    let mut residual: Residual<D> = Residual {
        value: Vector::zeros(),
        by: [SMatrix::zeros(); 2],
        at: Vector::zeros(),
    };
    residual.value[0] = curvature - wanted;
    let by1 = by1 / cube - r1 * (3.0 * curvature / q);
    residual.by[0].set_row(0, &by1.transpose());
    residual.by[1].set_row(0, &(by2 / cube).transpose());
    residual
}
