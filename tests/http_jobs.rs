//! `/v1/jobs`: the life of a job as a client sees it, and every way in which a
//! request can be refused.

#![allow(clippy::unwrap_used)] // Helpers of tests: a panic is their failure.

mod http_support;

use axum::body::{Body, HttpBody};
use axum::http::{Method, StatusCode};
use bytes::Bytes;
use http_support::{Service, idle_service, job, service, service_with};
use hyper::body::Frame;
use mouldloft::http::Limits;
use mouldloft::jobs::QueueConfig;
use serde_json::{Value, json};
use std::pin::Pin;
use std::task::{Context, Poll};
use std::time::Duration;

#[tokio::test]
async fn a_job_is_accepted_and_visible_at_once() {
    let service = idle_service().await;
    let answer = service.post("/v1/jobs", job("deck").to_string()).await;
    assert_eq!(answer.status, StatusCode::ACCEPTED);
    assert!(answer.header("retry-after").parse::<u64>().unwrap() >= 1);
    let body = answer.json();
    let place = answer.header("location");
    assert_eq!(place, format!("/v1/jobs/{}", body["id"].as_str().unwrap()));
    assert_eq!(body["links"]["self"], place);
    assert_eq!(body["status"], "accepted");
    assert_eq!(body["label"], "Bär 1");
    let seen = service.get(place).await;
    assert_eq!(seen.status, StatusCode::OK);
    assert_eq!(seen.json()["id"], body["id"]);
    assert!(!seen.header("retry-after").is_empty());
}

#[tokio::test]
async fn waiting_gives_the_ended_job() {
    let service = service().await;
    let answer = service
        .post("/v1/jobs?wait=20", job("deck").to_string())
        .await;
    assert_eq!(answer.status, StatusCode::OK);
    assert_eq!(answer.header("retry-after"), "");
    let body = answer.json();
    assert_eq!(body["status"], "successful");
    assert_eq!(body["verdict"], "within_limits");
    assert_eq!(body["progress"], 100.0);
    assert_eq!(body["warnings"], json!(["points 3 and 4 were merged"]));
    assert_eq!(body["message"], "One plate, worst twist 0.0°.");
}

#[tokio::test]
async fn the_tag_changes_with_the_job_and_not_otherwise() {
    let service = idle_service().await;
    let posted = service.post("/v1/jobs", job("deck").to_string()).await;
    let place = posted.header("location").to_owned();
    let seen = service.get(&place).await;
    let tag = seen.header("etag").to_owned();
    assert_eq!(posted.header("etag"), tag);
    let again = service.get_with(&place, &[("if-none-match", &tag)]).await;
    assert_eq!(again.status, StatusCode::NOT_MODIFIED);
    assert!(again.body.is_empty());
    assert_eq!(again.header("etag"), tag);
    let canceled = service
        .post(&format!("{place}/cancel"), Body::empty())
        .await;
    assert_eq!(canceled.status, StatusCode::OK);
    let after = service.get_with(&place, &[("if-none-match", &tag)]).await;
    assert_eq!(after.status, StatusCode::OK);
    assert_ne!(after.header("etag"), tag);
}

#[tokio::test]
async fn waiting_with_a_tag_returns_on_the_next_change() {
    let service = service().await;
    let posted = service.post("/v1/jobs", job("slow").to_string()).await;
    let place = posted.header("location").to_owned();
    let tag = loop {
        let seen = service.get(&place).await;
        if seen.json()["phase"] == "fitting" {
            break seen.header("etag").to_owned();
        }
        tokio::time::sleep(Duration::from_millis(5)).await;
    };
    let cancel = format!("{place}/cancel");
    let path = format!("{place}?wait=20");
    let headers = [("if-none-match", tag.as_str())];
    let (seen, told) = tokio::join!(service.get_with(&path, &headers), async {
        tokio::time::sleep(Duration::from_millis(50)).await;
        service.post(&cancel, Body::empty()).await
    });
    assert!(told.status.is_success());
    assert_eq!(seen.status, StatusCode::OK);
    assert_ne!(seen.header("etag"), tag);
}

#[tokio::test]
async fn cancelling_is_harmless_to_repeat() {
    let service = service().await;
    let posted = service.post("/v1/jobs", job("slow").to_string()).await;
    let place = posted.header("location").to_owned();
    let first = service
        .post(&format!("{place}/cancel"), Body::empty())
        .await;
    assert!(
        matches!(first.status.as_u16(), 200 | 202),
        "{}",
        first.status
    );
    let ended = service.get(&format!("{place}?wait=20")).await.json();
    assert_eq!(ended["status"], "dismissed");
    let again = service
        .post(&format!("{place}/cancel"), Body::empty())
        .await;
    assert_eq!(again.status, StatusCode::OK);
    service
        .get(&format!("{place}/result"))
        .await
        .problem(409, "job-dismissed");
}

#[tokio::test]
async fn deleting_erases() {
    let service = service().await;
    let place = service.done(&job("deck")).await;
    let answer = service.call(Method::DELETE, &place).await;
    assert_eq!(answer.status, StatusCode::NO_CONTENT);
    assert!(answer.body.is_empty());
    for path in [
        "",
        "/input",
        "/result",
        "/result.json",
        "/result.obj",
        "/diagnostics",
    ] {
        service
            .get(&format!("{place}{path}"))
            .await
            .problem(404, "job-not-found");
    }
    service
        .call(Method::DELETE, &place)
        .await
        .problem(404, "job-not-found");
}

#[tokio::test]
async fn unknown_jobs_are_404_everywhere() {
    let service = idle_service().await;
    for id in ["5b7c2f5e-9f0e-4f3a-8a57-3a1c1d2e4f60", "nonsense", "%00"] {
        for path in ["", "/input", "/result", "/result.svg", "/diagnostics"] {
            let answer = service.get(&format!("/v1/jobs/{id}{path}")).await;
            answer.problem(404, "job-not-found");
        }
        let cancel = service
            .post(&format!("/v1/jobs/{id}/cancel"), Body::empty())
            .await;
        cancel.problem(404, "job-not-found");
    }
}

#[tokio::test]
async fn the_input_comes_back_byte_for_byte() {
    let service = idle_service().await;
    let odd = format!(
        " \n{}  ",
        serde_json::to_string_pretty(&job("deck")).unwrap()
    );
    let posted = service.post("/v1/jobs", odd.clone()).await;
    let path = format!("{}/input", posted.header("location"));
    let bytes = service.get_raw(&path).await.body;
    assert_eq!(bytes, odd);
    let sha = posted.json()["input_sha256"].as_str().unwrap().to_owned();
    let same = service
        .get_with(&path, &[("if-none-match", &format!("\"{sha}\""))])
        .await;
    assert_eq!(same.status, StatusCode::NOT_MODIFIED);
}

async fn post_keyed(service: &Service, key: &str, job: &Value) -> http_support::Answer {
    let headers = [
        ("content-type", "application/json"),
        ("idempotency-key", key),
    ];
    service
        .post_with("/v1/jobs", &headers, job.to_string())
        .await
}

#[tokio::test]
async fn a_key_gives_the_same_job_or_a_conflict() {
    let service = idle_service().await;
    let first = post_keyed(&service, "k-1", &job("deck")).await;
    assert_eq!(first.status, StatusCode::ACCEPTED);
    assert_eq!(first.header("idempotency-replayed"), "");
    let second = post_keyed(&service, "k-1", &job("deck")).await;
    assert_eq!(second.status, StatusCode::ACCEPTED);
    assert_eq!(second.header("idempotency-replayed"), "true");
    assert_eq!(second.json()["id"], first.json()["id"]);
    post_keyed(&service, "k-1", &job("chine"))
        .await
        .problem(422, "idempotency-key-reused");
    let other = post_keyed(&service, "k-2", &job("deck")).await;
    assert_ne!(other.json()["id"], first.json()["id"]);
    for bad in ["", "a b", &"x".repeat(256)] {
        let problem = post_keyed(&service, bad, &job("deck"))
            .await
            .problem(400, "invalid-header");
        assert_eq!(problem["errors"][0]["pointer"], "Idempotency-Key");
    }
}

#[tokio::test]
async fn a_replay_of_an_ended_job_is_200() {
    let service = service().await;
    let first = post_keyed(&service, "k", &job("deck")).await;
    service
        .get(&format!("{}?wait=20", first.header("location")))
        .await;
    let again = post_keyed(&service, "k", &job("deck")).await;
    assert_eq!(again.status, StatusCode::OK);
    assert_eq!(again.header("idempotency-replayed"), "true");
}

#[tokio::test]
async fn checking_queues_nothing() {
    let service = idle_service().await;
    let answer = service
        .post("/v1/jobs?validate_only=true", job("deck").to_string())
        .await;
    assert_eq!(answer.status, StatusCode::OK);
    assert_eq!(
        answer.json(),
        json!({
            "valid": true,
            "warnings": [],
            "normalized": {
                "bbox_m": {"min": [0.0, 0.0, 0.0], "max": [2.0, 1.0, 0.5]},
                "counts": {"profiles": 2, "plates": 1, "points": 6},
            },
        })
    );
    assert_eq!(service.get("/v1/jobs").await.json()["items"], json!([]));
    let bad = service.post("/v1/jobs?validate_only=true", "{}").await;
    bad.problem(422, "invalid-job");
}

#[tokio::test]
async fn pages_follow_each_other() {
    let service = idle_service().await;
    let mut posted = Vec::new();
    for _ in 0..5 {
        let answer = service.post("/v1/jobs", job("deck").to_string()).await;
        posted.push(answer.json()["id"].as_str().unwrap().to_owned());
    }
    let mut path = "/v1/jobs?limit=2&status=accepted".to_owned();
    let mut listed: Vec<Value> = Vec::new();
    loop {
        let answer = service.get(&path).await;
        assert_eq!(answer.status, StatusCode::OK);
        let page = answer.json();
        listed.extend(page["items"].as_array().unwrap().iter().cloned());
        let Some(link) = answer.header("link").strip_prefix('<') else {
            assert_eq!(page["next_cursor"], Value::Null);
            break;
        };
        let (next, rel) = link.split_once('>').unwrap();
        assert_eq!(rel, "; rel=\"next\"");
        path = next.to_owned();
    }
    // Each once, newest first; two of one millisecond may stand either way.
    let text = |job: &Value, field: &str| job[field].as_str().unwrap().to_owned();
    let times: Vec<String> = listed.iter().map(|job| text(job, "created")).collect();
    assert!(times.is_sorted_by(|a, b| a >= b), "{times:?}");
    let mut ids: Vec<String> = listed.iter().map(|job| text(job, "id")).collect();
    ids.sort();
    posted.sort();
    assert_eq!(ids, posted);
}

#[tokio::test]
async fn lists_are_filtered() {
    let service = idle_service().await;
    service.post("/v1/jobs", job("deck").to_string()).await;
    for (query, n) in [
        ("status=accepted", 1),
        ("status=failed", 0),
        ("method=hull_plates", 1),
        ("method=other", 0),
        ("label=B%C3%A4r%201", 1),
        ("label=B%C3%A4r+1", 1),
        ("label=B", 0),
    ] {
        let items = service.get(&format!("/v1/jobs?{query}")).await.json()["items"].clone();
        assert_eq!(items.as_array().unwrap().len(), n, "{query}");
    }
}

#[tokio::test]
async fn queries_are_strict() {
    let service = idle_service().await;
    for (path, pointer) in [
        ("/v1/jobs?limt=5", "?limt"),
        ("/v1/jobs?limit=0", "?limit"),
        ("/v1/jobs?limit=201", "?limit"),
        ("/v1/jobs?limit=+5", "?limit"),
        ("/v1/jobs?limit=", "?limit"),
        ("/v1/jobs?limit=5&limit=5", "?limit"),
        ("/v1/jobs?status=done", "?status"),
        ("/v1/jobs?cursor=nonsense", "?cursor"),
        (
            "/v1/jobs/5b7c2f5e-9f0e-4f3a-8a57-3a1c1d2e4f60?wait=56",
            "?wait",
        ),
        ("/v1/methods?x=1", "?x"),
        ("/livez?verbose", "?verbose"),
        ("/version?%00=%FF", "?\u{0}"),
    ] {
        let problem = service.get(path).await.problem(400, "invalid-query");
        assert_eq!(problem["errors"][0]["pointer"], pointer, "{path}");
    }
    let typo = service.get("/v1/jobs?limt=5").await.json();
    assert_eq!(typo["errors"][0]["hint"], "did you mean \"limit\"?");
    let answer = service
        .post("/v1/jobs?validate_only=yes", job("deck").to_string())
        .await;
    answer.problem(400, "invalid-query");
}

#[tokio::test]
async fn bodies_must_say_that_they_are_json() {
    let service = idle_service().await;
    for kind in [
        "",
        "text/plain",
        "application/x-www-form-urlencoded",
        "application/jsonx",
        "\u{fc}",
    ] {
        let headers: &[(&str, &str)] = if kind.is_empty() {
            &[]
        } else {
            &[("content-type", kind)]
        };
        let answer = service
            .post_with("/v1/jobs", headers, job("deck").to_string())
            .await;
        let problem = answer.problem(415, "unsupported-media-type");
        assert!(problem["errors"][0]["hint"].is_string());
    }
    for kind in [
        "application/json",
        "Application/JSON; charset=utf-8",
        "application/vnd.x+json",
    ] {
        let headers = [("content-type", kind)];
        let answer = service
            .post_with("/v1/jobs", &headers, job("deck").to_string())
            .await;
        assert_eq!(answer.status, StatusCode::ACCEPTED, "{kind}");
    }
}

fn small_limits() -> Limits {
    Limits {
        wire_bytes: 2_000,
        inflated_bytes: 10_000,
        ..Limits::default()
    }
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    // Stored blocks would not shrink; runs of one byte do, by a real encoder:
    // the service's own, through its answer compression, is not at hand here.
    use std::io::Write;
    let mut child = std::process::Command::new("gzip")
        .stdin(std::process::Stdio::piped())
        .stdout(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    let mut input = child.stdin.take().unwrap();
    let bytes = bytes.to_vec();
    let writer = std::thread::spawn(move || input.write_all(&bytes).unwrap());
    let packed = child.wait_with_output().unwrap().stdout;
    writer.join().unwrap();
    packed
}

#[tokio::test]
async fn sizes_are_bounded_on_the_wire_and_unpacked() {
    let config = QueueConfig {
        workers: 0,
        ..QueueConfig::default()
    };
    let service = service_with(config, small_limits()).await;
    let padded = |n: usize| format!("{}{}", job("deck"), " ".repeat(n));
    let fits = service.post("/v1/jobs", padded(100)).await;
    assert_eq!(fits.status, StatusCode::ACCEPTED);
    service
        .post("/v1/jobs", padded(3_000))
        .await
        .problem(413, "too-large");
    // Without an announced length the stream itself is cut.
    let stream = Body::new(Chunks(vec![&[b' '; 1_500]; 2]));
    service
        .post("/v1/jobs", stream)
        .await
        .problem(413, "too-large");
    let packed_headers = [
        ("content-type", "application/json"),
        ("content-encoding", "gzip"),
    ];
    let packed = gzip(padded(5_000).as_bytes());
    let fits = service.post_with("/v1/jobs", &packed_headers, packed).await;
    assert_eq!(fits.status, StatusCode::ACCEPTED);
    let bomb = gzip(padded(1_000_000).as_bytes());
    assert!(bomb.len() < 2_000);
    let answer = service.post_with("/v1/jobs", &packed_headers, bomb).await;
    answer.problem(413, "too-large");
    let answer = service
        .post_with("/v1/jobs", &packed_headers, "not gzip")
        .await;
    answer.problem(400, "syntax");
    let other = [
        ("content-type", "application/json"),
        ("content-encoding", "br"),
    ];
    let answer = service.post_with("/v1/jobs", &other, "x").await;
    answer.problem(415, "unsupported-media-type");
}

/// A body without an announced length, in ready chunks.
struct Chunks(Vec<&'static [u8]>);

impl HttpBody for Chunks {
    type Data = Bytes;
    type Error = std::io::Error;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        _: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, Self::Error>>> {
        Poll::Ready(
            self.0
                .pop()
                .map(|chunk| Ok(Frame::data(Bytes::from_static(chunk)))),
        )
    }
}

#[tokio::test]
async fn a_body_that_never_comes_is_given_up() {
    let config = QueueConfig {
        workers: 0,
        ..QueueConfig::default()
    };
    let limits = Limits {
        body_time: Duration::from_millis(20),
        ..Limits::default()
    };
    let service = service_with(config, limits).await;
    let answer = service.post("/v1/jobs", Body::new(Never)).await;
    answer.problem(408, "body-timeout");
}

/// A body that never comes.
struct Never;

impl HttpBody for Never {
    type Data = Bytes;
    type Error = std::io::Error;

    fn poll_frame(
        self: Pin<&mut Self>,
        _: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, Self::Error>>> {
        Poll::Pending
    }
}

#[tokio::test]
async fn an_answer_that_takes_too_long_is_given_up() {
    let config = QueueConfig {
        workers: 0,
        ..QueueConfig::default()
    };
    let limits = Limits {
        answer_time: Duration::from_millis(20),
        ..Limits::default()
    };
    let service = service_with(config, limits).await;
    let answer = service.post("/v1/jobs", Body::new(Never)).await;
    answer.problem(503, "timeout");
    assert_eq!(answer.header("retry-after"), "1");
}

#[tokio::test]
async fn a_full_queue_says_when_to_come_back() {
    let config = QueueConfig {
        workers: 0,
        max_queued: 1,
        ..QueueConfig::default()
    };
    let service = service_with(config, Limits::default()).await;
    assert_eq!(
        service
            .post("/v1/jobs", job("deck").to_string())
            .await
            .status,
        202
    );
    let answer = service.post("/v1/jobs", job("deck").to_string()).await;
    answer.problem(503, "queue-full");
    assert!(answer.header("retry-after").parse::<u64>().unwrap() >= 1);
}

#[tokio::test]
async fn going_down_refuses_jobs_and_readiness() {
    let service = service().await;
    let place = service.done(&job("deck")).await;
    service.queue.drain(Duration::ZERO).await;
    let answer = service.post("/v1/jobs", job("deck").to_string()).await;
    answer.problem(503, "draining");
    let problem = service.get("/readyz").await.problem(503, "not-ready");
    assert!(
        problem["detail"].as_str().unwrap().contains("going down"),
        "{problem}"
    );
    assert_eq!(service.get("/livez").await.status, StatusCode::OK);
    assert_eq!(service.get(&place).await.status, StatusCode::OK);
}

#[tokio::test]
async fn a_slip_in_a_methods_name_is_told() {
    let service = idle_service().await;
    let mut job = job("deck");
    job["method"] = "hull_platse".into();
    let problem = service
        .post("/v1/jobs", job.to_string())
        .await
        .problem(422, "invalid-job");
    assert_eq!(problem["errors"][0]["pointer"], "/method");
    assert_eq!(
        problem["errors"][0]["hint"],
        "did you mean \"hull_plates\"?"
    );
}
