//! The OpenAPI document as a file and as a page. The page's scripts are
//! compiled in, so that it works without the internet.

use super::Api;
use super::extract::{Asked, Nothing};
use super::openapi::{AnyFile, DocFiles, Everywhere};
use super::problem::{ApiError, Code, Success};
use super::respond;
use axum::extract::{Path, State};
use axum::http::header;
use axum::response::{IntoResponse, Redirect, Response};
use bytes::Bytes;
use std::borrow::Cow;
use std::sync::Arc;
use utoipa_swagger_ui::Config;

/// The document in both notations, written once.
#[derive(Debug, Clone)]
pub struct Document {
    /// As JSON.
    pub json: Bytes,
    /// As YAML.
    pub yaml: Bytes,
}

impl Document {
    /// Writes the document.
    ///
    /// # Errors
    /// What the writers say; not with the document of this crate, a test shows.
    pub fn write(api: &utoipa::openapi::OpenApi) -> Result<Document, String> {
        let mut json = api.to_pretty_json().map_err(|e| e.to_string())?;
        json.push('\n');
        let yaml = api.to_yaml().map_err(|e| e.to_string())?;
        Ok(Document {
            json: json.into(),
            yaml: yaml.into(),
        })
    }
}

/// This document as YAML
#[utoipa::path(
    get, path = "/openapi.yaml", tag = "service", operation_id = "openapi_yaml",
    responses(
        (status = 200, description = "OpenAPI 3.1", content((String = "application/yaml"))),
        Everywhere,
    ),
)]
pub(super) async fn yaml(State(api): State<Api>, _: Asked<Nothing>) -> Response {
    respond::bytes_of(Success::Here, "application/yaml", api.document.yaml.clone())
}

/// This document as JSON
#[utoipa::path(
    get, path = "/openapi.json", tag = "service", operation_id = "openapi_json",
    responses(
        (status = 200, description = "OpenAPI 3.1", content((utoipa::openapi::Object = "application/json"))),
        Everywhere,
    ),
)]
pub(super) async fn json(State(api): State<Api>, _: Asked<Nothing>) -> Response {
    respond::bytes_of(Success::Here, "application/json", api.document.json.clone())
}

/// To the page
#[utoipa::path(
    get, path = "/docs", tag = "service", operation_id = "docs",
    responses((status = 303, description = "To /docs/",
        headers(("Location" = String, description = "`/docs/`"))), Everywhere),
)]
pub(super) async fn docs(_: Asked<Nothing>) -> Response {
    Redirect::to("/docs/").into_response()
}

/// The page that explains and tries the service
#[utoipa::path(
    get, path = "/docs/", tag = "service", operation_id = "docs_page",
    responses(
        (status = 200, description = "The page", content((String = "text/html"))),
        DocFiles,
    ),
)]
pub(super) async fn page(_: Asked<Nothing>) -> Result<Response, ApiError> {
    asset("index.html")
}

/// A part of the page
#[utoipa::path(
    get, path = "/docs/{file}", tag = "service", operation_id = "docs_file",
    params(("file" = String, Path, description = "Its name", example = "swagger-ui.css")),
    responses(
        (status = 200, description = "The file", content((inline(AnyFile) = "*/*"))),
        DocFiles,
    ),
)]
pub(super) async fn part(
    Path(file): Path<String>,
    _: Asked<Nothing>,
) -> Result<Response, ApiError> {
    asset(&file)
}

fn asset(name: &str) -> Result<Response, ApiError> {
    let config = Arc::new(Config::new(["/openapi.json"]));
    let file = utoipa_swagger_ui::serve(name, config).map_err(|e| ApiError::internal(&e))?;
    let Some(file) = file else {
        return Err(ApiError::new(
            Code::NotFound,
            format!("the page has no part {name:?}"),
        ));
    };
    let bytes = match file.bytes {
        Cow::Borrowed(bytes) => Bytes::from_static(bytes),
        Cow::Owned(bytes) => bytes.into(),
    };
    let response = respond::bytes_of(Success::Here, "application/octet-stream", bytes);
    let response = respond::with(response, header::CONTENT_TYPE, &file.content_type);
    Ok(if file.gzpipped {
        respond::with(response, header::CONTENT_ENCODING, "gzip")
    } else {
        response
    })
}
