//! The handle through which everybody else uses the queue.
//!
//! Reading merges what the store knows with what the fits of this process have
//! shown since their last beat. Submitting is in `submit`, waiting in `wait`.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use bytes::Bytes;

use super::clock::{Clock, SystemClock};
use super::config::QueueConfig;
use super::control::Why;
use super::core::{Core, Stage};
use super::engine::Engine;
use super::error::{OpenError, QueueError};
use super::health::Health;
use super::meter::{Meter, Stats};
use super::model::{Job, JobId, ListQuery, Page, Status, Tenant};
use super::start::Running;
use super::store::{BlobKind, Looked, StoreError};

/// The queue. Cloning is cheap; all clones are the same queue. When the last
/// is dropped without [`Queue::drain`], running fits are stopped and their
/// jobs are taken up again when the store is opened next.
#[derive(Clone)]
pub struct Queue {
    pub(super) core: Arc<Core>,
    running: Arc<Running>,
}

impl Queue {
    /// Opens the store, recovers what a previous process left running and
    /// starts the workers. To be called on a tokio runtime.
    ///
    /// # Errors
    /// See [`OpenError`]; nothing was started then.
    pub async fn open(
        config: QueueConfig,
        engine: Arc<dyn Engine>,
        meter: Arc<dyn Meter>,
    ) -> Result<Queue, OpenError> {
        Queue::open_with_clock(config, engine, meter, Arc::new(SystemClock::new())).await
    }

    /// [`Queue::open`] with another clock, for tests.
    ///
    /// # Errors
    /// As [`Queue::open`].
    pub async fn open_with_clock(
        config: QueueConfig,
        engine: Arc<dyn Engine>,
        meter: Arc<dyn Meter>,
        clock: Arc<dyn Clock>,
    ) -> Result<Queue, OpenError> {
        let (core, running) = super::start::start(config, engine, meter, clock).await?;
        Ok(Queue {
            core,
            running: Arc::new(running),
        })
    }

    /// The job as it stands this moment.
    ///
    /// # Errors
    /// `NotFound`, `Unavailable`, `Store`.
    pub async fn get(&self, tenant: &Tenant, id: JobId) -> Result<Job, QueueError> {
        let found = self.core.store.get(tenant, id).await;
        let job = self.told(found)?.ok_or(QueueError::NotFound)?;
        Ok(self.freshened(job))
    }

    /// One page of jobs, newest first.
    ///
    /// # Errors
    /// `InvalidCursor`, `Unavailable`, `Store`.
    pub async fn list(&self, tenant: &Tenant, query: ListQuery) -> Result<Page, QueueError> {
        let found = self.core.store.list(tenant, query).await;
        let page = self.told(found)?.ok_or(QueueError::InvalidCursor)?;
        let items = page.items.into_iter();
        Ok(Page {
            items: items.map(|job| self.freshened(job)).collect(),
            next_cursor: page.next_cursor,
        })
    }

    /// Cancels a job: a waiting one is dismissed at once, a running one is
    /// told to stop, an ended one stays as it is. Harmless to repeat.
    ///
    /// # Errors
    /// As [`Queue::get`], and `StorageFull`.
    pub async fn cancel(&self, tenant: &Tenant, id: JobId) -> Result<Job, QueueError> {
        let cancelled = self.core.store.cancel(tenant, id).await;
        let cancelled = self.told(cancelled)?.ok_or(QueueError::NotFound)?;
        if cancelled.job.status == Status::Running {
            self.core.live.stop(id, Why::Cancelled);
        }
        if cancelled.changed {
            self.core.announce(&cancelled.job);
        }
        Ok(self.freshened(cancelled.job))
    }

    /// Erases a job with its input and results; stops it if it is active.
    ///
    /// # Errors
    /// As [`Queue::get`], and `StorageFull`.
    pub async fn delete(&self, tenant: &Tenant, id: JobId) -> Result<(), QueueError> {
        let deleted = self.core.store.delete(tenant, id).await;
        if !self.told(deleted)? {
            return Err(QueueError::NotFound);
        }
        self.core.live.stop(id, Why::LeaseLost);
        self.core.hub.deleted(id);
        Ok(())
    }

    /// The input, byte for byte.
    ///
    /// # Errors
    /// As [`Queue::get`], and `Expired`.
    pub async fn input(&self, tenant: &Tenant, id: JobId) -> Result<Bytes, QueueError> {
        let looked = self.look(tenant, id, BlobKind::Input).await?;
        looked.blob.ok_or(QueueError::Expired)
    }

    /// The result, byte for byte.
    ///
    /// # Errors
    /// As [`Queue::get`], and `NotReady`, `Failed`, `Dismissed`, `Expired`.
    pub async fn result(&self, tenant: &Tenant, id: JobId) -> Result<Bytes, QueueError> {
        let looked = self.look(tenant, id, BlobKind::Result).await?;
        let job = Box::new(looked.job);
        match job.status {
            Status::Accepted | Status::Running => Err(QueueError::NotReady(job)),
            Status::Failed => Err(QueueError::Failed(job)),
            Status::Dismissed => Err(QueueError::Dismissed(job)),
            Status::Successful => looked.blob.ok_or(QueueError::Expired),
        }
    }

    /// The diagnostics, byte for byte; none if the job left none.
    ///
    /// # Errors
    /// As [`Queue::get`], and `NotReady` before the job has ended, `Expired`.
    pub async fn diagnostics(
        &self,
        tenant: &Tenant,
        id: JobId,
    ) -> Result<Option<Bytes>, QueueError> {
        let looked = self.look(tenant, id, BlobKind::Diagnostics).await?;
        if !looked.job.status.is_ended() {
            return Err(QueueError::NotReady(Box::new(looked.job)));
        }
        if looked.erased {
            return Err(QueueError::Expired);
        }
        Ok(looked.blob)
    }

    /// How the queue is, as of the last beat or write.
    pub async fn health(&self) -> Health {
        let core = &self.core;
        let state = core.store.state();
        let disk_free_bytes = core.store.free_bytes();
        Health {
            store_writable: state.writable && core.broken.borrow().is_none(),
            disk_free_bytes,
            disk_nearly_full: disk_free_bytes.is_some_and(|f| f < core.config.min_free_bytes),
            last_worker_beat_age: core.beat_age(),
            draining: core.stage() > Stage::Open,
            accepted: state.backlog.queued,
            running: state.backlog.running,
            stuck: core.counters.stuck.load(Ordering::Relaxed),
            workers: core.config.workers,
            sqlite_version: core.store.sqlite_version(),
        }
    }

    /// Counters and gauges; reads no disk.
    #[must_use]
    pub fn stats(&self) -> Stats {
        let of = |counter: &AtomicU64| counter.load(Ordering::Relaxed);
        let (counters, backlog) = (&self.core.counters, self.core.store.state().backlog);
        Stats {
            accepted: of(&counters.accepted),
            replayed: of(&counters.replayed),
            rejected: of(&counters.rejected),
            successful: of(&counters.successful),
            failed: of(&counters.failed),
            dismissed: of(&counters.dismissed),
            panics: of(&counters.panics),
            stale_results: of(&counters.stale),
            queued: backlog.queued,
            queued_bytes: backlog.queued_bytes,
            running: backlog.running,
            workers: self.core.config.workers,
        }
    }

    /// Goes down: accepts and begins nothing more, lets running fits end for
    /// `grace`, then stops them and gives their jobs back without counting a
    /// lost lease. Waiting callers get the job as it stands: at once if it will
    /// not begin any more, else at the end. Harmless to repeat; reading still
    /// works afterwards. The store is closed when the last handle is dropped.
    pub async fn drain(&self, grace: Duration) {
        self.running.drain(&self.core, grace).await;
    }

    /// Ends once the service goes down, for those who keep streams open.
    pub async fn draining(&self) {
        self.core.reached(Stage::Draining).await;
    }

    /// Ends when the store is broken beyond use (an I/O error on commit), with
    /// the reason: the process should exit then, a restart recovers.
    pub async fn broken(&self) -> String {
        let mut broken = self.core.broken.subscribe();
        let reason = match broken.wait_for(Option::is_some).await {
            Ok(reason) => reason.clone(),
            Err(_) => None,
        };
        reason.unwrap_or_default()
    }

    async fn look(&self, tenant: &Tenant, id: JobId, kind: BlobKind) -> Result<Looked, QueueError> {
        let looked = self.core.store.blob(tenant, id, kind).await;
        let mut looked = self.told(looked)?.ok_or(QueueError::NotFound)?;
        looked.job = self.freshened(looked.job);
        Ok(looked)
    }

    /// The job with the latest progress of this process, and an estimate.
    pub(super) fn freshened(&self, mut job: Job) -> Job {
        self.core.live.overlay(&mut job);
        job.eta_s = self.core.estimate(&job);
        job
    }

    pub(super) fn told<T>(&self, answer: Result<T, StoreError>) -> Result<T, QueueError> {
        answer.map_err(|error| self.core.explain(&error))
    }
}
