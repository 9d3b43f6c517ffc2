//! How stiff the springs should be, asked of the data themselves.
//!
//! The fit minimises `Σ wᵢ |qᵢ − b·c|² + λ cᵀPc`. Seen as a statistical model
//! (P the inverse covariance of a smooth random field, λ the ratio of the two
//! variances; Wahba 1990, §4.8; Wood 2011) the restricted likelihood of the
//! data has its maximum where
//!
//! `V(λ) = (n − m) ln D + ln det(A + λP) − r ln λ`,  `D = Σ w|q|² − fᵀc`,
//!
//! is least; m is the dimension of what the energy leaves free, r the rank of
//! P. It needs one Cholesky factor a trial, no trace, and its minimum is far
//! sharper than that of cross-validation. `σ² = D/(n − m)` is the noise.

use super::springs::Normal;
use crate::methods::FitError;
use crate::numerics::{EnvelopeFactor, EnvelopeMatrix};
use crate::solver::Control;

/// What V needs besides the matrices.
#[derive(Debug, Clone, Copy)]
pub(in super::super) struct Likelihood {
    /// Dimension of what the energy leaves free.
    pub(in super::super) free: usize,
    /// Independent noise components a point: 3 where points keep their
    /// parameters, 1 where they are feet (only the normal part is left).
    pub(in super::super) components: f64,
}

/// A fit with its stiffness.
#[derive(Debug, Clone)]
pub(in super::super) struct Chosen<const D: usize> {
    /// λ: weight of the energy against unit springs.
    pub(in super::super) lambda: f64,
    /// The control values.
    pub(in super::super) control: Vec<[f64; D]>,
    /// σ a component, in the unit of the values.
    pub(in super::super) noise: f64,
    /// The criterion, smaller is better (only for comparison on the same data
    /// and energy).
    pub(in super::super) criterion: f64,
    /// The factor of A + λP.
    pub(in super::super) factor: EnvelopeFactor,
}

/// Decades below and above the balance of the traces that are searched.
const DECADES: [f64; 2] = [-11.0, 9.0];
/// Step of the first walk, decades.
const WALK: f64 = 1.0;
/// Golden sections after it: to 0.05 of a decade, far finer than matters.
const SECTIONS: usize = 6;
/// Share of the data's own square below which a residual is rounding.
const ROUNDING: f64 = 1e-15;

/// `a + λ b` for matrices of the same envelope.
pub(in super::super) fn blend(
    a: &EnvelopeMatrix,
    lambda: f64,
    b: &EnvelopeMatrix,
) -> EnvelopeMatrix {
    let mut sum = a.clone();
    sum.add_scaled(lambda, b);
    sum
}

/// Solves for all fields.
pub(in super::super) fn solve<const D: usize>(
    factor: &EnvelopeFactor,
    rhs: &[[f64; D]],
) -> Vec<[f64; D]> {
    let mut control = rhs.to_vec();
    let mut column = vec![0.0; rhs.len()];
    for d in 0..D {
        for (x, r) in column.iter_mut().zip(rhs) {
            *x = r[d];
        }
        factor.solve_in_place(&mut column);
        for (c, x) in control.iter_mut().zip(&column) {
            c[d] = *x;
        }
    }
    control
}

/// The fit of a given λ; `None` where the matrix is not positive definite.
pub(in super::super) fn fit_with<const D: usize>(
    normal: &Normal<D>,
    energy: &EnvelopeMatrix,
    lambda: f64,
    model: Likelihood,
) -> Option<Chosen<D>> {
    let factor = blend(&normal.matrix, lambda, energy).factor().ok()?;
    let control = solve(&factor, &normal.rhs);
    let explained: f64 = control
        .iter()
        .zip(&normal.rhs)
        .flat_map(|(c, f)| c.iter().zip(f))
        .map(|(c, f)| c * f)
        .sum();
    let left = (normal.square - explained).max(ROUNDING * normal.square + f64::MIN_POSITIVE);
    let order = normal.rhs.len();
    let degrees = normal.points.saturating_sub(model.free).max(1) as f64;
    let determinant: f64 = factor.pivots().map(f64::ln).sum();
    let rank = order.saturating_sub(model.free) as f64;
    let criterion =
        model.components * (degrees * left.ln() + determinant - rank * lambda.ln());
    criterion.is_finite().then_some(Chosen {
        lambda,
        control,
        noise: (left / (degrees * model.components)).sqrt(),
        criterion,
        factor,
    })
}

/// The stiffness of greatest likelihood. `near`: a λ from a coarser level,
/// near which alone is searched.
///
/// # Errors
/// [`FitError::Stopped`]; [`FitError::Numerical`] when no λ gives a positive
/// definite system.
pub(in super::super) fn choose<const D: usize>(
    normal: &Normal<D>,
    energy: &EnvelopeMatrix,
    model: Likelihood,
    (near, control): (Option<f64>, &dyn Control),
) -> Result<Chosen<D>, FitError> {
    let trace = |m: &EnvelopeMatrix| m.diagonal().sum::<f64>();
    let middle = (trace(&normal.matrix) / trace(energy).max(f64::MIN_POSITIVE)).log10();
    let (start, low, high) = match near {
        Some(l) => (l.log10(), l.log10() - 3.0, l.log10() + 2.0),
        None => (middle, middle + DECADES[0], middle + DECADES[1]),
    };
    let mut search = Search {
        evaluate: |decade: f64| fit_with(normal, energy, 10f64.powf(decade), model),
        best: None,
        control,
    };
    search.try_at(start)?;
    let mut at = start;
    // Walk downhill, to the stiffer side first.
    for (step, end) in [(-WALK, low), (WALK, high)] {
        let mut reach = start;
        while (reach - end).abs() > 0.5 * WALK {
            reach += step;
            if !search.try_at(reach)? {
                break;
            }
            at = reach;
        }
        if at != start {
            break;
        }
    }
    search.golden(at - WALK, at + WALK)?;
    search
        .best
        .ok_or_else(|| FitError::Numerical("no spring stiffness gives a solvable system".into()))
}

/// `ln det⁺ P`, up to a constant of the net: what the criterion lacks when
/// energies are compared that leave the same polynomials free. With the mass
/// matrix M, `ln det(P + εM) − m ln ε` tends to it for small ε.
pub(in super::super) fn log_pseudo_determinant(
    energy: &EnvelopeMatrix,
    mass: &EnvelopeMatrix,
    free: usize,
) -> Option<f64> {
    let trace = |m: &EnvelopeMatrix| m.diagonal().sum::<f64>();
    let small = SMALL * trace(energy) / trace(mass).max(f64::MIN_POSITIVE);
    let factor = blend(energy, small, mass).factor().ok()?;
    let determinant: f64 = factor.pivots().map(f64::ln).sum();
    Some(determinant - free as f64 * small.ln())
}

/// ε of [`log_pseudo_determinant`] against the balance of traces.
const SMALL: f64 = 1e-11;

struct Search<'a, const D: usize, F: Fn(f64) -> Option<Chosen<D>>> {
    evaluate: F,
    best: Option<Chosen<D>>,
    control: &'a dyn Control,
}

impl<const D: usize, F: Fn(f64) -> Option<Chosen<D>>> Search<'_, D, F> {
    fn value(&mut self, decade: f64) -> Result<(f64, bool), FitError> {
        self.control.check()?;
        let Some(trial) = (self.evaluate)(decade) else {
            return Ok((f64::INFINITY, false));
        };
        let value = trial.criterion;
        let better = self.best.as_ref().is_none_or(|b| value < b.criterion);
        if better {
            self.best = Some(trial);
        }
        Ok((value, better))
    }

    /// Whether this is the best so far.
    fn try_at(&mut self, decade: f64) -> Result<bool, FitError> {
        Ok(self.value(decade)?.1)
    }

    fn golden(&mut self, low: f64, high: f64) -> Result<(), FitError> {
        let ratio = 0.5 * (5f64.sqrt() - 1.0);
        let (mut a, mut b) = (low, high);
        let (mut c, mut d) = (b - ratio * (b - a), a + ratio * (b - a));
        let (mut fc, mut fd) = (self.value(c)?.0, self.value(d)?.0);
        for _ in 0..SECTIONS {
            if fc < fd {
                (b, d, fd) = (d, c, fc);
                c = b - ratio * (b - a);
                fc = self.value(c)?.0;
            } else {
                (a, c, fc) = (c, d, fd);
                d = a + ratio * (b - a);
                fd = self.value(d)?.0;
            }
        }
        Ok(())
    }
}
