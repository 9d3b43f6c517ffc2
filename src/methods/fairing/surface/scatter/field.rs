//! Scattered points of a height field w = h(u, v): one scalar field, from
//! coarse to fine.
//!
//! The noise of a point acts across the sheet; along w it looks larger by
//! 1/cos of the slope. Springs are therefore weighted by cos² of the slope of
//! a coarser fit: the sum of squares is then that of distances.

use super::super::fit::{Fit, energy, robust};
use super::super::net::{Net, Sheet};
use super::super::springs::{Springs, gather};
use super::super::stiffness::{Chosen, Likelihood, choose, fit_with};
use super::super::task::Task;
use super::levels::{self, LEVELS, SAMPLE};
use crate::methods::FitError;
use crate::solver::Control;
use rayon::prelude::*;

/// Order × half bandwidth² up to which the stiffness is searched again with
/// all the points.
const CHEAP: f64 = 2e7;

/// A level's best.
struct Level {
    net: Net,
    chosen: Chosen<1>,
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
    let mut sample = thinned(&all, SAMPLE);
    let order = levels::order(all.at.len());
    let term = |net: &Net| {
        let energy = energy(task.energy, (order, 1.0), net.domain());
        let model = Likelihood {
            free: energy.free_dimension(levels::DEGREE),
            components: 1.0,
        };
        (energy.matrix(net), model)
    };
    let least = levels::least_gain(all.at.len());
    let mut best: Option<Level> = None;
    for spans in LEVELS {
        let net = levels::net(domain, spans, task.control_points)?;
        if best.is_some() && !levels::affordable(&net, all.at.len()) {
            break;
        }
        control.progress("fitting", 5.0 + 0.2 * spans as f64);
        let (matrix, model) = term(&net);
        let chosen = if task.robust {
            let r = robust(&net, &sample, (&matrix, model), control)?;
            sample.weight = r.weight;
            r.chosen
        } else {
            let near = best.as_ref().map(|b| b.chosen.lambda);
            choose(&gather(&net, &sample), &matrix, model, (near, control))?
        };
        let gain = best
            .as_ref()
            .map_or(1.0, |b| 1.0 - (chosen.noise / b.chosen.noise).powi(2));
        let first = best.is_none();
        if gain >= least {
            best = Some(Level { net, chosen });
        }
        if first && task.slides() {
            let sheet = best.as_ref().map(sheet_of);
            if let Some(sheet) = sheet {
                level_out(&sheet, &mut all);
                level_out(&sheet, &mut sample);
            }
        }
        if gain < least || task.control_points.is_some() {
            break;
        }
    }
    let level = best.ok_or_else(|| FitError::Numerical("no level fits".into()))?;
    finish(
        task,
        (level, all, sample),
        term(&domain_net(domain, task)?).1,
        control,
    )
}

fn domain_net(domain: [[f64; 2]; 2], task: &Task) -> Result<Net, FitError> {
    levels::net(domain, LEVELS[0], task.control_points)
}

fn sheet_of(level: &Level) -> Sheet {
    Sheet::of_heights(&level.net, &level.chosen.control)
}

/// The last fit, with all points.
fn finish(
    task: &Task,
    (level, all, sample): (Level, Springs<1>, Springs<1>),
    model: Likelihood,
    control: &dyn Control,
) -> Result<Fit, FitError> {
    let net = level.net;
    let order = levels::order(all.at.len());
    let matrix = energy(task.energy, (order, 1.0), net.domain()).matrix(&net);
    let mut weight = all.weight.clone();
    let chosen = if sample.at.len() == all.at.len() {
        weight = sample.weight;
        level.chosen
    } else if task.robust {
        let r = robust(&net, &all, (&matrix, model), control)?;
        weight = r.weight;
        r.chosen
    } else {
        let normal = gather(&net, &all);
        control.check()?;
        let cost = net.len() as f64 * (net.half_bandwidth() as f64).powi(2);
        let near = level.chosen.lambda;
        if cost <= CHEAP {
            choose(&normal, &matrix, model, (Some(near), control))?
        } else {
            fit_with(&normal, &matrix, near, model)
                .ok_or_else(|| FitError::Numerical("the last level has no fit".into()))?
        }
    };
    Ok(Fit {
        sheet: Sheet::of_heights(&net, &chosen.control),
        at: all.at,
        lambda: chosen.lambda,
        noise: chosen.noise,
        weight,
        energy: matrix,
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
