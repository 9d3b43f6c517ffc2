//! Fair curves through points of the plane or of space.

mod cells;
mod energy;
mod fairness;
mod free;
mod holds;
mod input;
mod net;
pub mod outcome;
mod paper;
mod relax;
mod report;
pub mod request;
mod sentences;
mod slips;
mod solve;
mod space;
mod springs;
mod start;
mod stiffness;
mod trace;
mod tree;
mod within;

pub use outcome::Outcome;
pub use request::Request;

use crate::methods::{FitError, Issue};
use crate::solver::Control;
use input::{Prepared, Task};
use solve::Traced;

/// Fits a fair curve.
///
/// # Errors
/// [`FitError::Invalid`] for unusable input, [`FitError::Stopped`] when the
/// control says so, [`FitError::Numerical`] where the points and wishes leave
/// no curve.
pub fn fit(request: &Request, control: &dyn Control) -> Result<Outcome, FitError> {
    control.progress("reading", 0.0);
    let prepared = input::prepare(request)?;
    match prepared.dimension {
        2 => fit_in::<2>(request, &prepared, control),
        _ => fit_in::<3>(request, &prepared, control),
    }
}

fn fit_in<const D: usize>(
    request: &Request,
    prepared: &Prepared,
    control: &dyn Control,
) -> Result<Outcome, FitError> {
    let task = Task::<D>::new(request, prepared);
    control.progress("ordering", 5.0);
    let traced = if request.ordered {
        let closed = prepared.closed == Some(true);
        let doubtful = start::standing_out(&task.points, closed);
        let (parameters, domain) = start::parameters_without(&task.points, closed, &doubtful);
        Traced {
            parameters,
            domain,
            closed,
            doubtful,
        }
    } else {
        let degree = input::degree_of(&request.options);
        let hints = (request.closed, request.options.robust);
        trace::trace(&task.points, degree, hints, control)?
    };
    control.progress("fairing", 15.0);
    let solved = match request.options.solver {
        request::Solver::Own => solve::solve(request, &task, &traced, control)?,
        request::Solver::Paper => paper::solve(request, &task, &traced, control)?,
    };
    control.progress("measuring", 90.0);
    report::outcome(request, prepared, &traced, &solved, control)
}

/// Everything that is wrong with a request; empty if it can be fitted.
#[must_use]
pub fn validate(request: &Request) -> Vec<Issue> {
    match input::prepare(request) {
        Err(FitError::Invalid(issues)) => issues,
        _ => Vec::new(),
    }
}
