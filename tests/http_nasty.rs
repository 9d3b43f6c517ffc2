//! Bodies that nobody should send, and paths that do not exist: the right
//! refusal, never a 5xx.

#![allow(clippy::unwrap_used)] // Helpers of tests: a panic is their failure.

mod http_support;

use axum::http::{Method, StatusCode};
use http_support::{idle_service, job};
use proptest::prelude::*;
use serde_json::Value;

/// A job with one of its texts replaced.
fn twisted(from: &str, to: &str) -> Vec<u8> {
    let text = job("deck").to_string();
    assert!(text.contains(from), "{from}");
    text.replacen(from, to, 1).into_bytes()
}

#[tokio::test]
async fn nasty_json_is_refused_with_its_place() {
    let service = idle_service().await;
    let deep = "[".repeat(70) + &"]".repeat(70);
    let big = "9".repeat(400);
    let cases: Vec<(Vec<u8>, u16, &str, &str)> = vec![
        (b"".to_vec(), 400, "empty-body", ""),
        (b"\xef\xbb\xbf{}".to_vec(), 400, "byte-order-mark", ""),
        (b"{".to_vec(), 400, "syntax", ""),
        (b"{} {}".to_vec(), 400, "syntax", ""),
        (b"\xff\xfe{\0}\0".to_vec(), 400, "syntax", ""),
        (b"null".to_vec(), 422, "wrong-type", ""),
        (b"[]".to_vec(), 422, "wrong-type", ""),
        (b"\"job\"".to_vec(), 422, "wrong-type", ""),
        (
            twisted("\"deck\"", "\"\\ud800\""),
            400,
            "syntax",
            "/input/profiles/0/name",
        ),
        (
            twisted("[0,0,0]", "[0,1e999,0]"),
            400,
            "number-out-of-range",
            "/input/profiles/0/points/0/1",
        ),
        (
            twisted("[0,0,0]", &format!("[0,{big},0]")),
            400,
            "number-out-of-range",
            "/input/profiles/0/points/0/1",
        ),
        (
            twisted("[0,0,0]", "[0,NaN,0]"),
            400,
            "syntax",
            "/input/profiles/0/points/0/1",
        ),
        (
            twisted("[0,0,0]", "[0,Infinity,0]"),
            400,
            "syntax",
            "/input/profiles/0/points/0/1",
        ),
        (
            // A whole 0, and then something that is no comma.
            twisted("[0,0,0]", "[0,0x10,0]"),
            400,
            "syntax",
            "/input/profiles/0/points/0/2",
        ),
        (
            twisted("[0,0,0]", "[0,1.,0]"),
            400,
            "syntax",
            "/input/profiles/0/points/0/1",
        ),
        (
            twisted("[0,0,0]", "[0,\"1\",0]"),
            422,
            "wrong-type",
            "/input/profiles/0/points/0/1",
        ),
        (
            twisted("[0,0,0]", "[0,null,0]"),
            422,
            "wrong-type",
            "/input/profiles/0/points/0/1",
        ),
        (
            twisted("[0,0,0]", "[0,0]"),
            422,
            "too-few",
            "/input/profiles/0/points/0",
        ),
        (
            twisted("[0,0,0]", "[0,0,0,0]"),
            422,
            "too-many",
            "/input/profiles/0/points/0",
        ),
        (
            twisted("[0,0,0]", "[0,1e7,0]"),
            422,
            "out-of-range",
            "/input/profiles/0/points/0/1",
        ),
        (
            twisted("[0,0,0]", "[0,1e300,0]"),
            422,
            "out-of-range",
            "/input/profiles/0/points/0/1",
        ),
        (twisted("[0,0,0]", &deep), 400, "too-deep", ""),
        (
            twisted("\"m\"", "\"m\",\"units\":\"ft\""),
            400,
            "duplicate-key",
            "/units",
        ),
        (twisted("\"m\"", "\"M\""), 422, "not-one-of", "/units"),
        (twisted("\"units\"", "\"unit\""), 422, "missing", "/units"),
        (twisted("\"Bär 1\"", "\"\""), 422, "wrong-length", "/label"),
        (
            twisted("\"Bär 1\"", &format!("\"{}\"", "x".repeat(201))),
            422,
            "wrong-length",
            "/label",
        ),
        (
            twisted("\"name\":\"deck\"", "\"name\":7"),
            422,
            "wrong-type",
            "/input/profiles/0/name",
        ),
        (
            twisted("\"name\":\"deck\"", "\"nom\":\"deck\""),
            422,
            "missing",
            "/input/profiles/0/name",
        ),
    ];
    for (body, status, code, pointer) in cases {
        let shown = String::from_utf8_lossy(&body[..body.len().min(200)]).into_owned();
        let answer = service.post("/v1/jobs", body).await;
        let kind = if status == 400 {
            "syntax"
        } else {
            "invalid-job"
        };
        let problem = answer.problem(status, kind);
        let first = &problem["errors"][0];
        assert_eq!(first["code"], code, "{shown} {problem}");
        if code == "too-deep" {
            let place = first["pointer"].as_str().unwrap();
            assert!(
                place.starts_with("/input/profiles/0/points/0/0/0"),
                "{place}"
            );
        } else {
            assert_eq!(first["pointer"], pointer, "{shown}");
        }
    }
}

#[tokio::test]
async fn syntax_errors_have_line_and_column() {
    let service = idle_service().await;
    let problem = service
        .post("/v1/jobs", "{\n  \"units\": m\n}")
        .await
        .problem(400, "syntax");
    assert!(
        problem["detail"]
            .as_str()
            .unwrap()
            .contains("line 2 column 12"),
        "{problem}"
    );
}

#[tokio::test]
async fn many_faults_are_listed_up_to_fifty() {
    let service = idle_service().await;
    let mut job = job("deck");
    job["input"]["profiles"][0]["points"] = Value::from(vec![Value::from("x"); 500]);
    let problem = service
        .post("/v1/jobs", job.to_string())
        .await
        .problem(422, "invalid-job");
    assert_eq!(problem["errors"].as_array().unwrap().len(), 50);
}

#[tokio::test]
async fn a_million_points_pass_and_one_more_does_not() {
    let service = idle_service().await;
    let job = |n: usize| {
        let mut points = String::with_capacity(9 * n);
        for i in 0..n {
            points.push_str(if i == 0 { "[" } else { "," });
            points.push_str(if i % 2 == 0 { "[0,0,0]" } else { "[1,0,0]" });
        }
        points.push(']');
        format!(
            "{{\"method\":\"hull_plates\",\"units\":\"m\",\"input\":{{\"profiles\":[\
             {{\"name\":\"a\",\"points\":{points}}},\
             {{\"name\":\"b\",\"points\":[[0,1,0],[1,1,0]]}}]}}}}"
        )
    };
    let problem = service
        .post("/v1/jobs", job(999_999))
        .await
        .problem(422, "invalid-job");
    assert_eq!(problem["errors"][0]["pointer"], "/input/profiles");
    assert_eq!(problem["errors"][0]["code"], "too-many");
}

#[tokio::test]
async fn a_flood_of_small_values_is_cut_off() {
    let service = idle_service().await;
    let flood = format!("[{}0]", "0,".repeat(6_100_000));
    let problem = service.post("/v1/jobs", flood).await.problem(400, "syntax");
    assert_eq!(problem["errors"][0]["code"], "too-many-values");
}

#[tokio::test]
async fn unknown_paths_and_methods_are_problems() {
    let service = idle_service().await;
    for path in [
        "/page",
        "/jobs",
        "/v1",
        "/v1/",
        "/v1/job",
        "/v1/jobs/",
        "/v2/jobs",
        "/docs/x/y",
        "/%2e%2e/etc",
    ] {
        service.get(path).await.problem(404, "not-found");
    }
    service
        .get("/docs/nothing.js")
        .await
        .problem(404, "not-found");
    service
        .get("/v1/methods/lofting")
        .await
        .problem(404, "method-not-found");
    service
        .get("/v1/examples/titanic")
        .await
        .problem(404, "example-not-found");
    for (method, path, allow) in [
        (Method::PUT, "/v1/jobs", ["GET", "POST"]),
        (Method::PATCH, "/v1/jobs/x", ["GET", "DELETE"]),
        (Method::POST, "/livez", ["GET", "HEAD"]),
        (Method::OPTIONS, "/v1/methods", ["GET", "HEAD"]),
    ] {
        let answer = service.call(method, path).await;
        answer.problem(405, "method-not-allowed");
        for word in allow {
            assert!(
                answer.header("allow").contains(word),
                "{path}: {}",
                answer.header("allow")
            );
        }
    }
    let head = service.call(Method::HEAD, "/nothing").await;
    assert_eq!(head.status, StatusCode::NOT_FOUND);
    assert!(head.body.is_empty());
}

#[tokio::test]
async fn request_ids_are_kept_if_they_can_be_printed() {
    let service = idle_service().await;
    let kept = service
        .get_with("/livez", &[("x-request-id", "cad-7.1:a_b")])
        .await;
    assert_eq!(kept.header("x-request-id"), "cad-7.1:a_b");
    for bad in ["", "a b", "<script>", &"x".repeat(129)] {
        let answer = service.get_with("/livez", &[("x-request-id", bad)]).await;
        assert_eq!(answer.header("x-request-id").len(), 36, "{bad:?}");
    }
}

fn runtime() -> tokio::runtime::Runtime {
    tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build()
        .unwrap()
}

/// Any byte of a good job may be replaced by any other, any stretch cut or
/// doubled.
#[test]
fn broken_jobs_are_never_our_fault() {
    let runtime = runtime();
    let service = runtime.block_on(idle_service());
    let job = job("deck").to_string().into_bytes();
    let twist = (0..job.len(), any::<u8>(), 0_usize..40, any::<bool>());
    proptest!(ProptestConfig::with_cases(1_000), |((at, byte, cut, twice) in twist)| {
        let mut body = job.clone();
        body[at] = byte;
        let end = (at + cut).min(body.len());
        let stretch: Vec<u8> = body[at..end].to_vec();
        if twice {
            body.splice(at..at, stretch);
        } else {
            body.drain(at..end);
        }
        let post = service.post("/v1/jobs?validate_only=true", body);
        let status = runtime.block_on(post).status;
        prop_assert!(matches!(status.as_u16(), 200 | 400 | 422), "{status}");
    });
}

/// Any text as a query.
#[test]
fn odd_queries_are_never_our_fault() {
    let runtime = runtime();
    let service = runtime.block_on(idle_service());
    proptest!(ProptestConfig::with_cases(1_000), |(query in "[ -~]{0,40}")| {
        let Ok(uri) = format!("/v1/jobs?{query}").parse::<axum::http::Uri>() else {
            return Ok(());
        };
        let status = runtime.block_on(service.get(&uri.to_string())).status;
        prop_assert!(matches!(status.as_u16(), 200 | 400), "{status}");
    });
}
