//! From the bytes of a job to the method's request: strict JSON, then the
//! schema, then what needs two values at once. The HTTP handler, the engine
//! and the command line all come this way, so they refuse the same jobs.

use super::did_you_mean::nearest;
use super::methods::{self, Job, Method};
use super::problem::{ApiError, Code, FieldError};
use super::strict_json::{self, excerpt};
use serde_json::Value;
use sha2::{Digest, Sha256};

/// Reads a job.
///
/// # Errors
/// `syntax` with the place of the first fault; `invalid-job` with every broken
/// rule.
pub fn read_job(bytes: &[u8]) -> Result<Box<dyn Job>, ApiError> {
    let (method, value) = read_value(bytes)?;
    method
        .read(value)
        .map_err(|faults| ApiError::at(Code::InvalidJob, faults))
}

/// As [`read_job`], up to the schema: the method and a value that keeps its
/// rule.
///
/// # Errors
/// As [`read_job`].
pub fn read_value(bytes: &[u8]) -> Result<(&'static dyn Method, Value), ApiError> {
    let value = strict_json::parse(bytes).map_err(|e| ApiError::at(Code::Syntax, vec![e]))?;
    let method = method_of(&value)?;
    let rule = method.rule().map_err(|e| ApiError::internal(e))?;
    let faults = rule.faults(&value);
    if faults.is_empty() {
        Ok((method, value))
    } else {
        Err(ApiError::at(Code::InvalidJob, faults))
    }
}

/// The method that a job names; its rule is that of the job.
fn method_of(value: &Value) -> Result<&'static dyn Method, ApiError> {
    let known = methods::names();
    let fault = |code, message: String| FieldError::new("/method", code, message);
    let one_of = format!("this must be one of {}", known.join(", "));
    let fault = match &value["method"] {
        _ if !value.is_object() => {
            FieldError::new("", "wrong-type", "this must be an object").value(excerpt(value))
        }
        Value::Null if value.get("method").is_none() => {
            fault("missing", "the field \"method\" is missing".into()).hint(one_of)
        }
        Value::String(name) => {
            if let Some(method) = methods::named(name) {
                return Ok(method);
            }
            let fault = fault("not-one-of", one_of).value(excerpt(&value["method"]));
            match nearest(name, &known) {
                Some(near) => fault.hint(format!("did you mean \"{near}\"?")),
                None => fault,
            }
        }
        other => fault("wrong-type", "this must be a string".into()).value(excerpt(other)),
    };
    Err(ApiError::at(Code::InvalidJob, vec![fault]))
}

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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::http::dto::Point;
    use crate::http::dto::hull_plates::{HullPlatesInput, HullPlatesOptions, to_request};
    use crate::http::dto::job::Units;

    fn two() -> HullPlatesInput {
        serde_json::from_str(TWO).unwrap()
    }

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
    fn defaults_are_those_of_the_method() {
        let given: HullPlatesOptions = serde_json::from_str("{}").unwrap();
        let options = to_request(&two(), &given, Units::M).unwrap().options;
        assert_eq!(
            options,
            crate::methods::hull_plates::request::Options::default()
        );
        let n = read_job(job(TWO, "").as_bytes()).unwrap().normalized();
        let counts: Vec<_> = n.counts.iter().map(|(k, v)| (k.as_str(), *v)).collect();
        assert_eq!(counts, [("plates", 1), ("points", 4), ("profiles", 2)]);
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
}
