//! Curves given by evaluation, as cubic B-splines on one knot vector.
//!
//! On every smooth piece the complete cubic spline through the curves' points
//! (knots at the data, end derivatives given) is within O(h⁴) of them; knots
//! are halved where a rail is still off. Pieces are joined with inner knots of
//! multiplicity three, so that a kink or the apex of a fan stays exactly where
//! it is.

use super::FitError;
use crate::geometry::{BSplineCurve, SplineError, complete_cubic, join_c0};
use nalgebra::{Point3, Vector3};

/// From which side a curve is looked at where it has a kink.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Side {
    Left,
    Right,
}

/// A point with its derivative by the common parameter.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rail {
    pub(super) point: Point3<f64>,
    pub(super) d1: Vector3<f64>,
}

/// What is to be fitted, and how well.
pub(super) struct Pieces<'a> {
    /// Parameters between which the curves are smooth, ends included.
    pub(super) breaks: &'a [f64],
    /// Inner parameters at which knots help (knots of the curves themselves).
    pub(super) seeds: &'a [f64],
    /// Largest distance at equal parameter.
    pub(super) distance: f64,
    /// Largest angle between tangents, radians.
    pub(super) angle: f64,
    /// Evaluates all curves.
    pub(super) rails: &'a dyn Fn(f64, Side) -> [Rail; 2],
}

/// Spans of a piece to begin with, per unit of parameter.
const SPANS: f64 = 32.0;
/// Rounds of halving; the last one is kept as it is.
const ROUNDS: usize = 12;
/// Most knots of a piece.
const MOST_KNOTS: usize = 60_000;
/// Parameters nearer than this count as one.
const APART: f64 = 1e-7;
/// Where in a span the fit is compared, away from the knots that it passes.
const CHECKS: [f64; 3] = [0.25, 0.5, 0.75];
/// A tangent shorter than this (against the largest) has no direction to compare.
const SLOW: f64 = 1e-6;

/// Both curves as cubic splines on the same knots.
pub(super) fn fit_pair(pieces: &Pieces<'_>) -> Result<[BSplineCurve; 2], FitError> {
    let mut parts: [Vec<BSplineCurve>; 2] = [Vec::new(), Vec::new()];
    for range in pieces.breaks.windows(2) {
        let [a, b] = fit_piece(pieces, range[0], range[1]).map_err(broken)?;
        parts[0].push(a);
        parts[1].push(b);
    }
    let [a, b] = parts;
    Ok([join_c0(&a).map_err(broken)?, join_c0(&b).map_err(broken)?])
}

fn broken(e: SplineError) -> FitError {
    FitError::Numerical(format!("a boundary could not be written as a spline: {e}"))
}

fn fit_piece(pieces: &Pieces<'_>, start: f64, end: f64) -> Result<[BSplineCurve; 2], SplineError> {
    let mut knots = first_knots(pieces.seeds, start, end);
    for round in 0.. {
        let fitted = through(pieces, &knots)?;
        let off = spans_off(pieces, &fitted, &knots);
        if off.is_empty() || round == ROUNDS || knots.len() > MOST_KNOTS {
            return Ok(fitted);
        }
        for span in off.into_iter().rev() {
            knots.insert(span + 1, 0.5 * (knots[span] + knots[span + 1]));
        }
    }
    through(pieces, &knots)
}

fn first_knots(seeds: &[f64], start: f64, end: f64) -> Vec<f64> {
    let count = ((end - start) * SPANS).ceil().max(2.0) as usize;
    let even = (1..count).map(|i| start + (end - start) * i as f64 / count as f64);
    let mut inner: Vec<f64> = seeds.to_vec();
    // Seeds first: an even knot too near to one gives way.
    let near = 0.2 * (end - start) / count as f64;
    inner.extend(even.filter(|u| seeds.iter().all(|s| (s - u).abs() > near)));
    inner.retain(|u| *u > start + APART && *u < end - APART);
    inner.sort_by(f64::total_cmp);
    inner.dedup_by(|b, a| *b - *a < APART);
    let mut knots = vec![start];
    knots.extend(inner);
    knots.push(end);
    knots
}

fn side_of(u: f64, knots: &[f64]) -> Side {
    if u >= knots[knots.len() - 1] {
        Side::Left
    } else {
        Side::Right
    }
}

fn through(pieces: &Pieces<'_>, knots: &[f64]) -> Result<[BSplineCurve; 2], SplineError> {
    let rails: Vec<[Rail; 2]> = knots
        .iter()
        .map(|u| (pieces.rails)(*u, side_of(*u, knots)))
        .collect();
    let one = |k: usize| {
        let points: Vec<Point3<f64>> = rails.iter().map(|r| r[k].point).collect();
        complete_cubic(knots, &points, rails[0][k].d1, rails[rails.len() - 1][k].d1)
    };
    Ok([one(0)?, one(1)?])
}

/// Spans in which a curve is off, in order.
fn spans_off(pieces: &Pieces<'_>, fitted: &[BSplineCurve; 2], knots: &[f64]) -> Vec<usize> {
    let is_off = |u: f64| {
        let wanted = (pieces.rails)(u, Side::Right);
        fitted.iter().zip(&wanted).any(|(curve, rail)| {
            let jet = curve.derivatives(u);
            let apart = (jet.point - rail.point).norm();
            let slow = rail.d1.norm() < SLOW;
            apart > pieces.distance || (!slow && jet.d1.angle(&rail.d1) > pieces.angle)
        })
    };
    let span_off = |i: &usize| {
        let (a, b) = (knots[*i], knots[*i + 1]);
        b - a > APART && CHECKS.iter().any(|share| is_off(a + share * (b - a)))
    };
    (0..knots.len() - 1).filter(span_off).collect()
}
