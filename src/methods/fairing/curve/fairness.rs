//! How fair a curve is: figures and the curvature comb, measured on the curve
//! that is delivered, in the user's unit.

use super::outcome::{CombTooth, Fairness};
use crate::geometry::BSplineCurve;
use crate::geometry::bspline::{BasisTable, Pieces};
use crate::numerics::GaussLegendre;
use nalgebra::{Point3, Vector3};

/// Quadrature nodes a span: the integrands are not polynomial.
const NODES: usize = 12;
/// Samples of the curvature a span, for extrema and inflections.
const SAMPLES: usize = 16;
/// Samples at least.
const LEAST_SAMPLES: usize = 400;
/// Samples at most: beyond, a span gets fewer.
const MOST_SAMPLES: usize = 16_000;
/// Extrema count if the curvature turns back by this share of its range (or
/// of a twentieth of its greatest amount, if that is more).
const PROMINENT: f64 = 0.03;
/// Curvatures below this share of the greatest have no sign.
const SIGNLESS: f64 = 0.02;
/// Teeth of a comb.
const TEETH: usize = 240;

/// The differential geometry at one parameter.
struct Local {
    point: Point3<f64>,
    speed: f64,
    tangent: Vector3<f64>,
    /// d²r/ds².
    bend: Vector3<f64>,
    /// κ, signed if the curve is plane and its normal given.
    curvature: f64,
    /// |(d(d²r/ds²)/ds)_⊥|².
    variation: f64,
    torsion: f64,
}

/// A curve to be measured; `plane` is the unit normal of its plane, if any,
/// about which the curvature is positive.
pub(super) struct Gauge<'a> {
    domain: [f64; 2],
    pieces: Pieces<'a, 3>,
    plane: Option<Vector3<f64>>,
    closed: bool,
    spans: Vec<[f64; 2]>,
}

impl<'a> Gauge<'a> {
    /// Prepares a polynomial curve with the table of its basis; of a `closed`
    /// one extrema are counted around.
    pub(super) fn new(
        curve: &BSplineCurve,
        table: &'a BasisTable,
        plane: Option<Vector3<f64>>,
        closed: bool,
    ) -> Self {
        let breaks = curve.knot_vector().breakpoints();
        let spans = breaks.windows(2).map(|w| [w[0], w[1]]).collect();
        let points = curve.control_points();
        Gauge {
            domain: curve.domain(),
            pieces: table.pieces(|k| points[k].coords),
            plane,
            closed,
            spans,
        }
    }

    fn at(&self, u: f64) -> Local {
        let [point, d1, d2, d3] = self.pieces.jet::<4>(u);
        let q = d1.norm_squared().max(f64::MIN_POSITIVE);
        let speed = q.sqrt();
        let tangent = d1 / speed;
        let a = d1.dot(&d2) / q;
        let bend = (d2 - d1 * a) / q;
        let m = d3 - d2 * (3.0 * a);
        let change = (m - tangent * tangent.dot(&m)) / (q * speed);
        let binormal = d1.cross(&d2);
        let curvature = match self.plane {
            Some(normal) => normal.dot(&tangent.cross(&bend)),
            None => bend.norm(),
        };
        let area = binormal.norm_squared();
        // Torsion means nothing where the curve is straight to rounding.
        let torsion = if self.plane.is_none() && bend.norm() * speed > 1e-9 {
            binormal.dot(&d3) / area
        } else {
            0.0
        };
        Local {
            point: point.into(),
            speed,
            tangent,
            bend,
            curvature,
            variation: change.norm_squared(),
            torsion,
        }
    }

    /// All figures.
    pub(super) fn fairness(&self) -> Fairness {
        let rule = GaussLegendre::new(NODES);
        let (mut variation, mut bending, mut length) = (0.0, 0.0, 0.0);
        for [a, b] in &self.spans {
            for (u, w) in rule.on(*a, *b) {
                let l = self.at(u);
                variation += w * l.speed * l.variation;
                bending += w * l.speed * l.bend.norm_squared();
                length += w * l.speed;
            }
        }
        let curvatures = self.curvatures();
        let amount = curvatures.iter().fold(0.0_f64, |m, k| m.max(k.abs()));
        let high = curvatures.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let low = curvatures.iter().copied().fold(f64::INFINITY, f64::min);
        let range = (high - low).max(0.05 * amount);
        // A line or a circle has neither extrema nor inflections, only
        // rounding.
        let bent = amount * length > 1e-9;
        Fairness {
            curvature_variation: variation,
            bending,
            extrema: if bent {
                self.extrema(&curvatures, PROMINENT * range)
            } else {
                0
            },
            inflections: if bent && self.plane.is_some() {
                sign_changes(&curvatures, SIGNLESS * amount)
            } else {
                0
            },
            max_curvature: amount,
            length,
        }
    }

    /// Extrema, the one at which a closed curve is opened included.
    fn extrema(&self, curvatures: &[f64], h: f64) -> usize {
        let inside = extrema(curvatures, h);
        inside + usize::from(self.closed && inside > 0)
    }

    fn curvatures(&self) -> Vec<f64> {
        let wanted = (self.spans.len() * SAMPLES).clamp(LEAST_SAMPLES, MOST_SAMPLES);
        let each = wanted.div_ceil(self.spans.len()).max(2);
        let mut out = Vec::with_capacity(self.spans.len() * each);
        for [a, b] in &self.spans {
            for k in 0..each {
                let u = a + (b - a) * (k as f64 + 0.5) / each as f64;
                out.push(self.at(u).curvature);
            }
        }
        if self.closed {
            // From the greatest around to it again, which then counts once.
            let greatest = |a: &usize, b: &usize| out[*a].total_cmp(&out[*b]);
            let start = (0..out.len()).max_by(greatest).unwrap_or(0);
            out.rotate_left(start);
            out.extend(out.first().copied());
        }
        out
    }

    /// The comb: teeth at even parameters (near arc length), span ends
    /// included at both ends of the curve.
    pub(super) fn comb(&self) -> Vec<CombTooth> {
        let [a, b] = self.domain;
        let rule = GaussLegendre::new(NODES);
        let mut s = 0.0;
        let mut before = a;
        (0..=TEETH)
            .map(|k| {
                let u = a + (b - a) * k as f64 / TEETH as f64;
                s += rule.integrate(before, u, |u| self.at(u).speed);
                before = u;
                self.tooth(s, u)
            })
            .collect()
    }

    fn tooth(&self, s: f64, u: f64) -> CombTooth {
        let l = self.at(u);
        let normal = match self.plane {
            Some(plane) => plane.cross(&l.tangent),
            None if l.bend.norm() > 0.0 => l.bend.normalize(),
            None => Vector3::zeros(),
        };
        CombTooth {
            s,
            u,
            point: l.point,
            normal,
            curvature: l.curvature,
            torsion: l.torsion,
        }
    }
}

/// Local extrema that stand out by more than `h`.
fn extrema(values: &[f64], h: f64) -> usize {
    let Some(first) = values.first() else {
        return 0;
    };
    let (mut count, mut low, mut high, mut rising) = (0, *first, *first, None);
    for v in values {
        low = low.min(*v);
        high = high.max(*v);
        match rising {
            None if *v - low > h => (rising, high) = (Some(true), *v),
            None if high - *v > h => (rising, low) = (Some(false), *v),
            Some(true) if high - *v > h => {
                count += 1;
                (rising, low) = (Some(false), *v);
            }
            Some(false) if *v - low > h => {
                count += 1;
                (rising, high) = (Some(true), *v);
            }
            _ => {}
        }
        // Only the running extreme on the way counts.
        match rising {
            Some(true) => low = *v,
            Some(false) => high = *v,
            None => {}
        }
    }
    count
}

/// Changes of sign among values larger than `least`.
fn sign_changes(values: &[f64], least: f64) -> usize {
    let mut signs = values.iter().filter(|v| v.abs() > least).map(|v| *v > 0.0);
    let Some(mut before) = signs.next() else {
        return 0;
    };
    let mut count = 0;
    for sign in signs {
        count += usize::from(sign != before);
        before = sign;
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_waves_and_not_ripples() {
        let wave = |k: usize| (k as f64 * 0.02).sin() + 0.005 * (k as f64 * 0.9).sin();
        let values: Vec<f64> = (0..1000).map(wave).collect();
        // sin on [0, 20): 6 extrema, 6 zeros after the first.
        assert_eq!(extrema(&values, 0.06), 6);
        assert_eq!(sign_changes(&values, 0.02), 6);
        assert_eq!(extrema(&[], 0.1), 0);
        assert_eq!(sign_changes(&[0.0, 0.0], 0.1), 0);
    }
}
