//! Whether the service lives, is ready, and which one it is.

use super::Api;
use super::extract::{Asked, Nothing};
use super::openapi::{Everywhere, Readiness};
use super::problem::{ApiError, Code, FieldError, Success};
use super::respond;
use axum::extract::State;
use axum::http::header;
use axum::response::Response;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// A word about the service.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub(super) struct Alive {
    /// `ok`.
    status: String,
}

/// A service that is ready.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub(super) struct Ready {
    /// `ready`.
    status: String,
    /// Threads for fits; 0 for a process that only answers.
    workers: usize,
    /// Jobs that wait.
    queued: u64,
    /// Jobs that run.
    running: u64,
    /// Free space where the data are; null if unknown.
    disk_free_bytes: Option<u64>,
    /// The version of the SQLite library; null for a store in memory.
    sqlite_version: Option<String>,
}

/// Which service this is.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub(super) struct Version {
    /// `mouldloft`.
    name: String,
    /// Its release.
    version: String,
    /// The version that results name.
    engine_version: String,
    /// The contract's version.
    api: String,
}

/// The process answers
#[utoipa::path(
    get, path = "/livez", tag = "service", operation_id = "livez",
    responses((status = 200, description = "Alive", body = Alive), Everywhere),
)]
pub(super) async fn livez(_: Asked<Nothing>) -> Response {
    fresh(respond::json(
        Success::Here,
        &Alive {
            status: "ok".into(),
        },
    ))
}

/// The service takes jobs
///
/// 503 with the reasons when the store cannot be written, the disk is nearly
/// full, no worker has shown life for 15 s, or the service is going down.
#[utoipa::path(
    get, path = "/readyz", tag = "service", operation_id = "readyz",
    responses((status = 200, description = "Ready", body = Ready), Readiness),
)]
pub(super) async fn readyz(
    State(api): State<Api>,
    _: Asked<Nothing>,
) -> Result<Response, ApiError> {
    let health = api.queue.health().await;
    let reasons = health.reasons();
    if !reasons.is_empty() {
        let errors = reasons
            .into_iter()
            .map(|r| FieldError::new("", "not-ready", r));
        return Err(ApiError::at(Code::NotReady, errors.collect()).retry_after(5));
    }
    Ok(fresh(respond::json(
        Success::Here,
        &Ready {
            status: "ready".into(),
            workers: health.workers,
            queued: health.accepted,
            running: health.running,
            disk_free_bytes: health.disk_free_bytes,
            sqlite_version: health.sqlite_version,
        },
    )))
}

/// Which service this is
#[utoipa::path(
    get, path = "/version", tag = "service", operation_id = "version",
    responses((status = 200, description = "The version", body = Version), Everywhere),
)]
pub(super) async fn version(_: Asked<Nothing>) -> Response {
    respond::json(
        Success::Here,
        &Version {
            name: env!("CARGO_PKG_NAME").into(),
            version: env!("CARGO_PKG_VERSION").into(),
            engine_version: super::ENGINE_VERSION.into(),
            api: "v1".into(),
        },
    )
}

fn fresh(response: Response) -> Response {
    respond::with(response, header::CACHE_CONTROL, "no-store")
}
