//! How many control points: enough for the shape, as few as that.
//!
//! A few dozen points get a span each, so that the spline can pass through
//! them all. More points share spans; whether the spline is rich enough is
//! asked of the points themselves: in cells of a quarter span the mean
//! residual must not be more than noise (by the median) makes it. Where it is, spans double.
//! Where a tolerance asks for more, only the spans at the points that need it
//! are halved ([`split`]).

use super::energy::{add_outer, nodes};
use super::slips::spread;
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
/// Points farther off than this many deviations are no evidence of shape.
const FAR: f64 = 5.0;
/// Standard deviations that the sum over cells may exceed its expectation by.
const DEVIATES: f64 = 4.0;

/// Whether the residuals hang together more than noise does.
pub(super) fn misses_shape<const D: usize>(
    space: &Space,
    springs: &Springs<D>,
    residuals: &[Vector<D>],
) -> bool {
    let sizes: Vec<f64> = residuals.iter().map(Vector::norm).collect();
    let noise = spread::<D>(&sizes, &springs.weights);
    let [a, b] = space.domain();
    let cells = space.unknowns() * CELLS;
    let mut sums = vec![(Vector::<D>::zeros(), 0.0); cells];
    for ((u, e), w) in springs.feet.iter().zip(residuals).zip(&springs.weights) {
        let k = ((u - a) / (b - a) * cells as f64) as usize;
        let cell = &mut sums[k.min(cells - 1)];
        if *w > 0.0 && e.norm() < FAR * noise {
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

/// A space with the spans at the given parameters, and their neighbours,
/// halved; `None` if that would make too many or too short ones.
pub(super) fn split(space: &Space, at: &[f64]) -> Option<Space> {
    /// Shortest span as a share of the domain.
    const SHORTEST: f64 = 1e-5;
    let spans = space.spans();
    let mut marked = vec![false; spans.len()];
    for u in at {
        let k = spans.partition_point(|s| s[1] <= *u).min(spans.len() - 1);
        for m in &mut marked[k.saturating_sub(1)..(k + 2).min(spans.len())] {
            *m = true;
        }
    }
    let [a, b] = space.domain();
    let mut inner = space.inner_knots();
    let before = inner.len();
    for (s, _) in spans.iter().zip(&marked).filter(|(_, m)| **m) {
        if s[1] - s[0] > SHORTEST * (b - a) {
            inner.push(0.5 * (s[0] + s[1]));
        }
    }
    if inner.len() == before || inner.len() > MOST_SPANS {
        return None;
    }
    inner.sort_by(f64::total_cmp);
    let made = if space.is_closed() {
        Space::closed(space.degree(), [a, b], &inner)
    } else {
        Space::open(space.degree(), [a, b], &inner)
    };
    made.ok()
}

/// The coefficients in a richer space of the curve with coefficients `x`.
pub(super) fn transfer<const D: usize>(
    from: &Space,
    x: &[Vector<D>],
    to: &Space,
) -> Option<Vec<Vector<D>>> {
    let curve = from.pieces(x);
    project(to, |u| curve.point(u))
}

/// The coefficients of the curve nearest to another by least squares at
/// quadrature nodes: the same curve, if it lies in the space.
pub(super) fn project<const D: usize>(
    to: &Space,
    point: impl Fn(f64) -> Vector<D>,
) -> Option<Vec<Vector<D>>> {
    let mut matrix = to.matrix(1);
    let mut sums = vec![Vector::<D>::zeros(); to.unknowns()];
    for node in nodes(to) {
        let row = node.basis.values();
        add_outer(to, &mut matrix, node.basis.first, row, node.weight);
        let point = point(node.u);
        for (k, b) in row.iter().enumerate() {
            sums[to.unknown(node.basis.first + k)] += point * (node.weight * b);
        }
    }
    let factor = matrix.factor().ok()?;
    for c in 0..D {
        let mut column: Vec<f64> = sums.iter().map(|s| s[c]).collect();
        factor.solve_in_place(&mut column);
        sums.iter_mut().zip(&column).for_each(|(s, v)| s[c] = *v);
    }
    Some(sums)
}
