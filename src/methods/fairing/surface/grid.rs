//! Parameters and net of a grid of points.
//!
//! Rows and columns get the mean of the distances between neighbours, so that
//! the noise of single points hardly shows in the parameters; where these
//! means are all alike within a factor of 1.5 the parameters are uniform, as
//! in the paper, and have no noise at all. The net goes a quarter of a step
//! past the outermost points: points measured beyond the edge have a foot.

use super::net::Net;
use super::task::{Layout, Task};
use crate::geometry::Knots;
use crate::methods::FitError;
use nalgebra::Vector3;

/// Steps between rows that differ by less than this factor are made equal.
const UNIFORM: f64 = 1.5;
/// How far the net goes past the outermost points, in steps.
const PAST: f64 = 0.25;
/// Most spans in one direction: beyond, knots are thinned.
const MOST_SPANS: usize = 96;
/// A step shorter than this share of the mean one counts as this.
const SHORTEST_STEP: f64 = 1e-2;

/// A grid's parameters.
#[derive(Debug, Clone)]
pub(in super::super) struct GridParameters {
    pub(in super::super) net: Net,
    /// Parameter of each row, of each column.
    pub(in super::super) lines: [Vec<f64>; 2],
    /// (u, v) of each present point.
    pub(in super::super) at: Vec<[f64; 2]>,
}

/// Parameters of a grid task; `u` runs over rows.
///
/// # Errors
/// [`FitError::Numerical`] if the task is no grid or has no extent.
pub(in super::super) fn parameters(task: &Task, degree: usize) -> Result<GridParameters, FitError> {
    let Layout::Grid { cell, .. } = &task.layout else {
        return Err(FitError::Numerical("no grid".into()));
    };
    let lines = mean_steps(task)?.map(|s| cumulative(&s));
    let wanted = task.control_points;
    let knots = |k: usize| {
        line_knots(&lines[k], degree, (wanted.map(|w| w[k]), &task.knuckles[k]))
            .map_err(|e| FitError::Numerical(e.to_string()))
    };
    let net = Net::new([knots(0)?, knots(1)?]);
    let at = cell
        .iter()
        .map(|[r, c]| [lines[0][*r], lines[1][*c]])
        .collect();
    Ok(GridParameters { net, lines, at })
}

/// Steps between neighbouring rows, and between neighbouring columns: mean
/// distances, made equal where they hardly differ.
///
/// # Errors
/// [`FitError::Numerical`] if the task is no grid.
pub(in super::super) fn mean_steps(task: &Task) -> Result<[Vec<f64>; 2], FitError> {
    let Layout::Grid { cell, size } = &task.layout else {
        return Err(FitError::Numerical("no grid".into()));
    };
    let mut table: Vec<Option<Vector3<f64>>> = vec![None; size[0] * size[1]];
    for (p, [r, c]) in task.points.iter().zip(cell) {
        table[r * size[1] + c] = Some(*p);
    }
    let along_rows = steps(size[0], size[1], |r, c| table[r * size[1] + c]);
    let along_columns = steps(size[1], size[0], |c, r| table[r * size[1] + c]);
    Ok([along_rows, along_columns].map(evened))
}

/// Mean distance from line i to line i + 1 over all crosswise pairs.
fn steps(
    lines: usize,
    across: usize,
    at: impl Fn(usize, usize) -> Option<Vector3<f64>>,
) -> Vec<f64> {
    let mean = |i: usize| {
        let lengths: Vec<f64> = (0..across)
            .filter_map(|c| Some((at(i + 1, c)? - at(i, c)?).norm()))
            .collect();
        (!lengths.is_empty()).then(|| lengths.iter().sum::<f64>() / lengths.len() as f64)
    };
    let means: Vec<Option<f64>> = (0..lines - 1).map(mean).collect();
    let known: Vec<f64> = means.iter().flatten().copied().collect();
    let typical = if known.is_empty() {
        1.0
    } else {
        known.iter().sum::<f64>() / known.len() as f64
    };
    means
        .into_iter()
        .map(|m| m.unwrap_or(typical).max(SHORTEST_STEP * typical))
        .collect()
}

/// The steps themselves, or equal ones where they hardly differ.
fn evened(steps: Vec<f64>) -> Vec<f64> {
    let low = steps.iter().copied().fold(f64::INFINITY, f64::min);
    let high = steps.iter().copied().fold(0.0, f64::max);
    if high <= UNIFORM * low {
        let mean = steps.iter().sum::<f64>() / steps.len() as f64;
        return vec![mean; steps.len()];
    }
    steps
}

fn cumulative(steps: &[f64]) -> Vec<f64> {
    let mut sum = 0.0;
    let mut all = vec![0.0];
    for s in steps {
        sum += s;
        all.push(sum);
    }
    all
}

/// Knots at the inner lines (thinned beyond [`MOST_SPANS`]) on the domain
/// with its margins, or `count − degree` equal spans; at knuckles as many as
/// leave the sheet only its continuity.
fn line_knots(
    lines: &[f64],
    degree: usize,
    (count, knuckles): (Option<usize>, &[usize]),
) -> Result<Knots, crate::geometry::SplineError> {
    let last = lines.len() - 1;
    let domain = [
        lines[0] - PAST * (lines[1] - lines[0]),
        lines[last] + PAST * (lines[last] - lines[last - 1]),
    ];
    let mut inner: Vec<f64> = match count {
        Some(count) => {
            let knots = Knots::uniform(degree, domain, count.saturating_sub(degree).max(1))?;
            let breaks = knots.breakpoints();
            breaks[1..breaks.len() - 1].to_vec()
        }
        None => thinned(lines, last.min(MOST_SPANS)),
    };
    for k in knuckles {
        let step = (lines[k + 1] - lines[*k]).min(lines[*k] - lines[k - 1]);
        inner.retain(|u| (u - lines[*k]).abs() > NEAR_KNUCKLE * step);
        inner.extend(std::iter::repeat_n(lines[*k], degree));
    }
    inner.sort_by(f64::total_cmp);
    Knots::clamped(degree, domain, &inner)
}

/// A knot nearer to a knuckle than this share of a step would only make a
/// sliver of a span.
const NEAR_KNUCKLE: f64 = 0.5;

/// Inner knots of so many spans, at the lines where there is one a line.
fn thinned(lines: &[f64], spans: usize) -> Vec<f64> {
    let last = lines.len() - 1;
    let knot = |k: usize| {
        let place = k as f64 * last as f64 / spans as f64;
        let (i, t) = (place.floor() as usize, place.fract());
        lines[i] + t * (lines[(i + 1).min(last)] - lines[i])
    };
    (1..spans).map(knot).collect()
}
