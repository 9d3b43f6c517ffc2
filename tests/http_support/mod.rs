//! A service in memory for the HTTP tests: the real router and queue around a
//! fit that does what the first profile's name says.

#![allow(dead_code)] // Each test file uses its own part.

use axum::Router;
use axum::body::Body;
use axum::http::{HeaderMap, Method, Request, StatusCode};
use bytes::Bytes;
use http_body_util::BodyExt;
use mouldloft::geometry::{BSplineCurve, BSplineSurface};
use mouldloft::http::engine::run_with;
use mouldloft::http::{Api, Engine, Limits, Metrics, router};
use mouldloft::jobs::{self, Queue, QueueConfig};
use mouldloft::methods::hull_plates::outcome::{
    Deviation, Fan, MovedPoint, Outcome, OutcomeProfile, Plate, PlateDiagnostics, Ruling,
    Termination,
};
use mouldloft::methods::hull_plates::request::{ProfileShape, Request as FitRequest};
use mouldloft::methods::{Control, FitError, Issue};
use nalgebra::Point3;
use serde_json::{Value, json};
use std::sync::Arc;
use std::time::Duration;
use tower::ServiceExt;

/// The service under test.
pub struct Service {
    pub router: Router,
    pub queue: Queue,
}

/// An answer, body read.
pub struct Answer {
    pub status: StatusCode,
    pub headers: HeaderMap,
    pub body: Bytes,
}

impl Answer {
    pub fn json(&self) -> Value {
        serde_json::from_slice(&self.body)
            .unwrap_or_else(|e| panic!("{e}: {}", String::from_utf8_lossy(&self.body)))
    }

    pub fn header(&self, name: &str) -> &str {
        self.headers.get(name).map_or("", |v| v.to_str().unwrap())
    }

    /// Checks that this is a complete problem document with this status and
    /// code, and gives it.
    #[track_caller]
    pub fn problem(&self, status: u16, code: &str) -> Value {
        let text = String::from_utf8_lossy(&self.body);
        assert_eq!(self.status.as_u16(), status, "{text}");
        assert_eq!(self.header("content-type"), "application/problem+json");
        let problem = self.json();
        assert_eq!(problem["code"], code, "{text}");
        assert_eq!(problem["status"], status);
        assert_eq!(problem["request_id"], self.header("x-request-id"));
        for field in ["type", "title", "detail", "instance", "request_id"] {
            assert!(
                problem[field].as_str().is_some_and(|s| !s.is_empty()),
                "{field}: {text}"
            );
        }
        problem
    }
}

/// A service with workers that run [`fit`].
pub async fn service() -> Service {
    service_with(
        QueueConfig {
            workers: 1,
            ..QueueConfig::default()
        },
        Limits::default(),
    )
    .await
}

/// A service that accepts and runs nothing.
pub async fn idle_service() -> Service {
    service_with(
        QueueConfig {
            workers: 0,
            ..QueueConfig::default()
        },
        Limits::default(),
    )
    .await
}

/// A service that fits in earnest.
pub async fn real_service() -> Service {
    let config = QueueConfig {
        workers: 1,
        ..QueueConfig::default()
    };
    service_around(Arc::new(Engine), config, Limits::default()).await
}

pub async fn service_with(config: QueueConfig, limits: Limits) -> Service {
    service_around(Arc::new(TestEngine), config, limits).await
}

async fn service_around(
    engine: Arc<dyn jobs::Engine>,
    config: QueueConfig,
    limits: Limits,
) -> Service {
    let metrics = Metrics::new();
    let config = QueueConfig {
        data_dir: None,
        ..config
    };
    let queue = Queue::open(config, engine, metrics.clone()).await.unwrap();
    let api = Api::new(queue.clone(), metrics)
        .unwrap()
        .with_limits(limits);
    Service {
        router: router(api),
        queue,
    }
}

impl Service {
    pub async fn send(&self, request: Request<Body>) -> Answer {
        let answer = self.send_raw(request).await;
        check_manners(&answer);
        answer
    }

    /// Gets bytes that are not the service's own: they need no newline.
    pub async fn get_raw(&self, path: &str) -> Answer {
        self.send_raw(Request::get(path).body(Body::empty()).unwrap())
            .await
    }

    async fn send_raw(&self, request: Request<Body>) -> Answer {
        let response = self.router.clone().oneshot(request).await.unwrap();
        let (parts, body) = response.into_parts();
        let body = body.collect().await.unwrap().to_bytes();
        Answer {
            status: parts.status,
            headers: parts.headers,
            body,
        }
    }

    pub async fn call(&self, method: Method, path: &str) -> Answer {
        self.send(
            Request::builder()
                .method(method)
                .uri(path)
                .body(Body::empty())
                .unwrap(),
        )
        .await
    }

    pub async fn get(&self, path: &str) -> Answer {
        self.call(Method::GET, path).await
    }

    pub async fn get_with(&self, path: &str, headers: &[(&str, &str)]) -> Answer {
        self.send(
            with_headers(Request::get(path), headers)
                .body(Body::empty())
                .unwrap(),
        )
        .await
    }

    pub async fn post(&self, path: &str, body: impl Into<Body>) -> Answer {
        self.post_with(path, &[("content-type", "application/json")], body)
            .await
    }

    pub async fn post_with(
        &self,
        path: &str,
        headers: &[(&str, &str)],
        body: impl Into<Body>,
    ) -> Answer {
        self.send(
            with_headers(Request::post(path), headers)
                .body(body.into())
                .unwrap(),
        )
        .await
    }

    /// Posts a job, waits for its end, gives its path.
    pub async fn done(&self, job: &Value) -> String {
        let answer = self.post("/v1/jobs?wait=20", job.to_string()).await;
        assert_eq!(
            answer.status,
            StatusCode::OK,
            "{}",
            String::from_utf8_lossy(&answer.body)
        );
        answer.header("location").to_owned()
    }
}

fn with_headers(
    mut builder: axum::http::request::Builder,
    headers: &[(&str, &str)],
) -> axum::http::request::Builder {
    for (name, value) in headers {
        builder = builder.header(*name, *value);
    }
    builder
}

/// What every answer must have.
#[track_caller]
fn check_manners(answer: &Answer) {
    assert!(!answer.header("x-request-id").is_empty());
    let kind = answer.header("content-type");
    // The page's own scripts and styles are as they are.
    let text = kind.contains("json")
        || ["text/plain", "text/csv"]
            .iter()
            .any(|k| kind.starts_with(k));
    let whole = answer.status != StatusCode::PARTIAL_CONTENT;
    if text && whole && !answer.body.is_empty() && answer.header("content-encoding").is_empty() {
        assert!(answer.body.ends_with(b"\n"), "no newline at the end");
    }
}

/// A job whose first profile has this name, which tells [`fit`] what to do.
pub fn job(first: &str) -> Value {
    json!({
        "method": "hull_plates",
        "label": "Bär 1",
        "units": "m",
        "input": {"profiles": [
            {"name": first, "points": [[0, 0, 0], [1, 0, 0], [2, 0, 0.5]]},
            {"name": "keel", "points": [[0, 1, 0], [1, 1, 0], [2, 1, 0.5]]},
        ]},
    })
}

/// Runs [`fit`] through the real intake and writers.
struct TestEngine;

impl jobs::Engine for TestEngine {
    fn run(
        &self,
        _method: &str,
        input: &[u8],
        control: &dyn Control,
    ) -> Result<jobs::Product, jobs::EngineError> {
        run_with(fit, input, control)
    }
}

fn fit(request: &FitRequest, control: &dyn Control) -> Result<Outcome, FitError> {
    match request.profiles[0].name.as_str() {
        "invalid" => Err(FitError::Invalid(vec![Issue {
            path: ["input", "profiles", "1"].map(str::to_owned).to_vec(),
            code: "opposite-direction",
            message: "profile 1 runs against profile 0".into(),
            hint: Some("reverse it".into()),
        }])),
        "numerical" => Err(FitError::Numerical("the matrix is singular".into())),
        "panic" => panic!("on purpose"),
        "slow" => loop {
            control.progress("fitting", 40.0);
            control.check()?;
            std::thread::sleep(Duration::from_millis(2));
        },
        _ => Ok(outcome(request)),
    }
}

/// A made-up outcome of the right form, infinities included.
fn outcome(request: &FitRequest) -> Outcome {
    let lines: Vec<Vec<Point3<f64>>> = (request.profiles.iter())
        .map(|p| match &p.shape {
            ProfileShape::Points(points) => points.clone(),
            ProfileShape::BSpline(curve) => curve.control_points().to_vec(),
        })
        .collect();
    let n = lines[0].len();
    let zero = Deviation {
        points_max: 0.0,
        curve_max: 0.0,
        curve_mean: 0.0,
        curve_rms: 0.0,
    };
    let moved = MovedPoint {
        index: 1,
        given: lines[0][1],
        now: lines[0][1],
        distance: 0.0,
    };
    let profiles = request
        .profiles
        .iter()
        .zip(&lines)
        .map(|(profile, line)| OutcomeProfile {
            name: profile.name.clone(),
            curve: BSplineCurve::new(1, knots(n), line.clone(), None).unwrap(),
            deviation: zero,
            moved_points: vec![moved],
        });
    Outcome {
        within_limits: true,
        summary: vec![
            "One plate, worst twist 0.0°.".into(),
            "Plate 1: flat.".into(),
        ],
        warnings: vec!["points 3 and 4 were merged".into()],
        model_size: 2.0,
        profiles: profiles.collect(),
        plates: lines
            .windows(2)
            .map(|pair| plate(&pair[0], &pair[1]))
            .collect(),
    }
}

fn knots(n: usize) -> Vec<f64> {
    #[allow(clippy::cast_precision_loss)]
    let inner = (0..n).map(|i| i as f64 / (n - 1) as f64);
    [0.0].into_iter().chain(inner).chain([1.0]).collect()
}

fn plate(first: &[Point3<f64>], second: &[Point3<f64>]) -> Plate {
    let n = first.len();
    let points = first
        .iter()
        .zip(second)
        .flat_map(|(a, b)| [*a, *b])
        .collect();
    let rulings = first
        .iter()
        .zip(second)
        .zip(knots(n).split_off(1))
        .map(|((a, b), u)| Ruling {
            u,
            from: *a,
            to: *b,
            twist_deg: 0.25,
            bend_radius_from: f64::INFINITY,
            bend_radius_to: -3.5,
        });
    Plate {
        name: "deck – keel".into(),
        surface: BSplineSurface::new([1, 1], [knots(n), vec![0.0, 0.0, 1.0, 1.0]], points, None)
            .unwrap(),
        within_limits: true,
        sentence: "Flat.".into(),
        rulings: rulings.collect(),
        fans: vec![Fan {
            at_start: true,
            apex_on_first: false,
            swept_percent: 3.0,
            u_range: [0.0, 0.1],
        }],
        extensions: [0.0; 4],
        diagnostics: figures(first[0]),
    }
}

fn figures(at: Point3<f64>) -> PlateDiagnostics {
    PlateDiagnostics {
        twist_max_deg: 0.25,
        twist_max_u: 0.5,
        twist_max_at: at,
        twist_mean_deg: 0.1,
        twist_p95_deg: 0.2,
        corner_warp_deg: [0.0, 0.5],
        bottleneck_deg: 0.2,
        bottleneck_grid: 200,
        regression_clearance: f64::INFINITY,
        crossing_rulings: 0,
        min_bend_radius: 3.5,
        min_bend_radius_u: 0.5,
        bend_strain_percent: None,
        fan_percent: [0.0, 3.0],
        extension_percent: 0.0,
        membrane_strain_percent: 0.0,
        gaussian_curvature_max: 1e-12,
        area: 2.0,
        pinned_deviation: None,
        termination: Termination {
            iterations: 12,
            reason: "gradient",
        },
    }
}
