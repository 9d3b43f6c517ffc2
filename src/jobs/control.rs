//! The queue's side of one running fit: how it hears "stop" and what it has
//! shown of its progress.

use std::sync::atomic::{AtomicU8, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use tokio::sync::Notify;

use super::clock::Clock;
use super::model::{Job, Timestamp};
use super::store::shared::{with_ticks, words};
use super::store::{Beat, Fence};
use crate::methods::{Control, Stop};

/// Progress is shown when it has moved by this much, in percent: finer steps
/// would wake watchers for nothing they can see.
const STEP_PERCENT: f64 = 1.0;

/// Why a fit was told to stop. The first reason stays.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub(super) enum Why {
    /// Its owner cancelled or deleted the job.
    Cancelled = 1,
    /// Its budget is used up.
    OutOfTime = 2,
    /// The lease is somebody else's: whatever it makes will be dropped.
    LeaseLost = 3,
    /// The service goes down and has given the job back.
    GivenBack = 4,
}

/// What has been shown so far.
#[derive(Debug, Clone, PartialEq)]
struct Shown {
    phase: &'static str,
    progress: f64,
    ticks: u64,
    updated: Timestamp,
}

/// One running fit as the queue holds it; the fit sees it as a [`Control`].
pub(super) struct FitControl {
    fence: Fence,
    deadline: Duration,
    clock: Arc<dyn Clock>,
    why: AtomicU8,
    stopped: Notify,
    shown: Mutex<Shown>,
    on_step: Box<dyn Fn() + Send + Sync>,
}

impl FitControl {
    /// A control for a job that was just taken up; its time begins now.
    /// `on_step` is called whenever visible progress was made.
    pub fn new(
        job: &Job,
        fence: Fence,
        budget: Duration,
        clock: Arc<dyn Clock>,
        on_step: Box<dyn Fn() + Send + Sync>,
    ) -> Self {
        let shown = Shown {
            phase: words::STARTING,
            // A former attempt may have got further: progress never falls.
            progress: job.progress,
            ticks: 0,
            updated: job.updated,
        };
        FitControl {
            fence,
            deadline: clock.monotonic().saturating_add(budget),
            clock,
            why: AtomicU8::new(0),
            stopped: Notify::new(),
            shown: Mutex::new(shown),
            on_step,
        }
    }

    /// The holding that this fit works under.
    pub fn fence(&self) -> &Fence {
        &self.fence
    }

    /// Tells the fit to stop; only the first reason counts.
    pub fn stop(&self, why: Why) {
        let first = self
            .why
            .compare_exchange(0, why as u8, Ordering::AcqRel, Ordering::Acquire);
        if first.is_ok() {
            self.stopped.notify_one();
        }
    }

    /// Why it was told to stop, if it was.
    pub fn why(&self) -> Option<Why> {
        [
            Why::Cancelled,
            Why::OutOfTime,
            Why::LeaseLost,
            Why::GivenBack,
        ]
        .into_iter()
        .find(|why| *why as u8 == self.why.load(Ordering::Acquire))
    }

    /// Ends once the fit was told to stop. For one waiter.
    pub async fn told_to_stop(&self) {
        if self.why().is_none() {
            self.stopped.notified().await;
        }
    }

    /// What to write with the next beat.
    pub fn beat(&self) -> Beat {
        let shown = self.shown();
        Beat {
            fence: self.fence.clone(),
            phase: shown.phase.to_owned(),
            progress: shown.progress,
            ticks: shown.ticks,
        }
    }

    /// Shows the progress in a job that was read from the store, if it is the
    /// same attempt.
    pub fn overlay(&self, job: &mut Job) {
        if job.attempt != self.fence.attempt {
            return;
        }
        let shown = self.shown();
        shown.phase.clone_into(&mut job.phase);
        job.progress = job.progress.max(shown.progress);
        job.updated = job.updated.max(shown.updated);
        job.revision = job.revision.max(with_ticks(job.revision, shown.ticks));
    }

    fn shown(&self) -> MutexGuard<'_, Shown> {
        // Held for a few assignments that cannot panic.
        self.shown.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Takes a step in; true if it is one that shows.
    fn step(&self, phase: &'static str, percent: f64) -> bool {
        let mut shown = self.shown();
        // Also false for what is no number.
        let moved = percent >= shown.progress + STEP_PERCENT;
        if !moved && phase == shown.phase {
            return false;
        }
        if moved {
            shown.progress = percent.min(100.0);
        }
        shown.phase = phase;
        shown.ticks += 1;
        shown.updated = self.clock.now();
        true
    }
}

impl Control for FitControl {
    fn check(&self) -> Result<(), Stop> {
        if self.why().is_none() && self.clock.monotonic() >= self.deadline {
            self.stop(Why::OutOfTime);
        }
        match self.why() {
            None => Ok(()),
            Some(Why::OutOfTime) => Err(Stop::OutOfTime),
            Some(Why::Cancelled | Why::LeaseLost | Why::GivenBack) => Err(Stop::Cancelled),
        }
    }

    fn progress(&self, phase: &'static str, percent: f64) {
        if self.step(phase, percent) {
            (self.on_step)();
        }
    }
}
