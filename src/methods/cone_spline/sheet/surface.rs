//! The exact rational surface of a patch.
//!
//! Rulings turn about the axis, so the point at λ runs on a circle whose centre
//! is p + λ r + (1 + gλ)(k n − g r)/W². Over the arc Δ, with h = W Δ/2, its
//! rational quadratic Bézier form has the middle point
//!
//! p_m + λ r_m + f (1 + gλ)(g r_m − k n_m), f = (sec h − 1)/W²,
//!
//! with the frame in the middle of the arc, and the middle weight cos h (Piegl &
//! Tiller, *The NURBS Book*, 7.3). Written with (1 − cos h)/h² nothing is
//! divided by W, so that cylinders and planes are no special cases.

use crate::geometry::cone::{Frame, Strain};
use crate::geometry::{BSplineSurface, SplineError};
use crate::numerics::sinc;
use nalgebra::Point3;
use std::f64::consts::FRAC_PI_2;

/// A patch from its first ruling over an arc, between two values of λ: degree
/// `[2, 1]`, rational, u the arc length at span ends, v = λ.
///
/// # Errors
/// No surface: an arc of no length, or no room between the two λ.
pub(super) fn exact(
    frame: &Frame,
    strain: Strain,
    length: f64,
    [low, high]: [f64; 2],
) -> Result<BSplineSurface, SplineError> {
    let spans = spans(strain, length);
    let step = length / spans as f64;
    let mut knots = vec![0.0; 3];
    let mut points: Vec<Point3<f64>> = [low, high].map(|l| frame.at(l)).to_vec();
    let mut weights = vec![1.0; 2];
    for span in 1..=spans {
        let end = if span == spans {
            length
        } else {
            step * span as f64
        };
        let half = 0.5 * strain.rate() * step;
        let middle = frame.carried(strain, end - 0.5 * step);
        // (1 − cos h)/h² = ½ sinc²(h/2).
        let f = 0.125 * step * step * sinc(0.5 * half).powi(2) / half.cos();
        let pull = f * (strain.g * middle.ruling - strain.k * middle.normal);
        points.extend([low, high].map(|l| middle.at(l) + strain.speed(l) * pull));
        weights.extend([half.cos(); 2]);
        let last = frame.carried(strain, end);
        points.extend([low, high].map(|l| last.at(l)));
        weights.extend([1.0; 2]);
        knots.extend(vec![end; if span == spans { 3 } else { 2 }]);
    }
    let along = vec![low, low, high, high];
    BSplineSurface::new([2, 1], [knots, along], points, Some(weights))
}

/// Spans of a patch: a quarter turn each keeps all weights above 0.7.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
fn spans(strain: Strain, length: f64) -> usize {
    (strain.rate() * length / FRAC_PI_2).ceil().max(1.0) as usize
}

/// The parameter u of an arc length on that surface.
///
/// On a rational quadratic arc with the weights 1, cos h, 1 the chords a and b to
/// its ends are as t : 1 − t, and a chord over the arc x is x sinc(W x/2).
pub(super) fn parameter(strain: Strain, length: f64, arc: f64) -> f64 {
    /// Nearer to an end than this share of the length a place is there.
    const ROUNDING: f64 = 1e-12;
    let spans = spans(strain, length);
    let step = length / spans as f64;
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // Saturates.
    let span = ((arc / step) as usize).min(spans - 1);
    let start = step * span as f64;
    let chord = |x: f64| x * sinc(0.5 * strain.rate() * x);
    let [a, b] = [arc - start, start + step - arc].map(chord);
    match arc / length {
        share if share < ROUNDING => 0.0,
        share if share > 1.0 - ROUNDING => length,
        _ => start + step * a / (a + b),
    }
}
