//! Compares an analytic Jacobian with central differences, as every problem's
//! test does.

use super::{Blocks, LeastSquares};

/// The worst disagreement between analytic and numerical derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Disagreement {
    /// Residual index.
    pub residual: usize,
    /// Unknown index.
    pub unknown: usize,
    /// From the problem.
    pub analytic: f64,
    /// From central differences.
    pub numerical: f64,
    /// |analytic − numerical| / (1 + |numerical|).
    pub relative: f64,
}

/// The largest relative disagreement at `x`, from central differences with
/// `step` relative to `1 + |x|`: expect about step² plus 1e-16 / step.
#[must_use]
pub fn worst_disagreement(problem: &dyn LeastSquares, x: &[f64], step: f64) -> Disagreement {
    let analytic = dense_jacobian(problem, x);
    let mut worst = Disagreement {
        residual: 0,
        unknown: 0,
        analytic: 0.0,
        numerical: 0.0,
        relative: 0.0,
    };
    for unknown in 0..x.len() {
        let h = step * (1.0 + x[unknown].abs());
        let shifted = |sign: f64| {
            let mut y = x.to_vec();
            y[unknown] += sign * h;
            residuals(problem, &y)
        };
        let (up, down) = (shifted(1.0), shifted(-1.0));
        for residual in 0..up.len() {
            let numerical = (up[residual] - down[residual]) / (2.0 * h);
            let analytic = analytic[residual][unknown];
            let relative = (analytic - numerical).abs() / (1.0 + numerical.abs());
            // NaN is the worst disagreement.
            if relative > worst.relative || relative.is_nan() {
                worst = Disagreement {
                    residual,
                    unknown,
                    analytic,
                    numerical,
                    relative,
                };
            }
        }
    }
    worst
}

fn residuals(problem: &dyn LeastSquares, x: &[f64]) -> Vec<f64> {
    let mut blocks = Blocks::default();
    problem.evaluate(x, &mut blocks);
    blocks.residuals().to_vec()
}

fn dense_jacobian(problem: &dyn LeastSquares, x: &[f64]) -> Vec<Vec<f64>> {
    let mut blocks = Blocks::default();
    blocks.reset(true);
    problem.evaluate(x, &mut blocks);
    let mut rows = Vec::new();
    for block in blocks.iter() {
        for row in block.jacobian.chunks_exact(block.columns.len()) {
            let mut dense = vec![0.0; x.len()];
            for (c, j) in block.columns.iter().zip(row) {
                dense[*c] += j;
            }
            rows.push(dense);
        }
    }
    rows
}
