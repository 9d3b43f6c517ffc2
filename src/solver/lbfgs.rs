//! Limited-memory BFGS with a line search for the strong Wolfe conditions
//! (Nocedal & Wright 2006, algorithms 7.4, 7.5, 3.5 and 3.6).

use super::{Control, Report, Stop, Termination};
use std::collections::VecDeque;

/// A smooth function of many variables.
pub trait Objective {
    /// The value at `x`; writes the gradient.
    fn evaluate(&self, x: &[f64], gradient: &mut [f64]) -> f64;

    /// Called after every accepted step: the place to renew what is held
    /// constant between steps (foot points). Answers whether the function has
    /// changed.
    fn accepted(&mut self, _x: &[f64]) -> bool {
        false
    }
}

/// What is asked of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Most iterations.
    pub iterations: usize,
    /// End when no gradient component is above this.
    pub gradient: f64,
    /// End when the value falls by less than this, relatively, ten times in a row.
    pub reduction: f64,
    /// Pairs of steps and gradient changes that are kept.
    pub memory: usize,
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            iterations: 1000,
            gradient: 1e-10,
            reduction: 1e-12,
            memory: 20,
        }
    }
}

/// Sufficient decrease and curvature constants of the Wolfe conditions.
const DECREASE: f64 = 1e-4;
const CURVATURE: f64 = 0.9;
/// Trial steps of one line search; more means that rounding has the upper hand.
const TRIALS: usize = 30;
/// A slow iteration now and then is normal; this many in a row are the end.
const SLOW_ITERATIONS: usize = 10;

struct Pair {
    step: Vec<f64>,
    change: Vec<f64>,
    inverse_product: f64,
}

struct Point {
    x: Vec<f64>,
    value: f64,
    gradient: Vec<f64>,
}

/// Minimises from `x`, which holds the last point at the end.
///
/// # Errors
/// [`Stop`] when the control says so.
pub fn minimize(
    objective: &mut dyn Objective,
    x: &mut [f64],
    settings: &Settings,
    control: &dyn Control,
) -> Result<Report, Stop> {
    let mut evaluations = 1;
    let mut here = Point {
        x: x.to_vec(),
        value: 0.0,
        gradient: vec![0.0; x.len()],
    };
    here.value = objective.evaluate(&here.x, &mut here.gradient);
    let initial_cost = here.value;
    let mut pairs: VecDeque<Pair> = VecDeque::with_capacity(settings.memory);
    let (mut slow, mut termination, mut iterations) = (0, Termination::IterationLimit, 0);
    if !(here.value.is_finite() && norm_max(&here.gradient).is_finite()) {
        termination = Termination::BadStart;
    }
    while termination == Termination::IterationLimit && iterations < settings.iterations {
        control.check()?;
        if norm_max(&here.gradient) <= settings.gradient {
            termination = Termination::SmallGradient;
            break;
        }
        iterations += 1;
        let Some(mut next) = step(objective, &here, &mut pairs, &mut evaluations) else {
            termination = Termination::Stalled;
            break;
        };
        let slow_now = (here.value - next.value).abs() <= settings.reduction * here.value.abs();
        slow = if slow_now { slow + 1 } else { 0 };
        if slow >= SLOW_ITERATIONS {
            termination = Termination::SmallReduction;
        }
        remember(&mut pairs, settings.memory, &here, &next);
        if objective.accepted(&next.x) {
            next.value = objective.evaluate(&next.x, &mut next.gradient);
            evaluations += 1;
        }
        x.copy_from_slice(&next.x);
        here = next;
    }
    Ok(Report {
        termination,
        iterations,
        evaluations,
        initial_cost,
        cost: here.value,
        gradient: norm_max(&here.gradient),
    })
}

/// One quasi-Newton step; when its line search fails, one more try along the
/// gradient without memory.
fn step(
    objective: &dyn Objective,
    here: &Point,
    pairs: &mut VecDeque<Pair>,
    evaluations: &mut usize,
) -> Option<Point> {
    let direction = two_loop(&here.gradient, pairs);
    let first = if pairs.is_empty() {
        1.0 / norm_max(&here.gradient).max(1.0)
    } else {
        1.0
    };
    if let Some(next) = line_search(objective, here, &direction, first, evaluations) {
        return Some(next);
    }
    if pairs.is_empty() {
        return None;
    }
    pairs.clear();
    let steepest: Vec<f64> = here.gradient.iter().map(|g| -g).collect();
    let first = 1.0 / norm_max(&here.gradient).max(1.0);
    line_search(objective, here, &steepest, first, evaluations)
}

fn remember(pairs: &mut VecDeque<Pair>, memory: usize, here: &Point, next: &Point) {
    let step = difference(&next.x, &here.x);
    let change = difference(&next.gradient, &here.gradient);
    let product = dot(&step, &change);
    // Keep the approximation positive definite.
    if product > 1e-14 * dot(&change, &change).sqrt() * dot(&step, &step).sqrt() {
        if pairs.len() == memory {
            pairs.pop_front();
        }
        pairs.push_back(Pair {
            step,
            change,
            inverse_product: 1.0 / product,
        });
    }
}

/// −H·g by the two-loop recursion (algorithm 7.4).
fn two_loop(gradient: &[f64], pairs: &VecDeque<Pair>) -> Vec<f64> {
    let mut q: Vec<f64> = gradient.iter().map(|g| -g).collect();
    let mut weights = Vec::with_capacity(pairs.len());
    for pair in pairs.iter().rev() {
        let weight = pair.inverse_product * dot(&pair.step, &q);
        add_scaled(&mut q, -weight, &pair.change);
        weights.push(weight);
    }
    if let Some(last) = pairs.back() {
        let scale = 1.0 / (last.inverse_product * dot(&last.change, &last.change));
        q.iter_mut().for_each(|v| *v *= scale);
    }
    for (pair, weight) in pairs.iter().zip(weights.into_iter().rev()) {
        let other = pair.inverse_product * dot(&pair.change, &q);
        add_scaled(&mut q, weight - other, &pair.step);
    }
    q
}

/// A point along a direction with its value and slope.
struct Trial {
    length: f64,
    slope: f64,
    point: Point,
}

/// Step lengths that meet the strong Wolfe conditions (algorithm 3.5).
fn line_search(
    objective: &dyn Objective,
    here: &Point,
    direction: &[f64],
    first: f64,
    evaluations: &mut usize,
) -> Option<Point> {
    let slope0 = dot(&here.gradient, direction);
    if slope0 >= 0.0 || !slope0.is_finite() {
        return None;
    }
    let mut try_length = |length: f64| {
        *evaluations += 1;
        trial_at(objective, here, direction, length)
    };
    let origin = Point {
        x: here.x.clone(),
        value: here.value,
        gradient: here.gradient.clone(),
    };
    let mut last = Trial {
        length: 0.0,
        slope: slope0,
        point: origin,
    };
    let mut length = first;
    for attempt in 0..TRIALS {
        let trial = try_length(length);
        let bound = here.value + DECREASE * length * slope0;
        let too_high = trial.point.value > bound || trial.point.value.is_nan();
        if too_high || (attempt > 0 && trial.point.value >= last.point.value) {
            return zoom(&mut try_length, here.value, slope0, last, trial);
        }
        if trial.slope.abs() <= -CURVATURE * slope0 {
            return Some(trial.point);
        }
        if trial.slope >= 0.0 {
            return zoom(&mut try_length, here.value, slope0, trial, last);
        }
        last = trial;
        length *= 2.0;
    }
    None
}

fn trial_at(objective: &dyn Objective, here: &Point, direction: &[f64], length: f64) -> Trial {
    let x: Vec<f64> = here
        .x
        .iter()
        .zip(direction)
        .map(|(x, d)| x + length * d)
        .collect();
    let mut gradient = vec![0.0; x.len()];
    let value = objective.evaluate(&x, &mut gradient);
    let slope = dot(&gradient, direction);
    Trial {
        length,
        slope,
        point: Point { x, value, gradient },
    }
}

/// Narrows a bracket (algorithm 3.6); `low` is its better end.
fn zoom(
    try_length: &mut dyn FnMut(f64) -> Trial,
    value0: f64,
    slope0: f64,
    mut low: Trial,
    mut high: Trial,
) -> Option<Point> {
    for _ in 0..TRIALS {
        let trial = try_length(cubic_minimum(&low, &high));
        let enough = trial.point.value <= value0 + DECREASE * trial.length * slope0;
        if !enough || trial.point.value >= low.point.value {
            high = trial;
        } else {
            if trial.slope.abs() <= -CURVATURE * slope0 {
                return Some(trial.point);
            }
            if trial.slope * (high.length - low.length) >= 0.0 {
                high = low;
            }
            low = trial;
        }
        if (high.length - low.length).abs() <= 1e-16 * high.length.max(low.length) {
            break;
        }
    }
    // Rounding ends the search before the curvature condition: a lower value
    // is still a step.
    (low.length > 0.0 && low.point.value < value0).then_some(low.point)
}

/// Minimum of the cubic through both ends (N & W eq. 3.59), kept inside the
/// bracket's middle 80 %.
fn cubic_minimum(a: &Trial, b: &Trial) -> f64 {
    let width = b.length - a.length;
    let d1 = a.slope + b.slope - 3.0 * (b.point.value - a.point.value) / width;
    let d2 = width.signum() * (d1 * d1 - a.slope * b.slope).sqrt();
    let cubic = b.length - width * (b.slope + d2 - d1) / (b.slope - a.slope + 2.0 * d2);
    let share = (cubic - a.length) / width;
    let share = if share.is_finite() {
        share.clamp(0.1, 0.9)
    } else {
        0.5
    };
    a.length + share * width
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

fn add_scaled(a: &mut [f64], scale: f64, b: &[f64]) {
    a.iter_mut().zip(b).for_each(|(a, b)| *a += scale * b);
}

fn norm_max(v: &[f64]) -> f64 {
    // `f64::max` would swallow a NaN.
    v.iter().fold(0.0, |m: f64, a| {
        if m.is_nan() || a.is_nan() {
            f64::NAN
        } else {
            m.max(a.abs())
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::Unwatched;

    /// Rosenbrock's valley in pairs; minimum 0 at (1, …, 1).
    struct Rosenbrock;

    impl Objective for Rosenbrock {
        fn evaluate(&self, x: &[f64], gradient: &mut [f64]) -> f64 {
            gradient.fill(0.0);
            let mut value = 0.0;
            for k in (0..x.len()).step_by(2) {
                let (a, b) = (1.0 - x[k], x[k + 1] - x[k] * x[k]);
                value += a * a + 100.0 * b * b;
                gradient[k] = -2.0 * a - 400.0 * x[k] * b;
                gradient[k + 1] = 200.0 * b;
            }
            value
        }
    }

    #[test]
    fn rosenbrock_ends_in_its_minimum() {
        let mut x = [-1.2, 1.0].repeat(10);
        let report = minimize(&mut Rosenbrock, &mut x, &Settings::default(), &Unwatched);
        let report = report.expect("nobody stops it");
        assert!(report.termination.converged(), "{report:?}");
        assert!(x.iter().all(|v| (v - 1.0).abs() < 1e-8), "{x:?}");
        assert!(report.iterations < 100, "{report:?}");
        assert!(report.cost < report.initial_cost && report.evaluations > report.iterations);
    }

    #[test]
    fn steps_meet_the_strong_wolfe_conditions() {
        let x = vec![-1.2, 1.0];
        let mut here = Point {
            x,
            value: 0.0,
            gradient: vec![0.0; 2],
        };
        here.value = Rosenbrock.evaluate(&here.x, &mut here.gradient);
        let direction: Vec<f64> = here.gradient.iter().map(|g| -g).collect();
        let slope = dot(&here.gradient, &direction);
        for first in [1e-8, 1e-3, 1.0, 1e4] {
            let next =
                line_search(&Rosenbrock, &here, &direction, first, &mut 0).expect("a descent");
            let length = (next.x[0] - here.x[0]) / direction[0];
            assert!(
                next.value <= here.value + DECREASE * length * slope,
                "first step {first}"
            );
            assert!(
                dot(&next.gradient, &direction).abs() <= -CURVATURE * slope,
                "first step {first}"
            );
        }
    }

    /// |x − target|² whose target walks on after accepted steps, a few times.
    struct Walking {
        target: f64,
        renewals: usize,
    }

    impl Objective for Walking {
        fn evaluate(&self, x: &[f64], gradient: &mut [f64]) -> f64 {
            gradient[0] = 2.0 * (x[0] - self.target);
            (x[0] - self.target).powi(2)
        }

        fn accepted(&mut self, _x: &[f64]) -> bool {
            let walks = self.renewals < 5;
            if walks {
                self.renewals += 1;
                self.target += 1.0;
            }
            walks
        }
    }

    #[test]
    fn a_function_that_changes_after_a_step_is_evaluated_anew() {
        let mut objective = Walking {
            target: 3.0,
            renewals: 0,
        };
        let mut x = [0.0];
        let report = minimize(&mut objective, &mut x, &Settings::default(), &Unwatched);
        assert!(report.expect("nobody stops it").termination.converged());
        assert_eq!(objective.renewals, 5);
        assert!((x[0] - 8.0).abs() < 1e-9, "{x:?}");
    }

    /// A function that is not a number anywhere.
    struct Broken;

    impl Objective for Broken {
        fn evaluate(&self, _x: &[f64], gradient: &mut [f64]) -> f64 {
            gradient.fill(f64::NAN);
            f64::NAN
        }
    }

    #[test]
    fn a_start_that_is_not_finite_is_reported_and_left_alone() {
        let mut x = [1.0, 2.0];
        let report = minimize(&mut Broken, &mut x, &Settings::default(), &Unwatched);
        let report = report.expect("nobody stops it");
        assert_eq!(
            (report.termination, report.iterations),
            (Termination::BadStart, 0)
        );
        assert_eq!(x, [1.0, 2.0]);
    }

    /// −ln x: falls for ever, without a minimum; not a number left of 0.
    struct Endless;

    impl Objective for Endless {
        fn evaluate(&self, x: &[f64], gradient: &mut [f64]) -> f64 {
            gradient[0] = -1.0 / x[0];
            -x[0].ln()
        }
    }

    #[test]
    fn a_function_without_a_minimum_ends_at_the_limit() {
        let mut x = [1e-3];
        let settings = Settings {
            iterations: 5,
            gradient: 0.0,
            ..Settings::default()
        };
        let report =
            minimize(&mut Endless, &mut x, &settings, &Unwatched).expect("nobody stops it");
        assert!(
            report.iterations <= 5 && !report.termination.converged(),
            "{report:?}"
        );
        assert!(x[0].is_finite() && x[0] > 1e-3);
    }

    struct Impatient;

    impl Control for Impatient {
        fn check(&self) -> Result<(), Stop> {
            Err(Stop::Cancelled)
        }
        fn progress(&self, _phase: &'static str, _percent: f64) {}
    }

    #[test]
    fn it_stops_when_told() {
        let mut x = [-1.2, 1.0];
        let stopped = minimize(&mut Rosenbrock, &mut x, &Settings::default(), &Impatient);
        assert_eq!(stopped, Err(Stop::Cancelled));
    }
}
