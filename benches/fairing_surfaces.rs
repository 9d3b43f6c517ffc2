//! What fairing sheets costs: height fields and folded sheets by their number
//! of points, by the size of the control net, tables of offsets by their
//! cells; this crate's solver against the paper's within one tolerance.
//!
//! A plain harness, since noise and fairness stand next to the time. Only
//! ratios mean anything: the machine is whatever runs it.
//! `cargo bench --bench fairing_surfaces`.

use mouldloft::methods::FitError;
use mouldloft::methods::fairing::offsets;
use mouldloft::methods::fairing::surface::request::{Options, Points, Solver, Tolerance};
use mouldloft::methods::fairing::surface::{self, Outcome, Request};
use mouldloft::solver::Unwatched;
use nalgebra::Point3;
use std::error::Error;
use std::f64::consts::PI;
use std::hint::black_box;
use std::io::Write;
use std::time::Instant;

/// The least of this many runs: what the work costs without its neighbours.
const RUNS: usize = 3;
const COUNTS: [usize; 5] = [100, 1_000, 10_000, 100_000, 1_000_000];
const FOLDED_COUNTS: [usize; 4] = [1_000, 10_000, 100_000, 1_000_000];
const NETS: [usize; 5] = [10, 20, 30, 40, 60];
/// Stations and waterlines.
const TABLES: [[usize; 2]; 4] = [[13, 8], [21, 11], [41, 24], [101, 40]];
/// Standard deviation of the measurements, and a tolerance of about the
/// largest of a thousand errors.
const NOISE: f64 = 0.005;
const TOLERANCE: f64 = 4.0 * NOISE;

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

type Shape = fn(f64, f64) -> Point3<f64>;

/// A side of a hull, 10 m by 3 m.
fn hull(u: f64, v: f64) -> Point3<f64> {
    let s = (10.0 * u - 4.5) / 6.0;
    let depth = 1.0 - (1.0 - (3.0 * v + 0.35) / 3.6).powi(4);
    let y = 2.0 * (1.0 - s * s - 0.2 * s.powi(4)) * depth;
    Point3::new(10.0 * u, y, 3.0 * v)
}

/// A shell of 200°, 4 m long.
fn shell(u: f64, v: f64) -> Point3<f64> {
    let angle = (200.0 * v - 10.0).to_radians();
    let radius = 1.0 + 0.2 * u + 0.08 * (2.0 * PI * u).sin() * (2.0 * angle).cos();
    Point3::new(4.0 * u, radius * angle.cos(), radius * angle.sin())
}

fn cloud(shape: Shape, count: usize) -> Request {
    let mut noise = Noise(2);
    let mut point = |_| {
        let p = shape(noise.even(), noise.even());
        Point3::new(p.x + noise.next(), p.y + noise.next(), p.z + noise.next())
    };
    Request {
        points: Points::Scattered((0..count).map(&mut point).collect()),
        options: Options::default(),
    }
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

fn net(outcome: &Outcome) -> String {
    let [m, n] = outcome.surface.counts();
    format!("{m} × {n}")
}

fn by_points(out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    writeln!(
        out,
        "Scattered points; ratio to the cost of a point at the first"
    )?;
    writeln!(
        out,
        "{:>20}{:>10}{:>10}{:>12}{:>12}",
        "points", "ms", "ratio", "control", "noise"
    )?;
    let kinds: [(&str, Shape, &[usize]); 2] =
        [("", hull, &COUNTS), (" folded", shell, &FOLDED_COUNTS)];
    for (kind, shape, counts) in kinds {
        let mut first = None;
        for count in counts {
            let request = cloud(shape, *count);
            let (ms, outcome) = timed(|| surface::fit(&request, &Unwatched))?;
            let each = ms / *count as f64;
            let ratio = each / *first.get_or_insert(each);
            let label = format!("{count}{kind}");
            let (control, noise) = (net(&outcome), outcome.noise);
            writeln!(
                out,
                "{label:>20}{ms:>10.1}{ratio:>10.3}{control:>12}{noise:>12.5}"
            )?;
        }
    }
    Ok(())
}

fn by_net(out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    writeln!(out, "\n100,000 points by the control net")?;
    writeln!(out, "{:>20}{:>10}{:>10}", "control", "ms", "ratio")?;
    let mut first = None;
    for n in NETS {
        let mut request = cloud(hull, 100_000);
        request.options.control_points = Some([n, n]);
        let (ms, outcome) = timed(|| surface::fit(&request, &Unwatched))?;
        let ratio = ms / *first.get_or_insert(ms);
        writeln!(out, "{:>20}{ms:>10.1}{ratio:>10.2}", net(&outcome))?;
    }
    Ok(())
}

fn tables(out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    writeln!(
        out,
        "\nTables of offsets; ratio to the cost of a cell at the first"
    )?;
    writeln!(out, "{:>20}{:>10}{:>10}", "cells", "ms", "ratio")?;
    let mut first = None;
    for [rows, columns] in TABLES {
        let mut noise = Noise(3);
        let line = |n: usize, length: f64| -> Vec<f64> {
            (0..n).map(|i| length * i as f64 / (n - 1) as f64).collect()
        };
        let (stations, waterlines) = (line(rows, 10.0), line(columns, 3.0));
        let mut cell = |x: &f64, z: &f64| {
            let y = hull(x / 10.0, z / 3.0).y;
            Some((y + noise.next()).max(0.0))
        };
        let half_breadths = (stations.iter())
            .map(|x| waterlines.iter().map(|z| cell(x, z)).collect())
            .collect();
        let request = offsets::Request {
            stations,
            waterlines,
            half_breadths,
            options: offsets::request::Options::default(),
        };
        let (ms, _) = timed(|| offsets::fit(&request, &Unwatched))?;
        let each = ms / (rows * columns) as f64;
        let ratio = each / *first.get_or_insert(each);
        let label = format!("{rows} × {columns}");
        writeln!(out, "{label:>20}{ms:>10.1}{ratio:>10.3}")?;
    }
    Ok(())
}

fn against_the_paper(out: &mut impl Write) -> Result<(), Box<dyn Error>> {
    writeln!(
        out,
        "\nWithin a tolerance of four deviations, 33 × 20 points"
    )?;
    writeln!(
        out,
        "{:>20}{:>10}{:>10}{:>12}{:>16}",
        "", "ms", "ratio", "max move", "rough isophotes"
    )?;
    let mut noise = Noise(4);
    let mut point = |i: usize, j: usize| {
        let p = hull(i as f64 / 32.0, j as f64 / 19.0);
        Some(Point3::new(p.x, p.y + noise.next(), p.z))
    };
    let rows: Vec<Vec<_>> = (0..33)
        .map(|i| (0..20).map(|j| point(i, j)).collect())
        .collect();
    let mut first = None;
    for (name, solver) in [("ours", Solver::Own), ("paper", Solver::Paper)] {
        let request = Request {
            points: Points::Grid(rows.clone()),
            options: Options {
                tolerance: Some(Tolerance::Same(TOLERANCE)),
                solver,
                ..Options::default()
            },
        };
        let (ms, outcome) = timed(|| surface::fit(&request, &Unwatched))?;
        let ratio = ms / *first.get_or_insert(ms);
        writeln!(
            out,
            "{name:>20}{ms:>10.1}{ratio:>10.2}{:>12.5}{:>16.4}",
            outcome.move_max, outcome.after.isophote_roughness
        )?;
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut out = std::io::stdout().lock();
    by_points(&mut out)?;
    by_net(&mut out)?;
    tables(&mut out)?;
    against_the_paper(&mut out)
}
