//! From a fit to the outcome: moves, figures, tables, sentences.

use super::diagnose::diagnose;
use super::feet::{Effort, Foot, feet};
use super::fit::Fit;
use super::net::Sheet;
use super::outcome::{Active, Move, Outcome, Parametrisation, Slip, TradeOff};
use super::region::Region;
use super::springs::{Normal, gather};
use super::stiffness::fit_with;
use super::task::Task;
use super::tolerance::{Bounded, energy_of};
use crate::geometry::BSplineSurface;
use crate::methods::FitError;
use crate::methods::words::short;
use crate::solver::Control;
use rayon::prelude::*;

/// Factors of λ in the trade-off table.
const TRADES: [f64; 7] = [1e-3, 1e-2, 1e-1, 1.0, 1e1, 1e2, 1e3];
/// The same where a factor is dear.
const FEW_TRADES: [f64; 3] = [1e-2, 1.0, 1e2];
/// Order × half bandwidth² above which it is.
const DEAR: f64 = 5e7;
/// Points from which the table and the sheet "before" are made.
const TRADE_SAMPLE: usize = 5_000;
/// λ of the sheet "before", against the chosen one; the next where it has no
/// solution.
const BEFORE: [f64; 3] = [1e-6, 1e-4, 1e-2];
/// A point with less of the strongest pull is not holding the sheet.
const HOLDS: f64 = 1e-6;
/// Most steps to a foot.
const FOOT_STEPS: usize = 12;
/// Longest list of active points.
const MOST_ACTIVE: usize = 1000;

/// Everything that was found.
#[derive(Debug)]
pub(super) struct Found<'a> {
    pub(super) task: &'a Task,
    pub(super) fit: &'a Fit,
    pub(super) bounded: Option<&'a Bounded>,
    /// Of the points on the delivered sheet.
    pub(super) feet: Vec<Foot>,
    pub(super) parametrisation: Parametrisation,
    pub(super) region: &'a Region,
    pub(super) slips: Vec<Slip>,
}

/// The outcome.
///
/// # Errors
/// [`FitError::Stopped`]; [`FitError::Numerical`] if the surface is not
/// finite.
pub(super) fn outcome(found: Found, control: &dyn Control) -> Result<Outcome, FitError> {
    let (task, fit) = (found.task, found.fit);
    let sheet = found.bounded.map_or(&fit.sheet, |b| &b.sheet);
    control.progress("measuring", 88.0);
    let moves = moves(task, &found.feet);
    control.check()?;
    let normal = gather(&fit.sheet.net, &fit.sampled(&task.points, TRADE_SAMPLE));
    let before = before(task, fit, &normal).unwrap_or_else(|| fit.sheet.clone());
    let figures = |s: &Sheet| diagnose((s, &fit.energy), found.region, task);
    let (after, isophotes) = figures(sheet);
    let trade_off = trade_off(task, fit, &normal, control)?;
    let (outline, pieces) = found.region.outline();
    let square: f64 = moves.iter().map(|m| m.distance * m.distance).sum();
    let mut warnings = task.warnings.clone();
    if pieces > 1 {
        warnings.push(format!(
            "the points lie in {pieces} pieces with gaps between; the outline is that of the \
             largest, the surface spans them all"
        ));
    }
    let mut outcome = Outcome {
        within_tolerance: found.bounded.is_none_or(|b| b.worst <= 1.0),
        summary: Vec::new(),
        warnings,
        surface: surface(task, sheet)?,
        outline,
        parametrisation: found.parametrisation,
        move_max: moves.iter().fold(0.0, |m, x| m.max(x.distance.abs())),
        move_rms: (square / moves.len().max(1) as f64).sqrt(),
        moves,
        noise: fit.noise * task.frame.size,
        stiffness: found.bounded.is_none().then_some(fit.lambda),
        slips: found.slips,
        active: found.bounded.map_or_else(Vec::new, |b| active(task, b)),
        before: figures(&before).0,
        after,
        trade_off,
        isophotes,
    };
    outcome.summary = summary(&outcome, found.bounded);
    control.progress("done", 100.0);
    Ok(outcome)
}

/// The surface in the user's frame.
fn surface(task: &Task, sheet: &Sheet) -> Result<BSplineSurface, FitError> {
    let points = sheet
        .points_v_fastest()
        .iter()
        .map(|p| task.frame.to_user(&p.coords))
        .collect();
    BSplineSurface::from_knots(sheet.net.knots.clone(), points, None)
        .map_err(|e| FitError::Numerical(e.to_string()))
}

/// Feet of the points on a sheet, or their own places where they keep their
/// parameters.
///
/// # Errors
/// [`FitError::Stopped`].
pub(super) fn feet_of(
    task: &Task,
    (sheet, at): (&Sheet, &[[f64; 2]]),
    control: &dyn Control,
) -> Result<Vec<Foot>, FitError> {
    if task.slides() || task.held().is_some() {
        // Against a tolerance every digit counts.
        let effort = match task.tolerance {
            Some(_) => Effort::exact(FOOT_STEPS),
            None => Effort::listed(FOOT_STEPS),
        }
        .holding(task.held());
        return Ok(feet(sheet, (&task.points, at), effort, control)?);
    }
    let stay = |(p, at): (&nalgebra::Vector3<f64>, &[f64; 2])| {
        let tangents = sheet.tangents(*at);
        Foot {
            at: *at,
            sheet: tangents,
            offset: p - tangents.point,
        }
    };
    Ok(task.points.iter().zip(at).map(stay).collect())
}

fn moves(task: &Task, feet: &[Foot]) -> Vec<Move> {
    feet.par_iter()
        .zip(&task.index)
        .with_min_len(512)
        .map(|(foot, index)| Move {
            index: *index,
            now: task.frame.to_user(&foot.sheet.point),
            at: foot.at,
            distance: foot.signed() * task.frame.size,
        })
        .collect()
}

fn before(task: &Task, fit: &Fit, normal: &Normal<3>) -> Option<Sheet> {
    BEFORE
        .iter()
        .find_map(|f| fit_with(normal, &fit.energy, f * fit.lambda, fit.model))
        .map(|c| fit.with_held(&c.control, task.freedom))
}

fn trade_off(
    task: &Task,
    fit: &Fit,
    normal: &Normal<3>,
    control: &dyn Control,
) -> Result<Vec<TradeOff>, FitError> {
    let net = &fit.sheet.net;
    let dear = net.len() as f64 * (net.half_bandwidth() as f64).powi(2) > DEAR;
    let factors: &[f64] = if dear { &FEW_TRADES } else { &TRADES };
    let stride = task.points.len().div_ceil(TRADE_SAMPLE).max(1);
    let mut table = Vec::new();
    for factor in factors {
        control.check()?;
        let Some(c) = fit_with(normal, &fit.energy, factor * fit.lambda, fit.model) else {
            continue;
        };
        let sheet = fit.with_held(&c.control, task.freedom);
        let (mut largest, mut square, mut count) = (0.0_f64, 0.0, 0usize);
        for (p, at) in task.points.iter().zip(&fit.at).step_by(stride) {
            let t = sheet.tangents(*at);
            let offset = p - t.point;
            let across = t.normal().filter(|_| task.slides());
            let d = across.map_or(offset.norm(), |n| n.dot(&offset).abs());
            largest = largest.max(d);
            square += d * d;
            count += 1;
        }
        table.push(TradeOff {
            stiffness: factor * fit.lambda,
            move_max: largest * task.frame.size,
            move_rms: (square / count.max(1) as f64).sqrt() * task.frame.size,
            energy: energy_of(&sheet, &fit.energy, task.freedom),
        });
    }
    Ok(table)
}

/// Points that hold the sheet, strongest first.
fn active(task: &Task, bounded: &Bounded) -> Vec<Active> {
    let total: f64 = bounded.duals.iter().map(|d| d.abs()).sum();
    let strongest = bounded.duals.iter().fold(0.0_f64, |m, d| m.max(d.abs()));
    let mut active: Vec<Active> = bounded
        .duals
        .iter()
        .zip(&task.index)
        .filter(|(d, _)| d.abs() > HOLDS * strongest)
        .map(|(d, index)| Active {
            index: *index,
            pull_percent: -100.0 * d / total,
        })
        .collect();
    active.sort_by(|a, b| b.pull_percent.abs().total_cmp(&a.pull_percent.abs()));
    active.truncate(MOST_ACTIVE);
    active
}

/// How much was moved, in words: how the verdict begins.
pub(in super::super) fn moved(o: &Outcome) -> String {
    format!(
        "{} points, moved by at most {} (rms {})",
        o.moves.len(),
        short(o.move_max),
        short(o.move_rms)
    )
}

fn summary(o: &Outcome, bounded: Option<&Bounded>) -> Vec<String> {
    let moved = moved(o);
    let verdict = match bounded {
        None => format!(
            "{moved}; stiffness from the points' own noise, estimated as σ = {}.",
            short(o.noise)
        ),
        Some(b) if b.worst <= 1.0 => format!(
            "{moved}: within tolerance; {} points hold the surface back.",
            o.active.len()
        ),
        Some(b) => format!(
            "{moved}: outside tolerance, the worst point by a factor of {}; the points' noise \
             is about σ = {}, allow more or give more control points.",
            short(b.worst),
            short(o.noise)
        ),
    };
    let mut sentences = vec![verdict];
    if let Some(worst) = o.slips.first() {
        sentences.push(format!(
            "{} points look like slips, the worst {} off ({:.1} σ).",
            o.slips.len(),
            short(worst.off),
            worst.sigmas
        ));
    }
    sentences
}
