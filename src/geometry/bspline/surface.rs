//! Tensor-product B-spline surfaces, polynomial or rational: construction and
//! evaluation. Changes of form are in `surface_forms`.

use super::curve::check_control;
use super::deboor::{Local, jet};
use super::knots::{Knots, MAX_DEGREE, span, span_left};
use super::{BSplineCurve, SplineError};
use crate::geometry::BoundingBox;
use nalgebra::{Point3, SVector, Vector3};

/// A tensor-product B-spline surface; control points indexed `[u][v]`, stored
/// with `v` running fastest.
#[derive(Debug, Clone, PartialEq)]
pub struct BSplineSurface {
    degrees: [usize; 2],
    knots: [Vec<f64>; 2],
    control_points: Vec<Point3<f64>>,
    weights: Option<Vec<f64>>,
}

/// Point and partial derivatives at one parameter pair.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceJet {
    /// The point.
    pub point: Point3<f64>,
    /// ∂S/∂u.
    pub du: Vector3<f64>,
    /// ∂S/∂v.
    pub dv: Vector3<f64>,
    /// ∂²S/∂u².
    pub duu: Vector3<f64>,
    /// ∂²S/∂u∂v.
    pub duv: Vector3<f64>,
    /// ∂²S/∂v².
    pub dvv: Vector3<f64>,
}

impl SurfaceJet {
    /// The unit normal along `du × dv`; `None` where the two are parallel.
    #[must_use]
    pub fn normal(&self) -> Option<Vector3<f64>> {
        self.du.cross(&self.dv).try_normalize(0.0)
    }
}

/// One of the two parameter directions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Axis {
    /// The first parameter.
    U,
    /// The second parameter.
    V,
}

impl Axis {
    /// 0 or 1.
    #[must_use]
    pub fn index(self) -> usize {
        match self {
            Axis::U => 0,
            Axis::V => 1,
        }
    }
}

impl BSplineSurface {
    /// A surface from its knots (multiplicities written out), control points
    /// and weights (`None`: polynomial).
    ///
    /// # Errors
    /// The first broken rule: those of [`Knots::new`] for u, then v, then the
    /// counts and values of control points and weights.
    pub fn new(
        degrees: [usize; 2],
        knots: [Vec<f64>; 2],
        control_points: Vec<Point3<f64>>,
        weights: Option<Vec<f64>>,
    ) -> Result<Self, SplineError> {
        let [u, v] = knots;
        let knots = [Knots::new(degrees[0], u)?, Knots::new(degrees[1], v)?];
        Self::from_knots(knots, control_points, weights)
    }

    /// As [`BSplineSurface::new`], with knots that are already checked.
    ///
    /// # Errors
    /// Counts and values of control points and weights.
    pub fn from_knots(
        knots: [Knots; 2],
        control_points: Vec<Point3<f64>>,
        weights: Option<Vec<f64>>,
    ) -> Result<Self, SplineError> {
        let count = knots[0].control_count() * knots[1].control_count();
        check_control(count, &control_points, weights.as_deref())?;
        let degrees = [knots[0].degree(), knots[1].degree()];
        let knots = knots.map(Knots::into_values);
        Ok(BSplineSurface {
            degrees,
            knots,
            control_points,
            weights,
        })
    }

    /// Degrees in u and v.
    #[must_use]
    pub fn degrees(&self) -> [usize; 2] {
        self.degrees
    }

    /// Knot vectors in u and v, multiplicities written out.
    #[must_use]
    pub fn knots(&self) -> &[Vec<f64>; 2] {
        &self.knots
    }

    /// A copy of one knot vector, as the checked type.
    #[must_use]
    pub fn knot_vector(&self, axis: Axis) -> Knots {
        let i = axis.index();
        Knots::trusted(self.degrees[i], self.knots[i].clone())
    }

    /// Number of control points in u and v.
    #[must_use]
    pub fn counts(&self) -> [usize; 2] {
        [0, 1].map(|i| self.knots[i].len() - self.degrees[i] - 1)
    }

    /// All control points, `v` fastest.
    #[must_use]
    pub fn control_points(&self) -> &[Point3<f64>] {
        &self.control_points
    }

    /// Weights of a rational surface, `v` fastest.
    #[must_use]
    pub fn weights(&self) -> Option<&[f64]> {
        self.weights.as_deref()
    }

    /// First and last parameter in one direction.
    #[must_use]
    pub fn domain(&self, axis: Axis) -> [f64; 2] {
        let knots = &self.knots[axis.index()];
        [knots[0], knots[knots.len() - 1]]
    }

    /// The surface scaled about the origin.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        BSplineSurface {
            control_points: self.control_points.iter().map(|p| p * factor).collect(),
            ..self.clone()
        }
    }

    /// The box of the control points, which holds the whole surface.
    #[must_use]
    pub fn bounding_box(&self) -> BoundingBox {
        let first = self.control_points[0];
        let start = BoundingBox {
            min: first,
            max: first,
        };
        self.control_points.iter().fold(start, |b, p| b.with(p))
    }

    /// The point at (u, v); parameters outside the domain are moved into it.
    #[must_use]
    pub fn point(&self, u: f64, v: f64) -> Point3<f64> {
        self.derivatives(u, v).point
    }

    /// Point, first and second partial derivatives at (u, v): right-sided at
    /// inner knots, left-sided at the ends of the domain.
    #[must_use]
    pub fn derivatives(&self, u: f64, v: f64) -> SurfaceJet {
        let [u, v] = self.clamp(u, v);
        let [ku, kv] = &self.knots;
        self.evaluate(
            [span(self.degrees[0], ku, u), span(self.degrees[1], kv, v)],
            u,
            v,
        )
    }

    /// The same as limits from below in both parameters.
    #[must_use]
    pub fn derivatives_left(&self, u: f64, v: f64) -> SurfaceJet {
        let [u, v] = self.clamp(u, v);
        let [ku, kv] = &self.knots;
        self.evaluate(
            [
                span_left(self.degrees[0], ku, u),
                span_left(self.degrees[1], kv, v),
            ],
            u,
            v,
        )
    }

    /// The weight at (u, v), which divides what the rational surface is made
    /// of; 1 for a polynomial one.
    #[must_use]
    pub fn weight_at(&self, u: f64, v: f64) -> f64 {
        let Some(weights) = &self.weights else {
            return 1.0;
        };
        let [u, v] = self.clamp(u, v);
        let [ku, kv] = &self.knots;
        let spans = [span(self.degrees[0], ku, u), span(self.degrees[1], kv, v)];
        let [w, ..] = self.tensor::<1>(spans, [u, v], |k| SVector::from([weights[k]]));
        w.x
    }

    /// The unit normal at (u, v); `None` where the surface is singular.
    #[must_use]
    pub fn normal(&self, u: f64, v: f64) -> Option<Vector3<f64>> {
        self.derivatives(u, v).normal()
    }

    fn clamp(&self, u: f64, v: f64) -> [f64; 2] {
        let ([a, b], [c, d]) = (self.domain(Axis::U), self.domain(Axis::V));
        [u.clamp(a, b), v.clamp(c, d)]
    }

    /// Polynomial, or homogeneous about one of the span's control points, as
    /// in [`BSplineCurve`].
    fn evaluate(&self, spans: [usize; 2], u: f64, v: f64) -> SurfaceJet {
        let Some(weights) = &self.weights else {
            let [point, du, duu, dv, duv, dvv] =
                self.tensor::<3>(spans, [u, v], |k| self.control_points[k].coords);
            return SurfaceJet {
                point: point.into(),
                du,
                dv,
                duu,
                duv,
                dvv,
            };
        };
        let [nu, nv] = self.nearest_corner(spans, u, v);
        let origin = self.control_points[nu * self.counts()[1] + nv];
        let h = self.tensor::<4>(spans, [u, v], |k| {
            ((self.control_points[k] - origin) * weights[k]).push(weights[k])
        });
        let [a, au, auu, av, auv, avv] = h.map(|x| x.xyz());
        let [w, wu, wuu, wv, wuv, wvv] = h.map(|x| x.w);
        let s = a / w;
        let du = (au - s * wu) / w;
        let dv = (av - s * wv) / w;
        SurfaceJet {
            point: origin + s,
            du,
            dv,
            duu: (auu - du * (2.0 * wu) - s * wuu) / w,
            duv: (auv - dv * wu - du * wv - s * wuv) / w,
            dvv: (avv - dv * (2.0 * wv) - s * wvv) / w,
        }
    }

    /// Indices of the control point at the corner of the span nearest to
    /// (u, v).
    fn nearest_corner(&self, spans: [usize; 2], u: f64, v: f64) -> [usize; 2] {
        [(0, u), (1, v)].map(|(i, x)| {
            let (k, t) = (spans[i], &self.knots[i]);
            if x - t[k] > t[k + 1] - x {
                k
            } else {
                k - self.degrees[i]
            }
        })
    }

    /// S, Su, Suu, Sv, Suv, Svv of the tensor product of any dimension: de
    /// Boor along u for each column that acts, then along v on the results.
    fn tensor<const D: usize>(
        &self,
        spans: [usize; 2],
        [u, v]: [f64; 2],
        control: impl Fn(usize) -> SVector<f64, D>,
    ) -> [SVector<f64, D>; 6] {
        let [p, q] = self.degrees;
        let row = self.counts()[1];
        let zero: Local<D> = [SVector::zeros(); MAX_DEGREE + 1];
        let (mut s, mut su, mut suu) = (zero, zero, zero);
        for j in 0..=q {
            let mut column = zero;
            for (i, slot) in column.iter_mut().enumerate().take(p + 1) {
                *slot = control((spans[0] - p + i) * row + spans[1] - q + j);
            }
            let c = jet::<D, 2>(p, &self.knots[0], spans[0], u, &mut column);
            (s[j], su[j], suu[j]) = (c.value, c.d1, c.d2);
        }
        let s = jet::<D, 2>(q, &self.knots[1], spans[1], v, &mut s);
        let su = jet::<D, 1>(q, &self.knots[1], spans[1], v, &mut su);
        let suu = jet::<D, 0>(q, &self.knots[1], spans[1], v, &mut suu);
        [s.value, su.value, suu.value, s.d1, su.d1, s.d2]
    }

    /// The curve of control points with one index fixed: row `i` along v, or
    /// column `j` along u.
    pub(super) fn control_curve(&self, along: Axis, fixed: usize) -> BSplineCurve {
        let [n, m] = self.counts();
        let pick = |k: usize| match along {
            Axis::U => k * m + fixed,
            Axis::V => fixed * m + k,
        };
        let count = if along == Axis::U { n } else { m };
        let points = (0..count).map(|k| self.control_points[pick(k)]).collect();
        let weights = self
            .weights
            .as_ref()
            .map(|w| (0..count).map(|k| w[pick(k)]).collect());
        BSplineCurve::trusted(self.knot_vector(along), points, weights)
    }
}
