//! Levenberg–Marquardt for least squares with one-sided residuals.
//!
//! A step minimises the model ½|r + Jp|² + ½ λ pᵀDp, where D is the running
//! largest diagonal of JᵀJ (Moré 1978: the trust region is then an ellipsoid
//! that does not depend on the unknowns' units) and λ follows the ratio of the
//! true to the predicted reduction (Nielsen 1999).
//!
//! A one-sided residual counts ½ max(0, r)², in the model too: the model is
//! then convex and piecewise quadratic, and is minimised by a semismooth Newton
//! iteration on the set of residuals that count, each step followed by an exact
//! line search. A step thus foresees the inequalities that it would break;
//! plain Gauss–Newton runs into them one after the other.
//!
//! That foresight costs a factorisation for every change of the set. With a
//! [`Settings::smoothing`] μ a one-sided residual counts ½ρ² instead, ρ a
//! smooth stand-in for max(0, r) that is off by at most μ, and a step is one
//! Newton step on that smooth convex function of J: a caller that lowers μ
//! from run to run follows the central path of an interior point method, at
//! one factorisation a step.
//!
//! A trial point whose residuals are not finite counts as no reduction, so a
//! problem can keep the iteration inside its domain by saying so.

use super::blocks::{Blocks, Derivatives};
use super::normal::{NormalEquations, NormalMatrix};
use super::{Control, LeastSquares, Report, Stop, Termination};

/// What is asked of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Most steps, refused ones included.
    pub iterations: usize,
    /// End when no gradient component is above this.
    pub gradient: f64,
    /// End when a step is below this, relative to the unknowns.
    pub step: f64,
    /// End when the predicted and the true relative reduction are below this.
    pub reduction: f64,
    /// Damping at the start, relative to D.
    pub damping: f64,
    /// μ of the one-sided residuals, in their unit; zero for sharp ones.
    pub smoothing: f64,
    /// The least scale of an unknown, as a share of the largest: damps those
    /// that the residuals hardly see near the start but see farther on.
    pub least_scale: f64,
    /// How the normal equations are stored and factored.
    pub normal_equations: NormalEquations,
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            iterations: 100,
            gradient: 1e-14,
            step: 1e-10,
            reduction: 1e-9,
            damping: 1e-3,
            smoothing: 0.0,
            least_scale: 1e-12,
            normal_equations: NormalEquations::Envelope,
        }
    }
}

/// Above this damping a step is lost in rounding: nothing more can be gained.
const LARGEST_DAMPING: f64 = 1e14;
/// Below this the damping no longer matters and only loses the way back up.
const SMALLEST_DAMPING: f64 = 1e-13;
/// Up to this damping a step is about the full Gauss–Newton step.
const FREE_DAMPING: f64 = 0.1;
/// A step must keep this share of its predicted reduction.
const LEAST_GAIN: f64 = 1e-4;

/// The iteration's private state.
struct State {
    x: Vec<f64>,
    cost: f64,
    gradient: Vec<f64>,
    scale: Vec<f64>,
    /// Derivatives of the cost by the residuals at `x`.
    derivatives: Derivatives,
    smoothing: f64,
    least_scale: f64,
    damping: f64,
    /// Nielsen's ν: the factor of the next increase.
    growth: f64,
    evaluations: usize,
}

/// Minimises from `x`, which holds the best point at the end.
///
/// # Errors
/// [`Stop`] when the control says so; `x` then holds the best point so far.
pub fn minimize(
    problem: &dyn LeastSquares,
    x: &mut [f64],
    settings: &Settings,
    control: &dyn Control,
) -> Result<Report, Stop> {
    let (mut blocks, mut trial_blocks) = (Blocks::default(), Blocks::default());
    let mut normal = NormalMatrix::new(settings.normal_equations, problem.dimension());
    let mut state = State::new(x, settings);
    state.linearize(problem, &mut blocks, &mut normal);
    let initial_cost = state.cost;
    let finish = |state: &State, termination, iterations| Report {
        termination,
        iterations,
        evaluations: state.evaluations,
        initial_cost,
        cost: state.cost,
        gradient: largest(&state.gradient),
    };
    if !state.is_finite() {
        return Ok(finish(&state, Termination::BadStart, 0));
    }
    for iteration in 0..settings.iterations {
        control.check()?;
        if largest(&state.gradient) <= settings.gradient {
            return Ok(finish(&state, Termination::SmallGradient, iteration));
        }
        let buffers = (&mut blocks, &mut trial_blocks);
        let ended = state.advance(problem, buffers, &mut normal, settings);
        x.copy_from_slice(&state.x);
        if let Some(termination) = ended {
            return Ok(finish(&state, termination, iteration + 1));
        }
    }
    Ok(finish(
        &state,
        Termination::IterationLimit,
        settings.iterations,
    ))
}

impl State {
    fn new(x: &[f64], settings: &Settings) -> Self {
        State {
            x: x.to_vec(),
            cost: f64::INFINITY,
            gradient: vec![0.0; x.len()],
            scale: vec![0.0; x.len()],
            derivatives: Derivatives::default(),
            smoothing: settings.smoothing,
            least_scale: settings.least_scale,
            damping: settings.damping,
            growth: 2.0,
            evaluations: 0,
        }
    }

    fn is_finite(&self) -> bool {
        self.cost.is_finite() && self.gradient.iter().all(|g| g.is_finite())
    }

    /// Cost, gradient, normal matrix and scale at the current point.
    fn linearize(
        &mut self,
        problem: &dyn LeastSquares,
        blocks: &mut Blocks,
        normal: &mut NormalMatrix,
    ) {
        blocks.reset(true);
        problem.evaluate(&self.x, blocks);
        self.evaluations += 1;
        self.cost = blocks.cost(self.smoothing);
        blocks.derivatives(blocks.residuals(), self.smoothing, &mut self.derivatives);
        self.gradient.fill(0.0);
        blocks.add_gradient(&self.derivatives.first, &mut self.gradient);
        normal.assemble(blocks, self.x.len());
        let diagonal = NormalMatrix::diagonal(blocks, &self.derivatives.second, self.x.len());
        let top = largest(&diagonal).max(f64::MIN_POSITIVE);
        for (scale, d) in self.scale.iter_mut().zip(&diagonal) {
            // An unknown that no residual sees still needs a positive scale.
            *scale = scale.max(*d).max(self.least_scale * top);
        }
    }

    /// One step, accepted or refused.
    fn advance(
        &mut self,
        problem: &dyn LeastSquares,
        (blocks, trial_blocks): (&mut Blocks, &mut Blocks),
        normal: &mut NormalMatrix,
        settings: &Settings,
    ) -> Option<Termination> {
        let shift: Vec<f64> = self.scale.iter().map(|d| self.damping * d).collect();
        let Some(model) = self.model(blocks, normal, &shift) else {
            return self.refuse();
        };
        if relative_size(&model.step, &self.x) <= settings.step {
            return Some(Termination::SmallStep);
        }
        let predicted = model.reduction;
        let trial: Vec<f64> = self.x.iter().zip(&model.step).map(|(x, p)| x + p).collect();
        trial_blocks.reset(false);
        problem.evaluate(&trial, trial_blocks);
        self.evaluations += 1;
        let reduction = self.cost - trial_blocks.cost(self.smoothing);
        let gain = reduction / predicted;
        if !(gain.is_finite() && gain > LEAST_GAIN) {
            let lost = self.is_free() && predicted <= settings.reduction * self.cost;
            return if lost {
                Some(Termination::SmallReduction)
            } else {
                self.refuse()
            };
        }
        let (before, free) = (self.cost, self.is_free());
        self.x = trial;
        self.linearize(problem, blocks, normal);
        self.damping = (self.damping * (1.0 - (2.0 * gain - 1.0).powi(3)).max(1.0 / 3.0))
            .max(SMALLEST_DAMPING);
        self.growth = 2.0;
        let small = free && reduction.max(predicted) <= settings.reduction * before;
        small.then_some(Termination::SmallReduction)
    }

    fn model(&self, blocks: &Blocks, normal: &mut NormalMatrix, shift: &[f64]) -> Option<Model> {
        if self.smoothing > 0.0 {
            Model::newton(blocks, normal, shift, (&self.derivatives, &self.gradient))
        } else {
            Model::minimize(blocks, normal, shift, &self.derivatives)
        }
    }

    /// Whether a small reduction means that little is left to gain, rather
    /// than that the damping allows only a short step.
    fn is_free(&self) -> bool {
        self.damping <= FREE_DAMPING
    }

    fn refuse(&mut self) -> Option<Termination> {
        self.damping *= self.growth;
        self.growth *= 2.0;
        (self.damping > LARGEST_DAMPING).then_some(Termination::Stalled)
    }
}

/// The damped model of one linearisation, minimised.
struct Model {
    step: Vec<f64>,
    /// By how much its value falls.
    reduction: f64,
}

/// Newton steps on the set of counting residuals; it settles after a few, and
/// a step that is not quite the minimum is still a step.
const MODEL_STEPS: usize = 12;
/// Bisections of the exact line search; with fewer the model steps do not settle.
const SEARCHES: usize = 30;

impl Model {
    /// One Newton step on the smooth cost.
    fn newton(
        blocks: &Blocks,
        normal: &mut NormalMatrix,
        shift: &[f64],
        (derivatives, gradient): (&Derivatives, &[f64]),
    ) -> Option<Self> {
        let mut step: Vec<f64> = gradient.iter().map(|g| -g).collect();
        if !normal.solve(blocks, &derivatives.second, shift, &mut step) {
            return None;
        }
        let downhill: f64 = step.iter().zip(gradient).map(|(p, g)| p * g).sum();
        Some(Model {
            step,
            reduction: -0.5 * downhill,
        })
    }

    /// The minimum for sharp one-sided residuals, by the set that counts.
    fn minimize(
        blocks: &Blocks,
        normal: &mut NormalMatrix,
        shift: &[f64],
        start: &Derivatives,
    ) -> Option<Self> {
        let residuals = blocks.residuals();
        let mut step = vec![0.0; shift.len()];
        let mut weights = start.second.clone();
        let (mut values, mut changes) = (residuals.to_vec(), Vec::new());
        let mut next = Derivatives::default();
        for _ in 0..MODEL_STEPS {
            let pull: Vec<f64> = residuals
                .iter()
                .zip(&weights)
                .map(|(r, w)| -r * w)
                .collect();
            let mut target = vec![0.0; shift.len()];
            blocks.add_gradient(&pull, &mut target);
            if !normal.solve(blocks, &weights, shift, &mut target) {
                return None;
            }
            target.iter_mut().zip(&step).for_each(|(t, p)| *t -= p);
            blocks.changes(&target, &mut changes);
            let share = exact_share(blocks, (&values, &changes), (&step, &target), shift);
            step.iter_mut()
                .zip(&target)
                .for_each(|(p, d)| *p += share * d);
            values
                .iter_mut()
                .zip(&changes)
                .for_each(|(v, c)| *v += share * c);
            blocks.derivatives(&values, 0.0, &mut next);
            if share == 1.0 && next.second == weights {
                break;
            }
            std::mem::swap(&mut weights, &mut next.second);
        }
        let damped: f64 = step.iter().zip(shift).map(|(p, s)| p * p * s).sum();
        let value = blocks.cost_of(&values, 0.0) + 0.5 * damped;
        Some(Model {
            step,
            reduction: blocks.cost(0.0) - value,
        })
    }
}

/// The share in (0, 1] of a direction that minimises the model along it.
fn exact_share(
    blocks: &Blocks,
    (values, changes): (&[f64], &[f64]),
    (step, direction): (&[f64], &[f64]),
    shift: &[f64],
) -> f64 {
    let slope = |share: f64| {
        let residuals: f64 = values
            .iter()
            .zip(changes)
            .enumerate()
            .map(|(r, (v, c))| {
                let moved = v + share * c;
                if blocks.is_one_sided(r) && moved < 0.0 {
                    0.0
                } else {
                    moved * c
                }
            })
            .sum();
        let damping = step.iter().zip(direction).zip(shift);
        residuals
            + damping
                .map(|((p, d), s)| s * (p + share * d) * d)
                .sum::<f64>()
    };
    // At the minimum of its own quadratic the slope is zero to rounding.
    if slope(1.0) <= 1e-10 * slope(0.0).abs() {
        return 1.0;
    }
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..SEARCHES {
        let middle = 0.5 * (low + high);
        if slope(middle) > 0.0 {
            high = middle
        } else {
            low = middle
        }
    }
    0.5 * (low + high)
}

fn largest(v: &[f64]) -> f64 {
    v.iter().fold(0.0, |m, a| m.max(a.abs()))
}

fn relative_size(step: &[f64], x: &[f64]) -> f64 {
    step.iter()
        .zip(x)
        .map(|(p, x)| p.abs() / (1.0 + x.abs()))
        .fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::Unwatched;
    use crate::solver::derivative_check::worst_disagreement;

    /// Rosenbrock's residuals, with an optional wall x₀ ≤ `wall`.
    struct Rosenbrock {
        wall: Option<f64>,
    }

    impl LeastSquares for Rosenbrock {
        fn dimension(&self) -> usize {
            2
        }

        fn evaluate(&self, x: &[f64], blocks: &mut Blocks) {
            let residuals = [1.0 - x[0], 10.0 * (x[1] - x[0] * x[0])];
            blocks.push(&residuals, &[0, 1], &[-1.0, 0.0, -20.0 * x[0], 10.0]);
            if let Some(wall) = self.wall {
                const HARD: f64 = 1e4;
                blocks.push_mixed(&[HARD * (x[0] - wall)], 0, &[0], &[HARD]);
            }
        }
    }

    fn run(problem: &dyn LeastSquares, x: &mut [f64], settings: &Settings) -> Report {
        minimize(problem, x, settings, &Unwatched).expect("nobody stops it")
    }

    #[test]
    fn rosenbrock_with_both_normal_equations() {
        for normal_equations in [NormalEquations::Envelope, NormalEquations::Sparse] {
            let mut x = [-1.2, 1.0];
            let settings = Settings {
                normal_equations,
                ..Settings::default()
            };
            let report = run(&Rosenbrock { wall: None }, &mut x, &settings);
            assert!(report.termination.converged(), "{report:?}");
            assert!((x[0] - 1.0).abs() + (x[1] - 1.0).abs() < 1e-8, "{x:?}");
        }
    }

    #[test]
    fn the_derivative_check_passes_right_and_finds_wrong_derivatives() {
        let right = worst_disagreement(&Rosenbrock { wall: None }, &[0.3, -0.4], 1e-5);
        assert!(right.relative < 1e-8, "{right:?}");
        struct Wrong;
        impl LeastSquares for Wrong {
            fn dimension(&self) -> usize {
                1
            }
            fn evaluate(&self, x: &[f64], blocks: &mut Blocks) {
                blocks.push(&[x[0] * x[0]], &[0], &[x[0]]);
            }
        }
        assert!(worst_disagreement(&Wrong, &[2.0], 1e-5).relative > 0.1);
    }

    #[test]
    fn a_one_sided_residual_holds_only_on_its_side() {
        for (wall, expected) in [(0.5, 0.5), (2.0, 1.0)] {
            let mut x = [-1.2, 1.0];
            let report = run(
                &Rosenbrock { wall: Some(wall) },
                &mut x,
                &Settings::default(),
            );
            assert!(report.termination.converged(), "{report:?}");
            assert!((x[0] - expected).abs() < 1e-6, "wall {wall}: {x:?}");
            assert!((x[1] - x[0] * x[0]).abs() < 1e-6, "wall {wall}: {x:?}");
        }
    }

    /// r = ln x − 1, not a number for x ≤ 0: a full first step from 8 leaves
    /// the domain.
    struct Logarithm;

    impl LeastSquares for Logarithm {
        fn dimension(&self) -> usize {
            1
        }

        fn evaluate(&self, x: &[f64], blocks: &mut Blocks) {
            blocks.push(&[x[0].ln() - 1.0], &[0], &[1.0 / x[0]]);
        }
    }

    #[test]
    fn steps_out_of_the_domain_are_refused() {
        let mut x = [30.0];
        let report = run(&Logarithm, &mut x, &Settings::default());
        assert!(report.termination.converged(), "{report:?}");
        assert!((x[0] - std::f64::consts::E).abs() < 1e-8, "{x:?}");
    }

    #[test]
    fn a_start_out_of_the_domain_is_reported() {
        let mut x = [-1.0];
        let report = run(&Logarithm, &mut x, &Settings::default());
        assert_eq!(
            (report.termination, report.iterations, x),
            (Termination::BadStart, 0, [-1.0])
        );
    }

    /// A residual that sees only the first of two unknowns.
    struct Blind;

    impl LeastSquares for Blind {
        fn dimension(&self) -> usize {
            2
        }

        fn evaluate(&self, x: &[f64], blocks: &mut Blocks) {
            blocks.push(&[x[0] - 4.0], &[0], &[1.0]);
        }
    }

    #[test]
    fn an_unknown_that_nothing_sees_stays() {
        for normal_equations in [NormalEquations::Envelope, NormalEquations::Sparse] {
            let mut x = [0.0, 7.0];
            let settings = Settings {
                normal_equations,
                ..Settings::default()
            };
            run(&Blind, &mut x, &settings);
            assert!((x[0] - 4.0).abs() < 1e-8, "{x:?}");
            assert_eq!(x[1], 7.0);
        }
    }

    #[test]
    fn the_iteration_limit_is_kept() {
        let mut x = [-1.2, 1.0];
        let settings = Settings {
            iterations: 3,
            ..Settings::default()
        };
        let report = run(&Rosenbrock { wall: None }, &mut x, &settings);
        assert_eq!(
            (report.termination, report.iterations),
            (Termination::IterationLimit, 3)
        );
        assert!(report.cost <= report.initial_cost);
    }

    struct Impatient;

    impl Control for Impatient {
        fn check(&self) -> Result<(), Stop> {
            Err(Stop::OutOfTime)
        }
        fn progress(&self, _phase: &'static str, _percent: f64) {}
    }

    #[test]
    fn it_stops_when_told() {
        let mut x = [-1.2, 1.0];
        let problem = Rosenbrock { wall: None };
        let stopped = minimize(&problem, &mut x, &Settings::default(), &Impatient);
        assert_eq!(stopped, Err(Stop::OutOfTime));
        assert_eq!(x, [-1.2, 1.0]);
    }
}
