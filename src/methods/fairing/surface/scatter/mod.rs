//! Scattered points: parameters without the user's help, then fits from
//! coarse to fine.

pub(super) mod field;
mod geodesics;
pub(super) mod heading;
pub(super) mod levels;
pub(super) mod unroll;
pub(super) mod voxels;

use super::fit::Fit;
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
    match heading::heading(task, &nodes) {
        Some(up) => {
            turn(task, &up);
            let up = task.frame.axes.column(2).into_owned();
            Ok((field::fit(task, control)?, Parametrisation::HeightField(up)))
        }
        None => Ok((
            unroll::fit(task, &nodes, control)?,
            Parametrisation::Unrolled,
        )),
    }
}

/// Turns frame and points: third axis `up` (user's axes).
fn turn(task: &mut Task, up: &nalgebra::Vector3<f64>) {
    let along = heading::longest_across(&task.points, up);
    let turned = task.frame.turned(up, &along);
    let change = turned.axes.tr_mul(&task.frame.axes);
    for p in &mut task.points {
        *p = change * *p;
    }
    task.frame = turned;
}
