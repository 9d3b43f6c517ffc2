//! The normal equations (JᵀJ + λD) p = −Jᵀr of block residuals.
//!
//! Curves and strips give matrices whose rows have few entries left of the
//! diagonal: an envelope (variable band, George & Liu 1981) holds them without
//! fill-in, bands and arrows included. Two-dimensional nets want a
//! fill-reducing order: those go to faer's sparse Cholesky. The pattern is
//! found from the blocks of each linearisation, so it may move from step to
//! step; one-sided residuals belong to it whether they count or not.

mod sparse;

use super::blocks::{Block, Blocks};
use crate::numerics::EnvelopeMatrix;
use sparse::SparseNormal;

/// How the normal equations are stored and factored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NormalEquations {
    /// Variable band in the order of the unknowns: bands, arrows, strips.
    Envelope,
    /// Sparse with a fill-reducing order: nets.
    Sparse,
}

/// JᵀJ over the residuals that always count, and a way to add the others.
pub(super) enum NormalMatrix {
    Envelope(EnvelopeMatrix),
    Sparse(SparseNormal),
}

impl NormalMatrix {
    pub(super) fn new(kind: NormalEquations, dimension: usize) -> Self {
        match kind {
            NormalEquations::Envelope => {
                NormalMatrix::Envelope(EnvelopeMatrix::new((0..dimension).collect()))
            }
            NormalEquations::Sparse => NormalMatrix::Sparse(SparseNormal::default()),
        }
    }

    /// Replaces the matrix by JᵀJ of the ordinary residuals; the pattern
    /// covers all.
    pub(super) fn assemble(&mut self, blocks: &Blocks, dimension: usize) {
        match self {
            NormalMatrix::Envelope(matrix) => {
                *matrix = EnvelopeMatrix::new(envelope(blocks, dimension));
                add_products(
                    blocks,
                    |r| f64::from(u8::from(!blocks.is_one_sided(r))),
                    |i, j, v| matrix.add(i, j, v),
                );
            }
            NormalMatrix::Sparse(sparse) => sparse.assemble(blocks, dimension),
        }
    }

    /// The diagonal of JᵀJ with the one-sided residuals by their weights.
    pub(super) fn diagonal(blocks: &Blocks, weights: &[f64], dimension: usize) -> Vec<f64> {
        let mut diagonal = vec![0.0; dimension];
        for block in blocks.iter() {
            for (r, row) in block.rows().filter(|(r, _)| weights[*r] > 0.0) {
                for (c, j) in block.columns.iter().zip(row) {
                    diagonal[*c] += weights[r] * j * j;
                }
            }
        }
        diagonal
    }

    /// Solves (JᵀJ + diag(shift)) x = rhs in place, with the one-sided
    /// residuals that count; `false` when the matrix is not positive definite
    /// to working precision.
    pub(super) fn solve(
        &mut self,
        blocks: &Blocks,
        weights: &[f64],
        shift: &[f64],
        rhs: &mut [f64],
    ) -> bool {
        let weight = |r: usize| {
            if blocks.is_one_sided(r) {
                weights[r]
            } else {
                0.0
            }
        };
        match self {
            NormalMatrix::Envelope(matrix) => {
                let mut damped = matrix.clone();
                add_products(blocks, weight, |i, j, v| damped.add(i, j, v));
                for (i, s) in shift.iter().enumerate() {
                    damped.add_to_diagonal(i, *s);
                }
                let Ok(factor) = damped.factor() else {
                    return false;
                };
                factor.solve_in_place(rhs);
                rhs.iter().all(|v| v.is_finite())
            }
            NormalMatrix::Sparse(sparse) => sparse.solve(blocks, weight, shift, rhs),
        }
    }
}

/// First column with an entry, for each row of the lower triangle.
fn envelope(blocks: &Blocks, dimension: usize) -> Vec<usize> {
    let mut first: Vec<usize> = (0..dimension).collect();
    for block in blocks.iter() {
        let low = block.columns.iter().copied().min().unwrap_or(0);
        for c in block.columns {
            first[*c] = first[*c].min(low);
        }
    }
    first
}

/// Calls `add(i, j, v)`, `i ≥ j`, with the products of which JᵀWJ is the sum.
fn add_products(
    blocks: &Blocks,
    weight: impl Fn(usize) -> f64,
    mut add: impl FnMut(usize, usize, f64),
) {
    let mut rows = Vec::new();
    for block in blocks.iter() {
        weighted_rows(&block, &weight, &mut rows);
        if !rows.is_empty() {
            products(&block, &rows, &mut add);
        }
    }
}

/// The rows of a block that have a weight.
fn weighted_rows<'a>(
    block: &Block<'a>,
    weight: impl Fn(usize) -> f64,
    rows: &mut Vec<(f64, &'a [f64])>,
) {
    rows.clear();
    let weighted = block.rows().map(|(r, row)| (weight(r), row));
    rows.extend(weighted.filter(|(w, _)| *w > 0.0));
}

/// Calls `add(i, j, v)`, `i ≥ j`, for every pair of a block's columns.
fn products(block: &Block<'_>, rows: &[(f64, &[f64])], mut add: impl FnMut(usize, usize, f64)) {
    for (a, ca) in block.columns.iter().enumerate() {
        for (b, cb) in block.columns[..=a].iter().enumerate() {
            let sum: f64 = rows.iter().map(|(w, row)| w * row[a] * row[b]).sum();
            // Two places of one block may name the same unknown: both orders
            // of that pair belong to the one diagonal entry.
            let value = if ca == cb && a != b { 2.0 * sum } else { sum };
            add(*ca.max(cb), *ca.min(cb), value);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHIFT: [f64; 4] = [0.1, 0.2, 0.3, 0.4];

    /// Overlapping blocks, an unknown named twice, a one-sided residual that
    /// counts and one that does not.
    fn blocks() -> Blocks {
        let mut blocks = Blocks::default();
        blocks.reset(true);
        blocks.push(&[1.0, -2.0], &[0, 1], &[1.0, 2.0, -0.5, 3.0]);
        blocks.push(&[0.5], &[2, 1, 2], &[1.5, -1.0, 0.25]);
        blocks.push_mixed(&[0.7, -0.7], 0, &[3, 0], &[2.0, 1.0, 9.0, 9.0]);
        blocks
    }

    /// JᵀJ + diag(shift) over the residuals that count, by the definition.
    fn dense(blocks: &Blocks, weights: &[f64]) -> nalgebra::Matrix4<f64> {
        let mut sum = nalgebra::Matrix4::from_diagonal(&SHIFT.into());
        for block in blocks.iter() {
            for (r, row) in block.rows() {
                let mut j = nalgebra::Vector4::zeros();
                block.columns.iter().zip(row).for_each(|(c, v)| j[*c] += v);
                sum += weights[r] * j * j.transpose();
            }
        }
        sum
    }

    #[test]
    fn both_kinds_solve_the_dense_system() {
        let blocks = blocks();
        let weights = [1.0, 1.0, 1.0, 0.6, 0.0];
        let rhs = [1.0, -1.0, 2.0, 0.5];
        let expected = dense(&blocks, &weights)
            .lu()
            .solve(&nalgebra::Vector4::from(rhs));
        let expected = expected.expect("regular");
        for kind in [NormalEquations::Envelope, NormalEquations::Sparse] {
            let mut matrix = NormalMatrix::new(kind, 4);
            // Twice: the second time on the symbolic factor of the first.
            for _ in 0..2 {
                matrix.assemble(&blocks, 4);
                let mut x = rhs;
                assert!(matrix.solve(&blocks, &weights, &SHIFT, &mut x), "{kind:?}");
                for (x, expected) in x.iter().zip(expected.iter()) {
                    assert!(
                        (x - expected).abs() < 1e-12,
                        "{kind:?}: {x} against {expected}"
                    );
                }
            }
        }
    }

    #[test]
    fn a_matrix_that_is_not_positive_definite_is_told() {
        let blocks = blocks();
        let weights = [1.0, 1.0, 1.0, 0.0, 0.0];
        for kind in [NormalEquations::Envelope, NormalEquations::Sparse] {
            let mut matrix = NormalMatrix::new(kind, 4);
            matrix.assemble(&blocks, 4);
            let shift = [0.1, 0.1, 0.1, -1.0];
            assert!(
                !matrix.solve(&blocks, &weights, &shift, &mut [1.0; 4]),
                "{kind:?}"
            );
        }
    }
}
