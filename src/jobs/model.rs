//! What a job is: the words that the store, the workers and the wire share.
//!
//! Plain data without behaviour; the rules of the state machine live in
//! [`store`](super::store), where a transaction can hold them.

use std::fmt;
use std::str::FromStr;
use std::time::Duration;

use bytes::Bytes;
use uuid::Uuid;

/// The unguessable name of a job: 122 random bits, so that knowing one tells
/// nothing about another.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct JobId(Uuid);

impl JobId {
    /// A fresh random id.
    #[must_use]
    pub fn random() -> Self {
        JobId(Uuid::new_v4())
    }

    /// The id as a UUID.
    #[must_use]
    pub fn as_uuid(&self) -> Uuid {
        self.0
    }
}

impl From<Uuid> for JobId {
    fn from(id: Uuid) -> Self {
        JobId(id)
    }
}

impl fmt::Display for JobId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.hyphenated().fmt(f)
    }
}

impl FromStr for JobId {
    type Err = uuid::Error;

    /// Reads any of the usual spellings of a UUID.
    ///
    /// # Errors
    /// The text is not a UUID.
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Uuid::try_parse(text).map(JobId)
    }
}

/// Whose a job is. Every row carries one and every query asks for one.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Tenant(String);

impl Tenant {
    /// The tenant with this name.
    pub fn new(name: impl Into<String>) -> Self {
        Tenant(name.into())
    }

    /// The one tenant of a server without keys.
    #[must_use]
    pub fn local() -> Self {
        Tenant("local".to_owned())
    }

    /// The name as text.
    #[must_use]
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

/// A moment, in milliseconds since 1970-01-01T00:00:00Z.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Timestamp(i64);

impl Timestamp {
    /// The moment this many milliseconds after the epoch.
    #[must_use]
    pub const fn from_millis(ms: i64) -> Self {
        Timestamp(ms)
    }

    /// Milliseconds since the epoch.
    #[must_use]
    pub const fn as_millis(self) -> i64 {
        self.0
    }

    /// This moment plus a span, saturating.
    #[must_use]
    pub fn plus(self, span: Duration) -> Self {
        Timestamp(self.0.saturating_add(millis(span)))
    }

    /// This moment less a span, saturating.
    #[must_use]
    pub fn minus(self, span: Duration) -> Self {
        Timestamp(self.0.saturating_sub(millis(span)))
    }

    /// Milliseconds from `earlier` to this moment; negative if it is later.
    #[must_use]
    pub fn millis_since(self, earlier: Timestamp) -> i64 {
        self.0.saturating_sub(earlier.0)
    }
}

/// A span in whole milliseconds, saturating.
pub(crate) fn millis(span: Duration) -> i64 {
    i64::try_from(span.as_millis()).unwrap_or(i64::MAX)
}

impl fmt::Display for Timestamp {
    /// RFC 3339 in UTC with milliseconds: `2026-11-20T08:15:00.250Z`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match jiff::Timestamp::from_millisecond(self.0) {
            Ok(t) => write!(f, "{t:.3}"),
            Err(_) => write!(f, "{} ms after 1970", self.0),
        }
    }
}

/// Where a job stands. The words are those of OGC API – Processes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Status {
    /// On disk, waiting for a worker.
    Accepted,
    /// A worker has it.
    Running,
    /// Ended with a result.
    Successful,
    /// Ended with nothing to show but a [`Failure`].
    Failed,
    /// Ended because somebody cancelled it.
    Dismissed,
}

impl Status {
    /// Every status, in the order of a job's life.
    pub const ALL: [Status; 5] = [
        Status::Accepted,
        Status::Running,
        Status::Successful,
        Status::Failed,
        Status::Dismissed,
    ];

    /// The word on the wire and in the store.
    #[must_use]
    pub const fn as_str(self) -> &'static str {
        match self {
            Status::Accepted => "accepted",
            Status::Running => "running",
            Status::Successful => "successful",
            Status::Failed => "failed",
            Status::Dismissed => "dismissed",
        }
    }

    /// True for the three ends, which nothing leaves.
    #[must_use]
    pub const fn is_ended(self) -> bool {
        matches!(
            self,
            Status::Successful | Status::Failed | Status::Dismissed
        )
    }

    /// The status with this word.
    #[must_use]
    pub fn parse(word: &str) -> Option<Self> {
        Status::ALL.into_iter().find(|s| s.as_str() == word)
    }
}

/// Whether a successful job reached what was asked of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Verdict {
    /// Every limit is kept.
    WithinLimits,
    /// The best surface found breaks at least one limit.
    OutsideLimits,
}

impl Verdict {
    /// The word on the wire and in the store.
    #[must_use]
    pub const fn as_str(self) -> &'static str {
        match self {
            Verdict::WithinLimits => "within_limits",
            Verdict::OutsideLimits => "outside_limits",
        }
    }

    /// The verdict with this word.
    #[must_use]
    pub fn parse(word: &str) -> Option<Self> {
        [Verdict::WithinLimits, Verdict::OutsideLimits]
            .into_iter()
            .find(|v| v.as_str() == word)
    }
}

/// Why a job failed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Failure {
    /// A stable word for programmes: `worker-panic`, `worker-crashed`,
    /// `budget-exceeded`, `invalid-input`, or the engine's own.
    pub code: String,
    /// A sentence for people.
    pub detail: String,
    /// What to quote when asking the operator; the log has the same.
    pub reference: Option<Uuid>,
    /// The engine's list of broken rules, as JSON text.
    pub errors_json: Option<String>,
}

/// A job as its owner may see it.
#[derive(Debug, Clone, PartialEq)]
pub struct Job {
    /// Its name.
    pub id: JobId,
    /// Whose it is.
    pub tenant: Tenant,
    /// The method that is asked for.
    pub method: String,
    /// The owner's own name for it.
    pub label: Option<String>,
    /// Where it stands.
    pub status: Status,
    /// What it is at: `queued`, `starting`, a word of the method's own, `done`.
    pub phase: String,
    /// 0 to 100, never falling.
    pub progress: f64,
    /// A sentence about where it stands.
    pub message: String,
    /// When it was accepted.
    pub created: Timestamp,
    /// When the current or last attempt began.
    pub started: Option<Timestamp>,
    /// When it ended.
    pub finished: Option<Timestamp>,
    /// When anything visible last changed.
    pub updated: Timestamp,
    /// How often a worker has taken it up; 0 before the first.
    pub attempt: u32,
    /// 1 is next; only for accepted jobs.
    pub queue_position: Option<u64>,
    /// Seconds until the end, estimated from recent jobs; none if unknown.
    pub eta_s: Option<f64>,
    /// The version of the engine that accepted it.
    pub engine_version: String,
    /// SHA-256 of the input, hexadecimal.
    pub input_sha256: String,
    /// Only for successful jobs.
    pub verdict: Option<Verdict>,
    /// What the owner should know though it stopped nothing.
    pub warnings: Vec<String>,
    /// Only for failed jobs.
    pub failure: Option<Failure>,
    /// How long the engine ran, in milliseconds; only for ended jobs that ran.
    pub solve_ms: Option<f64>,
    /// For an entity tag: a job that looks different has another revision, and
    /// it only rises. Estimates ([`Job::eta_s`]) do not count as a change.
    pub revision: u64,
    /// Somebody asked to cancel it and it has not ended yet.
    pub cancel_requested: bool,
    /// Size of the input, in bytes.
    pub input_bytes: u64,
    /// Size of the result, in bytes; only for successful jobs.
    pub result_bytes: Option<u64>,
}

/// Makes a repeated submission harmless.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct IdempotencyKey {
    /// The client's key; unique per tenant.
    pub key: String,
    /// SHA-256 of the whole request body, hexadecimal: the same key with
    /// another body is a conflict.
    pub body_sha256: String,
}

/// A job to submit.
#[derive(Debug, Clone)]
pub struct NewJob {
    /// The method to run.
    pub method: String,
    /// The owner's own name for it.
    pub label: Option<String>,
    /// The input, kept and given back byte for byte.
    pub input: Bytes,
    /// SHA-256 of the input, hexadecimal.
    pub input_sha256: String,
    /// How long the engine may run.
    pub budget: Duration,
    /// Makes repeating the submission harmless.
    pub idempotency: Option<IdempotencyKey>,
    /// The version of the engine, for the record.
    pub engine_version: String,
    /// What the owner should know from the start.
    pub warnings: Vec<String>,
}

/// What became of a submission.
#[derive(Debug, Clone, PartialEq)]
pub enum Accepted {
    /// A new job, on disk.
    New(Job),
    /// The key is known with the same body: its job, as it stands now.
    Replayed(Job),
}

impl Accepted {
    /// The job, new or known.
    #[must_use]
    pub fn job(&self) -> &Job {
        match self {
            Accepted::New(job) | Accepted::Replayed(job) => job,
        }
    }
}

/// Which jobs to list: newest first, all filters at once.
#[derive(Debug, Clone, Default)]
pub struct ListQuery {
    /// At most this many; 0 is taken as 1, above
    /// [`ListQuery::MAX_LIMIT`] as that.
    pub limit: usize,
    /// Where the page before ended, as it was handed out.
    pub cursor: Option<String>,
    /// Only jobs that stand there.
    pub status: Option<Status>,
    /// Only jobs of this method.
    pub method: Option<String>,
    /// Only jobs with exactly this label.
    pub label: Option<String>,
}

impl ListQuery {
    /// The longest page: one answer stays small and one read stays short.
    pub const MAX_LIMIT: usize = 200;
}

/// One page of a list.
#[derive(Debug, Clone, PartialEq)]
pub struct Page {
    /// The jobs, newest first.
    pub items: Vec<Job>,
    /// Hand it in to get the next page; none on the last.
    pub next_cursor: Option<String>,
}
