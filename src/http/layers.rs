//! What every request passes, outermost first: [`finish`] (request id, log,
//! metrics, problem documents), compression of answers, panics, the time
//! limit, the size limit, decompression of bodies.

use super::Api;
use super::extract::Limits;
use super::problem::{ApiError, Code, PROBLEM_JSON};
use axum::Router;
use axum::body::Body;
use axum::extract::{MatchedPath, Request, State};
use axum::http::{HeaderName, HeaderValue, Method, header};
use axum::middleware::{self, Next};
use axum::response::{IntoResponse, Response};
use http_body_util::Limited;
use std::any::Any;
use tower_http::catch_panic::CatchPanicLayer;
use tower_http::compression::CompressionLayer;
use tower_http::compression::predicate::{DefaultPredicate, Predicate};
use tower_http::decompression::RequestDecompressionLayer;
use tracing::Instrument;
use uuid::Uuid;

/// The header that names a request in answers and in the log.
pub const REQUEST_ID: HeaderName = HeaderName::from_static("x-request-id");

/// Longest request id that is taken over from the client.
const MAX_ID_LENGTH: usize = 128;

/// Puts the layers around the routes.
pub fn wrap(routes: Router, api: &Api) -> Router {
    routes
        .layer(RequestDecompressionLayer::new())
        .layer(middleware::from_fn_with_state(api.limits, limit_size))
        .layer(middleware::from_fn_with_state(api.limits, limit_time))
        .layer(CatchPanicLayer::custom(answer_panic))
        .layer(CompressionLayer::new().compress_when(DefaultPredicate::new().and(may_compress)))
        .layer(middleware::from_fn_with_state(api.clone(), finish))
}

/// A strong entity tag promises the same bytes, and a range counts them: such
/// answers go out as they are.
fn may_compress(
    _: axum::http::StatusCode,
    _: axum::http::Version,
    headers: &axum::http::HeaderMap,
    _: &axum::http::Extensions,
) -> bool {
    let strong = |tag: &HeaderValue| tag.as_bytes().starts_with(b"\"");
    !headers.get(header::ETAG).is_some_and(strong)
}

async fn limit_size(State(limits): State<Limits>, request: Request, next: Next) -> Response {
    let announced = request.headers().get(header::CONTENT_LENGTH);
    let announced = announced
        .and_then(|n| n.to_str().ok())
        .and_then(|n| n.parse::<u64>().ok());
    if announced.is_some_and(|n| n > limits.wire_bytes as u64) {
        return limits.too_large().into_response();
    }
    let request = request.map(|body| Body::new(Limited::new(body, limits.wire_bytes)));
    next.run(request).await
}

async fn limit_time(State(limits): State<Limits>, request: Request, next: Next) -> Response {
    match tokio::time::timeout(limits.answer_time, next.run(request)).await {
        Ok(response) => response,
        Err(_) => {
            let detail = format!("no answer within {} s", limits.answer_time.as_secs());
            ApiError::new(Code::Timeout, detail)
                .retry_after(1)
                .into_response()
        }
    }
}

fn answer_panic(cause: Box<dyn Any + Send + 'static>) -> Response {
    let text = cause
        .downcast_ref::<String>()
        .map(String::as_str)
        .or_else(|| cause.downcast_ref::<&str>().copied())
        .unwrap_or("a panic without words");
    ApiError::internal(&format!("panic: {text}")).into_response()
}

/// Names the request, runs it, completes its problem document, logs and
/// counts it.
async fn finish(State(api): State<Api>, request: Request, next: Next) -> Response {
    let id = request_id(&request);
    let method = request.method().clone();
    let path = request.uri().path().to_owned();
    let route = request
        .extensions()
        .get::<MatchedPath>()
        .map(|m| m.as_str().to_owned());
    let timer = api.metrics.timer();
    let span = tracing::info_span!("request", %id, %method, path);
    let response = next.run(request).instrument(span.clone()).await;
    let mut response = complete(response, &method, &path, &id);
    let headers = response.headers_mut();
    if let Ok(id) = HeaderValue::from_str(&id) {
        headers.insert(REQUEST_ID, id);
    }
    headers.insert(
        header::X_CONTENT_TYPE_OPTIONS,
        HeaderValue::from_static("nosniff"),
    );
    let status = response.status().as_u16();
    let seconds = timer.observe(&method, route.as_deref(), status);
    span.in_scope(|| tracing::info!(status, ms = seconds * 1e3, "answered"));
    response
}

/// The client's id, if it is one to print, or a fresh one.
fn request_id(request: &Request) -> String {
    let printable = |id: &&str| {
        (1..=MAX_ID_LENGTH).contains(&id.len())
            && id
                .bytes()
                .all(|b| b.is_ascii_alphanumeric() || b"-_.:".contains(&b))
    };
    let given = request
        .headers()
        .get(REQUEST_ID)
        .and_then(|id| id.to_str().ok());
    given
        .filter(printable)
        .map_or_else(|| Uuid::new_v4().to_string(), str::to_owned)
}

/// Writes the problem document of a failed request.
fn complete(mut response: Response, method: &Method, path: &str, id: &str) -> Response {
    let error = match response.extensions_mut().remove::<ApiError>() {
        Some(error) => error,
        None => match bare_error(&response) {
            Some(error) => error,
            None => return response,
        },
    };
    let document = error.document(path, id);
    let mut bytes = serde_json::to_vec(&document).unwrap_or_default();
    bytes.push(b'\n');
    let length = bytes.len();
    let body = if method == Method::HEAD {
        Body::empty()
    } else {
        Body::from(bytes)
    };
    let (mut parts, _) = response.into_parts();
    parts.status = error.code.status();
    parts
        .headers
        .insert(header::CONTENT_TYPE, HeaderValue::from_static(PROBLEM_JSON));
    parts.headers.insert(header::CONTENT_LENGTH, length.into());
    parts
        .headers
        .insert(header::CACHE_CONTROL, HeaderValue::from_static("no-store"));
    parts.headers.remove(header::CONTENT_ENCODING);
    parts.headers.remove(header::ETAG);
    Response::from_parts(parts, body)
}

/// The error behind an answer that a library made without a document.
fn bare_error(response: &Response) -> Option<ApiError> {
    let status = response.status();
    if !(status.is_client_error() || status.is_server_error()) || is_page(response) {
        return None;
    }
    let code = Code::of_bare_status(status);
    let detail = match code {
        Code::MethodNotAllowed => {
            let allow = response
                .headers()
                .get(header::ALLOW)
                .and_then(|a| a.to_str().ok());
            format!("this path takes {}", allow.unwrap_or("other HTTP methods"))
        }
        Code::UnsupportedMediaType => "the Content-Encoding must be gzip or left out".to_owned(),
        Code::NotFound => "see /docs for what there is".to_owned(),
        other => other.title().to_owned(),
    };
    Some(ApiError::new(code, detail))
}

/// Whether the answer was written for a person to read.
fn is_page(response: &Response) -> bool {
    let kind = response.headers().get(header::CONTENT_TYPE);
    kind.is_some_and(|kind| kind.as_bytes().starts_with(b"text/html"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::http::problem::Problem;
    use crate::http::{Engine, Metrics};
    use crate::jobs::{Queue, QueueConfig};
    use axum::routing::get;
    use http_body_util::BodyExt;
    use std::sync::Arc;
    use tower::ServiceExt;

    async fn ask(routes: Router, path: &str) -> (Response<()>, Problem) {
        let metrics = Metrics::new();
        let config = QueueConfig {
            data_dir: None,
            workers: 0,
            ..QueueConfig::default()
        };
        let queue = Queue::open(config, Arc::new(Engine), metrics.clone())
            .await
            .unwrap();
        let api = Api::new(queue, metrics).unwrap();
        let request = Request::get(path).body(Body::empty()).unwrap();
        let response = wrap(routes, &api).oneshot(request).await.unwrap();
        let (parts, body) = response.into_parts();
        let bytes = body.collect().await.unwrap().to_bytes();
        assert!(bytes.ends_with(b"}\n"));
        (
            Response::from_parts(parts, ()),
            serde_json::from_slice(&bytes).unwrap(),
        )
    }

    async fn boom() {
        panic!("a secret");
    }

    #[tokio::test]
    async fn a_panic_is_a_problem_and_keeps_its_words() {
        let (response, problem) = ask(Router::new().route("/boom", get(boom)), "/boom").await;
        assert_eq!(problem.code, Code::Internal.slug());
        assert_eq!(response.status(), Code::Internal.status());
        assert!(!problem.detail.contains("secret"));
        assert_eq!(response.headers()[REQUEST_ID], problem.request_id.as_str());
    }

    #[tokio::test]
    async fn a_bare_error_gets_a_document() {
        for code in [
            Code::NotFound,
            Code::TooLarge,
            Code::Timeout,
            Code::Internal,
        ] {
            let bare = move || async move { code.status() };
            let (response, problem) = ask(Router::new().route("/x", get(bare)), "/x").await;
            assert_eq!(
                (response.status(), problem.code.as_str()),
                (code.status(), code.slug())
            );
            assert_eq!(problem.instance, "/x");
        }
    }
}
