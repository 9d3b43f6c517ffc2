//! What a request brings, read strictly: the body with its type and limits,
//! query parameters without unknown or repeated ones, ids, the tenant.

use super::Api;
use super::did_you_mean::unknown;
use super::problem::{ApiError, Code, FieldError};
use axum::extract::{FromRequest, FromRequestParts, Query, RawPathParams, Request};
use axum::http::request::Parts;
use axum::http::{HeaderMap, header};
use bytes::Bytes;
use http_body_util::{BodyExt, LengthLimitError, Limited};
use std::borrow::Cow;
use std::error::Error;
use std::ops::RangeInclusive;
use std::time::Duration;

use crate::jobs::{IdempotencyKey, JobId, Tenant};

/// Longest wait that a request may ask for: below the 60 s of proxies.
pub const MAX_WAIT_S: u64 = 55;

/// Longest idempotency key.
const MAX_KEY_LENGTH: usize = 255;

/// Whose jobs a request is about. Without API keys, which come later, there is
/// one tenant; this is the one place to change then.
#[derive(Debug, Clone)]
pub struct Owner(pub Tenant);

impl FromRequestParts<Api> for Owner {
    type Rejection = ApiError;

    async fn from_request_parts(_parts: &mut Parts, _api: &Api) -> Result<Self, ApiError> {
        Ok(Owner(Tenant::local()))
    }
}

/// The id of a job in the path. What is no id at all is an unknown job.
#[derive(Debug, Clone, Copy)]
pub struct Id(pub JobId);

impl FromRequestParts<Api> for Id {
    type Rejection = ApiError;

    async fn from_request_parts(parts: &mut Parts, api: &Api) -> Result<Self, ApiError> {
        let named = RawPathParams::from_request_parts(parts, api).await;
        let text = named.iter().flatten().find(|(name, _)| *name == "id");
        let id = text.and_then(|(_, text)| text.parse().ok());
        id.map(Id)
            .ok_or_else(|| ApiError::new(Code::JobNotFound, "this is not the id of a job"))
    }
}

/// A body that says it is JSON, unpacked and within the limits.
#[derive(Debug, Clone)]
pub struct JsonBody(pub Bytes);

impl FromRequest<Api> for JsonBody {
    type Rejection = ApiError;

    async fn from_request(request: Request, api: &Api) -> Result<Self, ApiError> {
        require_json(request.headers())?;
        whole_body(request, api).await.map(JsonBody)
    }
}

/// A body, unpacked, within the limits.
///
/// # Errors
/// `too-large`, `body-timeout`, or `syntax` for one that breaks off.
pub async fn whole_body(request: Request, api: &Api) -> Result<Bytes, ApiError> {
    let limits = api.limits;
    let body = Limited::new(request.into_body(), limits.inflated_bytes);
    match tokio::time::timeout(limits.body_time, body.collect()).await {
        Ok(Ok(collected)) => Ok(collected.to_bytes()),
        Ok(Err(error)) => Err(body_error(error.as_ref(), limits)),
        Err(_) => Err(ApiError::new(
            Code::BodyTimeout,
            format!(
                "the body did not arrive within {} s",
                limits.body_time.as_secs()
            ),
        )),
    }
}

/// Bounds on what a request may cost.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// Bytes of a body on the wire.
    pub wire_bytes: usize,
    /// Bytes of a body after decompression.
    pub inflated_bytes: usize,
    /// Time for a body to arrive.
    pub body_time: Duration,
    /// Time for an answer, waiting included.
    pub answer_time: Duration,
}

impl Default for Limits {
    /// 16 MB on the wire, 64 MB inflated, 60 s for a body; the answer has
    /// those and the longest wait.
    fn default() -> Self {
        Limits {
            wire_bytes: 16_000_000,
            inflated_bytes: 64_000_000,
            body_time: Duration::from_secs(60),
            answer_time: Duration::from_secs(60 + MAX_WAIT_S + 5),
        }
    }
}

impl Limits {
    /// The failure of a body that is too large.
    #[must_use]
    pub fn too_large(&self) -> ApiError {
        let [wire, inflated] = [self.wire_bytes, self.inflated_bytes].map(|n| n / 1_000_000);
        let detail = format!("a body may have {wire} MB on the wire and {inflated} MB unpacked");
        ApiError::new(Code::TooLarge, detail)
    }
}

fn require_json(headers: &HeaderMap) -> Result<(), ApiError> {
    if is_json(&media_type(headers)) {
        Ok(())
    } else {
        Err(wrong_type(headers, &["application/json"]))
    }
}

/// The media type of a body in small letters, without parameters; empty where
/// none is given.
pub fn media_type(headers: &HeaderMap) -> String {
    let given = content_type(headers);
    let essence = given.split(';').next().unwrap_or_default();
    essence.trim().to_ascii_lowercase()
}

/// Whether a media type is one of JSON.
pub fn is_json(essence: &str) -> bool {
    essence == "application/json"
        || (essence.starts_with("application/") && essence.ends_with("+json"))
}

fn content_type(headers: &HeaderMap) -> Cow<'_, str> {
    let given = headers.get(header::CONTENT_TYPE);
    given.map_or_else(Cow::default, |v| String::from_utf8_lossy(v.as_bytes()))
}

/// The refusal of a body's type, with those that are taken.
pub fn wrong_type(headers: &HeaderMap, taken: &[&str]) -> ApiError {
    let given = content_type(headers);
    let found = if given.is_empty() {
        "none is given".into()
    } else {
        format!("it is {given:?}")
    };
    let taken = taken.join(" or ");
    let error = FieldError::new("Content-Type", "unsupported-media-type", found.clone())
        .hint(format!("send Content-Type: {taken}"));
    let mut problem = ApiError::at(Code::UnsupportedMediaType, vec![error]);
    problem.detail = format!("the Content-Type must be {taken}, {found}");
    problem
}

fn body_error(error: &(dyn Error + 'static), limits: Limits) -> ApiError {
    let mut cause: Option<&(dyn Error + 'static)> = Some(error);
    while let Some(inner) = cause {
        if inner.is::<LengthLimitError>() {
            return limits.too_large();
        }
        cause = inner.source();
    }
    ApiError::new(Code::Syntax, format!("the body cannot be read: {error}"))
}

/// The idempotency key of a submission.
///
/// # Errors
/// `invalid-header` for an empty, too long or unprintable key, or two of them.
pub fn idempotency_key(headers: &HeaderMap, sha: &str) -> Result<Option<IdempotencyKey>, ApiError> {
    const NAME: &str = "Idempotency-Key";
    let mut keys = headers.get_all("idempotency-key").iter();
    let Some(key) = keys.next() else {
        return Ok(None);
    };
    let printable =
        |k: &&[u8]| (1..=MAX_KEY_LENGTH).contains(&k.len()) && k.iter().all(u8::is_ascii_graphic);
    let text = Some(key.as_bytes())
        .filter(printable)
        .and_then(|k| std::str::from_utf8(k).ok());
    match (text, keys.next()) {
        (Some(text), None) => Ok(Some(IdempotencyKey {
            key: text.to_owned(),
            body_sha256: sha.to_owned(),
        })),
        _ => {
            let message = format!(
                "{NAME} must be one key of 1 to {MAX_KEY_LENGTH} printable ASCII characters \
                 without spaces"
            );
            let error = FieldError::new(NAME, "invalid-header", message);
            Err(ApiError::at(Code::InvalidHeader, vec![error]))
        }
    }
}

/// Query parameters: a type that names its parameters and reads them.
pub trait Parameters: Sized {
    /// The names that are known.
    const KNOWN: &'static [&'static str];

    /// Reads the values; faults are collected in `given`.
    fn read(given: &mut Given) -> Self;
}

/// The query of a request, checked.
#[derive(Debug, Clone)]
pub struct Asked<P>(pub P);

/// For paths that take no query parameters.
#[derive(Debug, Clone, Copy)]
pub struct Nothing;

impl Parameters for Nothing {
    const KNOWN: &'static [&'static str] = &[];

    fn read(_given: &mut Given) -> Self {
        Nothing
    }
}

impl<P: Parameters> FromRequestParts<Api> for Asked<P> {
    type Rejection = ApiError;

    async fn from_request_parts(parts: &mut Parts, _api: &Api) -> Result<Self, ApiError> {
        let pairs = Query::<Vec<(String, String)>>::try_from_uri(&parts.uri)
            .map_err(|e| ApiError::new(Code::InvalidQuery, e.body_text()))?
            .0;
        let mut given = Given {
            pairs,
            faults: Vec::new(),
        };
        given.refuse_strangers(P::KNOWN);
        let asked = P::read(&mut given);
        if given.faults.is_empty() {
            Ok(Asked(asked))
        } else {
            Err(ApiError::at(Code::InvalidQuery, given.faults))
        }
    }
}

/// The pairs of a query and what is wrong with them.
#[derive(Debug, Default)]
pub struct Given {
    pairs: Vec<(String, String)>,
    faults: Vec<FieldError>,
}

impl Given {
    fn refuse_strangers(&mut self, known: &[&str]) {
        for (i, (name, _)) in self.pairs.iter().enumerate() {
            let pointer = format!("?{name}");
            if !known.contains(&name.as_str()) {
                self.faults
                    .push(unknown(pointer, "unknown-parameter", name, known));
            } else if self.pairs[..i].iter().any(|(earlier, _)| earlier == name) {
                let message = format!("the parameter \"{name}\" is given twice");
                self.faults
                    .push(FieldError::new(pointer, "duplicate-parameter", message));
            }
        }
    }

    /// The text of a parameter, if it is given.
    #[must_use]
    pub fn text(&self, name: &str) -> Option<String> {
        self.pairs
            .iter()
            .find(|(n, _)| n == name)
            .map(|(_, value)| value.clone())
    }

    fn fault(&mut self, name: &str, value: &str, message: String) {
        let error = FieldError::new(format!("?{name}"), "invalid-parameter", message);
        self.faults
            .push(error.value(value.chars().take(60).collect::<String>()));
    }

    /// A text of bounded length.
    pub fn bounded_text(&mut self, name: &str, length: RangeInclusive<usize>) -> Option<String> {
        let text = self.text(name)?;
        if length.contains(&text.chars().count()) {
            return Some(text);
        }
        let message = format!(
            "\"{name}\" must have {} to {} characters",
            length.start(),
            length.end()
        );
        self.fault(name, &text, message);
        None
    }

    /// A whole number within bounds.
    pub fn whole(&mut self, name: &str, range: RangeInclusive<u64>) -> Option<u64> {
        let text = self.text(name)?;
        // Digits alone: "+5" would pass through a form encoder as a space.
        let digits = text.bytes().all(|b| b.is_ascii_digit());
        match text.parse().ok().filter(|n| digits && range.contains(n)) {
            Some(n) => Some(n),
            None => {
                let message = format!(
                    "\"{name}\" must be a whole number from {} to {}",
                    range.start(),
                    range.end()
                );
                self.fault(name, &text, message);
                None
            }
        }
    }

    /// A number above 0, no larger than a bound.
    pub fn positive(&mut self, name: &str, most: f64) -> Option<f64> {
        let text = self.text(name)?;
        let number = text.parse().ok();
        let number = number.filter(|x: &f64| *x > 0.0 && *x <= most && x.is_finite());
        if number.is_none() {
            let bound = if most.is_finite() {
                format!(", at most {most}")
            } else {
                String::new()
            };
            let message = format!("\"{name}\" must be a number above 0{bound}");
            self.fault(name, &text, message);
        }
        number
    }

    /// `true` or `false`.
    pub fn flag(&mut self, name: &str) -> Option<bool> {
        self.word(name, &[("true", true), ("false", false)])
    }

    /// One of some words.
    pub fn word<T: Copy>(&mut self, name: &str, words: &[(&str, T)]) -> Option<T> {
        let text = self.text(name)?;
        let found = words
            .iter()
            .find(|(word, _)| *word == text)
            .map(|(_, meaning)| *meaning);
        if found.is_none() {
            let all: Vec<&str> = words.iter().map(|(word, _)| *word).collect();
            self.fault(
                name,
                &text,
                format!("\"{name}\" must be one of {}", all.join(", ")),
            );
        }
        found
    }

    /// The `wait` parameter, as a duration.
    pub fn wait(&mut self) -> Option<Duration> {
        self.whole("wait", 0..=MAX_WAIT_S).map(Duration::from_secs)
    }
}
