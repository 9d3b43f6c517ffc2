//! How fast jobs end, for estimates: a moving mean of the time a worker spends
//! on one. Good to a factor of two, which is what "try again in" needs.

use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// Weight of the latest job in the mean: the last twenty or so count.
const WEIGHT: f64 = 0.1;

/// "Try again" is never said for sooner or later than this: below, clients
/// would hammer; above, they would leave capacity idle.
const RETRY_SECONDS: std::ops::RangeInclusive<f64> = 1.0..=60.0;

/// What is said when nothing has ended yet.
const RETRY_UNKNOWN: Duration = Duration::from_secs(5);

/// The part of a full queue that should have drained before the next try.
const DRAINED_SHARE: f64 = 0.1;

/// The moving mean.
#[derive(Default)]
pub(super) struct Pace {
    mean_s: Mutex<Option<f64>>,
}

impl Pace {
    /// A worker spent this long on a job, in seconds.
    pub fn ended(&self, seconds: f64) {
        let mut mean = self.mean_s.lock().unwrap_or_else(PoisonError::into_inner);
        *mean = Some(mean.map_or(seconds, |m| m + WEIGHT * (seconds - m)));
    }

    /// The mean, in seconds; none before the first end.
    pub fn mean_s(&self) -> Option<f64> {
        *self.mean_s.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Seconds until the job at `position` (1 is next) has ended.
    pub fn until_end(&self, position: u64, workers: usize) -> Option<f64> {
        #[expect(clippy::cast_precision_loss, reason = "an estimate")]
        let rounds = (position as f64 / workers.max(1) as f64).ceil();
        self.mean_s().map(|mean| mean * (rounds + 1.0))
    }

    /// When there should be room in a queue of `queued` jobs that is full.
    pub fn retry_after(&self, queued: u64, workers: usize) -> Duration {
        let Some(mean) = self.mean_s() else {
            return RETRY_UNKNOWN;
        };
        #[expect(clippy::cast_precision_loss, reason = "an estimate")]
        let seconds = queued as f64 * DRAINED_SHARE * mean / workers.max(1) as f64;
        let (least, most) = RETRY_SECONDS.into_inner();
        Duration::from_secs_f64(seconds.ceil().clamp(least, most))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn estimates_follow_what_ended() {
        let pace = Pace::default();
        assert_eq!(pace.until_end(1, 1), None);
        assert_eq!(pace.retry_after(100, 1), RETRY_UNKNOWN);
        pace.ended(2.0);
        assert_eq!(pace.until_end(3, 2), Some(6.0));
        assert_eq!(pace.retry_after(100, 2), Duration::from_secs(10));
        assert_eq!(pace.retry_after(1, 2), Duration::from_secs(1));
        assert_eq!(pace.retry_after(1_000_000, 2), Duration::from_secs(60));
    }
}
