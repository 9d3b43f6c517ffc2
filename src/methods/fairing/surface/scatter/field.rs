//! One scalar field over a plane (a height field) or across a coarse base
//! sheet (a folded one, module `base`), from coarse to fine.
//!
//! The noise of a point acts across the sheet; along the field it looks larger
//! by 1/cos of the slope. Springs are therefore weighted by cos² of the slope
//! of a coarser fit: the sum of squares is then that of distances. Across a
//! base the slopes are small.

use super::super::fit::{Fit, energy, evaluate, robust};
use super::super::net::{Net, Sheet};
use super::super::springs::{Normal, Springs, gather};
use super::super::stiffness::{self, Chosen, Likelihood, choose};
use super::super::task::Task;
use super::base;
use super::levels::{self, SAMPLE, Step};
use super::stretch::better;
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
    /// What the sample says on this net.
    normal: Normal<1>,
    /// Weights of a robust fit.
    weight: Option<Vec<f64>>,
}

/// Values to be fitted and the base over which they are heights: `None` for
/// the plane of the first two axes.
pub(super) struct Heights<'a> {
    pub(super) springs: Springs<1>,
    pub(super) base: Option<&'a Sheet>,
}

impl Heights<'_> {
    fn sheet(&self, net: &Net, heights: &[[f64; 1]]) -> Result<Sheet, FitError> {
        match self.base {
            None => Ok(Sheet::of_heights(net, heights)),
            Some(base) => base::raised(base, net, heights),
        }
    }

    fn domain(&self) -> [[f64; 2]; 2] {
        match self.base {
            None => levels::domain(&self.springs.at),
            Some(base) => base.net.domain(),
        }
    }

    fn least(&self) -> [usize; 2] {
        match self.base {
            None => levels::first(0).least,
            Some(base) => [0, 1].map(|k| base.net.spans[k].len()),
        }
    }
}

/// Fits a height field along the third axis of the frame.
///
/// # Errors
/// As [`choose`].
pub(super) fn of_plane(task: &Task, control: &dyn Control) -> Result<Fit, FitError> {
    let springs = Springs::<1> {
        at: task.points.iter().map(|p| [p.x, p.y]).collect(),
        value: task.points.iter().map(|p| [p.z]).collect(),
        weight: task.weight.clone(),
    };
    let heights = Heights {
        springs,
        base: None,
    };
    fit(task, heights, control)
}

/// Fits heights. The springs may be more than the points of the task: those
/// beyond are shadows of points (module `base`).
///
/// # Errors
/// As [`choose`].
pub(super) fn fit(task: &Task, mut all: Heights, control: &dyn Control) -> Result<Fit, FitError> {
    let domain = all.domain();
    let lengths = domain.map(|[a, b]| b - a);
    let density = all.springs.weight.iter().sum::<f64>() / (lengths[0] * lengths[1]);
    let mut sample = thinned(&all.springs, SAMPLE);
    let mut step = Step {
        least: all.least(),
        ..levels::first(task.points.len())
    };
    let mut best = level(task, (domain, step), (&sample, None), control)?;
    if (task.slides() || task.held().is_some()) && all.base.is_none() {
        let sheet = all.sheet(&best.net, &best.chosen.control)?;
        level_out(&sheet, &mut all.springs);
        level_out(&sheet, &mut sample);
    }
    loop {
        let (turned, lambda) = better(
            task,
            (&best.net, step),
            (&best.normal, &best.chosen),
            control,
        )?;
        let fine = levels::next(turned, lambda, (density, lengths));
        let finer = match fine {
            Some(finer) => Some(finer),
            None => levels::beyond(turned, leftover(&best, (domain, step), &sample)?),
        };
        let affordable = |finer: &Step| -> Result<bool, FitError> {
            let net = levels::net(domain, *finer, None)?;
            Ok(levels::affordable(&net, task.points.len()) && task.control_points.is_none())
        };
        let finer = match finer {
            Some(f) if affordable(&f)? => Some(f),
            _ => None,
        };
        let now = finer.unwrap_or(turned);
        if now != step {
            control.progress("fitting", 5.0 + 0.3 * now.spans as f64);
            let near = (now.space == step.space).then_some(lambda);
            best = level(task, (domain, now), (&sample, near), control)?;
            step = now;
        }
        if finer.is_none() {
            break;
        }
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
    let term = energy(task.energy, (step.space.order, step.stretch), net.domain());
    let model = Likelihood {
        free: term.free_dimension(&net),
        components: 1.0,
    };
    let energy = term.matrix(&net);
    let (chosen, normal, weight) = if task.robust {
        let r = robust(&net, sample, (&energy, model), (near, control))?;
        let mut trusted = sample.clone();
        trusted.weight.clone_from(&r.weight);
        (r.chosen, gather(&net, &trusted), Some(r.weight))
    } else {
        let normal = gather(&net, sample);
        let chosen = choose(&normal, &energy, model, (near, control))?;
        (chosen, normal, None)
    };
    Ok(Level {
        normal,
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
    (all, sample): (Heights, &Springs<1>),
    control: &dyn Control,
) -> Result<Fit, FitError> {
    let Level {
        net,
        energy,
        model,
        chosen,
        weight,
        ..
    } = level;
    let springs = &all.springs;
    let (chosen, weight) = if sample.at.len() == springs.at.len() && task.robust {
        (chosen, weight.unwrap_or_else(|| springs.weight.clone()))
    } else if task.robust {
        let near = (Some(chosen.lambda), control);
        let r = robust(&net, springs, (&energy, model), near)?;
        (r.chosen, r.weight)
    } else {
        control.check()?;
        let normal = gather(&net, springs);
        let last = stiffness::last(&normal, (&energy, model), chosen.lambda, control)?;
        (last, springs.weight.clone())
    };
    let points = task.points.len();
    Ok(Fit {
        sheet: all.sheet(&net, &chosen.control)?,
        at: springs.at[..points].to_vec(),
        lambda: chosen.lambda,
        noise: chosen.noise,
        weight: weight[..points].to_vec(),
        energy,
        model,
        monomials: Vec::new(),
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
