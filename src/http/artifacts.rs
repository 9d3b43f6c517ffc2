//! `/v1/jobs/{id}/artifacts`: the files that a job left, those of single
//! plates and patches among them.

use super::Api;
use super::extract::{Asked, Id, Nothing, Owner};
use super::file_query::{CuttingQuery, FileQuery};
use super::methods::document::{self, PartFile};
use super::methods::{Form, Format};
use super::openapi::{AnyFile, Artifacts, OneArtifact};
use super::problem::{ApiError, Code, Success};
use super::respond;
use super::results::{self, Stored};
use super::written::Key;
use axum::extract::{Path, State};
use axum::http::HeaderMap;
use axum::response::Response;
use bytes::Bytes;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// The files of a job.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub(super) struct ArtifactList {
    /// Those of the whole result, then those of its parts.
    items: Vec<Artifact>,
}

/// A file of a job.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub(super) struct Artifact {
    /// Its name below `…/artifacts/`.
    #[schema(examples("plate-1.glb"))]
    name: String,
    /// Its media type.
    #[schema(examples("model/gltf-binary"))]
    media_type: String,
    /// What it is good for.
    description: String,
    /// The plate, patch or flat pattern that it shows; null for the whole.
    part: Option<String>,
    /// The query parameters that it takes: `units`, `version`.
    parameters: Vec<String>,
    /// Where it is.
    href: String,
}

impl Artifact {
    fn new(name: String, format: Format, part: Option<String>, href: String) -> Self {
        let parameters = [
            ("units", format.takes_units()),
            ("version", format == Format::Dxf),
        ];
        Artifact {
            name,
            media_type: format.content_type().to_owned(),
            description: format.purpose().to_owned(),
            part,
            parameters: (parameters.into_iter())
                .filter(|(_, takes)| *takes)
                .map(|(name, _)| name.to_owned())
                .collect(),
            href,
        }
    }
}

/// The name of the whole result in a form.
fn whole_name(format: Format) -> String {
    format!("result.{}", format.extension())
}

/// The files of a job
///
/// The forms of the whole result, then for each plate or patch a scene and a
/// table, for each flat pattern a drawing.
#[utoipa::path(
    get, path = "/v1/jobs/{id}/artifacts", tag = "results", operation_id = "list_artifacts",
    params(("id" = uuid::Uuid, Path, description = "The job")),
    responses((status = 200, description = "The files", body = ArtifactList), Artifacts),
)]
pub(super) async fn list(
    State(api): State<Api>,
    Owner(owner): Owner,
    Id(id): Id,
    _: Asked<Nothing>,
) -> Result<Response, ApiError> {
    let stored = results::stored(&api, owner, id).await?;
    let place = format!("/v1/jobs/{id}");
    let (formats, parts) = away(move || contents(&stored)).await?;
    let whole = formats.into_iter().map(|format| {
        let name = whole_name(format);
        let href = format!("{place}/{name}");
        Artifact::new(name, format, None, href)
    });
    let parts = parts.into_iter().map(|file| {
        let href = format!("{place}/artifacts/{}", file.name);
        Artifact::new(file.name, file.format, Some(file.part), href)
    });
    let items = whole.chain(parts).collect();
    Ok(respond::json(Success::Here, &ArtifactList { items }))
}

/// A file of a job
#[utoipa::path(
    get, path = "/v1/jobs/{id}/artifacts/{name}", tag = "results", operation_id = "get_artifact",
    params(
        ("id" = uuid::Uuid, Path, description = "The job"),
        ("name" = String, Path, description = "Its name in the list", example = "result.glb"),
        CuttingQuery,
        ("Range" = Option<String>, Header, description = "`bytes=first-last`", nullable = false),
        ("If-None-Match" = Option<String>, Header,
            description = "The entity tag you know", nullable = false),
    ),
    responses(
        (status = 200, description = "The file", content((inline(AnyFile) = "*/*")),
            headers(
                ("ETag" = String, description = "SHA-256 of the bytes"),
                ("Content-Disposition" = String, description = "The file's name"),
                ("Accept-Ranges" = String, description = "`bytes`"),
            )),
        (status = 206, description = "The bytes that `Range` asked for",
            content((inline(AnyFile) = "*/*"))),
        (status = 304, description = "Unchanged"),
        OneArtifact,
    ),
)]
pub(super) async fn get(
    State(api): State<Api>,
    Owner(owner): Owner,
    Id(id): Id,
    Path(names): Path<(String, String)>,
    Asked(query): Asked<CuttingQuery>,
    headers: HeaderMap,
) -> Result<Response, ApiError> {
    let (_, name) = names;
    let stored = results::stored(&api, owner, id).await?;
    let whole = Format::ALL.into_iter().find(|f| whole_name(*f) == name);
    if let Some(format) = whole {
        let form = query.form(format)?;
        return results::whole(&api, stored, form, &headers).await;
    }
    let (_, ending) = name.rsplit_once('.').unwrap_or_default();
    let format = Format::ALL.into_iter().find(|f| f.extension() == ending);
    let form = query.form(format.ok_or_else(|| unknown(&stored, &name))?)?;
    let title = format!("{} {name}", stored.title());
    let bytes = part(&api, stored, &name, form).await?;
    Ok(results::file(title, form.format, bytes, &headers))
}

/// The bytes of a part's file.
async fn part(api: &Api, stored: Stored, name: &str, form: Form) -> Result<Bytes, ApiError> {
    let key = Key {
        job: stored.job.id,
        part: Some(name.to_owned()),
        form,
    };
    if let Some(known) = api.written.get(&key) {
        return Ok(known);
    }
    let wanted = name.to_owned();
    let write = move || {
        let document = stored.open()?;
        let files = document::part_files(&*document)?;
        let file = files.iter().find(|f| f.name == wanted);
        let file = file.ok_or_else(|| unknown(&stored, &wanted))?;
        document::write_part(&*document, file, form)
    };
    let bytes: Bytes = away(write).await?.into();
    api.written.keep(key, bytes.clone());
    Ok(bytes)
}

fn unknown(stored: &Stored, name: &str) -> ApiError {
    let list = format!("/v1/jobs/{}/artifacts", stored.job.id);
    let detail = format!("the job has no file {name:?}; {list} lists those that it has");
    ApiError::new(Code::ArtifactNotFound, detail)
}

fn contents(stored: &Stored) -> Result<(Vec<Format>, Vec<PartFile>), ApiError> {
    let document = stored.open()?;
    Ok((document.formats(), document::part_files(&*document)?))
}

/// Away from the threads that answer.
pub(super) async fn away<T: Send + 'static>(
    work: impl FnOnce() -> Result<T, ApiError> + Send + 'static,
) -> Result<T, ApiError> {
    match tokio::task::spawn_blocking(work).await {
        Ok(done) => done,
        Err(lost) => Err(ApiError::internal(&lost)),
    }
}
