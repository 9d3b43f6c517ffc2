//! What the handle, the workers and the keeper share.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use tokio::sync::{Notify, watch};
use tracing::error;
use uuid::Uuid;

use super::clock::Clock;
use super::config::QueueConfig;
use super::engine::Engine;
use super::error::QueueError;
use super::hub::Hub;
use super::live::Live;
use super::meter::{Ended, Meter};
use super::model::{Job, Status, Timestamp};
use super::pace::Pace;
use super::store::{Owner, Store, StoreError};

/// When to try again after something that heals by itself or by a restart.
pub(super) const SOON: Duration = Duration::from_secs(2);

/// When to try again on a full disk: somebody has to make room.
pub(super) const WHEN_THERE_IS_ROOM: Duration = Duration::from_secs(10);

/// Progress below this, in percent, says little about how long the rest takes.
const TELLING_PERCENT: f64 = 10.0;

/// How far the service is on its way down.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Stage {
    /// Everything works.
    Open,
    /// Nothing is accepted or begun; what runs may end.
    Draining,
    /// Nothing runs.
    Closed,
}

/// Counters since the start.
#[derive(Default)]
pub(super) struct Counters {
    pub accepted: AtomicU64,
    pub replayed: AtomicU64,
    pub rejected: AtomicU64,
    pub successful: AtomicU64,
    pub failed: AtomicU64,
    pub dismissed: AtomicU64,
    pub panics: AtomicU64,
    pub stale: AtomicU64,
    /// A gauge: fits that were told to stop and have not.
    pub stuck: AtomicU64,
}

/// One more.
pub(super) fn bump(counter: &AtomicU64) {
    counter.fetch_add(1, Ordering::Relaxed);
}

/// What the queue is made of.
pub(super) struct Core {
    pub config: QueueConfig,
    pub store: Arc<dyn Store>,
    pub engine: Arc<dyn Engine>,
    pub meter: Arc<dyn Meter>,
    pub clock: Arc<dyn Clock>,
    /// This process, in leases.
    pub owner: Owner,
    pub hub: Hub,
    pub live: Live,
    pub pace: Pace,
    pub counters: Counters,
    /// Something may wait for a worker.
    pub wake: Notify,
    pub stage: watch::Sender<Stage>,
    /// Why the store is beyond use, once it is.
    pub broken: watch::Sender<Option<String>>,
    /// The monotonic time of the last beat, in milliseconds.
    last_beat_ms: AtomicU64,
}

/// What a [`Core`] is given.
pub(super) struct Parts {
    pub config: QueueConfig,
    pub store: Arc<dyn Store>,
    pub engine: Arc<dyn Engine>,
    pub meter: Arc<dyn Meter>,
    pub clock: Arc<dyn Clock>,
}

impl Core {
    /// A queue at rest.
    pub fn new(parts: Parts) -> Self {
        let core = Core {
            config: parts.config,
            store: parts.store,
            engine: parts.engine,
            meter: parts.meter,
            clock: parts.clock,
            owner: Owner(Uuid::new_v4().to_string()),
            hub: Hub::default(),
            live: Live::default(),
            pace: Pace::default(),
            counters: Counters::default(),
            wake: Notify::new(),
            stage: watch::channel(Stage::Open).0,
            broken: watch::channel(None).0,
            last_beat_ms: AtomicU64::new(0),
        };
        core.note_beat();
        core
    }

    /// How far it is on its way down.
    pub fn stage(&self) -> Stage {
        *self.stage.borrow()
    }

    /// Ends once the stage is `stage` or beyond.
    pub async fn reached(&self, stage: Stage) {
        let mut stages = self.stage.subscribe();
        // The sender lives in `self`, so waiting cannot fail.
        let _ = stages.wait_for(|now| *now >= stage).await;
    }

    /// A worker showed life.
    pub fn note_beat(&self) {
        let now = u64::try_from(self.clock.monotonic().as_millis()).unwrap_or(u64::MAX);
        self.last_beat_ms.store(now, Ordering::Relaxed);
    }

    /// Time since a worker showed life; none without workers.
    pub fn beat_age(&self) -> Option<Duration> {
        let last = Duration::from_millis(self.last_beat_ms.load(Ordering::Relaxed));
        (self.config.workers > 0).then(|| self.clock.monotonic().saturating_sub(last))
    }

    /// Keeps in mind that the store is beyond use, if that is what `error` says.
    pub fn note(&self, error: &StoreError) {
        if let StoreError::Broken(reason) = error {
            self.broken.send_if_modified(|known| {
                let first = known.is_none();
                known.get_or_insert_with(|| reason.clone());
                first
            });
        }
    }

    /// What a caller hears of a store's error.
    pub fn explain(&self, error: &StoreError) -> QueueError {
        self.note(error);
        match error {
            StoreError::Full => QueueError::StorageFull {
                retry_after: WHEN_THERE_IS_ROOM,
            },
            StoreError::Busy(_) | StoreError::Broken(_) => {
                QueueError::Unavailable { retry_after: SOON }
            }
            StoreError::Corrupt(_) | StoreError::Defect(_) => {
                let reference = Uuid::new_v4().to_string();
                error!(%reference, %error, "the job store");
                QueueError::Store { reference }
            }
        }
    }

    /// Seconds until an active job has ended: from its own progress once that
    /// says something, else from what recent jobs took.
    pub fn estimate(&self, job: &Job) -> Option<f64> {
        match job.status {
            Status::Accepted => self
                .pace
                .until_end(job.queue_position?, self.config.workers),
            Status::Running => {
                let spent_s = between(job.started, Some(self.clock.now()))?.max(0.0) / 1000.0;
                if job.progress >= TELLING_PERCENT {
                    return Some(spent_s * (100.0 - job.progress) / job.progress);
                }
                self.pace.mean_s().map(|mean| (mean - spent_s).max(0.0))
            }
            _ => None,
        }
    }

    /// This process changed the state of a job: counts an end, and wakes those
    /// who wait for it.
    pub fn announce(&self, job: &Job) {
        let counter = match job.status {
            Status::Successful => &self.counters.successful,
            Status::Failed => &self.counters.failed,
            Status::Dismissed => &self.counters.dismissed,
            Status::Accepted | Status::Running => return self.hub.changed(job.id),
        };
        bump(counter);
        let held_ms = between(job.started, job.finished);
        if let (Some(held_ms), Some(_)) = (held_ms, job.solve_ms) {
            self.pace.ended(held_ms / 1000.0);
        }
        self.meter.ended(&Ended {
            method: &job.method,
            status: job.status,
            failure_code: job.failure.as_ref().map(|f| f.code.as_str()),
            waited_ms: between(Some(job.created), job.started),
            solve_ms: job.solve_ms,
            overhead_ms: held_ms
                .zip(job.solve_ms)
                .map(|(held, solve)| (held - solve).max(0.0)),
        });
        self.hub.ended(job);
    }
}

/// Milliseconds between two moments, if both are known.
fn between(from: Option<Timestamp>, to: Option<Timestamp>) -> Option<f64> {
    #[expect(clippy::cast_precision_loss, reason = "milliseconds of a job's life")]
    from.zip(to).map(|(from, to)| to.millis_since(from) as f64)
}
