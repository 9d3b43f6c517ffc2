//! Area and curvature of a tensor-product surface.

use crate::geometry::{Axis, BSplineSurface, FundamentalForms};
use crate::numerics::GaussLegendre;
use nalgebra::Point3;

/// Nodes a knot span and direction.
const NODES: usize = 4;

/// What a surface is like, at the Gauss nodes of its knot spans.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shape {
    /// Area.
    pub area: f64,
    /// Largest |Gaussian curvature|, 1/length²; 0 on a developable surface.
    pub gaussian_max: f64,
    /// Where.
    pub gaussian_max_at: Point3<f64>,
    /// `∫ |K| dA`, the solid angle of its normals, folds unfolded: a measure of
    /// how far from developable it is that knows no scale.
    pub total_curvature: f64,
    /// Least radius of normal curvature, infinite on a plane.
    pub least_radius: f64,
    /// Places without a normal.
    pub singular: usize,
}

/// Measures a surface.
#[must_use]
pub fn measure(surface: &BSplineSurface) -> Shape {
    let rule = GaussLegendre::new(NODES);
    let [us, vs] = [Axis::U, Axis::V].map(|axis| nodes(surface, axis, &rule));
    let mut shape = Shape {
        area: 0.0,
        gaussian_max: 0.0,
        gaussian_max_at: surface.point(us[0].0, vs[0].0),
        total_curvature: 0.0,
        least_radius: f64::INFINITY,
        singular: 0,
    };
    for (u, weight_u) in &us {
        for (v, weight_v) in &vs {
            let s = surface.derivatives(*u, *v);
            let area = s.du.cross(&s.dv).norm() * weight_u * weight_v;
            let Some(n) = s.normal().filter(|_| area > 0.0) else {
                shape.singular += 1;
                continue;
            };
            let forms = FundamentalForms {
                first: [s.du.norm_squared(), s.du.dot(&s.dv), s.dv.norm_squared()],
                second: [n.dot(&s.duu), n.dot(&s.duv), n.dot(&s.dvv)],
            };
            let (k, h) = (forms.gaussian_curvature(), forms.mean_curvature());
            if !(k.is_finite() && h.is_finite()) {
                shape.singular += 1;
                continue;
            }
            shape.area += area;
            shape.total_curvature += k.abs() * area;
            if k.abs() > shape.gaussian_max {
                (shape.gaussian_max, shape.gaussian_max_at) = (k.abs(), s.point);
            }
            let largest = h.abs() + (h * h - k).max(0.0).sqrt();
            shape.least_radius = shape.least_radius.min(largest.recip());
        }
    }
    shape
}

/// Parameters and weights in one direction.
fn nodes(surface: &BSplineSurface, axis: Axis, rule: &GaussLegendre) -> Vec<(f64, f64)> {
    let knots = surface.knot_vector(axis).breakpoints();
    (knots.windows(2))
        .flat_map(|w| rule.on(w[0], w[1]).collect::<Vec<_>>())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::conformance::samples::quarter_circle;
    use crate::geometry::{BSplineCurve, RuledSurface};
    use nalgebra::{Vector3, point};
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn a_cylinder_has_its_radius_and_no_curvature() {
        let arc = quarter_circle(2.0);
        let other = arc.translated(&Vector3::new(0.0, 0.0, 3.0));
        let cylinder = RuledSurface::new(arc, other).unwrap();
        let shape = measure(&cylinder.to_bspline().unwrap());
        assert!((shape.area / (6.0 * FRAC_PI_2) - 1.0).abs() < 1e-5);
        assert!((shape.least_radius - 2.0).abs() < 1e-9);
        assert!(shape.gaussian_max < 1e-12 && shape.total_curvature < 1e-12);
        assert_eq!(shape.singular, 0);
    }

    #[test]
    fn a_hypar_has_its_textbook_curvature() {
        // z = xy: K = −1/(1 + x² + y²)², largest in the corner.
        let line = |a, b| BSplineCurve::line(a, b, 2).unwrap();
        let hypar = RuledSurface::new(
            line(point![0., 0., 0.], point![1., 0., 0.]),
            line(point![0., 1., 0.], point![1., 1., 1.]),
        );
        let shape = measure(&hypar.unwrap().to_bspline().unwrap());
        assert!(shape.gaussian_max > 0.97 && shape.gaussian_max < 1.0);
        assert!(shape.gaussian_max_at.coords.norm() < 0.1);
        // ∫ dx dy / (1 + x² + y²)^{3/2} = atan(1/√3) over the unit square.
        let exact = (1.0 / 3f64.sqrt()).atan();
        assert!((shape.total_curvature - exact).abs() < 1e-4, "{shape:?}");
    }
}
