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
    /// The method that it is for.
    pub method: &'static str,
    /// What it shows, a sentence.
    pub description: &'static str,
    /// The job, as JSON.
    pub body: &'static str,
}

macro_rules! examples {
    ($( $name:literal, $method:literal: $description:literal; )*) => {
        /// All examples, the one to begin with first.
        pub const EXAMPLES: &[Example] = &[ $(
            Example {
                name: $name,
                method: $method,
                description: $description,
                body: include_str!(concat!("examples/", $name, ".json")),
            },
        )* ];
    };
}

examples! {
    "trawler", "hull_plates": "The UBC trawler, 70 ft, four profiles as published, kept exactly: three plates \
                within 6 degrees of twist.";
    "trawler_relaxed", "hull_plates": "The same trawler with boundaries free within 0.0455 ft, 0.065 % of its \
                        length: practically developable plates.";
    "cone", "hull_plates": "A quarter of a cone frustum: developable exactly, twist 0.";
    "cylinder", "hull_plates": "A half cylinder: developable exactly, rulings parallel.";
    "wigley", "hull_plates": "The Wigley hull, a round form that no plate fits: the verdict is outside_limits, \
               with the reason.";
    "punt", "hull_plates": "The flat bottom of a punt: a plane.";
    "frame", "fairing": "A frame lifted from a drawing to 5 mm, one point of it mis-read: the fair \
                         frame, every move, and the slip.";
    "half_circle", "fairing": "13 points of a half circle, passed through exactly: the curvature \
                               of a circle.";
    "gunnerus_offsets", "fairing": "Half-breadths of R/V Gunnerus, 17 stations and 15 waterlines, \
                                    faired as one surface.";
    "bilge_grid", "fairing": "A measured grid of a side with two cells missing, faired within \
                              15 mm.";
    "shoulder", "cone_spline": "A shoulder strake of 6 m as a mesh: the fewest cones within 4 mm, with \
                                workshop sheets and the flat pattern.";
    "strake", "cone_spline": "A strake like that of the UBC trawler between its chines, as a ruled surface: \
                              cones within 0.05 ft.";
    "bent_plate", "cone_spline": "A plate with a quarter round, in mm: a plane, a cylinder and a \
                                  plane, found exactly.";
    "vault", "curvature_net": "A glass vault from 16 quads in any order: cyclide patches, conical \
                               strips both ways, supports.";
    "saddle", "curvature_net": "A saddle near a catenoid, its net cut askew: laid anew, with two \
                                offsets.";
    "tube", "curvature_net": "A bent duct, closed round: conical strips along its rings and an \
                              inner skin.";
    "bilge", "curvature_net": "The turn of a bilge whose radius grows forward: strakes as conical \
                               strips, frames and longitudinals square to the skin.";
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
    /// The method that it is for.
    method: String,
    /// What it shows.
    description: String,
    /// The job itself.
    href: String,
}

impl Example {
    /// Its path.
    pub(super) fn href(&self) -> String {
        format!("/v1/examples/{}", self.name)
    }
}

/// Ready-to-post jobs
#[utoipa::path(
    get, path = "/v1/examples", tag = "methods", operation_id = "list_examples",
    responses((status = 200, description = "All examples", body = ExampleList), Everywhere),
)]
pub(super) async fn list(_: Asked<Nothing>) -> Response {
    let items = EXAMPLES.iter().map(|example| ExampleSummary {
        name: example.name.into(),
        method: example.method.into(),
        description: example.description.into(),
        href: example.href(),
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
                submission.as_ref().err()
            );
            let method = submission.map(|s| s.method());
            assert_eq!(method.ok(), Some(example.method), "{}", example.name);
            assert!(example.body.ends_with('\n'), "{}", example.name);
        }
    }
}
