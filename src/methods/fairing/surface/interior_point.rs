//! The fairest sheet between strips: minimise `½cᵀHc + gᵀc` subject to
//! `|Ac − r| ≤ 1`, by Mehrotra's predictor–corrector interior-point method
//! (Nocedal & Wright 2006, alg. 16.4) with an infeasible start.
//!
//! Two slacks a point, `s₊ = 1 − (Ac − r)` and `s₋ = 1 + (Ac − r)`, with
//! duals z₊, z₋ ≥ 0; the Newton matrix is `H + Aᵀ(z₊/s₊ + z₋/s₋)A`, in the
//! envelope of H. At the end the slacks of the linear problem are positive:
//! the tolerance is met with room to spare, however small.

use super::stiffness;
use super::strips::Strips;
use crate::methods::FitError;
use crate::numerics::EnvelopeMatrix;
use crate::solver::Control;

/// The quadratic part.
#[derive(Debug)]
pub(super) struct Objective {
    pub(super) hessian: EnvelopeMatrix,
    pub(super) gradient: Vec<f64>,
}

/// Where the iteration ended.
#[derive(Debug, Clone)]
pub(super) struct Optimum {
    /// The moves of the control points.
    pub(super) moves: Vec<f64>,
    /// `z₊ − z₋` a point: how hard it holds the sheet; zero inside the strip.
    pub(super) duals: Vec<f64>,
    /// Whether every strip is met and the gap closed.
    pub(super) met: bool,
}

/// Most iterations; 10 to 25 are usual.
const ITERATIONS: usize = 60;
/// Share of the way to the wall that a step may go.
const TO_THE_WALL: f64 = 0.995;
/// Relative duality gap at the end: the energy is then known to 1e-6.
const GAP: f64 = 1e-6;
/// Largest imbalance of forces at the end, relative to the forces.
const BALANCE: f64 = 1e-6;
/// Largest strip overrun at the end, in tolerances.
const OVERRUN: f64 = 1e-9;

struct State {
    c: Vec<f64>,
    s: [Vec<f64>; 2],
    z: [Vec<f64>; 2],
}

struct Step {
    c: Vec<f64>,
    s: [Vec<f64>; 2],
    z: [Vec<f64>; 2],
}

/// Residuals of the optimality conditions at one state.
struct Residuals {
    dual: Vec<f64>,
    strip: [Vec<f64>; 2],
    mean: f64,
    /// `½cᵀHc + gᵀc`.
    energy: f64,
    /// Largest entry of `Aᵀz`.
    pull: f64,
}

/// Solves; never fails for infeasible strips, but then says so.
///
/// # Errors
/// [`FitError::Stopped`].
pub(super) fn minimise(
    objective: &Objective,
    strips: &Strips,
    control: &dyn Control,
) -> Result<Optimum, FitError> {
    let n = strips.at.len();
    let start = 1.0 / n.max(1) as f64;
    let mut x = State {
        c: vec![0.0; objective.gradient.len()],
        s: [0, 1].map(|k| strips.offset.iter().map(|r| first_slack(*r, k)).collect()),
        z: [vec![start; n], vec![start; n]],
    };
    let mut met = false;
    for _ in 0..ITERATIONS {
        control.check()?;
        let now = residuals(objective, strips, &x);
        met = finished(objective, &now, &x);
        if met {
            break;
        }
        let Some(step) = newton(objective, strips, (&x, &now)) else {
            break;
        };
        advance(&mut x, &step);
    }
    let duals = x.z[0].iter().zip(&x.z[1]).map(|(a, b)| a - b).collect();
    Ok(Optimum {
        moves: x.c,
        duals,
        met,
    })
}

/// The slack of the start where it is inside, else ε: from nearer the wall the
/// first steps would be short.
fn first_slack(offset: f64, side: usize) -> f64 {
    let slack = if side == 0 {
        1.0 + offset
    } else {
        1.0 - offset
    };
    slack.max(1.0)
}

fn residuals(objective: &Objective, strips: &Strips, x: &State) -> Residuals {
    let place = strips.apply(&x.c);
    let sum = |k: usize, sign: f64| -> Vec<f64> {
        let s = &x.s[k];
        (0..s.len())
            .map(|i| s[i] - 1.0 + sign * (place[i] - strips.offset[i]))
            .collect()
    };
    let strip = [sum(0, 1.0), sum(1, -1.0)];
    let difference: Vec<f64> = x.z[0].iter().zip(&x.z[1]).map(|(a, b)| a - b).collect();
    let mut dual = objective.hessian.multiply(&x.c);
    let terms = dual.iter().zip(&objective.gradient).zip(&x.c);
    let energy = terms.map(|((h, g), c)| c * (0.5 * h + g)).sum();
    let pull = strips.transpose(&difference);
    for (d, (g, p)) in dual.iter_mut().zip(objective.gradient.iter().zip(&pull)) {
        *d += g + p;
    }
    Residuals {
        dual,
        strip,
        mean: mean(&x.s, &x.z),
        energy,
        pull: pull.iter().fold(0.0, |m, p| m.max(p.abs())),
    }
}

/// Mean complementarity μ.
fn mean(s: &[Vec<f64>; 2], z: &[Vec<f64>; 2]) -> f64 {
    let sum = |k: usize| -> f64 { s[k].iter().zip(&z[k]).map(|(a, b)| a * b).sum() };
    (sum(0) + sum(1)) / (2 * s[0].len().max(1)) as f64
}

fn finished(objective: &Objective, now: &Residuals, x: &State) -> bool {
    let largest = |v: &[f64]| v.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let gap = now.mean * (2 * x.s[0].len()) as f64;
    largest(&now.strip[0]).max(largest(&now.strip[1])) < OVERRUN
        && gap < GAP * (1.0 + now.energy.abs())
        && largest(&now.dual) < BALANCE * (now.pull + largest(&objective.gradient) + 1e-3)
}

/// Predictor and corrector with one factor; `None` where it breaks down.
fn newton(objective: &Objective, strips: &Strips, (x, now): (&State, &Residuals)) -> Option<Step> {
    let n = x.s[0].len();
    let weight: Vec<f64> = (0..n)
        .map(|i| x.z[0][i] / x.s[0][i] + x.z[1][i] / x.s[1][i])
        .collect();
    let mut matrix = objective.hessian.clone();
    strips.add_weighted(&weight, &mut matrix);
    // The energy leaves a few motions free until points hold them.
    let shift = 1e-14 * matrix.diagonal().fold(0.0, f64::max);
    for i in 0..matrix.order() {
        matrix.add_to_diagonal(i, shift);
    }
    let factor = stiffness::Factor::new(&matrix)?;
    let direction = |target: &[Vec<f64>; 2]| -> Option<Step> {
        let t = [0, 1].map(|k| -> Vec<f64> {
            (0..n)
                .map(|i| (target[k][i] + x.z[k][i] * now.strip[k][i]) / x.s[k][i] - x.z[k][i])
                .collect()
        });
        let difference: Vec<f64> = (0..n).map(|i| t[0][i] - t[1][i]).collect();
        let pull = strips.transpose(&difference);
        let rhs: Vec<[f64; 1]> = now.dual.iter().zip(pull).map(|(d, p)| [-d - p]).collect();
        let c: Vec<f64> = stiffness::solve(&factor, &rhs)
            .iter()
            .map(|v| v[0])
            .collect();
        c.iter().all(|v| v.is_finite()).then(|| {
            let place = strips.apply(&c);
            let sign = [1.0, -1.0];
            let s = [0, 1].map(|k| -> Vec<f64> {
                (0..n)
                    .map(|i| -now.strip[k][i] - sign[k] * place[i])
                    .collect()
            });
            let z = [0, 1].map(|k| -> Vec<f64> {
                (0..n)
                    .map(|i| (target[k][i] - x.z[k][i] * s[k][i]) / x.s[k][i] - x.z[k][i])
                    .collect()
            });
            Step { c, s, z }
        })
    };
    let nothing = [vec![0.0; n], vec![0.0; n]];
    let predictor = direction(&nothing)?;
    let reach = longest(x, &predictor);
    let (s, z) = moved(x, &predictor, reach);
    let centring = (mean(&s, &z) / now.mean).powi(3);
    let target = [0, 1].map(|k| -> Vec<f64> {
        (0..n)
            .map(|i| centring * now.mean - predictor.s[k][i] * predictor.z[k][i])
            .collect()
    });
    direction(&target)
}

/// Longest steps, primal and dual, that keep slacks and duals ≥ 0.
fn longest(x: &State, step: &Step) -> [f64; 2] {
    let reach = |v: &[Vec<f64>; 2], d: &[Vec<f64>; 2]| {
        (0..2)
            .flat_map(|k| v[k].iter().zip(&d[k]))
            .filter(|(_, d)| **d < 0.0)
            .fold(1.0_f64, |m, (v, d)| m.min(-v / d))
    };
    [reach(&x.s, &step.s), reach(&x.z, &step.z)]
}

fn moved(x: &State, step: &Step, [primal, dual]: [f64; 2]) -> ([Vec<f64>; 2], [Vec<f64>; 2]) {
    let go = |v: &[f64], d: &[f64], by: f64| v.iter().zip(d).map(|(v, d)| v + by * d).collect();
    (
        [0, 1].map(|k| go(&x.s[k], &step.s[k], primal)),
        [0, 1].map(|k| go(&x.z[k], &step.z[k], dual)),
    )
}

/// One length for both: the Hessian couples slacks and duals.
fn advance(x: &mut State, step: &Step) {
    let [primal, dual] = longest(x, step);
    let by = (TO_THE_WALL * primal.min(dual)).min(1.0);
    let (s, z) = moved(x, step, [by, by]);
    (x.s, x.z) = (s, z);
    for (c, d) in x.c.iter_mut().zip(&step.c) {
        *c += by * d;
    }
}
