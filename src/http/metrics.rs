//! `GET /metrics` in the Prometheus text format, and the meter of requests and
//! jobs behind it. The recorder belongs to the service, not to the process, so
//! that two services in one test process do not mix.

use super::Api;
use super::extract::{Asked, Nothing};
use super::openapi::Everywhere;
use super::respond;
use crate::jobs::clock::{Clock, SystemClock};
use crate::jobs::meter::Ended;
use crate::jobs::{Meter, Stats};
use axum::extract::State;
use axum::http::Method;
use axum::response::Response;
use metrics::{counter, gauge, histogram};
use metrics_exporter_prometheus::{PrometheusBuilder, PrometheusRecorder};
use std::sync::Arc;
use std::time::Duration;

/// Bounds of the histograms, seconds: from a status call to a long fit.
const BUCKETS_S: [f64; 13] = [
    0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1.0, 5.0, 20.0, 60.0,
];

/// The figures of one service.
pub struct Metrics {
    recorder: PrometheusRecorder,
    clock: SystemClock,
}

impl std::fmt::Debug for Metrics {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Metrics").finish_non_exhaustive()
    }
}

impl Metrics {
    /// Figures that stand at zero; hand them to the queue as its meter and to
    /// [`Api::new`](super::Api::new).
    #[must_use]
    pub fn new() -> Arc<Metrics> {
        let builder = PrometheusBuilder::new();
        // The list is not empty, the only thing that is refused.
        let builder = builder
            .set_buckets(&BUCKETS_S)
            .unwrap_or_else(|_| PrometheusBuilder::new());
        Arc::new(Metrics {
            recorder: builder.build_recorder(),
            clock: SystemClock::new(),
        })
    }

    /// Starts measuring a request.
    #[must_use]
    pub fn timer(self: &Arc<Self>) -> Timer {
        Timer {
            metrics: Arc::clone(self),
            begun: self.clock.monotonic(),
        }
    }

    /// The text that Prometheus reads.
    #[must_use]
    pub fn render(&self, stats: &Stats) -> String {
        self.record(|| {
            #[allow(clippy::cast_precision_loss)]
            let set = |name: &'static str, value: u64| gauge!(name).set(value as f64);
            set("mouldloft_jobs_queued", stats.queued);
            set("mouldloft_jobs_queued_bytes", stats.queued_bytes);
            set("mouldloft_jobs_running", stats.running);
            set("mouldloft_workers", stats.workers as u64);
            counter!("mouldloft_jobs_replayed_total").absolute(stats.replayed);
            counter!("mouldloft_fit_panics_total").absolute(stats.panics);
            counter!("mouldloft_stale_results_total").absolute(stats.stale_results);
        });
        let handle = self.recorder.handle();
        handle.run_upkeep();
        handle.render()
    }

    fn record(&self, what: impl FnOnce()) {
        metrics::with_local_recorder(&self.recorder, what);
    }
}

/// A request that is being measured.
#[derive(Debug)]
pub struct Timer {
    metrics: Arc<Metrics>,
    begun: Duration,
}

impl Timer {
    /// Counts the request; returns how long it took, in seconds.
    pub fn observe(&self, method: &Method, route: Option<&str>, status: u16) -> f64 {
        let seconds = self
            .metrics
            .clock
            .monotonic()
            .saturating_sub(self.begun)
            .as_secs_f64();
        // The route, not the path: ids would make a series of every job.
        let labels = [
            ("method", method.as_str().to_owned()),
            ("route", route.unwrap_or("none").to_owned()),
            ("status", status.to_string()),
        ];
        self.metrics.record(|| {
            counter!("mouldloft_http_requests_total", &labels).increment(1);
            histogram!("mouldloft_http_request_seconds", &labels[..2]).record(seconds);
        });
        seconds
    }
}

impl Meter for Metrics {
    fn accepted(&self, method: &str) {
        let labels = [("method", method.to_owned())];
        self.record(|| counter!("mouldloft_jobs_accepted_total", &labels).increment(1));
    }

    fn rejected(&self, reason: &'static str) {
        self.record(|| counter!("mouldloft_jobs_rejected_total", "reason" => reason).increment(1));
    }

    fn ended(&self, end: &Ended<'_>) {
        let labels = [
            ("method", end.method.to_owned()),
            ("status", end.status.as_str().to_owned()),
            ("code", end.failure_code.unwrap_or_default().to_owned()),
        ];
        let times = [
            ("mouldloft_job_wait_seconds", end.waited_ms),
            ("mouldloft_job_solve_seconds", end.solve_ms),
            ("mouldloft_job_overhead_seconds", end.overhead_ms),
        ];
        self.record(|| {
            counter!("mouldloft_jobs_ended_total", &labels).increment(1);
            for (name, ms) in times {
                if let Some(ms) = ms {
                    histogram!(name).record(ms / 1e3);
                }
            }
        });
    }
}

/// Counters, gauges and histograms for Prometheus.
#[utoipa::path(
    get, path = "/metrics", tag = "service",
    responses(
        (status = 200, description = "Prometheus text format", body = String, content_type = "text/plain"),
        Everywhere,
    ),
)]
pub(super) async fn get_metrics(State(api): State<Api>, _: Asked<Nothing>) -> Response {
    respond::text(
        "text/plain; version=0.0.4; charset=utf-8",
        api.metrics.render(&api.queue.stats()),
    )
}
