//! The page of the service for people: the list of jobs and the view of one.
//! Its parts are compiled in and ask this service alone, so that it works
//! without the internet; everything it shows comes from the `/v1` paths.

use super::Api;
use super::extract::Owner;
use super::problem::{Code, Success};
use super::respond::{self, File};
use crate::jobs::{JobId, QueueError};
use axum::extract::{Path, State};
use axum::http::{HeaderMap, header};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use bytes::Bytes;
use utoipa_axum::router::OpenApiRouter;
use uuid::Uuid;

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

/// The paths of the page. They are for browsers and stand in no contract, so
/// the OpenAPI document does not list them.
pub(super) fn routes() -> OpenApiRouter<Api> {
    OpenApiRouter::new()
        .route("/", get(index))
        .route("/jobs/{id}/view", get(view))
        .route("/page/{part}", get(part))
}

async fn index(headers: HeaderMap) -> Response {
    answer(HTML, INDEX, &headers)
}

async fn view(
    State(api): State<Api>,
    Owner(owner): Owner,
    Path(id): Path<String>,
    headers: HeaderMap,
) -> Response {
    let Ok(id) = Uuid::parse_str(&id) else {
        return no_such_job();
    };
    match api.queue.get(&owner, JobId::from(id)).await {
        Ok(_) => answer(HTML, VIEW, &headers),
        Err(QueueError::NotFound) => no_such_job(),
        Err(error) => super::problem::ApiError::from(error).into_response(),
    }
}

async fn part(Path(name): Path<String>, headers: HeaderMap) -> Response {
    match PARTS.iter().find(|(known, ..)| *known == name) {
        Some((_, kind, text)) => answer(kind, text, &headers),
        None => {
            super::problem::ApiError::new(Code::NotFound, format!("the page has no part {name:?}"))
                .into_response()
        }
    }
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
