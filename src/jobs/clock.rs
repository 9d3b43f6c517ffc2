//! The only module that reads the clock.
//!
//! Two clocks, for two questions: the wall clock for what is written down, and
//! a monotonic one for how long something took. The store that keeps leases is
//! given the clock; nobody compares times of two clocks.

use std::sync::Mutex;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use super::model::Timestamp;

/// Tells the time.
pub trait Clock: Send + Sync + 'static {
    /// The moment by the wall clock. May jump.
    fn now(&self) -> Timestamp;

    /// Time since some fixed moment of this process; never falls or jumps.
    fn monotonic(&self) -> Duration;
}

/// The system's clock.
#[derive(Debug, Clone, Copy)]
pub struct SystemClock {
    origin: Instant,
}

impl SystemClock {
    /// A clock whose monotonic time begins now.
    #[must_use]
    pub fn new() -> Self {
        SystemClock {
            origin: Instant::now(),
        }
    }
}

impl Default for SystemClock {
    fn default() -> Self {
        SystemClock::new()
    }
}

impl Clock for SystemClock {
    fn now(&self) -> Timestamp {
        // A system clock before 1970 is a broken one; it reads as 1970.
        let since_epoch = SystemTime::now()
            .duration_since(UNIX_EPOCH)
            .unwrap_or_default();
        Timestamp::from_millis(0).plus(since_epoch)
    }

    fn monotonic(&self) -> Duration {
        self.origin.elapsed()
    }
}

/// A clock that stands until it is told to move: for tests.
#[derive(Debug)]
pub struct ManualClock {
    time: Mutex<(Timestamp, Duration)>,
}

impl ManualClock {
    /// A clock that stands at `start`.
    #[must_use]
    pub fn at(start: Timestamp) -> Self {
        ManualClock {
            time: Mutex::new((start, Duration::ZERO)),
        }
    }

    /// Moves both times on.
    pub fn advance(&self, span: Duration) {
        let mut time = self.lock();
        time.0 = time.0.plus(span);
        time.1 += span;
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, (Timestamp, Duration)> {
        // Two plain numbers: a panic elsewhere cannot leave them half written.
        self.time
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner)
    }
}

impl Clock for ManualClock {
    fn now(&self) -> Timestamp {
        self.lock().0
    }

    fn monotonic(&self) -> Duration {
        self.lock().1
    }
}
