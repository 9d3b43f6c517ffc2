//! Gauss–Newton for the curve of least energy against its springs, at held
//! feet and held stiffness.

use super::energy::{Energy, Model};
use super::holds::Holds;
use super::space::{Space, Vector};
use super::springs::Gram;

/// Halvings of a step before it is given up: 2⁻¹² of the whole.
const HALVINGS: usize = 12;

/// What is minimised: λ·energy + springs + holds.
pub(super) struct Balance<'a, const D: usize> {
    /// The splines.
    pub(super) space: &'a Space,
    /// The energy with its nodes.
    pub(super) energy: &'a Energy,
    /// The springs at held feet.
    pub(super) gram: &'a Gram<D>,
    /// What must hold besides.
    pub(super) holds: &'a Holds<D>,
    /// λ.
    pub(super) stiffness: f64,
}

impl<const D: usize> Balance<'_, D> {
    /// λ·energy + λ·unevenness + springs + holds.
    pub(super) fn cost(&self, x: &[Vector<D>]) -> f64 {
        let [fair, even] = self.energy.cost(self.space, x);
        self.stiffness * (fair + even) + self.gram.cost(x) + self.holds.cost(self.space, x)
    }

    /// Steps until the cost falls by less than `enough` of itself, at most
    /// `most` of them. Returns the number of steps.
    pub(super) fn relax(&self, x: &mut Vec<Vector<D>>, most: usize, enough: f64) -> usize {
        let mut cost = self.cost(x);
        for step in 0..most {
            let Some(direction) = self.direction(x) else {
                return step;
            };
            let Some((next, lower)) = self.search(x, &direction, cost) else {
                return step;
            };
            *x = next;
            let gain = cost - lower;
            cost = lower;
            if gain <= enough * cost {
                return step + 1;
            }
        }
        most
    }

    /// The Gauss–Newton step.
    fn direction(&self, x: &[Vector<D>]) -> Option<Vec<f64>> {
        let mut model = Model {
            matrix: self.space.matrix(D),
            gradient: vec![0.0; x.len() * D],
        };
        let stiff = [self.stiffness; 2];
        self.energy.add(self.space, x, stiff, &mut model);
        self.holds.add(self.space, x, &mut model);
        add_springs(self.gram, x, &mut model);
        solve(&model)
    }

    fn search(
        &self,
        x: &[Vector<D>],
        direction: &[f64],
        cost: f64,
    ) -> Option<(Vec<Vector<D>>, f64)> {
        let mut share = 1.0;
        for _ in 0..HALVINGS {
            let next = stepped(x, direction, share);
            let value = self.cost(&next);
            if value < cost {
                return Some((next, value));
            }
            share *= 0.5;
        }
        None
    }
}

/// x + share · direction.
pub(super) fn stepped<const D: usize>(
    x: &[Vector<D>],
    direction: &[f64],
    share: f64,
) -> Vec<Vector<D>> {
    x.iter()
        .zip(direction.chunks_exact(D))
        .map(|(x, d)| x + Vector::<D>::from_column_slice(d) * share)
        .collect()
}

/// −A⁻¹ gradient, with a diagonal added where A is singular to rounding.
pub(super) fn solve(model: &Model) -> Option<Vec<f64>> {
    /// Share of the mean diagonal that is added first, and the factor by
    /// which it grows until the factorisation succeeds.
    const FIRST: f64 = 1e-14;
    const GROWTH: f64 = 100.0;
    const TRIES: usize = 6;
    let n = model.gradient.len();
    let mean = model.matrix.diagonal().sum::<f64>() / n as f64;
    let mut matrix = model.matrix.clone();
    let mut added = 0.0;
    for k in 0..TRIES {
        if let Ok(factor) = matrix.factor() {
            let mut step: Vec<f64> = model.gradient.iter().map(|g| -g).collect();
            factor.solve_in_place(&mut step);
            return step.iter().all(|s| s.is_finite()).then_some(step);
        }
        let more = mean * FIRST * GROWTH.powi(k as i32) - added;
        added += more;
        (0..n).for_each(|i| matrix.add_to_diagonal(i, more));
    }
    None
}

/// Adds the springs to a model.
pub(super) fn add_springs<const D: usize>(gram: &Gram<D>, x: &[Vector<D>], model: &mut Model) {
    for (slot, pull) in model.gradient.chunks_exact_mut(D).zip(gram.pull(x)) {
        for c in 0..D {
            slot[c] -= pull[c];
        }
    }
    for i in 0..x.len() {
        for j in gram.matrix.first_column(i)..=i {
            let value = gram.matrix.get(i, j);
            if value != 0.0 {
                for c in 0..D {
                    model.matrix.add(i * D + c, j * D + c, value);
                }
            }
        }
    }
}
