//! Folded sheets: unrolled along their geodesics, then fitted from coarse to
//! fine with feet taken anew at each level.
//!
//! The first map comes from the nodes alone; a coarse sheet through them makes
//! it smooth, and gives every point a foot to start from. At feet only the
//! part of the noise across the sheet is left, one component a point.

use super::super::feet::{Foot, feet};
use super::super::fit::{Fit, energy, median_scale, places, springs_to};
use super::super::input::issue;
use super::super::net::{Net, Sheet};
use super::super::springs::gather;
use super::super::stiffness::{self, Chosen, Likelihood, choose};
use super::super::task::Task;
use super::geodesics::flat_map;
use super::levels::{self, SAMPLE, Step};
use super::voxels::Nodes;
use crate::methods::FitError;
use crate::numerics::EnvelopeMatrix;
use crate::solver::Control;
use nalgebra::Vector3;
use rayon::prelude::*;

/// Rounds of feet and fits: on the nodes, on a level, at the end.
const ROUNDS: [usize; 3] = [3, 1, 1];
/// Gauss–Newton steps a round: the last round's feet are the start.
const FOOT_STEPS: usize = 4;
/// Residuals of so many σ lose their pull in a robust fit.
const CUT: f64 = 6.0;

/// Points with their feet.
struct Cloud {
    points: Vec<Vector3<f64>>,
    at: Vec<[f64; 2]>,
    weight: Vec<f64>,
}

/// A sheet with its stiffness.
struct Level {
    net: Net,
    energy: EnvelopeMatrix,
    model: Likelihood,
    chosen: Chosen<3>,
}

impl Level {
    fn sheet(&self) -> Sheet {
        Sheet::of_points(&self.net, &self.chosen.control)
    }
}

/// Fits a folded sheet.
///
/// # Errors
/// [`FitError::Invalid`] where the sheet cannot be unrolled, else as
/// [`choose`].
pub(in super::super) fn fit(
    task: &Task,
    nodes: &Nodes,
    control: &dyn Control,
) -> Result<Fit, FitError> {
    let map = flat_map(nodes).ok_or_else(|| {
        FitError::Invalid(vec![issue(
            &["input", "points"],
            "not-a-sheet",
            "the points cannot be unrolled into one sheet: they close all round, branch, or have \
             many points off the sheet",
            Some(
                "cut them along a line, for example by leaving out a sector, and give each sheet \
                  by itself",
            ),
        )])
    })?;
    control.check()?;
    let domain = levels::domain(&map).map(|[a, b]| [a - nodes.side(), b + nodes.side()]);
    let mut cloud = Cloud {
        points: nodes.place.clone(),
        at: map.clone(),
        weight: nodes.count.iter().map(|n| *n as f64).collect(),
    };
    let step = levels::first(task.points.len());
    let mut level = on_level(task, (domain, step), &cloud, (None, control))?;
    for _ in 0..ROUNDS[0] {
        refine(task, &mut level, &mut cloud, (false, control))?;
    }
    let stride = task.points.len().div_ceil(SAMPLE).max(1);
    let mut sample = seated(task, nodes, (&level.sheet(), &cloud.at), (stride, control))?;
    refine(task, &mut level, &mut sample, (true, control))?;
    let level = finer(task, (domain, step), (level, &mut sample), control)?;
    finish(task, level, (sample, nodes, &cloud.at), control)
}

/// From a coarse level to one that is fine enough for the sample.
fn finer(
    task: &Task,
    (domain, mut step): ([[f64; 2]; 2], Step),
    (mut level, sample): (Level, &mut Cloud),
    control: &dyn Control,
) -> Result<Level, FitError> {
    let lengths = domain.map(|[a, b]| b - a);
    let density = task.weight.iter().sum::<f64>() / (lengths[0] * lengths[1]);
    let longer = lengths[0].max(lengths[1]);
    loop {
        let fine = levels::next(step, level.chosen.lambda, (density, longer));
        let Some(finer) = (match fine {
            Some(finer) => Some(finer),
            None => {
                let seats = (sample.points.as_slice(), sample.at.as_slice());
                let feet = feet(&level.sheet(), seats, FOOT_STEPS, control)?;
                let residuals: Vec<f64> = feet.iter().map(Foot::signed).collect();
                let rest = levels::leftover((domain, step), &sample.at, &residuals)?;
                levels::beyond(step, rest)
            }
        }) else {
            return Ok(level);
        };
        let net = levels::net(domain, finer, None)?;
        if !levels::affordable(&net, task.points.len()) || task.control_points.is_some() {
            return Ok(level);
        }
        control.progress("fitting", 5.0 + 0.3 * finer.spans as f64);
        let near = (finer.space == step.space).then_some(level.chosen.lambda);
        level = on_level(task, (domain, finer), sample, (near, control))?;
        for _ in 0..ROUNDS[1] {
            refine(task, &mut level, sample, (true, control))?;
        }
        step = finer;
    }
}

/// The last rounds, with all points.
fn finish(
    task: &Task,
    mut level: Level,
    (sample, nodes, map): (Cloud, &Nodes, &[[f64; 2]]),
    control: &dyn Control,
) -> Result<Fit, FitError> {
    let mut all = if sample.points.len() == task.points.len() {
        sample
    } else {
        seated(task, nodes, (&level.sheet(), map), (1, control))?
    };
    for _ in 0..ROUNDS[2] {
        control.check()?;
        refine(task, &mut level, &mut all, (false, control))?;
    }
    Ok(Fit {
        sheet: level.sheet(),
        at: all.at,
        lambda: level.chosen.lambda,
        noise: level.chosen.noise,
        weight: all.weight,
        energy: level.energy,
        model: level.model,
    })
}

/// The fit of one level at given places.
fn on_level(
    task: &Task,
    (domain, step): ([[f64; 2]; 2], Step),
    cloud: &Cloud,
    (near, control): (Option<f64>, &dyn Control),
) -> Result<Level, FitError> {
    let net = levels::net(domain, step, task.control_points)?;
    let term = energy(task.energy, (step.space.order, 1.0), net.domain());
    let model = Likelihood {
        free: term.free_dimension(net.degree()),
        components: 1.0,
    };
    let energy = term.matrix(&net);
    let springs = springs_to(&cloud.points, &cloud.at, &cloud.weight);
    let chosen = choose(&gather(&net, &springs), &energy, model, (near, control))?;
    Ok(Level {
        net,
        energy,
        model,
        chosen,
    })
}

/// New feet, new weights where a robust fit was asked, new sheet; with a new
/// stiffness where `search`.
fn refine(
    task: &Task,
    level: &mut Level,
    cloud: &mut Cloud,
    (search, control): (bool, &dyn Control),
) -> Result<(), FitError> {
    control.check()?;
    let feet = feet(
        &level.sheet(),
        (&cloud.points, &cloud.at),
        FOOT_STEPS,
        control,
    )?;
    cloud.at = places(&feet);
    let mut springs = springs_to(&cloud.points, &cloud.at, &cloud.weight);
    if task.robust {
        let distances: Vec<f64> = feet.iter().map(|f| f.distance()).collect();
        let cut = CUT * median_scale(&distances, 1);
        for (w, d) in springs.weight.iter_mut().zip(&distances) {
            let t = (d / cut.max(f64::MIN_POSITIVE)).min(1.0);
            *w *= (1.0 - t * t).powi(2);
        }
    }
    let normal = gather(&level.net, &springs);
    let near = level.chosen.lambda;
    level.chosen = if search {
        choose(&normal, &level.energy, level.model, (Some(near), control))?
    } else {
        stiffness::last(&normal, (&level.energy, level.model), near, control)?
    };
    Ok(())
}

/// Every `stride`-th point with its foot on a sheet, from its node's place.
fn seated(
    task: &Task,
    nodes: &Nodes,
    (sheet, map): (&Sheet, &[[f64; 2]]),
    (stride, control): (usize, &dyn Control),
) -> Result<Cloud, FitError> {
    let points: Vec<Vector3<f64>> = task.points.iter().step_by(stride).copied().collect();
    let starts: Vec<[f64; 2]> = points
        .par_iter()
        .with_min_len(512)
        .map(|p| map[nodes.at(p).unwrap_or_else(|| nodes.nearest(p))])
        .collect();
    let at = places(&feet(sheet, (&points, &starts), 2 * FOOT_STEPS, control)?);
    Ok(Cloud {
        weight: task.weight.iter().step_by(stride).copied().collect(),
        points,
        at,
    })
}
