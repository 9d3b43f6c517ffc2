//! The normal equations (JᵀJ + λD) p = −Jᵀr of block residuals.
//!
//! Curves and strips give matrices whose rows have few entries left of the
//! diagonal: an envelope (variable band, George & Liu 1981) holds them without
//! fill-in, bands and arrows included. Two-dimensional nets want a
//! fill-reducing order: those go to faer's sparse Cholesky. The pattern is
//! found from the blocks of each linearisation, so it may move from step to
//! step; one-sided residuals belong to it whether they count or not.

use super::blocks::{Block, Blocks};
use crate::numerics::EnvelopeMatrix;
use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::{Llt, SymbolicLlt};
use faer::sparse::{SparseColMat, Triplet};
use faer::{Col, Side};

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

#[derive(Default)]
pub(super) struct SparseNormal {
    dimension: usize,
    entries: Vec<Triplet<usize, usize, f64>>,
    /// Columns of the blocks behind `symbolic`: while they stay, it stays.
    columns: Vec<usize>,
    symbolic: Option<SymbolicLlt<usize>>,
}

impl NormalMatrix {
    pub(super) fn new(kind: NormalEquations, dimension: usize) -> Self {
        match kind {
            NormalEquations::Envelope => {
                NormalMatrix::Envelope(EnvelopeMatrix::new((0..dimension).collect()))
            }
            NormalEquations::Sparse => NormalMatrix::Sparse(SparseNormal {
                dimension,
                ..SparseNormal::default()
            }),
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
                    |r| !blocks.is_one_sided(r),
                    |i, j, v| matrix.add(i, j, v),
                );
            }
            NormalMatrix::Sparse(sparse) => sparse.assemble(blocks),
        }
    }

    /// The diagonal of JᵀJ with the one-sided residuals that count.
    pub(super) fn diagonal(blocks: &Blocks, active: &[bool], dimension: usize) -> Vec<f64> {
        let mut diagonal = vec![0.0; dimension];
        for block in blocks.iter() {
            for (_, row) in block.rows().filter(|(r, _)| active[*r]) {
                for (c, j) in block.columns.iter().zip(row) {
                    diagonal[*c] += j * j;
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
        active: &[bool],
        shift: &[f64],
        rhs: &mut [f64],
    ) -> bool {
        let counts = |r: usize| blocks.is_one_sided(r) && active[r];
        match self {
            NormalMatrix::Envelope(matrix) => {
                let mut damped = matrix.clone();
                add_products(blocks, counts, |i, j, v| damped.add(i, j, v));
                for (i, s) in shift.iter().enumerate() {
                    damped.add_to_diagonal(i, *s);
                }
                let Ok(factor) = damped.factor() else {
                    return false;
                };
                factor.solve_in_place(rhs);
                rhs.iter().all(|v| v.is_finite())
            }
            NormalMatrix::Sparse(sparse) => sparse.solve(blocks, counts, shift, rhs),
        }
    }
}

impl SparseNormal {
    fn assemble(&mut self, blocks: &Blocks) {
        let columns: Vec<usize> = blocks
            .iter()
            .flat_map(|b| b.columns.iter().copied())
            .collect();
        if columns != self.columns {
            self.symbolic = None;
            self.columns = columns;
        }
        self.entries.clear();
        let entries = &mut self.entries;
        // Zeros of rows that do not count keep the pattern the same.
        add_products(
            blocks,
            |_| true,
            |i, j, _| entries.push(Triplet::new(i, j, 0.0)),
        );
        add_products(
            blocks,
            |r| !blocks.is_one_sided(r),
            |i, j, v| {
                entries.push(Triplet::new(i, j, v));
            },
        );
    }

    fn solve(
        &mut self,
        blocks: &Blocks,
        counts: impl Fn(usize) -> bool,
        shift: &[f64],
        rhs: &mut [f64],
    ) -> bool {
        let mut entries = self.entries.clone();
        add_products(blocks, counts, |i, j, v| {
            entries.push(Triplet::new(i, j, v))
        });
        entries.extend(
            shift
                .iter()
                .enumerate()
                .map(|(i, s)| Triplet::new(i, i, *s)),
        );
        let n = self.dimension;
        let Ok(matrix) = SparseColMat::<usize, f64>::try_new_from_triplets(n, n, &entries) else {
            return false;
        };
        if self.symbolic.is_none() {
            self.symbolic = SymbolicLlt::try_new(matrix.symbolic(), Side::Lower).ok();
        }
        let Some(symbolic) = self.symbolic.clone() else {
            return false;
        };
        let Ok(factor) = Llt::try_new_with_symbolic(symbolic, matrix.as_ref(), Side::Lower) else {
            return false;
        };
        let solution = factor.solve(&Col::from_fn(n, |i| rhs[i]));
        for (i, r) in rhs.iter_mut().enumerate() {
            *r = solution[i];
        }
        rhs.iter().all(|v| v.is_finite())
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

/// Calls `add(i, j, v)`, `i ≥ j`, with the products of which JᵀJ over the
/// counted residuals is the sum.
fn add_products(
    blocks: &Blocks,
    counts: impl Fn(usize) -> bool,
    mut add: impl FnMut(usize, usize, f64),
) {
    let mut rows: Vec<&[f64]> = Vec::new();
    for block in blocks.iter() {
        rows.clear();
        let width = block.columns.len();
        let lines = block.jacobian.chunks_exact(width).enumerate();
        rows.extend(
            lines
                .filter(|(r, _)| counts(block.first + r))
                .map(|(_, row)| row),
        );
        if !rows.is_empty() {
            add_block(&block, &rows, &mut add);
        }
    }
}

fn add_block(block: &Block<'_>, rows: &[&[f64]], add: &mut impl FnMut(usize, usize, f64)) {
    for (a, ca) in block.columns.iter().enumerate() {
        for (b, cb) in block.columns[..=a].iter().enumerate() {
            let sum: f64 = rows.iter().map(|row| row[a] * row[b]).sum();
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
    fn dense(blocks: &Blocks, active: &[bool]) -> nalgebra::Matrix4<f64> {
        let mut sum = nalgebra::Matrix4::from_diagonal(&SHIFT.into());
        for block in blocks.iter() {
            for (_, row) in block.rows().filter(|(r, _)| active[*r]) {
                let mut j = nalgebra::Vector4::zeros();
                block.columns.iter().zip(row).for_each(|(c, v)| j[*c] += v);
                sum += j * j.transpose();
            }
        }
        sum
    }

    #[test]
    fn both_kinds_solve_the_dense_system() {
        let blocks = blocks();
        let mut active = Vec::new();
        blocks.active(blocks.residuals(), &mut active);
        assert_eq!(active, [true, true, true, true, false]);
        let rhs = [1.0, -1.0, 2.0, 0.5];
        let expected = dense(&blocks, &active)
            .lu()
            .solve(&nalgebra::Vector4::from(rhs));
        let expected = expected.expect("regular");
        for kind in [NormalEquations::Envelope, NormalEquations::Sparse] {
            let mut matrix = NormalMatrix::new(kind, 4);
            // Twice: the second time on the symbolic factor of the first.
            for _ in 0..2 {
                matrix.assemble(&blocks, 4);
                let mut x = rhs;
                assert!(matrix.solve(&blocks, &active, &SHIFT, &mut x), "{kind:?}");
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
        let active = [true, true, true, false, false];
        for kind in [NormalEquations::Envelope, NormalEquations::Sparse] {
            let mut matrix = NormalMatrix::new(kind, 4);
            matrix.assemble(&blocks, 4);
            let shift = [0.1, 0.1, 0.1, -1.0];
            assert!(
                !matrix.solve(&blocks, &active, &shift, &mut [1.0; 4]),
                "{kind:?}"
            );
        }
    }
}
