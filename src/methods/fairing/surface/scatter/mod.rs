//! Scattered points: parameters without the user's help, then fits from
//! coarse to fine.

mod base;
pub(super) mod field;
mod geodesics;
pub(super) mod heading;
pub(super) mod levels;
mod rigid;
mod seam;
mod stretch;
pub(super) mod unroll;
pub(super) mod voxels;

use super::feet::{Effort, feet};
use super::fit::{Fit, places};
use super::outcome::Parametrisation;
use super::task::Task;
use crate::methods::FitError;
use crate::solver::Control;

/// Fits scattered points. The task's frame is turned so that its third axis
/// is the direction of a height field, where the sheet is one.
///
/// # Errors
/// [`FitError::Invalid`] for a sheet that cannot be unrolled,
/// [`FitError::Stopped`].
pub(super) fn fit(
    task: &mut Task,
    control: &dyn Control,
) -> Result<(Fit, Parametrisation), FitError> {
    control.progress("parameters", 2.0);
    let nodes = voxels::nodes(&task.points);
    let (mut fit, parametrisation) = match heading::heading(task, &nodes) {
        Some(up) => {
            turn(task, &up);
            let up = task.frame.axes.column(2).into_owned();
            let fit = field::of_plane(task, control)?;
            (fit, Parametrisation::HeightField(up))
        }
        None => {
            let fit = unroll::fit(task, &nodes, control)?;
            (fit, Parametrisation::Unrolled)
        }
    };
    if task.held().is_some() {
        let effort = Effort::exact(FOOT_STEPS).holding(task.held());
        let seats = (task.points.as_slice(), fit.at.as_slice());
        fit.at = places(&feet(&fit.sheet, seats, effort, control)?);
    }
    Ok((fit, parametrisation))
}

/// Steps to the foot in a point's own plane from its place in the net.
const FOOT_STEPS: usize = 12;

/// Turns frame and points: third axis `up` (user's axes).
fn turn(task: &mut Task, up: &nalgebra::Vector3<f64>) {
    let along = heading::longest_across(&task.points, up);
    let turned = task.frame.turned(up, &along);
    let change = turned.axes.tr_mul(&task.frame.axes);
    for p in &mut task.points {
        *p = change * *p;
    }
    task.frame = turned;
    if task.freedom != [true; 3] {
        // Turned by right angles only: `heading` keeps to the axes then.
        task.freedom = [0, 1, 2].map(|k| task.freedom[turned.axes.column(k).iamax()]);
    }
    task.cut = task.cut.map(|p| change * p);
}
