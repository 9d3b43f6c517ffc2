//! `/v1/methods`: what each fitting method takes and gives, out of the same
//! schemas that check the jobs.

use super::Method;
use crate::http::Api;
use crate::http::examples::EXAMPLES;
use crate::http::extract::{Asked, Nothing};
use crate::http::openapi::{Everywhere, OneMethod};
use crate::http::problem::{ApiError, Code, Success};
use crate::http::respond;
use axum::extract::Path;
use axum::response::Response;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use utoipa::ToSchema;

/// The methods there are.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub(in crate::http) struct MethodList {
    /// One each.
    items: Vec<MethodSummary>,
}

/// A method in a sentence.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub(in crate::http) struct MethodSummary {
    /// Its name in a job.
    name: String,
    /// What it does.
    summary: String,
    /// Where it is described.
    href: String,
}

/// A method: what it takes and gives.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub(in crate::http) struct MethodDescription {
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
pub(in crate::http) struct FieldDescription {
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
pub(in crate::http) struct Gift {
    /// Where in the result.
    field: String,
    /// What it is.
    description: String,
}

/// What a method says of itself; the rest comes out of its schemas.
#[derive(Debug, Clone, Copy)]
pub struct Words {
    /// What it does.
    pub summary: &'static str,
    /// How it does it.
    pub description: &'static str,
    /// Where it comes from.
    pub source: &'static str,
    /// Lengths among the options that do not carry a unit in their name.
    pub lengths: &'static [&'static str],
    /// What a result holds, and where.
    pub gifts: &'static [(&'static str, &'static str)],
}

fn summary(method: &dyn Method) -> MethodSummary {
    MethodSummary {
        name: method.name().into(),
        summary: method.words().summary.into(),
        href: format!("/v1/methods/{}", method.name()),
    }
}

fn description(method: &dyn Method) -> MethodDescription {
    let words = method.words();
    let schemas = method.schemas();
    let examples = EXAMPLES.iter().filter(|e| e.method == method.name());
    MethodDescription {
        name: method.name().into(),
        summary: words.summary.into(),
        description: words.description.into(),
        source: words.source.into(),
        input: fields(&schemas.input, &Value::Null, words.lengths),
        options: fields(&schemas.options, &schemas.defaults, words.lengths),
        gives: (words.gifts.iter())
            .map(|(field, text)| Gift {
                field: (*field).into(),
                description: (*text).into(),
            })
            .collect(),
        formats: (method.formats().iter())
            .map(|f| f.extension().to_owned())
            .collect(),
        examples: examples.map(|e| e.href()).collect(),
    }
}

/// The fields of a schema, with defaults from the type itself.
fn fields(schema: &Value, defaults: &Value, lengths: &[&str]) -> Vec<FieldDescription> {
    let required = schema["required"].as_array().cloned().unwrap_or_default();
    let properties = schema["properties"]
        .as_object()
        .cloned()
        .unwrap_or_default();
    properties
        .into_iter()
        .map(|(name, mut field)| FieldDescription {
            description: words_of(&field).replace('\n', " "),
            required: required.contains(&Value::from(name.as_str())),
            unit: unit(&name, lengths).map(str::to_owned),
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

/// A field's description; where it may be null, that of the other choice.
fn words_of(field: &Value) -> &str {
    let own = field["description"].as_str();
    let choices = field["oneOf"].as_array().into_iter().flatten();
    let other = choices.filter_map(|c| c["description"].as_str()).next();
    own.or(other).unwrap_or_default()
}

fn unit(name: &str, lengths: &[&str]) -> Option<&'static str> {
    if lengths.contains(&name) {
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
pub(in crate::http) async fn list(_: Asked<Nothing>) -> Response {
    respond::json(
        Success::Here,
        &MethodList {
            items: super::METHODS.iter().map(|m| summary(*m)).collect(),
        },
    )
}

/// What a method takes and gives
#[utoipa::path(
    get, path = "/v1/methods/{name}", tag = "methods", operation_id = "get_method",
    params(("name" = String, Path, description = "Its name", example = "hull_plates")),
    responses((status = 200, description = "The method", body = MethodDescription), OneMethod),
)]
pub(in crate::http) async fn get(
    Path(name): Path<String>,
    _: Asked<Nothing>,
) -> Result<Response, ApiError> {
    let method = super::named(&name).ok_or_else(|| {
        let known = super::names().join(", ");
        let detail = format!("there is no method {name:?}; there are {known}");
        ApiError::new(Code::MethodNotFound, detail)
    })?;
    Ok(respond::json(Success::Here, &description(method)))
}

/// The routes of this resource.
pub(in crate::http) fn routes() -> utoipa_axum::router::OpenApiRouter<Api> {
    utoipa_axum::router::OpenApiRouter::new()
        .routes(utoipa_axum::routes!(list))
        .routes(utoipa_axum::routes!(get))
}
