//! The fit of a grid without a tolerance: parameters stay, all coordinates
//! are fitted at once, order of the energy and stiffness from the data.

use super::energy::Energy;
use super::fit::{Fit, energy, free_only, robust, springs_to};
use super::grid::parameters;
use super::net::{Net, Sheet};
use super::springs::{Normal, Springs, gather};
use super::stiffness::{Chosen, Likelihood, choose, fit_with, log_pseudo_determinant};
use super::task::{Layout, Task};
use super::trend::Detrended;
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
    let best = best(task, (net, &masked), (order, free as f64), control)?;
    let (mut chosen, matrix, model) = (best.chosen, best.energy, best.model);
    if free < 3 {
        hold_axes(net, &springs, (&matrix, model, task.freedom), &mut chosen)?;
    }
    Ok(Fit {
        sheet: Sheet::of_points(net, &chosen.control),
        at: grid.at,
        lambda: chosen.lambda,
        noise: best.noise,
        weight: best.weight,
        energy: matrix,
        model,
        monomials: best.monomials,
    })
}

/// Steps of the stretch, up or down, and most of them: terms of the energy of
/// order 4 then differ by 8⁸, and the digits last.
const STRETCH: (f64, usize) = (2.0, 3);

/// A fit with the energy that the data like best.
pub(in super::super) struct Best<const D: usize> {
    pub(in super::super) chosen: Chosen<D>,
    /// Springs' weights at the end.
    pub(in super::super) weight: Vec<f64>,
    /// σ a component, in the unit of the values.
    pub(in super::super) noise: f64,
    pub(in super::super) energy: EnvelopeMatrix,
    pub(in super::super) model: Likelihood,
    /// Monomials that it leaves free.
    pub(in super::super) monomials: Vec<[usize; 2]>,
}

/// The fit with stretch and stiffness of greatest likelihood, and outliers made
/// light of where that is asked.
///
/// # Errors
/// As [`choose`].
pub(in super::super) fn best<const D: usize>(
    task: &Task,
    (net, springs): (&Net, &Springs<D>),
    (order, components): (usize, f64),
    control: &dyn Control,
) -> Result<Best<D>, FitError> {
    // No stretch changes what is free.
    let monomials = energy(task.energy, (order, 1.0), net.domain()).free_monomials(net.degree());
    let taken = Detrended::new(net, springs, &monomials);
    let found = stretched(task, (net, &taken.normal), (order, components), control)?;
    let (energy, model) = (found.energy, found.model);
    let (mut chosen, weight, noise) = if task.robust {
        let near = (Some(found.chosen.lambda), control);
        let r = robust(net, &taken.left, (&energy, model), near)?;
        (r.chosen, r.weight, r.scale)
    } else {
        let noise = found.chosen.noise;
        (found.chosen, springs.weight.clone(), noise)
    };
    taken.restore(&mut chosen.control);
    Ok(Best {
        chosen,
        weight,
        noise,
        energy,
        model,
        monomials,
    })
}

/// An energy with its best fit.
struct Stretched<const D: usize> {
    chosen: Chosen<D>,
    energy: EnvelopeMatrix,
    model: Likelihood,
}

/// The energy with the stretch of greatest likelihood, by walking from 1. The
/// user's own energy is left as it is.
fn stretched<const D: usize>(
    task: &Task,
    (net, normal): (&Net, &Normal<D>),
    (order, components): (usize, f64),
    control: &dyn Control,
) -> Result<Stretched<D>, FitError> {
    let mass = Energy::mass().matrix(net);
    let with = |stretch: f64, near: Option<f64>| -> Result<_, FitError> {
        let term = energy(task.energy, (order, stretch), net.domain());
        let model = Likelihood {
            free: term.free_dimension(net),
            components,
        };
        let energy = term.matrix(net);
        let chosen = choose(normal, &energy, model, (near, control))?;
        let prior = log_pseudo_determinant(&energy, &mass, model.free).unwrap_or(f64::NAN);
        let value = chosen.criterion - components * prior;
        let found = Stretched {
            chosen,
            energy,
            model,
        };
        Ok((found, value))
    };
    let (mut best, mut least) = with(1.0, None)?;
    if task.energy.is_some() {
        return Ok(best);
    }
    let first = best.chosen.lambda;
    for step in [STRETCH.0, 1.0 / STRETCH.0] {
        let mut stretch = 1.0;
        let (mut moved, mut near) = (false, first);
        for _ in 0..STRETCH.1 {
            stretch *= step;
            let (found, value) = match with(stretch, Some(near)) {
                // So much stretch is beyond what numbers can solve.
                Err(FitError::Numerical(_)) => break,
                other => other?,
            };
            near = found.chosen.lambda;
            // Not a number where a determinant failed: no improvement.
            if value.is_nan() || value >= least {
                break;
            }
            (best, least, moved) = (found, value, true);
        }
        if moved {
            break;
        }
    }
    Ok(best)
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
