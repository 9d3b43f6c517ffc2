//! Closeness and fairness out, mirrors exact.

use super::problem::{MirroredFrames, Soft};
use crate::methods::curvature_net::net::Net;
use crate::solver::levenberg_marquardt::{Settings, minimize};
use crate::solver::{Control, LeastSquares, NormalEquations, Stop};

/// A net whose frames mirror each other.
#[derive(Debug, Clone, PartialEq)]
pub struct Spline {
    /// The net: circular quads, orthonormal frames.
    pub net: Net,
    /// The largest component of a mirror's residual.
    pub mirror: f64,
    /// The ends of the edge that has it.
    pub worst_edge: [usize; 2],
    /// Iterations of the solver, all runs together.
    pub iterations: usize,
}

impl Spline {
    /// Whether the mirrors are exact.
    #[must_use]
    pub fn is_exact(&self) -> bool {
        self.mirror <= EXACT
    }
}

/// Mirrors below this are exact: the certificates ask for 1e-9, and a long
/// chain of mirrors adds its residuals up.
pub const EXACT: f64 = 1e-11;

/// Closeness against the mirrors at the start.
const CLOSENESS: f64 = 0.1;
/// Fairness against the mirrors at the start: ways and turns are told more by
/// their neighbours than by the start, which lets the net move as a whole.
const FAIRNESS: f64 = 0.3;
/// What is left of both from run to run.
const FADING: f64 = 0.1;
/// Runs before the last, on the mirrors alone.
const RUNS: i32 = 2;
/// Steps of a run: closeness and fairness are linear in the unknowns and the
/// mirrors nearly so.
const STEPS: usize = 2;
/// Newton's iteration on the mirrors alone goes on by so many steps until the
/// mirrors are [`ENOUGH`]; it needs three or four.
const LAST_STEPS: usize = 3;
/// At most so often.
const LAST_RUNS: usize = 10;
/// Near rounding even on large nets, where the solver's own tests for the end
/// would still see something to gain.
const ENOUGH: f64 = 1e-13;

/// What the solver takes of making the cyclide spline and all from it, percent.
const SHARE: f64 = 75.0;

/// The cyclide spline nearest to a net of curvature lines.
///
/// # Errors
/// [`Stop`] when the control says so.
pub fn solve(start: &Net, control: &dyn Control) -> Result<Spline, Stop> {
    let nothing = Soft {
        closeness: 0.0,
        fairness: 0.0,
    };
    let mut problem = MirroredFrames::new(start, nothing);
    let mut x = vec![0.0; problem.dimension()];
    let mut iterations = 0;
    for run in 0..RUNS {
        control.progress("cyclides", SHARE * f64::from(run) / f64::from(RUNS + 1));
        let left = FADING.powi(run);
        problem.soft = Soft {
            closeness: CLOSENESS * left,
            fairness: FAIRNESS * left,
        };
        iterations += minimize(&problem, &mut x, &settings(STEPS), control)?.iterations;
    }
    control.progress("cyclides", SHARE * f64::from(RUNS) / f64::from(RUNS + 1));
    problem.soft = nothing;
    for _ in 0..LAST_RUNS {
        iterations += minimize(&problem, &mut x, &settings(LAST_STEPS), control)?.iterations;
        if problem.worst_mirror(&x).0 <= ENOUGH {
            break;
        }
    }
    let (mirror, worst_edge) = problem.worst_mirror(&x);
    Ok(Spline {
        net: problem.net(&x),
        mirror,
        worst_edge,
        iterations,
    })
}

fn settings(iterations: usize) -> Settings {
    Settings {
        iterations,
        gradient: 1e-15,
        step: 1e-15,
        reduction: 0.0,
        // The mirrors alone leave a family of nets free: the damping is what
        // chooses the nearest of it.
        damping: 1e-8,
        normal_equations: NormalEquations::Sparse,
        ..Settings::default()
    }
}
