//! Jobs that name another job: what they name is put in its place when they
//! are posted, so that what is queued, stored and shown again is complete by
//! itself, and its result depends on nothing else.

use super::Api;
use super::dto::hull_plates::HullPlatesResult;
use super::dto::index::Index;
use super::dto::job::Units;
use super::problem::{ApiError, Code, FieldError};
use super::strict_json;
use crate::jobs::{JobId, QueueError, Tenant};
use bytes::Bytes;
use serde_json::{Map, Value, json};

/// The job as it is to be queued, and what there is to say about it.
///
/// # Errors
/// `invalid-job` where the job that is named is not there (or not the owner's),
/// has not ended well, or has no such plate.
pub(super) async fn resolved(
    api: &Api,
    owner: &Tenant,
    body: Bytes,
) -> Result<(Bytes, Vec<String>), ApiError> {
    let Some(mut job) = naming(&body) else {
        return Ok((body, Vec::new()));
    };
    let Some(id) = job["input"]["job"].as_str().and_then(|id| id.parse().ok()) else {
        // No id: refused where all jobs are.
        return Ok((body, Vec::new()));
    };
    let units = job["units"].clone();
    let Ok(units) = serde_json::from_value::<Units>(units) else {
        return Ok((body, Vec::new()));
    };
    let result = result(api, owner, id).await?;
    let Some(input) = job["input"].as_object_mut() else {
        return Ok((body, Vec::new()));
    };
    let at = |fault| ApiError::at(Code::InvalidJob, vec![fault]);
    let note = put_plate(input, &result, units).map_err(at)?;
    let mut body = serde_json::to_vec(&job).map_err(|e| ApiError::internal(&e))?;
    body.push(b'\n');
    let notes = if note.is_empty() {
        Vec::new()
    } else {
        vec![note]
    };
    Ok((body.into(), notes))
}

/// A job that names another is shorter than this; a longer one has a shape of
/// its own.
const LONGEST: usize = 1 << 16;

/// The job, if it is one that names another and nothing beside it.
fn naming(body: &[u8]) -> Option<Value> {
    if body.len() > LONGEST {
        return None;
    }
    let job = strict_json::parse(body).ok()?;
    let input = job["input"].as_object()?;
    let names = job["method"] == "cone_spline"
        && input.contains_key("job")
        && !["mesh", "surface"].iter().any(|k| input.contains_key(*k));
    names.then_some(job)
}

/// The result of the job that is named.
async fn result(api: &Api, owner: &Tenant, id: JobId) -> Result<HullPlatesResult, ApiError> {
    let job = api.queue.get(owner, id).await;
    let job = job.map_err(|error| refusal(id, error))?;
    if job.method != "hull_plates" {
        let message = format!("that job is one of {}, not of hull_plates", job.method);
        return Err(at_job(id, "wrong-method", message, None));
    }
    let bytes = api.queue.result(owner, id).await;
    let bytes = bytes.map_err(|error| refusal(id, error))?;
    serde_json::from_slice(&bytes).map_err(|e| ApiError::internal(&e))
}

fn refusal(id: JobId, error: QueueError) -> ApiError {
    let (code, message) = match error {
        QueueError::NotFound => ("job-not-found", "there is no such job".to_owned()),
        QueueError::Failed(_) => ("job-failed", "that job failed".to_owned()),
        QueueError::Dismissed(_) => ("job-dismissed", "that job was cancelled".to_owned()),
        QueueError::Expired => ("expired", "its result is no longer kept".to_owned()),
        QueueError::NotReady(job) => {
            let message = format!("that job is still {}", job.status.as_str());
            let hint = format!("wait for it: GET /v1/jobs/{id}?wait=55");
            return at_job(id, "result-not-ready", message, Some(hint));
        }
        other => return other.into(),
    };
    at_job(id, code, message, None)
}

fn at_job(id: JobId, code: &'static str, message: String, hint: Option<String>) -> ApiError {
    let fault = FieldError::new("/input/job", code, message).value(id.to_string());
    let fault = match hint {
        Some(hint) => fault.hint(hint),
        None => fault,
    };
    ApiError::at(Code::InvalidJob, vec![fault])
}

/// Puts the plate in the place of its job.
fn put_plate(
    input: &mut Map<String, Value>,
    result: &HullPlatesResult,
    units: Units,
) -> Result<String, FieldError> {
    let count = result.surfaces.len();
    let fault = |code, message: String| FieldError::new("/input/plate", code, message);
    let plate = match input.get("plate") {
        None if count == 1 => 0,
        None => {
            let message = format!("that job has {count} plates: say which, counted from 0");
            return Err(fault("missing", message));
        }
        // Anything but an index is left, to be refused where all jobs are.
        Some(plate) => match serde_json::from_value::<Index>(plate.clone()) {
            Ok(plate) => plate.0,
            Err(_) => return Ok(String::new()),
        },
    };
    let Some(surface) = result.surfaces.get(plate) else {
        let message = format!("that job has {count} plates, counted from 0");
        return Err(fault("out-of-range", message).value(plate.to_string()));
    };
    let scale = result.units.metres() / units.metres();
    let same = result.units == units;
    let length = |x: f64| if same { x } else { x * scale };
    let rows: Vec<Vec<[f64; 3]>> = (surface.control_points.iter())
        .map(|row| row.iter().map(|p| p.0.map(length)).collect())
        .collect();
    let mut spline = json!({
        "degree": surface.degree,
        "knots": surface.knots,
        "control_points": rows,
    });
    if let Some(weights) = &surface.weights {
        spline["weights"] = json!(weights);
    }
    input.remove("job");
    input.remove("plate");
    input.insert("surface".into(), spline);
    let name = surface.name.chars().take(100).collect::<String>();
    input.entry("name").or_insert_with(|| name.clone().into());
    Ok(format!("The strip is plate {plate} of that job, {name}."))
}
