//! From the bytes of a job to the method's request: strict JSON, then the
//! schema, then what needs two values at once. The HTTP handler, the engine
//! and the command line all come this way, so they refuse the same jobs.

use super::dto::job::{BoundingBox, Counts, JobRequest, Normalized};
use super::dto::{Point, ProfileCurve, to_request};
use super::problem::{ApiError, Code, FieldError};
use super::schema_check::Rule;
use super::strict_json;
use crate::methods::hull_plates::Request;
use serde_json::{Map, Value};
use sha2::{Digest, Sha256};
use std::sync::LazyLock;
use utoipa::{PartialSchema, ToSchema};

/// Methods that are announced but not built.
const UNBUILT: [&str; 3] = ["cone_spline", "fairing", "curvature_net"];

/// A job that is fit to be queued.
#[derive(Debug, Clone, PartialEq)]
pub struct Submission {
    /// The job as it was posted, defaults filled in.
    pub job: JobRequest,
    /// The same as the method takes it.
    pub request: Request,
}

/// Reads a job.
///
/// # Errors
/// `syntax` with the place of the first fault; `method-not-available`;
/// `invalid-job` with every broken rule.
pub fn read_job(bytes: &[u8]) -> Result<Submission, ApiError> {
    let value = strict_json::parse(bytes).map_err(|e| ApiError::at(Code::Syntax, vec![e]))?;
    if let Some(name) = value["method"]
        .as_str()
        .filter(|name| UNBUILT.contains(name))
    {
        let detail = format!("{name} is planned but not built yet; hull_plates is available");
        return Err(ApiError::new(Code::MethodNotAvailable, detail));
    }
    let rule = JOB_RULE.as_ref().map_err(|e| ApiError::internal(e))?;
    let faults = rule.faults(&value);
    if !faults.is_empty() {
        return Err(ApiError::at(Code::InvalidJob, faults));
    }
    let job: JobRequest = serde_json::from_value(value).map_err(|e| {
        // The schema has passed, so this is a gap between schema and type.
        ApiError::at(
            Code::InvalidJob,
            vec![FieldError::new("", "invalid", e.to_string())],
        )
    })?;
    let request = to_request(&job.input, &job.options, job.units)
        .map_err(|faults| ApiError::at(Code::InvalidJob, faults))?;
    Ok(Submission { job, request })
}

/// The rule of a job, out of the schema that is published.
static JOB_RULE: LazyLock<Result<Rule, String>> = LazyLock::new(|| {
    let mut schemas = Vec::new();
    JobRequest::schemas(&mut schemas);
    let components = schemas
        .into_iter()
        .map(|(name, schema)| Ok((name, serde_json::to_value(schema)?)))
        .collect::<Result<Map<String, Value>, serde_json::Error>>()
        .map_err(|e| e.to_string())?;
    let schema = serde_json::to_value(JobRequest::schema()).map_err(|e| e.to_string())?;
    Rule::compile(&schema, &components)
});

/// SHA-256, hexadecimal.
#[must_use]
pub fn sha256_hex(bytes: &[u8]) -> String {
    use std::fmt::Write;
    Sha256::digest(bytes)
        .iter()
        .fold(String::with_capacity(64), |mut hex, byte| {
            // Writing to a String cannot fail.
            let _ = write!(hex, "{byte:02x}");
            hex
        })
}

impl Submission {
    /// The job as it was understood, in metres.
    #[must_use]
    pub fn normalized(&self) -> Normalized {
        let metres = self.job.units.metres();
        let profiles = &self.job.input.profiles;
        let mut bounds = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
        let mut count = 0;
        for point in profiles.iter().flat_map(points) {
            count += 1;
            let [least, greatest] = &mut bounds;
            for ((low, high), x) in least.iter_mut().zip(greatest).zip(point.0) {
                *low = low.min(x * metres);
                *high = high.max(x * metres);
            }
        }
        Normalized {
            bbox_m: BoundingBox {
                min: Point(bounds[0]),
                max: Point(bounds[1]),
            },
            counts: Counts {
                profiles: profiles.len(),
                plates: profiles.len().saturating_sub(1),
                points: count,
            },
        }
    }
}

/// The given points, or the control points, of a profile.
fn points(profile: &ProfileCurve) -> impl Iterator<Item = &Point> {
    let given = profile.points.iter().flatten();
    given.chain(profile.bspline.iter().flat_map(|s| &s.control_points))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pointers(job: &str) -> Vec<(String, String)> {
        let error = read_job(job.as_bytes()).unwrap_err();
        error
            .errors
            .into_iter()
            .map(|e| (e.pointer, e.code))
            .collect()
    }

    fn job(input: &str, rest: &str) -> String {
        format!("{{\"method\":\"hull_plates\",\"units\":\"m\",\"input\":{input}{rest}}}")
    }

    const TWO: &str = r#"{"profiles":[{"name":"a","points":[[0,0,0],[1,0,0]]},
                                      {"name":"b","points":[[0,1,0],[1,1,0]]}]}"#;

    #[test]
    fn the_published_schema_compiles_to_a_rule() {
        assert!(JOB_RULE.is_ok(), "{:?}", JOB_RULE.as_ref().err());
    }

    #[test]
    fn defaults_are_those_of_the_method() {
        let submission = read_job(job(TWO, "").as_bytes()).unwrap();
        assert_eq!(
            submission.request.options,
            crate::methods::hull_plates::request::Options::default()
        );
        let n = submission.normalized();
        assert_eq!(
            (n.counts.profiles, n.counts.plates, n.counts.points),
            (2, 1, 4)
        );
        assert_eq!(n.bbox_m.max, Point([1.0, 1.0, 0.0]));
    }

    #[test]
    fn every_fault_has_its_pointer() {
        let cases = [
            (
                job(TWO, r#","options":{"max_twist":3}"#),
                "/options/max_twist",
                "unknown-field",
            ),
            (
                job(TWO, r#","options":{"max_twist_deg":0}"#),
                "/options/max_twist_deg",
                "out-of-range",
            ),
            (
                job(TWO, r#","options":{"boundary":{"mode":"tolerance"}}"#),
                "/options/boundary/value",
                "missing",
            ),
            (
                job(TWO, r#","options":{"boundary":{"mode":"exact","value":1}}"#),
                "/options/boundary/value",
                "unexpected",
            ),
            (
                job(
                    TWO,
                    r#","options":{"pinned_rulings":[{"plate":1,"from":[0,0,0],"to":[0,0,0]}]}"#,
                ),
                "/options/pinned_rulings/0/plate",
                "out-of-range",
            ),
            (
                job(
                    TWO,
                    r#","options":{"pinned_rulings":[{"plate":0,"from":[0,0,0],"to":[0,2e6,0]}]}"#,
                ),
                "/options/pinned_rulings/0/to/1",
                "out-of-range",
            ),
            (
                job(&TWO.replace("[1,0,0]", "[1,0,-1e6]"), ""),
                "/input/profiles/0/points/1/2",
                "out-of-range",
            ),
            (
                job(&TWO.replace("[1,0,0]", "[1,0]"), ""),
                "/input/profiles/0/points/1",
                "too-few",
            ),
            (
                job(&TWO.replace("[1,0,0]", "[1,0,null]"), ""),
                "/input/profiles/0/points/1/2",
                "wrong-type",
            ),
            (job(r#"{"profiles":[]}"#, ""), "/input/profiles", "too-few"),
            (
                job(TWO, r#","budget":{"time_s":0}"#),
                "/budget/time_s",
                "out-of-range",
            ),
            (
                job(TWO, "").replace("\"m\"", "\"feet\""),
                "/units",
                "not-one-of",
            ),
            (
                job(TWO, "").replace("\"units\":\"m\",", ""),
                "/units",
                "missing",
            ),
            (
                job(TWO, "").replace("hull_plates", "hull_plate"),
                "/method",
                "not-one-of",
            ),
        ];
        for (text, pointer, code) in cases {
            assert_eq!(pointers(&text), [(pointer.into(), code.into())], "{text}");
        }
    }

    #[test]
    fn spline_profiles_are_checked() {
        let spline = |knots: &str, more: &str| {
            let curve = format!(
                r#"{{"name":"a","bspline":{{"degree":1.0,"knots":{knots},
                    "control_points":[[0,0,0],[1,0,0]]{more}}}}}"#
            );
            job(
                &TWO.replace(r#"{"name":"a","points":[[0,0,0],[1,0,0]]}"#, &curve),
                "",
            )
        };
        assert!(read_job(spline("[0,0,1,1]", "").as_bytes()).is_ok());
        let at = "/input/profiles/0/bspline";
        for (text, pointer, code) in [
            (spline("[0,0,1,1,1]", ""), "/knots", "wrong-count"),
            (spline("[0,0,1,0]", ""), "/knots/3", "not-sorted"),
            (
                spline("[0,0,1,1]", ",\"weights\":[1]"),
                "/weights",
                "wrong-count",
            ),
            (
                spline("[0,0,1,1]", ",\"weights\":[1,0]"),
                "/weights/1",
                "out-of-range",
            ),
        ] {
            assert_eq!(
                pointers(&text),
                [(format!("{at}{pointer}"), code.into())],
                "{text}"
            );
        }
    }

    #[test]
    fn unbuilt_methods_are_known() {
        let error = read_job(br#"{"method":"fairing"}"#).unwrap_err();
        assert_eq!(error.code, Code::MethodNotAvailable);
    }
}
