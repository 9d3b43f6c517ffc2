//! Fair curves through points of the plane or of space.
//!
//! # The job
//! Points carry errors of measurement, of reading or of typing. Asked is the
//! fairest B-spline that moves no point beyond its tolerance; or, where no
//! tolerance is given, one as stiff as the noise of the points allows. "Fair"
//! is ∫ κ′² ds (in space ∫ κ′² + κ²τ² ds), 0 on lines and circles: see `energy`.
//!
//! # The way
//! 1. `input`: checks, unit scale, the plane of the points.
//! 2. Parameters: chord lengths of ordered points (`start`), or an order found
//!    by cells, spanning tree and longest path (`trace`).
//! 3. `free`: springs to the feet of the points (`springs`), the energy by
//!    Gauss–Newton (`relax`), the stiffness by restricted likelihood and then
//!    as great as the points do not refute (`stiffness`); as many spans as the
//!    shape needs (`net`).
//! 4. `slips`: points that the fair shape of the others does not expect.
//! 5. `within`: with tolerances, an interior point walk to the fairest curve
//!    within them. Its multipliers say which points hold the shape back; of
//!    many points only those that can do so take part (`members`).
//! 6. `report`, `fairness`: everything measured anew on the delivered curve.
//!
//! `paper` solves as Jing, Xi & Tang 1998 do, for comparison.
//!
//! # Reading the result
//! Without tolerances a move is the residual of an estimate; the estimate of
//! the noise is in the report. With tolerances most points stay clear of their
//! limits and about as many as the curve has waves lie on them.
//!
//! # Limits
//! * Minima are local: where points lie so far apart or scatter so much that
//!   several shapes explain them, the one near the first look is found.
//! * A tolerance below the noise of dense points cannot be kept by a curve that
//!   anyone would call fair: the result says how many points are beyond it.
//! * Unordered points must lie on one curve without crossings, its turns
//!   farther apart than the points scatter; parts and branches are refused.
//! * A slip at an end of the curve cannot be told from its shape, nor one on a
//!   sharp bend with a few points on it: there points that are right may be
//!   named.
//! * A tail at a loop is told from noise if it is some widest gaps long and has
//!   more than a hundredth of the points.
//! * Ends: tangent and curvature there rest on few points.

mod bends;
mod bounded;
mod cells;
mod checks;
mod contradictions;
mod energy;
mod extent;
mod fairness;
mod free;
mod holds;
mod input;
mod members;
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
mod walls;
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
    let traced = traced(request, prepared, &task, control)?;
    control.progress("fairing", 15.0);
    let solved = match request.options.solver {
        request::Solver::Own => solve::solve(request, &task, &traced, control)?,
        request::Solver::Paper => paper::solve(request, &task, &traced, control)?,
    };
    control.progress("measuring", 90.0);
    report::outcome(request, prepared, &traced, &solved, control)
}

/// Parameters for the points: by their order, or found.
fn traced<const D: usize>(
    request: &Request,
    prepared: &Prepared,
    task: &Task<D>,
    control: &dyn Control,
) -> Result<Traced, FitError> {
    /// Points from which cells say more than an order broken by slips.
    const MANY: usize = 150;
    let degree = input::degree_of(&request.options);
    let robust = request.options.robust;
    if !request.ordered {
        return trace::trace(&task.points, degree, (request.closed, robust), control);
    }
    let plain = task.knuckles.is_empty() && task.straight.is_empty();
    if robust && plain && task.points.len() >= MANY {
        let found = trace::trace(&task.points, degree, (prepared.closed, true), control);
        match found {
            Ok(mut traced) => {
                along_the_order(&mut traced);
                return Ok(traced);
            }
            Err(FitError::Stopped(stop)) => return Err(stop.into()),
            // The order holds what the places alone do not.
            Err(_) => {}
        }
    }
    let closed = prepared.closed == Some(true);
    let doubtful = start::standing_out(&task.points, closed);
    let (parameters, domain) = start::parameters_without(&task.points, closed, &doubtful);
    Ok(Traced {
        parameters,
        domain,
        closed,
        doubtful,
    })
}

/// Turns parameters round if most points run against them.
fn along_the_order(traced: &mut Traced) {
    let u = &traced.parameters;
    let forward = u.windows(2).filter(|w| w[1] > w[0]).count();
    if 2 * forward < u.len() {
        let [a, b] = traced.domain;
        traced.parameters.iter_mut().for_each(|u| *u = a + b - *u);
    }
}

/// Everything that is wrong with a request; empty if it can be fitted.
#[must_use]
pub fn validate(request: &Request) -> Vec<Issue> {
    match input::prepare(request) {
        Err(FitError::Invalid(issues)) => issues,
        _ => Vec::new(),
    }
}

#[cfg(test)]
mod tests;
