//! Surfaces put together from curves.

use super::{Axis, BSplineCurve, BSplineSurface, Knots, SplineError};

/// The surface whose control curves along `axis` are `rows`, in order of the
/// control points of the other direction, whose knots are `across`. Rows must
/// have equal knots, and all or none weights.
///
/// # Errors
/// Rows of different knots ([`SplineError::DomainsDiffer`]), or numbers that
/// do not fit `across`.
pub fn surface_from_rows(
    axis: Axis,
    rows: &[BSplineCurve],
    across: Knots,
) -> Result<BSplineSurface, SplineError> {
    let Some(first) = rows.first() else {
        return Err(SplineError::NoCurves);
    };
    let along = first.knot_vector().clone();
    if let Some(bad) = rows.iter().find(|r| *r.knot_vector() != along) {
        return Err(SplineError::DomainsDiffer {
            first: first.domain(),
            second: bad.domain(),
        });
    }
    let points: Vec<_> = rows
        .iter()
        .flat_map(|r| r.control_points().iter().copied())
        .collect();
    let rational = first.weights().is_some();
    let weights: Vec<f64> = rows
        .iter()
        .flat_map(|r| r.weights().unwrap_or_default())
        .copied()
        .collect();
    let count = along.control_count();
    let (points, weights, knots) = match axis {
        Axis::V => (points, weights, [across, along]),
        Axis::U => (
            transpose(&points, count),
            transpose(&weights, count),
            [along, across],
        ),
    };
    BSplineSurface::from_knots(knots, points, rational.then_some(weights))
}

/// From `row`-long rows to columns.
fn transpose<T: Copy>(items: &[T], row: usize) -> Vec<T> {
    (0..row)
        .flat_map(|j| items.iter().skip(j).step_by(row).copied())
        .collect()
}
