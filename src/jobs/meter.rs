//! What the queue tells about itself: counters to read, and a port for those
//! who want every value.

use super::model::Status;

/// Hears of every job; implemented where metrics live. Calls must be quick.
pub trait Meter: Send + Sync + 'static {
    /// A new job is on disk.
    fn accepted(&self, _method: &str) {}

    /// A submission was turned away; `reason` is `queue-full`,
    /// `storage-full`, `draining` or `unavailable`.
    fn rejected(&self, _reason: &'static str) {}

    /// A job ended in this process.
    fn ended(&self, _end: &Ended<'_>) {}
}

/// The figures of an ended job.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ended<'a> {
    /// The method it ran.
    pub method: &'a str,
    /// How it ended.
    pub status: Status,
    /// The word of its failure, for failed jobs.
    pub failure_code: Option<&'a str>,
    /// Time in the queue before the last attempt began, in ms.
    pub waited_ms: Option<f64>,
    /// Time in the engine, in ms.
    pub solve_ms: Option<f64>,
    /// Time from taking the job up to its end on disk, less the time in the
    /// engine, in ms: what the queue itself costs.
    pub overhead_ms: Option<f64>,
}

/// A meter that drops everything.
#[derive(Debug, Clone, Copy, Default)]
pub struct Unmetered;

impl Meter for Unmetered {}

/// Counters since the start of this process, and gauges.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Stats {
    /// Jobs accepted.
    pub accepted: u64,
    /// Submissions answered with a known job.
    pub replayed: u64,
    /// Submissions turned away for lack of room or because of going down.
    pub rejected: u64,
    /// Jobs that ended with a result.
    pub successful: u64,
    /// Jobs that failed.
    pub failed: u64,
    /// Jobs that were cancelled.
    pub dismissed: u64,
    /// Fits that panicked.
    pub panics: u64,
    /// Results dropped because another attempt had the job.
    pub stale_results: u64,
    /// Jobs that wait now.
    pub queued: u64,
    /// Bytes of input that wait now.
    pub queued_bytes: u64,
    /// Jobs that run now, in any process.
    pub running: u64,
    /// Threads for fits in this process.
    pub workers: usize,
}
