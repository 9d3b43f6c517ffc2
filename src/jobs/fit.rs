//! One fit on a thread of the pool: run the engine, catch what it throws, and
//! say how the attempt ended.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};

use bytes::Bytes;
use tracing::{error, warn};
use uuid::Uuid;

use super::control::{FitControl, Why};
use super::core::{Core, bump};
use super::engine::{EngineError, Product};
use super::model::{Failure, Job};
use super::store::{End, Outcome, StoreError};
use crate::methods::Stop;

/// Runs the engine for one claimed job. `None` if nothing is to be written:
/// the job is somebody else's by now.
pub(super) fn run(
    core: &Core,
    job: &Job,
    input: &Result<Bytes, StoreError>,
    control: &FitControl,
) -> Option<End> {
    let input = match input {
        Ok(input) => input,
        Err(reason) => return Some(end_with(control, 0.0, unreadable(job, reason))),
    };
    let begun = core.clock.monotonic();
    // Nothing of ours is left half-done by a panic: the engine is a pure
    // function, and what it shares with us are atomics and whole values.
    let done = catch_unwind(AssertUnwindSafe(|| {
        core.engine.run(&job.method, input, control)
    }));
    let solve_ms = (core.clock.monotonic() - begun).as_secs_f64() * 1000.0;
    let outcome = match done {
        Ok(Ok(product)) => successful(product),
        Ok(Err(error)) => stopped_or_failed(error, control)?,
        Err(payload) => {
            bump(&core.counters.panics);
            panicked(job, payload.as_ref())
        }
    };
    Some(end_with(control, solve_ms, outcome))
}

/// How a job ends whose fit does not obey; `None` if nothing is to be written.
pub(super) fn overdue(control: &FitControl, solve_ms: f64) -> Option<End> {
    let outcome = match control.why() {
        None | Some(Why::OutOfTime) => over_budget(),
        Some(Why::Cancelled) => Outcome::Dismissed,
        Some(Why::LeaseLost | Why::GivenBack) => return None,
    };
    Some(end_with(control, solve_ms, outcome))
}

/// How a job ends whose end the store does not take.
pub(super) fn not_kept(control: &FitControl, solve_ms: f64, reason: &StoreError) -> End {
    let reference = Uuid::new_v4();
    error!(%reference, job = %control.fence().id, %reason, "a result cannot be stored");
    let outcome = failed(Failure {
        code: "result-not-stored".to_owned(),
        detail: "the fit ended, but its result could not be stored".to_owned(),
        reference: Some(reference),
        errors_json: None,
    });
    end_with(control, solve_ms, outcome)
}

fn end_with(control: &FitControl, solve_ms: f64, outcome: Outcome) -> End {
    let last = control.beat();
    End {
        outcome,
        solve_ms,
        phase: last.phase,
        progress: last.progress,
    }
}

fn successful(product: Product) -> Outcome {
    Outcome::Successful {
        result: Bytes::from(product.result),
        diagnostics: Bytes::from(product.diagnostics),
        verdict: product.verdict,
        warnings: product.warnings,
        message: product.message,
    }
}

fn failed(failure: Failure) -> Outcome {
    Outcome::Failed {
        failure,
        diagnostics: None,
    }
}

fn plain(code: &str, detail: impl Into<String>) -> Outcome {
    failed(Failure {
        code: code.to_owned(),
        detail: detail.into(),
        reference: None,
        errors_json: None,
    })
}

fn over_budget() -> Outcome {
    plain(
        "budget-exceeded",
        "the fit used up its time budget; ask for more time or a simpler fit",
    )
}

/// The control knows why a fit was stopped better than the fit does.
fn stopped_or_failed(error: EngineError, control: &FitControl) -> Option<Outcome> {
    Some(match (error, control.why()) {
        (EngineError::Stopped(_), Some(Why::LeaseLost | Why::GivenBack)) => return None,
        (EngineError::Stopped(_), Some(Why::Cancelled)) => Outcome::Dismissed,
        (EngineError::Stopped(_), Some(Why::OutOfTime))
        | (EngineError::Stopped(Stop::OutOfTime), None) => over_budget(),
        (EngineError::Stopped(Stop::Cancelled), None) => {
            warn!(job = %control.fence().id, "a fit stopped unasked");
            plain(
                "stopped-unasked",
                "the fit stopped though nobody asked it to",
            )
        }
        (
            EngineError::Invalid {
                detail,
                errors_json,
            },
            _,
        ) => failed(Failure {
            code: "invalid-input".to_owned(),
            detail,
            reference: None,
            errors_json: Some(errors_json),
        }),
        (
            EngineError::Failed {
                code,
                detail,
                diagnostics,
            },
            _,
        ) => Outcome::Failed {
            failure: Failure {
                code,
                detail,
                reference: None,
                errors_json: None,
            },
            diagnostics: diagnostics.map(Bytes::from),
        },
    })
}

/// The backtrace was logged by the hook of [`super::pool`].
fn panicked(job: &Job, payload: &(dyn Any + Send)) -> Outcome {
    let reference = Uuid::new_v4();
    let said = payload
        .downcast_ref::<&str>()
        .copied()
        .or_else(|| payload.downcast_ref::<String>().map(String::as_str))
        .unwrap_or("something that is no text");
    error!(%reference, job = %job.id, method = %job.method, panic = said, "a fit panicked");
    failed(Failure {
        code: "worker-panic".to_owned(),
        detail: format!("the fit broke down by a defect of ours; please quote {reference}"),
        reference: Some(reference),
        errors_json: None,
    })
}

fn unreadable(job: &Job, reason: &StoreError) -> Outcome {
    let reference = Uuid::new_v4();
    error!(%reference, job = %job.id, %reason, "an input cannot be read back");
    failed(Failure {
        code: "input-unreadable".to_owned(),
        detail: format!("the stored input cannot be read back; please quote {reference}"),
        reference: Some(reference),
        errors_json: None,
    })
}
