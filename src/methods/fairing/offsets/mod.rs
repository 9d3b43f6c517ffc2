//! Offset tables (stations × waterlines of half-breadths) faired as one
//! surface (x(u), y(u, v), z(v)): half-breadths alone move, so that stations
//! and waterlines stay in their planes and are fair together.

mod curves;
mod fair;
mod hull_outline;
mod input;
mod lines;
pub mod outcome;
pub mod request;
#[cfg(test)]
mod tests;

pub use outcome::Outcome;
pub use request::Request;

use super::super::{Control, FitError, Issue};

/// Fits.
///
/// # Errors
/// [`FitError::Invalid`] for an unusable table, [`FitError::Stopped`] when the
/// control says so.
pub fn fit(request: &Request, control: &dyn Control) -> Result<Outcome, FitError> {
    control.progress("reading", 0.0);
    let issues = validate(request);
    if !issues.is_empty() {
        return Err(FitError::Invalid(issues));
    }
    let faired = fair::fair(request, control)?;
    let [stations, waterlines] = curves::families(&faired)?;
    let buttocks = curves::buttocks(request, &faired)?;
    control.progress("done", 100.0);
    Ok(Outcome {
        summary: faired.surface.summary.clone(),
        notes: faired.notes,
        table: faired.table,
        slips: faired.slips,
        stations,
        waterlines,
        buttocks,
        surface: faired.surface,
    })
}

/// Every issue of a request; none: it can be fitted.
#[must_use]
pub fn validate(request: &Request) -> Vec<Issue> {
    input::issues(request)
}
