//! The store that keeps nothing: the model that the others are tested against,
//! and what `--ephemeral` runs on.
//!
//! One map under one lock, written for being obviously right: every method is
//! the sentence of the trait, nothing is cached. Reading a job's place walks
//! the queue. Limits: everything is in memory, uncompressed, until it is swept
//! or the process ends.

mod entry;
mod rows;

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use self::rows::Rows;
use super::shared::words;
use super::{
    Admission, Answer, Beat, BlobKind, Cancelled, Claim, End, Fence, Limits, Looked, Owner, Pulse,
    Retention, Store, StoreError, StoreState, Swept,
};
use crate::jobs::clock::Clock;
use crate::jobs::model::{
    IdempotencyKey, Job, JobId, ListQuery, NewJob, Page, Status, Tenant, Timestamp,
};

/// The store in memory.
pub struct MemoryStore {
    clock: Arc<dyn Clock>,
    rows: Mutex<Rows>,
}

impl MemoryStore {
    /// An empty store.
    #[must_use]
    pub fn new(clock: Arc<dyn Clock>) -> Self {
        MemoryStore {
            clock,
            rows: Mutex::default(),
        }
    }

    fn rows(&self) -> MutexGuard<'_, Rows> {
        self.rows.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Does `work` under the lock, as a finished answer.
    fn with<'a, T: Send + 'a>(
        &'a self,
        work: impl FnOnce(&mut Rows, Timestamp) -> T,
    ) -> Answer<'a, T> {
        let done: Result<T, StoreError> = Ok(work(&mut self.rows(), self.clock.now()));
        Box::pin(std::future::ready(done))
    }
}

impl Store for MemoryStore {
    fn accept<'a>(
        &'a self,
        tenant: &'a Tenant,
        new: NewJob,
        limits: Limits,
    ) -> Answer<'a, Admission> {
        self.with(|rows, now| rows.accept(tenant, new, limits, now))
    }

    fn replay<'a>(
        &'a self,
        tenant: &'a Tenant,
        key: &'a IdempotencyKey,
        idempotency_age: Duration,
    ) -> Answer<'a, Option<Admission>> {
        self.with(|rows, now| rows.replay(tenant, key, now.minus(idempotency_age)))
    }

    fn claim<'a>(
        &'a self,
        owner: &'a Owner,
        count: usize,
        lease: Duration,
    ) -> Answer<'a, Vec<Claim>> {
        self.with(|rows, now| {
            (0..count)
                .map_while(|_| rows.claim(owner, lease, now))
                .collect()
        })
    }

    fn beat(&self, beats: Vec<Beat>, lease: Duration) -> Answer<'_, Vec<Pulse>> {
        self.with(|rows, now| {
            beats
                .iter()
                .map(|beat| rows.beat(beat, now.plus(lease), now))
                .collect()
        })
    }

    fn complete(&self, fence: Fence, end: End) -> Answer<'_, Option<Job>> {
        self.with(|rows, now| {
            let (seq, entry) = rows.held(&fence)?;
            entry.close(end, now);
            rows.seen(seq)
        })
    }

    fn release(&self, fences: Vec<Fence>) -> Answer<'_, Vec<Job>> {
        self.with(|rows, now| {
            let mut changed = Vec::new();
            for fence in &fences {
                if let Some((seq, entry)) = rows.held(fence) {
                    entry.put_back(entry.lost, u32::MAX, now);
                    changed.push(seq);
                }
            }
            rows.all_seen(changed)
        })
    }

    fn reap(&self, max_lost: u32) -> Answer<'_, Vec<Job>> {
        self.with(|rows, now| rows.take_away(Some(now), max_lost, now))
    }

    fn void_leases(&self, max_lost: u32) -> Answer<'_, Vec<Job>> {
        self.with(|rows, now| rows.take_away(None, max_lost, now))
    }

    fn cancel<'a>(&'a self, tenant: &'a Tenant, id: JobId) -> Answer<'a, Option<Cancelled>> {
        self.with(|rows, now| {
            let (seq, entry) = rows.entry(tenant, id)?;
            let before = entry.transitions;
            match entry.job.status {
                Status::Accepted => entry.enter(Status::Dismissed, words::CANCELLED, now),
                Status::Running if !entry.job.cancel_requested => {
                    entry.job.cancel_requested = true;
                    words::CANCELLING.clone_into(&mut entry.job.message);
                    entry.job.updated = now;
                    entry.transitions += 1;
                }
                _ => {}
            }
            let changed = entry.transitions > before;
            let job = rows.seen(seq)?;
            Some(Cancelled { job, changed })
        })
    }

    fn delete<'a>(&'a self, tenant: &'a Tenant, id: JobId) -> Answer<'a, bool> {
        self.with(|rows, _| {
            let seq = rows.seq_of(tenant, id);
            if let Some(seq) = seq {
                rows.remove(seq);
            }
            seq.is_some()
        })
    }

    fn get<'a>(&'a self, tenant: &'a Tenant, id: JobId) -> Answer<'a, Option<Job>> {
        self.with(|rows, _| rows.seq_of(tenant, id).and_then(|seq| rows.seen(seq)))
    }

    fn list<'a>(&'a self, tenant: &'a Tenant, query: ListQuery) -> Answer<'a, Option<Page>> {
        self.with(|rows, _| rows.list(tenant, &query))
    }

    fn blob<'a>(
        &'a self,
        tenant: &'a Tenant,
        id: JobId,
        kind: BlobKind,
    ) -> Answer<'a, Option<Looked>> {
        self.with(|rows, _| {
            let (seq, entry) = rows.entry(tenant, id)?;
            let (blob, erased) = (entry.blobs.get(&kind).cloned(), entry.erased);
            let job = rows.seen(seq)?;
            Some(Looked { job, blob, erased })
        })
    }

    fn sweep(&self, retention: Retention) -> Answer<'_, Swept> {
        self.with(|rows, now| rows.sweep(retention, now))
    }

    fn probe(&self) -> Answer<'_, ()> {
        self.with(|_, _| ())
    }

    fn state(&self) -> StoreState {
        StoreState {
            backlog: self.rows().backlog(),
            writable: true,
        }
    }

    fn free_bytes(&self) -> Option<u64> {
        None
    }

    fn sqlite_version(&self) -> Option<String> {
        None
    }
}
