//! What a job leaves: its result as JSON and as files, its diagnostics.

use super::Api;
use super::dto::ResultDocument;
use super::dto::diagnostics::DiagnosticsAnswer;
use super::extract::{Asked, Id, Nothing, Owner};
use super::jobs::WaitQuery;
use super::methods::{self, Format};
use super::openapi::{Diagnosing, Files, RawBytes, Results};
use super::problem::{ApiError, Code, Success};
use super::respond::{self, File};
use crate::jobs::{Job, JobId, QueueError, Status, Tenant};
use axum::extract::State;
use axum::http::{HeaderMap, header};
use axum::response::Response;
use bytes::Bytes;
use serde_json::value::RawValue;

/// Writes a stored result.
fn write(method: &str, format: Format, result: Bytes) -> Result<Bytes, ApiError> {
    if format == Format::Json {
        return Ok(result);
    }
    let method = methods::named(method)
        .ok_or_else(|| ApiError::internal(&format!("no method {method} wrote this")))?;
    if !method.formats().contains(&format) {
        return Err(not_available(format.extension(), method.formats()));
    }
    Ok(method.write(format, &result)?.into())
}

fn not_available(extension: &str, formats: &[Format]) -> ApiError {
    let known: Vec<&str> = formats.iter().map(|f| f.extension()).collect();
    let detail = format!(
        "there is no result.{extension}; there are {}",
        known.join(", ")
    );
    ApiError::new(Code::FormatNotAvailable, detail)
}

/// The failure of an ending that is no format, naming those that are.
pub(super) fn no_such_format(extension: &str) -> ApiError {
    not_available(extension, &Format::ALL)
}

/// The format that `Accept` likes best; JSON when it likes all the same.
fn negotiate(headers: &HeaderMap) -> Result<Format, ApiError> {
    let accepted: Vec<String> = (headers.get_all(header::ACCEPT).iter())
        .filter_map(|v| v.to_str().ok())
        .flat_map(|v| v.split(','))
        .map(|v| v.trim().to_ascii_lowercase())
        .filter(|v| !v.is_empty())
        .collect();
    if accepted.is_empty() {
        return Ok(Format::Json);
    }
    let mut best: Option<(f64, Format)> = None;
    for format in Format::ALL {
        let q = quality(&accepted, format.essence());
        if q > best.map_or(0.0, |(q, _)| q) {
            best = Some((q, format));
        }
    }
    best.map(|(_, format)| format).ok_or_else(|| {
        let known: Vec<&str> = Format::ALL.iter().map(|f| f.essence()).collect();
        let detail = format!("the result is available as {}", known.join(", "));
        ApiError::new(Code::NotAcceptable, detail)
    })
}

/// The weight that a list of media ranges gives to a type: that of the most
/// specific range (RFC 9110 12.5.1).
fn quality(accepted: &[String], essence: &str) -> f64 {
    let family = essence.split('/').next().unwrap_or_default();
    let mut best = (0, 0.0);
    for range in accepted {
        let mut parts = range.split(';').map(str::trim);
        let kind = parts.next().unwrap_or_default();
        let specific = match kind {
            _ if kind == essence => 3,
            _ if kind.strip_suffix("/*") == Some(family) => 2,
            "*/*" => 1,
            _ => continue,
        };
        let q = parts
            .find_map(|p| p.strip_prefix("q="))
            .map_or(1.0, |q| q.parse().unwrap_or(0.0));
        if specific > best.0 {
            best = (specific, q);
        }
    }
    best.1
}

/// The job and its stored result, once it has ended.
async fn stored(api: &Api, owner: &Tenant, id: JobId) -> Result<(Job, Bytes), ApiError> {
    let job = api.queue.get(owner, id).await?;
    let bytes = api.queue.result(owner, id).await?;
    Ok((job, bytes))
}

async fn written(job: &Job, format: Format, result: Bytes) -> Result<Bytes, ApiError> {
    let method = job.method.clone();
    match tokio::task::spawn_blocking(move || write(&method, format, result)).await {
        Ok(bytes) => bytes,
        Err(lost) => Err(ApiError::internal(&lost)),
    }
}

/// The result of a job
///
/// JSON unless `Accept` asks for one of the other formats.
#[utoipa::path(
    get, path = "/v1/jobs/{id}/result", tag = "results", operation_id = "get_result",
    params(
        ("id" = uuid::Uuid, Path, description = "The job"),
        WaitQuery,
        ("Accept" = Option<String>, Header, description = "Media types you take", nullable = false),
    ),
    responses(
        (status = 200, description = "The result",
            content(
                (ResultDocument = "application/json"),
                (String = "model/obj"), (String = "text/csv"), (String = "image/svg+xml"),
                (String = "model/step"), (String = "model/iges"), (String = "image/vnd.dxf"),
            ),
            headers(("ETag" = String, description = "SHA-256 of the bytes"))),
        (status = 206, description = "The bytes that `Range` asked for",
            content((inline(RawBytes) = "application/octet-stream"))),
        (status = 304, description = "Unchanged"),
        Results,
    ),
)]
pub(super) async fn result(
    State(api): State<Api>,
    Owner(owner): Owner,
    Id(id): Id,
    Asked(query): Asked<WaitQuery>,
    headers: HeaderMap,
) -> Result<Response, ApiError> {
    let format = negotiate(&headers)?;
    if let Some(wait) = query.wait {
        api.queue.wait_ended(&owner, id, wait).await?;
    }
    let (job, result) = stored(&api, &owner, id).await?;
    let bytes = written(&job, format, result).await?;
    let file = File {
        content_type: format.content_type(),
        bytes,
        name: None,
        inline: true,
    };
    Ok(respond::with(file.answer(&headers), header::VARY, "Accept"))
}

async fn file(
    api: Api,
    owner: Tenant,
    id: JobId,
    headers: HeaderMap,
    format: Format,
) -> Result<Response, ApiError> {
    let (job, result) = stored(&api, &owner, id).await?;
    let bytes = written(&job, format, result).await?;
    let stem = job.label.unwrap_or(job.method);
    let file = File {
        content_type: format.content_type(),
        bytes,
        name: Some(format!("{}.{}", stem.trim(), format.extension())),
        // A browser shows the drawing; the rest is for other programmes.
        inline: format == Format::Svg,
    };
    let response = file.answer(&headers);
    Ok(match format {
        // The label is the user's: no script runs in it whatever it says.
        Format::Svg => respond::with(
            response,
            header::CONTENT_SECURITY_POLICY,
            "default-src 'none'; style-src 'unsafe-inline'; sandbox",
        ),
        Format::Json | Format::Obj | Format::Csv | Format::Step | Format::Igs | Format::Dxf => {
            response
        }
    })
}

macro_rules! result_files {
    ($( $name:ident, $path:literal, $id:literal, $format:expr, $body:ty, $kind:literal, $title:literal; )*) => {
        $(
            #[doc = $title]
            #[utoipa::path(
                get, path = $path, tag = "results", operation_id = $id,
                params(
                    ("id" = uuid::Uuid, Path, description = "The job"),
                    ("Range" = Option<String>, Header, description = "`bytes=first-last`",
                        nullable = false),
                    ("If-None-Match" = Option<String>, Header,
                        description = "The entity tag you know", nullable = false),
                ),
                responses(
                    (status = 200, description = "The file", content(($body = $kind)),
                        headers(
                            ("ETag" = String, description = "SHA-256 of the bytes"),
                            ("Content-Disposition" = String, description = "The file's name"),
                            ("Accept-Ranges" = String, description = "`bytes`"),
                        )),
                    (status = 206, description = "The bytes that `Range` asked for",
                        content((inline(RawBytes) = $kind))),
                    (status = 304, description = "Unchanged"),
                    Files,
                ),
            )]
            pub(super) async fn $name(
                State(api): State<Api>,
                Owner(owner): Owner,
                Id(id): Id,
                _: Asked<Nothing>,
                headers: HeaderMap,
            ) -> Result<Response, ApiError> {
                file(api, owner, id, headers, $format).await
            }
        )*
    };
}

result_files! {
    result_json, "/v1/jobs/{id}/result.json", "get_result_json", Format::Json, ResultDocument,
        "application/json", "The result as a JSON file";
    result_obj, "/v1/jobs/{id}/result.obj", "get_result_obj", Format::Obj, String,
        "model/obj", "The plates as a triangle mesh, watertight along shared chines";
    result_csv, "/v1/jobs/{id}/result.csv", "get_result_csv", Format::Csv, String,
        "text/csv", "The table of rulings";
    result_svg, "/v1/jobs/{id}/result.svg", "get_result_svg", Format::Svg, String,
        "image/svg+xml", "The lines plan with the rulings coloured by twist";
    result_step, "/v1/jobs/{id}/result.step", "get_result_step", Format::Step, String,
        "model/step", "The surfaces for CAD, sewn along shared edges, with the curves beside them";
    result_igs, "/v1/jobs/{id}/result.igs", "get_result_igs", Format::Igs, String,
        "model/iges", "The surfaces and curves for older CAD";
    result_dxf, "/v1/jobs/{id}/result.dxf", "get_result_dxf", Format::Dxf, String,
        "image/vnd.dxf", "The flat patterns for the cutting table, true to size";
}

/// How a job went
///
/// For failed jobs too: failure is when it is needed.
#[utoipa::path(
    get, path = "/v1/jobs/{id}/diagnostics", tag = "results", operation_id = "get_diagnostics",
    params(("id" = uuid::Uuid, Path, description = "The job")),
    responses(
        (status = 200, description = "What is known", body = DiagnosticsAnswer),
        Diagnosing,
    ),
)]
pub(super) async fn diagnostics(
    State(api): State<Api>,
    Owner(owner): Owner,
    Id(id): Id,
    _: Asked<Nothing>,
) -> Result<Response, ApiError> {
    let job = api.queue.get(&owner, id).await?;
    let begun = job.started.is_some() || job.status.is_ended();
    if job.status == Status::Accepted && !begun {
        return Err(not_started(&job));
    }
    let figures = match api.queue.diagnostics(&owner, id).await {
        Ok(figures) => figures,
        // Running: there is a record but no figures yet.
        Err(QueueError::NotReady(_)) => None,
        Err(error) => return Err(error.into()),
    };
    let figures = figures.map(|bytes| {
        let text = String::from_utf8_lossy(&bytes).trim_end().to_owned();
        RawValue::from_string(text).map_err(|e| ApiError::internal(&e))
    });
    let answer = DiagnosticsAnswer::new(&job, figures.transpose()?);
    Ok(respond::json(Success::Here, &answer))
}

fn not_started(job: &Job) -> ApiError {
    ApiError::new(Code::NotStarted, "the job is waiting for a worker")
        .retry_after(super::failures::retry_seconds(job))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn choose(accept: &str) -> Option<Format> {
        let mut headers = HeaderMap::new();
        headers.insert(header::ACCEPT, accept.parse().unwrap());
        negotiate(&headers).ok()
    }

    #[test]
    fn accept_is_weighed() {
        for (accept, format) in [
            ("*/*", Some(Format::Json)),
            ("application/json", Some(Format::Json)),
            ("image/*, application/json;q=0.5", Some(Format::Svg)),
            ("text/csv;q=0.2, model/obj;q=0.9", Some(Format::Obj)),
            ("application/json;q=0, */*;q=0.1", Some(Format::Obj)),
            ("application/*", Some(Format::Json)),
            ("text/html", None),
            ("*/*;q=0", None),
        ] {
            assert_eq!(choose(accept), format, "{accept}");
        }
    }
}
