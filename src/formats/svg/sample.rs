//! Curves as polygons that look like them.

use crate::geometry::BSplineCurve;
use nalgebra::Point3;

/// Points along a curve, closely enough that their polygon looks like it, each
/// with its parameter.
pub(super) fn samples(curve: &BSplineCurve) -> Vec<(f64, Point3<f64>)> {
    /// Samples in a polynomial piece, unless there are very many pieces.
    const IN_A_PIECE: usize = 16;
    /// Samples in all: five on every millimetre of the page.
    const MOST: usize = 1400;
    let breakpoints = curve.knot_vector().breakpoints();
    let pieces = breakpoints.len().saturating_sub(1).max(1);
    let each = (MOST / pieces).clamp(1, IN_A_PIECE);
    let mut parameters = Vec::with_capacity(pieces * each + 1);
    for pair in breakpoints.windows(2) {
        let at = |i: usize| pair[0] + (pair[1] - pair[0]) * (i as f64 / each as f64);
        parameters.extend((0..each).map(at));
    }
    parameters.extend(breakpoints.last());
    parameters
        .into_iter()
        .map(|u| (u, curve.point(u)))
        .collect()
}
