//! Residual blocks: a few residuals that depend on a few unknowns, with their
//! dense little Jacobian. All blocks of a problem lie in four flat buffers
//! that are reused from iteration to iteration.
//!
//! A residual counts ½ r²; a **one-sided** residual counts ½ max(0, r)²: the
//! penalty of the inequality r ≤ 0. The solver is told both, with the
//! derivatives of one-sided residuals even where they do not count, so that a
//! step can foresee which inequalities it would break.

/// The residuals of a problem at one point, block after block.
#[derive(Debug, Clone, Default)]
pub struct Blocks {
    wants_jacobian: bool,
    residuals: Vec<f64>,
    /// Whether the residual of the same index is one-sided.
    one_sided: Vec<bool>,
    columns: Vec<usize>,
    jacobian: Vec<f64>,
    heads: Vec<Head>,
}

#[derive(Debug, Clone, Copy)]
struct Head {
    residual: usize,
    rows: usize,
    column: usize,
    columns: usize,
    jacobian: usize,
}

/// One block: `residuals[r]` depends on the unknowns `columns[c]` with the
/// derivative `jacobian[r * columns.len() + c]`.
#[derive(Debug, Clone, Copy)]
pub struct Block<'a> {
    /// Index of its first residual among all.
    pub first: usize,
    /// Residuals of the block.
    pub residuals: &'a [f64],
    /// Unknowns that they depend on.
    pub columns: &'a [usize],
    /// Row-major derivatives.
    pub jacobian: &'a [f64],
}

impl Block<'_> {
    /// The rows of the Jacobian with the indices of their residuals.
    pub fn rows(&self) -> impl Iterator<Item = (usize, &[f64])> {
        self.jacobian
            .chunks_exact(self.columns.len())
            .enumerate()
            .map(|(r, row)| (self.first + r, row))
    }
}

impl Blocks {
    /// Empties the buffers for a new evaluation, with or without derivatives.
    pub fn reset(&mut self, wants_jacobian: bool) {
        self.wants_jacobian = wants_jacobian;
        self.residuals.clear();
        self.one_sided.clear();
        self.columns.clear();
        self.jacobian.clear();
        self.heads.clear();
    }

    /// Whether the caller of the evaluation wants derivatives.
    #[must_use]
    pub fn wants_jacobian(&self) -> bool {
        self.wants_jacobian
    }

    /// Adds a block of ordinary residuals. `jacobian` (row-major,
    /// `residuals.len() × columns.len()`) is ignored unless
    /// [`Self::wants_jacobian`]; an unknown may stand in `columns` twice, its
    /// derivatives then add up.
    pub fn push(&mut self, residuals: &[f64], columns: &[usize], jacobian: &[f64]) {
        self.push_mixed(residuals, residuals.len(), columns, jacobian);
    }

    /// As [`Self::push`], the residuals from index `ordinary` on one-sided.
    pub fn push_mixed(
        &mut self,
        residuals: &[f64],
        ordinary: usize,
        columns: &[usize],
        jacobian: &[f64],
    ) {
        let head = Head {
            residual: self.residuals.len(),
            rows: residuals.len(),
            column: self.columns.len(),
            columns: columns.len(),
            jacobian: self.jacobian.len(),
        };
        self.residuals.extend_from_slice(residuals);
        self.one_sided
            .extend((0..residuals.len()).map(|r| r >= ordinary));
        if self.wants_jacobian && !columns.is_empty() {
            debug_assert_eq!(jacobian.len(), residuals.len() * columns.len());
            self.columns.extend_from_slice(columns);
            self.jacobian.extend_from_slice(jacobian);
            self.heads.push(head);
        }
    }

    /// All residuals in order.
    #[must_use]
    pub fn residuals(&self) -> &[f64] {
        &self.residuals
    }

    /// Whether residual `r` is one-sided.
    #[must_use]
    pub fn is_one_sided(&self, r: usize) -> bool {
        self.one_sided[r]
    }

    /// ½ Σ r² + ½ Σ max(0, r)², for the residuals or for other values of them.
    #[must_use]
    pub fn cost_of(&self, values: &[f64]) -> f64 {
        let counts =
            |(r, one_sided): (&f64, &bool)| if *one_sided && *r < 0.0 { 0.0 } else { r * r };
        0.5 * values.iter().zip(&self.one_sided).map(counts).sum::<f64>()
    }

    /// The cost of the residuals.
    #[must_use]
    pub fn cost(&self) -> f64 {
        self.cost_of(&self.residuals)
    }

    /// Which residuals count when they have the given values.
    pub fn active(&self, values: &[f64], active: &mut Vec<bool>) {
        active.clear();
        active.extend(
            values
                .iter()
                .zip(&self.one_sided)
                .map(|(r, one)| !*one || *r > 0.0),
        );
    }

    /// The blocks; empty unless derivatives were wanted.
    pub fn iter(&self) -> impl Iterator<Item = Block<'_>> {
        self.heads.iter().map(|h| Block {
            first: h.residual,
            residuals: &self.residuals[h.residual..h.residual + h.rows],
            columns: &self.columns[h.column..h.column + h.columns],
            jacobian: &self.jacobian[h.jacobian..h.jacobian + h.rows * h.columns],
        })
    }

    /// `J·step` for every residual.
    pub fn changes(&self, step: &[f64], changes: &mut Vec<f64>) {
        changes.clear();
        changes.resize(self.residuals.len(), 0.0);
        for block in self.iter() {
            for (r, row) in block.rows() {
                changes[r] = block
                    .columns
                    .iter()
                    .zip(row)
                    .map(|(c, j)| step[*c] * j)
                    .sum();
            }
        }
    }

    /// Adds `Jᵀ·values` over the residuals that count.
    pub fn add_gradient(&self, values: &[f64], active: &[bool], gradient: &mut [f64]) {
        for block in self.iter() {
            for (r, row) in block.rows().filter(|(r, _)| active[*r]) {
                for (c, j) in block.columns.iter().zip(row) {
                    gradient[*c] += values[r] * j;
                }
            }
        }
    }
}
