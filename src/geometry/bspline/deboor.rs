//! De Boor's triangle with derivatives: the one evaluation kernel.
//!
//! Level `r` of the triangle blends neighbours of level `r − 1`. The last
//! levels before the apex hold the control points of the curve's own
//! lower-degree restriction, so that the derivatives at the apex are their
//! scaled divided differences (de Boor 1978, ch. X): two points give the
//! first, three the second, four the third derivative. Differences of equal
//! points are exactly zero, and a blend of equal points is exactly that point.

use super::knots::MAX_DEGREE;
use nalgebra::SVector;

/// Control points of one span, on the stack.
pub(super) type Local<const D: usize> = [SVector<f64, D>; MAX_DEGREE + 1];

/// Value and derivatives at one parameter.
#[derive(Debug, Clone, Copy)]
pub(super) struct Jet<const D: usize> {
    pub value: SVector<f64, D>,
    pub d1: SVector<f64, D>,
    pub d2: SVector<f64, D>,
    pub d3: SVector<f64, D>,
}

/// The blend of `a` (where `below` is zero) and `b` (where `above` is). Exact
/// for `a = b` and at the end that it starts from: `b` if `MIRRORED`.
#[inline(always)]
fn blend<const D: usize, const MIRRORED: bool>(
    a: SVector<f64, D>,
    b: SVector<f64, D>,
    below: f64,
    above: f64,
) -> SVector<f64, D> {
    let width = below + above;
    if MIRRORED {
        b - (b - a) * (above / width)
    } else {
        a + (b - a) * (below / width)
    }
}

/// Runs the triangle, with derivatives up to `ORDER` (the others are zero), for the span `span` (a nonempty one) at `u`, on its
/// `degree + 1` control points, which are overwritten.
#[inline]
pub(super) fn jet<const D: usize, const ORDER: usize>(
    degree: usize,
    knots: &[f64],
    span: usize,
    u: f64,
    points: &mut Local<D>,
) -> Jet<D> {
    let t = &knots[span + 1 - degree..=span + degree];
    // At the right end of the span (a limit from the left, the end of the
    // curve) the blends start from the right, to be exact there.
    let mirrored = u >= t[degree];
    // Constant degrees unroll; those are the ones that plates use.
    match (degree, mirrored) {
        (1, false) => triangle::<D, ORDER, false>(1, t, u, points),
        (2, false) => triangle::<D, ORDER, false>(2, t, u, points),
        (3, false) => triangle::<D, ORDER, false>(3, t, u, points),
        (_, false) => triangle::<D, ORDER, false>(degree, t, u, points),
        (_, true) => triangle::<D, ORDER, true>(degree, t, u, points),
    }
}

/// `t` are the `2p` knots around the span; the span is `t[p−1]..t[p]`.
#[inline(always)]
fn triangle<const D: usize, const ORDER: usize, const MIRRORED: bool>(
    p: usize,
    t: &[f64],
    u: f64,
    d: &mut Local<D>,
) -> Jet<D> {
    let t = &t[..2 * p];
    let zero = SVector::<f64, D>::zeros();
    let mut jet = Jet {
        value: zero,
        d1: zero,
        d2: zero,
        d3: zero,
    };
    for r in 1..=p {
        match p + 1 - r {
            3 if ORDER >= 3 => jet.d3 = third(p, t, d),
            2 if ORDER >= 2 => jet.d2 = second(p, t, d),
            1 if ORDER >= 1 => jet.d1 = (d[p] - d[p - 1]) * (p as f64 / (t[p] - t[p - 1])),
            _ => {}
        }
        for j in (r..=p).rev() {
            d[j] = blend::<D, MIRRORED>(d[j - 1], d[j], u - t[j - 1], t[j + p - r] - u);
        }
    }
    jet.value = d[p];
    jet
}

/// The second derivative from the last three points `d[p−2..=p]`.
#[inline(always)]
fn second<const D: usize>(p: usize, t: &[f64], d: &Local<D>) -> SVector<f64, D> {
    let a = (d[p - 1] - d[p - 2]) / (t[p] - t[p - 2]);
    let b = (d[p] - d[p - 1]) / (t[p + 1] - t[p - 1]);
    (b - a) * ((p * (p - 1)) as f64 / (t[p] - t[p - 1]))
}

/// The third derivative from the last four points `d[p−3..=p]`.
#[inline(always)]
fn third<const D: usize>(p: usize, t: &[f64], d: &Local<D>) -> SVector<f64, D> {
    let a = |j: usize| (d[p - 2 + j] - d[p - 3 + j]) / (t[p + j] - t[p - 3 + j]);
    let b = |j: usize| (a(j + 1) - a(j)) / (t[p + j] - t[p - 2 + j]);
    (b(1) - b(0)) * ((p * (p - 1) * (p - 2)) as f64 / (t[p] - t[p - 1]))
}

/// The blossom (polar form) of the span's polynomial at `degree` arguments:
/// the triangle with another parameter at each level (Ramshaw 1989). The
/// `degree + 1` control points are overwritten.
pub(super) fn blossom<const D: usize>(
    knots: &[f64],
    span: usize,
    arguments: &[f64],
    d: &mut [SVector<f64, D>],
) -> SVector<f64, D> {
    let p = arguments.len();
    let t = &knots[span + 1 - p..=span + p];
    for r in 1..=p {
        let u = arguments[r - 1];
        for j in (r..=p).rev() {
            let (low, high) = (t[j - 1], t[j + p - r]);
            d[j] = extrapolate(
                d[j - 1],
                d[j],
                (u - low) / (high - low),
                (high - u) / (high - low),
            );
        }
    }
    d[p]
}

/// As [`blend`], for parameters that may lie outside: `x + y = 1`.
fn extrapolate<const D: usize>(
    a: SVector<f64, D>,
    b: SVector<f64, D>,
    x: f64,
    y: f64,
) -> SVector<f64, D> {
    if x.abs() <= y.abs() {
        a + (b - a) * x
    } else {
        b - (b - a) * y
    }
}
