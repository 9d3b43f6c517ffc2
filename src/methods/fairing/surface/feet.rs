//! Feet: the nearest place on a sheet to a point, from a start nearby (the
//! sliding springs of the paper, §2.3, eq. 11).
//!
//! Gauss–Newton on (u, v), held in the domain: a parameter at its bound that
//! wants to go further stays, and the other is moved alone. The step is the
//! exact one on a plane and errs by κ·d on a curved sheet (κ curvature, d
//! distance), so that two or three steps do where points are near.

use super::net::{Sheet, Tangents};
use crate::solver::{Control, Stop};
use nalgebra::Vector3;
use rayon::prelude::*;

/// A foot.
#[derive(Debug, Clone, Copy)]
pub(in super::super) struct Foot {
    /// Its parameters.
    pub(in super::super) at: [f64; 2],
    /// The sheet there.
    pub(in super::super) sheet: Tangents,
    /// From foot to point.
    pub(in super::super) offset: Vector3<f64>,
}

impl Foot {
    /// Distance of the point from its foot.
    pub(in super::super) fn distance(&self) -> f64 {
        self.offset.norm()
    }

    /// Distance with the sign of the side of the normal on which the point is.
    pub(in super::super) fn signed(&self) -> f64 {
        let along = self.sheet.normal().map_or(1.0, |n| n.dot(&self.offset));
        self.distance().copysign(along)
    }
}

/// How far a foot is followed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in super::super) struct Effort {
    /// Most steps.
    steps: usize,
    /// A step that promises to lower the squared distance by less than this
    /// share of it is not made.
    settled: f64,
    /// The axis along which foot and point must agree.
    held: Option<usize>,
}

impl Effort {
    /// As far as numbers can tell, in at most so many steps.
    pub(in super::super) const fn exact(steps: usize) -> Self {
        Effort {
            steps,
            settled: 1e-10,
            held: None,
        }
    }

    /// Distances to a millionth of themselves: for lists and statistics. One
    /// step from a place nearby is enough for most points.
    pub(in super::super) const fn listed(steps: usize) -> Self {
        Effort {
            steps,
            settled: 1e-6,
            held: None,
        }
    }

    /// The same in the plane of each point across an axis.
    pub(in super::super) const fn holding(self, held: Option<usize>) -> Self {
        Effort { held, ..self }
    }

    /// A vector as this search measures it.
    fn measured(&self, mut v: Vector3<f64>) -> Vector3<f64> {
        if let Some(k) = self.held {
            v[k] *= HELD;
        }
        v
    }
}

/// How much more a held axis counts: feet then keep to it to a ten thousandth
/// of what is settled of the distance.
const HELD: f64 = 1e4;

/// Halvings of a step that leads away from the point.
const HALVINGS: usize = 4;

/// The foot of `point` near `start`; never farther from the point than the
/// start was.
pub(in super::super) fn foot(
    sheet: &Sheet,
    point: &Vector3<f64>,
    start: [f64; 2],
    effort: Effort,
) -> Foot {
    let look = |at: [f64; 2]| {
        let tangents = sheet.tangents(at);
        Foot {
            at,
            sheet: tangents,
            offset: point - tangents.point,
        }
    };
    let domain = sheet.net.domain();
    let mut best = look(sheet.net.clamp(start));
    for _ in 0..effort.steps {
        let (mut step, promise) = free_step(&best, domain, effort);
        let before = effort.measured(best.offset).norm_squared();
        if promise <= effort.settled * before {
            break;
        }
        let mut moved = false;
        for _ in 0..HALVINGS {
            let next = [best.at[0] + step[0], best.at[1] + step[1]];
            let trial = look(sheet.net.clamp(next));
            if effort.measured(trial.offset).norm_squared() < before {
                best = trial;
                moved = true;
                break;
            }
            step = step.map(|s| 0.5 * s);
        }
        if !moved {
            break;
        }
    }
    best
}

/// The Gauss–Newton step that leaves bounds alone which it would cross, and by
/// how much it would lower the squared distance from a plane.
fn free_step(foot: &Foot, domain: [[f64; 2]; 2], effort: Effort) -> ([f64; 2], f64) {
    let [du, dv, offset] = [foot.sheet.du, foot.sheet.dv, foot.offset].map(|v| effort.measured(v));
    let (e, f, g) = (du.dot(&du), du.dot(&dv), dv.dot(&dv));
    let slope = [du.dot(&offset), dv.dot(&offset)];
    let held = [0, 1].map(|k| {
        (foot.at[k] <= domain[k][0] && slope[k] < 0.0)
            || (foot.at[k] >= domain[k][1] && slope[k] > 0.0)
    });
    let alone = |s: f64, square: f64| if square > 0.0 { s / square } else { 0.0 };
    let area = e * g - f * f;
    let step = match held {
        [true, true] => [0.0, 0.0],
        [true, false] => [0.0, alone(slope[1], g)],
        [false, true] => [alone(slope[0], e), 0.0],
        [false, false] if area > 1e-12 * e * g => [
            (g * slope[0] - f * slope[1]) / area,
            (e * slope[1] - f * slope[0]) / area,
        ],
        [false, false] => [0.5 * alone(slope[0], e), 0.5 * alone(slope[1], g)],
    };
    (step, step[0] * slope[0] + step[1] * slope[1])
}

/// The foot of a point on the tangent plane of a sheet at a place.
pub(in super::super) fn on_plane(
    tangents: &Tangents,
    at: [f64; 2],
    point: &Vector3<f64>,
) -> [f64; 2] {
    let foot = Foot {
        at,
        sheet: *tangents,
        offset: point - tangents.point,
    };
    let everywhere = [[f64::NEG_INFINITY, f64::INFINITY]; 2];
    let (step, _) = free_step(&foot, everywhere, Effort::exact(1));
    [at[0] + step[0], at[1] + step[1]]
}

/// Points between two looks at the control: well below a tenth of a second.
const BLOCK: usize = 65_536;

/// Feet of all points, in parallel.
///
/// # Errors
/// [`Stop`] when the control says so.
pub(in super::super) fn feet(
    sheet: &Sheet,
    (points, starts): (&[Vector3<f64>], &[[f64; 2]]),
    effort: Effort,
    control: &dyn Control,
) -> Result<Vec<Foot>, Stop> {
    let mut all = Vec::with_capacity(points.len());
    for (points, starts) in points.chunks(BLOCK).zip(starts.chunks(BLOCK)) {
        control.check()?;
        all.par_extend(
            points
                .par_iter()
                .zip(starts)
                .with_min_len(512)
                .map(|(p, at)| foot(sheet, p, *at, effort)),
        );
    }
    Ok(all)
}
