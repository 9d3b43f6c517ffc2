//! B-spline curves in space, polynomial or rational: construction and
//! evaluation. Changes of form are in `curve_forms`.

use super::SplineError;
use super::deboor::{Jet, Local, jet};
use super::knots::{Knots, MAX_DEGREE, span, span_left};
use crate::geometry::BoundingBox;
use nalgebra::{Point3, SVector, Vector3};

/// A B-spline curve. Invariants: knots as in [`Knots`]; one finite control
/// point per basis function; weights, where there are any, positive and finite.
#[derive(Debug, Clone, PartialEq)]
pub struct BSplineCurve {
    knots: Knots,
    control_points: Vec<Point3<f64>>,
    weights: Option<Vec<f64>>,
}

/// Point and derivatives at one parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurveJet {
    /// The point.
    pub point: Point3<f64>,
    /// First derivative with respect to the parameter.
    pub d1: Vector3<f64>,
    /// Second derivative.
    pub d2: Vector3<f64>,
}

impl BSplineCurve {
    /// A curve from its knots (multiplicities written out), control points and
    /// weights (`None`: polynomial).
    ///
    /// # Errors
    /// The first broken rule: those of [`Knots::new`], then the counts and
    /// values of control points and weights.
    pub fn new(
        degree: usize,
        knots: Vec<f64>,
        control_points: Vec<Point3<f64>>,
        weights: Option<Vec<f64>>,
    ) -> Result<Self, SplineError> {
        Self::from_knots(Knots::new(degree, knots)?, control_points, weights)
    }

    /// As [`BSplineCurve::new`], with knots that are already checked.
    ///
    /// # Errors
    /// Counts and values of control points and weights.
    pub fn from_knots(
        knots: Knots,
        control_points: Vec<Point3<f64>>,
        weights: Option<Vec<f64>>,
    ) -> Result<Self, SplineError> {
        check_control(knots.control_count(), &control_points, weights.as_deref())?;
        Ok(BSplineCurve {
            knots,
            control_points,
            weights,
        })
    }

    /// The straight segment from `a` to `b` on [0, 1], of any degree, run
    /// through at constant speed.
    ///
    /// # Errors
    /// Degree out of range, coordinates not finite.
    pub fn line(a: Point3<f64>, b: Point3<f64>, degree: usize) -> Result<Self, SplineError> {
        let knots = Knots::clamped(degree, [0.0, 1.0], &[])?;
        let at = |i: usize| match i {
            i if i == degree => b,
            i => a + (b - a) * (i as f64 / degree as f64),
        };
        Self::from_knots(knots, (0..=degree).map(at).collect(), None)
    }

    /// Degree.
    #[must_use]
    pub fn degree(&self) -> usize {
        self.knots.degree()
    }

    /// Knot vector, multiplicities written out.
    #[must_use]
    pub fn knots(&self) -> &[f64] {
        self.knots.values()
    }

    /// The checked knot vector.
    #[must_use]
    pub fn knot_vector(&self) -> &Knots {
        &self.knots
    }

    /// Control points.
    #[must_use]
    pub fn control_points(&self) -> &[Point3<f64>] {
        &self.control_points
    }

    /// Weights of a rational curve.
    #[must_use]
    pub fn weights(&self) -> Option<&[f64]> {
        self.weights.as_deref()
    }

    /// First and last parameter.
    #[must_use]
    pub fn domain(&self) -> [f64; 2] {
        self.knots.domain()
    }

    /// First point of the curve (its first control point).
    #[must_use]
    pub fn start(&self) -> Point3<f64> {
        self.control_points[0]
    }

    /// Last point of the curve (its last control point).
    #[must_use]
    pub fn end(&self) -> Point3<f64> {
        self.control_points[self.control_points.len() - 1]
    }

    /// The point at `u`; outside the domain that at the nearer end.
    #[must_use]
    pub fn point(&self, u: f64) -> Point3<f64> {
        let u = self.clamp(u);
        let span = span(self.degree(), &self.knots, u);
        self.evaluate::<0>(span, u).0.point
    }

    /// Point, first and second derivative at `u`: right-sided at inner knots,
    /// left-sided at the end.
    #[must_use]
    pub fn derivatives(&self, u: f64) -> CurveJet {
        let u = self.clamp(u);
        self.evaluate::<2>(span(self.degree(), &self.knots, u), u).0
    }

    /// The same as a limit from the left (right-sided at the start).
    #[must_use]
    pub fn derivatives_left(&self, u: f64) -> CurveJet {
        let u = self.clamp(u);
        self.evaluate::<2>(span_left(self.degree(), &self.knots, u), u)
            .0
    }

    /// Third derivative at `u`, right-sided at inner knots.
    #[must_use]
    pub fn derivative3(&self, u: f64) -> Vector3<f64> {
        let u = self.clamp(u);
        self.evaluate::<3>(span(self.degree(), &self.knots, u), u).1
    }

    /// Third derivative at `u` as a limit from the left.
    #[must_use]
    pub fn derivative3_left(&self, u: f64) -> Vector3<f64> {
        let u = self.clamp(u);
        self.evaluate::<3>(span_left(self.degree(), &self.knots, u), u)
            .1
    }

    fn clamp(&self, u: f64) -> f64 {
        let [a, b] = self.domain();
        u.clamp(a, b)
    }

    /// Point and derivatives up to `ORDER` in one span; the others are zero.
    #[inline]
    fn evaluate<const ORDER: usize>(&self, span: usize, u: f64) -> (CurveJet, Vector3<f64>) {
        let p = self.degree();
        let points = &self.control_points[span - p..=span];
        match &self.weights {
            None => {
                let mut local: Local<3> = [SVector::zeros(); MAX_DEGREE + 1];
                for (slot, point) in local.iter_mut().zip(points) {
                    *slot = point.coords;
                }
                let j = jet::<3, ORDER>(p, &self.knots, span, u, &mut local);
                (
                    CurveJet {
                        point: j.value.into(),
                        d1: j.d1,
                        d2: j.d2,
                    },
                    j.d3,
                )
            }
            Some(weights) => {
                self.evaluate_rational::<ORDER>(span, u, points, &weights[span - p..=span])
            }
        }
    }

    /// In homogeneous coordinates about the nearer of the span's end control
    /// points: a run of equal points then has derivatives exactly zero, and
    /// far-off coordinates lose no digits.
    fn evaluate_rational<const ORDER: usize>(
        &self,
        span: usize,
        u: f64,
        points: &[Point3<f64>],
        weights: &[f64],
    ) -> (CurveJet, Vector3<f64>) {
        let p = self.degree();
        let second_half = u - self.knots[span] > self.knots[span + 1] - u;
        let origin = if second_half { points[p] } else { points[0] };
        let mut local: Local<4> = [SVector::zeros(); MAX_DEGREE + 1];
        for (slot, (point, w)) in local.iter_mut().zip(points.iter().zip(weights)) {
            *slot = ((point - origin) * *w).push(*w);
        }
        let [value, d1, d2, d3] = project(&jet::<4, ORDER>(p, &self.knots, span, u, &mut local));
        (
            CurveJet {
                point: origin + value,
                d1,
                d2,
            },
            d3,
        )
    }

    /// The box of the control points, which holds the whole curve.
    #[must_use]
    pub fn bounding_box(&self) -> BoundingBox {
        let start = BoundingBox {
            min: self.start(),
            max: self.start(),
        };
        self.control_points.iter().fold(start, |b, p| b.with(p))
    }

    /// Wraps parts that satisfy the invariants by construction.
    pub(super) fn trusted(
        knots: Knots,
        control_points: Vec<Point3<f64>>,
        weights: Option<Vec<f64>>,
    ) -> Self {
        BSplineCurve {
            knots,
            control_points,
            weights,
        }
    }

    /// The denominator of a rational curve at `u`; 1 for a polynomial one.
    #[must_use]
    pub fn weight_at(&self, u: f64) -> f64 {
        let Some(weights) = &self.weights else {
            return 1.0;
        };
        let u = self.clamp(u);
        let span = span(self.degree(), &self.knots, u);
        let mut local: Local<1> = [SVector::zeros(); MAX_DEGREE + 1];
        for (slot, w) in local.iter_mut().zip(&weights[span - self.degree()..=span]) {
            slot.x = *w;
        }
        jet::<1, 0>(self.degree(), &self.knots, span, u, &mut local)
            .value
            .x
    }

    /// Point and derivatives in a span of the caller's choice, for limits at
    /// knots without a search. The span must be one of the knot vector's
    /// nonempty ones and `u` in it.
    #[must_use]
    pub(in crate::geometry) fn derivatives_in_span(&self, span: usize, u: f64) -> CurveJet {
        self.evaluate::<2>(span, u).0
    }
}

/// Counts and values of control points and weights.
pub(super) fn check_control(
    expected: usize,
    control_points: &[Point3<f64>],
    weights: Option<&[f64]>,
) -> Result<(), SplineError> {
    let given = control_points.len();
    if given != expected {
        return Err(SplineError::ControlPointCount { given, expected });
    }
    let finite = |p: &Point3<f64>| p.iter().all(|x| x.is_finite());
    if let Some(index) = control_points.iter().position(|p| !finite(p)) {
        return Err(SplineError::ControlPointNotFinite { index });
    }
    let Some(weights) = weights else {
        return Ok(());
    };
    if weights.len() != expected {
        return Err(SplineError::WeightCount {
            given: weights.len(),
            expected,
        });
    }
    match weights.iter().position(|w| !(*w > 0.0 && w.is_finite())) {
        Some(index) => Err(SplineError::Weight {
            index,
            value: weights[index],
        }),
        None => Ok(()),
    }
}

/// Value and three derivatives of `A/w` from those of `(A, w)` (Piegl &
/// Tiller eq. 4.8).
pub(super) fn project(j: &Jet<4>) -> [Vector3<f64>; 4] {
    let w = j.value.w;
    let value = j.value.xyz() / w;
    let d1 = (j.d1.xyz() - value * j.d1.w) / w;
    let d2 = (j.d2.xyz() - d1 * (2.0 * j.d1.w) - value * j.d2.w) / w;
    let d3 = (j.d3.xyz() - d2 * (3.0 * j.d1.w) - d1 * (3.0 * j.d2.w) - value * j.d3.w) / w;
    [value, d1, d2, d3]
}
