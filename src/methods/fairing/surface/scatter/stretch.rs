//! Sheets are not alike in all directions: a hull changes over its length much
//! more slowly than over its depth. The stretch of the energy that makes the
//! data most likely is looked for where it costs next to nothing.

use super::super::energy::Energy;
use super::super::fit::energy;
use super::super::net::Net;
use super::super::springs::Normal;
use super::super::stiffness::{Chosen, Likelihood, choose, log_pseudo_determinant};
use super::super::task::Task;
use super::levels::Step;
use crate::methods::FitError;
use crate::solver::Control;

/// Steps of the stretch.
const FACTOR: f64 = 1.5;
/// Most steps a level, and the largest stretch either way.
const MOST: (usize, f64) = (4, 8.0);
/// Order × half bandwidth² up to which a level is asked.
const CHEAP: f64 = 4e6;

/// The step with the stretch of greatest likelihood near its own, judged on
/// the net of the step, and its λ.
///
/// # Errors
/// As [`choose`].
pub(super) fn better(
    task: &Task,
    (net, step): (&Net, Step),
    (normal, chosen): (&Normal<1>, &Chosen<1>),
    control: &dyn Control,
) -> Result<(Step, f64), FitError> {
    let cost = net.len() as f64 * (net.half_bandwidth() as f64).powi(2);
    if task.energy.is_some() || cost > CHEAP {
        return Ok((step, chosen.lambda));
    }
    let mass = Energy::mass().matrix(net);
    let criterion = |stretch: f64, near: f64| -> Result<(f64, f64), FitError> {
        let term = energy(None, (step.space.order, stretch), net.domain());
        let model = Likelihood {
            free: term.free_dimension(net),
            components: 1.0,
        };
        let matrix = term.matrix(net);
        let chosen = choose(normal, &matrix, model, (Some(near), control))?;
        let prior = log_pseudo_determinant(&matrix, &mass, model.free).unwrap_or(f64::NAN);
        Ok((chosen.criterion - prior, chosen.lambda))
    };
    let (mut least, first) = criterion(step.stretch, chosen.lambda)?;
    let mut best = (step, first);
    for factor in [FACTOR, 1.0 / FACTOR] {
        let (mut stretch, mut near) = (step.stretch, first);
        for _ in 0..MOST.0 {
            stretch *= factor;
            let (value, lambda) = criterion(stretch, near)?;
            // Not a number where a determinant failed: no improvement.
            if value.is_nan() || value >= least || !(1.0 / MOST.1..=MOST.1).contains(&stretch) {
                break;
            }
            best = (Step { stretch, ..step }, lambda);
            (least, near) = (value, lambda);
        }
        if best.0 != step {
            break;
        }
    }
    Ok(best)
}
