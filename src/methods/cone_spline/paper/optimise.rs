//! The minimisation with growing weights (sec. 2.2.3, 3.2).

use super::cone::Cone;
use super::objective::{Data, Objective};
use super::ruled::Ruled;
use crate::geometry::SplineError;
use crate::methods::{Control, FitError};
use crate::solver::lbfgs;

/// λ₃ and λ₄ at the start, and by how much they grow.
const WEIGHT: f64 = 100.0;
const GROWTH: f64 = 10.0;
/// They grow when a round changes the constraints by less than this.
const STALLED: f64 = 1e-4;
/// The end: so much is left of the constraints.
const KEPT: f64 = 1e-5;
/// L-BFGS steps of a round. The paper compares two iterations; one step of
/// L-BFGS hardly changes anything, and the weights would be at their end
/// before the surface has come near the strip. With 150 errors are up to 1.7
/// times as large.
const STEPS: usize = 600;
/// Rounds at most: the weights are then far beyond what rounding allows.
const ROUNDS: usize = 12;
/// A round ends where steps gain less than this share.
const REDUCTION: f64 = 1e-6;

/// What came out.
#[derive(Debug, Clone)]
pub(super) struct Optimised {
    pub(super) surface: Ruled,
    pub(super) cones: Vec<Cone>,
    /// L-BFGS steps, all rounds.
    pub(super) iterations: usize,
    /// What is left of the constraints.
    pub(super) broken: f64,
    /// Why the last round ended.
    pub(super) termination: &'static str,
}

impl Optimised {
    /// Whether the constraints are kept as the paper asks.
    pub(super) fn is_conical(&self) -> bool {
        self.broken < KEPT
    }
}

/// Moves a surface and the cones of its regions until the regions are conical.
///
/// # Errors
/// [`FitError::Stopped`]; [`FitError::Numerical`] where control points cease
/// to be finite.
pub(super) fn optimise(
    (surface, cones): (&Ruled, &[Cone]),
    breaks: &[f64],
    data: Data<'_>,
    control: &dyn Control,
) -> Result<Optimised, FitError> {
    let mut objective = Objective::new(surface, breaks, data, WEIGHT);
    let mut x = Objective::gather(surface, cones);
    let settings = lbfgs::Settings {
        iterations: STEPS,
        reduction: REDUCTION,
        ..lbfgs::Settings::default()
    };
    let (mut iterations, mut before) = (0, objective.broken(&x));
    let mut termination = "not-needed";
    for round in 0..ROUNDS {
        let report = lbfgs::minimize(&mut objective, &mut x, &settings, control)?;
        iterations += report.iterations;
        termination = report.termination.as_str();
        let broken = objective.broken(&x);
        control.progress("fitting", 40.0 + 50.0 * round as f64 / ROUNDS as f64);
        if broken < KEPT {
            before = broken;
            break;
        }
        if (before - broken).abs() < STALLED {
            objective.weight *= GROWTH;
        }
        before = broken;
    }
    Ok(Optimised {
        surface: objective.surface(&x).map_err(failed)?,
        cones: objective.cones(&x),
        iterations,
        broken: before,
        termination,
    })
}

/// A spline that could not be made.
pub(super) fn failed(fault: SplineError) -> FitError {
    FitError::Numerical(format!("the paper's surface broke down: {fault}"))
}
