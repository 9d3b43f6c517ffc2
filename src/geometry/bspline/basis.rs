//! Basis functions and their derivatives on the stack: rows for least squares
//! and interpolation systems.
//!
//! The values of degree `p − k` (Cox–de Boor recurrence, Piegl & Tiller A2.2)
//! are raised `k` times by `N′_{i,q} = q (N_{i,q−1}/(t_{i+q} − t_i) −
//! N_{i+1,q−1}/(t_{i+q+1} − t_{i+1}))` (their eq. 2.7) for the k-th
//! derivative: the content of A2.3 without its coefficient table.

use super::knots::{Knots, MAX_DEGREE};

/// The `degree + 1` basis functions that act at one parameter, with
/// derivatives: `ROWS` = 1 for values, 2 with first, 3 with second derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BasisJet<const ROWS: usize> {
    /// Index of the first control point that acts.
    pub first: usize,
    /// Number of control points that act: `degree + 1`.
    pub count: usize,
    rows: [[f64; MAX_DEGREE + 1]; ROWS],
}

impl<const ROWS: usize> BasisJet<ROWS> {
    /// From rows found otherwise than by the recurrence.
    pub(super) fn of_rows(first: usize, count: usize, rows: [[f64; MAX_DEGREE + 1]; ROWS]) -> Self {
        BasisJet { first, count, rows }
    }

    /// The `order`-th derivatives of the acting functions (0: their values).
    ///
    /// # Panics
    /// If `order ≥ ROWS`.
    #[must_use]
    pub fn derivative(&self, order: usize) -> &[f64] {
        &self.rows[order][..self.count]
    }

    /// The values of the acting functions; they sum to 1.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        self.derivative(0)
    }
}

/// Basis functions at `u`, right-sided at inner knots. `u` is moved into the
/// domain if it lies outside.
#[must_use]
pub fn basis_jet<const ROWS: usize>(knots: &Knots, u: f64) -> BasisJet<ROWS> {
    let [a, b] = knots.domain();
    let u = u.clamp(a, b);
    basis_jet_in_span(knots, knots.span(u), u)
}

/// As [`basis_jet`] in a span of the caller's choice (see [`Knots::span`] and
/// [`Knots::span_left`]).
#[must_use]
pub(super) fn basis_jet_in_span<const ROWS: usize>(
    knots: &Knots,
    span: usize,
    u: f64,
) -> BasisJet<ROWS> {
    let p = knots.degree();
    // t[p−1]..t[p] is the span.
    let t = &knots.values()[span + 1 - p..=span + p];
    let mut rows = [[0.0; MAX_DEGREE + 1]; ROWS];
    for (order, row) in rows.iter_mut().enumerate().take(p + 1) {
        row[0] = 1.0;
        for q in 1..=p - order {
            raise_value(q, p, t, u, row);
        }
        for q in p - order + 1..=p {
            raise_derivative(q, p, t, row);
        }
    }
    BasisJet {
        first: span - p,
        count: p + 1,
        rows,
    }
}

/// From the `q` values of degree `q − 1` to the `q + 1` of degree `q`.
#[inline]
fn raise_value(q: usize, p: usize, t: &[f64], u: f64, row: &mut [f64; MAX_DEGREE + 1]) {
    let mut carried = 0.0;
    for j in 0..q {
        let (low, high) = (t[p - q + j], t[p + j]);
        let share = row[j] / (high - low);
        row[j] = carried + (high - u) * share;
        carried = (u - low) * share;
    }
    row[q] = carried;
}

/// From `q` functions of degree `q − 1` to the derivatives of the `q + 1`
/// functions of degree `q` that they make.
#[inline]
fn raise_derivative(q: usize, p: usize, t: &[f64], row: &mut [f64; MAX_DEGREE + 1]) {
    let mut carried = 0.0;
    for j in 0..q {
        let share = q as f64 * row[j] / (t[p + j] - t[p - q + j]);
        row[j] = carried - share;
        carried = share;
    }
    row[q] = carried;
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Piegl & Tiller, examples 2.3 and 2.4: degree 2, u = 5/2.
    #[test]
    fn values_and_derivatives_of_the_nurbs_book() {
        let knots = Knots::new(2, vec![0., 0., 0., 1., 2., 3., 4., 4., 5., 5., 5.]).expect("valid");
        let b = basis_jet::<3>(&knots, 2.5);
        assert_eq!(b.first, 2);
        assert_eq!(b.values(), [1.0 / 8.0, 6.0 / 8.0, 1.0 / 8.0]);
        assert_eq!(b.derivative(1), [-0.5, 0.0, 0.5]);
        assert_eq!(b.derivative(2), [1.0, -2.0, 1.0]);
    }

    #[test]
    fn partition_of_unity_and_difference_quotients() {
        for degree in 1..=MAX_DEGREE {
            let knots = Knots::clamped(degree, [-1., 2.], &[0.0, 0.1, 1.3]).expect("valid");
            for i in 0..=40 {
                let u = -0.97 + 0.0713 * i as f64;
                let b = basis_jet::<3>(&knots, u);
                for (order, want) in [1.0, 0.0, 0.0].into_iter().enumerate() {
                    let row = b.derivative(order);
                    let size: f64 = row.iter().map(|v| v.abs()).sum();
                    let sum: f64 = row.iter().sum();
                    assert!((sum - want).abs() <= 1e-14 * size.max(1.0));
                }
                let h = 1e-5;
                let (lo, hi) = (basis_jet::<2>(&knots, u - h), basis_jet::<2>(&knots, u + h));
                if lo.first == hi.first {
                    for j in 0..=degree {
                        let d1 = (hi.values()[j] - lo.values()[j]) / (2.0 * h);
                        assert!(
                            (d1 - b.derivative(1)[j]).abs() < 1e-5,
                            "degree {degree} u {u}"
                        );
                        let d2 = (hi.derivative(1)[j] - lo.derivative(1)[j]) / (2.0 * h);
                        assert!((d2 - b.derivative(2)[j]).abs() < 1e-3 * d2.abs().max(1.0));
                    }
                }
            }
        }
    }

    #[test]
    fn rows_beyond_the_degree_are_zero() {
        let knots = Knots::clamped(1, [0., 1.], &[]).expect("valid");
        assert_eq!(basis_jet::<3>(&knots, 0.25).derivative(2), [0.0, 0.0]);
    }
}
