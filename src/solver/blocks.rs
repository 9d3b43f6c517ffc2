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

impl<'a> Block<'a> {
    /// The rows of the Jacobian with the indices of their residuals.
    pub fn rows(&self) -> impl Iterator<Item = (usize, &'a [f64])> + use<'a> {
        let first = self.first;
        self.jacobian
            .chunks_exact(self.columns.len())
            .enumerate()
            .map(move |(r, row)| (first + r, row))
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

    /// ½ Σ r² + ½ Σ max(0, r)², for the residuals or for other values of them;
    /// with a smoothing μ, (r + √(r² + 4μ²))/2 stands for max(0, r).
    #[must_use]
    pub fn cost_of(&self, values: &[f64], smoothing: f64) -> f64 {
        let counts = |(r, one_sided): (&f64, &bool)| {
            let r = if *one_sided {
                soft_plus(*r, smoothing).value
            } else {
                *r
            };
            r * r
        };
        0.5 * values.iter().zip(&self.one_sided).map(counts).sum::<f64>()
    }

    /// The cost of the residuals.
    #[must_use]
    pub fn cost(&self, smoothing: f64) -> f64 {
        self.cost_of(&self.residuals, smoothing)
    }

    /// First and second derivatives of the cost by each residual, when they
    /// have the given values.
    pub fn derivatives(&self, values: &[f64], smoothing: f64, derivatives: &mut Derivatives) {
        derivatives.first.clear();
        derivatives.second.clear();
        for (r, one_sided) in values.iter().zip(&self.one_sided) {
            let soft = if *one_sided {
                soft_plus(*r, smoothing)
            } else {
                SoftPlus {
                    value: *r,
                    slope: 1.0,
                    bend: 0.0,
                }
            };
            derivatives.first.push(soft.value * soft.slope);
            derivatives
                .second
                .push(soft.slope * soft.slope + soft.value * soft.bend);
        }
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

    /// Adds `Jᵀ·values`.
    pub fn add_gradient(&self, values: &[f64], gradient: &mut [f64]) {
        for block in self.iter() {
            for (r, row) in block.rows().filter(|(r, _)| values[*r] != 0.0) {
                for (c, j) in block.columns.iter().zip(row) {
                    gradient[*c] += values[r] * j;
                }
            }
        }
    }
}

/// Derivatives of the cost by the residuals.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Derivatives {
    /// ∂/∂r; zero where a residual does not count.
    pub first: Vec<f64>,
    /// ∂²/∂r², never negative; zero where a residual does not count.
    pub second: Vec<f64>,
}

/// A stand-in for max(0, r) with its derivatives.
struct SoftPlus {
    value: f64,
    slope: f64,
    bend: f64,
}

/// ρ = (r + √(r² + 4μ²))/2, which is max(0, r) for μ = 0 and at most μ above it
/// elsewhere (Chen & Harker 1993; the value is the positive root of
/// ρ(ρ − r) = μ², so that μ² is the complementarity of an interior point
/// method). ½ρ² is convex: ρ′² + ρρ″ > 0.
fn soft_plus(r: f64, smoothing: f64) -> SoftPlus {
    if smoothing == 0.0 {
        let counts = r > 0.0 || r.is_nan();
        return SoftPlus {
            value: if counts { r } else { 0.0 },
            slope: f64::from(u8::from(counts)),
            bend: 0.0,
        };
    }
    let root = r.hypot(2.0 * smoothing);
    // The other form loses every digit for r ≪ −μ.
    let value = if r > 0.0 {
        0.5 * (r + root)
    } else {
        2.0 * smoothing * smoothing / (root - r)
    };
    SoftPlus {
        value,
        slope: value / root,
        bend: 2.0 * smoothing * smoothing / (root * root * root),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_soft_plus_is_convex_and_near_the_sharp_one() {
        for smoothing in [1e-6, 1e-2, 1.0] {
            for i in -40..=40 {
                let r = 0.25 * smoothing * f64::from(i);
                let soft = soft_plus(r, smoothing);
                let above = soft.value - r.max(0.0);
                assert!(
                    above > 0.0 && above <= smoothing * (1.0 + 1e-12),
                    "{r}: {above}"
                );
                assert!(soft.slope * soft.slope + soft.value * soft.bend > 0.0);
                let h = 1e-4 * smoothing;
                let [a, b] = [-h, h].map(|h| soft_plus(r + h, smoothing));
                assert!(((b.value - a.value) / (2.0 * h) - soft.slope).abs() < 1e-6);
                let bend = (b.slope - a.slope) / (2.0 * h);
                assert!((bend - soft.bend).abs() * smoothing < 1e-6);
            }
        }
    }

    #[test]
    fn without_smoothing_it_is_sharp() {
        for (r, value, slope) in [(-2.0, 0.0, 0.0), (3.0, 3.0, 1.0)] {
            let soft = soft_plus(r, 0.0);
            assert_eq!((soft.value, soft.slope, soft.bend), (value, slope, 0.0));
        }
        assert!(soft_plus(f64::NAN, 0.0).value.is_nan());
    }
}
