//! Every way in which a request can fail, as RFC 9457 problem documents, and
//! the only place that picks a status code.
//!
//! A handler returns [`ApiError`]; its [`Code`] decides status, title and type
//! through exhaustive matches, so a new kind of failure does not compile until
//! it has them. The document is completed (`instance`, `request_id`) and
//! written by the outermost layer around the router, which also turns bare
//! error answers of the libraries beneath into problem documents.

use axum::http::{HeaderName, HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Media type of a problem document.
pub const PROBLEM_JSON: &str = "application/problem+json";

/// Most places a problem document lists; more would help nobody.
pub const MAX_LISTED_ERRORS: usize = 50;

macro_rules! codes {
    ($( $(#[$doc:meta])* $name:ident = $slug:literal, $title:literal; )*) => {
        /// The closed list of failures.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Code {
            $( $(#[$doc])* $name, )*
        }

        impl Code {
            /// All codes, in the order of their definition.
            pub const ALL: &'static [Code] = &[ $( Code::$name, )* ];

            /// The stable word for programmes.
            #[must_use]
            pub fn slug(self) -> &'static str {
                match self { $( Code::$name => $slug, )* }
            }

            /// The short human title, the same for every occurrence.
            #[must_use]
            pub fn title(self) -> &'static str {
                match self { $( Code::$name => $title, )* }
            }
        }
    };
}

codes! {
    /// The body is not JSON, or not the JSON that is accepted.
    Syntax = "syntax", "The body is not acceptable JSON";
    /// An unknown or malformed query parameter.
    InvalidQuery = "invalid-query", "A query parameter is not usable";
    /// A malformed request header.
    InvalidHeader = "invalid-header", "A request header is not usable";
    /// The path does not exist.
    NotFound = "not-found", "There is nothing at this path";
    /// No such job (or somebody else's).
    JobNotFound = "job-not-found", "There is no such job";
    /// No such method.
    MethodNotFound = "method-not-found", "There is no such fitting method";
    /// No such example.
    ExampleNotFound = "example-not-found", "There is no such example";
    /// The job has no file of that name.
    ArtifactNotFound = "artifact-not-found", "The job has no such file";
    /// Results are not written in this format.
    FormatNotAvailable = "format-not-available", "The result is not available in this format";
    /// The path exists, but not with this HTTP method.
    MethodNotAllowed = "method-not-allowed", "The path does not take this HTTP method";
    /// None of the accepted media types can be given.
    NotAcceptable = "not-acceptable", "None of the accepted media types is available";
    /// The client sent its body too slowly.
    BodyTimeout = "body-timeout", "The body did not arrive in time";
    /// The job has not ended.
    ResultNotReady = "result-not-ready", "The result is not ready";
    /// The job failed; it has no result.
    JobFailed = "job-failed", "The job failed";
    /// The job was cancelled; it has no result.
    JobDismissed = "job-dismissed", "The job was cancelled";
    /// The job has not started; there is nothing to diagnose.
    NotStarted = "not-started", "The job has not started";
    /// The bytes were removed when their retention ended.
    Expired = "expired", "No longer kept";
    /// The body exceeds a limit.
    TooLarge = "too-large", "The body is too large";
    /// The body has the wrong media type or encoding.
    UnsupportedMediaType = "unsupported-media-type", "The body has an unsupported type or encoding";
    /// The requested byte range lies outside the file.
    RangeNotSatisfiable = "range-not-satisfiable", "The range lies outside the file";
    /// The job breaks a rule.
    InvalidJob = "invalid-job", "The job is not valid";
    /// Surfaces that break a rule; every fault names its place.
    InvalidSurfaces = "invalid-surfaces", "The surfaces cannot be measured";
    /// The idempotency key belongs to another body.
    KeyReused = "idempotency-key-reused", "The idempotency key was used with another body";
    /// A bug; the log holds the details under the request id.
    Internal = "internal", "Something went wrong on our side";
    /// The queue is full.
    QueueFull = "queue-full", "The queue is full";
    /// The disk is full.
    StorageFull = "storage-full", "The storage is full";
    /// The server is shutting down.
    Draining = "draining", "The server is shutting down";
    /// The store does not answer.
    StoreUnavailable = "store-unavailable", "The job store does not answer";
    /// The answer took too long.
    Timeout = "timeout", "The answer took too long";
    /// The server should get no jobs just now.
    NotReady = "not-ready", "The service is not ready";
}

impl Code {
    /// The one place where a failure gets its HTTP status.
    #[must_use]
    pub fn status(self) -> StatusCode {
        match self {
            Code::Syntax | Code::InvalidQuery | Code::InvalidHeader => StatusCode::BAD_REQUEST,
            Code::NotFound
            | Code::JobNotFound
            | Code::MethodNotFound
            | Code::ExampleNotFound
            | Code::ArtifactNotFound
            | Code::FormatNotAvailable => StatusCode::NOT_FOUND,
            Code::MethodNotAllowed => StatusCode::METHOD_NOT_ALLOWED,
            Code::NotAcceptable => StatusCode::NOT_ACCEPTABLE,
            Code::BodyTimeout => StatusCode::REQUEST_TIMEOUT,
            Code::ResultNotReady | Code::JobFailed | Code::JobDismissed | Code::NotStarted => {
                StatusCode::CONFLICT
            }
            Code::Expired => StatusCode::GONE,
            Code::TooLarge => StatusCode::PAYLOAD_TOO_LARGE,
            Code::UnsupportedMediaType => StatusCode::UNSUPPORTED_MEDIA_TYPE,
            Code::RangeNotSatisfiable => StatusCode::RANGE_NOT_SATISFIABLE,
            Code::InvalidJob | Code::InvalidSurfaces | Code::KeyReused => {
                StatusCode::UNPROCESSABLE_ENTITY
            }
            Code::Internal => StatusCode::INTERNAL_SERVER_ERROR,
            Code::QueueFull
            | Code::StorageFull
            | Code::Draining
            | Code::StoreUnavailable
            | Code::Timeout
            | Code::NotReady => StatusCode::SERVICE_UNAVAILABLE,
        }
    }

    /// The code for an error answer that a library gave without a document.
    #[must_use]
    pub fn of_bare_status(status: StatusCode) -> Code {
        match status {
            StatusCode::NOT_FOUND => Code::NotFound,
            StatusCode::METHOD_NOT_ALLOWED => Code::MethodNotAllowed,
            StatusCode::REQUEST_TIMEOUT => Code::BodyTimeout,
            StatusCode::PAYLOAD_TOO_LARGE => Code::TooLarge,
            StatusCode::UNSUPPORTED_MEDIA_TYPE => Code::UnsupportedMediaType,
            StatusCode::SERVICE_UNAVAILABLE => Code::Timeout,
            other if other.is_client_error() => Code::InvalidHeader,
            _ => Code::Internal,
        }
    }
}

/// How a request can succeed; the counterpart of [`Code`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Success {
    /// Here it is.
    Here,
    /// It is on its way.
    Accepted,
    /// It is gone, and there is nothing to say.
    Erased,
    /// Here is the part that was asked for.
    Part,
    /// The client's copy is still good.
    Unchanged,
}

impl Success {
    /// The HTTP status.
    #[must_use]
    pub fn status(self) -> StatusCode {
        match self {
            Success::Here => StatusCode::OK,
            Success::Accepted => StatusCode::ACCEPTED,
            Success::Erased => StatusCode::NO_CONTENT,
            Success::Part => StatusCode::PARTIAL_CONTENT,
            Success::Unchanged => StatusCode::NOT_MODIFIED,
        }
    }
}

/// One place where a request breaks a rule.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct FieldError {
    /// JSON pointer into the body (RFC 6901); `?name` for a query parameter,
    /// the header's name for a header.
    #[schema(examples("/input/profiles/1/points/4/2"))]
    pub pointer: String,
    /// A short stable word for programmes.
    #[schema(examples("out-of-range"))]
    pub code: String,
    /// A sentence for people, with the offending numbers.
    pub message: String,
    /// What was found there, shortened.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub value: Option<String>,
    /// What to do about it, where that is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub hint: Option<String>,
}

impl FieldError {
    /// An error without value or hint.
    #[must_use]
    pub fn new(pointer: impl Into<String>, code: &str, message: impl Into<String>) -> Self {
        FieldError {
            pointer: pointer.into(),
            code: code.to_owned(),
            message: message.into(),
            value: None,
            hint: None,
        }
    }

    /// The same with advice.
    #[must_use]
    pub fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(hint.into());
        self
    }

    /// The same with what was found.
    #[must_use]
    pub fn value(mut self, value: impl Into<String>) -> Self {
        self.value = Some(value.into());
        self
    }
}

/// A problem document (RFC 9457).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Problem {
    /// Names the kind of problem.
    #[serde(rename = "type")]
    #[schema(examples("urn:mouldloft:problem:invalid-job"))]
    pub kind: String,
    /// The kind in words.
    #[schema(examples("The job is not valid"))]
    pub title: String,
    /// The HTTP status.
    #[schema(minimum = 400, maximum = 599)]
    pub status: u16,
    /// What happened this time.
    pub detail: String,
    /// The kind as one stable word for programmes.
    #[schema(examples("invalid-job"))]
    pub code: String,
    /// The path that was asked for.
    pub instance: String,
    /// Quote this when asking for help; the log knows it.
    pub request_id: String,
    /// The places that are wrong, at most 50.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schema(required = false)]
    pub errors: Vec<FieldError>,
}

/// A failed request, before it is written.
#[derive(Debug, Clone, PartialEq)]
pub struct ApiError {
    /// Which failure.
    pub code: Code,
    /// What happened this time, a sentence.
    pub detail: String,
    /// The places that are wrong.
    pub errors: Vec<FieldError>,
    /// Headers that belong to the failure (`Allow`, `Retry-After`, …).
    pub headers: Vec<(HeaderName, HeaderValue)>,
}

impl ApiError {
    /// A failure with its sentence.
    #[must_use]
    pub fn new(code: Code, detail: impl Into<String>) -> Self {
        ApiError {
            code,
            detail: detail.into(),
            errors: Vec::new(),
            headers: Vec::new(),
        }
    }

    /// A failure that names places; more than fifty are cut, and said so.
    #[must_use]
    pub fn at(code: Code, mut errors: Vec<FieldError>) -> Self {
        let detail = match errors.as_slice() {
            [] => code.title().to_owned(),
            [one] => one.message.clone(),
            [first, rest @ ..] => format!("{} (and {} more)", first.message, rest.len()),
        };
        errors.truncate(MAX_LISTED_ERRORS);
        ApiError {
            code,
            detail,
            errors,
            headers: Vec::new(),
        }
    }

    /// Adds a header; a value that cannot be one is left out.
    #[must_use]
    pub fn header(mut self, name: HeaderName, value: &str) -> Self {
        if let Ok(value) = HeaderValue::from_str(value) {
            self.headers.push((name, value));
        }
        self
    }

    /// Asks the client to come back after so many seconds.
    #[must_use]
    pub fn retry_after(self, seconds: u64) -> Self {
        self.header(header::RETRY_AFTER, &seconds.max(1).to_string())
    }

    /// A bug on our side: the cause goes to the log, not to the client.
    #[must_use]
    pub fn internal(cause: &dyn std::fmt::Display) -> Self {
        tracing::error!(%cause, "internal error");
        ApiError::new(
            Code::Internal,
            "This is a fault of the service, not of the request. The log holds the cause under \
             the request id.",
        )
    }

    /// The document, complete.
    #[must_use]
    pub fn document(&self, instance: &str, request_id: &str) -> Problem {
        Problem {
            kind: format!("urn:mouldloft:problem:{}", self.code.slug()),
            title: self.code.title().to_owned(),
            status: self.code.status().as_u16(),
            detail: self.detail.clone(),
            code: self.code.slug().to_owned(),
            instance: instance.to_owned(),
            request_id: request_id.to_owned(),
            errors: self.errors.clone(),
        }
    }
}

impl IntoResponse for ApiError {
    /// The status and headers; the body follows in the outermost layer, which
    /// finds the error in the answer's extensions.
    fn into_response(self) -> Response {
        let mut response = self.code.status().into_response();
        response.headers_mut().extend(self.headers.clone());
        response.extensions_mut().insert(self);
        response
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_code_has_an_error_status_and_its_own_word() {
        let mut slugs: Vec<_> = Code::ALL.iter().map(|c| c.slug()).collect();
        slugs.sort_unstable();
        slugs.dedup();
        assert_eq!(slugs.len(), Code::ALL.len());
        for code in Code::ALL {
            assert!(code.status().is_client_error() || code.status().is_server_error());
        }
    }

    #[test]
    fn a_long_list_is_cut_and_counted() {
        let many = (0..80).map(|i| FieldError::new(format!("/{i}"), "x", format!("no {i}")));
        let error = ApiError::at(Code::InvalidJob, many.collect());
        assert_eq!(error.errors.len(), MAX_LISTED_ERRORS);
        assert_eq!(error.detail, "no 0 (and 79 more)");
    }
}
