//! Splines as polynomials, span by span: for evaluation at very many
//! parameters.
//!
//! In each span every function of the basis is kept by its Taylor coefficients
//! about the middle, in the variable t = (u − middle)/(half the width) ∈
//! [−1, 1], where they are of the size of Bernstein's and nothing cancels. A
//! value then costs a Horner scheme in place of de Boor's triangle with its
//! divisions; the span is found by a table of even cells.

use super::basis::{BasisJet, basis_jet_in_span};
use super::knots::{Knots, MAX_DEGREE};
use nalgebra::SVector;

/// Functions, or derivatives, that one polynomial piece can have.
const MOST: usize = MAX_DEGREE + 1;
/// Cells of the table a span.
const CELLS_PER_SPAN: usize = 4;

/// The basis of a spline space as polynomials.
#[derive(Debug, Clone, PartialEq)]
pub struct BasisTable {
    degree: usize,
    breaks: Vec<f64>,
    /// Index of the first function that acts in each span.
    first: Vec<usize>,
    /// The span in which each of the even cells of the domain begins.
    cells: Vec<usize>,
    cells_per_length: f64,
    /// `[k]` of a span: the coefficients of tᵏ of all its functions.
    coefficients: Vec<[f64; MOST]>,
}

/// A place in a table: span, t, and dt/du.
#[derive(Clone, Copy)]
struct Place {
    span: usize,
    t: f64,
    rate: f64,
}

impl BasisTable {
    /// The table of a knot vector.
    #[must_use]
    pub fn new(knots: &Knots) -> Self {
        let p = knots.degree();
        let breaks = knots.breakpoints();
        let mut first = Vec::with_capacity(breaks.len());
        let mut coefficients = Vec::with_capacity((p + 1) * breaks.len());
        for w in breaks.windows(2) {
            let half = 0.5 * (w[1] - w[0]);
            let span = knots.span(w[0]);
            let jet = basis_jet_in_span::<MOST>(knots, span, w[0] + half);
            first.push(jet.first);
            let mut scale = 1.0;
            for k in 0..=p {
                let mut row = [0.0; MOST];
                for (slot, d) in row.iter_mut().zip(jet.derivative(k)) {
                    *slot = d * scale;
                }
                coefficients.push(row);
                scale *= half / (k + 1) as f64;
            }
        }
        let count = CELLS_PER_SPAN * first.len();
        let [a, b] = knots.domain();
        let mut cells = Vec::with_capacity(count);
        let mut span = 0;
        for cell in 0..count {
            let u = a + (b - a) * cell as f64 / count as f64;
            while span + 1 < first.len() && breaks[span + 1] <= u {
                span += 1;
            }
            cells.push(span);
        }
        BasisTable {
            degree: p,
            breaks,
            first,
            cells,
            cells_per_length: count as f64 / (b - a),
            coefficients,
        }
    }

    /// Right-sided at inner knots; outside the domain its nearer end.
    #[inline]
    fn place(&self, u: f64) -> Place {
        let last = self.first.len() - 1;
        let u = u.clamp(self.breaks[0], self.breaks[last + 1]);
        let cell = ((u - self.breaks[0]) * self.cells_per_length) as usize;
        let cell = cell.min(self.cells.len() - 1);
        // Rounding may name the cell beside the right one.
        let low = self.cells[cell.saturating_sub(1)];
        let high = self.cells.get(cell + 2).copied().unwrap_or(last);
        let span = if high - low <= 2 * CELLS_PER_SPAN {
            let mut span = low;
            while span < last && self.breaks[span + 1] <= u {
                span += 1;
            }
            span
        } else {
            let inside = &self.breaks[low + 1..=high];
            low + inside.partition_point(|t| *t <= u)
        };
        let (from, to) = (self.breaks[span], self.breaks[span + 1]);
        let rate = 2.0 / (to - from);
        Place {
            span,
            t: (u - from) * rate - 1.0,
            rate,
        }
    }

    /// Functions and `ROWS − 1` derivatives at a parameter: [`super::basis_jet`]
    /// but for rounding.
    #[must_use]
    #[inline]
    pub fn jet<const ROWS: usize>(&self, u: f64) -> BasisJet<ROWS> {
        let at = self.place(u);
        let n = self.degree + 1;
        let coefficients = &self.coefficients[at.span * n..][..n];
        let mut rows = [[0.0; MOST]; ROWS];
        for c in coefficients.iter().rev() {
            for r in (1..ROWS).rev() {
                let lower = rows[r - 1];
                raise(&mut rows[r], at.t, &lower);
            }
            raise(&mut rows[0], at.t, c);
        }
        let mut scale = 1.0;
        for (r, row) in rows.iter_mut().enumerate().skip(1) {
            scale *= at.rate * r as f64;
            row.iter_mut().for_each(|v| *v *= scale);
        }
        BasisJet::of_rows(self.first[at.span], n, rows)
    }

    /// The spline with the coefficients `of(function)`.
    #[must_use]
    pub fn pieces<const D: usize>(&self, of: impl Fn(usize) -> SVector<f64, D>) -> Pieces<'_, D> {
        let n = self.degree + 1;
        let mut coefficients = Vec::with_capacity(self.coefficients.len());
        for (first, block) in self.first.iter().zip(self.coefficients.chunks_exact(n)) {
            let mut own = [SVector::zeros(); MOST];
            for (j, slot) in own[..n].iter_mut().enumerate() {
                *slot = of(first + j);
            }
            for c in block {
                let terms = own[..n].iter().zip(c);
                coefficients.push(terms.map(|(x, c)| x * *c).sum());
            }
        }
        Pieces {
            table: self,
            coefficients,
        }
    }
}

/// One step of Horner's scheme for all functions.
#[inline]
fn raise(row: &mut [f64; MOST], t: f64, next: &[f64; MOST]) {
    for (value, next) in row.iter_mut().zip(next) {
        *value = *value * t + next;
    }
}

/// A spline as polynomials.
#[derive(Debug, Clone)]
pub struct Pieces<'a, const D: usize> {
    table: &'a BasisTable,
    coefficients: Vec<SVector<f64, D>>,
}

impl<const D: usize> Pieces<'_, D> {
    /// The spline and its `ROWS − 1` derivatives at a parameter, right-sided
    /// at inner knots.
    #[must_use]
    #[inline]
    pub fn jet<const ROWS: usize>(&self, u: f64) -> [SVector<f64, D>; ROWS] {
        let at = self.table.place(u);
        let n = self.table.degree + 1;
        let mut rows = [SVector::<f64, D>::zeros(); ROWS];
        for c in self.coefficients[at.span * n..][..n].iter().rev() {
            for r in (1..ROWS).rev() {
                rows[r] = rows[r] * at.t + rows[r - 1];
            }
            rows[0] = rows[0] * at.t + c;
        }
        let mut scale = 1.0;
        for (r, row) in rows.iter_mut().enumerate().skip(1) {
            scale *= at.rate * r as f64;
            *row *= scale;
        }
        rows
    }

    /// The point at a parameter.
    #[must_use]
    #[inline]
    pub fn point(&self, u: f64) -> SVector<f64, D> {
        self.jet::<1>(u)[0]
    }
}

#[cfg(test)]
mod tests {
    use super::super::{BSplineCurve, basis_jet};
    use super::*;
    use nalgebra::Point3;

    /// Even, crowded and repeated knots, at knots, ends and between.
    #[test]
    fn tables_agree_with_the_recurrence() {
        let crowded: Vec<f64> = (1..60).map(|k| 1e-4 * k as f64).collect();
        for (degree, inner) in [
            (3, vec![0.0, 0.5, 0.5, 0.6]),
            (5, crowded),
            (5, vec![0.3; 5]),
            (7, vec![]),
        ] {
            let knots = Knots::clamped(degree, [-1.0, 2.0], &inner).expect("knots");
            let table = BasisTable::new(&knots);
            let parameters = (0..=300).map(|k| -1.0 + 0.01 * k as f64);
            for u in parameters.chain(inner.iter().copied()) {
                let (got, want) = (table.jet::<4>(u), basis_jet::<4>(&knots, u));
                assert_eq!(got.first, want.first, "degree {degree} u {u}");
                let spans = knots.breakpoints();
                let k = spans.partition_point(|t| *t <= u).clamp(1, spans.len() - 1);
                for order in 0..4 {
                    // Rounding of values of size 1 over the span.
                    let rate = 2.0 / (spans[k] - spans[k - 1]);
                    let size = want
                        .derivative(order)
                        .iter()
                        .fold(1.0_f64, |m, v| m.max(v.abs()));
                    let most = 2e-13 * size + 2e-15 * (4.0 * rate).powi(order as i32);
                    for (g, w) in got.derivative(order).iter().zip(want.derivative(order)) {
                        assert!((g - w).abs() <= most, "degree {degree} u {u}: {g} {w}");
                    }
                }
            }
        }
    }

    #[test]
    fn pieces_are_the_curve() {
        let knots = Knots::uniform(5, [0.0, 3.0], 7).expect("knots");
        let points: Vec<Point3<f64>> = (0..knots.control_count())
            .map(|k| Point3::new(k as f64, (k * k % 5) as f64, (k % 3) as f64))
            .collect();
        let table = BasisTable::new(&knots);
        let pieces = table.pieces(|k| points[k].coords);
        let curve = BSplineCurve::from_knots(knots.clone(), points.clone(), None).expect("curve");
        for k in 0..=60 {
            let u = 0.05 * k as f64;
            let (got, want) = (pieces.jet::<4>(u), curve.derivatives(u));
            assert!((got[0] - want.point.coords).norm() < 1e-12);
            assert!((got[1] - want.d1).norm() < 1e-11);
            assert!((got[2] - want.d2).norm() < 1e-10);
            if k < 60 {
                assert!((got[3] - curve.derivative3(u)).norm() < 1e-9);
            }
            assert_eq!(pieces.point(u), got[0]);
        }
    }
}
