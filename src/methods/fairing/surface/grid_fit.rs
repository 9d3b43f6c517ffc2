//! The fit of a grid without a tolerance: parameters stay, all coordinates
//! are fitted at once, order of the energy and stiffness from the data.

use super::fit::{Fit, energy, robust, springs_to};
use super::grid::parameters;
use super::net::{Net, Sheet};
use super::springs::{Normal, Springs, gather};
use super::stiffness::{Chosen, Likelihood, choose, fit_with};
use super::task::{Layout, Task};
use crate::methods::FitError;
use crate::numerics::EnvelopeMatrix;
use crate::solver::Control;

/// Degree of a grid's net: C⁴, so that no knot shows in isophotes or in the
/// variation of curvature.
const DEGREE: usize = 5;
/// Rows and columns that the orders 4 and 3 of the energy need: twice what
/// determines the polynomials that they leave free.
const ROWS_OF_ORDER: [(usize, usize); 2] = [(8, 4), (5, 3)];
/// Weight of the energy where a coordinate must not change, against the
/// balance of traces.
const INTERPOLATION: f64 = 1e-9;

/// Fits a grid.
///
/// # Errors
/// As [`choose`].
pub(in super::super) fn fit(task: &Task, control: &dyn Control) -> Result<Fit, FitError> {
    let Layout::Grid { size, .. } = &task.layout else {
        return Err(FitError::Numerical("no grid".into()));
    };
    let shorter = size[0].min(size[1]);
    let order = ROWS_OF_ORDER
        .iter()
        .find(|(rows, _)| shorter >= *rows)
        .map_or(2, |(_, order)| *order);
    let grid = parameters(task, DEGREE)?;
    let net = &grid.net;
    let energy = energy(task.energy, order, net.domain());
    let free = task.freedom.iter().filter(|f| **f).count();
    let model = Likelihood {
        free: energy.free_dimension(DEGREE),
        components: free as f64,
    };
    let matrix = energy.matrix(net);
    let springs = springs_to(&task.points, &grid.at, &task.weight);
    let (mut chosen, weight, noise) = if task.robust {
        let r = robust(net, &springs, (&matrix, model), control)?;
        (r.chosen, r.weight, r.scale)
    } else {
        let masked = free_only(&springs, task.freedom);
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

/// The same springs with the held coordinates at zero: they must not speak
/// of the noise.
fn free_only(springs: &Springs<3>, freedom: [bool; 3]) -> Springs<3> {
    let mut masked = springs.clone();
    for value in &mut masked.value {
        for (v, _) in value.iter_mut().zip(freedom).filter(|(_, free)| !free) {
            *v = 0.0;
        }
    }
    masked
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
