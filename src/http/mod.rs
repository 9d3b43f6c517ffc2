//! The HTTP contract: an axum router in which every path is registered once,
//! for the service and for its OpenAPI document.
//!
//! ```text
//! layers (id, log, problem documents, compression, panics, time, size)
//!   └ routes: jobs results artifacts verify methods examples health docs metrics page
//!       ├ extract, intake: from a request to a value, strictly
//!       │    strict_json → schema_check → dto → methods::…::Request
//!       └ respond, problem, failures: from a value or an error to an answer
//! engine: the queue's port to the methods, over the same intake
//! ```
//!
//! Rules: a handler parses, calls and answers; only [`problem`] picks status
//! codes; bounds of a job are written once, in the DTO's schema, which is
//! published, compiled and checked ([`schema_check`]).
//!
//! Limits: one tenant (see [`extract::Owner`]); files are written at request, and
//! only those asked for lately are kept; no streams.

// utoipa's attribute macros name types by paths that the lint finds too long.
#![allow(unused_qualifications)]

pub mod did_you_mean;
pub mod dto;
pub mod engine;
pub mod examples;
pub mod extract;
pub mod failures;
pub mod intake;
pub mod methods;
pub mod metrics;
pub mod openapi;
pub mod problem;
pub mod respond;
pub mod schema_check;
pub mod strict_json;
pub mod upload;

mod archive;
mod artifacts;
mod docs;
mod file_query;
mod health;
mod jobs;
mod layers;
mod page;
mod references;
mod results;
mod verify;
mod written;

pub use docs::Document;
pub use engine::Engine;
pub use extract::Limits;
pub use metrics::Metrics;

use crate::jobs::Queue;
use axum::Router;
use axum::extract::{Request, State};
use axum::response::{IntoResponse, Response};
use problem::{ApiError, Code};
use std::sync::Arc;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// The version that jobs and results name.
pub const ENGINE_VERSION: &str = env!("CARGO_PKG_VERSION");

/// What the handlers share. Cloning is cheap.
#[derive(Clone)]
pub struct Api {
    /// The jobs.
    pub queue: Queue,
    /// The figures.
    pub metrics: Arc<Metrics>,
    /// Bounds on requests.
    pub limits: Limits,
    document: Document,
    written: Arc<written::Written>,
}

impl Api {
    /// The service over a queue, with the metrics that the queue meters into.
    ///
    /// # Errors
    /// The OpenAPI document cannot be written (a fault of this crate).
    pub fn new(queue: Queue, metrics: Arc<Metrics>) -> Result<Api, String> {
        let document = Document::write(&document())?;
        Ok(Api {
            queue,
            metrics,
            limits: Limits::default(),
            document,
            written: Arc::default(),
        })
    }

    /// The same with other bounds.
    #[must_use]
    pub fn with_limits(self, limits: Limits) -> Api {
        Api { limits, ..self }
    }
}

/// The service as a router, layers included.
pub fn router(api: Api) -> Router {
    let (routes, _) = all_routes().split_for_parts();
    let routes = routes.fallback(nothing_here).with_state(api.clone());
    layers::wrap(routes, &api)
}

/// The OpenAPI document.
#[must_use]
pub fn document() -> utoipa::openapi::OpenApi {
    let (_, mut document) = all_routes().split_for_parts();
    openapi::finish(&mut document);
    document
}

fn all_routes() -> OpenApiRouter<Api> {
    OpenApiRouter::with_openapi(openapi::head())
        .routes(routes!(jobs::submit, jobs::list))
        .routes(routes!(jobs::get, jobs::delete))
        .routes(routes!(jobs::cancel))
        .routes(routes!(jobs::input))
        .routes(routes!(results::result))
        .routes(routes!(results::result_json))
        .routes(routes!(results::result_obj))
        .routes(routes!(results::result_stl))
        .routes(routes!(results::result_ply))
        .routes(routes!(results::result_glb))
        .routes(routes!(results::result_csv))
        .routes(routes!(results::result_svg))
        .routes(routes!(results::result_step))
        .routes(routes!(results::result_igs))
        .routes(routes!(results::result_dxf))
        .routes(routes!(results::result_zip))
        .routes(routes!(artifacts::list))
        .routes(routes!(artifacts::get))
        .routes(routes!(results::diagnostics))
        .routes(routes!(verify::verify))
        .merge(methods::routes())
        .merge(examples::routes())
        .merge(page::routes())
        .routes(routes!(health::livez))
        .routes(routes!(health::readyz))
        .routes(routes!(health::version))
        .routes(routes!(metrics::get_metrics))
        .routes(routes!(docs::yaml))
        .routes(routes!(docs::json))
        .routes(routes!(docs::docs))
        .routes(routes!(docs::page))
        .routes(routes!(docs::part))
}

/// The answer at paths that do not exist; a result in an unknown format says
/// which there are.
async fn nothing_here(State(_): State<Api>, request: Request) -> Response {
    let path = request.uri().path();
    let file = path
        .strip_prefix("/v1/jobs/")
        .and_then(|rest| rest.split_once('/'));
    match file.and_then(|(_, file)| file.strip_prefix("result.")) {
        Some(extension) if !extension.is_empty() => results::no_such_format(extension),
        _ => ApiError::new(Code::NotFound, "see /docs for what there is"),
    }
    .into_response()
}
