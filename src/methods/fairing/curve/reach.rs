//! A curve strictly within the tolerances, from which the fairest is sought:
//! springs reweighted. Where a point is too far away its spring is made
//! stiffer, the others stay as they are (after Lawson's algorithm for
//! uniform approximation, 1961).

use super::free::Shape;
use super::holds::Holds;
use super::springs::Springs;
use crate::solver::{Control, Stop};

/// Rounds at most.
const MOST_ROUNDS: usize = 80;
/// Share of its tolerance that every point must keep to.
const WITHIN: f64 = 0.97;
/// Share beyond which a spring is made stiffer, and the share aimed at.
const STIFFEN_BEYOND: f64 = 0.9;
const AIM: f64 = 0.85;
/// Power of the excess by which it is, and its bound a round.
const POWER: i32 = 4;
const MOST_FACTOR: f64 = 30.0;
/// Rounds without gain after which the spline counts as too poor.
const PATIENCE: usize = 12;
/// What counts as a gain.
const GAIN: f64 = 0.99;
/// Longest step of a foot, as a share of the domain.
const REACH: f64 = 0.03;

/// Brings every point within its tolerance if the spline can, and returns the
/// largest share of a tolerance that is used; on return `shape` and feet are
/// the best found.
///
/// # Errors
/// When the control says stop.
pub(super) fn reach<const D: usize>(
    shape: &mut Shape<D>,
    springs: &mut Springs<D>,
    (tolerances, stiffness): (&[f64], f64),
    holds: &mut Holds<D>,
    control: &dyn Control,
) -> Result<f64, Stop> {
    let [a, b] = shape.space.domain();
    let given = springs.weights.clone();
    let mut best = (worst(shape, springs, tolerances), shape.clone(), springs.feet.clone());
    let mut since = 0;
    for _ in 0..MOST_ROUNDS {
        control.check()?;
        if best.0 <= WITHIN || since > PATIENCE {
            break;
        }
        stiffen(shape, springs, tolerances);
        let gram = springs.gram(&shape.space, &shape.x);
        holds.follow(springs.held_feet());
        shape.balance(&gram, holds, stiffness);
        holds.tighten(&shape.space, &shape.x);
        springs.refresh(&shape.space, &shape.x, REACH * (b - a));
        let now = worst(shape, springs, tolerances);
        since = if now < GAIN * best.0 { 0 } else { since + 1 };
        if now < best.0 {
            best = (now, shape.clone(), springs.feet.clone());
        }
    }
    (*shape, springs.feet) = (best.1, best.2);
    springs.weights = given;
    Ok(best.0)
}

fn stiffen<const D: usize>(shape: &Shape<D>, springs: &mut Springs<D>, tolerances: &[f64]) {
    let residuals = springs.residuals(&shape.space, &shape.x);
    for ((w, e), t) in springs.weights.iter_mut().zip(&residuals).zip(tolerances) {
        let used = e.norm() / t;
        if used > STIFFEN_BEYOND {
            *w *= (used / AIM).powi(POWER).min(MOST_FACTOR);
        }
    }
}

/// The largest share of a tolerance that a point uses.
pub(super) fn worst<const D: usize>(
    shape: &Shape<D>,
    springs: &Springs<D>,
    tolerances: &[f64],
) -> f64 {
    springs
        .residuals(&shape.space, &shape.x)
        .iter()
        .zip(tolerances)
        .filter(|(_, t)| t.is_finite() && **t > 0.0)
        .map(|(e, t)| e.norm() / t)
        .fold(0.0, f64::max)
}
