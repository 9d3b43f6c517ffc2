//! Curves on a surface over straight lines in its parameters.
//!
//! Over a line that stays in one span of u and of v a surface of degrees
//! [p, q] is a rational polynomial of degree p + q (DeRose et al., *Functional
//! composition algorithms via blossoming*, 1993): its Bézier points follow from
//! its values at p + q + 1 places, exactly.

use super::{Axis, BSplineCurve, BSplineSurface, Knots, SplineError};
use nalgebra::{DMatrix, Point2, Point3, Vector4};

impl BSplineSurface {
    /// The curve S(u(t), v(t)) over a polyline in (u, v): on the surface
    /// everywhere, of degree p + q, its parameter the length along the
    /// polyline. Along a straight side of the surface it is a straight line.
    ///
    /// # Errors
    /// [`SplineError::NoCurves`] for fewer than two places that differ; a
    /// degree above the largest.
    pub fn curve_over(&self, polyline: &[Point2<f64>]) -> Result<BSplineCurve, SplineError> {
        let mut line = polyline.to_vec();
        line.dedup();
        let [first, .., last] = &line[..] else {
            return Err(SplineError::NoCurves);
        };
        let [p, q] = self.degrees();
        let along_u = line.iter().all(|x| x.y == first.y);
        let along_v = line.iter().all(|x| x.x == first.x);
        if (along_v && q == 1 && !self.crosses(Axis::V))
            || (along_u && p == 1 && !self.crosses(Axis::U))
        {
            let [a, b] = [first, last].map(|x| self.point(x.x, x.y));
            return BSplineCurve::line(a, b, 1);
        }
        let degree = p + q;
        let from_values = bernstein(degree);
        let mut knots = vec![0.0; degree + 1];
        let mut control: Vec<Vector4<f64>> = Vec::new();
        let mut length = 0.0;
        for pair in line.windows(2) {
            let step = pair[1] - pair[0];
            let cuts = self.cuts(pair);
            for t in cuts.windows(2) {
                let at = |k: usize| {
                    let share = k as f64 / degree as f64;
                    pair[0] + step * (t[0] + (t[1] - t[0]) * share)
                };
                let values: Vec<_> = (0..=degree).map(|k| self.homogeneous(&at(k))).collect();
                let bezier = (0..=degree).map(|i| {
                    let terms = values.iter().enumerate();
                    terms
                        .map(|(k, value)| value * from_values[(i, k)])
                        .sum::<Vector4<f64>>()
                });
                control.extend(bezier.skip(usize::from(!control.is_empty())));
                length += step.norm() * (t[1] - t[0]);
                knots.extend(vec![length; degree]);
            }
        }
        knots.push(length);
        let points = control
            .iter()
            .map(|h| Point3::from(h.xyz() / h.w))
            .collect();
        let weights = (self.weights()).map(|_| control.iter().map(|h| h.w).collect());
        BSplineCurve::from_knots(Knots::new(degree, knots)?, points, weights)
    }

    /// Whether there are knots inside the domain.
    fn crosses(&self, axis: Axis) -> bool {
        self.knot_vector(axis).breakpoints().len() > 2
    }

    /// Where, as shares, a line passes knots, both its ends included.
    fn cuts(&self, line: &[Point2<f64>]) -> Vec<f64> {
        /// Nearer to an end than this share a knot is that end.
        const AT_END: f64 = 1e-9;
        let mut cuts = vec![0.0, 1.0];
        for axis in [Axis::U, Axis::V] {
            let [a, b] = [line[0], line[1]].map(|x| x[axis.index()]);
            let share = |knot: f64| (knot - a) / (b - a);
            let inside = |t: &f64| (AT_END..1.0 - AT_END).contains(t);
            let knots = self.knot_vector(axis).breakpoints();
            cuts.extend(knots.into_iter().map(share).filter(inside));
        }
        cuts.sort_by(f64::total_cmp);
        cuts.dedup();
        cuts
    }

    /// Point times weight, and weight.
    fn homogeneous(&self, at: &Point2<f64>) -> Vector4<f64> {
        let weight = self.weight_at(at.x, at.y);
        (self.point(at.x, at.y).coords * weight).push(weight)
    }
}

/// Bézier points of a polynomial from its values at equal steps.
fn bernstein(degree: usize) -> DMatrix<f64> {
    let value = |k: usize, i: usize| {
        let t = k as f64 / degree as f64;
        let mut choose = 1.0;
        for j in 0..i {
            choose *= (degree - j) as f64 / (j + 1) as f64;
        }
        choose * t.powi(i as i32) * (1.0 - t).powi((degree - i) as i32)
    };
    let values = DMatrix::from_fn(degree + 1, degree + 1, value);
    // Bernstein polynomials are a basis: the matrix has an inverse.
    values
        .try_inverse()
        .unwrap_or_else(|| DMatrix::identity(degree + 1, degree + 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A quarter of a cone in two spans, and a wavy polynomial surface.
    fn surfaces() -> [BSplineSurface; 2] {
        let h = std::f64::consts::FRAC_PI_8;
        let places = [0.0, 1.0, 2.0, 3.0, 4.0].map(|k: f64| k * h);
        let mut points = Vec::new();
        let mut weights = Vec::new();
        for (i, turn) in places.iter().enumerate() {
            let (far, weight) = match i % 2 {
                0 => (1.0, 1.0),
                _ => (1.0 / h.cos(), h.cos()),
            };
            for z in [1.0, 3.0] {
                points.push(Point3::new(z * far * turn.cos(), z * far * turn.sin(), z));
                weights.push(weight);
            }
        }
        let knots = vec![0.0, 0.0, 0.0, 1.0, 1.0, 2.0, 2.0, 2.0];
        let along = vec![1.0, 1.0, 3.0, 3.0];
        let cone = BSplineSurface::new([2, 1], [knots.clone(), along], points, Some(weights));
        let wavy = (0..25).map(|k| {
            let (i, j) = ((k / 5) as f64, (k % 5) as f64);
            Point3::new(i, j, (i * 1.3).sin() * (j * 0.7).cos())
        });
        let other = vec![0.0, 0.0, 0.0, 0.5, 1.5, 2.0, 2.0, 2.0];
        let wavy = BSplineSurface::new([2, 2], [knots, other], wavy.collect(), None);
        [cone.expect("a cone"), wavy.expect("a surface")]
    }

    #[test]
    fn curves_over_polylines_lie_on_the_surface() {
        for surface in surfaces() {
            let [low, high] = surface.domain(Axis::V);
            let at = |u: f64, share: f64| Point2::new(u, low + (high - low) * share);
            let line = [
                at(0.1, 0.0),
                at(0.7, 0.3),
                at(1.9, 0.9),
                at(1.9, 0.5),
                at(0.2, 0.8),
            ];
            let curve = surface.curve_over(&line).expect("a curve");
            assert_eq!(curve.weights().is_some(), surface.weights().is_some());
            let mut from = 0.0;
            for pair in line.windows(2) {
                let length = (pair[1] - pair[0]).norm();
                for k in 0..=20 {
                    let share = k as f64 / 20.0;
                    let there = pair[0] + (pair[1] - pair[0]) * share;
                    let off = curve.point(from + share * length) - surface.point(there.x, there.y);
                    assert!(off.norm() < 1e-13, "{off}");
                }
                from += length;
            }
            assert_eq!(curve.domain()[0], 0.0);
            assert!((curve.domain()[1] - from).abs() < 1e-13);
        }
    }

    #[test]
    fn a_ruling_is_a_straight_line() {
        let [cone, wavy] = surfaces();
        let ruling = [
            Point2::new(0.6, 1.2),
            Point2::new(0.6, 2.0),
            Point2::new(0.6, 2.5),
        ];
        let curve = cone.curve_over(&ruling).expect("a line");
        assert_eq!((curve.degree(), curve.control_points().len()), (1, 2));
        assert!((curve.end() - cone.point(0.6, 2.5)).norm() < 1e-15);
        assert_eq!(wavy.curve_over(&ruling[..2]).expect("a curve").degree(), 4);
        let nowhere = [ruling[0]; 3];
        assert_eq!(cone.curve_over(&nowhere), Err(SplineError::NoCurves));
        assert_eq!(cone.curve_over(&[]), Err(SplineError::NoCurves));
    }
}
