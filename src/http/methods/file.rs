//! Files that come with a job, where methods read the same kind.

use crate::http::problem::FieldError;
use serde_json::{Map, Value};

/// The job's input, into which a file's contents are to be put in place of
/// all the fields `named`.
pub(super) fn input_for_file<'a>(
    job: &'a mut Value,
    named: &[&str],
) -> Result<&'a mut Map<String, Value>, FieldError> {
    let input = job["input"].as_object_mut().ok_or_else(|| {
        let message = "the job has no \"input\", not even an empty one";
        FieldError::new("/input", "missing", message)
    })?;
    match named.iter().find(|n| input.contains_key(**n)) {
        Some(name) => {
            let message = format!("\"{name}\" and a file are given; one is enough");
            Err(FieldError::new("/input", "ambiguous", message))
        }
        None => Ok(input),
    }
}
