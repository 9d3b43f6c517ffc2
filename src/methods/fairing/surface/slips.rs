//! Points that look like mistakes.
//!
//! A mistake bends the sheet towards itself and its neighbours away from it:
//! residuals of an ordinary fit hide it and accuse others. So they are judged
//! against a robust fit, each by the sheet fitted without the point itself:
//! with leverage `h = bᵀM⁻¹b` and weight w the residual r becomes
//! `r/(1 − wh)`, its variance `σ²(1 + h/(1 − wh))`.

use super::fit::{Fit, median_scale, robust, springs_to};
use super::net::Sheet;
use super::outcome::Slip;
use super::springs::{Normal, gather};
use super::stiffness::{Factor, fit_with};
use super::task::{Layout, Task};
use crate::methods::FitError;
use crate::solver::Control;
use nalgebra::Vector3;

/// Up to so many points a robust fit is made for the purpose; beyond, single
/// points do not bend the sheet any more.
const ROBUST_UP_TO: usize = 20_000;
/// A slip is reported when noise would do the like in fewer than one in so
/// many data sets.
const CONFIDENCE: f64 = 0.5;
/// Residuals below so many σ are not looked at.
const LOOK: f64 = 3.0;
/// Longest list.
const MOST: usize = 1000;
/// Leverages worked out one by one where a solution is dear; the others count
/// as the mean, which is then small.
const EXACT: usize = 40;
/// Order × half bandwidth above which it is dear.
const DEAR: usize = 400_000;
/// Noise below this share of the longest side is rounding.
const ROUNDING: f64 = 1e-7;

/// The suspected slips, worst first.
///
/// # Errors
/// [`FitError::Stopped`].
pub(super) fn slips(task: &Task, fit: &Fit, control: &dyn Control) -> Result<Vec<Slip>, FitError> {
    let springs = springs_to(&task.points, &fit.at, &task.weight);
    let net = &fit.sheet.net;
    let (control_points, weight, lambda) = if task.points.len() <= ROBUST_UP_TO && !task.robust {
        let near = (Some(fit.lambda), control);
        let r = robust(net, &springs, (&fit.energy, fit.model), near)?;
        (r.chosen.control, r.weight, r.chosen.lambda)
    } else {
        let control = fit.sheet.control.iter().map(|p| [p.x, p.y, p.z]).collect();
        (control, fit.weight.clone(), fit.lambda)
    };
    let sheet = Sheet::of_points(net, &control_points);
    let residual: Vec<(f64, Vector3<f64>)> = task
        .points
        .iter()
        .zip(&fit.at)
        .map(|(p, at)| across(&sheet, p, *at, task.freedom))
        .collect();
    let lengths: Vec<f64> = residual.iter().map(|r| r.0.abs()).collect();
    let mut weighted = springs;
    weighted.weight = weight;
    let normal = gather(net, &weighted);
    let Some(solved) = fit_with(&normal, &fit.energy, lambda, fit.model) else {
        return Ok(Vec::new());
    };
    control.check()?;
    let used = used(&normal, fit, (lambda, &solved.factor)) / lengths.len() as f64;
    let sigma = (scale(&lengths) / (1.0 - used.clamp(0.0, 0.9)).sqrt()).max(ROUNDING);
    let suspects: Vec<usize> = (0..lengths.len())
        .filter(|i| lengths[*i] > LOOK * sigma)
        .collect();
    if suspects.is_empty() {
        return Ok(Vec::new());
    }
    control.check()?;
    let mut slips: Vec<Slip> = Vec::new();
    let mut order = suspects;
    order.sort_by(|a, b| lengths[*b].total_cmp(&lengths[*a]));
    let mean = (net.len() as f64 / lengths.len() as f64).min(1.0);
    let exact = if net.len() * net.half_bandwidth() > DEAR {
        EXACT
    } else {
        2 * MOST
    };
    for (rank, i) in order.into_iter().take(2 * MOST).enumerate() {
        let h = if rank < exact {
            leverage(&sheet, fit.at[i], &solved.factor)
        } else {
            mean
        };
        let keep = (1.0 - weighted.weight[i] * h).max(1e-6);
        let alone = residual[i].0 / keep;
        let sigmas = alone.abs() / (sigma * (1.0 + h / keep).sqrt());
        let confidence = 1.0 - (lengths.len() as f64 * two_sided(sigmas)).min(1.0);
        if confidence >= CONFIDENCE {
            slips.push(slip(task, i, (residual[i].1 * alone, sigmas, confidence)));
        }
    }
    slips.sort_by(|a, b| b.sigmas.total_cmp(&a.sigmas));
    slips.truncate(MOST);
    Ok(slips)
}

/// Degrees of freedom that a fit uses up, which its residuals lack:
/// `N − d ln det(A + λP)/d ln λ`, by a difference.
fn used(normal: &Normal<3>, fit: &Fit, (lambda, factor): (f64, &Factor)) -> f64 {
    let order = normal.rhs.len() as f64;
    let beside = fit_with(normal, &fit.energy, lambda * DIFFERENCE, fit.model);
    beside.map_or(0.0, |b| {
        let rise = b.factor.log_determinant() - factor.log_determinant();
        order - rise / DIFFERENCE.ln()
    })
}

/// Factor between the two λ of the difference.
const DIFFERENCE: f64 = 1.1;

/// σ that both the middle and the shoulders of the residuals agree with: the
/// noise of real surveys has longer tails than the normal distribution, and
/// its tails are not slips. Up to 8 % of slips do not reach the shoulder.
fn scale(lengths: &[f64]) -> f64 {
    let mut sorted = lengths.to_vec();
    if sorted.is_empty() {
        return 0.0;
    }
    let place = (SHOULDER.0 * (sorted.len() - 1) as f64) as usize;
    let (_, shoulder, _) = sorted.select_nth_unstable_by(place, f64::total_cmp);
    median_scale(lengths, 1).max(*shoulder / SHOULDER.1)
}

/// A quantile of |x| of the standard normal distribution.
const SHOULDER: (f64, f64) = (0.90, 1.644_854);

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
fn across(
    sheet: &Sheet,
    p: &Vector3<f64>,
    at: [f64; 2],
    freedom: [bool; 3],
) -> (f64, Vector3<f64>) {
    let t = sheet.tangents(at);
    let along = if freedom.iter().filter(|f| **f).count() == 1 {
        Vector3::from_fn(|k, _| if freedom[k] { 1.0 } else { 0.0 })
    } else {
        t.normal().unwrap_or_else(Vector3::z)
    };
    (along.dot(&(p - t.point)), along)
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

/// Probability that a standard normal variable is farther from 0 than z
/// (Abramowitz & Stegun 7.1.26 below 3, the continued fraction 7.1.14 above).
fn two_sided(z: f64) -> f64 {
    let x = z / std::f64::consts::SQRT_2;
    if z < 3.0 {
        let t = 1.0 / (1.0 + 0.327_591_1 * x);
        let poly = t
            * (0.254_829_592
                + t * (-0.284_496_736
                    + t * (1.421_413_741 + t * (-1.453_152_027 + t * 1.061_405_429))));
        return poly * (-x * x).exp();
    }
    let mut tail = x;
    for k in (1..=40).rev() {
        tail = x + 0.5 * f64::from(k) / tail;
    }
    (-x * x).exp() / (tail * std::f64::consts::PI.sqrt())
}

#[cfg(test)]
mod tests {
    use super::two_sided;

    /// Tables of the normal distribution.
    #[test]
    fn tails() {
        for (z, p) in [
            (1.0, 0.317_310_5),
            (1.96, 0.049_995_8),
            (3.0, 2.699_796e-3),
            (5.0, 5.733_031e-7),
        ] {
            assert!(
                (two_sided(z) / p - 1.0).abs() < 1e-5,
                "{z}: {}",
                two_sided(z)
            );
        }
    }
}
