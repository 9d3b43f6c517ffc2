//! Quasi-developable plates between a hull's profile curves.

mod cubic_fit;
mod deliver;
mod diagnose;
mod exact;
mod field;
mod input;
mod model;
mod movable;
pub mod outcome;
mod paper;
mod path;
mod profile;
mod relaxed;
mod report;
pub mod request;
mod search;
mod solve;
mod task;
mod twist;

pub use outcome::Outcome;
pub use request::Request;

use super::{Control, FitError};

/// Fits all plates of a hull.
///
/// # Errors
/// [`FitError::Invalid`] for unusable input, [`FitError::Stopped`] when the
/// control says so.
pub fn fit(request: &Request, control: &dyn Control) -> Result<Outcome, FitError> {
    control.progress("reading", 0.0);
    let task = input::Task::new(request)?;
    control.progress("rulings", 5.0);
    let solved = solve::solve(request, &task, control)?;
    report::outcome(request, &task, &solved, control)
}

/// Everything that can be said about a request without fitting it: the
/// warnings that the fit would carry.
///
/// # Errors
/// [`FitError::Invalid`] with every issue found.
pub fn validate(request: &Request) -> Result<Vec<String>, FitError> {
    Ok(input::Task::new(request)?.warnings)
}
