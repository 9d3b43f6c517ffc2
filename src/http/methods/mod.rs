//! The fitting methods as the HTTP layer knows them, one file each: the shape
//! of a job and its rule, the way into the method and back, words, files.
//! Everything else (intake, engine, results, the command line) goes through
//! [`Method`] and knows no method by name.

pub mod cone_spline;
pub mod curvature_net;
pub mod document;
pub mod fairing;
pub mod file;
mod format;
pub mod hull_plates;
mod resource;

pub use document::Document;
pub use format::{Form, Format};
pub use resource::Words;
pub(super) use resource::routes;

use super::dto::Point;
use super::dto::job::{BoundingBox, Budget, Normalized, Units};
use super::dto::result::Envelope;
use super::problem::{ApiError, Code, FieldError};
use super::schema_check::Rule;
use super::upload::File;
use crate::methods::{Control, FitError};
use serde_json::{Map, Value};
use utoipa::{PartialSchema, ToSchema};

/// The methods that are built.
pub const METHODS: &[&dyn Method] = &[
    &hull_plates::HullPlates,
    &fairing::Fairing,
    &curvature_net::CurvatureNet,
    &cone_spline::ConeSpline,
];

/// A method.
pub trait Method: Sync {
    /// Its word in a job.
    fn name(&self) -> &'static str;
    /// What it says of itself.
    fn words(&self) -> &'static Words;
    /// The schemas of what it takes.
    fn schemas(&self) -> Schemas;
    /// The forms in which its results can be had.
    fn formats(&self) -> &'static [Format];
    /// The rule of its jobs, out of the schema that is published.
    ///
    /// # Errors
    /// A gap between schema and checker, a fault of this crate.
    fn rule(&self) -> Result<&'static Rule, &'static String>;
    /// A job out of a value that keeps the rule.
    ///
    /// # Errors
    /// Every rule that needs two values at once and is broken.
    fn read(&self, value: Value) -> Result<Box<dyn Job>, Vec<FieldError>>;
    /// Puts a file's contents into a job that came with it, and tells how it
    /// was read.
    ///
    /// # Errors
    /// `invalid-job` with the place in the file or the job.
    fn take_file(&self, job: &mut Value, file: &File) -> Result<Vec<String>, ApiError> {
        let _ = (job, file);
        let message = format!("a job of {} takes no file", self.name());
        let fault = FieldError::new("file", "unexpected", message);
        Err(ApiError::at(Code::InvalidJob, vec![fault]))
    }
    /// Reads a stored result back.
    ///
    /// # Errors
    /// One that is not of this method; a fault of ours.
    fn open(&self, result: &[u8]) -> Result<Box<dyn Document>, ApiError>;
    /// Writes a stored result in another form.
    ///
    /// # Errors
    /// `format-not-available` where this result has no such form.
    fn write(&self, form: Form, result: &[u8]) -> Result<Vec<u8>, ApiError> {
        document::write(&*self.open(result)?, form)
    }
}

/// A job that was read and may be queued or fitted.
pub trait Job: Send + std::fmt::Debug {
    /// The name of its method.
    fn method(&self) -> &'static str;
    /// What all jobs have.
    fn header(&self) -> Header<'_>;
    /// What the fit would warn of.
    ///
    /// # Errors
    /// [`FitError::Invalid`] with every issue of the input.
    fn warnings(&self) -> Result<Vec<String>, FitError>;
    /// The job as it was understood, in metres.
    fn normalized(&self) -> Normalized;
    /// Fits, and writes result and diagnostics as JSON.
    ///
    /// # Errors
    /// Those of the method.
    fn fit(&self, input_sha256: String, control: &dyn Control) -> Result<Fitted, FitError>;
}

/// What all jobs have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Header<'a> {
    /// The user's name for it.
    pub label: Option<&'a str>,
    /// What it may use.
    pub budget: Budget,
}

/// What comes of a fit, as JSON lines.
#[derive(Debug, Clone, PartialEq)]
pub struct Fitted {
    /// The result.
    pub result: Vec<u8>,
    /// Its figures alone.
    pub diagnostics: Vec<u8>,
    /// Whether every limit is kept.
    pub within_limits: bool,
    /// The verdict in a sentence.
    pub message: String,
    /// What the user should know about the input.
    pub warnings: Vec<String>,
}

impl Fitted {
    /// What a result says, as bytes.
    fn of(document: &impl Envelope) -> Result<Self, FitError> {
        Ok(Fitted {
            result: json_line(document)?,
            diagnostics: json_line(document.figures())?,
            within_limits: document.is_within_limits(),
            message: document.summary().first().cloned().unwrap_or_default(),
            warnings: document.warnings().to_vec(),
        })
    }
}

/// The schemas of what a method takes.
#[derive(Debug, Clone, PartialEq)]
pub struct Schemas {
    /// Of `input`.
    pub input: Value,
    /// Of `options`.
    pub options: Value,
    /// The options' defaults.
    pub defaults: Value,
}

impl Schemas {
    fn of<I: PartialSchema, O: PartialSchema + Default + serde::Serialize>() -> Self {
        Schemas {
            input: serde_json::to_value(I::schema()).unwrap_or_default(),
            options: serde_json::to_value(O::schema()).unwrap_or_default(),
            defaults: serde_json::to_value(O::default()).unwrap_or_default(),
        }
    }
}

/// The method of that name.
#[must_use]
pub fn named(name: &str) -> Option<&'static dyn Method> {
    METHODS.iter().copied().find(|m| m.name() == name)
}

/// The names of all methods.
#[must_use]
pub fn names() -> Vec<&'static str> {
    METHODS.iter().map(|m| m.name()).collect()
}

/// The rule of a body, out of the schema that is published.
pub(super) fn rule_of<J: ToSchema>() -> Result<Rule, String> {
    let mut schemas = Vec::new();
    J::schemas(&mut schemas);
    let components = schemas
        .into_iter()
        .map(|(name, schema)| Ok((name, serde_json::to_value(schema)?)))
        .collect::<Result<Map<String, Value>, serde_json::Error>>()
        .map_err(|e| e.to_string())?;
    let schema = serde_json::to_value(J::schema()).map_err(|e| e.to_string())?;
    Rule::compile(&schema, &components)
}

/// The schema has passed, so this is a gap between schema and type.
#[allow(clippy::needless_pass_by_value)] // As `map_err` hands it over.
fn misread(error: serde_json::Error) -> Vec<FieldError> {
    vec![FieldError::new("", "invalid", error.to_string())]
}

/// A stored result as the document that a method reads.
fn read_back<D: Document + serde::de::DeserializeOwned + 'static>(
    result: &[u8],
) -> Result<Box<dyn Document>, ApiError> {
    let document: D = serde_json::from_slice(result).map_err(|e| ApiError::internal(&e))?;
    Ok(Box::new(document))
}

fn json_line(value: &impl serde::Serialize) -> Result<Vec<u8>, FitError> {
    let mut bytes = serde_json::to_vec(value)
        .map_err(|e| FitError::Numerical(format!("the result cannot be written as JSON: {e}")))?;
    bytes.push(b'\n');
    Ok(bytes)
}

impl Normalized {
    /// The box around points, and counts.
    fn new(points: &[Point], units: Units, counts: &[(&str, usize)]) -> Self {
        let mut bounds = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
        for point in points {
            let [least, greatest] = &mut bounds;
            for ((low, high), x) in least.iter_mut().zip(greatest).zip(point.0) {
                *low = low.min(x * units.metres());
                *high = high.max(x * units.metres());
            }
        }
        Normalized {
            bbox_m: BoundingBox {
                min: Point(bounds[0]),
                max: Point(bounds[1]),
            },
            counts: (counts.iter())
                .map(|(name, count)| ((*name).to_owned(), *count))
                .collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_published_schemas_compile_to_rules() {
        for method in METHODS {
            assert!(
                method.rule().is_ok(),
                "{}: {:?}",
                method.name(),
                method.rule().err()
            );
        }
    }
}
