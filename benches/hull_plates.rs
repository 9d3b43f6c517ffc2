//! What a fit costs: this crate's solver against the paper's on the trawler in
//! one run, and how the cost grows with points, control points and profiles.
//!
//! A plain harness, since the twist stands next to the time. Only ratios mean
//! anything: the machine is whatever runs it. `cargo bench --bench hull_plates`.

use mouldloft::geometry::{Parametrization, interpolate};
use mouldloft::methods::FitError;
use mouldloft::methods::hull_plates::request::{
    Boundary, Options, Profile, ProfileShape, Request, Solver,
};
use mouldloft::methods::hull_plates::{Outcome, fit};
use mouldloft::solver::Unwatched;
use nalgebra::Point3;
use std::error::Error;
use std::hint::black_box;
use std::time::Instant;

/// The least of this many runs: what the work costs without its neighbours.
const RUNS: usize = 3;
/// Zheng & Bo's threshold, as share of the trawler's 70 ft.
const PAPER_TOLERANCE: f64 = 0.0004 * 70.0;
const POINT_COUNTS: [usize; 4] = [13, 50, 200, 1000];
const PROFILE_COUNTS: [usize; 3] = [2, 4, 8];
/// Points of each profile where the number of profiles grows.
const POINTS_OF_EACH: usize = 25;

/// Stations and offsets (x; y, z of each profile) of the UBC trawler, feet
/// (Zheng & Bo 2018, table 1).
const STATIONS: [f64; 13] = [
    0.0, 7.0, 14.0, 21.0, 28.0, 35.0, 42.0, 49.0, 56.0, 59.5, 63.0, 66.5, 70.0,
];
const OFFSETS: [(&str, [[f64; 2]; 13]); 4] = [
    (
        "main_deck",
        [
            [11.48, 12.72],
            [11.48, 11.91],
            [11.48, 11.21],
            [11.48, 10.27],
            [11.48, 10.27],
            [11.49, 10.30],
            [11.16, 10.58],
            [9.96, 11.21],
            [7.91, 12.06],
            [6.54, 12.55],
            [5.03, 13.08],
            [3.40, 13.64],
            [1.71, 14.19],
        ],
    ),
    (
        "upper_chine",
        [
            [10.36, 7.77],
            [10.52, 6.10],
            [10.64, 4.78],
            [10.75, 3.71],
            [10.82, 2.90],
            [10.78, 2.70],
            [10.35, 3.25],
            [9.09, 4.46],
            [6.84, 5.99],
            [5.34, 6.79],
            [3.67, 7.69],
            [1.89, 8.35],
            [0.0, 9.16],
        ],
    ),
    (
        "lower_chine",
        [
            [8.78, 6.98],
            [8.96, 5.09],
            [9.11, 3.59],
            [9.23, 2.35],
            [9.31, 1.51],
            [9.29, 1.24],
            [9.04, 1.77],
            [8.23, 2.86],
            [6.49, 4.32],
            [5.19, 5.09],
            [3.65, 5.85],
            [1.86, 6.66],
            [0.0, 7.39],
        ],
    ),
    (
        "profile",
        [
            [0.0, 5.71],
            [0.0, 3.62],
            [0.0, 1.80],
            [0.0, 0.49],
            [0.0, -0.12],
            [0.0, 0.0],
            [0.0, 0.19],
            [0.0, 0.46],
            [0.0, 0.71],
            [0.0, 0.80],
            [0.0, 0.96],
            [0.0, 1.11],
            [0.0, 2.99],
        ],
    ),
];

fn main() -> Result<(), Box<dyn Error>> {
    let mut out = std::io::stdout().lock();
    against_the_paper(&mut out)?;
    by_points(&mut out)?;
    by_profiles(&mut out)
}

fn trawler() -> Vec<Profile> {
    let points = |offsets: &[[f64; 2]; 13]| {
        STATIONS
            .iter()
            .zip(offsets)
            .map(|(x, [y, z])| Point3::new(*x, *y, *z))
            .collect()
    };
    OFFSETS
        .iter()
        .map(|(name, offsets)| profile(name, points(offsets)))
        .collect()
}

fn profile(name: &str, points: Vec<Point3<f64>>) -> Profile {
    Profile {
        name: name.into(),
        shape: ProfileShape::Points(points),
    }
}

fn request(profiles: Vec<Profile>, boundary: Boundary, solver: Solver) -> Request {
    Request {
        profiles,
        options: Options {
            boundary,
            solver,
            ..Options::default()
        },
    }
}

/// Least milliseconds of a fit, and its outcome.
fn timed(request: &Request) -> Result<(f64, Outcome), FitError> {
    let mut least = f64::INFINITY;
    let mut outcome = fit(request, &Unwatched)?;
    for _ in 0..RUNS {
        let start = Instant::now();
        outcome = black_box(fit(black_box(request), &Unwatched)?);
        least = least.min(1e3 * start.elapsed().as_secs_f64());
    }
    Ok((least, outcome))
}

fn twists(outcome: &Outcome) -> String {
    let twist = |p: &mouldloft::methods::hull_plates::outcome::Plate| {
        let d = &p.diagnostics;
        format!("{:.2}/{:.3}", d.twist_max_deg, d.twist_mean_deg)
    };
    outcome
        .plates
        .iter()
        .map(twist)
        .collect::<Vec<_>>()
        .join("  ")
}

/// Largest distance of a profile from its plates' boundary, % of the model.
fn deviation(outcome: &Outcome) -> f64 {
    let largest = outcome
        .profiles
        .iter()
        .map(|p| p.deviation.curve_max)
        .fold(0.0, f64::max);
    100.0 * largest / outcome.model_size
}

fn against_the_paper(out: &mut impl std::io::Write) -> Result<(), Box<dyn Error>> {
    writeln!(
        out,
        "UBC trawler, three plates; twist max/mean of each in degrees"
    )?;
    writeln!(
        out,
        "{:<22}{:>10}{:>10}{:>12}  twist",
        "", "ms", "ratio", "moved, %"
    )?;
    for (mode, boundary) in [
        ("exact", Boundary::Exact),
        ("0.04 %", Boundary::Tolerance(PAPER_TOLERANCE)),
    ] {
        let (ours, own) = timed(&request(trawler(), boundary, Solver::Own))?;
        let (theirs, paper) = timed(&request(trawler(), boundary, Solver::Paper))?;
        for (name, ms, outcome) in [("ours", ours, &own), ("paper", theirs, &paper)] {
            let (ratio, moved) = (ms / ours, deviation(outcome));
            let label = format!("{mode}, {name}");
            writeln!(
                out,
                "{label:<22}{ms:>10.1}{ratio:>10.1}{moved:>12.5}  {}",
                twists(outcome)
            )?;
        }
    }
    Ok(())
}

/// `count` points on the curve through the trawler's points.
fn resampled(profile: &Profile, count: usize) -> Result<Profile, Box<dyn Error>> {
    let ProfileShape::Points(points) = &profile.shape else {
        return Ok(profile.clone());
    };
    let curve = interpolate(points, 3, Parametrization::ChordLength)?;
    let place = |i: usize| curve.point(i as f64 / (count - 1) as f64);
    Ok(Profile {
        name: profile.name.clone(),
        shape: ProfileShape::Points((0..count).map(place).collect()),
    })
}

fn by_points(out: &mut impl std::io::Write) -> Result<(), Box<dyn Error>> {
    writeln!(
        out,
        "\nOurs by points (= control points) of a profile, four profiles"
    )?;
    writeln!(
        out,
        "{:>22}{:>10}{:>10}{:>12}  twist",
        "points", "ms", "ratio", "rulings"
    )?;
    for (mode, boundary) in [
        ("exact", Boundary::Exact),
        ("0.04 %", Boundary::Tolerance(PAPER_TOLERANCE)),
    ] {
        let mut first = None;
        for count in POINT_COUNTS {
            let profiles = trawler()
                .iter()
                .map(|p| resampled(p, count))
                .collect::<Result<Vec<_>, _>>()?;
            let (ms, outcome) = timed(&request(profiles, boundary, Solver::Own))?;
            let ratio = ms / *first.get_or_insert(ms);
            let rulings: usize = outcome.plates.iter().map(|p| p.rulings.len()).sum();
            let label = format!("{mode}, {count}");
            writeln!(
                out,
                "{label:>22}{ms:>10.1}{ratio:>10.1}{rulings:>12}  {}",
                twists(&outcome)
            )?;
        }
    }
    Ok(())
}

/// A round-bilged hull of `count` profiles: waterlines of a form whose
/// sections open upwards, so that every plate bends and twists a little.
fn hull(count: usize) -> Vec<Profile> {
    let waterline = |k: usize| {
        let height = k as f64 / (count - 1) as f64;
        let point = |i: usize| {
            let x = i as f64 / (POINTS_OF_EACH - 1) as f64;
            let breadth = 0.04 + 0.12 * (0.3 + height) * (1.0 - (2.0 * x - 1.0).powi(2));
            Point3::new(x, breadth, 0.3 * height + 0.03 * height * (x - 0.4).powi(2))
        };
        profile(
            &format!("line_{k}"),
            (0..POINTS_OF_EACH).map(point).collect(),
        )
    };
    (0..count).map(waterline).collect()
}

fn by_profiles(out: &mut impl std::io::Write) -> Result<(), Box<dyn Error>> {
    writeln!(
        out,
        "\nOurs by profiles, {POINTS_OF_EACH} points each, exact"
    )?;
    writeln!(
        out,
        "{:>22}{:>10}{:>10}{:>12}",
        "profiles", "ms", "ratio", "rulings"
    )?;
    let mut first = None;
    for count in PROFILE_COUNTS {
        let (ms, outcome) = timed(&request(hull(count), Boundary::Exact, Solver::Own))?;
        let ratio = ms / *first.get_or_insert(ms);
        let rulings: usize = outcome.plates.iter().map(|p| p.rulings.len()).sum();
        writeln!(out, "{count:>22}{ms:>10.1}{ratio:>10.1}{rulings:>12}")?;
    }
    Ok(())
}
