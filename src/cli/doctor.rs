//! `mouldloft doctor`: can this machine run the loft? Opens the store as
//! `serve` would, measures the disk, fits a small cone through the queue, and
//! says in sentences what it found.

use super::{Exit, files, out};
use crate::app;
use crate::http::{ENGINE_VERSION, intake};
use crate::jobs::clock::{Clock as _, SystemClock};
use crate::jobs::{Health, Job, NewJob, Queue, Status, Tenant, Unmetered};
use crate::settings::StoreSettings;
use bytes::Bytes;
use serde_json::{Value, json};
use std::sync::Arc;
use std::time::Duration;

/// A small cone takes a fraction of a second; longer means a stuck worker.
const CANARY_BUDGET: Duration = Duration::from_secs(30);
/// A cone is developable: its rulings cannot twist by more than this, degrees.
const CANARY_TWIST_DEG: f64 = 0.1;
/// Below this rate of syncs single jobs are accepted noticeably slowly.
const SLOW_SYNCS: f64 = 50.0;

/// What was found, good and bad.
#[derive(Default)]
struct Findings {
    bad: usize,
}

impl Findings {
    fn good(&self, sentence: &str) {
        out::line(&format!("good  {sentence}"));
    }

    fn bad(&mut self, sentence: &str) {
        self.bad += 1;
        out::line(&format!("BAD   {sentence}"));
    }
}

/// Examines and reports; 0 when nothing is wrong.
pub async fn run(settings: &StoreSettings) -> Exit {
    let mut findings = Findings::default();
    examine(settings, &mut findings).await;
    if findings.bad == 0 {
        out::line("Everything is in order.");
        Exit::Done
    } else {
        out::line(&format!("{} of the checks failed.", findings.bad));
        Exit::Trouble
    }
}

async fn examine(settings: &StoreSettings, findings: &mut Findings) {
    let queue = match app::open_queue(settings, Arc::new(Unmetered)).await {
        Ok(queue) => queue,
        Err(error) => return findings.bad(&format!("The job store does not open: {error}.")),
    };
    store(&queue.health().await, settings, findings);
    if !settings.ephemeral {
        disk(settings, findings);
    }
    if queue.health().await.workers == 0 {
        findings.good("There are no workers here by setting; no fit was tried.");
    } else {
        canary(&queue, findings).await;
    }
    queue.drain(Duration::ZERO).await;
}

fn store(health: &Health, settings: &StoreSettings, findings: &mut Findings) {
    match &health.sqlite_version {
        Some(version) => findings.good(&format!(
            "The job store in {} opens with SQLite {version}.",
            settings.data.display()
        )),
        None => findings.good("The job store is in memory and ends with the process."),
    }
    let reasons = health.reasons();
    for reason in &reasons {
        findings.bad(&format!("Not ready: {reason}."));
    }
    if reasons.is_empty() {
        findings.good("The job store can be written.");
    }
    if let Some(free) = health.disk_free_bytes {
        findings.good(&format!("The disk has {} MB free.", free / 1_000_000));
    }
}

fn disk(settings: &StoreSettings, findings: &mut Findings) {
    let clock = SystemClock::new();
    match files::syncs_per_second(&settings.data, || clock.monotonic()) {
        Ok(rate) if rate < SLOW_SYNCS => findings.bad(&format!(
            "The disk confirms only {rate:.0} writes a second; single jobs are accepted no faster."
        )),
        Ok(rate) => findings.good(&format!("The disk confirms {rate:.0} writes a second.")),
        Err(error) => findings.bad(&format!("The disk cannot be measured: {error}.")),
    }
}

/// Runs a small cone through the queue and takes it out again.
async fn canary(queue: &Queue, findings: &mut Findings) {
    let tenant = Tenant::local();
    let submitted = queue.submit(&tenant, canary_job()).await;
    let id = match submitted {
        Ok(accepted) => accepted.job().id,
        Err(error) => return findings.bad(&format!("A canary job is not accepted: {error}.")),
    };
    let ended = queue.wait_ended(&tenant, id, CANARY_BUDGET * 2).await;
    match ended {
        Ok(job) if job.status == Status::Successful => {
            let result = queue.result(&tenant, id).await;
            let result = result.ok().and_then(|r| serde_json::from_slice(&r).ok());
            judge(&job, &result.unwrap_or(Value::Null), findings);
        }
        Ok(job) => {
            let why = job.failure.map_or(job.message, |f| f.detail);
            findings.bad(&format!(
                "A canary fit ended as {}: {why}.",
                job.status.as_str()
            ));
        }
        Err(error) => findings.bad(&format!("A canary job was lost: {error}.")),
    }
    if let Err(error) = queue.delete(&tenant, id).await {
        findings.bad(&format!("The canary job cannot be erased: {error}."));
    }
}

fn judge(job: &Job, result: &Value, findings: &mut Findings) {
    let twist = result["diagnostics"]["plates"][0]["twist_max_deg"].as_f64();
    let took = job.solve_ms.unwrap_or(f64::NAN);
    match twist {
        Some(twist) if twist <= CANARY_TWIST_DEG => {
            findings.good(&format!(
                "A worker fitted a small cone in {took:.0} ms, twist {twist:.1e}°."
            ));
        }
        Some(twist) => findings.bad(&format!(
            "A worker fitted a small cone with a twist of {twist:.2}°, which no cone has: \
             the numbers of this machine or this build cannot be trusted."
        )),
        None => findings.bad("A worker fitted a small cone, but its result cannot be read."),
    }
}

/// A quarter of a right circular cone between two arcs.
fn canary_job() -> NewJob {
    let arc = |radius: f64, z: f64| -> Vec<[f64; 3]> {
        let angle = |i: i32| std::f64::consts::FRAC_PI_2 * f64::from(i) / 12.0;
        (0..=12)
            .map(angle)
            .map(|a| [radius * a.cos(), radius * a.sin(), z])
            .collect()
    };
    let job = json!({
        "method": "hull_plates",
        "label": "doctor's cone",
        "units": "m",
        "input": {"profiles": [
            {"name": "upper", "points": arc(2.0, 1.0)},
            {"name": "lower", "points": arc(1.0, 0.0)},
        ]},
    });
    let input = Bytes::from(job.to_string());
    NewJob {
        method: "hull_plates".to_owned(),
        label: Some("doctor's cone".to_owned()),
        input_sha256: intake::sha256_hex(&input),
        input,
        budget: CANARY_BUDGET,
        idempotency: None,
        engine_version: ENGINE_VERSION.to_owned(),
        warnings: Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_canary_is_a_valid_job() {
        let read = intake::read_job(&canary_job().input);
        assert!(read.is_ok(), "{:?}", read.err());
    }
}
