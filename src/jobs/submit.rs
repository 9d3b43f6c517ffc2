//! Submitting a job to the [`Queue`].
//!
//! Refusing is decided before the store is troubled, so that an overloaded
//! service says no quickly; the store decides again inside its transaction.

use super::core::{SOON, Stage, WHEN_THERE_IS_ROOM, bump};
use super::error::QueueError;
use super::model::{Accepted, IdempotencyKey, NewJob, Tenant};
use super::queue::Queue;
use super::store::{Admission, Limits};

impl Queue {
    /// Accepts a job. When this returns, the job is on disk and visible.
    ///
    /// # Errors
    /// `IdempotencyConflict`, `QueueFull`, `StorageFull`, `Draining`,
    /// `Unavailable`, `Store`.
    pub async fn submit(&self, tenant: &Tenant, new: NewJob) -> Result<Accepted, QueueError> {
        let submitted = match self.refusal(new.input.len() as u64) {
            None => self.accept(tenant, new).await,
            Some(refusal) => match &new.idempotency {
                // Room or not: what is known already can be told.
                Some(key) => self.replay(tenant, key, refusal).await,
                None => Err(refusal),
            },
        };
        self.count(&submitted);
        submitted
    }

    /// Why nothing can be accepted now, as far as that is known without the
    /// store's transaction.
    fn refusal(&self, bytes: u64) -> Option<QueueError> {
        let core = &self.core;
        if core.stage() > Stage::Open {
            return Some(QueueError::Draining { retry_after: SOON });
        }
        if core.broken.borrow().is_some() {
            return Some(QueueError::Unavailable { retry_after: SOON });
        }
        if let Some(free) = core.store.free_bytes()
            && free < core.config.min_free_bytes.saturating_add(bytes)
        {
            return Some(QueueError::StorageFull {
                retry_after: WHEN_THERE_IS_ROOM,
            });
        }
        let backlog = core.store.state().backlog;
        let full = backlog.queued >= core.config.max_queued
            || backlog.queued_bytes.saturating_add(bytes) > core.config.max_queued_bytes;
        full.then(|| self.queue_full())
    }

    fn queue_full(&self) -> QueueError {
        let queued = self.core.store.state().backlog.queued;
        let retry_after = self.core.pace.retry_after(queued, self.core.config.workers);
        QueueError::QueueFull { retry_after }
    }

    async fn accept(&self, tenant: &Tenant, new: NewJob) -> Result<Accepted, QueueError> {
        let config = &self.core.config;
        let limits = Limits {
            jobs: config.max_queued,
            bytes: config.max_queued_bytes,
            idempotency_age: config.idempotency_age,
        };
        let admission = self.core.store.accept(tenant, new, limits).await;
        let accepted = self.admitted(self.told(admission)?)?;
        self.core.wake.notify_one();
        Ok(accepted)
    }

    async fn replay(
        &self,
        tenant: &Tenant,
        key: &IdempotencyKey,
        refusal: QueueError,
    ) -> Result<Accepted, QueueError> {
        let age = self.core.config.idempotency_age;
        let known = self.core.store.replay(tenant, key, age).await;
        match self.told(known)? {
            Some(known) => self.admitted(known),
            None => Err(refusal),
        }
    }

    fn admitted(&self, admission: Admission) -> Result<Accepted, QueueError> {
        match admission {
            Admission::New(job) => Ok(Accepted::New(self.freshened(job))),
            Admission::Replayed(job) => Ok(Accepted::Replayed(self.freshened(job))),
            Admission::KeyConflict => Err(QueueError::IdempotencyConflict),
            Admission::QueueFull => Err(self.queue_full()),
        }
    }

    fn count(&self, submitted: &Result<Accepted, QueueError>) {
        let (counters, meter) = (&self.core.counters, &self.core.meter);
        let reason = match submitted {
            Ok(Accepted::New(job)) => {
                bump(&counters.accepted);
                return meter.accepted(&job.method);
            }
            Ok(Accepted::Replayed(_)) => return bump(&counters.replayed),
            Err(QueueError::QueueFull { .. }) => "queue-full",
            Err(QueueError::StorageFull { .. }) => "storage-full",
            Err(QueueError::Draining { .. }) => "draining",
            Err(QueueError::Unavailable { .. }) => "unavailable",
            Err(_) => return,
        };
        bump(&counters.rejected);
        meter.rejected(reason);
    }
}
