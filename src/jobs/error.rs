//! Why a call to the queue has no answer. Domain errors: they know no HTTP.

use std::path::PathBuf;
use std::time::Duration;

use thiserror::Error;

use super::model::Job;

/// Why a call to the [`Queue`](super::Queue) has no answer.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum QueueError {
    /// No such job, or it is somebody else's: the two are the same from here.
    #[error("there is no such job")]
    NotFound,
    /// The idempotency key was used with another body.
    #[error("this idempotency key was used before with another body")]
    IdempotencyConflict,
    /// Too many jobs, or too many bytes of them, are waiting.
    #[error("the queue is full: try again in {} s", .retry_after.as_secs())]
    QueueFull {
        /// When there should be room again, from the rate at which jobs end.
        retry_after: Duration,
    },
    /// There is no room on the disk; reading goes on.
    #[error("the job store has no room left: try again in {} s", .retry_after.as_secs())]
    StorageFull {
        /// When to try again.
        retry_after: Duration,
    },
    /// The service is going down.
    #[error("the service is going down: try again in {} s", .retry_after.as_secs())]
    Draining {
        /// When another should be up.
        retry_after: Duration,
    },
    /// The store cannot be reached or is locked by somebody: nothing is wrong
    /// with the call.
    #[error("the job store cannot be reached just now: try again in {} s", .retry_after.as_secs())]
    Unavailable {
        /// When to try again.
        retry_after: Duration,
    },
    /// There is no result yet; the job as it stands.
    #[error("the job has not ended yet")]
    NotReady(Box<Job>),
    /// There is no result because the job failed.
    #[error("the job failed: {}", .0.failure.as_ref().map_or("", |f| f.detail.as_str()))]
    Failed(Box<Job>),
    /// There is no result because the job was cancelled.
    #[error("the job was cancelled")]
    Dismissed(Box<Job>),
    /// The input or result was erased when its time was over.
    #[error("the data of this job are past their time and were erased")]
    Expired,
    /// The store broke; the log tells more under the reference.
    #[error("the job store broke (reference {reference})")]
    Store {
        /// What to look for in the log.
        reference: String,
    },
    /// The cursor was not handed out by this service.
    #[error("the cursor is not one that this service handed out")]
    InvalidCursor,
}

/// Why the queue cannot be opened; each is a sentence for the terminal.
#[derive(Debug, Error)]
pub enum OpenError {
    /// Another process has the folder.
    #[error(
        "the data folder {} is in use by another mouldloft; stop it or choose another folder with --data",
        .0.display()
    )]
    InUse(PathBuf),
    /// The folder cannot be made or written.
    #[error("the data folder {} cannot be used: {source}", .path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// The SQLite library can lose committed writes.
    #[error(
        "SQLite {found} can lose committed writes when its log is reset; {needed} or later is needed"
    )]
    BadSqlite {
        /// The version linked in.
        found: String,
        /// The oldest good version.
        needed: &'static str,
    },
    /// The file was written by a later release.
    #[error(
        "the job store has format {found}, this release knows formats up to {known}; use a later release"
    )]
    TooNew {
        /// The file's format.
        found: i64,
        /// The latest format known here.
        known: i64,
    },
    /// The store cannot be opened or migrated.
    #[error("the job store cannot be opened: {0}")]
    Store(String),
    /// The threads for fits cannot be started.
    #[error("the worker threads cannot be started: {0}")]
    Workers(String),
}
