//! `/v1/jobs`: submit, list, follow, cancel, erase; the posted body again.

use super::Api;
use super::dto::job::{Job as JobAnswer, JobList, JobRequest, StatusWord, Validation};
use super::extract::{Asked, Given, Id, Nothing, Owner, Parameters, idempotency_key};
use super::failures::retry_seconds;
use super::intake;
use super::methods;
use super::openapi::{Ending, Inputs, Listing, OneJob, Submitting};
use super::problem::{ApiError, Success};
use super::references;
use super::respond;
use super::upload::{JobWithFile, Posted};
use crate::jobs::{Accepted, Job, ListQuery, NewJob, Status};
use axum::extract::State;
use axum::http::{HeaderMap, HeaderName, header};
use axum::response::{IntoResponse, Response};
use bytes::Bytes;
use std::time::Duration;
use utoipa::IntoParams;

/// Jobs on a page when nothing is said.
const DEFAULT_PAGE: u64 = 50;

/// Query of a submission.
#[derive(Debug, IntoParams)]
#[into_params(parameter_in = Query)]
pub(super) struct SubmitQuery {
    /// Seconds to wait for the job's end.
    #[param(minimum = 0, maximum = 55, value_type = Option<u32>, nullable = false)]
    wait: Option<Duration>,
    /// Only check the job; nothing is queued.
    #[param(value_type = Option<bool>, nullable = false)]
    validate_only: bool,
}

impl Parameters for SubmitQuery {
    const KNOWN: &'static [&'static str] = &["wait", "validate_only"];

    fn read(given: &mut Given) -> Self {
        SubmitQuery {
            wait: given.wait(),
            validate_only: given.flag("validate_only").unwrap_or(false),
        }
    }
}

/// Submit a job
///
/// A 200 or 202 means that the job is on disk. With `wait` the answer comes
/// when the job has ended, if it ends in time. With `validate_only` the job is
/// checked and not queued.
#[utoipa::path(
    post, path = "/v1/jobs", tag = "jobs", operation_id = "submit_job",
    params(
        SubmitQuery,
        ("Idempotency-Key" = Option<String>, Header,
            description = "Makes repeating the call harmless: the same key and body give the same job.",
            min_length = 1, max_length = 255, pattern = "^[!-~]+$", nullable = false),
    ),
    request_body(description = "The job, or a form with the job and a file of points or a mesh",
        content((JobRequest = "application/json"), (JobWithFile = "multipart/form-data"))),
    responses(
        (status = 200, description = "The job has ended (`wait`, or a replay), or is valid (`validate_only`)",
            content((JobOrValidation = "application/json")),
            headers(("Idempotency-Replayed" = String, description = "`true` when the key was known"))),
        (status = 202, description = "The job is on disk", body = JobAnswer,
            headers(
                ("Location" = String, description = "The job"),
                ("Retry-After" = String, description = "When to ask for it, seconds"),
                ("Idempotency-Replayed" = String, description = "`true` when the key was known"),
            )),
        Submitting,
    ),
)]
pub(super) async fn submit(
    State(api): State<Api>,
    Owner(owner): Owner,
    Asked(query): Asked<SubmitQuery>,
    headers: HeaderMap,
    Posted { body, notes }: Posted,
) -> Result<Response, ApiError> {
    let (body, found) = references::resolved(&api, &owner, body).await?;
    let sha = intake::sha256_hex(&body);
    let idempotency = idempotency_key(&headers, &sha)?;
    let (posted, warnings) = check(body.clone()).await?;
    let warnings = [notes, found, warnings].concat();
    if query.validate_only {
        let normalized = posted.normalized();
        return Ok(respond::json(
            Success::Here,
            &Validation {
                valid: true,
                warnings,
                normalized,
            },
        ));
    }
    let new = NewJob {
        method: posted.method().to_owned(),
        label: posted.header().label.map(str::to_owned),
        input: body,
        input_sha256: sha,
        budget: posted.header().budget.time(),
        idempotency,
        engine_version: super::ENGINE_VERSION.to_owned(),
        warnings,
    };
    let (job, replayed) = match api.queue.submit(&owner, new).await? {
        Accepted::New(job) => (job, false),
        Accepted::Replayed(job) => (job, true),
    };
    let job = match query.wait {
        Some(wait) if !job.status.is_ended() => api.queue.wait_ended(&owner, job.id, wait).await?,
        _ => job,
    };
    let success = if job.status.is_ended() {
        Success::Here
    } else {
        Success::Accepted
    };
    let mut response = job_response(success, &job);
    response = respond::with(response, header::LOCATION, &format!("/v1/jobs/{}", job.id));
    if replayed {
        let name = HeaderName::from_static("idempotency-replayed");
        response = respond::with(response, name, "true");
    }
    Ok(response)
}

/// Either answer of `POST /v1/jobs` with 200.
#[derive(serde::Serialize, utoipa::ToSchema)]
#[serde(untagged)]
#[allow(dead_code, clippy::large_enum_variant)] // A schema, never a value.
pub(super) enum JobOrValidation {
    /// The job, when it has ended.
    Job(JobAnswer),
    /// The check, with `validate_only`.
    Validation(Validation),
}

/// Reads and checks a job away from the threads that answer; also what the
/// method would warn of.
async fn check(body: Bytes) -> Result<(Box<dyn methods::Job>, Vec<String>), ApiError> {
    let work = move || {
        let posted = intake::read_job(&body)?;
        let warnings = posted.warnings()?;
        Ok((posted, warnings))
    };
    match tokio::task::spawn_blocking(work).await {
        Ok(checked) => checked,
        Err(lost) => Err(ApiError::internal(&lost)),
    }
}

/// A job with its entity tag, and when to ask again while it is active.
fn job_response(success: Success, job: &Job) -> Response {
    let response = respond::json(success, &JobAnswer::from(job));
    let response = respond::with(response, header::ETAG, &etag(job));
    let response = respond::with(response, header::CACHE_CONTROL, "no-cache");
    if job.status.is_ended() {
        response
    } else {
        respond::with(
            response,
            header::RETRY_AFTER,
            &retry_seconds(job).to_string(),
        )
    }
}

/// Weak: estimates may differ under one revision.
fn etag(job: &Job) -> String {
    format!("W/\"{}\"", job.revision)
}

/// Query of a list.
#[derive(Debug, IntoParams)]
#[into_params(parameter_in = Query)]
pub(super) struct ListParameters {
    /// Jobs on a page.
    #[param(minimum = 1, maximum = 200, default = 50, value_type = Option<u32>, nullable = false)]
    limit: u64,
    /// `next_cursor` of the page before.
    #[param(min_length = 1, max_length = 500, nullable = false)]
    cursor: Option<String>,
    /// Only jobs that stand there.
    #[param(inline, value_type = Option<StatusWord>, nullable = false)]
    status: Option<Status>,
    /// Only jobs of this method.
    #[param(min_length = 1, max_length = 50, nullable = false)]
    method: Option<String>,
    /// Only jobs with exactly this label.
    #[param(min_length = 1, max_length = 200, nullable = false)]
    label: Option<String>,
}

impl Parameters for ListParameters {
    const KNOWN: &'static [&'static str] = &["limit", "cursor", "status", "method", "label"];

    fn read(given: &mut Given) -> Self {
        let words = Status::ALL.map(|s| (s.as_str(), s));
        ListParameters {
            limit: given
                .whole("limit", 1..=ListQuery::MAX_LIMIT as u64)
                .unwrap_or(DEFAULT_PAGE),
            cursor: given.bounded_text("cursor", 1..=500),
            status: given.word("status", &words),
            method: given.bounded_text("method", 1..=50),
            label: given.bounded_text("label", 1..=200),
        }
    }
}

/// List jobs, newest first
#[utoipa::path(
    get, path = "/v1/jobs", tag = "jobs", operation_id = "list_jobs",
    params(ListParameters),
    responses(
        (status = 200, description = "A page of jobs", body = JobList,
            headers(("Link" = String, description = "`rel=next`: the next page"))),
        Listing,
    ),
)]
pub(super) async fn list(
    State(api): State<Api>,
    Owner(owner): Owner,
    Asked(asked): Asked<ListParameters>,
    uri: axum::http::Uri,
) -> Result<Response, ApiError> {
    let query = ListQuery {
        limit: usize::try_from(asked.limit).unwrap_or(ListQuery::MAX_LIMIT),
        cursor: asked.cursor,
        status: asked.status,
        method: asked.method,
        label: asked.label,
    };
    let page = api.queue.list(&owner, query).await?;
    let items = page.items.iter().map(Into::into).collect();
    let next = page.next_cursor;
    let link = next.as_deref().map(|cursor| next_link(&uri, cursor));
    let answer = respond::json(
        Success::Here,
        &JobList {
            items,
            next_cursor: next,
        },
    );
    let answer = respond::with(answer, header::CACHE_CONTROL, "no-cache");
    Ok(match link {
        Some(link) => respond::with(answer, header::LINK, &link),
        None => answer,
    })
}

/// The same query with another cursor.
fn next_link(uri: &axum::http::Uri, cursor: &str) -> String {
    let kept = uri.query().unwrap_or_default().split('&');
    let kept = kept.filter(|pair| !pair.is_empty() && !pair.starts_with("cursor="));
    let next = format!("cursor={cursor}");
    let query: Vec<&str> = kept.chain([next.as_str()]).collect();
    format!("<{}?{}>; rel=\"next\"", uri.path(), query.join("&"))
}

/// Query of paths that can wait.
#[derive(Debug, IntoParams)]
#[into_params(parameter_in = Query)]
pub(super) struct WaitQuery {
    /// Seconds to wait for the job's end; with `If-None-Match`, for its next
    /// change.
    #[param(minimum = 0, maximum = 55, value_type = Option<u32>, nullable = false)]
    pub(super) wait: Option<Duration>,
}

impl Parameters for WaitQuery {
    const KNOWN: &'static [&'static str] = &["wait"];

    fn read(given: &mut Given) -> Self {
        WaitQuery { wait: given.wait() }
    }
}

/// Follow a job
#[utoipa::path(
    get, path = "/v1/jobs/{id}", tag = "jobs", operation_id = "get_job",
    params(
        ("id" = uuid::Uuid, Path, description = "The job"),
        WaitQuery,
        ("If-None-Match" = Option<String>, Header, description = "The entity tag you know", nullable = false),
    ),
    responses(
        (status = 200, description = "The job as it stands", body = JobAnswer,
            headers(
                ("ETag" = String, description = "Changes with the job"),
                ("Retry-After" = String, description = "While active: when to ask again, seconds"),
            )),
        (status = 304, description = "Unchanged"),
        OneJob,
    ),
)]
pub(super) async fn get(
    State(api): State<Api>,
    Owner(owner): Owner,
    Id(id): Id,
    Asked(query): Asked<WaitQuery>,
    headers: HeaderMap,
) -> Result<Response, ApiError> {
    let mut job = api.queue.get(&owner, id).await?;
    let conditional = headers.contains_key(header::IF_NONE_MATCH);
    if let Some(wait) = query.wait.filter(|_| !job.status.is_ended()) {
        if !conditional {
            job = api.queue.wait_ended(&owner, id, wait).await?;
        } else if respond::matches(&headers, &etag(&job)) {
            job = api
                .queue
                .wait_change(&owner, id, job.revision, wait)
                .await?;
        }
    }
    if respond::matches(&headers, &etag(&job)) {
        return Ok(respond::unchanged(&etag(&job)));
    }
    Ok(job_response(Success::Here, &job))
}

/// Cancel a job
///
/// Harmless to repeat.
#[utoipa::path(
    post, path = "/v1/jobs/{id}/cancel", tag = "jobs", operation_id = "cancel_job",
    params(("id" = uuid::Uuid, Path, description = "The job")),
    responses(
        (status = 200, description = "It has ended", body = JobAnswer),
        (status = 202, description = "It was told to stop", body = JobAnswer),
        Ending,
    ),
)]
pub(super) async fn cancel(
    State(api): State<Api>,
    Owner(owner): Owner,
    Id(id): Id,
    _: Asked<Nothing>,
) -> Result<Response, ApiError> {
    let job = api.queue.cancel(&owner, id).await?;
    let success = if job.status.is_ended() {
        Success::Here
    } else {
        Success::Accepted
    };
    Ok(job_response(success, &job))
}

/// Erase a job
///
/// Stops it if it is active; erases its input and results.
#[utoipa::path(
    delete, path = "/v1/jobs/{id}", tag = "jobs", operation_id = "delete_job",
    params(("id" = uuid::Uuid, Path, description = "The job")),
    responses((status = 204, description = "Erased"), Ending),
)]
pub(super) async fn delete(
    State(api): State<Api>,
    Owner(owner): Owner,
    Id(id): Id,
    _: Asked<Nothing>,
) -> Result<Response, ApiError> {
    api.queue.delete(&owner, id).await?;
    Ok(Success::Erased.status().into_response())
}

/// The body as it was posted
#[utoipa::path(
    get, path = "/v1/jobs/{id}/input", tag = "results", operation_id = "get_job_input",
    params(("id" = uuid::Uuid, Path, description = "The job")),
    responses(
        (status = 200, description = "Byte for byte", body = JobRequest,
            headers(("ETag" = String, description = "SHA-256 of the body"))),
        (status = 304, description = "Unchanged"),
        Inputs,
    ),
)]
pub(super) async fn input(
    State(api): State<Api>,
    Owner(owner): Owner,
    Id(id): Id,
    _: Asked<Nothing>,
    headers: HeaderMap,
) -> Result<Response, ApiError> {
    let bytes = api.queue.input(&owner, id).await?;
    let etag = format!("\"{}\"", intake::sha256_hex(&bytes));
    if respond::matches(&headers, &etag) {
        return Ok(respond::unchanged(&etag));
    }
    let response = respond::bytes_of(Success::Here, "application/json", bytes);
    Ok(respond::with(response, header::ETAG, &etag))
}
