//! The queue's port to the methods: reads the stored body again, runs the
//! method, writes result and diagnostics.

use super::intake;
use super::methods::hull_plates::{Fit, PlatesJob};
use super::methods::{Fitted, Job};
use super::problem::{ApiError, Code, FieldError};
use crate::jobs;
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
        // The body names the method itself.
        let job = intake::read_job(input).map_err(|e| invalid(&e))?;
        let fitted = job.fit(intake::sha256_hex(input), control);
        product(&*job, fitted.map_err(engine_error)?)
    }
}

/// Reads a posted job of `hull_plates`, runs `fit` on it in place of the method
/// and writes what comes of it: how tests see a fit fail.
///
/// # Errors
/// As [`jobs::Engine::run`].
pub fn run_with(
    fit: Fit,
    input: &[u8],
    control: &dyn Control,
) -> Result<jobs::Product, jobs::EngineError> {
    let (_, value) = intake::read_value(input).map_err(|e| invalid(&e))?;
    let job = PlatesJob::read(value)
        .map_err(|faults| invalid(&ApiError::at(Code::InvalidJob, faults)))?;
    let fitted = job.fit_with(fit, intake::sha256_hex(input), control);
    product(&job, fitted.map_err(engine_error)?)
}

fn product(job: &dyn Job, fitted: Fitted) -> Result<jobs::Product, jobs::EngineError> {
    // The warnings that the job did not get when it was accepted.
    let known = job.warnings().unwrap_or_default();
    let new = fitted.warnings.into_iter().filter(|w| !known.contains(w));
    Ok(jobs::Product {
        result: fitted.result,
        diagnostics: fitted.diagnostics,
        verdict: if fitted.within_limits {
            jobs::Verdict::WithinLimits
        } else {
            jobs::Verdict::OutsideLimits
        },
        warnings: new.collect(),
        message: fitted.message,
    })
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
