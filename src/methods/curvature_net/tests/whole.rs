//! The fit as a whole.

use super::models::{bilge, request, tube, vault};
use crate::methods::FitError;
use crate::methods::curvature_net::request::{Direction, Supports};
use crate::methods::curvature_net::{Outcome, Request, fit};
use crate::solver::{Control, Stop, Unwatched};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// With everything that can be asked.
fn whole(mut request: Request) -> Request {
    request.options.cyclide = true;
    request.options.levels = Some(1);
    request.options.strips = vec![Direction::U, Direction::V];
    request.options.offsets = vec![0.02];
    request.options.supports = Some(Supports { height: 0.02 });
    request
}

fn fitted(request: &Request) -> Outcome {
    fit(request, &Unwatched).expect("an outcome")
}

#[test]
fn everything_asked_is_there_and_proved() {
    for (name, grid) in [("vault", vault()), ("bilge", bilge()), ("tube", tube())] {
        let outcome = fitted(&whole(request(grid)));
        let layout = outcome.net.layout();
        let [n, m] = layout.patch_counts();
        let cyclides = outcome.cyclides.as_ref().expect("asked");
        assert!(
            cyclides.figures.is_proved(),
            "{name}: {:?}",
            cyclides.figures
        );
        assert_eq!(cyclides.patches.iter().flatten().count(), n * m, "{name}");
        let lines = layout.rows + layout.columns;
        assert_eq!(cyclides.strips.len(), lines, "{name}");
        assert_eq!(cyclides.supports.len(), lines, "{name}");
        let arcs = layout.edges(0).count() + layout.edges(1).count();
        assert_eq!(cyclides.members.len(), arcs, "{name}");
        assert_eq!(cyclides.offsets[0].patches.iter().flatten().count(), n * m);
        let away = cyclides.figures.moved.mean / cyclides.figures.mean_edge;
        assert!(away < 0.1, "{name}: {away} edges");
        let first = &outcome.summary[0];
        assert!(first.starts_with(&format!("{n} × {m} patches")), "{first}");
    }
}

#[test]
fn the_smooth_surface_as_a_spline_is_the_same_surface() {
    let outcome = fitted(&whole(request(tube())));
    let smooth = &outcome.smooth.surface;
    let widths = smooth.widths();
    let (i, j) = (1, 2);
    let at =
        |d: usize, k: usize, share: f64| widths[d][..k].iter().sum::<f64>() + share * widths[d][k];
    for share in [[0.0, 0.0], [0.3, 0.8], [1.0, 0.5]] {
        let spline = (outcome.surface).point(at(0, i, share[0]), at(1, j, share[1]));
        let patch = smooth.jet([i, j], share).point;
        assert!((spline - patch).norm() < 1e-12, "{share:?}");
    }
}

#[test]
fn the_outcome_does_not_depend_on_threads() {
    let request = whole(request(bilge()));
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("threads").install(|| fitted(&request))
    };
    assert_eq!(on(1), on(3));
}

/// Stops at a given check and writes down the progress.
struct Patience {
    left: AtomicUsize,
    told: Mutex<Vec<f64>>,
}

impl Control for Patience {
    fn check(&self) -> Result<(), Stop> {
        let took = self
            .left
            .fetch_update(Ordering::Relaxed, Ordering::Relaxed, |n| n.checked_sub(1));
        took.map(|_| ()).map_err(|_| Stop::Cancelled)
    }

    fn progress(&self, _phase: &'static str, percent: f64) {
        self.told.lock().expect("one thread").push(percent);
    }
}

#[test]
fn it_stops_wherever_it_is_and_tells_how_far_it_came() {
    let request = whole(request(vault()));
    let run = |checks: usize| {
        let patience = Patience {
            left: AtomicUsize::new(checks),
            told: Mutex::new(Vec::new()),
        };
        let result = fit(&request, &patience);
        (result, patience.told.into_inner().expect("one thread"))
    };
    let (mut checks, mut stopped) = (0, 0);
    let told = loop {
        match run(checks) {
            (Err(FitError::Stopped(Stop::Cancelled)), _) => stopped += 1,
            (Ok(_), told) => break told,
            (Err(other), _) => panic!("{other}"),
        }
        // Every few checks: late ones lie behind the smooth surface.
        checks += 1 + checks / 3;
    };
    assert!(stopped > 5, "{stopped}");
    assert!(told.windows(2).all(|p| p[0] <= p[1]), "{told:?}");
    assert_eq!(told.last(), Some(&100.0));
}
