//! Boundaries that may move within a tolerance: paths and displacements of
//! all plates are solved together, so that a chine stays one curve for both
//! of its plates.
//!
//! The tolerance is a hard bound by construction ([`super::movable`]). Target
//! and clearance are one-sided residuals, smoothed at first and sharpened from
//! stage to stage ([`lm::Settings::smoothing`]). Within the tolerance the moves are the least that bring the twist down to a target: the
//! weight of each coefficient's move is renewed as 1/|d| (iteratively
//! reweighted least squares), which concentrates the moves where they are
//! needed instead of spreading a little everywhere.

use super::exact::{Rulings, end_at_tips, tips, weights};
use super::model::{Model, PlateSpec};
use super::movable::{Displacement, Movable};
use super::profile::Profile;
use super::task::{Limits, Pins};
use crate::methods::FitError;
use crate::solver::levenberg_marquardt::{self as lm, Settings};
use crate::solver::{Control, NormalEquations, Report};

/// What is asked of a relaxed fit.
#[derive(Debug, Clone)]
pub(super) struct Task<'a> {
    pub(super) profiles: &'a [Profile],
    pub(super) limits: Limits,
    pub(super) pins: &'a [Pins],
    /// y of the plane of symmetry, unit scale.
    pub(super) centreline: f64,
    /// Twist to aim at, radians: below it moves count more than twist.
    pub(super) target: f64,
}

/// A relaxed fit.
#[derive(Debug, Clone)]
pub(super) struct Relaxed {
    pub(super) movables: Vec<Movable>,
    /// Displacement coefficients of each profile.
    pub(super) displacements: Vec<Displacement>,
    /// Path unknowns of each plate.
    pub(super) paths: Vec<Vec<f64>>,
    /// Largest |θ|; infinite where rulings turn back, so that it is of no use.
    pub(super) twist_max: f64,
    pub(super) iterations: usize,
    pub(super) last: Option<Report>,
}

/// Knot spans of a displacement: enough to follow a sharp forefoot, where half
/// as many left twice the twist.
const SPANS: usize = 128;
/// Excess over the target counts so much more than the mean that the target
/// acts as a bound.
const CEILING_WEIGHT: f64 = 30.0;
const TWIST_WEIGHT: f64 = 0.1;
/// Weight of moves of the size of the tolerance against a twist of
/// [`MOVE_ANGLE`] (radians, 0.02°); tried from 1 to 10, ten moves least at the
/// same twist.
const MOVE_WEIGHT: f64 = 10.0;
const MOVE_ANGLE: f64 = 3.5e-4;
/// Weight of their second differences: enough against ripple from coefficient
/// to coefficient, too little to spread a move.
const FAIRNESS: f64 = 0.02;
/// Between samples a twist above the target, and above the largest at a sample,
/// by this factor is a peak to look at.
const PEAK: f64 = 1.05;
/// A plate that is still rough between so many samples is not to be had.
const MOST_SAMPLES: usize = 1500;
/// Moves below this share of the tolerance all count the same.
const NEGLIGIBLE_MOVE: f64 = 0.02;

/// Smoothing of the one-sided residuals in the first stage, in
/// [`MOVE_ANGLE`]; from stage to stage it falls by a factor, and the rounding
/// of the paths' corners (arc-length fraction) with it. The last stage solves
/// what is delivered, but for what cannot be seen.
const FIRST_SMOOTHING: f64 = 3.0;
const STAGES: usize = 5;
/// Stages after the last while the clearance is not met.
const MORE_STAGES: usize = 4;
const SHARPENING: f64 = 0.3;
const FIRST_ROUNDING: f64 = 1e-2;
const SHARPER_CORNERS: f64 = 0.1;
/// Steps of a stage; the first goes furthest.
const FIRST_STEPS: usize = 12;
const STEPS: usize = 8;
/// Factors of the clearance's weight in the first stages; the last one stays.
const CLEARANCES: [f64; 3] = [1.0, 2.0, 4.0];
const REDUCTION: f64 = 1e-3;

/// Moves the boundaries of all plates by at most `tolerance` (unit scale),
/// from their exact rulings.
///
/// # Errors
/// [`FitError::Stopped`]; [`FitError::Numerical`] if a profile has no splines
/// to move on.
pub(super) fn solve(
    task: &Task<'_>,
    start: &[Rulings],
    tolerance: f64,
    control: &dyn Control,
) -> Result<Relaxed, FitError> {
    let movables = task
        .profiles
        .iter()
        .enumerate()
        .map(|(k, p)| {
            Movable::new(
                p,
                SPANS,
                tolerance,
                (task.centreline, meets(task.profiles, k)),
            )
        })
        .collect::<Result<Vec<_>, _>>()
        .map_err(|e| FitError::Numerical(e.to_string()))?;
    let plates = start
        .iter()
        .zip(task.pins)
        .enumerate()
        .map(|(i, (rulings, pins))| PlateSpec {
            profiles: [i, i + 1],
            shape: rulings.shape.clone(),
            pins: pins.clone(),
            speeds: rulings.speeds,
            tips: rulings.tips,
        })
        .collect();
    let mut model = Model::new(
        task.profiles,
        plates,
        movables,
        &|k, s| place(start, k, s),
        weights(&task.limits),
    );
    let paths: Vec<Vec<f64>> = start.iter().map(|r| r.y.clone()).collect();
    let moves: Vec<Vec<f64>> = model
        .movables
        .iter()
        .map(|m| vec![0.0; m.unknowns()])
        .collect();
    let mut x = model.gather(&paths, &moves);
    model.weights.ceiling = task.target;
    model.weights.ceiling_weight = CEILING_WEIGHT;
    model.weights.twist = TWIST_WEIGHT;
    let unit = MOVE_ANGLE / tolerance;
    let (mut iterations, mut last) = (0, None);
    for k in 0..STAGES + MORE_STAGES {
        reweigh(&mut model, &x, unit, tolerance);
        let sharpness = i32::try_from(k).unwrap_or(i32::MAX);
        let rounding = FIRST_ROUNDING * SHARPER_CORNERS.powi(sharpness);
        for plate in &mut model.plates {
            plate.shape = plate.shape.clone().rounded(rounding);
        }
        let clearance = CLEARANCES[k.min(CLEARANCES.len() - 1)];
        model.weights.clearance = clearance * weights(&task.limits).clearance;
        let settings = Settings {
            iterations: if k == 0 { FIRST_STEPS } else { STEPS },
            smoothing: FIRST_SMOOTHING * MOVE_ANGLE * SHARPENING.powi(sharpness),
            reduction: REDUCTION,
            normal_equations: NormalEquations::Sparse,
            ..Settings::default()
        };
        let report = lm::minimize(&model, &mut x, &settings, control)?;
        iterations += report.iterations;
        for p in 0..model.plates.len() {
            if k > 0 {
                model.tighten(&x, p);
            }
            let known = PEAK * model.twist_max(&x, p).max(task.target);
            let peaks = model.peaks_between(&x, p, known);
            let samples = model.plates[p].shape.stations().len() + peaks.len();
            if !peaks.is_empty() && samples <= MOST_SAMPLES {
                model.plates[p].shape = model.plates[p].shape.with_more(&peaks);
            }
        }
        last = Some(report);
        let clear = (0..model.plates.len()).all(|p| model.is_clear(&x, p));
        if k + 1 >= STAGES && clear {
            break;
        }
    }
    let paths: Vec<Vec<f64>> = (0..start.len())
        .map(|p| {
            let mut y = model.path_of(&x, p);
            end_at_tips(&mut y, start[p].tips);
            y
        })
        .collect();
    let moves: Vec<Vec<f64>> = (0..model.movables.len())
        .map(|k| model.moves_of(&x, k))
        .collect();
    let x = model.gather(&paths, &moves);
    Ok(Relaxed {
        displacements: model.displacements(&x),
        paths,
        twist_max: (0..start.len())
            .map(|p| model.twist_max_everywhere(&x, p))
            .fold(0.0, f64::max),
        movables: model.movables,
        iterations,
        last,
    })
}

/// At which ends profile `k` meets a neighbour.
fn meets(profiles: &[Profile], k: usize) -> [bool; 2] {
    let neighbours = [k.checked_sub(1), Some(k + 1)].into_iter().flatten();
    let tips = neighbours.filter_map(|i| Some(tips([&profiles[k], profiles.get(i)?])));
    tips.fold([false; 2], |a, b| [a[0] || b[0], a[1] || b[1]])
}

/// Where along the paths of its plates the point `s` of profile `k` is used,
/// in the mean.
fn place(start: &[Rulings], k: usize, s: f64) -> f64 {
    let before = k
        .checked_sub(1)
        .map(|i| start[i].shape.place_of(&start[i].y, 1, s));
    let behind = start.get(k).map(|r| r.shape.place_of(&r.y, 0, s));
    match (before, behind) {
        (Some(a), Some(b)) => 0.5 * (a + b),
        (a, b) => a.or(b).unwrap_or(s),
    }
}

fn reweigh(model: &mut Model<'_>, x: &[f64], unit: f64, tolerance: f64) {
    let displacements = model.displacements(x);
    let moved = displacements
        .iter()
        .any(|d| d.coefficients.iter().any(|d| d.norm() > 0.0));
    for (weights, d) in model.move_weights.iter_mut().zip(&displacements) {
        let d = &d.coefficients;
        let share = (1.0 / d.len() as f64).sqrt();
        for (weight, d) in weights.iter_mut().zip(d) {
            let factor = if moved {
                (1.0 / (d.norm() / tolerance + NEGLIGIBLE_MOVE)).sqrt()
            } else {
                1.0
            };
            *weight = MOVE_WEIGHT * unit * share * factor;
        }
    }
    model.weights.move_fairness =
        FAIRNESS * unit / (displacements[0].coefficients.len() as f64).sqrt();
}
