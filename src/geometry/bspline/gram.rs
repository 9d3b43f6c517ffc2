//! Inner products of B-spline derivatives: the one-dimensional factors of the
//! energies of curves and tensor-product surfaces.

use super::basis::basis_jet;
use super::knots::Knots;
use crate::numerics::{EnvelopeMatrix, GaussLegendre};

/// Highest derivative for which [`gram`] has rows; an energy of a higher one
/// is meaningless for the degrees in use.
const ROWS: usize = 5;

/// `G_ij = ∫ N_i⁽ᵏ⁾ N_j⁽ᵏ⁾ dt` over the whole domain for the k-th derivatives
/// (k ≤ 4), a band of half width `degree`. Gauss–Legendre with `degree + 1`
/// nodes a span integrates the products exactly. Unit: 1/length^(2k − 1) of
/// the parameter. Zero for k above the degree (or above 4).
#[must_use]
pub fn gram(knots: &Knots, derivative: usize) -> EnvelopeMatrix {
    let degree = knots.degree();
    let mut matrix = EnvelopeMatrix::banded(knots.control_count(), degree);
    if derivative > degree || derivative >= ROWS {
        return matrix;
    }
    let rule = GaussLegendre::new(degree + 1);
    for span in knots.breakpoints().windows(2) {
        for (t, weight) in rule.on(span[0], span[1]) {
            let jet = basis_jet::<ROWS>(knots, t);
            matrix.add_outer(jet.first, jet.derivative(derivative), weight);
        }
    }
    matrix
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The energy of a polynomial is known: f = t³ on [0, 2] has
    /// ∫ f² = 2⁷/7, ∫ f′² = 9·2⁵/5, ∫ f″² = 36·2³/3, ∫ f‴² = 36·2, ∫ f⁗² = 0.
    #[test]
    fn energies_of_a_cube() {
        let knots = Knots::clamped(5, [0.0, 2.0], &[0.3, 1.0, 1.0, 1.7]).expect("valid");
        // Blossom of t³ at the inner knots: the control points.
        let t = knots.values();
        let n = knots.control_count();
        let control: Vec<f64> = (0..n)
            .map(|i| {
                let k = &t[i + 1..i + 6];
                let mut sum = 0.0;
                for a in 0..5 {
                    for b in a + 1..5 {
                        for c in b + 1..5 {
                            sum += k[a] * k[b] * k[c];
                        }
                    }
                }
                sum / 10.0
            })
            .collect();
        let want = [128.0 / 7.0, 9.0 * 32.0 / 5.0, 96.0, 72.0, 0.0];
        for (k, want) in want.into_iter().enumerate() {
            let image = gram(&knots, k).multiply(&control);
            let energy: f64 = image.iter().zip(&control).map(|(a, b)| a * b).sum();
            // The energy is a difference of terms as large as the entries.
            let rounding = 1e-13 * gram(&knots, k).diagonal().sum::<f64>();
            let miss = (energy - want).abs();
            assert!(miss < 1e-9 + rounding, "k {k}: {energy} for {want}");
        }
    }

    #[test]
    fn beyond_the_degree_is_nothing() {
        let knots = Knots::uniform(2, [0.0, 1.0], 4).expect("valid");
        assert!(gram(&knots, 3).diagonal().all(|d| d == 0.0));
    }
}
