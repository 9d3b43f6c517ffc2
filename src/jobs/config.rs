//! The settings of the queue; `app` fills them in.

use std::num::NonZero;
use std::path::PathBuf;
use std::time::Duration;

const MB: u64 = 1_000_000;
const HOUR: Duration = Duration::from_secs(3600);
const DAY: Duration = Duration::from_secs(24 * 3600);

/// The settings of the queue. [`QueueConfig::default`] is what `serve` uses.
#[derive(Debug, Clone, PartialEq)]
pub struct QueueConfig {
    /// The folder of the store; none keeps everything in memory.
    pub data_dir: Option<PathBuf>,
    /// Threads for fits; 0 accepts and answers but runs nothing.
    pub workers: usize,
    /// At most this many jobs wait.
    pub max_queued: u64,
    /// At most this many bytes of input wait.
    pub max_queued_bytes: u64,
    /// How long a worker has a job without a beat.
    pub lease: Duration,
    /// How often the beat renews leases, writes progress and hears of cancels.
    pub beat: Duration,
    /// A job whose lease was lost this often has failed.
    pub max_lost_leases: u32,
    /// How long after its end a job's input, result and diagnostics are kept.
    pub result_age: Duration,
    /// How long after its end a job's record is kept.
    pub record_age: Duration,
    /// How long an idempotency key is known.
    pub idempotency_age: Duration,
    /// How often to erase what is past its time.
    pub sweep: Duration,
    /// Below this much free space nothing is accepted, so that what is
    /// accepted can still be finished.
    pub min_free_bytes: u64,
    /// How long a fit may take to obey its control before its job is ended
    /// without it.
    pub stop_grace: Duration,
}

impl Default for QueueConfig {
    fn default() -> Self {
        QueueConfig {
            data_dir: Some(PathBuf::from("mouldloft-data")),
            workers: default_workers(),
            max_queued: 10_000,
            max_queued_bytes: 2_000 * MB,
            lease: Duration::from_secs(30),
            beat: Duration::from_secs(5),
            max_lost_leases: 3,
            result_age: 30 * DAY,
            record_age: 90 * DAY,
            idempotency_age: 24 * HOUR,
            sweep: Duration::from_secs(600),
            min_free_bytes: 100 * MB,
            stop_grace: Duration::from_secs(2),
        }
    }
}

/// All cores but one, which stays free for answering; at least one.
fn default_workers() -> usize {
    let cores = std::thread::available_parallelism().map_or(1, NonZero::get);
    cores.saturating_sub(1).max(1)
}
