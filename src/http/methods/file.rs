//! Files that come with a job, where methods read the same kind.

use crate::formats::mesh_in;
use crate::geometry::Face;
use crate::http::problem::FieldError;
use crate::http::upload::File;
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

/// Puts the mesh of a file into `input.mesh`, and tells how it was read.
/// `others` are the fields that stand for the same thing.
///
/// # Errors
/// The job has no input or two; the place in the file that cannot be read.
pub fn take_mesh(job: &mut Value, file: &File, others: &[&str]) -> Result<Vec<String>, FieldError> {
    let input = input_for_file(job, &[&["mesh"], others].concat())?;
    let reading = mesh_in::read(&file.bytes).map_err(|e| {
        FieldError::new(e.pointer(), "unreadable", e.sentence())
            .hint(e.hint())
            .value(e.found)
    })?;
    let note = format!("{}: {}", file.name, reading.sentence());
    let vertices = reading.mesh.vertices().iter();
    let vertices: Vec<Value> = vertices.map(|p| vec![p.x, p.y, p.z].into()).collect();
    let corners = |face: &Face| Value::from(face.corners().to_vec());
    let faces: Vec<Value> = reading.mesh.faces().iter().map(corners).collect();
    input.insert(
        "mesh".into(),
        serde_json::json!({"vertices": vertices, "faces": faces}),
    );
    Ok(vec![note])
}
