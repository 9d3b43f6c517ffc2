//! The fit of a grid without a tolerance: parameters stay, all coordinates
//! are fitted at once, order of the energy and stiffness from the data.

use super::energy::Energy;
use super::fit::{Fit, energy, free_only, robust, springs_to};
use super::grid::parameters;
use super::net::{Net, Sheet};
use super::springs::{Normal, Springs, gather};
use super::stiffness::{Chosen, Likelihood, choose, fit_with, log_pseudo_determinant};
use super::task::{Layout, Task};
use crate::methods::FitError;
use crate::numerics::EnvelopeMatrix;
use crate::solver::Control;

/// Degree of a grid's net: C⁴, so that no knot shows in isophotes or in the
/// variation of curvature.
pub(in super::super) const DEGREE: usize = 5;
/// Rows and columns that the orders 4 and 3 of the energy need: twice what
/// determines the polynomials that they leave free.
const ROWS_OF_ORDER: [(usize, usize); 2] = [(8, 4), (5, 3)];
/// Weight of the energy where a coordinate must not change, against the
/// balance of traces.
const INTERPOLATION: f64 = 1e-9;

/// Order of the isotropic energy for a table of this size; between knuckles
/// there must be as many lines as the order, to determine what it leaves free.
pub(in super::super) fn order(size: [usize; 2], knuckles: &[Vec<usize>; 2]) -> usize {
    let shorter = size[0].min(size[1]);
    let order = ROWS_OF_ORDER
        .iter()
        .find(|(rows, _)| shorter >= *rows)
        .map_or(2, |(_, order)| *order);
    let fewest = |k: usize| {
        let ends = [&[0][..], &knuckles[k], &[size[k].saturating_sub(1)]].concat();
        let runs = ends.windows(2).map(|w| w[1] - w[0] + 1);
        runs.min().unwrap_or(order)
    };
    order.min(fewest(0)).min(fewest(1)).max(2)
}

/// Fits a grid.
///
/// # Errors
/// As [`choose`].
pub(in super::super) fn fit(task: &Task, control: &dyn Control) -> Result<Fit, FitError> {
    let Layout::Grid { size, .. } = &task.layout else {
        return Err(FitError::Numerical("no grid".into()));
    };
    let order = order(*size, &task.knuckles);
    let grid = parameters(task, DEGREE)?;
    let net = &grid.net;
    let free = task.freedom.iter().filter(|f| **f).count();
    let springs = springs_to(&task.points, &grid.at, &task.weight);
    let masked = free_only(&springs, task.freedom);
    let (matrix, model) = stretched(task, (net, &masked), (order, free as f64), control)?;
    let (mut chosen, weight, noise) = if task.robust {
        let r = robust(net, &masked, (&matrix, model), (None, control))?;
        (r.chosen, r.weight, r.scale)
    } else {
        let chosen = choose(&gather(net, &masked), &matrix, model, (None, control))?;
        let noise = chosen.noise;
        (chosen, springs.weight.clone(), noise)
    };
    if free < 3 {
        hold_axes(net, &springs, (&matrix, model, task.freedom), &mut chosen)?;
    }
    Ok(Fit {
        sheet: Sheet::of_points(net, &chosen.control),
        at: grid.at,
        lambda: chosen.lambda,
        noise,
        weight,
        energy: matrix,
        model,
    })
}

/// Steps of the stretch, up or down, and most of them.
const STRETCH: (f64, usize) = (2.0, 7);

/// The energy with the stretch of greatest likelihood, by walking from 1. The
/// user's own energy is left as it is.
///
/// # Errors
/// As [`choose`].
pub(in super::super) fn stretched<const D: usize>(
    task: &Task,
    (net, springs): (&Net, &Springs<D>),
    (order, components): (usize, f64),
    control: &dyn Control,
) -> Result<(EnvelopeMatrix, Likelihood), FitError> {
    let with = |stretch: f64| {
        let energy = energy(task.energy, (order, stretch), net.domain());
        let model = Likelihood {
            free: energy.free_dimension(net),
            components,
        };
        (energy.matrix(net), model)
    };
    let (mut best, model) = with(1.0);
    if task.energy.is_some() {
        return Ok((best, model));
    }
    let mass = Energy::mass().matrix(net);
    let normal = gather(net, springs);
    let criterion = |matrix: &EnvelopeMatrix, near: Option<f64>| -> Result<_, FitError> {
        let chosen = choose(&normal, matrix, model, (near, control))?;
        let prior = log_pseudo_determinant(matrix, &mass, model.free).unwrap_or(f64::NAN);
        Ok((chosen.criterion - components * prior, chosen.lambda))
    };
    let (mut least, first) = criterion(&best, None)?;
    for step in [STRETCH.0, 1.0 / STRETCH.0] {
        let mut stretch = 1.0;
        let (mut moved, mut near) = (false, first);
        for _ in 0..STRETCH.1 {
            stretch *= step;
            let (matrix, _) = with(stretch);
            let (value, lambda) = match criterion(&matrix, Some(near)) {
                // So much stretch is beyond what numbers can solve.
                Err(FitError::Numerical(_)) => break,
                other => other?,
            };
            near = lambda;
            // Not a number where a determinant failed: no improvement.
            if value.is_nan() || value >= least {
                break;
            }
            (best, least, moved) = (matrix, value, true);
        }
        if moved {
            break;
        }
    }
    Ok((best, model))
}

/// Replaces the coordinates that must not move by those that interpolate.
fn hold_axes(
    net: &Net,
    springs: &Springs<3>,
    (energy, model, freedom): (&EnvelopeMatrix, Likelihood, [bool; 3]),
    chosen: &mut Chosen<3>,
) -> Result<(), FitError> {
    let normal: Normal<3> = gather(net, springs);
    let trace = |m: &EnvelopeMatrix| m.diagonal().sum::<f64>();
    let balance = trace(&normal.matrix) / trace(energy).max(f64::MIN_POSITIVE);
    let held = fit_with(&normal, energy, INTERPOLATION * balance, model)
        .ok_or_else(|| FitError::Numerical("the held coordinates have no fit".into()))?;
    for (c, h) in chosen.control.iter_mut().zip(&held.control) {
        for d in 0..3 {
            if !freedom[d] {
                c[d] = h[d];
            }
        }
    }
    Ok(())
}
