//! The fairest curve within the tolerances: minimise the energy F subject to
//! ‖pᵢ − r(uᵢ)‖ ≤ εᵢ for every point.
//!
//! At held feet each bound is a convex quadratic, and the true distance is
//! never more than ‖pᵢ − r(uᵢ)‖: a step that keeps the bounds at held feet
//! keeps them on the curve, and projecting the feet anew only gives room.
//! A primal–dual interior point method (Nocedal & Wright, *Numerical
//! Optimization*, ch. 19) walks from a curve strictly within the bounds
//! towards the fairest:
//!
//! with eᵢ = pᵢ − r(uᵢ), cᵢ = 1 − ‖eᵢ‖²/εᵢ² and multipliers zᵢ, zᵢcᵢ → μ ↓ 0,
//!
//! (½F″ + Σ zᵢ/εᵢ² (bᵢbᵢᵀ ⊗ (1 + 2 eᵢeᵢᵀ/(cᵢεᵢ²)))) δ
//!   = −½F′ + Σ μ/(cᵢεᵢ²) bᵢ ⊗ eᵢ.
//!
//! So zᵢ/εᵢ² is the stiffness Kᵢ of the paper's spring, one of its own for
//! each point, and 0 where the point has room. Every matrix is banded: the
//! cost of a step is linear in the number of points.

use super::energy::{Energy, Model};
use super::holds::Holds;
use super::relax::{add_springs, solve, stepped};
use super::space::{Space, Vector};
use super::springs::{Gram, Springs};
use super::walls::{Stiff, Sums};
use crate::solver::{Control, Stop};
use rayon::prelude::*;

/// Points handled by one task; fixed for equal sums on any number of threads.
const CHUNK: usize = 2048;
/// Steps at most.
const MOST_STEPS: usize = 120;
/// The duality gap, as share of the energy, at which the curve is the fairest.
const GAP: f64 = 1e-4;
/// Share of its room that a bound must keep in one step.
const KEPT: f64 = 0.02;
/// How fast μ falls after a good step.
const FALL: f64 = 0.2;
/// Slack at which a curve has entered its bounds: 5 % of room on every side.
const ENTERED: f64 = -0.1;
/// A way in ends where so many steps take off less than this share of ‖e‖²/ε².
const STRETCH: usize = 12;
const STALLED: f64 = 0.005;
/// Longest step of a foot, as a share of the domain.
const REACH: f64 = 0.02;
/// Shortenings of a step.
const HALVINGS: usize = 25;

/// What bounds the points.
pub(super) struct Bounds<'a, const D: usize> {
    /// εᵢ for each point, unit scale; infinite where a point is not bounded.
    pub(super) tolerance: &'a [f64],
    /// Springs besides: stiff ones for locked points, lazy ones for all, that
    /// choose the nearest among equally fair curves.
    pub(super) others: &'a Gram<D>,
}

/// The fairest curve found.
#[derive(Debug, Clone)]
pub(super) struct Fairest {
    /// zᵢ, the multiplier of each point's bound; ∂F/∂εᵢ = −2 zᵢ/εᵢ.
    pub(super) duals: Vec<f64>,
    /// Steps taken.
    pub(super) steps: usize,
    /// Duality gap as a share of the energy.
    pub(super) gap: f64,
    /// Slack that the bounds still need; ≤ 0 if they are kept.
    pub(super) slack: f64,
}

/// What a curve is measured by on the way.
pub(super) struct Terms<'a, const D: usize> {
    /// The splines.
    pub(super) space: &'a Space,
    /// The energy.
    pub(super) energy: &'a Energy,
    /// Tangents, curvatures, straight stretches.
    pub(super) holds: &'a Holds<D>,
    /// The bounds.
    pub(super) bounds: Bounds<'a, D>,
}

/// ∫ κ′² ds below which a curve of this length is a circle or a line to the
/// eye: that of κ changing by 1e-3/L along it.
pub(super) fn no_energy(space: &Space) -> f64 {
    let [a, b] = space.domain();
    1e-6 / (b - a).powi(3)
}

/// Where a walk is.
struct Walk<'a, const D: usize> {
    springs: &'a mut Springs<D>,
    x: &'a mut Vec<Vector<D>>,
    /// s: every bound is ‖e‖² ≤ (1 + s) ε².
    slack: f64,
    /// Price of slack; 0 where there is none.
    price: f64,
    mu: f64,
    rooms: Vec<f64>,
    duals: Vec<f64>,
}

/// A step of coefficients and slack.
struct Step {
    d: Vec<f64>,
    slack: f64,
}

/// Walks from `x`, strictly within the bounds at the feet of `springs`, to
/// the fairest.
///
/// # Errors
/// When the control says stop.
pub(super) fn fairest<const D: usize>(
    terms: &Terms<D>,
    springs: &mut Springs<D>,
    x: &mut Vec<Vector<D>>,
    control: &dyn Control,
) -> Result<Fairest, Stop> {
    let mut walk = Walk::begin(terms, springs, x, 0.0);
    walk.run(terms, control)
}

/// Walks from any `x` into the bounds, as fair as that can be, by a slack s in
/// ‖eᵢ‖² ≤ (1 + s) εᵢ² that costs `price`. Ends as soon as every point is
/// within; a slack above 0 at the end says that the spline cannot (or not at
/// that price).
///
/// # Errors
/// When the control says stop.
pub(super) fn enter<const D: usize>(
    terms: &Terms<D>,
    springs: &mut Springs<D>,
    x: &mut Vec<Vector<D>>,
    price: f64,
    control: &dyn Control,
) -> Result<Fairest, Stop> {
    let mut walk = Walk::begin(terms, springs, x, price);
    walk.run(terms, control)
}

/// The energy of a curve in which prices are counted: where it is still a line
/// or an arc, that of one that is neither, κ changing by 1/L along it.
pub(super) fn currency<const D: usize>(space: &Space, energy: &Energy, x: &[Vector<D>]) -> f64 {
    let [a, b] = space.domain();
    let [fair, even] = energy.cost(space, x);
    (fair + even).max((b - a).powi(-3))
}

impl<'a, const D: usize> Walk<'a, D> {
    fn begin(
        terms: &Terms<D>,
        springs: &'a mut Springs<D>,
        x: &'a mut Vec<Vector<D>>,
        price: f64,
    ) -> Self {
        let worst = 1.0 - terms.rooms(springs, x).into_iter().fold(1.0, f64::min);
        let slack = if price > 0.0 {
            1.2 * worst + 0.1 - 1.0
        } else {
            0.0
        };
        let count = terms.count();
        let first = terms.objective(x).max(no_energy(terms.space));
        let mu = first / count.max(1.0);
        let rooms: Vec<f64> = terms.rooms(springs, x).iter().map(|c| c + slack).collect();
        let duals = rooms.iter().map(|c| mu / c).collect();
        Walk {
            springs,
            x,
            slack,
            price,
            mu,
            rooms,
            duals,
        }
    }

    fn run(&mut self, terms: &Terms<D>, control: &dyn Control) -> Result<Fairest, Stop> {
        let nothing = no_energy(terms.space);
        let count = terms.count();
        let mut steps = 0;
        // A circle or a line is as fair as can be; the nearest one is given.
        let done = self.price == 0.0 && terms.objective(self.x) <= nothing;
        let mut before_stretch = f64::INFINITY;
        while steps < MOST_STEPS && !done {
            control.check()?;
            steps += 1;
            if self.price > 0.0 && steps % STRETCH == 0 {
                if before_stretch - self.slack <= STALLED * (1.0 + self.slack) {
                    break;
                }
                before_stretch = self.slack;
            }
            let before = self.objective(terms);
            let share = self.advance(terms, before);
            if self.price > 0.0 && self.slack <= ENTERED {
                break;
            }
            let now = self.objective(terms);
            let small = self.mu * count <= GAP * now.abs().max(nothing);
            match share {
                None if small => break,
                None => self.mu *= FALL,
                Some(share) => {
                    if small && before - now <= GAP * now.abs() {
                        break;
                    }
                    if share > 0.1 {
                        self.mu *= if share > 0.7 { FALL } else { FALL.sqrt() };
                    }
                }
            }
        }
        let energy = terms.objective(self.x).max(nothing);
        Ok(Fairest {
            duals: if done {
                vec![0.0; self.duals.len()]
            } else {
                self.duals.clone()
            },
            steps,
            gap: if done { 0.0 } else { self.mu * count / energy },
            slack: self.slack,
        })
    }

    fn all_rooms(&self, terms: &Terms<D>) -> Vec<f64> {
        let rooms = terms.rooms(self.springs, self.x);
        rooms.iter().map(|c| c + self.slack).collect()
    }

    fn objective(&self, terms: &Terms<D>) -> f64 {
        terms.objective(self.x) + self.price * self.slack
    }

    /// One step; the share of it that was taken.
    fn advance(&mut self, terms: &Terms<D>, before: f64) -> Option<f64> {
        let step = self.direction(terms)?;
        let share = self.search(terms, &step, before)?;
        let slopes = terms.slopes(self.springs, self.x, &step.d);
        for ((z, c), slope) in self.duals.iter_mut().zip(&self.rooms).zip(&slopes) {
            *z += share * (self.mu / c - *z - *z / c * (slope + step.slack));
        }
        *self.x = stepped(self.x, &step.d, share);
        self.slack += share * step.slack;
        let [a, b] = terms.space.domain();
        let feet = self.springs.feet.clone();
        self.springs.refresh(terms.space, self.x, REACH * (b - a));
        self.rooms = self.all_rooms(terms);
        if self.rooms.iter().any(|c| *c <= 0.0) {
            // A foot that agrees in some axes only may be farther away than it
            // was: it waits.
            let each = self.springs.feet.iter_mut().zip(&feet).zip(&self.rooms);
            each.filter(|(_, c)| **c <= 0.0)
                .for_each(|((u, before), _)| *u = *before);
            self.rooms = self.all_rooms(terms);
        }
        for (z, c) in self.duals.iter_mut().zip(&self.rooms) {
            // Near the central path, so that no dual runs away (Wächter &
            // Biegler 2006, eq. 16).
            let central = self.mu / c;
            *z = z.max(central * 1e-3).min(central * 1e3);
        }
        Some(share)
    }

    /// The primal–dual step; slack by a bordered system.
    fn direction(&self, terms: &Terms<D>) -> Option<Step> {
        let mut model = terms.model(self.springs, self.x, self.weights());
        if self.price == 0.0 {
            let d = solve(&model)?;
            return Some(Step { d, slack: 0.0 });
        }
        // a = Σ z/(c ε²) b ⊗ e couples slack and coefficients.
        let border = terms.border(self.springs, self.x, self.weights());
        let each = self
            .rooms
            .iter()
            .zip(&self.duals)
            .zip(terms.bounds.tolerance);
        let (mut curve, mut pull) = (0.0, -self.price);
        for ((c, z), t) in each {
            if t.is_finite() {
                curve += z / c;
                pull += self.mu / c;
            }
        }
        let plain = solve(&model)?;
        model.gradient = border.iter().map(|v| -v).collect();
        let along = solve(&model)?;
        let dot = |v: &[f64]| border.iter().zip(v).map(|(a, b)| a * b).sum::<f64>();
        let slack = (0.5 * pull - dot(&plain)) / (0.5 * curve - dot(&along));
        let d = plain
            .iter()
            .zip(&along)
            .map(|(p, a)| p - slack * a)
            .collect();
        slack.is_finite().then_some(Step { d, slack })
    }

    fn weights(&self) -> Weights<'_> {
        Weights {
            duals: &self.duals,
            rooms: &self.rooms,
            mu: self.mu,
        }
    }

    /// The share of a step that keeps every bound and lowers the barrier
    /// function F + price·s − μ Σ ln c.
    fn search(&self, terms: &Terms<D>, step: &Step, before: f64) -> Option<f64> {
        let change: Vec<Vector<D>> = as_vectors(&step.d);
        let (curve, moved) = (terms.space.pieces(self.x), terms.space.pieces(&change));
        let pairs: Vec<Pair<D>> = (0..self.springs.points.len())
            .filter(|i| terms.bounds.tolerance[*i].is_finite())
            .map(|i| {
                let u = self.springs.feet[i];
                Pair {
                    away: self.springs.points[i] - curve.point(u),
                    change: moved.point(u),
                    tolerance: terms.bounds.tolerance[i],
                    room: self.rooms[i],
                }
            })
            .collect();
        let barrier = |share: f64| -> Option<f64> {
            let slack = self.slack + share * step.slack;
            let mut sum = 0.0;
            for p in &pairs {
                let after = room(&(p.away - p.change * share), p.tolerance) + slack;
                if after <= KEPT * p.room {
                    return None;
                }
                sum -= (after / p.room).ln();
            }
            Some(self.mu * sum)
        };
        let mut share = 1.0;
        for _ in 0..HALVINGS {
            if let Some(barrier) = barrier(share) {
                let energy = terms.objective(&stepped(self.x, &step.d, share));
                let value = energy + self.price * (self.slack + share * step.slack);
                if value + barrier < before {
                    return Some(share);
                }
            }
            share *= 0.6;
        }
        None
    }
}

/// A bounded point during a line search.
struct Pair<const D: usize> {
    away: Vector<D>,
    change: Vector<D>,
    tolerance: f64,
    room: f64,
}

/// Multipliers, rooms and μ at a step.
#[derive(Clone, Copy)]
struct Weights<'a> {
    duals: &'a [f64],
    rooms: &'a [f64],
    mu: f64,
}

impl<const D: usize> Terms<'_, D> {
    /// Energy, even speed, holds and locked points.
    fn objective(&self, x: &[Vector<D>]) -> f64 {
        let [fair, even] = self.energy.cost(self.space, x);
        fair + even + self.holds.cost(self.space, x) + self.bounds.others.cost(x)
    }

    /// cᵢ = 1 − ‖eᵢ‖²/εᵢ².
    fn rooms(&self, springs: &Springs<D>, x: &[Vector<D>]) -> Vec<f64> {
        let curve = self.space.pieces(x);
        self.per_point(springs, |i| {
            let e = springs.points[i] - curve.point(springs.feet[i]);
            room(&e, self.bounds.tolerance[i])
        })
    }

    /// dcᵢ for a full step along `d`.
    fn slopes(&self, springs: &Springs<D>, x: &[Vector<D>], d: &[f64]) -> Vec<f64> {
        let change: Vec<Vector<D>> = as_vectors(d);
        let (curve, moved) = (self.space.pieces(x), self.space.pieces(&change));
        self.per_point(springs, |i| {
            let u = springs.feet[i];
            let e = springs.points[i] - curve.point(u);
            let t = self.bounds.tolerance[i];
            2.0 * e.dot(&moved.point(u)) / (t * t)
        })
    }

    fn per_point(&self, springs: &Springs<D>, f: impl Fn(usize) -> f64 + Sync) -> Vec<f64> {
        let n = springs.points.len();
        (0..n.div_ceil(CHUNK))
            .into_par_iter()
            .flat_map_iter(|k| (k * CHUNK..(k * CHUNK + CHUNK).min(n)).map(&f))
            .collect()
    }

    /// Number of bounded points.
    fn count(&self) -> f64 {
        self.bounds
            .tolerance
            .iter()
            .filter(|t| t.is_finite())
            .count() as f64
    }

    /// Σ z/(c ε²) b ⊗ e.
    fn border(&self, springs: &Springs<D>, x: &[Vector<D>], weights: Weights) -> Vec<f64> {
        let mut out = vec![0.0; x.len() * D];
        for (i, t) in self.bounds.tolerance.iter().enumerate() {
            if !t.is_finite() {
                continue;
            }
            let basis = self.space.basis::<1>(springs.feet[i]);
            let e = springs.points[i] - self.space.combine(basis.first, basis.values(), x);
            let pull = e * (weights.duals[i] / (weights.rooms[i] * t * t));
            for (k, b) in basis.values().iter().enumerate() {
                let at = self.space.unknown(basis.first + k) * D;
                for c in 0..D {
                    out[at + c] += b * pull[c];
                }
            }
        }
        out
    }

    /// The system of one step.
    fn model(&self, springs: &Springs<D>, x: &[Vector<D>], weights: Weights) -> Model {
        let mut model = Model {
            matrix: self.space.matrix(D),
            gradient: vec![0.0; x.len() * D],
        };
        self.energy.add(self.space, x, [1.0; 2], &mut model);
        self.holds.add(self.space, x, &mut model);
        add_springs(self.bounds.others, x, &mut model);
        let n = springs.points.len();
        let curve = self.space.pieces(x);
        let sums: Vec<Sums> = (0..n.div_ceil(CHUNK))
            .into_par_iter()
            .map(|k| {
                let mut sums = Sums::new::<D>(self.space);
                for i in k * CHUNK..(k * CHUNK + CHUNK).min(n) {
                    let t = self.bounds.tolerance[i];
                    if t.is_finite() {
                        let e = springs.points[i] - curve.point(springs.feet[i]);
                        let stiff = Stiff {
                            spring: weights.duals[i] / (t * t),
                            wall: 2.0 * weights.duals[i] / (weights.rooms[i] * t.powi(4)),
                            push: weights.mu / (weights.rooms[i] * t * t),
                        };
                        sums.add(self.space, springs.feet[i], &e, &stiff);
                    }
                }
                sums
            })
            .collect();
        for sums in &sums {
            sums.scatter::<D>(self.space, &mut model);
        }
        model
    }
}

fn room<const D: usize>(e: &Vector<D>, tolerance: f64) -> f64 {
    1.0 - e.norm_squared() / (tolerance * tolerance)
}

fn as_vectors<const D: usize>(d: &[f64]) -> Vec<Vector<D>> {
    d.chunks_exact(D)
        .map(Vector::<D>::from_column_slice)
        .collect()
}
