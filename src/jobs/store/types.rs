//! What goes into a store and comes out of it.

use std::time::Duration;

use bytes::Bytes;

use super::StoreError;
use crate::jobs::model::{Failure, Job, JobId, Verdict};

/// Who holds a lease: one process of this service, by a random name.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Owner(pub String);

/// One holding of one job. Everything a worker writes names it, and changes
/// nothing once the job has another attempt or owner, or has ended.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Fence {
    /// The job.
    pub id: JobId,
    /// The attempt that the worker was given.
    pub attempt: u32,
    /// The worker's process.
    pub owner: Owner,
}

/// What limits accepting.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// At most this many jobs wait.
    pub jobs: u64,
    /// At most this many bytes of input wait.
    pub bytes: u64,
    /// An idempotency key older than this is forgotten.
    pub idempotency_age: Duration,
}

/// What became of a submission.
#[derive(Debug, Clone, PartialEq)]
pub enum Admission {
    /// A new job, committed.
    New(Job),
    /// The key is known with the same body.
    Replayed(Job),
    /// The key is known with another body.
    KeyConflict,
    /// A limit is reached.
    QueueFull,
}

/// A job taken up.
#[derive(Debug, Clone, PartialEq)]
pub struct Claim {
    /// The job, running; its `attempt` is part of the fence.
    pub job: Job,
    /// Its input, or why that cannot be read.
    pub input: Result<Bytes, StoreError>,
    /// How long the engine may run.
    pub budget: Duration,
}

/// What a worker tells with its beat.
#[derive(Debug, Clone, PartialEq)]
pub struct Beat {
    /// The holding to prolong.
    pub fence: Fence,
    /// Phase of the fit.
    pub phase: String,
    /// 0 to 100; a lower value than the row's is ignored.
    pub progress: f64,
    /// How many visible steps of progress there were in this attempt.
    pub ticks: u64,
}

/// What a worker hears with its beat.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pulse {
    /// The lease is prolonged.
    Held,
    /// Prolonged, and somebody wants the job cancelled.
    CancelRequested,
    /// The job is somebody else's now, or has ended, or is gone.
    Lost,
}

/// How an attempt ended.
#[derive(Debug, Clone, PartialEq)]
pub struct End {
    /// Which of the three ends.
    pub outcome: Outcome,
    /// Milliseconds in the engine.
    pub solve_ms: f64,
    /// The last phase; successful jobs get `done`.
    pub phase: String,
    /// The last progress; successful jobs get 100.
    pub progress: f64,
}

/// The three ends.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// There is a result.
    Successful {
        /// The result.
        result: Bytes,
        /// The diagnostics.
        diagnostics: Bytes,
        /// Whether every limit is kept.
        verdict: Verdict,
        /// To be added to the job's warnings.
        warnings: Vec<String>,
        /// One sentence about it.
        message: String,
    },
    /// There is nothing to show.
    Failed {
        /// Why.
        failure: Failure,
        /// What is known about the state it failed in.
        diagnostics: Option<Bytes>,
    },
    /// Somebody cancelled it.
    Dismissed,
}

/// The three blobs of a job.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum BlobKind {
    /// What was submitted.
    Input,
    /// What came out.
    Result,
    /// What the method says about how it went.
    Diagnostics,
}

impl BlobKind {
    /// The word in the store.
    #[must_use]
    pub const fn as_str(self) -> &'static str {
        match self {
            BlobKind::Input => "input",
            BlobKind::Result => "result",
            BlobKind::Diagnostics => "diagnostics",
        }
    }
}

/// A job after a cancel.
#[derive(Debug, Clone, PartialEq)]
pub struct Cancelled {
    /// The job as it stands now.
    pub job: Job,
    /// True if this call changed it.
    pub changed: bool,
}

/// A job and one of its blobs.
#[derive(Debug, Clone, PartialEq)]
pub struct Looked {
    /// The job.
    pub job: Job,
    /// The blob; none if it never was or is erased.
    pub blob: Option<Bytes>,
    /// Its blobs were erased when their time was over.
    pub erased: bool,
}

/// How long things are kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Retention {
    /// Blobs, after the end of their job.
    pub blobs: Duration,
    /// Records, after the end of their job.
    pub records: Duration,
    /// Idempotency keys, after they were used first.
    pub keys: Duration,
}

/// What one sweep erased. A sweep does a bounded number of each: sweep again
/// until nothing is left.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Swept {
    /// Jobs whose blobs were erased.
    pub blobs: u64,
    /// Jobs that were erased.
    pub records: u64,
    /// Idempotency keys that were forgotten.
    pub keys: u64,
}

impl Swept {
    /// One sweep erases at most this many of each, so that accepting never
    /// waits long behind it.
    pub const AT_MOST: u64 = 200;

    /// True if there may be more to erase.
    #[must_use]
    pub fn is_cut_short(&self) -> bool {
        [self.blobs, self.records, self.keys].contains(&Swept::AT_MOST)
    }
}

/// What waits and what runs.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Backlog {
    /// Jobs that wait.
    pub queued: u64,
    /// Bytes of their inputs.
    pub queued_bytes: u64,
    /// Jobs that run.
    pub running: u64,
}

/// What a store knows about itself without asking the disk.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StoreState {
    /// As of the last commit.
    pub backlog: Backlog,
    /// The last write went through.
    pub writable: bool,
}
