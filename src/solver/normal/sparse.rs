//! Normal equations in compressed columns, factored by faer.
//!
//! The pattern, the fill-reducing order and the place of every product among
//! the stored entries are found once for a layout of blocks; from then on an
//! assembly is a pass of additions without searching.

use super::super::blocks::Blocks;
use super::{products, weighted_rows};
use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::{Llt, SymbolicLlt};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMat};
use faer::{Col, Side};
use std::collections::HashMap;

/// The lower triangle of JᵀJ over the ordinary residuals, with its layout.
#[derive(Default)]
pub(in super::super) struct SparseNormal {
    layout: Option<Layout>,
    values: Vec<f64>,
}

/// Where the products of the blocks go.
struct Layout {
    /// Columns of the blocks that it was made for, and their widths.
    columns: Vec<usize>,
    widths: Vec<usize>,
    pattern: SymbolicSparseColMat<usize>,
    symbolic: SymbolicLlt<usize>,
    /// For every block the first of its slots; blocks on the same unknowns
    /// share theirs.
    starts: Vec<usize>,
    /// Index among the stored entries of each product of a block.
    slots: Vec<usize>,
    /// Index of each diagonal entry.
    diagonal: Vec<usize>,
}

impl SparseNormal {
    /// Replaces the matrix by JᵀJ of the ordinary residuals; the pattern
    /// covers all. `false` where faer cannot analyse it.
    pub(super) fn assemble(&mut self, blocks: &Blocks, dimension: usize) {
        if !self.layout.as_ref().is_some_and(|l| l.fits(blocks)) {
            self.layout = Layout::new(blocks, dimension);
        }
        let Some(layout) = &self.layout else { return };
        self.values.clear();
        self.values.resize(layout.pattern.row_idx().len(), 0.0);
        let ordinary = |r: usize| f64::from(u8::from(!blocks.is_one_sided(r)));
        layout.add(blocks, ordinary, &mut self.values);
    }

    /// As [`super::NormalMatrix::solve`], `weight` for the one-sided residuals.
    pub(super) fn solve(
        &self,
        blocks: &Blocks,
        weight: impl Fn(usize) -> f64,
        shift: &[f64],
        rhs: &mut [f64],
    ) -> bool {
        let Some(layout) = &self.layout else {
            return false;
        };
        let mut values = self.values.clone();
        layout.add(blocks, weight, &mut values);
        for (slot, s) in layout.diagonal.iter().zip(shift) {
            values[*slot] += s;
        }
        let matrix = SparseColMatRef::new(layout.pattern.as_ref(), &values);
        let symbolic = layout.symbolic.clone();
        let Ok(factor) = Llt::try_new_with_symbolic(symbolic, matrix, Side::Lower) else {
            return false;
        };
        let solution = factor.solve(&Col::from_fn(rhs.len(), |i| rhs[i]));
        for (i, r) in rhs.iter_mut().enumerate() {
            *r = solution[i];
        }
        rhs.iter().all(|v| v.is_finite())
    }
}

impl Layout {
    fn new(blocks: &Blocks, dimension: usize) -> Option<Self> {
        let mut entries: Vec<Vec<usize>> = (0..dimension).map(|j| vec![j]).collect();
        // Neighbouring samples depend on the same unknowns: each set once.
        let mut sets: HashMap<&[usize], usize> = HashMap::new();
        let mut slot_count = 0;
        for block in blocks.iter() {
            sets.entry(block.columns).or_insert_with(|| {
                pairs(block.columns).for_each(|(i, j)| entries[j].push(i));
                let start = slot_count;
                slot_count += block.columns.len() * (block.columns.len() + 1) / 2;
                start
            });
        }
        for rows in &mut entries {
            rows.sort_unstable();
            rows.dedup();
        }
        let mut column_starts = vec![0];
        for rows in &entries {
            column_starts.push(column_starts[column_starts.len() - 1] + rows.len());
        }
        let place = |i: usize, j: usize| {
            column_starts[j] + entries[j].binary_search(&i).unwrap_or_default()
        };
        let (mut starts, mut slots) = (Vec::new(), Vec::with_capacity(slot_count));
        for block in blocks.iter() {
            let start = sets[block.columns];
            if start == slots.len() {
                slots.extend(pairs(block.columns).map(|(i, j)| place(i, j)));
            }
            starts.push(start);
        }
        let diagonal = (0..dimension).map(|j| place(j, j)).collect();
        let pattern = SymbolicSparseColMat::new_checked(
            dimension,
            dimension,
            column_starts.clone(),
            None,
            entries.concat(),
        );
        Some(Layout {
            columns: blocks.iter().flat_map(|b| b.columns).copied().collect(),
            widths: blocks.iter().map(|b| b.columns.len()).collect(),
            symbolic: SymbolicLlt::try_new(pattern.as_ref(), Side::Lower).ok()?,
            pattern,
            starts,
            slots,
            diagonal,
        })
    }

    fn fits(&self, blocks: &Blocks) -> bool {
        blocks
            .iter()
            .map(|b| b.columns.len())
            .eq(self.widths.iter().copied())
            && blocks
                .iter()
                .flat_map(|b| b.columns)
                .eq(self.columns.iter())
    }

    /// Adds the products of the weighted rows to the stored entries.
    fn add(&self, blocks: &Blocks, weight: impl Fn(usize) -> f64, values: &mut [f64]) {
        let mut rows = Vec::new();
        for (block, start) in blocks.iter().zip(&self.starts) {
            weighted_rows(&block, &weight, &mut rows);
            if !rows.is_empty() {
                let mut slots = self.slots[*start..].iter();
                products(&block, &rows, |_, _, value| {
                    if let Some(slot) = slots.next() {
                        values[*slot] += value;
                    }
                });
            }
        }
    }
}

/// The entries (i, j), i ≥ j, of a block's products, in the order of
/// [`products`].
fn pairs(columns: &[usize]) -> impl Iterator<Item = (usize, usize)> + '_ {
    columns.iter().enumerate().flat_map(move |(a, ca)| {
        columns[..=a]
            .iter()
            .map(move |cb| (*ca.max(cb), *ca.min(cb)))
    })
}
