//! How many control points: enough for the shape, as few as that.
//!
//! A few dozen points get a span each, so that the spline can pass through
//! them all. More points share spans; whether the spline is rich enough is
//! asked of the points themselves: in cells of a quarter span the mean
//! residual must not be more than noise makes it. Where it is, spans double.

use super::space::{Space, Vector};
use super::springs::Springs;

/// Spans up to which every interval between points gets one.
pub(super) const FIRST_SPANS: usize = 64;
/// Spans at most.
pub(super) const MOST_SPANS: usize = 4096;
/// Cells a span.
const CELLS: usize = 4;
/// Points a cell must have for its mean to say something.
const LEAST_IN_CELL: usize = 2;
/// Standard deviations that the sum over cells may exceed its expectation by.
const DEVIATES: f64 = 4.0;

/// Whether the residuals hang together more than noise does.
pub(super) fn misses_shape<const D: usize>(
    space: &Space,
    springs: &Springs<D>,
    residuals: &[Vector<D>],
    noise: f64,
) -> bool {
    let [a, b] = space.domain();
    let cells = space.unknowns() * CELLS;
    let mut sums = vec![(Vector::<D>::zeros(), 0.0); cells];
    for ((u, e), w) in springs.feet.iter().zip(residuals).zip(&springs.weights) {
        let k = ((u - a) / (b - a) * cells as f64) as usize;
        let cell = &mut sums[k.min(cells - 1)];
        if *w > 0.0 {
            cell.0 += e;
            cell.1 += 1.0;
        }
    }
    let (mut chi, mut count) = (0.0, 0.0);
    for (sum, n) in &sums {
        if *n >= LEAST_IN_CELL as f64 {
            chi += sum.norm_squared() / (n * noise * noise);
            count += (D - 1) as f64;
        }
    }
    count > 0.0 && chi > count + DEVIATES * (2.0 * count).sqrt()
}
