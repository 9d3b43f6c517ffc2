//! The durable queue of jobs: accept, run, end, remember.
//!
//! A job is `accepted → running → successful | failed | dismissed`, nothing
//! else. The idea in three sentences:
//!
//! * **Accept** is one transaction (job, idempotency key, input) that is on
//!   disk before [`Queue::submit`] returns.
//! * **Running** is a lease: an owner and an attempt number on the row, renewed
//!   by a beat that carries progress out and cancellation in; a lost lease
//!   gives the job back, the third loss fails it.
//! * **The end** is one transaction, result inside, fenced by attempt and
//!   owner: a worker that lost its lease changes no row. So execution is at
//!   least once and the visible result is written once.
//!
//! | module | holds |
//! |---|---|
//! | [`model`] | what a job is |
//! | [`error`] | why a call has no answer |
//! | [`queue`], `submit`, `wait` | the handle everybody else uses |
//! | [`engine`] | the port through which methods are run |
//! | [`store`] | the rows: SQLite, and a model in memory |
//! | `worker`, `fit`, `pool` | the running half: taking up, one fit, the threads |
//! | `keeper`, `live`, `control` | the beat, the fits of this process, one fit's stop and progress |
//! | `hub`, `pace`, `core`, `start` | wake-ups, estimates, what all share, opening and going down |
//! | [`clock`] | the only reader of the clock |
//!
//! Limits: one process owns an SQLite folder (an exclusive lock says so). A
//! fit that never asks its [`Control`](crate::methods::Control) keeps its
//! thread until it returns; its job still ends in time, see `keeper`.

pub mod clock;
pub mod config;
mod control;
mod core;
pub mod engine;
pub mod error;
mod fit;
pub mod health;
mod hub;
mod keeper;
mod live;
pub mod meter;
pub mod model;
mod pace;
mod pool;
pub mod queue;
mod start;
pub mod store;
mod submit;
#[cfg(test)]
mod tests;
mod wait;
mod worker;

pub use config::QueueConfig;
pub use engine::{Engine, EngineError, Product};
pub use error::{OpenError, QueueError};
pub use health::Health;
pub use meter::{Ended, Meter, Stats, Unmetered};
pub use model::{
    Accepted, Failure, IdempotencyKey, Job, JobId, ListQuery, NewJob, Page, Status, Tenant,
    Timestamp, Verdict,
};
pub use queue::Queue;
