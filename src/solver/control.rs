//! How a running fit hears "stop" and tells how far it is, without knowing
//! clocks, threads or queues.

use std::fmt;

/// Why a fit was told to stop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stop {
    /// Somebody cancelled it.
    Cancelled,
    /// Its time budget is used up.
    OutOfTime,
}

impl fmt::Display for Stop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Stop::Cancelled => "cancelled",
            Stop::OutOfTime => "out of time",
        })
    }
}

/// The caller's side of a running fit. A fit calls [`Control::check`] at
/// least every few milliseconds of work and [`Control::progress`] when a phase
/// begins or moves on. Implementations must be cheap and must never block.
pub trait Control: Sync {
    /// `Err` asks the fit to return at once.
    ///
    /// # Errors
    /// The reason to stop, once there is one; it stays.
    fn check(&self) -> Result<(), Stop>;

    /// `phase` is a word of the method's own (`reading`, `rulings`, `fitting`,
    /// …); `percent` of the whole fit, 0 to 100. May be called from any thread.
    fn progress(&self, phase: &'static str, percent: f64);
}

/// A control that never stops and drops all progress: for tests and benches.
#[derive(Debug, Clone, Copy, Default)]
pub struct Unwatched;

impl Control for Unwatched {
    fn check(&self) -> Result<(), Stop> {
        Ok(())
    }
    fn progress(&self, _phase: &'static str, _percent: f64) {}
}
