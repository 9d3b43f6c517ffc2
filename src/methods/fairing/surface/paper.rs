//! The paper's own loop (Jing, Xi & Tang 1998, §2.1), for comparison: bicubic
//! on uniform knots, one stiffness K for all springs (100 times on the border
//! of a grid), raised while the largest distance exceeds the tolerance and
//! lowered while it is far below; feet anew each time. The first shape comes
//! from the border alone, as in STEP1, where the layout has one.

use super::feet::feet;
use super::fit::{Fit, energy, places, springs_to};
use super::net::{Net, Sheet};
use super::request::EnergyWeights;
use super::springs::gather;
use super::stiffness::{Likelihood, fit_with};
use super::task::{Layout, Task};
use super::tolerance::{Bounded, exact_feet};
use crate::geometry::Knots;
use crate::methods::FitError;
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
const FOOT_STEPS: usize = 4;

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
    let matrix = term.matrix(&net);
    let model = Likelihood {
        free: term.free_dimension(DEGREE),
        components: 3.0,
    };
    let tolerance = task.tolerance.clone().unwrap_or_default();
    let mut at = start.at.clone();
    let mut lambda = start.lambda;
    let mut sliding = first_shape(task, &net, (&matrix, model, lambda))
        .map(|sheet| places(&feet(&sheet, &task.points, &at, FOOT_STEPS)));
    let mut best: Option<(f64, f64, Sheet, Vec<[f64; 2]>)> = None;
    let mut last_raised: Option<bool> = None;
    for _ in 0..CHANGES {
        control.check()?;
        if let Some(s) = sliding.take() {
            at = s;
        }
        let normal = gather(&net, &springs_to(&task.points, &at, &task.weight));
        let Some(chosen) = fit_with(&normal, &matrix, lambda, model) else {
            break;
        };
        let sheet = Sheet::of_points(&net, &chosen.control);
        let now = feet(&sheet, &task.points, &at, FOOT_STEPS);
        let worst = now
            .iter()
            .zip(&tolerance)
            .map(|(f, e)| f.distance() / e)
            .fold(0.0, f64::max);
        at = places(&now);
        let better = best.as_ref().is_none_or(|(w, l, ..)| {
            if worst <= 1.0 {
                *w > 1.0 || lambda > *l
            } else {
                worst < *w
            }
        });
        if better {
            best = Some((worst, lambda, sheet, at.clone()));
        }
        let raise = worst > 1.0;
        let settled = !raise && (worst > FAR_BELOW || last_raised == Some(true));
        if settled {
            break;
        }
        lambda = if raise { lambda / STEP } else { lambda * STEP };
        last_raised = Some(raise);
    }
    let (_, lambda, sheet, at) =
        best.ok_or_else(|| FitError::Numerical("no spring stiffness gives a sheet".into()))?;
    let exact = exact_feet(&sheet, &task.points, &at);
    let ratio = exact.iter().zip(&tolerance).map(|(f, e)| f.distance() / e);
    let bounded = Bounded {
        worst: ratio.fold(0.0, f64::max),
        at: places(&exact),
        duals: exact
            .iter()
            .map(|f| f.signed() / lambda)
            .map(|d| -d)
            .collect(),
        sheet: sheet.clone(),
    };
    let fit = Fit {
        sheet,
        at,
        lambda,
        energy: matrix,
        model,
        ..start
    };
    Ok((fit, Some(bounded)))
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

/// The sheet of the border points alone.
fn first_shape(
    task: &Task,
    net: &Net,
    (energy, model, lambda): (&crate::numerics::EnvelopeMatrix, Likelihood, f64),
) -> Option<Sheet> {
    let Layout::Grid { cell, size } = &task.layout else {
        return None;
    };
    let border = |c: &[usize; 2]| (0..2).any(|k| c[k] == 0 || c[k] + 1 == size[k]);
    let start = super::grid::parameters(task, net.degree()).ok()?;
    let weight: Vec<f64> = cell
        .iter()
        .zip(&task.weight)
        .map(|(c, w)| if border(c) { *w } else { 0.0 })
        .collect();
    let normal = gather(net, &springs_to(&task.points, &start.at, &weight));
    let chosen = fit_with(&normal, energy, lambda, model)?;
    Some(Sheet::of_points(net, &chosen.control))
}
