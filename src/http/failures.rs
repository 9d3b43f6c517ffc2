//! From the errors of the layers beneath to [`ApiError`]: the queue's and the
//! methods', with their numbers and places.

use super::dto::job::JobError;
use super::problem::{ApiError, Code, FieldError};
use super::strict_json::escape;
use crate::jobs::{Job, QueueError};
use crate::methods::{FitError, Issue};
use std::time::Duration;

/// Asking about an active job again sooner than this tells nothing new, s.
const SOONEST_RETRY_S: f64 = 1.0;

/// Asking later than this keeps people waiting for nothing, s.
const LATEST_RETRY_S: f64 = 30.0;

/// When to ask about an active job again, in whole seconds.
#[must_use]
pub fn retry_seconds(job: &Job) -> u64 {
    let estimate = job.eta_s.unwrap_or(SOONEST_RETRY_S);
    let seconds = estimate.ceil().clamp(SOONEST_RETRY_S, LATEST_RETRY_S);
    // Between 1 and 30 by the clamp; a NaN estimate becomes 0, then 1.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    (seconds as u64).max(1)
}

impl From<QueueError> for ApiError {
    fn from(error: QueueError) -> Self {
        let detail = error.to_string();
        match error {
            QueueError::NotFound => ApiError::new(Code::JobNotFound, detail),
            QueueError::IdempotencyConflict => ApiError::new(Code::KeyReused, detail),
            QueueError::QueueFull { retry_after } => later(Code::QueueFull, detail, retry_after),
            QueueError::StorageFull { retry_after } => {
                later(Code::StorageFull, detail, retry_after)
            }
            QueueError::Draining { retry_after } => later(Code::Draining, detail, retry_after),
            QueueError::Unavailable { retry_after } => {
                later(Code::StoreUnavailable, detail, retry_after)
            }
            QueueError::NotReady(job) => not_ready(&job),
            QueueError::Failed(job) => failed(&job),
            QueueError::Dismissed(_) => ApiError::new(Code::JobDismissed, detail),
            QueueError::Expired => ApiError::new(Code::Expired, detail),
            QueueError::Store { .. } => ApiError::new(Code::Internal, detail),
            QueueError::InvalidCursor => ApiError::at(
                Code::InvalidQuery,
                vec![
                    FieldError::new("?cursor", "invalid-cursor", detail)
                        .hint("hand in \"next_cursor\" of the page before, unchanged"),
                ],
            ),
        }
    }
}

fn later(code: Code, detail: String, retry_after: Duration) -> ApiError {
    let whole = retry_after.as_secs() + u64::from(retry_after.subsec_nanos() > 0);
    ApiError::new(code, detail).retry_after(whole)
}

fn not_ready(job: &Job) -> ApiError {
    let detail = format!(
        "the job is {} ({}, {:.0} %); ask again, or with ?wait=55",
        job.status.as_str(),
        job.phase,
        job.progress
    );
    ApiError::new(Code::ResultNotReady, detail).retry_after(retry_seconds(job))
}

fn failed(job: &Job) -> ApiError {
    match job.failure.as_ref().map(JobError::from) {
        Some(failure) => {
            let mut error = ApiError::at(Code::JobFailed, failure.errors);
            error.detail = format!("{}: {}", failure.code, failure.detail);
            error
        }
        None => ApiError::new(Code::JobFailed, "the job failed"),
    }
}

impl From<FitError> for ApiError {
    fn from(error: FitError) -> Self {
        match error {
            FitError::Invalid(issues) => ApiError::at(
                Code::InvalidJob,
                issues.iter().map(FieldError::from).collect(),
            ),
            FitError::Stopped(stop) => {
                ApiError::new(Code::Timeout, format!("the check was {stop}"))
            }
            FitError::Numerical(detail) => ApiError::internal(&detail),
        }
    }
}

impl From<&Issue> for FieldError {
    fn from(issue: &Issue) -> Self {
        let pointer: String = issue
            .path
            .iter()
            .map(|s| format!("/{}", escape(s)))
            .collect();
        FieldError {
            hint: issue.hint.clone(),
            ..FieldError::new(pointer, issue.code, issue.message.clone())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_issue_keeps_its_place() {
        let issue = Issue {
            path: ["input", "profiles", "1", "points", "4"]
                .map(str::to_owned)
                .to_vec(),
            code: "repeated-point",
            message: "points 3 and 4 are the same".into(),
            hint: Some("leave one out".into()),
        };
        let error = ApiError::from(FitError::Invalid(vec![issue]));
        assert_eq!(error.code, Code::InvalidJob);
        assert_eq!(error.errors[0].pointer, "/input/profiles/1/points/4");
        assert_eq!(error.errors[0].hint.as_deref(), Some("leave one out"));
    }

    #[test]
    fn a_part_of_a_second_is_rounded_up() {
        let error = later(Code::QueueFull, String::new(), Duration::from_millis(1_001));
        assert_eq!(error.headers[0].0, "retry-after");
        assert_eq!(error.headers[0].1, "2");
    }
}
