//! A job that comes with a file: `multipart/form-data` with the parts `job`
//! (JSON) and `file` (points as text, or a mesh). The two are made one job, as if
//! the file had been typed into it: what is queued, stored and shown again is
//! that job.

use super::Api;
use super::extract::{self, JsonBody};
use super::methods;
use super::problem::{ApiError, Code, FieldError};
use super::strict_json;
use axum::extract::{FromRequest, Request};
use axum::http::header;
use bytes::Bytes;
use serde_json::Value;

/// A posted job, and what is to be said about the file it came with.
#[derive(Debug, Clone)]
pub struct Posted {
    /// The job.
    pub body: Bytes,
    /// How the file was read.
    pub notes: Vec<String>,
}

/// A file that came with a job.
#[derive(Debug, Clone)]
pub struct File {
    /// Its name, or `file`.
    pub name: String,
    /// What is in it.
    pub bytes: Bytes,
}

impl FromRequest<Api> for Posted {
    type Rejection = ApiError;

    async fn from_request(request: Request, api: &Api) -> Result<Self, ApiError> {
        let Some(boundary) = boundary(&request) else {
            let JsonBody(body) = JsonBody::from_request(request, api).await?;
            return Ok(Posted {
                body,
                notes: Vec::new(),
            });
        };
        let bytes = extract::whole_body(request, api).await?;
        let (job, file) = parts(bytes, &boundary).await?;
        let work = move || merged(&job, &file);
        match tokio::task::spawn_blocking(work).await {
            Ok(posted) => posted,
            Err(lost) => Err(ApiError::internal(&lost)),
        }
    }
}

/// The boundary of a multipart body; `None` for any other body.
fn boundary(request: &Request) -> Option<String> {
    let kind = request.headers().get(header::CONTENT_TYPE)?.to_str().ok()?;
    multer::parse_boundary(kind).ok()
}

async fn parts(bytes: Bytes, boundary: &str) -> Result<(Bytes, File), ApiError> {
    let broken = |e: multer::Error| ApiError::new(Code::Syntax, format!("the form: {e}"));
    let mut form = multer::Multipart::with_reader(std::io::Cursor::new(bytes), boundary);
    let (mut job, mut file) = (None, None);
    while let Some(field) = form.next_field().await.map_err(broken)? {
        let name = field.name().unwrap_or_default().to_owned();
        let file_name = field.file_name().map(str::to_owned);
        let place = match name.as_str() {
            "job" => &mut job,
            "file" => &mut file,
            other => return Err(stranger(other)),
        };
        let bytes = field.bytes().await.map_err(broken)?;
        if place.replace((file_name, bytes)).is_some() {
            let fault = FieldError::new(name, "duplicate-part", "this part comes twice");
            return Err(ApiError::at(Code::Syntax, vec![fault]));
        }
    }
    let missing = |name: &str| {
        let message = format!("the form has no part \"{name}\"");
        ApiError::at(
            Code::Syntax,
            vec![FieldError::new(name, "missing", message)],
        )
    };
    let (_, job) = job.ok_or_else(|| missing("job"))?;
    let (name, bytes) = file.ok_or_else(|| missing("file"))?;
    Ok((
        job,
        File {
            name: name.unwrap_or_else(|| "file".to_owned()),
            bytes,
        },
    ))
}

fn stranger(name: &str) -> ApiError {
    let name: String = name.chars().take(60).collect();
    let fault = FieldError::new(
        name,
        "unknown-part",
        "a form has the parts \"job\" and \"file\"",
    );
    ApiError::at(Code::Syntax, vec![fault])
}

fn merged(job: &[u8], file: &File) -> Result<Posted, ApiError> {
    let mut job = strict_json::parse(job).map_err(|mut e| {
        e.pointer = format!("job{}", e.pointer);
        ApiError::at(Code::Syntax, vec![e])
    })?;
    let method = job["method"].as_str().and_then(methods::named);
    // A job without a method is refused where all jobs are.
    let notes = method.map_or(Ok(Vec::new()), |m| m.take_file(&mut job, file));
    let mut body = serde_json::to_vec(&job).map_err(|e| ApiError::internal(&e))?;
    body.push(b'\n');
    Ok(Posted {
        body: body.into(),
        notes: notes?,
    })
}

/// A job with its file, for the document.
#[derive(serde::Deserialize, utoipa::ToSchema)]
#[serde(deny_unknown_fields)]
#[allow(dead_code)] // A schema, never a value.
pub struct JobWithFile {
    /// The job, without what is in the file; `input.file` of `fairing` says what
    /// a table holds.
    #[schema(value_type = super::dto::JobRequest)]
    job: Value,
    /// Points, or a table of offsets, as text: columns apart by comma,
    /// semicolon, tab or blanks, decimal point or comma, with or without
    /// headers and comments. Or a mesh: OBJ, STL or PLY.
    #[schema(format = Binary)]
    file: String,
}
