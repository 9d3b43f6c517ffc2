//! The share of bounded points in the system of a step, summed span by span.

use super::energy::Model;
use super::space::{Space, Vector};

/// What one point adds: K = z/ε², its growth towards the wall, its push.
pub(super) struct Stiff {
    /// K.
    pub(super) spring: f64,
    /// 2 z/(c ε⁴).
    pub(super) wall: f64,
    /// μ/(c ε²).
    pub(super) push: f64,
}

/// Sums over points by span: lower triangles of small dense blocks.
pub(super) struct Sums {
    size: usize,
    matrix: Vec<f64>,
    gradient: Vec<f64>,
}

impl Sums {
    /// Zeros for a space.
    pub(super) fn new<const D: usize>(space: &Space) -> Self {
        let size = (space.degree() + 1) * D;
        Sums {
            size,
            matrix: vec![0.0; space.functions() * size * (size + 1) / 2],
            gradient: vec![0.0; space.functions() * size],
        }
    }

    /// Adds the point with foot `u`, away from it by `e`.
    pub(super) fn add<const D: usize>(
        &mut self,
        space: &Space,
        u: f64,
        e: &Vector<D>,
        stiff: &Stiff,
    ) {
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

    /// Adds the sums to a model.
    pub(super) fn scatter<const D: usize>(&self, space: &Space, model: &mut Model) {
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
