//! Gaussian elimination with partial pivoting on a band (as LAPACK's `gbtrf`,
//! but by rows), with several right-hand sides at once.
//!
//! Pivoting fills up to `lower` further diagonals above the band; room for
//! them is kept from the start.

use thiserror::Error;

/// The matrix has no usable pivot in one column.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[error("the matrix is singular: no pivot in column {column}")]
pub struct Singular {
    /// The column without a pivot.
    pub column: usize,
}

/// A square band matrix: `lower` diagonals below the main one, `upper` above.
#[derive(Debug, Clone, PartialEq)]
pub struct BandedMatrix {
    n: usize,
    lower: usize,
    upper: usize,
    /// Row `i` holds columns `i − lower ..= i + upper + lower`, out-of-range
    /// columns included as zeros.
    values: Vec<f64>,
}

impl BandedMatrix {
    /// A zero matrix of order `n`.
    #[must_use]
    pub fn new(n: usize, lower: usize, upper: usize) -> Self {
        BandedMatrix {
            n,
            lower,
            upper,
            values: vec![0.0; n * (2 * lower + upper + 1)],
        }
    }

    fn index(&self, i: usize, j: usize) -> usize {
        i * (2 * self.lower + self.upper + 1) + (j + self.lower - i)
    }

    /// Adds `value` to the entry (i, j).
    ///
    /// # Panics
    /// If the entry lies outside the band, a mistake of the programme.
    pub fn add(&mut self, i: usize, j: usize, value: f64) {
        assert!(
            j + self.lower >= i && j <= i + self.upper && j < self.n,
            "entry ({i}, {j}) lies outside the band"
        );
        let k = self.index(i, j);
        self.values[k] += value;
    }

    /// Eliminates.
    ///
    /// # Errors
    /// [`Singular`] where a column has no nonzero, finite pivot.
    pub fn factor(mut self) -> Result<BandedLu, Singular> {
        let mut swaps = Vec::with_capacity(self.n);
        for k in 0..self.n {
            let last_row = (k + self.lower).min(self.n - 1);
            let pivot_row = self.pivot_row(k, last_row)?;
            swaps.push(pivot_row);
            if pivot_row != k {
                self.swap_rows(k, pivot_row);
            }
            for i in k + 1..=last_row {
                self.eliminate(k, i);
            }
        }
        Ok(BandedLu {
            matrix: self,
            swaps,
        })
    }

    /// The row of the largest entry in column `k` at or below the diagonal.
    fn pivot_row(&self, k: usize, last_row: usize) -> Result<usize, Singular> {
        let (mut best, mut size) = (k, 0.0);
        for i in k..=last_row {
            let v = self.values[self.index(i, k)].abs();
            if v > size {
                (best, size) = (i, v);
            }
        }
        if size > 0.0 && size.is_finite() {
            Ok(best)
        } else {
            Err(Singular { column: k })
        }
    }

    /// One past the last column that row `k` can hold once it is a pivot row.
    fn column_end(&self, k: usize) -> usize {
        (k + self.upper + self.lower + 1).min(self.n)
    }

    fn swap_rows(&mut self, k: usize, other: usize) {
        for j in k..self.column_end(k) {
            let (a, b) = (self.index(k, j), self.index(other, j));
            self.values.swap(a, b);
        }
    }

    fn eliminate(&mut self, k: usize, i: usize) {
        let at = self.index(i, k);
        let factor = self.values[at] / self.values[self.index(k, k)];
        self.values[at] = factor;
        if factor != 0.0 {
            for j in k + 1..self.column_end(k) {
                let slot = self.index(i, j);
                self.values[slot] -= factor * self.values[self.index(k, j)];
            }
        }
    }
}

/// A factored band matrix.
#[derive(Debug, Clone, PartialEq)]
pub struct BandedLu {
    matrix: BandedMatrix,
    swaps: Vec<usize>,
}

impl BandedLu {
    /// Replaces `K` right-hand sides (one array a row) by their solutions.
    ///
    /// # Panics
    /// If `b` is shorter than the matrix.
    pub fn solve_in_place<const K: usize>(&self, b: &mut [[f64; K]]) {
        let m = &self.matrix;
        for k in 0..m.n {
            b.swap(k, self.swaps[k]);
            let pivot = b[k];
            for i in k + 1..=(k + m.lower).min(m.n - 1) {
                subtract(&mut b[i], m.values[m.index(i, k)], &pivot);
            }
        }
        for k in (0..m.n).rev() {
            let mut sum = b[k];
            for j in k + 1..m.column_end(k) {
                subtract(&mut sum, m.values[m.index(k, j)], &b[j]);
            }
            let pivot = m.values[m.index(k, k)];
            b[k] = sum.map(|v| v / pivot);
        }
    }
}

fn subtract<const K: usize>(target: &mut [f64; K], factor: f64, row: &[f64; K]) {
    for (t, r) in target.iter_mut().zip(row) {
        *t -= factor * r;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(n: usize, lower: usize, upper: usize, entry: impl Fn(usize, usize) -> f64) {
        let mut a = BandedMatrix::new(n, lower, upper);
        let x: Vec<[f64; 2]> = (0..n).map(|i| [i as f64 - 3.0, (i as f64).cos()]).collect();
        let mut b = vec![[0.0; 2]; n];
        for i in 0..n {
            for j in i.saturating_sub(lower)..(i + upper + 1).min(n) {
                a.add(i, j, entry(i, j));
                b[i][0] += entry(i, j) * x[j][0];
                b[i][1] += entry(i, j) * x[j][1];
            }
        }
        a.factor().expect("regular").solve_in_place(&mut b);
        for (i, (got, want)) in b.iter().zip(&x).enumerate() {
            assert!(
                (got[0] - want[0]).abs() + (got[1] - want[1]).abs() < 1e-9,
                "row {i}"
            );
        }
    }

    #[test]
    fn solves_bands_that_need_pivoting() {
        // A zero diagonal: without row swaps the first step divides by zero.
        check(20, 1, 1, |i, j| {
            if i == j {
                0.0
            } else {
                1.0 + (i + 2 * j) as f64 * 0.1
            }
        });
        check(31, 2, 3, |i, j| ((i * 5 + j * 3) % 7) as f64 - 2.5);
        check(8, 0, 0, |i, _| i as f64 + 1.0);
        check(1, 3, 3, |_, _| 2.0);
    }

    #[test]
    fn a_singular_matrix_is_refused_with_its_column() {
        let mut a = BandedMatrix::new(3, 1, 1);
        a.add(0, 0, 1.0);
        a.add(2, 2, 1.0);
        assert_eq!(a.factor(), Err(Singular { column: 1 }));
        assert_eq!(
            BandedMatrix::new(2, 0, 0).factor(),
            Err(Singular { column: 0 })
        );
    }
}
