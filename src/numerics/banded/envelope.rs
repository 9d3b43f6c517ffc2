//! Envelope (skyline) Cholesky for symmetric positive definite matrices.
//!
//! Row `i` of the lower triangle is kept from its first nonzero column to the
//! diagonal, zeros in between included. Cholesky fills exactly that envelope
//! and nothing outside it (George & Liu, *Computer Solution of Large Sparse
//! Positive Definite Systems*, 1981, §4.2), so band, arrow and variable-band
//! matrices all cost what their envelope costs: about `Σ wᵢ²/2` multiply-adds
//! for row widths `wᵢ`. The row-oriented ("bordering") form makes every inner
//! loop a dot product of two contiguous slices.
//!
//! Limits: no pivoting and no reordering; an indefinite or numerically
//! singular matrix is refused with the row where it shows.

use thiserror::Error;

/// A pivot of the factorisation was not positive: the matrix is not (or
/// numerically not) positive definite.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[error("the matrix is not positive definite: pivot {pivot:e} in row {row}")]
pub struct NotPositiveDefinite {
    /// The row whose pivot failed.
    pub row: usize,
    /// What was left on the diagonal there (before the square root).
    pub pivot: f64,
}

/// A symmetric matrix stored by the envelope of its lower triangle.
#[derive(Debug, Clone, PartialEq)]
pub struct EnvelopeMatrix {
    shape: Envelope,
    values: Vec<f64>,
}

/// Where the rows of an envelope lie: row `i` holds columns `first[i]..=i` at
/// `start[i]..start[i + 1]`.
#[derive(Debug, Clone, PartialEq)]
struct Envelope {
    first: Vec<usize>,
    start: Vec<usize>,
}

impl Envelope {
    fn row<'a>(&self, values: &'a [f64], i: usize) -> &'a [f64] {
        &values[self.start[i]..self.start[i + 1]]
    }

    fn index(&self, i: usize, j: usize) -> usize {
        let (i, j) = if i >= j { (i, j) } else { (j, i) };
        assert!(
            j >= self.first[i],
            "entry ({i}, {j}) lies left of the envelope"
        );
        self.start[i] + (j - self.first[i])
    }
}

impl EnvelopeMatrix {
    /// A zero matrix of order `first.len()`; row `i` may hold nonzeros in the
    /// columns `first[i]..=i`. A value above `i` counts as `i` (diagonal only).
    #[must_use]
    pub fn new(first_nonzero_column_of_each_row: Vec<usize>) -> Self {
        let mut first = first_nonzero_column_of_each_row;
        let mut start = Vec::with_capacity(first.len() + 1);
        start.push(0);
        let mut end = 0;
        for (i, f) in first.iter_mut().enumerate() {
            *f = (*f).min(i);
            end += i - *f + 1;
            start.push(end);
        }
        EnvelopeMatrix {
            shape: Envelope { first, start },
            values: vec![0.0; end],
        }
    }

    /// A zero band matrix of order `n` with `half_bandwidth` diagonals below
    /// the main one.
    #[must_use]
    pub fn banded(n: usize, half_bandwidth: usize) -> Self {
        Self::new((0..n).map(|i| i.saturating_sub(half_bandwidth)).collect())
    }

    /// Order of the matrix.
    #[must_use]
    pub fn order(&self) -> usize {
        self.shape.first.len()
    }

    /// Number of stored entries.
    #[must_use]
    pub fn stored(&self) -> usize {
        self.values.len()
    }

    /// First stored column of row `i`.
    #[must_use]
    pub fn first_column(&self, i: usize) -> usize {
        self.shape.first[i]
    }

    /// Row `i` of the lower triangle: its first stored column and its values
    /// from there to the diagonal.
    #[must_use]
    pub fn row(&self, i: usize) -> (usize, &[f64]) {
        (self.shape.first[i], self.shape.row(&self.values, i))
    }

    /// Sets every entry to zero and keeps the envelope.
    pub fn clear(&mut self) {
        self.values.fill(0.0);
    }

    /// Adds `value` to the entries (i, j) and (j, i), which are one.
    ///
    /// # Panics
    /// If the entry lies outside the envelope: the pattern handed to
    /// [`EnvelopeMatrix::new`] was wrong, a mistake of the programme.
    pub fn add(&mut self, i: usize, j: usize, value: f64) {
        let k = self.shape.index(i, j);
        self.values[k] += value;
    }

    /// Adds `scale · rowᵀ·row` for a dense row of values that begins at column
    /// `first`: one residual's share of the normal equations.
    ///
    /// # Panics
    /// As [`EnvelopeMatrix::add`].
    pub fn add_outer(&mut self, first: usize, row: &[f64], scale: f64) {
        for (a, &ra) in row.iter().enumerate() {
            let begin = self.shape.index(first + a, first);
            let factor = scale * ra;
            for (slot, &rb) in self.values[begin..=begin + a].iter_mut().zip(row) {
                *slot += factor * rb;
            }
        }
    }

    /// The entry (i, j); zero outside the envelope.
    #[must_use]
    pub fn get(&self, i: usize, j: usize) -> f64 {
        let (i, j) = if i >= j { (i, j) } else { (j, i) };
        if j < self.shape.first[i] {
            0.0
        } else {
            self.values[self.shape.index(i, j)]
        }
    }

    /// The diagonal, from the first row to the last.
    pub fn diagonal(&self) -> impl Iterator<Item = f64> + '_ {
        self.shape.start[1..]
            .iter()
            .map(|&end| self.values[end - 1])
    }

    /// Adds `value` to the diagonal entry of row `i`.
    pub fn add_to_diagonal(&mut self, i: usize, value: f64) {
        self.values[self.shape.start[i + 1] - 1] += value;
    }

    /// Adds `scale` times a matrix with the same envelope.
    ///
    /// # Panics
    /// If the envelopes differ, a mistake of the programme.
    pub fn add_scaled(&mut self, other: &EnvelopeMatrix, scale: f64) {
        assert_eq!(self.shape, other.shape, "matrices of different envelopes");
        axpy(scale, &other.values, &mut self.values);
    }

    /// Replaces every stored entry (i, j), j ≤ i, by `change(i, j, entry)`.
    pub fn scale_entries(&mut self, change: impl Fn(usize, usize, f64) -> f64) {
        for i in 0..self.order() {
            let (first, start) = (self.shape.first[i], self.shape.start[i]);
            for j in first..=i {
                let slot = &mut self.values[start + j - first];
                *slot = change(i, j, *slot);
            }
        }
    }

    /// `y = A x`.
    #[must_use]
    pub fn multiply(&self, x: &[f64]) -> Vec<f64> {
        let mut y = vec![0.0; self.order()];
        for i in 0..self.order() {
            let row = self.shape.row(&self.values, i);
            let below = &row[..row.len() - 1];
            let f = self.shape.first[i];
            y[i] += dot(row, &x[f..=i]);
            axpy(x[i], below, &mut y[f..i]);
        }
        y
    }

    /// The Cholesky factor, in new memory.
    ///
    /// # Errors
    /// [`NotPositiveDefinite`] with the row whose pivot was not positive.
    pub fn factor(&self) -> Result<EnvelopeFactor, NotPositiveDefinite> {
        let mut factor = EnvelopeFactor {
            shape: self.shape.clone(),
            values: self.values.clone(),
        };
        factor.decompose()?;
        Ok(factor)
    }

    /// As [`EnvelopeMatrix::factor`], into the memory of an earlier factor of
    /// a matrix with the same envelope (any other is simply replaced).
    ///
    /// # Errors
    /// As [`EnvelopeMatrix::factor`]; the factor is then of no use.
    pub fn factor_into(&self, factor: &mut EnvelopeFactor) -> Result<(), NotPositiveDefinite> {
        if factor.shape != self.shape {
            factor.shape = self.shape.clone();
        }
        factor.values.clone_from(&self.values);
        factor.decompose()
    }
}

/// The lower Cholesky factor `L` with `A = L Lᵀ`, in the envelope of `A`.
#[derive(Debug, Clone, PartialEq)]
pub struct EnvelopeFactor {
    shape: Envelope,
    values: Vec<f64>,
}

impl EnvelopeFactor {
    /// Overwrites the stored lower triangle of A with L, row by row.
    fn decompose(&mut self) -> Result<(), NotPositiveDefinite> {
        for i in 0..self.shape.first.len() {
            let (done, rest) = self.values.split_at_mut(self.shape.start[i]);
            let fi = self.shape.first[i];
            let row = &mut rest[..=i - fi];
            for j in fi..i {
                let fj = self.shape.first[j];
                let other = self.shape.row(done, j);
                let from = fi.max(fj);
                let sum = dot(&row[from - fi..j - fi], &other[from - fj..j - fj]);
                row[j - fi] = (row[j - fi] - sum) / other[j - fj];
            }
            let (below, diagonal) = row.split_at_mut(i - fi);
            let pivot = diagonal[0] - dot(below, below);
            // `!(…)` so that NaN is refused too.
            if !(pivot > 0.0 && pivot.is_finite()) {
                return Err(NotPositiveDefinite { row: i, pivot });
            }
            diagonal[0] = pivot.sqrt();
        }
        Ok(())
    }

    /// Replaces the right-hand side `b` by the solution of `A x = b`.
    ///
    /// # Panics
    /// If `b` is shorter than the matrix.
    pub fn solve_in_place(&self, b: &mut [f64]) {
        let n = self.shape.first.len();
        for i in 0..n {
            let row = self.shape.row(&self.values, i);
            let f = self.shape.first[i];
            let width = i - f;
            b[i] = (b[i] - dot(&row[..width], &b[f..i])) / row[width];
        }
        for i in (0..n).rev() {
            let row = self.shape.row(&self.values, i);
            let f = self.shape.first[i];
            let width = i - f;
            b[i] /= row[width];
            axpy(-b[i], &row[..width], &mut b[f..i]);
        }
    }

    /// The squares of the diagonal of `L`: the pivots of the elimination.
    pub fn pivots(&self) -> impl Iterator<Item = f64> + '_ {
        self.shape.start[1..]
            .iter()
            .map(|&end| self.values[end - 1] * self.values[end - 1])
    }
}

/// Independent running sums of [`dot`]: enough to fill two 256-bit registers,
/// and a fixed order of summation, so that results never depend on the caller.
const LANES: usize = 8;

/// Dot product over the shorter length, in [`LANES`] partial sums.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let n = a.len().min(b.len());
    let (a, b) = (&a[..n], &b[..n]);
    let mut lanes = [0.0; LANES];
    let (mut ca, mut cb) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    for (x, y) in ca.by_ref().zip(cb.by_ref()) {
        for l in 0..LANES {
            lanes[l] += x[l] * y[l];
        }
    }
    let mut tail = 0.0;
    for (x, y) in ca.remainder().iter().zip(cb.remainder()) {
        tail += x * y;
    }
    // As a tree: a chain of eight additions would take longer than the rest.
    let [a, b, c, d, e, f, g, h] = lanes;
    ((a + b) + (c + d)) + ((e + f) + (g + h)) + tail
}

/// `y += s x` over the shorter length.
fn axpy(s: f64, x: &[f64], y: &mut [f64]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y += s * x;
    }
}

#[cfg(test)]
mod tests;
