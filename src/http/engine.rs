//! The queue's port to the methods: reads the stored body again, runs the
//! method, writes result and diagnostics.

use super::dto::ResultDocument;
use super::intake::{self, Submission};
use super::problem::{ApiError, FieldError};
use crate::jobs;
use crate::methods::hull_plates::{self, Outcome};
use crate::methods::{Control, FitError};

/// Runs the methods of this crate on bodies as they were posted.
#[derive(Debug, Clone, Copy, Default)]
pub struct Engine;

impl jobs::Engine for Engine {
    fn run(
        &self,
        _method: &str,
        input: &[u8],
        control: &dyn Control,
    ) -> Result<jobs::Product, jobs::EngineError> {
        // The body names the method itself; while there is one, reading it is
        // choosing it.
        run_with(hull_plates::fit, input, control)
    }
}

/// A fit, as [`hull_plates::fit`] is one.
pub type Fit = fn(&hull_plates::Request, &dyn Control) -> Result<Outcome, FitError>;

/// Reads a posted body, runs `fit` on it and writes what comes of it.
///
/// # Errors
/// As [`jobs::Engine::run`].
pub fn run_with(
    fit: Fit,
    input: &[u8],
    control: &dyn Control,
) -> Result<jobs::Product, jobs::EngineError> {
    let submission = intake::read_job(input).map_err(|e| invalid(&e))?;
    let outcome = fit(&submission.request, control).map_err(engine_error)?;
    product(&submission, input, &outcome)
}

fn product(
    submission: &Submission,
    input: &[u8],
    outcome: &Outcome,
) -> Result<jobs::Product, jobs::EngineError> {
    let document = ResultDocument::new(&submission.job, intake::sha256_hex(input), outcome);
    Ok(jobs::Product {
        result: json_line(&document)?,
        diagnostics: json_line(&document.diagnostics)?,
        verdict: if outcome.within_limits {
            jobs::Verdict::WithinLimits
        } else {
            jobs::Verdict::OutsideLimits
        },
        warnings: new_warnings(submission, outcome),
        message: outcome.summary.first().cloned().unwrap_or_default(),
    })
}

/// The warnings that the job did not get when it was accepted.
fn new_warnings(submission: &Submission, outcome: &Outcome) -> Vec<String> {
    let known = hull_plates::validate(&submission.request).unwrap_or_default();
    outcome
        .warnings
        .iter()
        .filter(|w| !known.contains(w))
        .cloned()
        .collect()
}

fn json_line(value: &impl serde::Serialize) -> Result<Vec<u8>, jobs::EngineError> {
    let mut bytes = serde_json::to_vec(value).map_err(|e| jobs::EngineError::Failed {
        code: "unwritable-result".into(),
        detail: format!("the result cannot be written as JSON: {e}"),
        diagnostics: None,
    })?;
    bytes.push(b'\n');
    Ok(bytes)
}

fn engine_error(error: FitError) -> jobs::EngineError {
    match error {
        FitError::Invalid(_) => invalid(&error.into()),
        FitError::Stopped(stop) => jobs::EngineError::Stopped(stop),
        FitError::Numerical(_) => jobs::EngineError::Failed {
            code: "numerical".into(),
            detail: error.to_string(),
            diagnostics: None,
        },
    }
}

fn invalid(error: &ApiError) -> jobs::EngineError {
    let errors: &[FieldError] = &error.errors;
    jobs::EngineError::Invalid {
        detail: error.detail.clone(),
        // Strings alone: writing them cannot fail, and an empty list is valid.
        errors_json: serde_json::to_string(errors).unwrap_or_else(|_| "[]".into()),
    }
}
