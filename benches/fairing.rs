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
use std::time::{Duration, Instant};

/// The least of this many runs, or of as many as begin within [`ENOUGH`]: what
/// the work costs without its neighbours.
const RUNS: usize = 5;
const ENOUGH: Duration = Duration::from_secs(2);
const CURVE_COUNTS: [usize; 5] = [100, 1_000, 10_000, 100_000, 1_000_000];
const SURFACE_COUNTS: [usize; 4] = [1_000, 10_000, 100_000, 1_000_000];
/// Standard deviation of the measurements.
const NOISE: f64 = 0.005;
/// A tolerance that a million errors keep.
const WIDE: f64 = 5.0 * NOISE;

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

/// A frame of some 8 m whose radius swells and shrinks.
fn frame(count: usize) -> Vec<Point3<f64>> {
    let mut noise = Noise(1);
    let point = |i: usize| {
        let t = i as f64 / (count - 1) as f64;
        let (angle, radius) = (0.2 + 1.5 * t, 5.0 + 0.3 * (TAU * t).sin());
        let (y, z) = (radius * angle.sin(), 5.0 - radius * angle.cos());
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
    let begun = Instant::now();
    let mut last = black_box(run()?);
    let mut least = begun.elapsed();
    let mut runs = 0;
    while runs < RUNS && begun.elapsed() < ENOUGH {
        let start = Instant::now();
        last = black_box(run()?);
        least = least.min(start.elapsed());
        runs += 1;
    }
    Ok((1e3 * least.as_secs_f64(), last))
}

/// How the points of a curve come, and what is asked.
struct Case {
    name: &'static str,
    ordered: bool,
    tolerance: Option<f64>,
    solver: Solver,
    most: usize,
}

const CASES: [Case; 5] = [
    Case {
        name: "in order",
        ordered: true,
        tolerance: None,
        solver: Solver::Own,
        most: 1_000_000,
    },
    Case {
        name: "shuffled",
        ordered: false,
        tolerance: None,
        solver: Solver::Own,
        most: 1_000_000,
    },
    Case {
        name: "in order, tolerance",
        ordered: true,
        tolerance: Some(WIDE),
        solver: Solver::Own,
        most: 1_000_000,
    },
    Case {
        name: "shuffled, tolerance",
        ordered: false,
        tolerance: Some(WIDE),
        solver: Solver::Own,
        most: 100_000,
    },
    Case {
        name: "paper, tolerance",
        ordered: true,
        tolerance: Some(WIDE),
        solver: Solver::Paper,
        most: 10_000,
    },
];

impl Case {
    fn request(&self, count: usize) -> curve::Request {
        let points = frame(count);
        let points = if self.ordered {
            points
        } else {
            shuffled(points)
        };
        let mut request = curve::Request::through(points, 2);
        request.ordered = self.ordered;
        request.options.tolerance = self.tolerance;
        request.options.solver = self.solver;
        request
    }
}

fn curves(out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    writeln!(
        out,
        "Curves; each: cost of a point against that of 1,000 in order; paper: cost of the \
         paper's solver in units of ours"
    )?;
    let head = ["points", "", "ms", "each", "paper", "control", "∫κ′²"];
    let [points, name, ms, each, paper, control, rough] = head;
    writeln!(
        out,
        "{points:>10}  {name:<22}{ms:>9}{each:>8}{paper:>8}{control:>9}{rough:>10}"
    )?;
    let (base, _) = timed(|| curve::fit(&CASES[0].request(1000), &Unwatched))?;
    for count in CURVE_COUNTS {
        let mut within = f64::NAN;
        for case in CASES.iter().filter(|c| count <= c.most) {
            let request = case.request(count);
            let (ms, o) = timed(|| curve::fit(&request, &Unwatched))?;
            if case.ordered && case.tolerance.is_some() && case.solver == Solver::Own {
                within = ms;
            }
            let paper = match case.solver {
                Solver::Paper => format!("{:.1}", ms / within),
                Solver::Own => String::new(),
            };
            let each = ms / base * 1e3 / count as f64;
            let (control, rough) = (o.report.control_points, o.after.curvature_variation);
            writeln!(
                out,
                "{count:>10}  {:<22}{ms:>9.1}{each:>8.3}{paper:>8}{control:>9}{rough:>10.4}",
                case.name
            )?;
        }
    }
    Ok(())
}

fn nets(out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    writeln!(
        out,
        "\n10,000 points in order by the number of control points"
    )?;
    let [control, ms, ratio, within] = ["control", "ms", "ratio", "tolerance"];
    writeln!(out, "{control:>10}{ms:>10}{ratio:>8}{within:>12}{ratio:>8}")?;
    let mut first = None;
    for count in [16, 64, 256, 1024] {
        let mut request = CASES[0].request(10_000);
        request.options.control_points = Some(count);
        let (free, _) = timed(|| curve::fit(&request, &Unwatched))?;
        request.options.tolerance = Some(WIDE);
        let (within, _) = timed(|| curve::fit(&request, &Unwatched))?;
        let base = *first.get_or_insert([free, within]);
        writeln!(
            out,
            "{count:>10}{free:>10.1}{:>8.2}{within:>12.1}{:>8.2}",
            free / base[0],
            within / base[1]
        )?;
    }
    Ok(())
}

fn against_the_paper(out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    writeln!(
        out,
        "\n200 points within a tolerance, ours and the paper's one stiffness for all"
    )?;
    let head = [
        "deviations",
        "ours ms",
        "∫κ′²",
        "paper ms",
        "∫κ′²",
        "rougher",
    ];
    let [deviations, ours, rough, paper, _, rougher] = head;
    writeln!(
        out,
        "{deviations:>10}{ours:>10}{rough:>12}{paper:>10}{rough:>12}{rougher:>10}"
    )?;
    for deviations in [2.5, 3.0, 4.0, 6.0] {
        let with = |solver: Solver| {
            let mut request = CASES[0].request(200);
            request.options.tolerance = Some(deviations * NOISE);
            request.options.solver = solver;
            timed(|| curve::fit(&request, &Unwatched))
        };
        let (ours, paper) = (with(Solver::Own)?, with(Solver::Paper)?);
        let [a, b] = [&ours.1, &paper.1].map(|o| o.after.curvature_variation);
        writeln!(
            out,
            "{deviations:>10}{:>10.1}{a:>12.4}{:>10.1}{b:>12.4}{:>10.2}",
            ours.0,
            paper.0,
            b / a
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
    nets(&mut out)?;
    against_the_paper(&mut out)?;
    surfaces(&mut out)
}
