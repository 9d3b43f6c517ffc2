//! Cholesky of wide bands, tile by tile.
//!
//! A band is cut into square tiles; the factorisation is the right-looking
//! one on tiles (Golub & Van Loan §4.2.9): factor the diagonal tile, solve
//! for the tiles beneath it, subtract their products from the tiles to the
//! right. The products are dense matrix products, which the processor does at
//! its full speed; those of one step are independent and run in parallel, each
//! in a fixed order, so that the result does not depend on the thread count.
//!
//! Beats [`super::EnvelopeMatrix::factor`] from half bandwidths of about a hundred on.

use super::envelope::{EnvelopeMatrix, NotPositiveDefinite};
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::{Accum, MatMut, MatRef, Par};
use rayon::prelude::*;

/// Rows and columns of a tile: large enough for dense products at full speed.
const TILE: usize = 64;
/// Numbers in a tile.
const AREA: usize = TILE * TILE;
/// Tiles below the diagonal from which a step is worth two threads.
const PARALLEL: usize = 5;

/// The lower Cholesky factor of a band matrix, in tiles.
#[derive(Debug, Clone, PartialEq)]
pub struct TiledFactor {
    order: usize,
    /// Tiles a column, the diagonal one included.
    reach: usize,
    /// Column by column, each downwards, each tile column-major.
    tiles: Vec<f64>,
}

impl TiledFactor {
    /// Factors a matrix whose rows reach at most `half_bandwidth` to the left
    /// of the diagonal.
    ///
    /// # Errors
    /// [`NotPositiveDefinite`] with the row whose pivot was not positive.
    ///
    /// # Panics
    /// If a row reaches further: a mistake of the programme.
    pub fn new(
        matrix: &EnvelopeMatrix,
        half_bandwidth: usize,
    ) -> Result<Self, NotPositiveDefinite> {
        let order = matrix.order();
        let columns = order.div_ceil(TILE);
        let reach = half_bandwidth.div_ceil(TILE) + 1;
        let mut factor = TiledFactor {
            order,
            reach,
            tiles: vec![0.0; columns * reach * AREA],
        };
        for i in 0..order {
            let (first, row) = matrix.row(i);
            for (j, value) in (first..).zip(row) {
                let k = factor.place(i, j);
                factor.tiles[k] = *value;
            }
        }
        // The last tile is filled up with a unit matrix.
        for i in order..columns * TILE {
            let k = factor.place(i, i);
            factor.tiles[k] = 1.0;
        }
        for k in 0..columns {
            factor.step(k)?;
        }
        Ok(factor)
    }

    /// Where the entry (i, j), j ≤ i, is kept.
    fn place(&self, i: usize, j: usize) -> usize {
        let (below, column) = (i / TILE - j / TILE, j / TILE);
        assert!(below < self.reach, "entry ({i}, {j}) lies left of the band");
        (column * self.reach + below) * AREA + (j % TILE) * TILE + i % TILE
    }

    /// Eliminates one column of tiles.
    fn step(&mut self, k: usize) -> Result<(), NotPositiveDefinite> {
        let columns = self.order.div_ceil(TILE);
        let (done, tail) = self.tiles.split_at_mut((k + 1) * self.reach * AREA);
        let panel = &mut done[k * self.reach * AREA..];
        let (diagonal, below) = panel.split_at_mut(AREA);
        factor_tile(diagonal, k * TILE)?;
        let reach = (self.reach - 1).min(columns - k - 1);
        let lower = MatRef::from_column_major_slice(diagonal, TILE, TILE);
        for tile in below.chunks_exact_mut(AREA).take(reach) {
            let tile = MatMut::from_column_major_slice_mut(tile, TILE, TILE);
            solve_lower_triangular_in_place(lower, tile.transpose_mut(), Par::Seq);
        }
        let below = &below[..reach * AREA];
        let width = self.reach;
        let update = |(place, tile): (usize, &mut [f64])| {
            // Tile (j + i, j) counted from column k + 1.
            let (j, i) = (place / width, place % width);
            if i + j >= reach {
                return;
            }
            let part = |r: usize| {
                MatRef::from_column_major_slice(&below[r * AREA..(r + 1) * AREA], TILE, TILE)
            };
            let target = MatMut::from_column_major_slice_mut(tile, TILE, TILE);
            matmul(
                target,
                Accum::Add,
                part(i + j),
                part(j).transpose(),
                -1.0,
                Par::Seq,
            );
        };
        let touched = &mut tail[..reach * width * AREA];
        if reach >= PARALLEL {
            touched
                .par_chunks_exact_mut(AREA)
                .enumerate()
                .with_min_len(width)
                .for_each(update);
        } else {
            touched.chunks_exact_mut(AREA).enumerate().for_each(update);
        }
        Ok(())
    }

    /// Replaces the right-hand side `b` by the solution of `A x = b`.
    ///
    /// # Panics
    /// If `b` is shorter than the matrix.
    pub fn solve_in_place(&self, b: &mut [f64]) {
        let columns = self.order.div_ceil(TILE);
        let mut x = vec![0.0; columns * TILE];
        x[..self.order].copy_from_slice(&b[..self.order]);
        for k in 0..columns {
            for c in 0..TILE {
                let column = self.column(k, c);
                let (head, rest) = x[k * TILE..].split_at_mut(TILE);
                head[c] /= column(0)[c];
                let pivot = head[c];
                axpy(-pivot, &column(0)[c + 1..], &mut head[c + 1..]);
                for (i, target) in rest.chunks_exact_mut(TILE).enumerate().take(self.reach - 1) {
                    axpy(-pivot, column(i + 1), target);
                }
            }
        }
        for k in (0..columns).rev() {
            for c in (0..TILE).rev() {
                let column = self.column(k, c);
                let (head, rest) = x[k * TILE..].split_at(TILE);
                let mut sum = head[c] - dot(&column(0)[c + 1..], &head[c + 1..]);
                for (i, target) in rest.chunks_exact(TILE).enumerate().take(self.reach - 1) {
                    sum -= dot(column(i + 1), target);
                }
                x[k * TILE + c] = sum / column(0)[c];
            }
        }
        b[..self.order].copy_from_slice(&x[..self.order]);
    }

    /// Column `c` of the tiles of column `k`, tile by tile.
    fn column<'a>(&'a self, k: usize, c: usize) -> impl Fn(usize) -> &'a [f64] {
        let start = k * self.reach * AREA + c * TILE;
        move |i| &self.tiles[start + i * AREA..start + i * AREA + TILE]
    }

    /// The squares of the diagonal of `L`: the pivots of the elimination.
    pub fn pivots(&self) -> impl Iterator<Item = f64> + '_ {
        (0..self.order).map(|i| {
            let pivot = self.tiles[self.place(i, i)];
            pivot * pivot
        })
    }
}

/// Overwrites the lower triangle of a diagonal tile with its factor, column
/// by column.
fn factor_tile(tile: &mut [f64], first_row: usize) -> Result<(), NotPositiveDefinite> {
    for j in 0..TILE {
        let (left, rest) = tile.split_at_mut(j * TILE);
        let column = &mut rest[..TILE];
        for k in 0..j {
            let other = &left[k * TILE..(k + 1) * TILE];
            axpy(-other[j], &other[j..], &mut column[j..]);
        }
        let pivot = column[j];
        // `!(…)` so that NaN is refused too.
        if !(pivot > 0.0 && pivot.is_finite()) {
            let row = first_row + j;
            return Err(NotPositiveDefinite { row, pivot });
        }
        let root = pivot.sqrt();
        for value in &mut column[j..] {
            *value /= root;
        }
    }
    Ok(())
}

/// `y += s x`.
fn axpy(s: f64, x: &[f64], y: &mut [f64]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y += s * x;
    }
}

/// Dot product over the shorter length, in four partial sums.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut lanes = [0.0; 4];
    let (ca, cb) = (a.chunks_exact(4), b.chunks_exact(4));
    let tail: f64 = ca
        .remainder()
        .iter()
        .zip(cb.remainder())
        .map(|(x, y)| x * y)
        .sum();
    for (x, y) in ca.zip(cb) {
        for l in 0..4 {
            lanes[l] += x[l] * y[l];
        }
    }
    (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]) + tail
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(n: usize, w: usize) -> EnvelopeMatrix {
        let mut matrix = EnvelopeMatrix::banded(n, w);
        for i in 0..n {
            for j in i.saturating_sub(w)..i {
                matrix.add(i, j, ((i * 7 + j * 13) % 17) as f64 / 17.0 - 0.4);
            }
            matrix.add(i, i, 2.0 * w as f64 + 1.0);
        }
        matrix
    }

    #[test]
    fn solves_what_the_envelope_solves() {
        for (n, w) in [(1, 0), (31, 5), (32, 31), (100, 33), (257, 64), (400, 170)] {
            let matrix = sample(n, w);
            let tiled = TiledFactor::new(&matrix, w).expect("positive definite");
            let plain = matrix.factor().expect("positive definite");
            let mut x: Vec<f64> = (0..n).map(|i| (i as f64).sin()).collect();
            let mut y = x.clone();
            tiled.solve_in_place(&mut x);
            plain.solve_in_place(&mut y);
            for (a, b) in x.iter().zip(&y) {
                assert!((a - b).abs() < 1e-12, "n {n} w {w}: {a} {b}");
            }
            for (a, b) in tiled.pivots().zip(plain.pivots()) {
                assert!((a - b).abs() < 1e-10 * b);
            }
        }
    }

    #[test]
    fn refuses_an_indefinite_matrix_at_its_row() {
        let mut matrix = sample(100, 40);
        matrix.add_to_diagonal(70, -1000.0);
        assert_eq!(TiledFactor::new(&matrix, 40).map_err(|e| e.row), Err(70));
    }
}
