//! The fairest sheet within a hard tolerance of every point.
//!
//! At fixed feet the problem is a convex quadratic programme between strips
//! ([`super::programme`]); control points move along the sheet's normals
//! or along the free axis. Feet and normals are then taken anew and the
//! programme is solved again from there, a few times: each sheet stays within
//! the strips, so that the energy settles. Where a strip was too wide, because
//! the sheet between foot and point is curved, it is narrowed by what it was
//! exceeded.

use super::feet::{Effort, Foot, feet};
use super::net::Sheet;
use super::programme::Programme;
use crate::methods::FitError;
use crate::numerics::EnvelopeMatrix;
use crate::solver::{Control, Stop};
use nalgebra::Vector3;

/// The points to be met.
#[derive(Debug, Clone, Copy)]
pub(in super::super) struct Bounds<'a> {
    pub(in super::super) points: &'a [Vector3<f64>],
    pub(in super::super) tolerance: &'a [f64],
    /// The only axis along which points move and distances count; `None`:
    /// points slide and distances are to the sheet.
    pub(in super::super) axes: Option<[bool; 3]>,
}

impl Bounds<'_> {
    pub(super) fn freedom(&self) -> [bool; 3] {
        self.axes.unwrap_or([true; 3])
    }
}

/// A sheet that was fitted within bounds.
#[derive(Debug, Clone)]
pub(in super::super) struct Bounded {
    pub(in super::super) sheet: Sheet,
    pub(in super::super) at: Vec<[f64; 2]>,
    /// Signed pull of each point, 0 where it has room.
    pub(in super::super) duals: Vec<f64>,
    /// Largest distance in tolerances.
    pub(in super::super) worst: f64,
}

/// Rounds of new feet.
const ROUNDS: usize = 8;
/// The energy has settled when a round changes it by less.
const SETTLED: f64 = 1e-3;
/// Strips are a little narrower than the tolerance, for the rounding of
/// whoever checks.
const ROOM: f64 = 1e-6;
/// Distances up to so many tolerances are mended by narrower strips; beyond,
/// the step is halved, and at most so often.
const MILD: f64 = 2.0;
/// See [`MILD`].
const MOST_HALVINGS: usize = 8;
/// Gauss–Newton steps for feet: they must be the true ones here.
const FEET: Effort = Effort::exact(12);

/// The fairest sheet within bounds, from a sheet nearby. When the bounds
/// cannot all be met with this net the result says by how much (`worst`
/// above 1).
///
/// # Errors
/// [`FitError::Stopped`].
pub(in super::super) fn within(
    start: (&Sheet, &[[f64; 2]]),
    bounds: Bounds,
    energy: &EnvelopeMatrix,
    control: &dyn Control,
) -> Result<Bounded, FitError> {
    let mut sheet = start.0.clone();
    let mut at = start.1.to_vec();
    let mut members = Vec::new();
    let mut narrow = vec![1.0 - ROOM; at.len()];
    let ratio = ratios(&sheet, &mut at, bounds, control)?;
    let mut worst = ratio.iter().copied().fold(0.0, f64::max);
    let first = Bounded {
        sheet: sheet.clone(),
        at: at.clone(),
        duals: vec![0.0; at.len()],
        worst,
    };
    let mut before = energy_of(&sheet, energy, bounds.freedom());
    let mut best = (before, first);
    for round in 0..ROUNDS {
        control.progress(
            "within tolerance",
            40.0 + 45.0 * round as f64 / ROUNDS as f64,
        );
        let programme = Programme {
            bounds,
            narrow: &narrow,
            energy,
        };
        let solved = programme.solve((&sheet, &at), &mut members, control)?;
        let Some((moved, duals)) = solved else {
            break;
        };
        let (next, ratio) = towards((&sheet, &mut at), moved, (bounds, worst), control)?;
        sheet = next;
        worst = ratio.iter().copied().fold(0.0, f64::max);
        for (n, r) in narrow.iter_mut().zip(&ratio) {
            *n *= (1.0 / r).min(1.0);
        }
        let value = energy_of(&sheet, energy, bounds.freedom());
        let trial = Bounded {
            sheet: sheet.clone(),
            at: at.clone(),
            duals,
            worst,
        };
        if is_better((value, worst), &best) {
            best = (value, trial);
        }
        if worst <= 1.0 && (before - value).abs() <= SETTLED * value {
            break;
        }
        before = value;
    }
    Ok(best.1)
}

/// A step to the programme's sheet, as far as its strips speak for it: they are
/// those of the feet and normals of the sheet before, and a sheet that moves
/// far turns away from them.
fn towards(
    (sheet, at): (&Sheet, &mut [[f64; 2]]),
    goal: Sheet,
    (bounds, before): (Bounds, f64),
    control: &dyn Control,
) -> Result<(Sheet, Vec<f64>), FitError> {
    let mut next = goal;
    let mut halved = 0;
    loop {
        let mut places = at.to_vec();
        let ratio = ratios(&next, &mut places, bounds, control)?;
        let worst = ratio.iter().copied().fold(0.0, f64::max);
        if worst <= MILD.max(before) || halved == MOST_HALVINGS {
            at.copy_from_slice(&places);
            return Ok((next, ratio));
        }
        for (c, from) in next.control.iter_mut().zip(&sheet.control) {
            *c = 0.5 * (*c + from);
        }
        halved += 1;
    }
}

/// Distances in tolerances, at new feet where points slide.
fn ratios(
    sheet: &Sheet,
    at: &mut [[f64; 2]],
    bounds: Bounds,
    control: &dyn Control,
) -> Result<Vec<f64>, FitError> {
    if bounds.axes.is_some() {
        let one = |i: usize| (bounds.points[i] - sheet.point(at[i])).norm() / bounds.tolerance[i];
        return Ok((0..at.len()).map(one).collect());
    }
    let feet = feet(sheet, (bounds.points, at), FEET, control)?;
    for (place, foot) in at.iter_mut().zip(&feet) {
        *place = foot.at;
    }
    let distances = feet.iter().map(Foot::distance);
    Ok(distances
        .zip(bounds.tolerance)
        .map(|(d, e)| d / e)
        .collect())
}

/// Whether a sheet (energy, worst distance in tolerances) beats another: by
/// its energy where both keep the bounds, else by how nearly it does.
fn is_better((value, worst): (f64, f64), (energy, other): &(f64, Bounded)) -> bool {
    if worst <= 1.0 && other.worst <= 1.0 {
        value < *energy
    } else {
        worst < other.worst
    }
}

/// `Σ cᵀPc` over the coordinates that are free.
pub(in super::super) fn energy_of(
    sheet: &Sheet,
    energy: &EnvelopeMatrix,
    freedom: [bool; 3],
) -> f64 {
    (0..3)
        .filter(|d| freedom[*d])
        .map(|d| {
            let c: Vec<f64> = sheet.control.iter().map(|p| p[d]).collect();
            let image = energy.multiply(&c);
            image.iter().zip(&c).map(|(a, b)| a * b).sum::<f64>()
        })
        .sum()
}

/// Feet of all points, as exact as tolerances need.
///
/// # Errors
/// [`Stop`] when the control says so.
pub(in super::super) fn exact_feet(
    sheet: &Sheet,
    points: &[Vector3<f64>],
    at: &[[f64; 2]],
    control: &dyn Control,
) -> Result<Vec<Foot>, Stop> {
    feet(sheet, (points, at), FEET, control)
}
