//! What fairing costs: curves and surfaces by their number of points, in order
//! and shuffled; this crate's solver against the paper's, whose one stiffness
//! for all points leaves the curve rougher at the same largest move.
//!
//! A plain harness, since the fairness stands next to the time. Only ratios
//! mean anything: the machine is whatever runs it. `cargo bench --bench fairing`.

use mouldloft::methods::FitError;
use mouldloft::methods::fairing::curve::{self, request::Solver};
use mouldloft::methods::fairing::surface;
use mouldloft::solver::Unwatched;
use nalgebra::Point3;
use std::error::Error;
use std::f64::consts::TAU;
use std::hint::black_box;
use std::io::Write;
use std::time::Instant;

/// The least of this many runs: what the work costs without its neighbours.
const RUNS: usize = 3;
const CURVE_COUNTS: [usize; 5] = [100, 1_000, 10_000, 100_000, 1_000_000];
const SHUFFLED_COUNTS: [usize; 3] = [1_000, 10_000, 100_000];
const SURFACE_COUNTS: [usize; 4] = [1_000, 10_000, 100_000, 1_000_000];
/// Standard deviation of the measurements, and the tolerance of the comparison
/// with the paper: about the largest of a few hundred errors.
const NOISE: f64 = 0.005;
const TOLERANCE: f64 = 3.0 * NOISE;

/// Deterministic noise, about normal: the sum of twelve even ones.
struct Noise(u64);

impl Noise {
    fn even(&mut self) -> f64 {
        // Knuth's constants (MMIX).
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn next(&mut self) -> f64 {
        NOISE * ((0..12).map(|_| self.even()).sum::<f64>() - 6.0)
    }
}

/// A frame of 10 m with a bilge and a flare.
fn frame(count: usize) -> Vec<Point3<f64>> {
    let mut noise = Noise(1);
    let point = |i: usize| {
        let t = i as f64 / (count - 1) as f64;
        let angle = 0.2 + 1.4 * t + 0.25 * (TAU * t).sin();
        let (y, z) = (5.0 * angle.sin(), 5.0 * (1.0 - angle.cos()));
        Point3::new(y + noise.next(), z + noise.next(), 0.0)
    };
    (0..count).map(point).collect()
}

/// A side of a hull with a hollow.
fn sheet(count: usize) -> Vec<Point3<f64>> {
    let mut noise = Noise(2);
    let point = |_| {
        let (u, v) = (noise.even(), noise.even());
        let y = 1.0 - 0.8 * (2.0 * u - 1.0).powi(2) * (1.0 - 0.3 * v) + 0.2 * (3.0 * v).sin();
        Point3::new(8.0 * u, y + noise.next(), 2.0 * v)
    };
    (0..count).map(point).collect()
}

fn shuffled(mut points: Vec<Point3<f64>>) -> Vec<Point3<f64>> {
    let mut noise = Noise(3);
    for i in (1..points.len()).rev() {
        let j = (noise.even() * (i + 1) as f64) as usize;
        points.swap(i, j);
    }
    points
}

fn timed<T>(run: impl Fn() -> Result<T, FitError>) -> Result<(f64, T), FitError> {
    let mut least = f64::INFINITY;
    let mut last = run()?;
    for _ in 0..RUNS {
        let start = Instant::now();
        last = black_box(run()?);
        least = least.min(1e3 * start.elapsed().as_secs_f64());
    }
    Ok((least, last))
}

fn curves(out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    writeln!(
        out,
        "Curves, noise estimated; ratio to the cost of a point at 100"
    )?;
    writeln!(
        out,
        "{:>22}{:>10}{:>10}{:>12}",
        "points", "ms", "ratio", "control"
    )?;
    for (order, counts) in [(true, &CURVE_COUNTS[..]), (false, &SHUFFLED_COUNTS[..])] {
        let mut first = None;
        for count in counts {
            let points = if order {
                frame(*count)
            } else {
                shuffled(frame(*count))
            };
            let mut request = curve::Request::through(points, 2);
            request.ordered = order;
            let (ms, outcome) = timed(|| curve::fit(&request, &Unwatched))?;
            let each = ms / *count as f64;
            let ratio = each / *first.get_or_insert(each);
            let label = format!("{count}{}", if order { "" } else { " shuffled" });
            let control = outcome.report.control_points;
            writeln!(out, "{label:>22}{ms:>10.1}{ratio:>10.3}{control:>12}")?;
        }
    }
    Ok(())
}

fn against_the_paper(out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    writeln!(out, "\nWithin a tolerance of three deviations, 300 points")?;
    writeln!(
        out,
        "{:>22}{:>10}{:>10}{:>12}{:>12}",
        "", "ms", "ratio", "max move", "∫κ′²"
    )?;
    let mut first = None;
    for (name, solver) in [("ours", Solver::Own), ("paper", Solver::Paper)] {
        let mut request = curve::Request::through(frame(300), 2);
        request.options.tolerance = Some(TOLERANCE);
        request.options.solver = solver;
        let (ms, outcome) = timed(|| curve::fit(&request, &Unwatched))?;
        let ratio = ms / *first.get_or_insert(ms);
        writeln!(
            out,
            "{name:>22}{ms:>10.1}{ratio:>10.1}{:>12.5}{:>12.4}",
            outcome.move_figures.max, outcome.after.curvature_variation
        )?;
    }
    Ok(())
}

fn surfaces(out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    writeln!(
        out,
        "\nSurfaces through scattered points; ratio to the cost of a point at 1,000"
    )?;
    writeln!(
        out,
        "{:>22}{:>10}{:>10}{:>12}{:>12}",
        "points", "ms", "ratio", "control", "noise"
    )?;
    let mut first = None;
    for count in SURFACE_COUNTS {
        let request = surface::Request {
            points: surface::request::Points::Scattered(sheet(count)),
            options: surface::request::Options::default(),
        };
        let (ms, outcome) = timed(|| surface::fit(&request, &Unwatched))?;
        let each = ms / count as f64;
        let ratio = each / *first.get_or_insert(each);
        let [m, n] = outcome.surface.counts();
        let control = format!("{m} × {n}");
        let noise = outcome.noise;
        writeln!(
            out,
            "{count:>22}{ms:>10.1}{ratio:>10.3}{control:>12}{noise:>12.5}"
        )?;
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut out = std::io::stdout().lock();
    curves(&mut out)?;
    against_the_paper(&mut out)?;
    surfaces(&mut out)
}
