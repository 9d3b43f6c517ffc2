//! Energies `Σ w ∬ |∂ᵃ⁺ᵇr/∂uᵃ∂vᵇ|² du dv` as quadratic forms of the control
//! points: sums of Kronecker products of one-dimensional Gram matrices, each
//! integrated exactly by Gauss quadrature.
//!
//! The paper's five terms (Jing, Xi & Tang 1998, eq. 2) are one member of the
//! family; the isotropic energies of order m,
//! `Σₖ C(m, k) |∂ᵐr/∂uᵏ∂vᵐ⁻ᵏ|²` (Duchon; thin plate for m = 2), the others.
//! Of order 3 and 4 they weigh how the curvature changes, not how large it
//! is: a circular cylinder is then fair, as the paper wanted with its γ.

use super::net::Net;
use crate::geometry::gram;
use crate::numerics::EnvelopeMatrix;

/// One term: weight and the orders of derivation in u and v.
pub(in super::super) type Term = (f64, [usize; 2]);

/// A weighted sum of squared derivatives.
#[derive(Debug, Clone, PartialEq)]
pub(in super::super) struct Energy {
    terms: Vec<Term>,
}

impl Energy {
    /// The paper's: α₁₁, α₂₂, β₁₁, β₁₂, β₂₂ in this order.
    pub(in super::super) fn of_paper([a11, a22, b11, b12, b22]: [f64; 5]) -> Self {
        let all = [
            (a11, [1, 0]),
            (a22, [0, 1]),
            (b11, [2, 0]),
            (b12, [1, 1]),
            (b22, [0, 2]),
        ];
        Energy {
            terms: all.into_iter().filter(|(w, _)| *w > 0.0).collect(),
        }
    }

    /// The isotropic energy of the given order over a plane in which v is
    /// stretched by `stretch`: sheets that are longer than wide vary faster
    /// across than along.
    pub(in super::super) fn isotropic(order: usize, stretch: f64) -> Self {
        let mut binomial = 1.0;
        let mut terms = Vec::new();
        for k in 0..=order {
            let weight = binomial * stretch.powi(-2 * k as i32);
            terms.push((weight, [order - k, k]));
            binomial *= (order - k) as f64 / (k + 1) as f64;
        }
        Energy { terms }
    }

    /// `∬ r²`: the mass of a field.
    pub(in super::super) fn mass() -> Self {
        Energy {
            terms: vec![(1.0, [0, 0])],
        }
    }

    /// Dimension of the polynomials that cost nothing: monomials uᵃvᵇ that
    /// every term derives away.
    /// Across each knuckle line at u₀ of a net those with a ≥ 1 may change:
    /// (u − u₀)₊ᵃ vᵇ costs nothing either.
    pub(in super::super) fn free_dimension(&self, net: &Net) -> usize {
        let [in_u, in_v] = net.knuckles();
        let changes = |power: usize, lines: usize| if power > 0 { 1 + lines } else { 1 };
        self.free_monomials(net.degree())
            .iter()
            .map(|[a, b]| changes(*a, in_u) * changes(*b, in_v))
            .sum()
    }

    /// Powers (a, b) of the monomials uᵃvᵇ up to a degree in each that cost
    /// nothing.
    pub(in super::super) fn free_monomials(&self, degree: usize) -> Vec<[usize; 2]> {
        let free = |[a, b]: [usize; 2]| self.terms.iter().all(|(_, [k, l])| a < *k || b < *l);
        (0..=degree)
            .flat_map(|a| (0..=degree).map(move |b| [a, b]))
            .filter(|powers| free(*powers))
            .collect()
    }

    /// The matrix P with energy `cᵀ P c` of a scalar field on the net.
    pub(in super::super) fn matrix(&self, net: &Net) -> EnvelopeMatrix {
        let mut matrix = EnvelopeMatrix::banded(net.len(), net.half_bandwidth());
        for (weight, [k, l]) in &self.terms {
            let grams = [gram(&net.knots[0], *k), gram(&net.knots[1], *l)];
            add_product(net, *weight, &grams, &mut matrix);
        }
        matrix
    }
}

/// Adds `weight · Gᵤ ⊗ Gᵥ`.
fn add_product(net: &Net, weight: f64, [gu, gv]: &[EnvelopeMatrix; 2], sum: &mut EnvelopeMatrix) {
    let [nu, nv] = net.counts();
    let reach = net.degree();
    for i in 0..nu {
        for i2 in i.saturating_sub(reach)..(i + reach + 1).min(nu) {
            let share = weight * gu.get(i, i2);
            for j in 0..nv {
                for j2 in j.saturating_sub(reach)..(j + reach + 1).min(nv) {
                    let (row, column) = (net.index(i, j), net.index(i2, j2));
                    if row >= column {
                        sum.add(row, column, share * gv.get(j, j2));
                    }
                }
            }
        }
    }
}
