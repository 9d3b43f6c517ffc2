//! The fairest surface within a tolerance of a grid or a cloud of points.
//!
//! A tensor-product B-spline whose energy (change of curvature by default,
//! the paper's five terms on demand; [`request::EnergyWeights`]) is least for
//! given springs to the points, or within a hard tolerance of every point.
//!
//! 1. Parameters: a grid has its own; scattered points are a height field or
//!    are unrolled (module `scatter`).
//! 2. The stiffness of the springs comes from the points themselves by
//!    restricted likelihood (module `stiffness`), and with it their noise.
//! 3. With a tolerance, the fairest sheet between all strips is found by an
//!    interior-point method, feet and normals taken anew (module
//!    `tolerance`).
//! 4. Slips, moves, figures (modules `slips`, `report`, `diagnose`).
//!
//! Source: Jing, Xi & Tang 1998 for the model; the modules name theirs.

mod diagnose;
pub(super) mod energy;
pub(super) mod feet;
pub(super) mod fit;
pub(super) mod grid;
pub(super) mod grid_fit;
pub(super) mod input;
mod interior_point;
mod moments;
pub(super) mod net;
pub mod outcome;
mod paper;
mod programme;
pub(super) mod region;
pub(super) mod report;
pub mod request;
mod scatter;
mod slips;
mod spans;
pub(super) mod springs;
pub(super) mod stiffness;
mod strips;
pub(super) mod task;
#[cfg(test)]
pub(super) mod tests;
pub(super) mod tolerance;
mod trend;

pub use outcome::Outcome;
pub use request::Request;

use super::super::{Control, FitError, Issue};
use fit::Fit;
use outcome::Parametrisation;
use region::Region;
use request::Solver;
use task::{Layout, Task};
use tolerance::{Bounded, Bounds};

/// Fits.
///
/// # Errors
/// [`FitError::Invalid`] for unusable input, [`FitError::Stopped`] when the
/// control says so.
pub fn fit(request: &Request, control: &dyn Control) -> Result<Outcome, FitError> {
    control.progress("reading", 0.0);
    let mut task = input::read(request).map_err(FitError::Invalid)?;
    let (fit, parametrisation) = match &task.layout {
        Layout::Grid { .. } => (grid_fit::fit(&task, control)?, Parametrisation::Grid),
        Layout::Scattered => scatter::fit(&mut task, control)?,
    };
    let region = region(&task, &fit);
    let (fit, bounded) = match request.options.solver {
        Solver::Paper => paper::fit(&task, fit, control)?,
        Solver::Own => {
            let bounded = bounded(&task, &fit, control)?;
            (fit, bounded)
        }
    };
    conclude(&task, (&fit, bounded), (parametrisation, &region), control)
}

/// Slips, figures, outcome.
///
/// # Errors
/// [`FitError::Stopped`]; [`FitError::Numerical`] if the surface is not
/// finite.
pub(super) fn conclude(
    task: &Task,
    (fit, bounded): (&Fit, Option<Bounded>),
    (parametrisation, region): (Parametrisation, &Region),
    control: &dyn Control,
) -> Result<Outcome, FitError> {
    control.progress("slips", 82.0);
    let feet = report::feet_of(task, (&fit.sheet, &fit.at), control)?;
    let slips = slips::slips(task, (fit, &feet), control)?;
    let feet = match &bounded {
        Some(b) => report::feet_of(task, (&b.sheet, &b.at), control)?,
        None => feet,
    };
    let found = report::Found {
        task,
        fit,
        bounded: bounded.as_ref(),
        feet,
        parametrisation,
        region,
        slips,
    };
    report::outcome(found, control)
}

/// Every issue of a request; none: it can be fitted.
#[must_use]
pub fn validate(request: &Request) -> Vec<Issue> {
    input::issues(request)
}

/// Where the data are.
fn region(task: &Task, fit: &Fit) -> Region {
    if let Layout::Grid { cell, size } = &task.layout
        && let Ok(grid) = grid::parameters(task, fit.sheet.net.degree())
    {
        let mut present = vec![false; size[0] * size[1]];
        for [r, c] in cell {
            present[r * size[1] + c] = true;
        }
        return Region::of_grid(&grid.lines, present);
    }
    Region::of_points(&fit.at, fit.sheet.net.domain())
}

/// The sheet within the tolerance, where there is one.
pub(super) fn bounded(
    task: &Task,
    fit: &Fit,
    control: &dyn Control,
) -> Result<Option<Bounded>, FitError> {
    let Some(tolerance) = &task.tolerance else {
        return Ok(None);
    };
    let excused = excused(task, fit, tolerance);
    let bounds = Bounds {
        points: &task.points,
        tolerance: &excused,
        axes: (!task.slides()).then_some(task.freedom),
    };
    let at = if task.slides() {
        let feet = tolerance::exact_feet(&fit.sheet, &task.points, &fit.at, control)?;
        fit::places(&feet)
    } else {
        fit.at.clone()
    };
    tolerance::within((&fit.sheet, &at), bounds, &fit.energy, control).map(Some)
}

/// Weight below which a robust fit has given a point up.
const GIVEN_UP: f64 = 0.05;
/// Half width of the strip of such a point: the whole model.
const ANYWHERE: f64 = 10.0;

/// Tolerances, without those of points that a robust fit has given up.
fn excused(task: &Task, fit: &Fit, tolerance: &[f64]) -> Vec<f64> {
    let one = |i: usize| {
        let given_up = task.robust && !task.locked[i] && fit.weight[i] < GIVEN_UP * task.weight[i];
        if given_up {
            ANYWHERE
        } else {
            tolerance[i].min(ANYWHERE)
        }
    };
    (0..tolerance.len()).map(one).collect()
}
