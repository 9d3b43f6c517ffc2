//! The fit without a tolerance: the stiffness from the noise of the points.

use super::energy::{Energy, Quadratic};
use super::holds::Holds;
use super::net::project;
use super::relax::Balance;
use super::space::{Space, Vector};
use super::springs::{Gram, Springs};
use super::stiffness::{Choice, Offsets};
use crate::solver::{Control, Stop};

/// A curve with its springs.
#[derive(Debug, Clone)]
pub(super) struct Shape<const D: usize> {
    /// The splines.
    pub(super) space: Space,
    /// Coefficients.
    pub(super) x: Vec<Vector<D>>,
    /// The energy with its weights along the curve.
    pub(super) energy: Energy,
}

/// Rounds of feet, stiffness and Gauss–Newton.
const MOST_ROUNDS: usize = 12;
/// Gauss–Newton steps a round.
const STEPS: usize = 4;
/// A step that lowers the cost by less than this share ends a round.
const ENOUGH: f64 = 1e-4;
/// Points from whose double on not all are asked at first: with so many the
/// first rounds come as near to the shape as the last ones need.
const FEW: usize = 2048;
/// Longest step of a foot, as a share of the domain.
const REACH: f64 = 0.05;
/// Curvature times length up to which a bend is gentle: that of four full
/// circles. Ship curves stay below; noses of aerofoils lie far above.
const GENTLE: f64 = 8.0 * std::f64::consts::PI;
/// What may be left of a hold, unit scale.
pub(super) const HELD: f64 = 1e-11;
/// Change of ln λ that does not change the curve visibly.
const SETTLED: f64 = 0.05;

/// Energy of the first shape: jerk, and so little of the others that they
/// matter only where two or three points leave the curve undetermined.
pub(super) const FIRST_ENERGY: Quadratic = [1e-12, 1e-9, 1.0];

/// The curve of the quadratic energy ∫ |r‴|² du at the stiffness that the
/// points suggest, with their feet where they are.
///
/// `None` if the points and the spline do not determine a curve.
pub(super) fn first_shape<const D: usize>(
    space: Space,
    springs: &Springs<D>,
    quadratic: Option<Quadratic>,
) -> Option<Shape<D>> {
    let every = (springs.points.len() / FEW).max(1);
    let few = (every > 1 && springs.held.is_empty()).then(|| springs.thinned(every));
    let springs = few.as_ref().unwrap_or(springs);
    let gram = springs.gram(&space, &vec![Vector::zeros(); space.unknowns()]);
    let model = Offsets::linear(&space, &FIRST_ENERGY, &gram);
    let (x, ..) = model.solve(model.choose(None).stiffness)?;
    Some(shape_of(space, x, quadratic))
}

/// The same, so soft that it all but passes through the points.
pub(super) fn soft_shape<const D: usize>(
    space: Space,
    springs: &Springs<D>,
    quadratic: Option<Quadratic>,
) -> Option<Shape<D>> {
    let gram = springs.gram(&space, &vec![Vector::zeros(); space.unknowns()]);
    let model = Offsets::linear(&space, &FIRST_ENERGY, &gram);
    let (x, ..) = model.solve(model.soft().stiffness)?;
    Some(shape_of(space, x, quadratic))
}

fn shape_of<const D: usize>(
    space: Space,
    x: Vec<Vector<D>>,
    quadratic: Option<Quadratic>,
) -> Shape<D> {
    let energy = Energy::new(&space, quadratic);
    let mut shape = Shape { space, x, energy };
    shape.relieve();
    shape
}

/// Fits `shape` to its springs; the stiffness comes from the points. Of very
/// many points some are asked first, and all of them only for the last rounds.
///
/// # Errors
/// When the control says stop.
pub(super) fn settle<const D: usize>(
    shape: &mut Shape<D>,
    springs: &mut Springs<D>,
    holds: &mut Holds<D>,
    control: &dyn Control,
) -> Result<Choice, Stop> {
    let every = springs.points.len() / FEW;
    if every < 2 || !springs.held.is_empty() {
        return rounds(shape, springs, holds, (None, control));
    }
    let mut few = springs.thinned(every);
    let first = rounds(shape, &mut few, holds, (None, control))?;
    // The same curve against as many springs the more.
    let near = first.likeliest + (every as f64).ln();
    rounds(shape, springs, holds, (Some(near), control))
}

/// Rounds of feet, stiffness and shape until nothing changes; `near`: ln λ of
/// the likeliest on almost the same curve.
fn rounds<const D: usize>(
    shape: &mut Shape<D>,
    springs: &mut Springs<D>,
    holds: &mut Holds<D>,
    (near, control): (Option<f64>, &dyn Control),
) -> Result<Choice, Stop> {
    let [a, b] = shape.space.domain();
    let reach = REACH * (b - a);
    let first_rounds = near.is_none();
    let least = if first_rounds { 2 } else { 1 };
    let mut choice: Option<Choice> = None;
    for round in 0..MOST_ROUNDS {
        control.check()?;
        springs.refresh(&shape.space, &shape.x, reach);
        let gram = springs.gram(&shape.space, &shape.x);
        let near = choice.map(|c| c.likeliest).or(near);
        let offsets = Offsets::about(&shape.space, &shape.energy, &gram, &shape.x);
        let next = if gram.count > 0 {
            offsets.choose(near)
        } else {
            offsets.soft()
        };
        holds.weigh(&shape.space, next.stiffness, &offsets.stiffnesses());
        holds.follow(springs.held_feet());
        shape.balance(&gram, holds, next.stiffness);
        if first_rounds && holds.is_empty() {
            shape.reach_ends(springs);
        }
        let unheld = holds.tighten(&shape.space, &shape.x);
        let change = |c: Choice| (c.stiffness.ln() - next.stiffness.ln()).abs();
        let steady = choice.is_some_and(|c| change(c) < SETTLED);
        choice = Some(next);
        if steady && round >= least && unheld <= HELD {
            break;
        }
    }
    springs.refresh(&shape.space, &shape.x, reach);
    Ok(choice.expect("there is at least one round"))
}

impl<const D: usize> Shape<D> {
    /// Weighs the energy by the curvature of the present shape. Once, of the
    /// first shape: a weight that followed the curve would reward it for
    /// gathering its curvature in a cusp, which then weighs nothing.
    pub(super) fn relieve(&mut self) {
        let [a, b] = self.space.domain();
        self.energy.relieve(&self.space, &self.x, GENTLE / (b - a));
    }

    /// Lets the curve begin and end at the feet of its end points. At held feet
    /// the springs of all points resist a move along the curve, so that a stiff
    /// one would come to its ends only by very many rounds.
    fn reach_ends(&mut self, springs: &Springs<D>) {
        /// Moves of an end, share of the domain: one that cannot be seen, and
        /// one that has another cause.
        const SEEN: f64 = 1e-6;
        const MOST: f64 = 0.05;
        let pinned: Vec<usize> = (0..springs.points.len())
            .filter(|i| springs.pinned[*i])
            .collect();
        let &[i, j] = pinned.as_slice() else {
            return;
        };
        if self.space.is_closed() || !springs.is_free() {
            return;
        }
        let [a, b] = self.space.domain();
        let [i, j] = if springs.feet[i] <= springs.feet[j] {
            [i, j]
        } else {
            [j, i]
        };
        let curve = self.space.pieces(&self.x);
        let shift = |u: f64, p: &Vector<D>| {
            let [point, d1, d2] = curve.jet::<3>(u);
            let away = p - point;
            let speed = d1.norm_squared();
            away.dot(&d1) / (speed - away.dot(&d2)).max(0.1 * speed)
        };
        let shifts = [shift(a, &springs.points[i]), shift(b, &springs.points[j])];
        let most = shifts[0].abs().max(shifts[1].abs()) / (b - a);
        let at_ends = springs.feet[i] == a && springs.feet[j] == b;
        if !at_ends || most.is_nan() || !(SEEN..=MOST).contains(&most) {
            return;
        }
        let stretch = (b - a + shifts[1] - shifts[0]) / (b - a);
        let beyond = |u: f64, end: f64| {
            let [point, d1, d2] = curve.jet::<3>(end);
            point + d1 * (u - end) + d2 * (0.5 * (u - end).powi(2))
        };
        let stretched = project(&self.space, |u| {
            let u = a + shifts[0] + (u - a) * stretch;
            if u < a {
                beyond(u, a)
            } else if u > b {
                beyond(u, b)
            } else {
                curve.point(u)
            }
        });
        if let Some(x) = stretched {
            self.x = x;
        }
    }

    /// Gauss–Newton steps at a stiffness.
    pub(super) fn balance(&mut self, gram: &Gram<D>, holds: &Holds<D>, stiffness: f64) -> usize {
        Balance {
            space: &self.space,
            energy: &self.energy,
            gram,
            holds,
            stiffness,
        }
        .relax(&mut self.x, STEPS, ENOUGH)
    }
}
