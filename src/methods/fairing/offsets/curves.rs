//! Stations, waterlines and buttocks of the faired surface.

use super::fair::Faired;
use super::outcome::{Buttock, CellKind};
use super::request::Request;
use crate::geometry::{
    Axis, BSplineCurve, BSplineSurface, Parametrization, SplineError, interpolate,
};
use crate::methods::FitError;
use nalgebra::Point3;

/// Bisections of a place: beyond rounding.
const BISECTIONS: usize = 60;
/// A piece shorter than this share of its line is a touch.
const SHORTEST: f64 = 1e-6;
/// Samples between two stations of a buttock.
const BETWEEN: usize = 4;
/// Samples between two waterlines when a buttock is looked for.
const DOWN: usize = 8;
/// Degree of a buttock.
const DEGREE: usize = 3;
/// Shares of the greatest half-breadth where no buttocks are asked for.
const SHARES: [f64; 3] = [0.25, 0.5, 0.75];

fn numerical(e: SplineError) -> FitError {
    FitError::Numerical(e.to_string())
}

/// Stations and waterlines.
///
/// # Errors
/// [`FitError::Numerical`] where a curve cannot be cut.
pub(super) fn families(faired: &Faired) -> Result<[Vec<Vec<BSplineCurve>>; 2], FitError> {
    let [stations, waterlines] = [faired.at[0].len(), faired.at[1].len()];
    let on = |i: usize, j: usize| faired.kinds[i][j] != CellKind::Outside;
    let of_stations = (0..stations)
        .map(|i| cut(faired, Axis::V, i, &|j| on(i, j)))
        .collect::<Result<_, _>>()?;
    let of_waterlines = (0..waterlines)
        .map(|j| cut(faired, Axis::U, j, &|i| on(i, j)))
        .collect::<Result<_, _>>()?;
    Ok([of_stations, of_waterlines])
}

/// The curve along one direction on line `k` of the other, from the first to
/// the last cell on the hull, or to the centreline where that comes before
/// the next cell; in pieces where it passes behind the centreline between.
fn cut(
    faired: &Faired,
    along: Axis,
    k: usize,
    on: &dyn Fn(usize) -> bool,
) -> Result<Vec<BSplineCurve>, FitError> {
    let surface = &faired.surface.surface;
    let lines = &faired.at[along.index()];
    let across = faired.at[1 - along.index()][k];
    let cells: Vec<usize> = (0..lines.len()).filter(|i| on(*i)).collect();
    let (Some(first), Some(last)) = (cells.first(), cells.last()) else {
        return Ok(Vec::new());
    };
    let [low, high] = surface.domain(along);
    let y = |t: f64| place(surface, along, t, across).y;
    let before = if *first > 0 { lines[first - 1] } else { low };
    let after = lines.get(last + 1).copied().unwrap_or(high);
    let from = centreline(&y, lines[*first], before);
    let to = centreline(&y, lines[*last], after);
    let curve = surface.iso_curve(along, across).map_err(numerical)?;
    visible(&y, [from, to], DOWN * (last - first + 1))
        .into_iter()
        .map(|[a, b]| curve.restricted(a, b).map_err(numerical))
        .collect()
}

/// The parts of a range where y is above the centreline (touching it counts).
fn visible(y: &dyn Fn(f64) -> f64, [from, to]: [f64; 2], samples: usize) -> Vec<[f64; 2]> {
    let above = |t: f64| y(t) > 0.0;
    let at = |k: usize| from + (to - from) * k as f64 / samples as f64;
    let mut parts = Vec::new();
    let mut start = from;
    for k in 0..samples {
        // The ends lie on the centreline itself.
        let (a, b) = (k == 0 || above(at(k)), k + 1 == samples || above(at(k + 1)));
        if a && !b {
            parts.push([start, bisect(&above, at(k), at(k + 1))]);
        } else if !a && b {
            start = bisect(&above, at(k + 1), at(k));
        }
        if k + 1 == samples {
            parts.push([start, to]);
        }
    }
    let shortest = SHORTEST * (to - from);
    parts.retain(|[a, b]| b - a > shortest && above(0.5 * (a + b)));
    parts
}

fn place(surface: &BSplineSurface, along: Axis, t: f64, across: f64) -> Point3<f64> {
    match along {
        Axis::U => surface.point(t, across),
        Axis::V => surface.point(across, t),
    }
}

/// The place between `inside` and `beyond` where y comes to zero; `inside`
/// itself where it does not.
fn centreline(y: &dyn Fn(f64) -> f64, inside: f64, beyond: f64) -> f64 {
    if !(y(inside) > 0.0 && y(beyond) <= 0.0) {
        return inside;
    }
    bisect(&|t| y(t) > 0.0, inside, beyond)
}

/// The border between where `keeps` holds (`a`) and where not (`b`).
fn bisect(keeps: &dyn Fn(f64) -> bool, a: f64, b: f64) -> f64 {
    let (mut a, mut b) = (a, b);
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (a + b);
        if keeps(middle) {
            a = middle;
        } else {
            b = middle;
        }
    }
    a
}

/// The buttocks asked for.
///
/// # Errors
/// [`FitError::Numerical`] where a curve cannot be made.
pub(super) fn buttocks(request: &Request, faired: &Faired) -> Result<Vec<Buttock>, FitError> {
    let greatest = faired
        .table
        .iter()
        .flatten()
        .filter_map(|c| c.new)
        .fold(0.0_f64, f64::max);
    let wanted: Vec<f64> = if request.options.buttocks.is_empty() {
        SHARES.iter().map(|s| s * greatest).collect()
    } else {
        request.options.buttocks.clone()
    };
    wanted
        .into_iter()
        .map(|y| {
            Ok(Buttock {
                y,
                curves: pieces(faired, y)?,
            })
        })
        .collect()
}

/// The pieces of y = const: the lowest place where the hull grows wider than
/// that, station by station and between.
fn pieces(faired: &Faired, y: f64) -> Result<Vec<BSplineCurve>, FitError> {
    let stations = &faired.at[0];
    let mut runs: Vec<Vec<Point3<f64>>> = vec![Vec::new()];
    for i in 0..(stations.len() - 1) * BETWEEN + 1 {
        let (k, part) = (i / BETWEEN, i % BETWEEN);
        let next = (k + 1).min(stations.len() - 1);
        let u = stations[k] + (stations[next] - stations[k]) * part as f64 / BETWEEN as f64;
        // Between stations, where either is on the hull.
        let on = |j: usize| {
            faired.kinds[k][j] != CellKind::Outside
                || (part > 0 && faired.kinds[next][j] != CellKind::Outside)
        };
        let found = widening(faired, (u, y), &on);
        match (found, runs.last_mut()) {
            (Some(p), Some(run)) => run.push(p),
            (None, Some(run)) if !run.is_empty() => runs.push(Vec::new()),
            _ => {}
        }
    }
    runs.iter()
        .filter(|run| run.len() > DEGREE)
        .map(|run| interpolate(run, DEGREE, Parametrization::ChordLength).map_err(numerical))
        .collect()
}

/// The lowest place at parameter u where the half-breadth passes y.
fn widening(
    faired: &Faired,
    (u, y): (f64, f64),
    on: &dyn Fn(usize) -> bool,
) -> Option<Point3<f64>> {
    let surface = &faired.surface.surface;
    let lines = &faired.at[1];
    let wide = |v: f64| surface.point(u, v).y >= y;
    for j in 0..lines.len() - 1 {
        // The hull may end between two waterlines.
        if !(on(j) || on(j + 1)) {
            continue;
        }
        let step = (lines[j + 1] - lines[j]) / DOWN as f64;
        for d in 0..DOWN {
            let (a, b) = (lines[j] + d as f64 * step, lines[j] + (d + 1) as f64 * step);
            if !wide(a) && wide(b) {
                let v = bisect(&|v| wide(v), b, a);
                return Some(surface.point(u, v));
            }
        }
    }
    None
}
