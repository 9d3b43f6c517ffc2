//! Folded sheets: unrolled along their geodesics, a coarse sheet through the
//! map, and the points as heights across it (module `base`).
//!
//! The first map comes from the nodes alone. A few rounds of feet on a sheet
//! that is stiffer than they ask for take the map's own waves out of it; a
//! still stiffer one becomes the base.

use super::super::energy::Energy;
use super::super::feet::{Effort, Foot, feet};
use super::super::fit::{Fit, places, springs_to};
use super::super::input::issue;
use super::super::net::{Net, Sheet};
use super::super::springs::gather;
use super::super::stiffness::{Chosen, Likelihood, choose, fit_with};
use super::super::task::Task;
use super::base;
use super::field::{self, Heights};
use super::geodesics::flat_map;
use super::levels::{self, Step};
use super::seam::{SHARED, Seam};
use super::voxels::Nodes;
use crate::methods::{FitError, Issue};
use crate::numerics::EnvelopeMatrix;
use crate::solver::Control;
use nalgebra::Vector3;

/// Rounds of feet on the nodes.
const ROUNDS: usize = 4;
/// Gauss–Newton steps a round: the last round's feet are the start.
const FEET: Effort = Effort::exact(4);
/// How much stiffer than the likeliest sheet the one is on which feet are
/// taken. With order 4 it passes waves that are 10^(3/8) = 2.4 times as long.
const RELAXING: f64 = 1e3;
/// The same for the base, stiffest first: its own noise cannot be undone by a
/// field as stiff as itself, so that it should have none. The last is the
/// likeliest sheet itself.
const BASES: [f64; 4] = [1e4, 1e3, 1e2, 1e1];
/// Least cosine between the normals of base and node, ...
const FACING: f64 = 0.8;
/// ... and the share of nodes that keep it; the rest are edges and outliers.
const SHARE: f64 = 0.97;

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

    /// The sheet through a cloud with its stiffness raised by a factor.
    fn stiffer(&self, cloud: &Cloud, factor: f64) -> Result<Sheet, FitError> {
        let springs = springs_to(&cloud.points, &cloud.at, &cloud.weight);
        let lambda = factor * self.chosen.lambda;
        let normal = gather(&self.net, &springs);
        let fit = fit_with(&normal, &self.energy, lambda, self.model);
        let fit = fit.ok_or_else(|| FitError::Numerical("the base has no fit".into()))?;
        Ok(Sheet::of_points(&self.net, &fit.control))
    }
}

/// Fits a folded sheet.
///
/// # Errors
/// [`FitError::Invalid`] where the sheet cannot be unrolled, else as
/// [`choose`].
pub(in super::super) fn fit(
    task: &mut Task,
    nodes: &Nodes,
    control: &dyn Control,
) -> Result<Fit, FitError> {
    let (map, seam) = opened(task, nodes)?;
    control.check()?;
    let margin = nodes.side() * if seam.is_some() { SHARED } else { 1.0 };
    let domain = levels::domain(&map).map(|[a, b]| [a - margin, b + margin]);
    let step = levels::first(task.points.len());
    let mut cloud = Cloud {
        points: nodes.place.clone(),
        at: map,
        weight: nodes.count.iter().map(|n| *n as f64).collect(),
    };
    let mut level = on_level(task, (domain, step), &cloud, control)?;
    for _ in 0..ROUNDS {
        control.check()?;
        settle(&mut level, &mut cloud, (RELAXING, control))?;
    }
    let base = base_sheet(&level, (nodes, &cloud), control)?;
    control.check()?;
    let places = (nodes, cloud.at.as_slice(), seam.as_ref());
    let springs = base::heights(&base, task, places, control)?;
    let heights = Heights {
        springs,
        base: Some(&base),
    };
    field::fit(task, heights, control)
}

/// The flat map; of a tube after it was cut where the user says.
fn opened(task: &mut Task, nodes: &Nodes) -> Result<(Vec<[f64; 2]>, Option<Seam>), FitError> {
    if let Some(map) = flat_map(nodes) {
        if task.cut.is_some() {
            let told = "the sheet lies flat without a cut: \"cut\" was not needed";
            task.warnings.push(told.into());
        }
        return Ok((map, None));
    }
    let cut = task.cut.and_then(|place| Seam::cut(nodes, &place));
    let opened = cut.and_then(|(seam, cut)| Some((flat_map(&cut)?, seam)));
    let Some((map, seam)) = opened else {
        return Err(FitError::Invalid(vec![not_a_sheet(task.cut.is_some())]));
    };
    task.warnings.push(
        "the sheet closes all round: it was cut along its axis at the place given; points beside \
         the cut count on both sides, so that the two borders agree"
            .into(),
    );
    Ok((map, Some(seam)))
}

fn not_a_sheet(was_cut: bool) -> Issue {
    let message = if was_cut {
        "the points cannot be unrolled into one sheet, not even cut at the place given: they \
         branch, close at an end, or have many points off the sheet"
    } else {
        "the points cannot be unrolled into one sheet: they close all round, branch, or have many \
         points off the sheet"
    };
    let hint = "give \"cut\", a place near which a tube may be cut along its axis, or cut the \
                points yourself, for example by leaving out a sector; leave out points off the \
                sheet";
    issue(&["input", "points"], "not-a-sheet", message, Some(hint))
}

/// One round of feet on a sheet that is stiffer by a factor, and the sheet
/// through them: what the map has of waves along the sheet is ironed out.
fn settle(
    level: &mut Level,
    cloud: &mut Cloud,
    (factor, control): (f64, &dyn Control),
) -> Result<(), FitError> {
    let stiff = level.stiffer(cloud, factor)?;
    let seats = (cloud.points.as_slice(), cloud.at.as_slice());
    cloud.at = places(&feet(&stiff, seats, FEET, control)?);
    let springs = springs_to(&cloud.points, &cloud.at, &cloud.weight);
    let near = (Some(level.chosen.lambda), control);
    level.chosen = choose(
        &gather(&level.net, &springs),
        &level.energy,
        level.model,
        near,
    )?;
    Ok(())
}

/// The stiffest sheet that still faces the way the nodes do.
fn base_sheet(
    level: &Level,
    (nodes, cloud): (&Nodes, &Cloud),
    control: &dyn Control,
) -> Result<Sheet, FitError> {
    let mut sheet = level.sheet();
    for factor in BASES {
        let stiff = level.stiffer(cloud, factor)?;
        let feet = feet(&stiff, (&cloud.points, &cloud.at), FEET, control)?;
        let faces = |(foot, normal): (&Foot, &Vector3<f64>)| {
            let own = foot.sheet.normal();
            own.is_some_and(|n| n.dot(normal).abs() >= FACING)
        };
        let agree = feet.iter().zip(&nodes.normal).filter(|p| faces(*p)).count();
        if agree as f64 >= SHARE * feet.len() as f64 {
            sheet = stiff;
            break;
        }
    }
    Ok(sheet)
}

/// The fit of one level at given places.
fn on_level(
    task: &Task,
    (domain, step): ([[f64; 2]; 2], Step),
    cloud: &Cloud,
    control: &dyn Control,
) -> Result<Level, FitError> {
    let net = levels::net(domain, step, task.control_points)?;
    let term = Energy::isotropic(step.space.order, 1.0);
    let model = Likelihood {
        free: term.free_dimension(&net),
        components: 1.0,
    };
    let energy = term.matrix(&net);
    let springs = springs_to(&cloud.points, &cloud.at, &cloud.weight);
    let chosen = choose(&gather(&net, &springs), &energy, model, (None, control))?;
    Ok(Level {
        net,
        energy,
        model,
        chosen,
    })
}
