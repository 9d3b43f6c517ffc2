//! How answers are written: JSON with a newline at the end, entity tags, byte
//! ranges, file names.

use super::intake::sha256_hex;
use super::problem::{ApiError, Code, Success};
use axum::body::Body;
use axum::http::{HeaderMap, HeaderName, HeaderValue, header};
use axum::response::{IntoResponse, Response};
use bytes::Bytes;
use serde::Serialize;
use std::ops::Range;

/// A JSON answer, ended by a newline.
#[must_use]
pub fn json(success: Success, value: &impl Serialize) -> Response {
    match serde_json::to_vec(value) {
        Ok(mut bytes) => {
            bytes.push(b'\n');
            bytes_of(success, "application/json", bytes.into())
        }
        Err(error) => ApiError::internal(&error).into_response(),
    }
}

/// A text answer, ended by a newline.
#[must_use]
pub fn text(content_type: &'static str, mut text: String) -> Response {
    if !text.ends_with('\n') {
        text.push('\n');
    }
    bytes_of(Success::Here, content_type, text.into())
}

/// Bytes as they are.
#[must_use]
pub fn bytes_of(success: Success, content_type: &'static str, bytes: Bytes) -> Response {
    let mut response = success.status().into_response();
    let length = bytes.len();
    *response.body_mut() = Body::from(bytes);
    let headers = response.headers_mut();
    headers.insert(header::CONTENT_TYPE, HeaderValue::from_static(content_type));
    headers.insert(header::CONTENT_LENGTH, length.into());
    response
}

/// The same answer with one more header; a value that cannot be one is left
/// out.
#[must_use]
pub fn with(mut response: Response, name: HeaderName, value: &str) -> Response {
    if let Ok(value) = HeaderValue::from_str(value) {
        response.headers_mut().insert(name, value);
    }
    response
}

/// "Your copy is still good."
#[must_use]
pub fn unchanged(etag: &str) -> Response {
    with(
        Success::Unchanged.status().into_response(),
        header::ETAG,
        etag,
    )
}

/// Whether `If-None-Match` names the tag (weak comparison, RFC 9110 13.1.2).
#[must_use]
pub fn matches(headers: &HeaderMap, etag: &str) -> bool {
    let opaque = |tag: &str| tag.trim().trim_start_matches("W/").to_owned();
    let mut given = headers
        .get_all(header::IF_NONE_MATCH)
        .iter()
        .filter_map(|v| v.to_str().ok());
    given.any(|list| list.trim() == "*" || list.split(',').any(|tag| opaque(tag) == opaque(etag)))
}

/// A file: strong entity tag, ranges, name.
#[derive(Debug)]
pub struct File {
    /// Its media type.
    pub content_type: &'static str,
    /// Its bytes.
    pub bytes: Bytes,
    /// Its name for the user's disk, any text; none leaves the header out.
    pub name: Option<String>,
    /// Shown in a browser rather than saved.
    pub inline: bool,
}

impl File {
    /// The answer to a request with these headers.
    #[must_use]
    pub fn answer(self, request: &HeaderMap) -> Response {
        let etag = format!("\"{}\"", sha256_hex(&self.bytes));
        if matches(request, &etag) {
            return unchanged(&etag);
        }
        let total = self.bytes.len();
        let response = match wanted_range(request, &etag, total) {
            Wanted::All => bytes_of(Success::Here, self.content_type, self.bytes),
            Wanted::Part(range) => {
                let place = format!("bytes {}-{}/{total}", range.start, range.end - 1);
                let part = bytes_of(Success::Part, self.content_type, self.bytes.slice(range));
                with(part, header::CONTENT_RANGE, &place)
            }
            Wanted::Nothing => {
                let detail = format!("the file has {total} bytes");
                return ApiError::new(Code::RangeNotSatisfiable, detail)
                    .header(header::CONTENT_RANGE, &format!("bytes */{total}"))
                    .into_response();
            }
        };
        let response = with(response, header::ETAG, &etag);
        let response = with(response, header::ACCEPT_RANGES, "bytes");
        match self.name {
            Some(name) => with(
                response,
                header::CONTENT_DISPOSITION,
                &disposition(&name, self.inline),
            ),
            None => response,
        }
    }
}

enum Wanted {
    All,
    Part(Range<usize>),
    Nothing,
}

/// What `Range` asks for. Several ranges, other units and malformed ones are
/// answered with the whole file, as RFC 9110 14.2 allows.
fn wanted_range(request: &HeaderMap, etag: &str, total: usize) -> Wanted {
    let text = |name| {
        request
            .get(name)
            .and_then(|v: &HeaderValue| v.to_str().ok())
    };
    if text(header::IF_RANGE).is_some_and(|tag| tag.trim() != etag) {
        return Wanted::All;
    }
    let spec = text(header::RANGE).and_then(|range| range.trim().strip_prefix("bytes="));
    let Some((first, last)) = spec.and_then(|spec| spec.trim().split_once('-')) else {
        return Wanted::All;
    };
    let number = |s: &str| {
        s.parse::<usize>()
            .ok()
            .filter(|_| s.bytes().all(|b| b.is_ascii_digit()))
    };
    let range = match (number(first), number(last)) {
        (Some(first), Some(last)) if first > last => return Wanted::All,
        (Some(first), Some(last)) => first..usize::min(last.saturating_add(1), total),
        (Some(first), None) if last.is_empty() => first..total,
        (None, Some(suffix)) if first.is_empty() => total.saturating_sub(suffix)..total,
        _ => return Wanted::All,
    };
    if range.is_empty() {
        Wanted::Nothing
    } else {
        Wanted::Part(range)
    }
}

/// `Content-Disposition` with an ASCII name and, where that lost something,
/// the full one (RFC 6266).
fn disposition(name: &str, inline: bool) -> String {
    let kind = if inline { "inline" } else { "attachment" };
    let plain = |c: char| {
        if c.is_ascii_alphanumeric() || "-_.".contains(c) {
            c
        } else {
            '_'
        }
    };
    let ascii: String = name.chars().map(plain).collect();
    if ascii == name {
        return format!("{kind}; filename=\"{ascii}\"");
    }
    let mut encoded = String::new();
    for byte in name.bytes() {
        if byte.is_ascii_alphanumeric() || b"-_.".contains(&byte) {
            encoded.push(char::from(byte));
        } else {
            encoded.push_str(&format!("%{byte:02X}"));
        }
    }
    format!("{kind}; filename=\"{ascii}\"; filename*=UTF-8''{encoded}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::http::problem::Code;

    fn ask(name: HeaderName, value: &str) -> Response {
        let mut headers = HeaderMap::new();
        headers.insert(name, HeaderValue::from_str(value).unwrap());
        let file = File {
            content_type: "text/csv",
            bytes: Bytes::from_static(b"0123456789"),
            name: Some("Bär 1.csv".into()),
            inline: false,
        };
        file.answer(&headers)
    }

    #[test]
    fn ranges_are_cut_as_the_standard_says() {
        for (range, status, place) in [
            ("bytes=0-3", Success::Part.status(), Some("bytes 0-3/10")),
            ("bytes=7-", Success::Part.status(), Some("bytes 7-9/10")),
            ("bytes=-3", Success::Part.status(), Some("bytes 7-9/10")),
            ("bytes=-30", Success::Part.status(), Some("bytes 0-9/10")),
            ("bytes=8-99", Success::Part.status(), Some("bytes 8-9/10")),
            (
                "bytes=10-",
                Code::RangeNotSatisfiable.status(),
                Some("bytes */10"),
            ),
            (
                "bytes=-0",
                Code::RangeNotSatisfiable.status(),
                Some("bytes */10"),
            ),
            ("bytes=3-1", Success::Here.status(), None),
            ("bytes=0-1,4-5", Success::Here.status(), None),
            ("lines=0-1", Success::Here.status(), None),
            ("bytes=a-b", Success::Here.status(), None),
            ("bytes=99999999999999999999-", Success::Here.status(), None),
        ] {
            let response = ask(header::RANGE, range);
            assert_eq!(response.status(), status, "{range}");
            let found = response.headers().get(header::CONTENT_RANGE);
            assert_eq!(found.map(|v| v.to_str().unwrap()), place, "{range}");
        }
    }

    #[test]
    fn names_survive_in_both_spellings() {
        let response = ask(header::RANGE, "none");
        assert_eq!(
            response.headers()[header::CONTENT_DISPOSITION],
            "attachment; filename=\"B_r_1.csv\"; filename*=UTF-8''B%C3%A4r%201.csv"
        );
    }

    #[test]
    fn tags_compare_weakly() {
        let etag = ask(header::RANGE, "none").headers()[header::ETAG]
            .to_str()
            .unwrap()
            .to_owned();
        for given in [
            etag.clone(),
            format!("W/{etag}"),
            "*".into(),
            format!("\"x\", {etag}"),
        ] {
            let status = ask(header::IF_NONE_MATCH, &given).status();
            assert_eq!(status, Success::Unchanged.status(), "{given}");
        }
        assert_eq!(
            ask(header::IF_NONE_MATCH, "\"x\"").status(),
            Success::Here.status()
        );
    }
}
