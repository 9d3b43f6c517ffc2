//! A fit watched from a terminal: a bar, a budget, and Ctrl-C.

use crate::jobs::clock::Clock;
use crate::methods::{Control, Stop};
use indicatif::{ProgressBar, ProgressStyle};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// The bar counts tenths of a percent.
const STEPS: u64 = 1_000;

/// Shows progress on standard error if that is a terminal, and stops a fit
/// that is cancelled or has used up its budget.
pub struct Watch<C> {
    bar: ProgressBar,
    cancelled: AtomicBool,
    clock: C,
    deadline: Duration,
}

impl<C: Clock> Watch<C> {
    /// Watches from now on for at most `budget`.
    pub fn new(clock: C, budget: Duration) -> Watch<C> {
        // indicatif hides the bar by itself where there is no terminal.
        let bar = ProgressBar::new(STEPS);
        if let Ok(style) =
            ProgressStyle::with_template("{msg:12} {bar:40} {percent:>3} %  {elapsed}")
        {
            bar.set_style(style);
        }
        let deadline = clock.monotonic().saturating_add(budget);
        Watch {
            bar,
            cancelled: AtomicBool::new(false),
            clock,
            deadline,
        }
    }

    /// Asks the fit to stop.
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }

    /// Takes the bar away.
    pub fn clear(&self) {
        self.bar.finish_and_clear();
    }
}

impl<C: Clock> Control for Watch<C> {
    fn check(&self) -> Result<(), Stop> {
        if self.cancelled.load(Ordering::Relaxed) {
            Err(Stop::Cancelled)
        } else if self.clock.monotonic() >= self.deadline {
            Err(Stop::OutOfTime)
        } else {
            Ok(())
        }
    }

    fn progress(&self, phase: &'static str, percent: f64) {
        self.bar.set_message(phase);
        self.bar
            .set_position((percent.clamp(0.0, 100.0) * STEPS as f64 / 100.0) as u64);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::jobs::Timestamp;
    use crate::jobs::clock::ManualClock;
    use std::sync::Arc;

    struct Shared(Arc<ManualClock>);

    impl Clock for Shared {
        fn now(&self) -> Timestamp {
            self.0.now()
        }
        fn monotonic(&self) -> Duration {
            self.0.monotonic()
        }
    }

    #[test]
    fn the_budget_and_a_cancel_stop_the_fit() {
        let clock = Arc::new(ManualClock::at(Timestamp::from_millis(0)));
        let watch = Watch::new(Shared(Arc::clone(&clock)), Duration::from_secs(2));
        clock.advance(Duration::from_millis(1_999));
        assert_eq!(watch.check(), Ok(()));
        clock.advance(Duration::from_millis(1));
        assert_eq!(watch.check(), Err(Stop::OutOfTime));
        watch.cancel();
        assert_eq!(watch.check(), Err(Stop::Cancelled));
    }
}
