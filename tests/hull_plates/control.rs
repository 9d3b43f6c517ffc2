//! Stop and progress.

use crate::support::*;
use mouldloft::methods::FitError;
use mouldloft::methods::hull_plates::fit;
use mouldloft::methods::hull_plates::request::{Boundary, Options};
use mouldloft::solver::{Control, Stop};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// Says stop at the n-th check, and remembers what happened.
struct Watch {
    checks: AtomicUsize,
    stop_at: usize,
    stop: Stop,
    stopped: Mutex<Option<Instant>>,
    progress: Mutex<Vec<(&'static str, f64)>>,
}

impl Watch {
    fn new(stop_at: usize, stop: Stop) -> Self {
        Watch {
            checks: AtomicUsize::new(0),
            stop_at,
            stop,
            stopped: Mutex::new(None),
            progress: Mutex::new(Vec::new()),
        }
    }
}

impl Control for Watch {
    fn check(&self) -> Result<(), Stop> {
        if self.checks.fetch_add(1, Ordering::SeqCst) >= self.stop_at {
            self.stopped
                .lock()
                .unwrap()
                .get_or_insert_with(Instant::now);
            return Err(self.stop);
        }
        Ok(())
    }
    fn progress(&self, phase: &'static str, percent: f64) {
        self.progress.lock().unwrap().push((phase, percent));
    }
}

#[test]
fn a_stop_is_heard_soon_wherever_it_comes() {
    let boundary = Boundary::Tolerance(0.0455);
    let request = request(
        &trawler()[2..],
        Options {
            boundary,
            ..Options::default()
        },
    );
    let whole = Watch::new(usize::MAX, Stop::Cancelled);
    fit(&request, &whole).unwrap();
    let all = whole.checks.load(Ordering::SeqCst);
    assert!(all >= 20, "only {all} checks in a whole fit");
    for (stop_at, stop) in [
        (0, Stop::OutOfTime),
        (1, Stop::Cancelled),
        (all / 2, Stop::Cancelled),
        (all - 1, Stop::OutOfTime),
    ] {
        let watch = Watch::new(stop_at, stop);
        assert_eq!(
            fit(&request, &watch),
            Err(FitError::Stopped(stop)),
            "at check {stop_at}"
        );
        let took = watch.stopped.lock().unwrap().unwrap().elapsed();
        // Threads that are still at work hear it at their own next check.
        assert!(
            took < Duration::from_secs(2),
            "{took:?} after check {stop_at}"
        );
        let after = watch.checks.load(Ordering::SeqCst) - stop_at;
        assert!(after <= 64, "{after} checks after the stop");
    }
}

#[test]
fn progress_rises_to_a_hundred() {
    for options in [
        exact(),
        Options {
            boundary: Boundary::Tolerance(0.007),
            ..Options::default()
        },
    ] {
        let watch = Watch::new(usize::MAX, Stop::Cancelled);
        fit(&request(&trawler(), options), &watch).unwrap();
        let steps = watch.progress.into_inner().unwrap();
        assert!(steps.windows(2).all(|w| w[0].1 <= w[1].1), "{steps:?}");
        assert_eq!(steps.first().unwrap().1, 0.0);
        assert_eq!(steps.last().unwrap().1, 100.0);
        assert!(
            steps.len() >= 4 && steps.iter().all(|s| !s.0.is_empty()),
            "{steps:?}"
        );
    }
}
