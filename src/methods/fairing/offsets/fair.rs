//! The fair surface of a table, and the table read back from it.

use super::hull_outline::{Place, places};
use super::lines::{Lines, lines};
use super::outcome::{Cell, CellKind, CellSlip};
use super::request::Request;
use crate::methods::FitError;
use crate::methods::fairing::surface;
use crate::solver::Control;
use nalgebra::{Point3, Vector3};
use surface::fit::Fit;
use surface::grid_fit::{DEGREE, best, order};
use surface::net::{Net, Sheet};
use surface::outcome::Parametrisation;
use surface::region::Region;
use surface::report::moved;
use surface::request::{Points, Tolerance};
use surface::springs::Springs;
use surface::task::{Layout, Task};

/// An edge zero is the hull's ending where the surface that never saw it is
/// nearer to zero than this many σ, ...
const ENDING_SIGMAS: f64 = 3.0;
/// ... or than this share of the greatest half-breadth.
const ENDING_SHARE: f64 = 0.01;

/// Everything that the outcome is made of.
pub(super) struct Faired {
    pub(super) surface: surface::Outcome,
    pub(super) table: Vec<Vec<Cell>>,
    pub(super) slips: Vec<CellSlip>,
    pub(super) notes: Vec<String>,
    /// Parameters of stations and waterlines.
    pub(super) at: [Vec<f64>; 2],
    /// What the cells turned out to be.
    pub(super) kinds: Vec<Vec<CellKind>>,
}

/// Fairs a valid table.
///
/// # Errors
/// [`FitError::Stopped`], [`FitError::Numerical`].
pub(super) fn fair(request: &Request, control: &dyn Control) -> Result<Faired, FitError> {
    let places = places(request);
    let mut kinds: Vec<Vec<CellKind>> = places
        .iter()
        .map(|row| row.iter().map(|p| kind(*p)).collect())
        .collect();
    let mut task = task(request, &kinds)?;
    let families = families(request, &task)?;
    let mut fit = field(&task, &families, control)?;
    let endings = endings(request, &places, (&fit, &task, &families), &mut kinds);
    if endings > 0 {
        task = self::task(request, &kinds)?;
        fit = field(&task, &families, control)?;
    }
    let region = region(&families, &kinds);
    let bounded = surface::bounded(&task, &fit, control)?;
    let found = (Parametrisation::Grid, &region);
    let mut surface = surface::conclude(&task, (&fit, bounded), found, control)?;
    let at = families.map(|f| f.at);
    keep_outboard(&mut surface, &mut kinds, &at);
    Ok(Faired {
        table: table(request, &kinds, (&surface, &at)),
        slips: slips(request, &surface),
        notes: notes(&places, endings, &surface),
        surface,
        at,
        kinds,
    })
}

fn kind(place: Place) -> CellKind {
    match place {
        Place::Hull => CellKind::Measured,
        Place::Gap => CellKind::Filled,
        Place::Edge | Place::Outside => CellKind::Outside,
    }
}

fn measured(kind: CellKind) -> bool {
    matches!(kind, CellKind::Measured | CellKind::Ending)
}

/// The measured cells as a grid of points that move along y.
fn task(request: &Request, kinds: &[Vec<CellKind>]) -> Result<Task, FitError> {
    let point = |i: usize, j: usize| {
        let y = request.half_breadths[i][j].filter(|_| measured(kinds[i][j]))?;
        Some(Point3::new(request.stations[i], y, request.waterlines[j]))
    };
    let columns = request.waterlines.len();
    let rows = (0..request.stations.len())
        .map(|i| (0..columns).map(|j| point(i, j)).collect())
        .collect();
    let o = &request.options;
    let tolerance = o.tolerance.map(|t| {
        if o.cell_tolerances.is_empty() {
            return Tolerance::Same(t);
        }
        let mut each = vec![t; request.stations.len() * columns];
        for (i, j, t) in &o.cell_tolerances {
            each[i * columns + j] = *t;
        }
        Tolerance::Each(each)
    });
    let options = surface::request::Options {
        tolerance,
        locked: o.locked.iter().map(|[i, j]| i * columns + j).collect(),
        freedom: [false, true, false],
        robust: o.robust,
        knuckles: [o.knuckle_stations.clone(), o.knuckle_waterlines.clone()],
        light: o.light,
        ..surface::request::Options::default()
    };
    let points = Points::Grid(rows);
    surface::input::read(&surface::Request { points, options }).map_err(FitError::Invalid)
}

/// Stations and waterlines in the frame of the task.
fn families(request: &Request, task: &Task) -> Result<[Lines; 2], FitError> {
    let steps = surface::grid::mean_steps(task)?;
    let middle = task.frame.middle;
    let unit =
        |x: &[f64], m: f64| -> Vec<f64> { x.iter().map(|x| (x - m) / task.frame.size).collect() };
    let [across, up] = &task.knuckles;
    Ok([
        lines(&unit(&request.stations, middle.x), &steps[0], DEGREE)?.creased(across)?,
        lines(&unit(&request.waterlines, middle.z), &steps[1], DEGREE)?.creased(up)?,
    ])
}

/// The field y(u, v) and the sheet that it makes.
fn field(task: &Task, families: &[Lines; 2], control: &dyn Control) -> Result<Fit, FitError> {
    let Layout::Grid { cell, size } = &task.layout else {
        return Err(FitError::Numerical("no grid".into()));
    };
    let net = Net::new([families[0].knots.clone(), families[1].knots.clone()]);
    let at: Vec<[f64; 2]> = cell
        .iter()
        .map(|[i, j]| [families[0].at[*i], families[1].at[*j]])
        .collect();
    let springs = Springs::<1> {
        at: at.clone(),
        value: task.points.iter().map(|p| [p.y]).collect(),
        weight: task.weight.clone(),
    };
    let best = best(
        task,
        (&net, &springs),
        (order(*size, &task.knuckles), 1.0),
        control,
    )?;
    let [nu, nv] = net.counts();
    let mut points = vec![Vector3::zeros(); nu * nv];
    for i in 0..nu {
        for j in 0..nv {
            let k = net.index(i, j);
            let (x, z) = (families[0].control[i], families[1].control[j]);
            points[k] = Vector3::new(x, best.chosen.control[k][0], z);
        }
    }
    Ok(Fit {
        sheet: Sheet {
            net,
            control: points,
            plane: false,
        },
        at,
        lambda: best.chosen.lambda,
        noise: best.noise,
        weight: best.weight,
        energy: best.energy,
        model: best.model,
        monomials: best.monomials,
    })
}

/// Takes edge zeros as endings where the surface comes to zero by itself;
/// how many it took.
fn endings(
    request: &Request,
    places: &[Vec<Place>],
    (fit, task, families): (&Fit, &Task, &[Lines; 2]),
    kinds: &mut [Vec<CellKind>],
) -> usize {
    let greatest = request
        .half_breadths
        .iter()
        .flatten()
        .flatten()
        .fold(0.0_f64, |m, y| m.max(*y));
    let near = (ENDING_SIGMAS * fit.noise * task.frame.size)
        .max(ENDING_SHARE * greatest)
        .max(request.options.tolerance.unwrap_or(0.0));
    let mut count = 0;
    for (i, row) in places.iter().enumerate() {
        for (j, place) in row.iter().enumerate() {
            if *place == Place::Edge {
                let there = fit.sheet.point([families[0].at[i], families[1].at[j]]);
                let y = task.frame.to_user(&there).y;
                if y.abs() <= near {
                    kinds[i][j] = CellKind::Ending;
                    count += 1;
                }
            }
        }
    }
    count
}

/// Half-breadths end at the centreline: where the surface passes behind it the
/// hull has ended just before, a measured cell keeps zero and a missing one
/// lies outside.
fn keep_outboard(surface: &mut surface::Outcome, kinds: &mut [Vec<CellKind>], at: &[Vec<f64>; 2]) {
    let told = moved(surface);
    for m in surface.moves.iter_mut().filter(|m| m.now.y < 0.0) {
        // The cell was at least 0, so that this is the nearer place.
        m.distance = (m.distance.abs() + m.now.y).max(0.0).copysign(m.distance);
        m.now.y = 0.0;
    }
    let lengths = surface.moves.iter().map(|m| m.distance.abs());
    surface.move_max = lengths.clone().fold(0.0, f64::max);
    let square: f64 = lengths.map(|d| d * d).sum();
    surface.move_rms = (square / surface.moves.len().max(1) as f64).sqrt();
    let now = moved(surface);
    if let Some(verdict) = surface.summary.first_mut() {
        *verdict = verdict.replacen(&told, &now, 1);
    }
    for (row, u) in kinds.iter_mut().zip(&at[0]) {
        for (kind, v) in row.iter_mut().zip(&at[1]) {
            if *kind == CellKind::Filled && surface.surface.point(*u, *v).y < 0.0 {
                *kind = CellKind::Outside;
            }
        }
    }
}

/// The hull in (u, v): measured and filled cells.
fn region(families: &[Lines; 2], kinds: &[Vec<CellKind>]) -> Region {
    let inside = kinds.iter().flatten().map(|k| *k != CellKind::Outside);
    let at = [families[0].at.clone(), families[1].at.clone()];
    Region::of_grid(&at, inside.collect())
}

fn table(
    request: &Request,
    kinds: &[Vec<CellKind>],
    (surface, at): (&surface::Outcome, &[Vec<f64>; 2]),
) -> Vec<Vec<Cell>> {
    let cell = |i: usize, j: usize| {
        let (kind, old) = (kinds[i][j], request.half_breadths[i][j]);
        let place = || surface.surface.point(at[0][i], at[1][j]);
        let new = (kind != CellKind::Outside).then(|| place().y.max(0.0));
        Cell {
            kind,
            old,
            new,
            change: old.zip(new).map(|(old, new)| new - old),
        }
    };
    (0..kinds.len())
        .map(|i| (0..kinds[i].len()).map(|j| cell(i, j)).collect())
        .collect()
}

fn slips(request: &Request, surface: &surface::Outcome) -> Vec<CellSlip> {
    let columns = request.waterlines.len();
    let of = |s: &surface::outcome::Slip| CellSlip {
        station: s.index / columns,
        waterline: s.index % columns,
        given: s.given.y,
        expected: s.expected.y.max(0.0),
        sigmas: s.sigmas,
        confidence: s.confidence,
    };
    surface.slips.iter().map(of).collect()
}

fn notes(places: &[Vec<Place>], endings: usize, surface: &surface::Outcome) -> Vec<String> {
    let count = |p: Place| places.iter().flatten().filter(|q| **q == p).count();
    let mut notes = surface.warnings.clone();
    let edges = count(Place::Edge);
    if edges > 0 {
        notes.push(format!(
            "{edges} zeros lie next to the hull: {endings} are its ending, where the surface comes \
             to the centreline by itself; the other {} lie beyond the ending and were left out.",
            edges - endings
        ));
    }
    let outside = count(Place::Outside);
    if outside > 0 {
        notes.push(format!(
            "{outside} cells beyond the hull's outline have no value."
        ));
    }
    let gaps = count(Place::Gap);
    if gaps > 0 {
        notes.push(format!(
            "{gaps} missing cells inside the hull are filled with the surface's own value."
        ));
    }
    notes
}
