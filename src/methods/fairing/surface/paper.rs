//! The paper's own loop (Jing, Xi & Tang 1998, §2.1), for comparison: bicubic
//! on uniform knots, one stiffness K for all springs (100 times on the border
//! of a grid), raised while the largest distance exceeds the tolerance and
//! lowered while it is far below; feet anew each time. The first shape comes
//! from the border alone, as in STEP1, where the layout has one.

use super::feet::{Effort, Foot, feet};
use super::fit::{Fit, energy, places, springs_to};
use super::net::{Net, Sheet};
use super::request::EnergyWeights;
use super::springs::gather;
use super::stiffness::{Likelihood, fit_with};
use super::task::{Layout, Task};
use super::tolerance::{Bounded, exact_feet};
use crate::geometry::Knots;
use crate::methods::FitError;
use crate::numerics::EnvelopeMatrix;
use crate::solver::Control;

/// Degree of the paper's surfaces.
const DEGREE: usize = 3;
/// Energy where none was asked: bending, the middle of the paper's examples.
const BENDING: EnergyWeights = EnergyWeights {
    alpha11: 0.0,
    alpha22: 0.0,
    beta11: 1.0,
    beta12: 2.0,
    beta22: 1.0,
};
/// Factor by which K is raised or lowered.
const STEP: f64 = 2.0;
/// "Far below the tolerance": below this share of it.
const FAR_BELOW: f64 = 0.8;
/// Most changes of K: sixty octaves span all stiffnesses that numbers have.
const CHANGES: usize = 60;
/// Feet steps a change.
const FEET: Effort = Effort::exact(4);

/// A sheet of the loop.
struct Trial {
    /// Largest distance in tolerances.
    worst: f64,
    /// 1/K.
    lambda: f64,
    sheet: Sheet,
    at: Vec<[f64; 2]>,
}

/// What stays the same in the loop.
struct Springs<'a> {
    task: &'a Task,
    net: Net,
    energy: EnvelopeMatrix,
    model: Likelihood,
    tolerance: Vec<f64>,
}

/// Fits by the paper's loop; parameters start from those of `start`.
///
/// # Errors
/// [`FitError::Stopped`], [`FitError::Numerical`] if no K gives a sheet.
pub(super) fn fit(
    task: &Task,
    start: Fit,
    control: &dyn Control,
) -> Result<(Fit, Option<Bounded>), FitError> {
    let net = net(task, &start)?;
    let term = energy(Some(task.energy.unwrap_or(BENDING)), (2, 1.0), net.domain());
    let springs = Springs {
        task,
        energy: term.matrix(&net),
        model: Likelihood {
            free: term.free_dimension(&net),
            components: 3.0,
        },
        tolerance: task.tolerance.clone().unwrap_or_default(),
        net,
    };
    let first = springs.first_shape(start.lambda);
    let at = match first {
        Some(sheet) => places(&feet(&sheet, (&task.points, &start.at), FEET, control)?),
        None => start.at.clone(),
    };
    let best = springs
        .settle(start.lambda, at, control)?
        .ok_or_else(|| FitError::Numerical("no spring stiffness gives a sheet".into()))?;
    let exact = exact_feet(&best.sheet, &task.points, &best.at, control)?;
    let pull = |f: &Foot| -f.signed() / best.lambda;
    let bounded = Bounded {
        worst: springs.worst(&exact),
        at: places(&exact),
        duals: exact.iter().map(pull).collect(),
        sheet: best.sheet.clone(),
    };
    let fit = Fit {
        sheet: best.sheet,
        at: best.at,
        lambda: best.lambda,
        energy: springs.energy,
        model: springs.model,
        monomials: Vec::new(),
        ..start
    };
    Ok((fit, Some(bounded)))
}

impl Springs<'_> {
    fn worst(&self, feet: &[Foot]) -> f64 {
        let ratios = feet
            .iter()
            .zip(&self.tolerance)
            .map(|(f, e)| f.distance() / e);
        ratios.fold(0.0, f64::max)
    }

    /// STEP2 to STEP4: the softest sheet within the tolerance that the loop
    /// meets, or the nearest to it.
    fn settle(
        &self,
        start: f64,
        mut at: Vec<[f64; 2]>,
        control: &dyn Control,
    ) -> Result<Option<Trial>, FitError> {
        let points = &self.task.points;
        let mut lambda = start;
        let mut best: Option<Trial> = None;
        let mut was_raised = false;
        for _ in 0..CHANGES {
            control.check()?;
            let normal = gather(&self.net, &springs_to(points, &at, &self.task.weight));
            let Some(chosen) = fit_with(&normal, &self.energy, lambda, self.model) else {
                break;
            };
            let sheet = Sheet::of_points(&self.net, &chosen.control);
            let now = feet(&sheet, (points, &at), FEET, control)?;
            let worst = self.worst(&now);
            at = places(&now);
            let better = best.as_ref().is_none_or(|b| {
                if worst <= 1.0 {
                    b.worst > 1.0 || lambda > b.lambda
                } else {
                    worst < b.worst
                }
            });
            if better {
                let at = at.clone();
                best = Some(Trial {
                    worst,
                    lambda,
                    sheet,
                    at,
                });
            }
            let raise = worst > 1.0;
            if !raise && (worst > FAR_BELOW || was_raised) {
                break;
            }
            lambda = if raise { lambda / STEP } else { lambda * STEP };
            was_raised = raise;
        }
        Ok(best)
    }

    /// STEP1: the sheet of the border points alone.
    fn first_shape(&self, lambda: f64) -> Option<Sheet> {
        let Layout::Grid { cell, size } = &self.task.layout else {
            return None;
        };
        let border = |c: &[usize; 2]| (0..2).any(|k| c[k] == 0 || c[k] + 1 == size[k]);
        let start = super::grid::parameters(self.task, DEGREE).ok()?;
        let weight: Vec<f64> = cell
            .iter()
            .zip(&self.task.weight)
            .map(|(c, w)| if border(c) { *w } else { 0.0 })
            .collect();
        let springs = springs_to(&self.task.points, &start.at, &weight);
        let chosen = fit_with(
            &gather(&self.net, &springs),
            &self.energy,
            lambda,
            self.model,
        )?;
        Some(Sheet::of_points(&self.net, &chosen.control))
    }
}

/// Uniform bicubic knots, as many control points as the start has (or as
/// asked).
fn net(task: &Task, start: &Fit) -> Result<Net, FitError> {
    let domain = start.sheet.net.domain();
    let counts = task.control_points.unwrap_or(start.sheet.net.counts());
    let knots = |k: usize| {
        Knots::uniform(DEGREE, domain[k], counts[k].saturating_sub(DEGREE).max(1))
            .map_err(|e| FitError::Numerical(e.to_string()))
    };
    Ok(Net::new([knots(0)?, knots(1)?]))
}
