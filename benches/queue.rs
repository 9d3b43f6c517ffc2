//! What the queue itself costs: overhead per small job (its end on disk less
//! the time in the engine), and how quickly status calls are answered over HTTP
//! while every worker fits.
//!
//! A plain harness: percentiles of a running service, which sampling
//! frameworks for functions do not measure. `cargo bench --bench queue`.

use mouldloft::app::{FrontLimits, Service};
use mouldloft::http::Metrics;
use mouldloft::jobs::meter::Ended;
use mouldloft::jobs::{
    Engine, EngineError, Meter, NewJob, Product, Queue, QueueConfig, Tenant, Verdict,
};
use mouldloft::methods::Control;
use std::error::Error;
use std::hint::black_box;
use std::io::Write as _;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Enough jobs for a 99th percentile that stands on more than one job.
const SMALL_JOBS: usize = 500;
/// Status calls while everything fits.
const STATUS_CALLS: usize = 2_000;
/// Size of a small result, bytes.
const RESULT: usize = 50_000;
/// A small job's fit.
const SMALL_FIT: Duration = Duration::from_millis(5);
/// The busy engine of the second part spins until told to stop; this is only
/// how often it looks.
const LOOK: u32 = 10_000;

/// Burns the core: for a while on `small` jobs, until told on others.
struct Burner {
    stop: Arc<AtomicBool>,
}

impl Engine for Burner {
    fn run(&self, method: &str, _: &[u8], control: &dyn Control) -> Result<Product, EngineError> {
        let start = Instant::now();
        let done = || match method {
            "small" => start.elapsed() >= SMALL_FIT,
            _ => self.stop.load(Ordering::Relaxed),
        };
        let mut x = 1.0_f64;
        while !done() {
            for _ in 0..LOOK {
                x = black_box(x * 1.000_000_1);
            }
            control.check().map_err(EngineError::Stopped)?;
        }
        Ok(Product {
            result: vec![b'0'; RESULT],
            diagnostics: b"{}".to_vec(),
            verdict: Verdict::WithinLimits,
            warnings: Vec::new(),
            message: String::new(),
        })
    }
}

/// Keeps the overhead of every job that ended.
#[derive(Default)]
struct Overheads(Mutex<Vec<f64>>);

impl Meter for Overheads {
    fn ended(&self, end: &Ended<'_>) {
        let mut seen = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        seen.extend(end.overhead_ms);
    }
}

fn job(method: &str) -> NewJob {
    NewJob {
        method: method.to_owned(),
        label: None,
        input: bytes::Bytes::from_static(b"{}"),
        input_sha256: "0".repeat(64),
        budget: Duration::from_secs(300),
        idempotency: None,
        engine_version: "bench".to_owned(),
        warnings: Vec::new(),
    }
}

fn percentile(sorted: &[f64], percent: usize) -> f64 {
    let last = sorted.len().saturating_sub(1);
    sorted
        .get((sorted.len() * percent / 100).min(last))
        .copied()
        .unwrap_or(f64::NAN)
}

fn report(what: &str, mut milliseconds: Vec<f64>) -> Result<(), Box<dyn Error>> {
    milliseconds.sort_by(f64::total_cmp);
    let [p50, p99] = [50, 99].map(|p| percentile(&milliseconds, p));
    writeln!(
        std::io::stdout(),
        "{what}: p50 {p50:.2} ms, p99 {p99:.2} ms ({} samples)",
        milliseconds.len()
    )?;
    Ok(())
}

#[tokio::main]
async fn main() -> Result<(), Box<dyn Error>> {
    let folder = tempfile::tempdir()?;
    let config = QueueConfig {
        data_dir: Some(folder.path().join("data")),
        ..QueueConfig::default()
    };
    let workers = config.workers;
    let stop = Arc::new(AtomicBool::new(false));
    let overheads = Arc::new(Overheads::default());
    let engine = Arc::new(Burner {
        stop: Arc::clone(&stop),
    });
    let queue = Queue::open(config, engine, Arc::clone(&overheads) as Arc<dyn Meter>).await?;
    small_jobs(&queue).await?;
    let seen = overheads
        .0
        .lock()
        .unwrap_or_else(PoisonError::into_inner)
        .clone();
    report("overhead of a small job", seen)?;
    report(
        "status while every worker fits",
        status_calls(&queue, workers).await?,
    )?;
    stop.store(true, Ordering::Relaxed);
    queue.drain(Duration::from_secs(5)).await;
    Ok(())
}

/// Submits small jobs one behind the other and waits for all.
async fn small_jobs(queue: &Queue) -> Result<(), Box<dyn Error>> {
    let tenant = Tenant::local();
    let start = Instant::now();
    let mut ids = Vec::new();
    for _ in 0..SMALL_JOBS {
        ids.push(queue.submit(&tenant, job("small")).await?.job().id);
    }
    for id in ids {
        queue
            .wait_ended(&tenant, id, Duration::from_secs(300))
            .await?;
    }
    let rate = SMALL_JOBS as f64 / start.elapsed().as_secs_f64();
    writeln!(
        std::io::stdout(),
        "{SMALL_JOBS} small jobs end to end: {rate:.0} a second"
    )?;
    Ok(())
}

/// Milliseconds of status calls over HTTP while all workers are busy.
async fn status_calls(queue: &Queue, workers: usize) -> Result<Vec<f64>, Box<dyn Error>> {
    let tenant = Tenant::local();
    let mut id = None;
    for _ in 0..workers {
        id = Some(queue.submit(&tenant, job("endless")).await?.job().id);
    }
    let Some(id) = id else {
        return Ok(Vec::new());
    };
    while queue.stats().running < workers as u64 {
        tokio::time::sleep(Duration::from_millis(1)).await;
    }
    let listener = tokio::net::TcpListener::bind(("127.0.0.1", 0)).await?;
    let limits = FrontLimits {
        connections: 16,
        header_timeout: Duration::from_secs(10),
    };
    let service = Service::over(queue.clone(), Metrics::new(), listener, limits)?;
    let url = format!("http://{}/v1/jobs/{id}", service.address());
    let client = reqwest::Client::new();
    let mut milliseconds = Vec::with_capacity(STATUS_CALLS);
    for _ in 0..STATUS_CALLS {
        let start = Instant::now();
        let answer = client.get(&url).send().await?.error_for_status()?;
        black_box(answer.bytes().await?);
        milliseconds.push(start.elapsed().as_secs_f64() * 1e3);
    }
    Ok(milliseconds)
}
