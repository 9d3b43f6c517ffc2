//! Parameters of stations and waterlines, and the monotone splines x(u), z(v)
//! that put them exactly in their planes.
//!
//! Parameters are mean distances along the hull, so that they are wide where
//! stations crowd and where the bottom runs nearly level. If the spline
//! through such parameters were not monotone they are drawn towards the
//! places themselves, for which it is a straight line.

use crate::geometry::{BSplineCurve, Knots, SplineError, basis_jet, gram};
use crate::methods::FitError;
use crate::numerics::EnvelopeMatrix;
use nalgebra::Point3;

/// Steps from the distances to the places.
const BLENDS: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];
/// Least slope anywhere, as share of the mean slope.
const LEAST_SLOPE: f64 = 0.05;
/// Samples of the slope a span.
const SAMPLES: usize = 4;
/// Weights of the energy against the data, both at the balance of traces: the
/// next where the one before leaves nothing to divide by, and most corrections
/// that then take the misfit to rounding.
const ENERGY: [(f64, usize); 3] = [(1e-8, 4), (1e-6, 20), (1e-4, 100)];
/// How far the net goes past the outermost lines, in steps.
const PAST: f64 = 0.25;
/// Misfit that is rounding, as share of the extent.
const MET: f64 = 1e-15;

/// One family of lines.
#[derive(Debug, Clone)]
pub(super) struct Lines {
    pub(super) knots: Knots,
    /// Parameter of each line.
    pub(super) at: Vec<f64>,
    /// Control values of the place as a function of the parameter.
    pub(super) control: Vec<f64>,
}

/// Lines at given places (increasing) with steps along the hull between them.
///
/// # Errors
/// [`FitError::Numerical`] where no spline can be made.
pub(super) fn lines(places: &[f64], steps: &[f64], degree: usize) -> Result<Lines, FitError> {
    let extent = places[places.len() - 1] - places[0];
    let length: f64 = steps.iter().sum();
    for blend in BLENDS {
        let mut at = vec![0.0];
        for (k, s) in steps.iter().enumerate() {
            let own = (places[k + 1] - places[k]) / extent * length;
            at.push(at[k] + (1.0 - blend) * s + blend * own);
        }
        let lines = through(places, at, degree)?;
        if monotone(&lines, places) {
            return Ok(lines);
        }
    }
    Err(FitError::Numerical(
        "the lines have no monotone parameters".into(),
    ))
}

fn through(places: &[f64], at: Vec<f64>, degree: usize) -> Result<Lines, FitError> {
    let numerical = |e: &dyn std::fmt::Display| FitError::Numerical(e.to_string());
    let last = at.len() - 1;
    let domain = [
        at[0] - PAST * (at[1] - at[0]),
        at[last] + PAST * (at[last] - at[last - 1]),
    ];
    let knots = Knots::clamped(degree, domain, &at[1..last]).map_err(|e| numerical(&e))?;
    let order = degree.min(at.len()).min(4);
    let mut matrix = EnvelopeMatrix::banded(knots.control_count(), degree);
    let rows: Vec<_> = at.iter().map(|u| basis_jet::<1>(&knots, *u)).collect();
    for row in &rows {
        matrix.add_outer(row.first, row.values(), 1.0);
    }
    let energy = gram(&knots, order);
    let trace = |m: &EnvelopeMatrix| m.diagonal().sum::<f64>();
    let balance = trace(&matrix) / trace(&energy).max(f64::MIN_POSITIVE);
    let mut factor = Err(FitError::Numerical("no weight of the energy".into()));
    let mut corrections = 0;
    for (weight, most) in ENERGY {
        let mut sum = matrix.clone();
        sum.add_scaled(&energy, weight * balance);
        factor = sum.factor().map_err(|e| numerical(&e));
        corrections = most;
        if factor.is_ok() {
            break;
        }
    }
    let factor = factor?;
    let extent = places[last] - places[0];
    let mut control = vec![0.0; knots.control_count()];
    for _ in 0..corrections {
        let mut rhs = vec![0.0; control.len()];
        let mut misfit = 0.0_f64;
        for (row, x) in rows.iter().zip(places) {
            let away = x - dot(row.values(), &control[row.first..]);
            misfit = misfit.max(away.abs());
            for (k, b) in row.values().iter().enumerate() {
                rhs[row.first + k] += b * away;
            }
        }
        if misfit <= MET * extent {
            break;
        }
        // The energy pulls back what was reached already.
        factor.solve_in_place(&mut rhs);
        for (c, d) in control.iter_mut().zip(&rhs) {
            *c += d;
        }
    }
    Ok(Lines { knots, at, control })
}

impl Lines {
    /// The same places with room for a knuckle at some of the lines: knots are
    /// inserted until only continuity is left.
    ///
    /// # Errors
    /// [`FitError::Numerical`] for the first or last line.
    pub(super) fn creased(self, knuckles: &[usize]) -> Result<Self, FitError> {
        let numerical = |e: SplineError| FitError::Numerical(e.to_string());
        let degree = self.knots.degree();
        let lacking = |u: f64| degree.saturating_sub(self.knots.multiplicity(u));
        let inserted: Vec<f64> = knuckles
            .iter()
            .flat_map(|k| std::iter::repeat_n(self.at[*k], lacking(self.at[*k])))
            .collect();
        if inserted.is_empty() {
            return Ok(self);
        }
        let points = self.control.iter().map(|x| Point3::new(*x, 0.0, 0.0));
        let line = BSplineCurve::from_knots(self.knots, points.collect(), None);
        let line = line.map_err(numerical)?;
        let line = line.insert_knots(&inserted).map_err(numerical)?;
        Ok(Lines {
            knots: line.knot_vector().clone(),
            at: self.at,
            control: line.control_points().iter().map(|p| p.x).collect(),
        })
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Whether the place grows with the parameter everywhere, and the lines lie
/// where they should.
fn monotone(lines: &Lines, places: &[f64]) -> bool {
    let last = places.len() - 1;
    let extent = places[last] - places[0];
    let mean = extent / (lines.at[last] - lines.at[0]);
    let met = lines.at.iter().zip(places).all(|(u, x)| {
        let row = basis_jet::<1>(&lines.knots, *u);
        (dot(row.values(), &lines.control[row.first..]) - x).abs() <= 1e-9 * extent
    });
    let breaks = lines.knots.breakpoints();
    let rises = breaks.windows(2).all(|w| {
        (0..=SAMPLES).all(|k| {
            let u = w[0] + (w[1] - w[0]) * k as f64 / SAMPLES as f64;
            let row = basis_jet::<2>(&lines.knots, u);
            dot(row.derivative(1), &lines.control[row.first..]) >= LEAST_SLOPE * mean
        })
    });
    met && rises
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_lie_in_their_planes_even_where_they_crowd() {
        let places = [0.0, 0.1, 0.2, 1.0, 2.0, 3.0, 3.05];
        let steps = [0.5, 0.3, 0.9, 1.0, 1.1, 0.4];
        let lines = lines(&places, &steps, 5).expect("monotone");
        assert!(monotone(&lines, &places));
    }
}
