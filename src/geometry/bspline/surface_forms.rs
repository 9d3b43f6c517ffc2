//! The same surface in another form: refined, raised, split, reversed; curves
//! on it; surfaces from curves and from grids of points.

use super::interpolate::solve_collocation;
use super::refine::{ControlMap, Elevation, Insertion};
use super::{Axis, BSplineCurve, BSplineSurface, Knots, Parametrization, SplineError};
use super::{interpolation_parameters, surface_from_rows};
use nalgebra::Point3;

impl BSplineSurface {
    /// The same surface with further knots in one direction.
    ///
    /// # Errors
    /// As [`BSplineCurve::insert_knots`].
    pub fn insert_knots(&self, axis: Axis, knots: &[f64]) -> Result<Self, SplineError> {
        self.mapped(axis, &Insertion::new(&self.knot_vector(axis), knots)?)
    }

    /// The same surface with one degree more in one direction.
    ///
    /// # Errors
    /// As [`BSplineCurve::elevated`].
    pub fn elevated(&self, axis: Axis) -> Result<Self, SplineError> {
        self.mapped(axis, &Elevation::new(&self.knot_vector(axis))?)
    }

    /// The parts before and after `parameter` in one direction.
    ///
    /// # Errors
    /// [`SplineError::OutsideDomain`] unless it is strictly inside.
    pub fn split(&self, axis: Axis, parameter: f64) -> Result<(Self, Self), SplineError> {
        let (mut left, mut right) = (Vec::new(), Vec::new());
        for curve in self.control_curves(axis) {
            let (a, b) = curve.split(parameter)?;
            left.push(a);
            right.push(b);
        }
        let across = self.knot_vector(other(axis));
        let left = surface_from_rows(axis, &left, across.clone())?;
        Ok((left, surface_from_rows(axis, &right, across)?))
    }

    /// The same surface run through the other way in one direction.
    ///
    /// # Errors
    /// None in practice; the parts are checked as they are put together.
    pub fn reversed(&self, axis: Axis) -> Result<Self, SplineError> {
        let rows: Vec<_> = self
            .control_curves(axis)
            .iter()
            .map(BSplineCurve::reversed)
            .collect();
        surface_from_rows(axis, &rows, self.knot_vector(other(axis)))
    }

    /// The curve `v ↦ S(u, v)` for a fixed `u`, or `u ↦ S(u, v)` for a fixed
    /// `v`: the curve *along* `along` at `at` in the other direction.
    ///
    /// # Errors
    /// None in practice; the curve is checked as it is put together.
    pub fn iso_curve(&self, along: Axis, at: f64) -> Result<BSplineCurve, SplineError> {
        let across = other(along);
        let mut points = Vec::new();
        let mut weights = Vec::new();
        for curve in self.control_curves(across) {
            points.push(curve.point(at));
            weights.push(curve.weight_at(at));
        }
        let rational = self.weights().is_some();
        BSplineCurve::from_knots(self.knot_vector(along), points, rational.then_some(weights))
    }

    /// The four boundary curves: `v = first`, `v = last` (along u), `u =
    /// first`, `u = last` (along v). Exact, to the bit of the control points.
    #[must_use]
    pub fn boundary_curves(&self) -> [BSplineCurve; 4] {
        let [n, m] = self.counts();
        [
            (Axis::U, 0),
            (Axis::U, m - 1),
            (Axis::V, 0),
            (Axis::V, n - 1),
        ]
        .map(|(along, fixed)| self.control_curve(along, fixed))
    }

    /// All control curves along one direction.
    fn control_curves(&self, along: Axis) -> Vec<BSplineCurve> {
        let count = self.counts()[other(along).index()];
        (0..count).map(|k| self.control_curve(along, k)).collect()
    }

    fn mapped(&self, axis: Axis, map: &impl ControlMap) -> Result<Self, SplineError> {
        let rows: Vec<_> = self
            .control_curves(axis)
            .iter()
            .map(|c| c.mapped(map))
            .collect();
        surface_from_rows(axis, &rows, self.knot_vector(other(axis)))
    }
}

fn other(axis: Axis) -> Axis {
    match axis {
        Axis::U => Axis::V,
        Axis::V => Axis::U,
    }
}

/// The surface through a grid of points, `counts` in u and v, `v` fastest, on
/// [0, 1]²: parameters averaged over the rows and over the columns, then two
/// rounds of curve interpolation (Piegl & Tiller A9.3, A9.4).
///
/// # Errors
/// A grid of the wrong size or too small for the degrees, repeated neighbours,
/// coordinates not finite.
pub fn interpolate_grid(
    points: &[Point3<f64>],
    counts: [usize; 2],
    degrees: [usize; 2],
    parametrization: Parametrization,
) -> Result<BSplineSurface, SplineError> {
    let [n, m] = counts;
    if points.len() != n * m || n < 2 || m < 2 {
        return Err(SplineError::ControlPointCount {
            given: points.len(),
            expected: n * m,
        });
    }
    let row = |i: usize| points[i * m..(i + 1) * m].to_vec();
    let column = |j: usize| (0..n).map(|i| points[i * m + j]).collect::<Vec<_>>();
    let u = mean_parameters((0..m).map(column), parametrization)?;
    let v = mean_parameters((0..n).map(row), parametrization)?;
    let knots = [
        Knots::averaged(degrees[0], &u)?,
        Knots::averaged(degrees[1], &v)?,
    ];
    let mut grid: Vec<[f64; 3]> = points.iter().map(|p| p.coords.into()).collect();
    for line in grid.chunks_mut(m) {
        solve_collocation(&knots[1], &v, line)?;
    }
    for j in 0..m {
        let mut line: Vec<[f64; 3]> = (0..n).map(|i| grid[i * m + j]).collect();
        solve_collocation(&knots[0], &u, &mut line)?;
        for (i, solved) in line.into_iter().enumerate() {
            grid[i * m + j] = solved;
        }
    }
    let control = grid.into_iter().map(Point3::from).collect();
    BSplineSurface::from_knots(knots, control, None)
}

/// The mean of the parameters of several lines of points.
fn mean_parameters(
    lines: impl Iterator<Item = Vec<Point3<f64>>>,
    parametrization: Parametrization,
) -> Result<Vec<f64>, SplineError> {
    let mut mean: Vec<f64> = Vec::new();
    let mut count = 0.0;
    for line in lines {
        let parameters = interpolation_parameters(&line, parametrization)?;
        count += 1.0;
        mean.resize(parameters.len(), 0.0);
        for (m, p) in mean.iter_mut().zip(parameters) {
            *m += (p - *m) / count;
        }
    }
    Ok(mean)
}
