//! Curves through points.
//!
//! Parameters from the points (chord length or centripetal; Piegl & Tiller
//! eqs. 9.4–9.6), averaged knots ([`Knots::averaged`]), and one banded system
//! for the control points: linear in the number of points. This is the curve
//! of Zheng & Bo 2018, eqs. 1 and 2.
//!
//! Limits: points are taken as given; nothing is smoothed.

use super::basis::{basis_jet, basis_jet_in_span};
use super::knots::check_increasing;
use super::{BSplineCurve, Knots, SplineError};
use crate::numerics::BandedMatrix;
use nalgebra::{Point3, Vector3};

/// How interpolation parameters follow from the points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Parametrization {
    /// Steps in proportion to the distances between neighbours.
    #[default]
    ChordLength,
    /// Steps in proportion to the roots of the distances (Lee 1989): tamer
    /// where the spacing changes sharply.
    Centripetal,
    /// Equal steps.
    Uniform,
}

/// The parameters of the points, from exactly 0 to exactly 1, increasing.
///
/// # Errors
/// Fewer than two points, a coordinate that is not finite, or a point that
/// repeats the one before it (to rounding of the parameter).
pub fn interpolation_parameters(
    points: &[Point3<f64>],
    parametrization: Parametrization,
) -> Result<Vec<f64>, SplineError> {
    if points.len() < 2 {
        return Err(SplineError::TooFewPoints {
            given: points.len(),
            needed: 2,
        });
    }
    if let Some(index) = points.iter().position(|p| !p.iter().all(|x| x.is_finite())) {
        return Err(SplineError::PointNotFinite { index });
    }
    if let Some(k) = points.windows(2).position(|w| w[0] == w[1]) {
        return Err(SplineError::RepeatedPoint { index: k + 1 });
    }
    let mut sums = vec![0.0];
    let mut sum = 0.0;
    for (k, w) in points.windows(2).enumerate() {
        let chord = (w[1] - w[0]).norm();
        if !chord.is_finite() {
            // The coordinates are finite, but too large to take a distance.
            return Err(SplineError::PointNotFinite { index: k + 1 });
        }
        sum += match parametrization {
            Parametrization::ChordLength => chord,
            Parametrization::Centripetal => chord.sqrt(),
            Parametrization::Uniform => 1.0,
        };
        sums.push(sum);
    }
    let parameters: Vec<f64> = sums.iter().map(|s| s / sum).collect();
    match parameters.windows(2).position(|w| w[1] <= w[0]) {
        Some(k) => Err(SplineError::RepeatedPoint { index: k + 1 }),
        None => Ok(parameters),
    }
}

/// The curve of the given degree through the points, on [0, 1]. With fewer
/// than `degree + 1` points the polynomial through all of them, raised to the
/// degree: two points give the straight line at constant speed.
///
/// # Errors
/// Those of [`interpolation_parameters`], and a degree out of range.
pub fn interpolate(
    points: &[Point3<f64>],
    degree: usize,
    parametrization: Parametrization,
) -> Result<BSplineCurve, SplineError> {
    let parameters = interpolation_parameters(points, parametrization)?;
    interpolate_at(&parameters, points, degree)
}

/// As [`interpolate`] with the caller's parameters, which become the domain.
///
/// # Errors
/// Parameters that do not increase or are not as many as the points, a degree
/// out of range, coordinates not finite.
pub fn interpolate_at(
    parameters: &[f64],
    points: &[Point3<f64>],
    degree: usize,
) -> Result<BSplineCurve, SplineError> {
    if points.len() != parameters.len() || points.len() < 2 {
        let needed = parameters.len().max(2);
        return Err(SplineError::TooFewPoints {
            given: points.len(),
            needed,
        });
    }
    let reachable = degree.min(points.len() - 1);
    let knots = Knots::averaged(reachable, parameters)?;
    let mut rhs: Vec<[f64; 3]> = points.iter().map(|p| p.coords.into()).collect();
    solve_collocation(&knots, parameters, &mut rhs)?;
    let mut control: Vec<Point3<f64>> = rhs.into_iter().map(Point3::from).collect();
    // The end rows are units, so that this only undoes rounding.
    let last = points.len() - 1;
    (control[0], control[last]) = (points[0], points[last]);
    BSplineCurve::from_knots(knots, control, None)?.elevated_to(degree)
}

/// Replaces values at the parameters by the control values of the spline that
/// takes them.
pub(super) fn solve_collocation<const K: usize>(
    knots: &Knots,
    parameters: &[f64],
    values: &mut [[f64; K]],
) -> Result<(), SplineError> {
    let rows: Vec<_> = parameters
        .iter()
        .map(|u| basis_jet::<1>(knots, *u))
        .collect();
    let (mut lower, mut upper) = (0, 0);
    for (i, row) in rows.iter().enumerate() {
        for (j, _) in nonzeros(row.first, row.values()) {
            lower = lower.max(i.saturating_sub(j));
            upper = upper.max(j.saturating_sub(i));
        }
    }
    let mut matrix = BandedMatrix::new(rows.len(), lower, upper);
    for (i, row) in rows.iter().enumerate() {
        for (j, v) in nonzeros(row.first, row.values()) {
            matrix.add(i, j, v);
        }
    }
    let factor = matrix
        .factor()
        .map_err(|e| SplineError::SingularInterpolation { row: e.column })?;
    factor.solve_in_place(values);
    Ok(())
}

fn nonzeros(first: usize, values: &[f64]) -> impl Iterator<Item = (usize, f64)> + '_ {
    values
        .iter()
        .enumerate()
        .filter(|(_, v)| **v != 0.0)
        .map(move |(j, v)| (first + j, *v))
}

/// The C² cubic with knots at the given parameters through all points, with
/// the given first derivatives at its ends (the "complete" or clamped cubic
/// spline; de Boor 1978, ch. IV).
///
/// # Errors
/// Fewer than two points, another number of parameters, parameters that do
/// not increase, coordinates or derivatives not finite.
pub fn complete_cubic(
    parameters: &[f64],
    points: &[Point3<f64>],
    d_start: Vector3<f64>,
    d_end: Vector3<f64>,
) -> Result<BSplineCurve, SplineError> {
    let m = points.len();
    if m != parameters.len() || m < 2 {
        return Err(SplineError::TooFewPoints {
            given: m,
            needed: parameters.len().max(2),
        });
    }
    check_increasing(parameters)?;
    let knots = Knots::clamped(3, [parameters[0], parameters[m - 1]], &parameters[1..m - 1])?;
    let mut control = vec![points[0]; m + 2];
    control[1] = points[0] + d_start * ((parameters[1] - parameters[0]) / 3.0);
    control[m] = points[m - 1] - d_end * ((parameters[m - 1] - parameters[m - 2]) / 3.0);
    control[m + 1] = points[m - 1];
    if m > 2 {
        complete_cubic_inner(&knots, parameters, points, &mut control)?;
    }
    BSplineCurve::from_knots(knots, control, None)
}

/// The tridiagonal system for the control points `2..m`: at its own simple
/// knot three basis functions act.
fn complete_cubic_inner(
    knots: &Knots,
    parameters: &[f64],
    points: &[Point3<f64>],
    control: &mut [Point3<f64>],
) -> Result<(), SplineError> {
    let m = points.len();
    let mut matrix = BandedMatrix::new(m - 2, 1, 1);
    let mut rhs: Vec<[f64; 3]> = Vec::with_capacity(m - 2);
    for i in 1..m - 1 {
        let row = basis_jet_in_span::<1>(knots, i + 3, parameters[i]);
        let mut value = points[i].coords;
        for (j, v) in row.values()[..3].iter().enumerate() {
            match row.first + j {
                known if known == 1 || known == m => value -= control[known].coords * *v,
                unknown => matrix.add(i - 1, unknown - 2, *v),
            }
        }
        rhs.push(value.into());
    }
    let factor = matrix
        .factor()
        .map_err(|e| SplineError::SingularInterpolation { row: e.column })?;
    factor.solve_in_place(&mut rhs);
    for (slot, solved) in control[2..m].iter_mut().zip(rhs) {
        *slot = solved.into();
    }
    Ok(())
}

#[cfg(test)]
mod tests;
