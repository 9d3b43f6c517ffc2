//! What rolling a strip costs: time against the number of patches and against
//! the number of vertices; this crate's solver against the paper's on strips
//! like the paper's own, error and time.
//!
//! A plain harness, since errors stand next to the time. Only ratios mean
//! anything: the machine is whatever runs it. `cargo bench --bench
//! cone_spline`.

use mouldloft::geometry::cone::{Frame, Strain};
use mouldloft::methods::FitError;
use mouldloft::methods::cone_spline::request::{Goal, Input, Norm, Options, Request, Solver};
use mouldloft::methods::cone_spline::{Outcome, fit};
use mouldloft::solver::Unwatched;
use nalgebra::{Point3, Vector3};
use std::error::Error;
use std::f64::consts::PI;
use std::hint::black_box;
use std::io::Write;
use std::time::Instant;

/// The least of this many runs: what the work costs without its neighbours.
const RUNS: usize = 3;
const PATCHES: [usize; 3] = [4, 8, 16];
const VERTICES: [usize; 4] = [1_000, 10_000, 100_000, 1_000_000];
/// Vertices of a strip where their number is not looked at.
const USUAL: usize = 2_500;
/// Steps of the frame along a strip, at least.
const STEPS: usize = 4_000;

/// A strip swept by a frame: strain and half width by arc length.
struct Swept {
    strain: fn(f64) -> [f64; 2],
    half_width: fn(f64) -> f64,
    length: f64,
}

/// Rows of about `count` vertices in all, from one long side to the other.
type Rows = Vec<Vec<Point3<f64>>>;

/// Rows and columns of about `count` vertices, squares or a little longer.
fn size(count: usize) -> [usize; 2] {
    let across = ((count as f64 / 10.0).sqrt() as usize).max(4);
    [count / across, across]
}

impl Swept {
    fn rows(&self, count: usize) -> Rows {
        let [rows, across] = size(count);
        let fine = STEPS.div_ceil(rows - 1);
        let step = self.length / ((rows - 1) * fine) as f64;
        let mut frame = Frame {
            point: Point3::origin(),
            ruling: Vector3::x(),
            normal: Vector3::z(),
        };
        let mut all = Vec::with_capacity(rows);
        for i in 0..=(rows - 1) * fine {
            let s = i as f64 * step;
            if i % fine == 0 {
                let width = (self.half_width)(s);
                let at = |j: usize| frame.at(width * (2.0 * j as f64 / (across - 1) as f64 - 1.0));
                all.push((0..across).map(at).collect());
            }
            let [g, k] = (self.strain)(s + 0.5 * step);
            frame = frame.carried(Strain { g, k }, step);
        }
        all
    }
}

fn even(_: f64) -> f64 {
    0.3
}

fn c(count: usize) -> Rows {
    let strain = |s: f64| {
        let bump = (-((s - 2.7) / 0.4).powi(2)).exp();
        let k = 0.45 + 1.3 * (PI * s / 3.0 - 0.3).sin().powi(4) + 0.5 * bump;
        [0.25 * (1.3 * s + 0.4).sin(), k]
    };
    let strip = Swept {
        strain,
        half_width: even,
        length: 3.0,
    };
    strip.rows(count)
}

fn s(count: usize) -> Rows {
    let strain = |s: f64| {
        let g = 0.3 * (1.1 * s).cos() + 0.15 * (2.3 * s).sin();
        [g, 1.6 * (0.5 * PI * s + 0.25).sin() + 0.3 * (3.0 * s).sin()]
    };
    let strip = Swept {
        strain,
        half_width: even,
        length: 4.0,
    };
    strip.rows(count)
}

fn width(count: usize) -> Rows {
    let strain = |s: f64| {
        let k = 1.2 + 1.3 * (2.1 * s).cos() + 0.5 * (4.0 * s).sin();
        [0.5 * (1.7 * s - 0.5).sin(), k]
    };
    let strip = Swept {
        strain,
        half_width: |s| 0.16 + 0.28 * ((s - 1.6) / 1.6).powi(2),
        length: 3.2,
    };
    strip.rows(count)
}

fn wavy(count: usize) -> Rows {
    let strain = |s: f64| {
        let g = 0.35 * (2.0 * s).sin() + 0.2 * (3.1 * s).cos();
        [g, 2.6 * (2.0 * PI * s / 1.7).sin() + 0.7 * (2.2 * s).cos()]
    };
    let strip = Swept {
        strain,
        half_width: even,
        length: 5.0,
    };
    strip.rows(count)
}

/// A strip of the tangents of a helix, 1.6 turns.
fn helix(count: usize) -> Rows {
    let [rows, across] = size(count);
    let point = |i: usize, j: usize| {
        let u = 3.2 * PI * i as f64 / (rows - 1) as f64;
        let v = 0.9 + 0.5 * j as f64 / (across - 1) as f64;
        let (sin, cos) = u.sin_cos();
        Point3::new(cos - v * sin, sin + v * cos, 0.35 * (u + v))
    };
    (0..rows)
        .map(|i| (0..across).map(|j| point(i, j)).collect())
        .collect()
}

/// The mesh of rows, its longest side 1.
fn strip(rows: &Rows) -> Input {
    let across = rows[0].len();
    let points = rows.concat();
    let extent = |axis: usize| {
        let values = || points.iter().map(|p| p[axis]);
        values().fold(f64::MIN, f64::max) - values().fold(f64::MAX, f64::min)
    };
    let scale = 1.0 / [0, 1, 2].map(extent).into_iter().fold(0.0, f64::max);
    let face = |i: usize| {
        let (row, column) = (i / (across - 1), i % (across - 1));
        let at = |a: usize, b: usize| (row + a) * across + column + b;
        vec![at(0, 0), at(0, 1), at(1, 1), at(1, 0)]
    };
    Input::Mesh {
        faces: (0..(rows.len() - 1) * (across - 1)).map(face).collect(),
        vertices: points.iter().map(|p| p * scale).collect(),
    }
}

fn request(input: Input, pieces: usize, solver: Solver) -> Request {
    Request {
        name: "strip".to_owned(),
        input,
        options: Options {
            goal: Goal::Pieces(pieces),
            solver,
            ..Options::default()
        },
    }
}

/// The least time of some runs, seconds, with the outcome.
fn timed(request: &Request) -> Result<(f64, Outcome), FitError> {
    let mut best = f64::INFINITY;
    let mut run = || {
        let start = Instant::now();
        let found = fit(black_box(request), &Unwatched);
        best = best.min(start.elapsed().as_secs_f64());
        found
    };
    let mut outcome = run()?;
    for _ in 1..RUNS {
        outcome = run()?;
    }
    Ok((best, outcome))
}

fn by_patches(out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    writeln!(out, "The wavy strip, {USUAL} vertices, by its patches")?;
    writeln!(
        out,
        "{:>10}{:>10}{:>10}{:>12}",
        "patches", "ms", "ratio", "error"
    )?;
    let mut first = None;
    for patches in PATCHES {
        let (time, outcome) = timed(&request(strip(&wavy(USUAL)), patches, Solver::Own))?;
        let ratio = time / *first.get_or_insert(time);
        let (ms, error) = (1e3 * time, outcome.to_surface.max);
        writeln!(out, "{patches:>10}{ms:>10.1}{ratio:>10.2}{error:>12.1e}")?;
    }
    Ok(())
}

fn by_vertices(out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    writeln!(
        out,
        "\nThe S in 8 patches, by its vertices; ratio to the cost of a vertex at the first"
    )?;
    writeln!(
        out,
        "{:>10}{:>10}{:>10}{:>12}",
        "vertices", "ms", "ratio", "error"
    )?;
    let mut first = None;
    for count in VERTICES {
        let rows = s(count);
        let vertices = rows.len() * rows[0].len();
        let (time, outcome) = timed(&request(strip(&rows), 8, Solver::Own))?;
        let each = time / vertices as f64;
        let ratio = each / *first.get_or_insert(each);
        let (ms, error) = (1e3 * time, outcome.to_surface.max);
        writeln!(out, "{vertices:>10}{ms:>10.1}{ratio:>10.3}{error:>12.1e}")?;
    }
    Ok(())
}

/// "0.00123 0.00045  12.3": largest and mean distance, milliseconds; a star
/// where a joint runs past an apex.
fn told(run: &Result<(f64, Outcome), FitError>) -> String {
    match run {
        Ok((time, o)) => {
            let (max, mean) = (o.to_surface.max, o.to_surface.mean);
            let star = if o.within_limits { ' ' } else { '*' };
            format!("{max:>10.5}{mean:>10.5}{:>9.1}{star}", 1e3 * time)
        }
        Err(_) => format!("{:>29} ", "no chain that can be rolled"),
    }
}

fn against_the_paper(out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    writeln!(
        out,
        "\nLargest and mean distance (longest side 1), ms; then the paper's over own: largest \
         distance (also over own with the norm \"minimax\"), mean, time. *: cannot be rolled"
    )?;
    writeln!(
        out,
        "{:<8}{:>8}{:>29} {:>29} {:>9}{:>9}{:>9}{:>9}",
        "strip", "patches", "own", "paper", "largest", "minimax", "mean", "time"
    )?;
    let strips: [(&str, Rows, &[usize]); 5] = [
        ("C", c(USUAL), &[4, 8]),
        ("S", s(USUAL), &[8]),
        ("width", width(USUAL), &[6]),
        ("helix", helix(USUAL), &[8, 13]),
        ("wavy", wavy(USUAL), &[4, 8, 16, 20]),
    ];
    for (name, rows, counts) in strips {
        for patches in counts {
            let request = |solver| request(strip(&rows), *patches, solver);
            let (own, paper) = (timed(&request(Solver::Own)), timed(&request(Solver::Paper)));
            let mut minimax = request(Solver::Own);
            minimax.options.norm = Some(Norm::Minimax);
            let ratios = match (&own, &paper, fit(&minimax, &Unwatched)) {
                (Ok((t, o)), Ok((u, p)), Ok(least)) if o.within_limits && p.within_limits => {
                    format!(
                        "{:>9.1}{:>9.1}{:>9.1}{:>9.1}",
                        p.to_surface.max / o.to_surface.max,
                        p.to_surface.max / least.to_surface.max,
                        p.to_surface.mean / o.to_surface.mean,
                        u / t
                    )
                }
                _ => String::new(),
            };
            let (own, paper) = (told(&own), told(&paper));
            writeln!(out, "{name:<8}{patches:>8}{own}{paper}{ratios}")?;
        }
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let out = &mut std::io::stdout().lock();
    by_patches(out)?;
    by_vertices(out)?;
    against_the_paper(out)
}
