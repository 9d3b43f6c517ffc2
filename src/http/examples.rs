//! `/v1/examples`: jobs that can be posted as they are, compiled in.

use super::Api;
use super::dto::JobRequest;
use super::extract::{Asked, Nothing};
use super::openapi::{Everywhere, OneExample};
use super::problem::{ApiError, Code, Success};
use super::respond;
use axum::extract::Path;
use axum::response::Response;
use bytes::Bytes;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// A ready-to-post job.
#[derive(Debug, Clone, Copy)]
pub struct Example {
    /// Its name in the path.
    pub name: &'static str,
    /// What it shows, a sentence.
    pub description: &'static str,
    /// The job, as JSON.
    pub body: &'static str,
}

macro_rules! examples {
    ($( $name:literal: $description:literal; )*) => {
        /// All examples, the one to begin with first.
        pub const EXAMPLES: &[Example] = &[ $(
            Example {
                name: $name,
                description: $description,
                body: include_str!(concat!("examples/", $name, ".json")),
            },
        )* ];
    };
}

examples! {
    "trawler": "The UBC trawler, 70 ft, four profiles as published, kept exactly: three plates \
                within 6 degrees of twist.";
    "trawler_relaxed": "The same trawler with boundaries free within 0.0455 ft, 0.065 % of its \
                        length: practically developable plates.";
    "cone": "A quarter of a cone frustum: developable exactly, twist 0.";
    "cylinder": "A half cylinder: developable exactly, rulings parallel.";
    "wigley": "The Wigley hull, a round form that no plate fits: the verdict is outside_limits, \
               with the reason.";
    "punt": "The flat bottom of a punt: a plane.";
}

/// The examples there are.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub(super) struct ExampleList {
    /// One each.
    items: Vec<ExampleSummary>,
}

/// An example in a sentence.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub(super) struct ExampleSummary {
    /// Its name.
    name: String,
    /// What it shows.
    description: String,
    /// The job itself.
    href: String,
}

/// Paths of all examples.
pub(super) fn hrefs() -> Vec<String> {
    EXAMPLES
        .iter()
        .map(|e| format!("/v1/examples/{}", e.name))
        .collect()
}

/// Ready-to-post jobs
#[utoipa::path(
    get, path = "/v1/examples", tag = "methods", operation_id = "list_examples",
    responses((status = 200, description = "All examples", body = ExampleList), Everywhere),
)]
pub(super) async fn list(_: Asked<Nothing>) -> Response {
    let items = EXAMPLES
        .iter()
        .zip(hrefs())
        .map(|(example, href)| ExampleSummary {
            name: example.name.into(),
            description: example.description.into(),
            href,
        });
    respond::json(
        Success::Here,
        &ExampleList {
            items: items.collect(),
        },
    )
}

/// A ready-to-post job
#[utoipa::path(
    get, path = "/v1/examples/{name}", tag = "methods", operation_id = "get_example",
    params(("name" = String, Path, description = "Its name", example = "trawler")),
    responses(
        (status = 200, description = "The body for POST /v1/jobs", body = JobRequest),
        OneExample,
    ),
)]
pub(super) async fn get(Path(name): Path<String>, _: Asked<Nothing>) -> Result<Response, ApiError> {
    let example = EXAMPLES.iter().find(|e| e.name == name).ok_or_else(|| {
        let names: Vec<&str> = EXAMPLES.iter().map(|e| e.name).collect();
        let detail = format!(
            "there is no example {name:?}; there are {}",
            names.join(", ")
        );
        ApiError::new(Code::ExampleNotFound, detail)
    })?;
    let body = Bytes::from_static(example.body.as_bytes());
    Ok(respond::bytes_of(Success::Here, "application/json", body))
}

/// The routes of this resource.
pub(super) fn routes() -> utoipa_axum::router::OpenApiRouter<Api> {
    utoipa_axum::router::OpenApiRouter::new()
        .routes(utoipa_axum::routes!(list))
        .routes(utoipa_axum::routes!(get))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::http::intake::read_job;

    #[test]
    fn every_example_is_a_valid_job() {
        for example in EXAMPLES {
            let submission = read_job(example.body.as_bytes());
            assert!(
                submission.is_ok(),
                "{}: {:?}",
                example.name,
                submission.err()
            );
            assert!(example.body.ends_with('\n'), "{}", example.name);
        }
    }
}
