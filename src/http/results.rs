//! What a job leaves: its result as JSON and as files, its diagnostics.

use super::Api;
use super::archive;
use super::artifacts::away;
use super::dto::ResultDocument;
use super::dto::diagnostics::DiagnosticsAnswer;
use super::extract::{Asked, Id, Nothing, Owner};
use super::file_query::{CuttingQuery, FileQuery, UnitsQuery};
use super::jobs::WaitQuery;
use super::methods::{self, Document, Form, Format, document};
use super::openapi::{Diagnosing, Files, RawBytes, Results};
use super::problem::{ApiError, Code, Success};
use super::respond::{self, File};
use super::written::Key;
use crate::jobs::{Job, JobId, QueueError, Status, Tenant};
use axum::extract::State;
use axum::http::{HeaderMap, header};
use axum::response::Response;
use bytes::Bytes;
use serde_json::value::RawValue;

/// A job and its result, once it has ended.
pub(super) struct Stored {
    /// The job.
    pub job: Job,
    /// Its owner.
    owner: Tenant,
    /// The result as it is kept.
    result: Bytes,
}

impl Stored {
    /// The result read back.
    ///
    /// # Errors
    /// A fault of ours.
    pub fn open(&self) -> Result<Box<dyn Document>, ApiError> {
        let method = methods::named(&self.job.method);
        let method = method.ok_or_else(|| {
            ApiError::internal(&format!("no method {} wrote this", self.job.method))
        })?;
        method.open(&self.result)
    }

    /// What files of it are called by.
    pub fn title(&self) -> &str {
        let label = self.job.label.as_deref();
        label.unwrap_or(&self.job.method).trim()
    }
}

/// The failure of an ending that is no format, naming those that are.
pub(super) fn no_such_format(extension: &str) -> ApiError {
    document::not_available(extension, &Format::ALL)
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
///
/// # Errors
/// There is no such job of this owner, or it has no result.
pub(super) async fn stored(api: &Api, owner: Tenant, id: JobId) -> Result<Stored, ApiError> {
    Ok(Stored {
        job: api.queue.get(&owner, id).await?,
        result: api.queue.result(&owner, id).await?,
        owner,
    })
}

/// The result in a form, out of those that were written lately if it is there.
async fn written(api: &Api, stored: Stored, form: Form) -> Result<Bytes, ApiError> {
    if form.format == Format::Json {
        return Ok(stored.result);
    }
    let key = Key {
        job: stored.job.id,
        part: None,
        form,
    };
    if let Some(known) = api.written.get(&key) {
        return Ok(known);
    }
    let input = match form.format {
        Format::Zip => api.queue.input(&stored.owner, stored.job.id).await?,
        _ => Bytes::new(),
    };
    let write = move || {
        let opened = stored.open()?;
        match form.format {
            Format::Zip => archive::pack(&*opened, &input, &stored.result),
            _ => document::write(&*opened, form),
        }
    };
    let bytes: Bytes = away(write).await?.into();
    api.written.keep(key, bytes.clone());
    Ok(bytes)
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
                (String = "model/obj"), (inline(RawBytes) = "model/stl"),
                (inline(RawBytes) = "application/x-ply"), (inline(RawBytes) = "model/gltf-binary"),
                (String = "text/csv"), (String = "image/svg+xml"), (String = "model/step"),
                (String = "model/iges"), (String = "image/vnd.dxf"),
                (inline(RawBytes) = "application/zip"),
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
    let stored = stored(&api, owner, id).await?;
    let bytes = written(&api, stored, format.into()).await?;
    let file = File {
        content_type: format.content_type(),
        bytes,
        name: None,
        inline: true,
    };
    Ok(respond::with(file.answer(&headers), header::VARY, "Accept"))
}

/// The whole result as a file.
///
/// # Errors
/// It has no such form.
pub(super) async fn whole(
    api: &Api,
    stored: Stored,
    form: Form,
    headers: &HeaderMap,
) -> Result<Response, ApiError> {
    let name = format!("{}.{}", stored.title(), form.format.extension());
    let bytes = written(api, stored, form).await?;
    Ok(file(name, form.format, bytes, headers))
}

/// A file with its name.
pub(super) fn file(name: String, format: Format, bytes: Bytes, headers: &HeaderMap) -> Response {
    let file = File {
        content_type: format.content_type(),
        bytes,
        name: Some(name),
        // A browser shows the drawing; the rest is for other programmes.
        inline: format == Format::Svg,
    };
    let response = file.answer(headers);
    if format != Format::Svg {
        return response;
    }
    // The label is the user's: no script runs in it whatever it says.
    respond::with(
        response,
        header::CONTENT_SECURITY_POLICY,
        "default-src 'none'; style-src 'unsafe-inline'; sandbox",
    )
}

macro_rules! result_files {
    ($( $name:ident, $path:literal, $id:literal, $format:expr, $query:ident $(as $shown:ident)?,
        $body:ty, $kind:literal, $title:literal; )*) => {
        $(
            #[doc = $title]
            #[utoipa::path(
                get, path = $path, tag = "results", operation_id = $id,
                params(
                    ("id" = uuid::Uuid, Path, description = "The job"),
                    $($shown,)?
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
                Asked(query): Asked<$query>,
                headers: HeaderMap,
            ) -> Result<Response, ApiError> {
                let stored = stored(&api, owner, id).await?;
                whole(&api, stored, query.form($format)?, &headers).await
            }
        )*
    };
}

result_files! {
    result_json, "/v1/jobs/{id}/result.json", "get_result_json", Format::Json, Nothing,
        ResultDocument, "application/json", "The result as a JSON file";
    result_obj, "/v1/jobs/{id}/result.obj", "get_result_obj", Format::Obj,
        UnitsQuery as UnitsQuery, String, "model/obj",
        "The surfaces as a triangle mesh, watertight along shared borders";
    result_stl, "/v1/jobs/{id}/result.stl", "get_result_stl", Format::Stl,
        UnitsQuery as UnitsQuery, RawBytes, "model/stl", "The same mesh, triangles alone (binary)";
    result_ply, "/v1/jobs/{id}/result.ply", "get_result_ply", Format::Ply,
        UnitsQuery as UnitsQuery, RawBytes, "application/x-ply",
        "The same mesh with a colour and a value a vertex (binary)";
    result_glb, "/v1/jobs/{id}/result.glb", "get_result_glb", Format::Glb,
        UnitsQuery as UnitsQuery, RawBytes, "model/gltf-binary",
        "The same mesh as a scene: named parts, colours, values, lines";
    result_csv, "/v1/jobs/{id}/result.csv", "get_result_csv", Format::Csv,
        UnitsQuery as UnitsQuery, String, "text/csv",
        "The table: rulings, workshop sheets, corrections, bill of quantities";
    result_svg, "/v1/jobs/{id}/result.svg", "get_result_svg", Format::Svg,
        UnitsQuery as UnitsQuery, String, "image/svg+xml",
        "The drawing: lines plan, flat pattern, plot";
    result_step, "/v1/jobs/{id}/result.step", "get_result_step", Format::Step,
        UnitsQuery as UnitsQuery, String, "model/step",
        "The surfaces for CAD, sewn along shared edges, with the curves beside them";
    result_igs, "/v1/jobs/{id}/result.igs", "get_result_igs", Format::Igs,
        UnitsQuery as UnitsQuery, String, "model/iges",
        "The surfaces and curves for older CAD";
    result_dxf, "/v1/jobs/{id}/result.dxf", "get_result_dxf", Format::Dxf,
        CuttingQuery as CuttingQuery, String, "image/vnd.dxf",
        "The flat patterns for the cutting table, true to size";
    result_zip, "/v1/jobs/{id}/result.zip", "get_result_zip", Format::Zip, Nothing, RawBytes,
        "application/zip", "All forms of the result with the job";
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
