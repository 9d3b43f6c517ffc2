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
/// Halvings of a step.
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

/// Walks from `x`, strictly within the bounds at the feet of `springs`.
///
/// # Errors
/// When the control says stop.
pub(super) fn fairest<const D: usize>(
    terms: &Terms<D>,
    springs: &mut Springs<D>,
    x: &mut Vec<Vector<D>>,
    control: &dyn Control,
) -> Result<Fairest, Stop> {
    let count = terms.bounds.tolerance.iter().filter(|t| t.is_finite()).count() as f64;
    let [a, b] = terms.space.domain();
    let reach = 0.02 * (b - a);
    let first = terms.objective(x);
    let nothing = no_energy(terms.space);
    let mut mu = first.max(nothing) / count.max(1.0);
    let mut rooms = terms.rooms(springs, x);
    let mut duals: Vec<f64> = rooms.iter().map(|c| mu / c).collect();
    let mut steps = 0;
    while steps < MOST_STEPS {
        control.check()?;
        let before = terms.objective(x);
        let direction = solve(&terms.model(springs, x, &duals, &rooms, mu));
        let taken = direction
            .and_then(|d| terms.step(springs, x, &d, (mu, before)).map(|share| (d, share)));
        steps += 1;
        let Some((d, share)) = taken else {
            if mu * count <= GAP * before.max(nothing) {
                break;
            }
            mu *= FALL;
            continue;
        };
        let slopes = terms.slopes(springs, x, &d);
        for ((z, c), slope) in duals.iter_mut().zip(&rooms).zip(&slopes) {
            *z += share * (mu / c - *z - *z / c * slope);
        }
        *x = stepped(x, &d, share);
        springs.refresh(terms.space, x, reach);
        rooms = terms.rooms(springs, x);
        for (z, c) in duals.iter_mut().zip(&rooms) {
            // Near the central path, so that no dual runs away (eq. 16 of
            // Wächter & Biegler 2006).
            *z = z.clamp(mu / c * 1e-3, mu / c * 1e3);
        }
        let now = terms.objective(x);
        let gain = before - now;
        if mu * count <= GAP * now.max(nothing) && gain <= GAP * now {
            break;
        }
        if share > 0.1 {
            mu *= if share > 0.7 { FALL } else { FALL.sqrt() };
        }
    }
    let gap = mu * count / terms.objective(x).max(f64::MIN_POSITIVE);
    Ok(Fairest { duals, steps, gap })
}

impl<const D: usize> Terms<'_, D> {
    /// Energy, even speed, holds and locked points.
    fn objective(&self, x: &[Vector<D>]) -> f64 {
        let [fair, even] = self.energy.cost(self.space, x);
        fair + even + self.holds.cost(self.space, x) + self.bounds.others.cost(x)
    }

    /// cᵢ = 1 − ‖eᵢ‖²/εᵢ².
    fn rooms(&self, springs: &Springs<D>, x: &[Vector<D>]) -> Vec<f64> {
        self.per_point(springs, |i| {
            let e = springs.points[i] - self.space.point(x, springs.feet[i]);
            room(&e, self.bounds.tolerance[i])
        })
    }

    /// dcᵢ for a full step along `d`.
    fn slopes(&self, springs: &Springs<D>, x: &[Vector<D>], d: &[f64]) -> Vec<f64> {
        let change: Vec<Vector<D>> = as_vectors(d);
        self.per_point(springs, |i| {
            let u = springs.feet[i];
            let e = springs.points[i] - self.space.point(x, u);
            let t = self.bounds.tolerance[i];
            2.0 * e.dot(&self.space.point(&change, u)) / (t * t)
        })
    }

    fn per_point(&self, springs: &Springs<D>, f: impl Fn(usize) -> f64 + Sync) -> Vec<f64> {
        let n = springs.points.len();
        (0..n.div_ceil(CHUNK))
            .into_par_iter()
            .flat_map_iter(|k| (k * CHUNK..(k * CHUNK + CHUNK).min(n)).map(&f))
            .collect()
    }

    /// The share of a step that keeps every bound and lowers the barrier
    /// function F − μ Σ ln c.
    fn step(
        &self,
        springs: &Springs<D>,
        x: &[Vector<D>],
        d: &[f64],
        (mu, objective): (f64, f64),
    ) -> Option<f64> {
        let change: Vec<Vector<D>> = as_vectors(d);
        let pairs: Vec<(Vector<D>, Vector<D>, f64)> = (0..springs.points.len())
            .filter(|i| self.bounds.tolerance[*i].is_finite())
            .map(|i| {
                let u = springs.feet[i];
                let e = springs.points[i] - self.space.point(x, u);
                (e, self.space.point(&change, u), self.bounds.tolerance[i])
            })
            .collect();
        let barrier = |share: f64| -> Option<f64> {
            let mut sum = 0.0;
            for (e, move_, t) in &pairs {
                let (before, after) = (room(e, *t), room(&(e - move_ * share), *t));
                if after <= KEPT * before {
                    return None;
                }
                sum -= (after / before).ln();
            }
            Some(mu * sum)
        };
        let mut share = 1.0;
        for _ in 0..HALVINGS {
            if let Some(barrier) = barrier(share) {
                let value = self.objective(&stepped(x, d, share));
                if value + barrier < objective {
                    return Some(share);
                }
            }
            share *= 0.6;
        }
        None
    }

    /// The system of one step.
    fn model(
        &self,
        springs: &Springs<D>,
        x: &[Vector<D>],
        duals: &[f64],
        rooms: &[f64],
        mu: f64,
    ) -> Model {
        let mut model = Model {
            matrix: self.space.matrix(D),
            gradient: vec![0.0; x.len() * D],
        };
        self.energy.add(self.space, x, [1.0; 2], &mut model);
        self.holds.add(self.space, x, &mut model);
        add_springs(self.bounds.others, x, &mut model);
        let n = springs.points.len();
        let sums: Vec<Sums> = (0..n.div_ceil(CHUNK))
            .into_par_iter()
            .map(|k| {
                let mut sums = Sums::new::<D>(self.space);
                for i in k * CHUNK..(k * CHUNK + CHUNK).min(n) {
                    let t = self.bounds.tolerance[i];
                    if t.is_finite() {
                        let e = springs.points[i] - self.space.point(x, springs.feet[i]);
                        let stiff = Stiff {
                            spring: duals[i] / (t * t),
                            wall: 2.0 * duals[i] / (rooms[i] * t.powi(4)),
                            push: mu / (rooms[i] * t * t),
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
    d.chunks_exact(D).map(Vector::<D>::from_column_slice).collect()
}

/// What one point adds: K = z/ε², its growth towards the wall, its push.
struct Stiff {
    spring: f64,
    wall: f64,
    push: f64,
}

/// Sums over points by span: lower triangles of small dense blocks.
struct Sums {
    size: usize,
    matrix: Vec<f64>,
    gradient: Vec<f64>,
}

impl Sums {
    fn new<const D: usize>(space: &Space) -> Self {
        let size = (space.degree() + 1) * D;
        Sums {
            size,
            matrix: vec![0.0; space.functions() * size * (size + 1) / 2],
            gradient: vec![0.0; space.functions() * size],
        }
    }

    fn add<const D: usize>(&mut self, space: &Space, u: f64, e: &Vector<D>, stiff: &Stiff) {
        let basis = space.basis::<1>(u);
        let block = basis.first * self.size * (self.size + 1) / 2;
        let mut slots = self.matrix[block..].iter_mut();
        let gradient = &mut self.gradient[basis.first * self.size..][..self.size];
        for (a, ba) in basis.values().iter().enumerate() {
            for c in 0..D {
                gradient[a * D + c] -= stiff.push * ba * e[c];
                let row = e * (stiff.wall * e[c]);
                for bb in &basis.values()[..a] {
                    for k in 0..D {
                        let own = if k == c { stiff.spring } else { 0.0 };
                        if let Some(slot) = slots.next() {
                            *slot += ba * bb * (own + row[k]);
                        }
                    }
                }
                for k in 0..=c {
                    let own = if k == c { stiff.spring } else { 0.0 };
                    if let Some(slot) = slots.next() {
                        *slot += ba * ba * (own + row[k]);
                    }
                }
            }
        }
    }

    fn scatter<const D: usize>(&self, space: &Space, model: &mut Model) {
        let triangle = self.size * (self.size + 1) / 2;
        for first in 0..space.functions() {
            let block = &self.matrix[first * triangle..(first + 1) * triangle];
            if block.iter().all(|v| *v == 0.0) {
                continue;
            }
            let place = |a: usize| space.unknown(first + a / D) * D + a % D;
            let mut values = block.iter();
            for a in 0..self.size {
                model.gradient[place(a)] += self.gradient[first * self.size + a];
                for b in 0..=a {
                    let value = values.next().copied().unwrap_or(0.0);
                    model.matrix.add(place(a), place(b), value);
                }
            }
        }
    }
}
