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
use crate::numerics::{EnvelopeFactor, EnvelopeMatrix, TiledFactor};
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
}

/// Decades below and above the balance of the traces that are searched.
const DECADES: [f64; 2] = [-11.0, 9.0];
/// Step of the first walk, decades.
const WALK: f64 = 1.0;
/// Parabolas after it: to about 0.05 of a decade, far finer than matters.
const PARABOLAS: usize = 3;
/// Decades that need not be told apart.
const CLOSE: f64 = 0.03;

/// A Cholesky factor in the form that suits its bandwidth.
#[derive(Debug, Clone)]
pub(in super::super) enum Factor {
    /// Narrow bands.
    Plain(EnvelopeFactor),
    /// Wide bands.
    Tiled(TiledFactor),
}

/// Half bandwidth from which tiles are faster.
const WIDE: usize = 128;

impl Factor {
    /// Factors a band matrix; `None` if it is not positive definite.
    pub(in super::super) fn new(matrix: &EnvelopeMatrix) -> Option<Self> {
        let last = matrix.order().saturating_sub(1);
        let width = last - matrix.first_column(last);
        if width < WIDE {
            matrix.factor().ok().map(Factor::Plain)
        } else {
            TiledFactor::new(matrix, width).ok().map(Factor::Tiled)
        }
    }

    /// Replaces b by the solution of `A x = b`.
    pub(in super::super) fn solve_in_place(&self, b: &mut [f64]) {
        match self {
            Factor::Plain(f) => f.solve_in_place(b),
            Factor::Tiled(f) => f.solve_in_place(b),
        }
    }

    /// `ln det A`.
    pub(in super::super) fn log_determinant(&self) -> f64 {
        match self {
            Factor::Plain(f) => f.pivots().map(f64::ln).sum(),
            Factor::Tiled(f) => f.pivots().map(f64::ln).sum(),
        }
    }
}

/// `a + λ b` for matrices of the same envelope.
pub(in super::super) fn blend(
    a: &EnvelopeMatrix,
    lambda: f64,
    b: &EnvelopeMatrix,
) -> EnvelopeMatrix {
    let mut sum = a.clone();
    sum.add_scaled(b, lambda);
    sum
}

/// Solves for all fields.
pub(in super::super) fn solve<const D: usize>(factor: &Factor, rhs: &[[f64; D]]) -> Vec<[f64; D]> {
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
    let factor = Factor::new(&blend(&normal.matrix, lambda, energy))?;
    let control = solve(&factor, &normal.rhs);
    let explained: f64 = control
        .iter()
        .zip(&normal.rhs)
        .flat_map(|(c, f)| c.iter().zip(f))
        .map(|(c, f)| c * f)
        .sum();
    let left = (normal.square - explained).max(normal.rounding + f64::MIN_POSITIVE);
    let order = normal.rhs.len();
    let degrees = normal.points.saturating_sub(model.free).max(1) as f64;
    let determinant = factor.log_determinant();
    let rank = order.saturating_sub(model.free) as f64;
    let criterion = model.components * (degrees * left.ln() + determinant - rank * lambda.ln());
    criterion.is_finite().then_some(Chosen {
        lambda,
        control,
        noise: (left / (degrees * model.components)).sqrt(),
        criterion,
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
        seen: Vec::new(),
        control,
    };
    search.try_at(start)?;
    let mut at = start;
    // Walk downhill, to the stiffer side first.
    for (step, end) in [(-WALK, low), (WALK, high)] {
        let mut reach = start;
        while (reach - end).abs() > 0.5 * WALK {
            reach += step;
            let better = search.try_at(reach)?;
            // Where nothing was solvable yet, further on may be.
            if !better && search.best.is_some() {
                break;
            }
            at = reach;
        }
        if at != start {
            break;
        }
    }
    search.parabolas(at)?;
    match (search.best, near) {
        (Some(best), _) => Ok(best),
        // What was solvable at another level or with other weights is not here.
        (None, Some(_)) => choose(normal, energy, model, (None, control)),
        (None, None) => Err(FitError::Numerical(
            "no spring stiffness gives a solvable system".into(),
        )),
    }
}

/// Order × half bandwidth² up to which a few more factors cost nothing beside
/// the points.
const CHEAP: f64 = 4e7;

/// The fit of all points when a sample has found λ: searched again nearby
/// where factors are cheap, taken over where they are dear.
///
/// # Errors
/// As [`choose`].
pub(in super::super) fn last<const D: usize>(
    normal: &Normal<D>,
    (energy, model): (&EnvelopeMatrix, Likelihood),
    lambda: f64,
    control: &dyn Control,
) -> Result<Chosen<D>, FitError> {
    let order = energy.order();
    let width = order.saturating_sub(1) - energy.first_column(order.saturating_sub(1));
    if order as f64 * (width as f64).powi(2) <= CHEAP {
        return choose(normal, energy, model, (Some(lambda), control));
    }
    fit_with(normal, energy, lambda, model)
        .ok_or_else(|| FitError::Numerical("the last level has no fit".into()))
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
    let factor = Factor::new(&blend(energy, small, mass))?;
    Some(factor.log_determinant() - free as f64 * small.ln())
}

/// ε of [`log_pseudo_determinant`] against the balance of traces.
const SMALL: f64 = 1e-11;

struct Search<'a, const D: usize, F: Fn(f64) -> Option<Chosen<D>>> {
    evaluate: F,
    best: Option<Chosen<D>>,
    seen: Vec<(f64, f64)>,
    control: &'a dyn Control,
}

impl<const D: usize, F: Fn(f64) -> Option<Chosen<D>>> Search<'_, D, F> {
    fn value(&mut self, decade: f64) -> Result<(f64, bool), FitError> {
        self.control.check()?;
        let Some(trial) = (self.evaluate)(decade) else {
            return Ok((f64::INFINITY, false));
        };
        let value = trial.criterion;
        self.seen.push((decade, value));
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

    /// Vertices of parabolas through three trials about the least one.
    fn parabolas(&mut self, middle: f64) -> Result<(), FitError> {
        let mut trials = Vec::new();
        for decade in [middle - WALK, middle, middle + WALK] {
            let known = self.seen.iter().find(|(d, _)| *d == decade).copied();
            trials.push(match known {
                Some(trial) => trial,
                None => (decade, self.value(decade)?.0),
            });
        }
        for _ in 0..PARABOLAS {
            let Some(vertex) = vertex(&trials) else { break };
            if trials.iter().any(|(d, _)| (d - vertex).abs() < CLOSE) {
                break;
            }
            trials.push((vertex, self.value(vertex)?.0));
            trials.sort_by(|a, b| a.0.total_cmp(&b.0));
            let least = (1..trials.len() - 1)
                .min_by(|a, b| trials[*a].1.total_cmp(&trials[*b].1))
                .unwrap_or(1);
            trials = trials[least - 1..=least + 1].to_vec();
        }
        Ok(())
    }
}

/// The vertex of the parabola through three trials in order, where it opens
/// upwards and lies between them.
fn vertex(trials: &[(f64, f64)]) -> Option<f64> {
    let [(a, fa), (b, fb), (c, fc)] = trials else {
        return None;
    };
    let (left, right) = ((fb - fa) / (b - a), (fc - fb) / (c - b));
    let bend = (right - left) / (c - a);
    let place = 0.5 * (a + b) - 0.5 * left / bend;
    (bend > 0.0 && place > *a && place < *c).then_some(place)
}
