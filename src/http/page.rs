//! The page of the service for people: the list of jobs and the view of one.
//! Its parts are compiled in and ask this service alone, so that it works
//! without the internet; everything it shows comes from the `/v1` paths.

use super::Api;
use super::extract::{Asked, Nothing, Owner};
use super::openapi::{AnyFile, DocFiles, Everywhere};
use super::problem::{ApiError, Code, Success};
use super::respond::{self, File};
use crate::jobs::{JobId, QueueError};
use axum::extract::{Path, State};
use axum::http::{HeaderMap, header};
use axum::response::Response;
use bytes::Bytes;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

const HTML: &str = "text/html; charset=utf-8";
const SCRIPT: &str = "text/javascript; charset=utf-8";
const STYLE: &str = "text/css; charset=utf-8";

/// Nothing from elsewhere, no script or style within the HTML.
const POLICY: &str =
    "default-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

const INDEX: &str = include_str!("page/index.html");
const VIEW: &str = include_str!("page/view.html");
const NO_SUCH_JOB: &str = include_str!("page/no_such_job.html");

/// Scripts and style: name, media type, text.
const PARTS: [(&str, &str, &str); 7] = [
    ("style.css", STYLE, include_str!("page/style.css")),
    ("index.js", SCRIPT, include_str!("page/index.js")),
    ("view.js", SCRIPT, include_str!("page/view.js")),
    ("viewer.js", SCRIPT, include_str!("page/viewer.js")),
    ("model.js", SCRIPT, include_str!("page/model.js")),
    ("service.js", SCRIPT, include_str!("page/service.js")),
    ("icon.svg", "image/svg+xml", include_str!("page/icon.svg")),
];

/// The paths of the page.
pub(super) fn routes() -> OpenApiRouter<Api> {
    OpenApiRouter::new()
        .routes(routes!(index))
        .routes(routes!(view))
        .routes(routes!(part))
}

/// The page of all jobs
#[utoipa::path(
    get, path = "/", tag = "service", operation_id = "page",
    params(("If-None-Match" = Option<String>, Header,
        description = "The entity tag you know", nullable = false)),
    responses(
        (status = 200, description = "The page", content((String = "text/html"))),
        (status = 304, description = "Unchanged"),
        Everywhere,
    ),
)]
async fn index(_: Asked<Nothing>, headers: HeaderMap) -> Response {
    answer(HTML, INDEX, &headers)
}

/// The page of a job
///
/// Its surface to turn, its drawing, its words and its files.
#[utoipa::path(
    get, path = "/jobs/{id}/view", tag = "service", operation_id = "page_of_job",
    params(
        ("id" = uuid::Uuid, Path, description = "The job"),
        ("If-None-Match" = Option<String>, Header,
            description = "The entity tag you know", nullable = false),
    ),
    responses(
        (status = 200, description = "The page", content((String = "text/html"))),
        (status = 304, description = "Unchanged"),
        (status = 404, description = "No such job: a page with the way back",
            content((String = "text/html"))),
        Everywhere,
    ),
)]
async fn view(
    State(api): State<Api>,
    Owner(owner): Owner,
    Path(id): Path<String>,
    _: Asked<Nothing>,
    headers: HeaderMap,
) -> Result<Response, ApiError> {
    let Ok(id) = id.parse::<JobId>() else {
        return Ok(no_such_job());
    };
    match api.queue.get(&owner, id).await {
        Ok(_) => Ok(answer(HTML, VIEW, &headers)),
        Err(QueueError::NotFound) => Ok(no_such_job()),
        Err(error) => Err(error.into()),
    }
}

/// A part of the pages
#[utoipa::path(
    get, path = "/page/{part}", tag = "service", operation_id = "page_part",
    params(
        ("part" = String, Path, description = "Its name", example = "style.css"),
        ("If-None-Match" = Option<String>, Header,
            description = "The entity tag you know", nullable = false),
    ),
    responses(
        (status = 200, description = "The file", content((inline(AnyFile) = "*/*"))),
        (status = 304, description = "Unchanged"),
        DocFiles,
    ),
)]
async fn part(
    Path(name): Path<String>,
    _: Asked<Nothing>,
    headers: HeaderMap,
) -> Result<Response, ApiError> {
    let known = PARTS.iter().find(|(known, ..)| *known == name);
    let Some((_, kind, text)) = known else {
        let detail = format!("the page has no part {name:?}");
        return Err(ApiError::new(Code::NotFound, detail));
    };
    Ok(answer(kind, text, &headers))
}

fn answer(content_type: &'static str, text: &'static str, request: &HeaderMap) -> Response {
    let file = File {
        content_type,
        bytes: Bytes::from_static(text.as_bytes()),
        name: None,
        inline: true,
    };
    guarded(file.answer(request))
}

/// A page of its own rather than a problem document: a person asked.
fn no_such_job() -> Response {
    let text = Bytes::from_static(NO_SUCH_JOB.as_bytes());
    let mut response = guarded(respond::bytes_of(Success::Here, HTML, text));
    *response.status_mut() = Code::NotFound.status();
    response
}

fn guarded(response: Response) -> Response {
    let response = respond::with(response, header::CONTENT_SECURITY_POLICY, POLICY);
    // The entity tag is asked about each time: a new version shows at once.
    respond::with(response, header::CACHE_CONTROL, "no-cache")
}
