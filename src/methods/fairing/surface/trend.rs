//! What the energy leaves free, fitted first and taken out.
//!
//! Springs that are soft against the energy leave little but the polynomials
//! that cost nothing, and these are then the small difference of large
//! numbers: of a table that is such a polynomial eight digits are lost, or all.
//! Fitted by themselves and taken out of the values they are exact, and what
//! the springs still have to say keeps its digits.

use super::net::Net;
use super::springs::{Normal, Springs, gather};
use crate::geometry::Knots;
use nalgebra::{DMatrix, DVector};

/// Rounding of one value against the values' size; its square is what a sum of
/// squares cannot tell from zero.
const ROUNDING: f64 = 1e-14;
/// Corrections that take the fit of the polynomials to rounding.
const CORRECTIONS: usize = 3;

/// Springs without their trend, their normal equations, and the trend's control
/// values.
#[derive(Debug, Clone)]
pub(in super::super) struct Detrended<const D: usize> {
    /// The springs to what is left of the values.
    pub(in super::super) left: Springs<D>,
    pub(in super::super) normal: Normal<D>,
    trend: Vec<[f64; D]>,
}

impl<const D: usize> Detrended<D> {
    /// Takes out the polynomials of the given monomials
    /// ([`super::energy::Energy::free_monomials`]); where the springs do not
    /// determine them nothing is taken out.
    pub(in super::super) fn new(net: &Net, springs: &Springs<D>, monomials: &[[usize; 2]]) -> Self {
        let basis = Polynomials::new(net, monomials);
        let mut left = springs.clone();
        let mut trend = vec![[0.0; D]; net.len()];
        if let Some(coefficients) = basis.take_out(&mut left) {
            let control = basis.control(net);
            for (slot, row) in trend.iter_mut().zip(control.row_iter()) {
                for (d, x) in slot.iter_mut().enumerate() {
                    *x = (row * coefficients.column(d))[0];
                }
            }
        }
        let mut normal = gather(net, &left);
        let squares = springs.value.iter().zip(&springs.weight);
        let whole: f64 = squares
            .map(|(q, w)| w * q.iter().map(|x| x * x).sum::<f64>())
            .sum();
        normal.rounding = normal.rounding.max(ROUNDING * ROUNDING * whole);
        Detrended {
            left,
            normal,
            trend,
        }
    }

    /// Puts the trend back.
    pub(in super::super) fn restore(&self, control: &mut [[f64; D]]) {
        for (c, t) in control.iter_mut().zip(&self.trend) {
            for (c, t) in c.iter_mut().zip(t) {
                *c += t;
            }
        }
    }
}

/// Monomials of both parameters, each scaled to [-1, 1].
struct Polynomials<'a> {
    powers: &'a [[usize; 2]],
    domain: [[f64; 2]; 2],
}

impl<'a> Polynomials<'a> {
    fn new(net: &Net, powers: &'a [[usize; 2]]) -> Self {
        let domain = net.domain();
        Polynomials { powers, domain }
    }

    fn row(&self, at: [f64; 2]) -> DVector<f64> {
        let t = [0, 1].map(|k| scaled(at[k], self.domain[k]));
        let values = self
            .powers
            .iter()
            .map(|[a, b]| power(t[0], *a) * power(t[1], *b));
        DVector::from_iterator(self.powers.len(), values)
    }

    /// Subtracts the fit by least squares; its coefficients, one column a
    /// field.
    fn take_out<const D: usize>(&self, springs: &mut Springs<D>) -> Option<DMatrix<f64>> {
        let m = self.powers.len();
        let mut square = DMatrix::zeros(m, m);
        for (at, w) in springs.at.iter().zip(&springs.weight) {
            let row = self.row(*at);
            square.ger(*w, &row, &row, 1.0);
        }
        let factor = square.cholesky()?;
        let mut coefficients = DMatrix::zeros(m, D);
        for _ in 0..CORRECTIONS {
            let mut rhs = DMatrix::<f64>::zeros(m, D);
            for ((at, w), q) in springs.at.iter().zip(&springs.weight).zip(&springs.value) {
                let row = self.row(*at);
                for (d, q) in q.iter().enumerate() {
                    rhs.column_mut(d).axpy(w * q, &row, 1.0);
                }
            }
            let step = factor.solve(&rhs);
            if step.iter().any(|x| !x.is_finite()) {
                return None;
            }
            for (at, q) in springs.at.iter().zip(&mut springs.value) {
                let row = self.row(*at);
                for (d, q) in q.iter_mut().enumerate() {
                    *q -= row.dot(&step.column(d));
                }
            }
            coefficients += step;
        }
        Some(coefficients)
    }

    /// Control values of each monomial, one column each, rows as
    /// [`Net::index`].
    fn control(&self, net: &Net) -> DMatrix<f64> {
        let [nu, nv] = net.counts();
        let mut control = DMatrix::zeros(net.len(), self.powers.len());
        for (k, powers) in self.powers.iter().enumerate() {
            let [u, v] = [0, 1].map(|d| blossoms(&net.knots[d], powers[d], self.domain[d]));
            for i in 0..nu {
                for j in 0..nv {
                    control[(net.index(i, j), k)] = u[i] * v[j];
                }
            }
        }
        control
    }
}

fn scaled(t: f64, [low, high]: [f64; 2]) -> f64 {
    (2.0 * t - low - high) / (high - low)
}

fn power(t: f64, n: usize) -> f64 {
    (0..n).fold(1.0, |p, _| p * t)
}

/// Control values of the scaled tⁿ: its blossom at the inner knots of each
/// basis function, eₙ(t₁ … t_p) / C(p, n) with the elementary symmetric
/// polynomial eₙ (Ramshaw 1989; Marsden's identity).
fn blossoms(knots: &Knots, n: usize, domain: [f64; 2]) -> Vec<f64> {
    let degree = knots.degree();
    let flat = knots.values();
    (0..knots.control_count())
        .map(|i| {
            // Symmetric polynomials of all orders, one knot after the other.
            let mut symmetric = vec![0.0; degree + 1];
            symmetric[0] = 1.0;
            for t in &flat[i + 1..=i + degree] {
                for k in (1..=degree).rev() {
                    symmetric[k] += scaled(*t, domain) * symmetric[k - 1];
                }
            }
            let choose = (0..n).fold(1.0, |c, k| c * (degree - k) as f64 / (k + 1) as f64);
            symmetric[n] / choose
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::methods::fairing::surface::energy::Energy;
    use crate::methods::fairing::surface::fit::evaluate;

    fn net() -> Net {
        let knots = |inner: &[f64], d| Knots::clamped(5, d, inner).expect("valid");
        Net::new([
            knots(&[0.1, 0.5, 0.55], [0.0, 2.0]),
            knots(&[-0.4], [-1.0, 3.0]),
        ])
    }

    fn springs(value: impl Fn(f64, f64) -> f64) -> Springs<1> {
        let at: Vec<[f64; 2]> = (0..60)
            .map(|i| {
                let wobble = |k: f64| (f64::from(i) * k).sin().mul_add(0.5, 0.5);
                [2.0 * wobble(1.7), 4.0 * wobble(2.9) - 1.0]
            })
            .collect();
        Springs {
            value: at.iter().map(|[u, v]| [value(*u, *v)]).collect(),
            weight: vec![1.0; at.len()],
            at,
        }
    }

    #[test]
    fn a_polynomial_is_nothing_but_trend() {
        let net = net();
        let exact = |u: f64, v: f64| 100.0 + 3.0 * u - u * v + 0.5 * v * v;
        let springs = springs(exact);
        let taken = Detrended::new(&net, &springs, &Energy::isotropic(3, 2.0).free_monomials(5));
        let largest = taken
            .normal
            .rhs
            .iter()
            .fold(0.0_f64, |m, x| m.max(x[0].abs()));
        assert!(largest < 1e-11, "{largest}");
        let mut control = vec![[0.0]; net.len()];
        taken.restore(&mut control);
        for (at, q) in springs.at.iter().zip(&springs.value) {
            let now = evaluate(&net, &control, *at);
            assert!((now[0] - q[0]).abs() < 1e-11, "{} {}", now[0], q[0]);
        }
    }

    /// An energy with first derivatives sees slopes: only the mean is free.
    #[test]
    fn what_costs_stays_in() {
        let net = net();
        let springs = springs(|u, _| 5.0 + u);
        let membrane = Energy::of_paper([1.0, 1.0, 0.0, 0.0, 0.0]);
        let taken = Detrended::new(&net, &springs, &membrane.free_monomials(5));
        let left = taken.normal.square;
        let mean = springs.value.iter().map(|q| q[0]).sum::<f64>() / 60.0;
        let spread: f64 = springs.value.iter().map(|q| (q[0] - mean).powi(2)).sum();
        assert!((left / spread - 1.0).abs() < 1e-9, "{left} {spread}");
    }
}
