//! `/v1/methods`: what each fitting method takes and gives, out of the same
//! schemas that check the jobs.

use super::Api;
use super::dto::{HullPlatesInput, HullPlatesOptions};
use super::extract::{Asked, Nothing};
use super::openapi::{Everywhere, OneMethod};
use super::problem::{ApiError, Code, Success};
use super::respond;
use axum::extract::Path;
use axum::response::Response;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use utoipa::{PartialSchema, ToSchema};

/// The methods there are.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub(super) struct MethodList {
    /// One each.
    items: Vec<MethodSummary>,
}

/// A method in a sentence.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub(super) struct MethodSummary {
    /// Its name in a job.
    name: String,
    /// What it does.
    summary: String,
    /// Where it is described.
    href: String,
}

/// A method: what it takes and gives.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub(super) struct MethodDescription {
    /// Its name in a job.
    name: String,
    /// What it does.
    summary: String,
    /// How it does it.
    description: String,
    /// Where it comes from.
    source: String,
    /// The fields of `input`.
    input: Vec<FieldDescription>,
    /// The fields of `options`.
    options: Vec<FieldDescription>,
    /// What comes back.
    gives: Vec<Gift>,
    /// Endings of `…/result.{ending}`.
    formats: Vec<String>,
    /// Ready-to-post jobs.
    examples: Vec<String>,
}

/// A field of a job.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub(super) struct FieldDescription {
    /// Its name.
    name: String,
    /// What it is, in words.
    description: String,
    /// Whether it must be given.
    required: bool,
    /// `length` in the job's unit, `degrees`, `percent`, or null.
    unit: Option<String>,
    /// What holds when it is left out; null if nothing does.
    #[schema(value_type = Value)]
    default: Value,
    /// Its JSON schema: type, bounds, words.
    #[schema(value_type = Object)]
    schema: Value,
}

/// Something that a result holds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub(super) struct Gift {
    /// Where in the result.
    field: String,
    /// What it is.
    description: String,
}

const NAME: &str = "hull_plates";
const SUMMARY: &str =
    "Plates that bend from flat steel or plywood between the profile curves of a hull.";
const DESCRIPTION: &str = "Two neighbouring profiles bound a plate. Its rulings are chosen so \
    that the surface normals at the two ends of each differ as little as possible (twist): by a \
    search over all pairs of points for the best set of rulings, then by least squares. The \
    boundary is kept exactly, or moved within a tolerance that holds everywhere. Fans at the ends, \
    the distance of the edge of regression and bend radii are bounded, so that a yard can bend \
    what is delivered.";
const SOURCE: &str = "After Zheng & Bo 2018 and Bo, Zheng, Zhang 2019 (arXiv 1905.07518); the \
    discrete optimum after Wang & Tang 2005.";

/// Lengths among the options that do not carry a unit in their name.
const LENGTHS: [&str; 3] = ["thickness", "min_bend_radius", "boundary"];

const GIFTS: [(&str, &str); 7] = [
    ("verdict", "within_limits or outside_limits"),
    (
        "summary",
        "One sentence for the job, then one a plate, with the reason",
    ),
    (
        "surfaces",
        "One B-spline surface a plate, degree [3,1], control points [u][v]",
    ),
    ("curves", "The profiles as the plates share them"),
    (
        "method_specific.plates",
        "Rulings with twist and bend radii, fans, extensions",
    ),
    (
        "method_specific.profiles",
        "How far each profile was moved, and which points",
    ),
    (
        "diagnostics",
        "Twist (max, mean, 95 %), corner warp, the discrete optimum, clearance, bend \
      radius, strain, curvature, area, termination",
    ),
];

fn summary() -> MethodSummary {
    MethodSummary {
        name: NAME.into(),
        summary: SUMMARY.into(),
        href: format!("/v1/methods/{NAME}"),
    }
}

fn description() -> MethodDescription {
    MethodDescription {
        name: NAME.into(),
        summary: SUMMARY.into(),
        description: DESCRIPTION.into(),
        source: SOURCE.into(),
        input: fields::<HullPlatesInput>(&Value::Null),
        options: fields::<HullPlatesOptions>(
            &serde_json::to_value(HullPlatesOptions::default()).unwrap_or_default(),
        ),
        gives: GIFTS
            .map(|(field, text)| Gift {
                field: field.into(),
                description: text.into(),
            })
            .into(),
        formats: super::results::Format::ALL
            .map(|f| f.extension().to_owned())
            .into(),
        examples: super::examples::hrefs(),
    }
}

/// The fields of a schema, with defaults from the type itself.
fn fields<T: PartialSchema>(defaults: &Value) -> Vec<FieldDescription> {
    let schema = serde_json::to_value(T::schema()).unwrap_or_default();
    let required = schema["required"].as_array().cloned().unwrap_or_default();
    let properties = schema["properties"]
        .as_object()
        .cloned()
        .unwrap_or_default();
    properties
        .into_iter()
        .map(|(name, mut field)| FieldDescription {
            description: field["description"]
                .as_str()
                .unwrap_or_default()
                .replace('\n', " "),
            required: required.contains(&Value::from(name.as_str())),
            unit: unit(&name).map(str::to_owned),
            default: defaults[&name].clone(),
            schema: {
                if let Some(fields) = field.as_object_mut() {
                    fields.remove("description");
                    fields.remove("default");
                }
                field
            },
            name,
        })
        .collect()
}

fn unit(name: &str) -> Option<&'static str> {
    if LENGTHS.contains(&name) {
        Some("length")
    } else if name.ends_with("_deg") {
        Some("degrees")
    } else if name.ends_with("_percent") {
        Some("percent")
    } else {
        None
    }
}

/// The fitting methods
#[utoipa::path(
    get, path = "/v1/methods", tag = "methods", operation_id = "list_methods",
    responses((status = 200, description = "All methods", body = MethodList), Everywhere),
)]
pub(super) async fn list(_: Asked<Nothing>) -> Response {
    respond::json(
        Success::Here,
        &MethodList {
            items: vec![summary()],
        },
    )
}

/// What a method takes and gives
#[utoipa::path(
    get, path = "/v1/methods/{name}", tag = "methods", operation_id = "get_method",
    params(("name" = String, Path, description = "Its name", example = "hull_plates")),
    responses((status = 200, description = "The method", body = MethodDescription), OneMethod),
)]
pub(super) async fn get(Path(name): Path<String>, _: Asked<Nothing>) -> Result<Response, ApiError> {
    if name != NAME {
        let detail = format!("there is no method {name:?}; there is {NAME}");
        return Err(ApiError::new(Code::MethodNotFound, detail));
    }
    Ok(respond::json(Success::Here, &description()))
}

/// The routes of this resource.
pub(super) fn routes() -> utoipa_axum::router::OpenApiRouter<Api> {
    utoipa_axum::router::OpenApiRouter::new()
        .routes(utoipa_axum::routes!(list))
        .routes(utoipa_axum::routes!(get))
}
