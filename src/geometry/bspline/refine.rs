//! Linear maps of control points that leave the shape alone: knot insertion
//! and degree elevation.
//!
//! A [`ControlMap`] works on points of any dimension, so that one map serves
//! curves, rows and columns of surfaces, and rational splines in homogeneous
//! coordinates.

use super::SplineError;
use super::deboor::blossom;
use super::knots::{Knots, MAX_DEGREE, span};
use nalgebra::SVector;

/// A linear map from the control points over one knot vector to those over
/// another, for the same spline.
pub(super) trait ControlMap {
    /// The knots that the mapped control points go with.
    fn target(&self) -> &Knots;
    /// Maps the control points of one curve.
    fn apply<const D: usize>(&self, points: &[SVector<f64, D>]) -> Vec<SVector<f64, D>>;
}

/// Insertion of knots: Piegl & Tiller A5.4 (RefineKnotVectCurve). Control
/// points whose knots do not change are copied bit by bit.
pub(super) struct Insertion {
    source: Knots,
    inserted: Vec<f64>,
    target: Knots,
}

impl Insertion {
    /// # Errors
    /// A knot that is not strictly inside the domain, or one that would occur
    /// more than `degree` times.
    pub fn new(source: &Knots, inserted: &[f64]) -> Result<Self, SplineError> {
        let domain = source.domain();
        // `!(…)` so that NaN is refused.
        if let Some(&parameter) = inserted
            .iter()
            .find(|t| !(**t > domain[0] && **t < domain[1]))
        {
            return Err(SplineError::OutsideDomain { parameter, domain });
        }
        let mut inserted = inserted.to_vec();
        inserted.sort_by(f64::total_cmp);
        let mut values = source.values().to_vec();
        values.extend_from_slice(&inserted);
        values.sort_by(f64::total_cmp);
        let target = Knots::new(source.degree(), values)?;
        Ok(Insertion {
            source: source.clone(),
            inserted,
            target,
        })
    }
}

impl ControlMap for Insertion {
    fn target(&self) -> &Knots {
        &self.target
    }

    fn apply<const D: usize>(&self, points: &[SVector<f64, D>]) -> Vec<SVector<f64, D>> {
        let (Some(&lowest), Some(&highest)) = (self.inserted.first(), self.inserted.last()) else {
            return points.to_vec();
        };
        let (p, old, new) = (
            self.source.degree(),
            self.source.values(),
            self.target.values(),
        );
        let added = self.inserted.len();
        let a = span(p, old, lowest);
        let b = span(p, old, highest) + 1;
        let mut out = vec![SVector::<f64, D>::zeros(); points.len() + added];
        out[..=a - p].copy_from_slice(&points[..=a - p]);
        out[b - 1 + added..].copy_from_slice(&points[b - 1..]);
        let mut i = b + p - 1;
        let mut k = b + p + added - 1;
        for &x in self.inserted.iter().rev() {
            while x <= old[i] && i > a {
                out[k - p - 1] = points[i - p - 1];
                k -= 1;
                i -= 1;
            }
            out[k - p - 1] = out[k - p];
            for l in 1..=p {
                let at = k - p + l;
                let (above, below) = (new[k + l] - x, x - old[i - p + l]);
                out[at - 1] = mix(out[at - 1], out[at], below, above);
            }
            k -= 1;
        }
        out
    }
}

/// `a` where `below` is zero, `b` where `above` is; in between their blend.
fn mix<const D: usize>(
    a: SVector<f64, D>,
    b: SVector<f64, D>,
    below: f64,
    above: f64,
) -> SVector<f64, D> {
    // A zero `above` is A5.4's own special case, also where `below` is zero.
    if above == 0.0 {
        return b;
    }
    let share = below / (below + above);
    if below <= above {
        a + (b - a) * share
    } else {
        b - (b - a) * (above / (below + above))
    }
}

/// Elevation of the degree by one. A new control point is the blossom of
/// degree `p + 1` at `p + 1` consecutive new knots, which is the mean of the
/// old blossom over all ways to leave one of them out (Ramshaw 1989). Every
/// distinct knot gains one multiplicity, so that smoothness is kept.
pub(super) struct Elevation {
    source: Knots,
    target: Knots,
}

impl Elevation {
    /// # Errors
    /// [`SplineError::Degree`] at [`MAX_DEGREE`].
    pub fn new(source: &Knots) -> Result<Self, SplineError> {
        let mut values = source.values().to_vec();
        values.extend(source.breakpoints());
        values.sort_by(f64::total_cmp);
        let target = Knots::new(source.degree() + 1, values)?;
        Ok(Elevation {
            source: source.clone(),
            target,
        })
    }

    /// The old span on which control point `i` of the target is computed: the
    /// widest below its basis function, where extrapolation is least.
    fn span_for(&self, i: usize) -> usize {
        let q = self.target.degree();
        let support = &self.target.values()[i..=i + q + 1];
        let mut best = (0.0, support[0]);
        for w in support.windows(2) {
            if w[1] - w[0] > best.0 {
                best = (w[1] - w[0], w[0]);
            }
        }
        self.source.span(best.1)
    }

    fn control_point<const D: usize>(
        &self,
        i: usize,
        points: &[SVector<f64, D>],
    ) -> SVector<f64, D> {
        let (p, q) = (self.source.degree(), self.target.degree());
        let k = self.span_for(i);
        let local = &points[k - p..=k];
        let arguments = &self.target.values()[i + 1..=i + q];
        let value = |skipped: usize| {
            let mut rest = [0.0; MAX_DEGREE + 1];
            let kept = arguments.iter().enumerate().filter(|(j, _)| *j != skipped);
            for (slot, (_, t)) in rest.iter_mut().zip(kept) {
                *slot = *t;
            }
            let mut work = [SVector::<f64, D>::zeros(); MAX_DEGREE + 1];
            work[..=p].copy_from_slice(local);
            blossom(self.source.values(), k, &rest[..p], &mut work[..=p])
        };
        let first = value(0);
        let sum: SVector<f64, D> = (1..q).fold(SVector::zeros(), |sum, j| sum + (value(j) - first));
        first + sum / q as f64
    }
}

impl ControlMap for Elevation {
    fn target(&self) -> &Knots {
        &self.target
    }

    fn apply<const D: usize>(&self, points: &[SVector<f64, D>]) -> Vec<SVector<f64, D>> {
        let last = self.target.control_count() - 1;
        (0..=last)
            .map(|i| match i {
                // The ends are the curve's own ends, to the bit.
                0 => points[0],
                i if i == last => points[points.len() - 1],
                i => self.control_point(i, points),
            })
            .collect()
    }
}
