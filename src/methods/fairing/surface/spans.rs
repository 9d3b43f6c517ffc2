//! The pieces of the basis functions as polynomials, span by span: tables in
//! place of recurrences where millions of points are looked up.
//!
//! In the span [a, a + h] function j is `Σₖ c_kj tᵏ`, t = (u − a)/h, with
//! `c_kj = hᵏ N_j⁽ᵏ⁾(a)/k!`: Taylor's formula, exact for a polynomial.

use super::net::MOST_ACTING;
use crate::geometry::{Knots, basis_jet};

/// Coefficients of one span, power by power.
#[derive(Debug, Clone, PartialEq)]
struct Span {
    start: f64,
    inverse: f64,
    first: usize,
    power: [[f64; MOST_ACTING]; MOST_ACTING],
}

/// All spans of a knot vector.
#[derive(Debug, Clone, PartialEq)]
pub(in super::super) struct Spans {
    spans: Vec<Span>,
    /// Inner borders, for lookup.
    borders: Vec<f64>,
    domain: [f64; 2],
    /// Spans per unit of the parameter where all are equal.
    uniform: Option<f64>,
    count: usize,
}

/// The functions that act at one parameter, with `R − 1` ≤ 2 derivatives.
#[derive(Debug, Clone, Copy)]
pub(in super::super) struct Acting<const R: usize> {
    /// Index of the first control value that acts.
    pub(in super::super) first: usize,
    /// How many act.
    pub(in super::super) count: usize,
    rows: [[f64; MOST_ACTING]; R],
}

impl<const R: usize> Acting<R> {
    /// Values of the acting functions.
    pub(in super::super) fn values(&self) -> &[f64] {
        &self.rows[0][..self.count]
    }

    /// Their derivatives of an order below `R`.
    pub(in super::super) fn derivative(&self, order: usize) -> &[f64] {
        &self.rows[order][..self.count]
    }
}

/// `k (k − 1) … (k − order + 1)`, by order and k.
const FALLING: [[f64; MOST_ACTING]; 3] = [
    [1.0; MOST_ACTING],
    [0.0, 1.0, 2.0, 3.0, 4.0, 5.0],
    [0.0, 0.0, 2.0, 6.0, 12.0, 20.0],
];

/// Spans whose lengths agree to this share are equal.
const EQUAL: f64 = 1e-9;

impl Spans {
    pub(in super::super) fn new(knots: &Knots) -> Self {
        let borders = knots.breakpoints();
        let count = knots.degree() + 1;
        let spans: Vec<Span> = borders
            .windows(2)
            .map(|w| span(knots, w[0], w[1]))
            .collect();
        let domain = knots.domain();
        let mean = (domain[1] - domain[0]) / spans.len() as f64;
        let equal = borders
            .windows(2)
            .all(|w| ((w[1] - w[0]) / mean - 1.0).abs() < EQUAL);
        Spans {
            borders: borders[1..borders.len() - 1].to_vec(),
            uniform: equal.then_some(1.0 / mean),
            spans,
            domain,
            count,
        }
    }

    /// The span of a parameter; outside the domain the nearest.
    #[inline]
    pub(in super::super) fn span(&self, u: f64) -> usize {
        match self.uniform {
            // A value below zero or no number becomes 0.
            Some(rate) => (((u - self.domain[0]) * rate) as usize).min(self.spans.len() - 1),
            None => self.borders.partition_point(|b| *b <= u),
        }
    }

    /// The span of a parameter (moved into the domain) and its place t in it.
    #[inline]
    pub(in super::super) fn local(&self, u: f64) -> (usize, f64) {
        let u = u.clamp(self.domain[0], self.domain[1]);
        let k = self.span(u);
        (k, (u - self.spans[k].start) * self.spans[k].inverse)
    }

    /// First control value that acts in a span, and the coefficients of the
    /// acting functions there, power by power.
    pub(in super::super) fn polynomials(
        &self,
        span: usize,
    ) -> (usize, &[[f64; MOST_ACTING]; MOST_ACTING]) {
        (self.spans[span].first, &self.spans[span].power)
    }

    /// Number of spans.
    pub(in super::super) fn len(&self) -> usize {
        self.spans.len()
    }

    /// The functions that act at `u`, moved into the domain.
    #[inline]
    pub(in super::super) fn acting<const R: usize>(&self, u: f64) -> Acting<R> {
        let u = u.clamp(self.domain[0], self.domain[1]);
        let span = &self.spans[self.span(u)];
        let t = (u - span.start) * span.inverse;
        let mut rows = [[0.0; MOST_ACTING]; R];
        let mut scale = 1.0;
        for (order, row) in rows.iter_mut().enumerate() {
            // Horner for the order-th derivative.
            for k in (order..self.count).rev() {
                let factor = FALLING[order][k];
                for (r, c) in row.iter_mut().zip(&span.power[k]) {
                    *r = *r * t + factor * c;
                }
            }
            for r in row.iter_mut() {
                *r *= scale;
            }
            scale *= span.inverse;
        }
        Acting {
            first: span.first,
            count: self.count,
            rows,
        }
    }
}

fn span(knots: &Knots, start: f64, end: f64) -> Span {
    let jet = basis_jet::<MOST_ACTING>(knots, start);
    let mut power = [[0.0; MOST_ACTING]; MOST_ACTING];
    let mut factor = 1.0;
    for (k, row) in power.iter_mut().enumerate().take(knots.degree() + 1) {
        if k > 0 {
            factor *= (end - start) / k as f64;
        }
        for (c, d) in row.iter_mut().zip(jet.derivative(k)) {
            *c = factor * d;
        }
    }
    Span {
        start,
        inverse: 1.0 / (end - start),
        first: jet.first,
        power,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_agree_with_the_recurrence() {
        for degree in 3..=5 {
            let uneven = Knots::clamped(degree, [-1.0, 2.0], &[-0.9, 0.1, 0.1, 1.3]);
            let even = Knots::uniform(degree, [-1.0, 2.0], 7);
            for knots in [uneven, even].into_iter().flatten() {
                let spans = Spans::new(&knots);
                for i in 0..=60 {
                    let u = -1.1 + 0.0533 * f64::from(i);
                    let (a, b) = (spans.acting::<3>(u), basis_jet::<3>(&knots, u));
                    assert_eq!(a.first, b.first, "degree {degree} u {u}");
                    for order in 0..3 {
                        for (x, y) in a.derivative(order).iter().zip(b.derivative(order)) {
                            let size = 10f64.powi(2 * order as i32);
                            assert!((x - y).abs() < 1e-11 * size, "{x} {y}");
                        }
                    }
                }
            }
        }
    }
}
