//! What a curvature net costs: time against the number of patches, with and
//! without the cyclide spline, and against the paper's Gauss–Newton on its kind
//! of models, with the torsion that each leaves.
//!
//! A plain harness, since the torsion stands next to the time. Only ratios mean
//! anything: the machine is whatever runs it. `cargo bench --bench
//! curvature_net`.

use mouldloft::methods::FitError;
use mouldloft::methods::curvature_net::request::{Grid, Input, Options, Request, Solver};
use mouldloft::methods::curvature_net::{Outcome, fit};
use mouldloft::solver::Unwatched;
use nalgebra::Point3;
use std::error::Error;
use std::f64::consts::{PI, TAU};
use std::hint::black_box;
use std::io::Write;
use std::time::Instant;

/// The least of this many runs: what the work costs without its neighbours.
const RUNS: usize = 3;
/// Splits of a net of 4 × 4 quads: 16 to 4096 patches.
const LEVELS: [usize; 5] = [0, 1, 2, 3, 4];

/// A net of points of a surface over [0, 1]², closed along v or not.
fn grid([rows, columns]: [usize; 2], closed: bool, surface: impl Fn(f64, f64) -> [f64; 3]) -> Grid {
    let last = columns - usize::from(!closed);
    let point = |k: usize| {
        let (i, j) = ((k / columns) as f64, (k % columns) as f64);
        Point3::from(surface(i / (rows - 1) as f64, j / last as f64))
    };
    Grid {
        rows,
        columns,
        closed: [false, closed],
        points: (0..rows * columns).map(point).collect(),
    }
}

fn vault() -> Grid {
    grid([4, 5], false, |u, v| {
        let angle = PI * (0.15 + 0.7 * v);
        let radius = 4.0 + 0.6 * u;
        let sag = -0.8 * (2.0 * u - 1.0).powi(2);
        [10.0 * u, -radius * angle.cos(), radius * angle.sin() + sag]
    })
}

fn saddle() -> Grid {
    grid([5, 4], false, |u, v| {
        let (x, y) = (6.0 * u - 3.0, 5.0 * v - 2.5);
        [x, y, 0.12 * x * x - 0.15 * y * y + 0.2 * u * v]
    })
}

fn tube() -> Grid {
    grid([4, 6], true, |u, v| {
        let radius = 2.0 + 1.2 * (2.0 * u - 1.0).powi(2);
        let (sin, cos) = (TAU * v).sin_cos();
        [radius * cos + 0.3 * u, 1.1 * radius * sin, 7.0 * u]
    })
}

fn bilge() -> Grid {
    grid([4, 4], false, |u, v| {
        let (sin, cos) = (0.5 * PI * (0.1 + 0.8 * v)).sin_cos();
        let breadth = 5.0 - 0.8 * u * u;
        [9.0 * u, breadth * sin, 4.0 - 3.6 * cos + 0.5 * u * u]
    })
}

/// 4 × 4 quads of a shallow dome.
fn dome() -> Grid {
    grid([5, 5], false, |u, v| {
        let (x, y) = (8.0 * u - 4.0, 6.0 * v - 3.0);
        [x, y, 3.0 - 0.12 * x * x - 0.05 * y * y]
    })
}

fn request(grid: Grid, options: Options) -> Request {
    Request {
        input: Input::Grid(grid),
        options,
    }
}

/// The least time of some runs, seconds, with the outcome.
fn timed(request: &Request) -> Result<(f64, Outcome), FitError> {
    let mut best = f64::INFINITY;
    let mut outcome = None;
    for _ in 0..RUNS {
        let start = Instant::now();
        let found = fit(black_box(request), &Unwatched)?;
        best = best.min(start.elapsed().as_secs_f64());
        outcome = Some(found);
    }
    outcome
        .map(|outcome| (best, outcome))
        .ok_or_else(|| FitError::Numerical("nothing ran".to_owned()))
}

fn by_patches(out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    writeln!(
        out,
        "patches   smooth        a patch   with cyclides   a patch"
    )?;
    for levels in LEVELS {
        let options = |cyclide| Options {
            levels: Some(levels),
            cyclide,
            ..Options::default()
        };
        let (smooth, _) = timed(&request(dome(), options(false)))?;
        let (all, outcome) = timed(&request(dome(), options(true)))?;
        let [n, m] = outcome.net.layout().patch_counts();
        let patches = (n * m) as f64;
        writeln!(
            out,
            "{patches:7} {smooth:8.3} s {:8.1} µs {all:13.3} s {:8.1} µs",
            1e6 * smooth / patches,
            1e6 * all / patches
        )?;
    }
    Ok(())
}

fn against_the_paper(out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    writeln!(
        out,
        "\nmodel     own: time, torsion mean and max      paper: time, torsion mean and max      ratio"
    )?;
    let models = [
        ("vault", vault()),
        ("saddle", saddle()),
        ("tube", tube()),
        ("bilge", bilge()),
    ];
    for (name, grid) in models {
        let options = |solver| Options {
            cyclide: false,
            solver,
            ..Options::default()
        };
        let (own, o) = timed(&request(grid.clone(), options(Solver::Own)))?;
        let (paper, p) = timed(&request(grid, options(Solver::Paper)))?;
        let (o, p) = (&o.smooth.borders, &p.smooth.borders);
        writeln!(
            out,
            "{name:8} {own:7.3} s {:9.1e} {:9.1e} {paper:18.3} s {:9.1e} {:9.1e} {:13.1} ×",
            o.mean_torsion,
            o.max_torsion.value,
            p.mean_torsion,
            p.max_torsion.value,
            paper / own
        )?;
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let out = &mut std::io::stdout().lock();
    by_patches(out)?;
    against_the_paper(out)?;
    Ok(())
}
