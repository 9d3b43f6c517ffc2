//! Where the jobs are: one trait, and what its implementations agree on.
//!
//! The state machine lives here, because only a transaction can hold it. Two
//! engines run the same contract tests (`tests/store_contract.rs`): [`sqlite`],
//! and [`memory`], a model that keeps nothing. PostgreSQL is to be the third;
//! for its sake every row has a tenant, every lease an owner, every method is
//! asynchronous, and no method is told the time: a store has its own clock,
//! and that is the only one that judges leases.

pub mod cursor;
pub mod memory;
mod pack;
pub(crate) mod shared;
pub mod sqlite;
pub mod types;

use std::future::Future;
use std::pin::Pin;
use std::time::Duration;

use thiserror::Error;

use super::model::{IdempotencyKey, Job, JobId, ListQuery, NewJob, Page, Tenant};

pub use types::{
    Admission, Backlog, Beat, BlobKind, Cancelled, Claim, End, Fence, Limits, Looked, Outcome,
    Owner, Pulse, Retention, StoreState, Swept,
};

/// What every method of a store returns: boxed, so that stores are objects.
pub type Answer<'a, T> = Pin<Box<dyn Future<Output = Result<T, StoreError>> + Send + 'a>>;

/// Why a store has no answer.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum StoreError {
    /// No room on the disk; nothing was written; reading goes on.
    #[error("no room on the disk")]
    Full,
    /// Locked or out of reach just now; nothing was written.
    #[error("out of reach: {0}")]
    Busy(String),
    /// What is asked for cannot be read as what it should be.
    #[error("unreadable: {0}")]
    Corrupt(String),
    /// One statement was wrong: a defect of this programme. The others go on.
    #[error("refused: {0}")]
    Defect(String),
    /// A write went wrong in a way that makes the state of the file unsure.
    /// The store takes no further writes.
    #[error("broken: {0}")]
    Broken(String),
}

/// The rows. Every method is one transaction, durable when it returns `Ok`;
/// a call that is dropped half-way may still take effect.
pub trait Store: Send + Sync + 'static {
    /// Accepts a job, unless its key is known or a limit is reached.
    fn accept<'a>(
        &'a self,
        tenant: &'a Tenant,
        new: NewJob,
        limits: Limits,
    ) -> Answer<'a, Admission>;

    /// What a key would give now; none if it is unknown or forgotten. Never
    /// `New` or `QueueFull`.
    fn replay<'a>(
        &'a self,
        tenant: &'a Tenant,
        key: &'a IdempotencyKey,
        idempotency_age: Duration,
    ) -> Answer<'a, Option<Admission>>;

    /// Takes up at most `count` waiting jobs, the longest waiting first.
    fn claim<'a>(
        &'a self,
        owner: &'a Owner,
        count: usize,
        lease: Duration,
    ) -> Answer<'a, Vec<Claim>>;

    /// Prolongs leases and writes progress; answers in the same order.
    fn beat(&self, beats: Vec<Beat>, lease: Duration) -> Answer<'_, Vec<Pulse>>;

    /// Ends a job; none if the fence does not hold, and nothing changed then.
    fn complete(&self, fence: Fence, end: End) -> Answer<'_, Option<Job>>;

    /// Gives jobs back unharmed, so that somebody takes them up next; those
    /// that somebody wants cancelled are dismissed. Returns the changed jobs.
    fn release(&self, fences: Vec<Fence>) -> Answer<'_, Vec<Job>>;

    /// Takes away leases that ran out: the job waits again, or is dismissed if
    /// somebody wants that, or failed `worker-crashed` when `max_lost` leases
    /// are lost. Returns the changed jobs.
    fn reap(&self, max_lost: u32) -> Answer<'_, Vec<Job>>;

    /// Takes away every lease, as [`Store::reap`]; called once at the start by
    /// the only process that has the store. Stores that several processes
    /// share do nothing here: their leases run out by themselves.
    fn void_leases(&self, max_lost: u32) -> Answer<'_, Vec<Job>>;

    /// Dismisses a waiting job, marks a running one, leaves an ended one.
    /// Returns the job after that; none if there is none.
    fn cancel<'a>(&'a self, tenant: &'a Tenant, id: JobId) -> Answer<'a, Option<Cancelled>>;

    /// Erases a job, whatever its state. False if there is none.
    fn delete<'a>(&'a self, tenant: &'a Tenant, id: JobId) -> Answer<'a, bool>;

    /// A job; none if there is none.
    fn get<'a>(&'a self, tenant: &'a Tenant, id: JobId) -> Answer<'a, Option<Job>>;

    /// A page of jobs, newest first; none if the cursor is not ours.
    fn list<'a>(&'a self, tenant: &'a Tenant, query: ListQuery) -> Answer<'a, Option<Page>>;

    /// A job and one of its blobs; none if there is no such job.
    fn blob<'a>(
        &'a self,
        tenant: &'a Tenant,
        id: JobId,
        kind: BlobKind,
    ) -> Answer<'a, Option<Looked>>;

    /// Erases some of what is past its time.
    fn sweep(&self, retention: Retention) -> Answer<'_, Swept>;

    /// Writes something of no meaning, to see whether writing works.
    fn probe(&self) -> Answer<'_, ()>;

    /// What is known without asking the disk.
    fn state(&self) -> StoreState;

    /// Free space, in bytes; none if unknown or without meaning.
    fn free_bytes(&self) -> Option<u64>;

    /// The version of the SQLite library, for stores that use it.
    fn sqlite_version(&self) -> Option<String>;
}
