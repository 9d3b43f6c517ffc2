//! Quasi-developable plates between a hull's profile curves.

pub mod outcome;
pub mod request;

pub use outcome::Outcome;
pub use request::Request;

use super::{Control, FitError};

/// Fits all plates of a hull.
///
/// # Errors
/// [`FitError::Invalid`] for unusable input, [`FitError::Stopped`] when the
/// control says so.
pub fn fit(_request: &Request, _control: &dyn Control) -> Result<Outcome, FitError> {
    Err(FitError::Numerical("not built yet".into()))
}

/// Everything that can be said about a request without fitting it: issues that
/// make it invalid, or the warnings that the fit would carry.
///
/// # Errors
/// [`FitError::Invalid`] with every issue found.
pub fn validate(_request: &Request) -> Result<Vec<String>, FitError> {
    Ok(Vec::new())
}
