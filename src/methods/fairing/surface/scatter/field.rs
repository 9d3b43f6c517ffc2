//! Scattered points of a height field w = h(u, v): one scalar field, from
//! coarse to fine.
//!
//! The noise of a point acts across the sheet; along w it looks larger by
//! 1/cos of the slope. Springs are therefore weighted by cos² of the slope of
//! a coarser fit: the sum of squares is then that of distances.

use super::super::fit::{Fit, energy, evaluate, robust};
use super::super::net::{Net, Sheet};
use super::super::springs::{Springs, gather};
use super::super::stiffness::{self, Chosen, Likelihood, choose};
use super::super::task::Task;
use super::levels::{self, SAMPLE, Step};
use crate::methods::FitError;
use crate::numerics::EnvelopeMatrix;
use crate::solver::Control;
use rayon::prelude::*;

/// What a level found.
struct Level {
    net: Net,
    energy: EnvelopeMatrix,
    model: Likelihood,
    chosen: Chosen<1>,
    /// Weights of a robust fit.
    weight: Option<Vec<f64>>,
}

/// Fits a height field along the third axis of the frame.
///
/// # Errors
/// As [`choose`].
pub(in super::super) fn fit(task: &Task, control: &dyn Control) -> Result<Fit, FitError> {
    let mut all = Springs::<1> {
        at: task.points.iter().map(|p| [p.x, p.y]).collect(),
        value: task.points.iter().map(|p| [p.z]).collect(),
        weight: task.weight.clone(),
    };
    let domain = levels::domain(&all.at);
    let lengths = domain.map(|[a, b]| b - a);
    let density = all.weight.iter().sum::<f64>() / (lengths[0] * lengths[1]);
    let longer = lengths[0].max(lengths[1]);
    let mut sample = thinned(&all, SAMPLE);
    let mut step = levels::first(all.at.len());
    let mut best = level(task, (domain, step), (&sample, None), control)?;
    if task.slides() {
        let sheet = Sheet::of_heights(&best.net, &best.chosen.control);
        level_out(&sheet, &mut all);
        level_out(&sheet, &mut sample);
    }
    loop {
        let fine = levels::next(step, best.chosen.lambda, (density, longer));
        let Some(finer) = (match fine {
            Some(finer) => Some(finer),
            None => levels::beyond(step, leftover(&best, (domain, step), &sample)?),
        }) else {
            break;
        };
        let net = levels::net(domain, finer, None)?;
        if !levels::affordable(&net, all.at.len()) || task.control_points.is_some() {
            break;
        }
        control.progress("fitting", 5.0 + 0.3 * finer.spans as f64);
        let near = (finer.space == step.space).then_some(best.chosen.lambda);
        best = level(task, (domain, finer), (&sample, near), control)?;
        step = finer;
    }
    finish(task, best, (all, &sample), control)
}

/// Correlation of what the level leaves of its sample.
fn leftover(
    level: &Level,
    place: ([[f64; 2]; 2], Step),
    sample: &Springs<1>,
) -> Result<f64, FitError> {
    let residuals: Vec<f64> = sample
        .at
        .par_iter()
        .zip(&sample.value)
        .with_min_len(512)
        .map(|(at, value)| value[0] - evaluate(&level.net, &level.chosen.control, *at)[0])
        .collect();
    levels::leftover(place, &sample.at, &residuals)
}

/// The fit of one level to the sample.
fn level(
    task: &Task,
    (domain, step): ([[f64; 2]; 2], Step),
    (sample, near): (&Springs<1>, Option<f64>),
    control: &dyn Control,
) -> Result<Level, FitError> {
    let net = levels::net(domain, step, task.control_points)?;
    let term = energy(task.energy, (step.space.order, 1.0), net.domain());
    let model = Likelihood {
        free: term.free_dimension(net.degree()),
        components: 1.0,
    };
    let energy = term.matrix(&net);
    let (chosen, weight) = if task.robust {
        let r = robust(&net, sample, (&energy, model), (near, control))?;
        (r.chosen, Some(r.weight))
    } else {
        let normal = gather(&net, sample);
        (choose(&normal, &energy, model, (near, control))?, None)
    };
    Ok(Level {
        net,
        energy,
        model,
        chosen,
        weight,
    })
}

/// The last fit, with all points.
fn finish(
    task: &Task,
    level: Level,
    (all, sample): (Springs<1>, &Springs<1>),
    control: &dyn Control,
) -> Result<Fit, FitError> {
    let Level {
        net,
        energy,
        model,
        chosen,
        weight,
    } = level;
    let (chosen, weight) = if sample.at.len() == all.at.len() && task.robust {
        (chosen, weight.unwrap_or(all.weight))
    } else if task.robust {
        let r = robust(&net, &all, (&energy, model), (Some(chosen.lambda), control))?;
        (r.chosen, r.weight)
    } else {
        control.check()?;
        let normal = gather(&net, &all);
        let last = stiffness::last(&normal, (&energy, model), chosen.lambda, control)?;
        (last, all.weight)
    };
    Ok(Fit {
        sheet: Sheet::of_heights(&net, &chosen.control),
        at: all.at,
        lambda: chosen.lambda,
        noise: chosen.noise,
        weight,
        energy,
        model,
    })
}

/// Weights by cos² of the slope.
fn level_out(sheet: &Sheet, springs: &mut Springs<1>) {
    let at = &springs.at;
    springs
        .weight
        .par_iter_mut()
        .zip(at)
        .with_min_len(512)
        .for_each(|(w, at)| {
            let t = sheet.tangents(*at);
            *w /= 1.0 + t.du.z * t.du.z + t.dv.z * t.dv.z;
        });
}

/// At most `most` springs, evenly spaced in the given order.
fn thinned(springs: &Springs<1>, most: usize) -> Springs<1> {
    let stride = springs.at.len().div_ceil(most).max(1);
    Springs {
        at: springs.at.iter().step_by(stride).copied().collect(),
        value: springs.value.iter().step_by(stride).copied().collect(),
        weight: springs.weight.iter().step_by(stride).copied().collect(),
    }
}
