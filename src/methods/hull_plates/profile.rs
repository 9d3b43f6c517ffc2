//! A profile as the fit sees it: a cubic B-spline in unit scale, by arc
//! length.

use crate::geometry::{ArcLength, BSplineCurve, CurveJet};
use nalgebra::{Point3, Vector3};

/// A point of a profile with derivatives by arc-length fraction s.
#[derive(Debug, Clone, Copy)]
pub(super) struct Jet {
    pub(super) point: Point3<f64>,
    pub(super) d1: Vector3<f64>,
    pub(super) d2: Vector3<f64>,
    /// The curve's own parameter, and its derivatives by s.
    pub(super) parameter: f64,
    pub(super) speed: f64,
    pub(super) acceleration: f64,
}

/// A profile curve of length `length`, addressed by the fraction s ∈ [0, 1]
/// of its arc length.
#[derive(Debug, Clone)]
pub(super) struct Profile {
    pub(super) curve: BSplineCurve,
    arc: ArcLength,
    length: f64,
}

/// Below this speed (length of the derivative by parameter, against the
/// curve's length) the derivative by arc length is not taken.
const SLOWEST: f64 = 1e-9;

impl Profile {
    pub(super) fn new(curve: BSplineCurve) -> Self {
        let arc = ArcLength::new(&curve);
        let length = arc.total();
        Profile { curve, arc, length }
    }

    /// Arc length, unit scale.
    pub(super) fn length(&self) -> f64 {
        self.length
    }

    /// Arc-length fraction of a curve parameter.
    pub(super) fn fraction_of(&self, parameter: f64) -> f64 {
        self.arc.length_at(parameter) / self.length
    }

    /// Curve parameter of an arc-length fraction, clamped to the curve.
    pub(super) fn parameter_of(&self, s: f64) -> f64 {
        self.arc.parameter_at(s.clamp(0.0, 1.0) * self.length)
    }

    /// Point and derivatives at fraction `s`, limits from the right at kinks;
    /// beyond an end those of the end.
    pub(super) fn at(&self, s: f64) -> Jet {
        let parameter = self.parameter_of(s);
        self.by_fraction(parameter, &self.curve.derivatives(parameter))
    }

    /// da/ds where the derivative by parameter is `d1`.
    pub(super) fn rate(&self, d1: &Vector3<f64>) -> f64 {
        self.length / d1.norm().max(SLOWEST * self.length)
    }

    fn by_fraction(&self, parameter: f64, c: &CurveJet) -> Jet {
        let speed = self.rate(&c.d1);
        // a″ = −ℓ² (C′·C″)/|C′|⁴ with a′ = ℓ/|C′|.
        let acceleration = -speed.powi(4) * c.d1.dot(&c.d2) / (self.length * self.length);
        Jet {
            point: c.point,
            d1: c.d1 * speed,
            d2: c.d2 * (speed * speed) + c.d1 * acceleration,
            parameter,
            speed,
            acceleration,
        }
    }
}

/// A measure by which to place knots along [0, 1]: half of it even, half the
/// angle through which the given tangents turn, so that a sharp forefoot is
/// resolved as well as a flat run. Rises from 0 to 1 over `probes` steps.
pub(super) fn turning<const K: usize>(
    probes: usize,
    tangents: impl Fn(f64) -> [Vector3<f64>; K],
) -> Vec<f64> {
    let mut before = tangents(0.0);
    let mut turned = vec![0.0];
    for i in 1..=probes {
        let here = tangents(i as f64 / probes as f64);
        let turn: f64 = here.iter().zip(&before).map(|(a, b)| a.angle(b)).sum();
        turned.push(turned[i - 1] + turn);
        before = here;
    }
    let total = turned[probes].max(f64::MIN_POSITIVE);
    let even = |i: usize| i as f64 / probes as f64;
    turned
        .iter()
        .enumerate()
        .map(|(i, t)| 0.5 * (t / total + even(i)))
        .collect()
}

/// The places in [0, 1] that cut a rising measure, given at even places, into
/// `count` equal shares.
pub(super) fn even_shares(measure: &[f64], count: usize) -> Vec<f64> {
    let steps = (measure.len() - 1) as f64;
    let (low, high) = (measure[0], measure[measure.len() - 1]);
    let place = |i: usize| {
        let wanted = low + (high - low) * i as f64 / count as f64;
        let k = measure
            .partition_point(|m| *m < wanted)
            .clamp(1, measure.len() - 1);
        let (a, b) = (measure[k - 1], measure[k]);
        ((k - 1) as f64 + ((wanted - a) / (b - a)).clamp(0.0, 1.0)) / steps
    };
    let mut places: Vec<f64> = (0..=count).map(place).collect();
    places[0] = 0.0;
    places[count] = 1.0;
    places
}
