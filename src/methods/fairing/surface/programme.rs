//! The convex programme of a hard tolerance at fixed feet: what each point
//! sees of the sheet, along which direction each control point moves, and the
//! few points that decide.

use super::interior_point::{self, Objective};
use super::net::{Net, Sheet};
use super::springs::Cells;
use super::strips::Strips;
use super::tolerance::{Bounds, energy_of};
use crate::methods::FitError;
use crate::numerics::EnvelopeMatrix;
use crate::solver::Control;
use nalgebra::Vector3;
use rayon::prelude::*;

/// Where a point looks for the sheet, and what is left across that.
struct Look {
    at: [f64; 2],
    direction: Vector3<f64>,
    along: f64,
    across: f64,
}

fn looks(sheet: &Sheet, at: &[[f64; 2]], bounds: Bounds) -> Vec<Look> {
    let one = |(p, at): (&Vector3<f64>, &[f64; 2])| {
        let tangents = sheet.tangents(*at);
        let offset = p - tangents.point;
        let direction = direction(tangents.normal(), bounds.axes);
        let along = direction.dot(&offset);
        Look {
            at: *at,
            direction,
            along,
            across: (offset.norm_squared() - along * along).max(0.0).sqrt(),
        }
    };
    let points = bounds.points.par_iter().zip(at).with_min_len(512);
    points.map(one).collect()
}

/// The normal, or its part along the free axes.
fn direction(normal: Option<Vector3<f64>>, axes: Option<[bool; 3]>) -> Vector3<f64> {
    let normal = normal.unwrap_or_else(Vector3::z);
    let Some(free) = axes else {
        return normal;
    };
    let keep = Vector3::from_fn(|k, _| if free[k] { normal[k] } else { 0.0 });
    let axis = Vector3::from_fn(|k, _| if free[k] { 1.0 } else { 0.0 });
    if free.iter().filter(|f| **f).count() == 1 {
        return axis;
    }
    keep.try_normalize(1e-6).unwrap_or_else(|| axis.normalize())
}

/// The programme at fixed feet: points, strips, energy.
pub(super) struct Programme<'a> {
    pub(super) bounds: Bounds<'a>,
    /// Share of each strip that is used.
    pub(super) narrow: &'a [f64],
    pub(super) energy: &'a EnvelopeMatrix,
}

/// Up to so many points all are in the programme from the start.
const FEW: usize = 3000;
/// Rounds of points that join; each takes in all that were overrun.
const JOININGS: usize = 20;
/// Most that join in a round, worst first.
const MOST_JOINING: usize = 3000;

impl Programme<'_> {
    /// Solves it from a sheet and its feet: the moved sheet and the pull of
    /// each point; `None` where the strips cannot all be met.
    ///
    /// Of many points few hold the sheet. So the programme begins with those
    /// that stick out furthest in each cell, to either side; the points whose
    /// strips its solution overruns join, until there are none. `members`
    /// keeps them for the next time.
    ///
    /// # Errors
    /// [`FitError::Stopped`].
    pub(super) fn solve(
        &self,
        (sheet, at): (&Sheet, &[[f64; 2]]),
        members: &mut Vec<bool>,
        control: &dyn Control,
    ) -> Result<Option<(Sheet, Vec<f64>)>, FitError> {
        let directions = control_directions(sheet, self.bounds.axes);
        let looks = looks(sheet, at, self.bounds);
        let reach = self.reach(&looks);
        let all: Vec<usize> = (0..at.len()).collect();
        let whole = strips((&sheet.net, &directions), &looks, (&reach, &all));
        if members.is_empty() {
            *members = first_members(&whole);
        }
        let objective = objective(sheet, &directions, (self.energy, self.bounds.freedom()));
        for _ in 0..JOININGS {
            let chosen: Vec<usize> = (0..at.len()).filter(|i| members[*i]).collect();
            let some = strips((&sheet.net, &directions), &looks, (&reach, &chosen));
            let optimum = interior_point::minimise(&objective, &some, control)?;
            if !optimum.met {
                return Ok(None);
            }
            if join(&whole, &optimum.moves, members) == 0 {
                let mut duals = vec![0.0; at.len()];
                for (i, z) in chosen.iter().zip(&optimum.duals) {
                    duals[*i] = z / reach[*i];
                }
                return Ok(Some((moved(sheet, &directions, &optimum.moves), duals)));
            }
        }
        Ok(None)
    }

    /// Half widths of the strips.
    fn reach(&self, looks: &[Look]) -> Vec<f64> {
        let one = |(l, (e, n)): (&Look, (&f64, &f64))| {
            // What lies across cannot be changed; some room is left always.
            let room = (e * n).powi(2) - l.across * l.across;
            room.max((LEAST_ROOM * e).powi(2)).sqrt()
        };
        let bounds = self.bounds.tolerance.iter().zip(self.narrow);
        looks.iter().zip(bounds).map(one).collect()
    }
}

/// Least half width of a strip, in tolerances.
const LEAST_ROOM: f64 = 1e-2;

/// Strips of the chosen points.
fn strips<'a>(
    (net, directions): (&'a Net, &'a [Vector3<f64>]),
    looks: &[Look],
    (reach, chosen): (&[f64], &[usize]),
) -> Strips<'a> {
    let at: Vec<[f64; 2]> = chosen.iter().map(|i| looks[*i].at).collect();
    Strips {
        net,
        directions,
        cells: Cells::new(net, &at),
        at,
        looks: chosen
            .iter()
            .map(|i| looks[*i].direction / reach[*i])
            .collect(),
        offset: chosen.iter().map(|i| looks[*i].along / reach[*i]).collect(),
    }
}

/// The points that stick out furthest, to either side, in each cell.
fn first_members(whole: &Strips) -> Vec<bool> {
    let n = whole.at.len();
    if n <= FEW {
        return vec![true; n];
    }
    let mut members = vec![false; n];
    let extremes: Vec<[u32; 2]> = whole
        .cells
        .chunks()
        .map(|points| {
            let mut extremes = [points[0]; 2];
            for i in points {
                let offset = |i: u32| whole.offset[i as usize];
                if offset(*i) < offset(extremes[0]) {
                    extremes[0] = *i;
                }
                if offset(*i) > offset(extremes[1]) {
                    extremes[1] = *i;
                }
            }
            extremes
        })
        .collect();
    for i in extremes.as_flattened() {
        members[*i as usize] = true;
    }
    members
}

/// Takes in the points whose strips are overrun; how many.
fn join(whole: &Strips, moves: &[f64], members: &mut [bool]) -> usize {
    let place = whole.apply(moves);
    let overrun = |i: usize| (place[i] - whole.offset[i]).abs();
    let mut joining: Vec<usize> = (0..members.len())
        .filter(|i| !members[*i] && overrun(*i) > 1.0)
        .collect();
    joining.sort_by(|a, b| overrun(*b).total_cmp(&overrun(*a)));
    joining.truncate(MOST_JOINING);
    for i in &joining {
        members[*i] = true;
    }
    joining.len()
}

/// The sheet after the moves of its control points.
fn moved(sheet: &Sheet, directions: &[Vector3<f64>], moves: &[f64]) -> Sheet {
    let mut moved = sheet.clone();
    moved.plane = false;
    for (p, (n, c)) in moved.control.iter_mut().zip(directions.iter().zip(moves)) {
        *p += n * *c;
    }
    moved
}

/// The direction of each control point: that of the sheet beneath it.
fn control_directions(sheet: &Sheet, axes: Option<[bool; 3]>) -> Vec<Vector3<f64>> {
    let [nu, nv] = sheet.net.counts();
    let mut directions = vec![Vector3::zeros(); nu * nv];
    for i in 0..nu {
        for j in 0..nv {
            let at = [
                sheet.net.knots[0].greville(i),
                sheet.net.knots[1].greville(j),
            ];
            directions[sheet.net.index(i, j)] = direction(sheet.tangents(at).normal(), axes);
        }
    }
    directions
}

/// The energy as a function of the moves, scaled so that the present energy
/// is 1.
fn objective(
    sheet: &Sheet,
    directions: &[Vector3<f64>],
    (energy, freedom): (&EnvelopeMatrix, [bool; 3]),
) -> Objective {
    let diagonal = energy.diagonal().fold(0.0, f64::max);
    let scale = 1.0 / energy_of(sheet, energy, freedom).max(1e-16 * diagonal + f64::MIN_POSITIVE);
    let mut hessian = energy.clone();
    hessian.scale_entries(|i, j, v| v * scale * directions[i].dot(&directions[j]));
    let mut gradient = vec![0.0; directions.len()];
    for d in (0..3).filter(|d| freedom[*d]) {
        let c: Vec<f64> = sheet.control.iter().map(|p| p[d]).collect();
        for ((g, p), n) in gradient.iter_mut().zip(energy.multiply(&c)).zip(directions) {
            *g += scale * p * n[d];
        }
    }
    Objective { hessian, gradient }
}
