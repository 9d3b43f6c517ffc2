//! Points that look like mistakes.
//!
//! A mistake bends the sheet towards itself and its neighbours away from it:
//! residuals of an ordinary fit hide it and accuse others. So they are judged
//! against a robust fit, each by the sheet fitted without the point itself:
//! with leverage `h = bᵀM⁻¹b` and weight w the residual r becomes
//! `r/(1 − wh)`, its variance `σ²(1 + h/(1 − wh))`.

use super::feet::Foot;
use super::fit::{Fit, free_only, median_scale, robust, springs_to};
use super::net::{Sheet, Tangents};
use super::outcome::Slip;
use super::springs::{Springs, gather};
use super::stiffness::{Factor, blend};
use super::task::{Layout, Task};
use super::trend::Detrended;
use crate::methods::FitError;
use crate::methods::fairing::student::{freedom_of_tails, two_sided};
use crate::numerics::EnvelopeMatrix;
use crate::solver::Control;
use nalgebra::Vector3;
use rayon::prelude::*;

/// Up to so many points a robust fit is made for the purpose; beyond, single
/// points do not bend the sheet any more.
const ROBUST_UP_TO: usize = 20_000;
/// A slip is reported when noise would not do the like in so large a share of
/// all data sets.
const CONFIDENCE: f64 = 0.95;
/// Residuals below so many σ are not looked at.
const LOOK: f64 = 3.0;
/// Longest list.
const MOST: usize = 1000;
/// Leverages worked out one by one where a solution is dear; the others count
/// as the mean, which is then small.
const EXACT: usize = 40;
/// Order × half bandwidth above which it is dear.
const DEAR: usize = 400_000;
/// Most of the data's freedom that a fit is taken to have used up: guards
/// against division by nothing.
const MOST_USED: f64 = 0.9;
/// Least share of its own error that a point must keep to be judged: one that
/// alone holds its part of the sheet leaves no residual that could tell.
const LEAST_KEPT: f64 = 1e-3;
/// Noise below this share of the longest side is rounding.
const ROUNDING: f64 = 3e-7;

/// A sheet that slips have not bent, with what judges them.
struct Judge<'a> {
    task: &'a Task,
    fit: &'a Fit,
    sheet: Sheet,
    weight: Vec<f64>,
    /// Residual across the sheet and its direction, one a point.
    residual: Vec<(f64, Vector3<f64>)>,
    sigma: f64,
    /// Degrees of freedom of Student's t in which residuals are measured.
    freedom: f64,
    factor: Factor,
}

/// The suspected slips, worst first; `feet`: of the points on the fit.
///
/// # Errors
/// [`FitError::Stopped`].
pub(super) fn slips(
    task: &Task,
    (fit, feet): (&Fit, &[Foot]),
    control: &dyn Control,
) -> Result<Vec<Slip>, FitError> {
    let Some(judge) = judge(task, (fit, feet), control)? else {
        return Ok(Vec::new());
    };
    control.check()?;
    let size = |i: usize| judge.residual[i].0.abs();
    let mut suspects: Vec<usize> = (0..task.points.len())
        .filter(|i| size(*i) > LOOK * judge.sigma)
        .collect();
    suspects.sort_by(|a, b| size(*b).total_cmp(&size(*a)));
    let net = &fit.sheet.net;
    let mean = (net.len() as f64 / task.points.len() as f64).min(1.0);
    let dear = net.len() * net.half_bandwidth() > DEAR;
    let exact = if dear { EXACT } else { 2 * MOST };
    let mut slips = Vec::new();
    for (rank, i) in suspects.into_iter().take(2 * MOST).enumerate() {
        let h = if rank < exact {
            leverage(&judge.sheet, fit.at[i], &judge.factor)
        } else {
            mean
        };
        slips.extend(judge.verdict(i, h));
    }
    slips.sort_by(|a, b| b.sigmas.total_cmp(&a.sigmas));
    slips.truncate(MOST);
    Ok(slips)
}

/// Fits robustly where single points can bend the sheet; `None` where there is
/// no solution.
fn judge<'a>(
    task: &'a Task,
    (fit, feet): (&'a Fit, &[Foot]),
    control: &dyn Control,
) -> Result<Option<Judge<'a>>, FitError> {
    let net = &fit.sheet.net;
    let bent = task.points.len() <= ROBUST_UP_TO && !task.robust;
    let (mut springs, sheet, weight, (lambda, noise)) = if !bent {
        let springs = fit.sampled(&task.points, ROBUST_UP_TO);
        let of_fit = (fit.lambda, fit.noise);
        (springs, fit.sheet.clone(), fit.weight.clone(), of_fit)
    } else {
        let springs = springs_to(&task.points, &fit.at, &task.weight);
        let mut springs = free_only(&springs, task.freedom);
        let near = (Some(fit.lambda), control);
        let taken = Detrended::new(net, &springs, &fit.monomials);
        let mut r = robust(net, &taken.left, (&fit.energy, fit.model), near)?;
        taken.restore(&mut r.chosen.control);
        let sheet = fit.with_held(&r.chosen.control, task.freedom);
        springs.weight.clone_from(&r.weight);
        (springs, sheet, r.weight, (r.chosen.lambda, r.chosen.noise))
    };
    springs = free_only(&springs, task.freedom);
    let residual: Vec<(f64, Vector3<f64>)> = if bent {
        let places = task.points.par_iter().zip(&fit.at).with_min_len(512);
        places
            .map(|(p, at)| {
                let tangents = sheet.tangents(*at);
                across(&tangents, &(p - tangents.point), task.freedom)
            })
            .collect()
    } else {
        let feet = feet.par_iter().with_min_len(512);
        feet.map(|f| across(&f.sheet, &f.offset, task.freedom))
            .collect()
    };
    let matrix = gather(net, &weights_of(&springs)).matrix;
    let Some(factor) = Factor::new(&blend(&matrix, lambda, &fit.energy)) else {
        return Ok(None);
    };
    control.check()?;
    let lengths: Vec<f64> = residual.iter().map(|r| r.0.abs()).collect();
    let count = lengths.len() as f64;
    let used = used(&matrix, fit, (lambda, &factor)) / count;
    let kept = 1.0 - used.clamp(0.0, MOST_USED);
    let scale = scale(&lengths);
    let sigma = (scale.sigma / kept.sqrt()).max(noise).max(ROUNDING);
    let freedom = (EFFICIENCY * kept * count).max(1.0).min(scale.freedom);
    Ok(Some(Judge {
        task,
        fit,
        sheet,
        weight,
        residual,
        sigma,
        freedom,
        factor,
    }))
}

impl Judge<'_> {
    /// The slip that point i is, given its leverage; `None` if it is none.
    fn verdict(&self, i: usize, h: f64) -> Option<Slip> {
        let (length, along) = self.residual[i];
        let keep = 1.0 - self.weight[i] * h;
        if keep < LEAST_KEPT {
            return None;
        }
        let alone = length / keep;
        let sigmas = alone.abs() / (self.sigma * (1.0 + h / keep).sqrt());
        let chance = self.fit.at.len() as f64 * two_sided(sigmas, self.freedom);
        let confidence = 1.0 - chance.min(1.0);
        (confidence >= CONFIDENCE).then(|| slip(self.task, i, (along * alone, sigmas, confidence)))
    }
}

/// Degrees of freedom that a fit uses up, which its residuals lack:
/// `N − d ln det(A + λP)/d ln λ`, by a difference.
fn used(matrix: &EnvelopeMatrix, fit: &Fit, (lambda, factor): (f64, &Factor)) -> f64 {
    let beside = Factor::new(&blend(matrix, lambda * DIFFERENCE, &fit.energy));
    beside.map_or(0.0, |b| {
        let rise = b.log_determinant() - factor.log_determinant();
        matrix.order() as f64 - rise / DIFFERENCE.ln()
    })
}

/// Places and stiffness alone: all that leverages depend on.
fn weights_of(springs: &Springs<3>) -> Springs<0> {
    Springs {
        at: springs.at.clone(),
        value: vec![[]; springs.at.len()],
        weight: springs.weight.clone(),
    }
}

/// Factor between the two λ of the difference.
const DIFFERENCE: f64 = 1.1;

/// How wide the residuals are, and how long their tails.
struct Scale {
    sigma: f64,
    freedom: f64,
}

/// σ that both the middle and the shoulders of the residuals agree with: the
/// noise of real surveys has longer tails than the normal distribution, and
/// its tails are not slips. Up to 8 % of slips do not reach the shoulder. Many
/// residuals tell how long the tails are, too.
fn scale(lengths: &[f64]) -> Scale {
    let mut sorted = lengths.to_vec();
    if sorted.is_empty() {
        return Scale {
            sigma: 0.0,
            freedom: 1.0,
        };
    }
    let place = (SHOULDER.0 * (sorted.len() - 1) as f64) as usize;
    let (_, shoulder, _) = sorted.select_nth_unstable_by(place, f64::total_cmp);
    let (shoulder, middle) = (*shoulder, median_scale(lengths, 1));
    let ratio = shoulder / (middle * MEDIAN).max(f64::MIN_POSITIVE);
    Scale {
        sigma: middle.max(shoulder / SHOULDER.1),
        freedom: if lengths.len() >= MANY {
            freedom_of_tails(ratio)
        } else {
            f64::INFINITY
        },
    }
}

/// A quantile of |x| of the standard normal distribution.
const SHOULDER: (f64, f64) = (0.90, 1.644_854);
/// Its median.
const MEDIAN: f64 = 0.674_490;
/// Residuals that tell the length of their tails.
const MANY: usize = 500;
/// Efficiency of σ from a quantile: so many degrees of freedom has it for one
/// of the residuals (Huber 1981, §5.1).
const EFFICIENCY: f64 = 0.5;

fn slip(task: &Task, i: usize, (off, sigmas, confidence): (Vector3<f64>, f64, f64)) -> Slip {
    let cell = match &task.layout {
        Layout::Grid { cell, .. } => Some(cell[i]),
        Layout::Scattered => None,
    };
    Slip {
        index: task.index[i],
        cell,
        given: task.frame.to_user(&task.points[i]),
        expected: task.frame.to_user(&(task.points[i] - off)),
        off: off.norm() * task.frame.size,
        sigmas,
        confidence,
    }
}

/// Residual across the sheet (or along the one free axis), and its direction.
fn across(tangents: &Tangents, offset: &Vector3<f64>, freedom: [bool; 3]) -> (f64, Vector3<f64>) {
    let along = if freedom.iter().filter(|f| **f).count() == 1 {
        Vector3::from_fn(|k, _| if freedom[k] { 1.0 } else { 0.0 })
    } else {
        tangents.normal().unwrap_or_else(Vector3::z)
    };
    (along.dot(offset), along)
}

/// `bᵀM⁻¹b` at a place.
fn leverage(sheet: &Sheet, at: [f64; 2], factor: &Factor) -> f64 {
    let [ju, jv] = sheet.net.jets::<1>(at);
    let mut row = vec![0.0; sheet.net.len()];
    for (a, x) in ju.values().iter().enumerate() {
        for (b, y) in jv.values().iter().enumerate() {
            row[sheet.net.index(ju.first + a, jv.first + b)] = x * y;
        }
    }
    let mut solved = row.clone();
    factor.solve_in_place(&mut solved);
    row.iter().zip(&solved).map(|(a, b)| a * b).sum()
}
