//! The mesh of a faired surface: trimmed to its outline, with the deviations
//! of the points or its mean curvature.

use super::build::Heading;
use super::nearest::Scattered;
use super::{MeshDrawing, Quantity, QuantityKind};
use crate::formats::fair_surface::{FairSurfaceDrawing, mesh};
use crate::formats::length_unit::LengthUnit;
use crate::geometry::{BSplineCurve, BSplineSurface};
use nalgebra::Point3;

/// Pieces of a curve's polyline between two knots.
const PIECES: u32 = 12;

impl MeshDrawing {
    /// A faired surface, whose lengths are in `units`.
    ///
    /// `deviations`, by their places on the surface, are what it is coloured
    /// by, between the places by the nearest of them; `limit` is the largest
    /// that was allowed. Without deviations it is coloured by its mean
    /// curvature, positive where it bends towards ∂S/∂u × ∂S/∂v.
    #[must_use]
    pub fn of_fair_surface(
        fair: &FairSurfaceDrawing,
        units: LengthUnit,
        deviations: &[(Point3<f64>, f64)],
        limit: Option<f64>,
    ) -> Self {
        let heading = Heading {
            title: &fair.title,
            units,
            verdict: &fair.verdict,
        };
        let known = !deviations.is_empty();
        let mut drawing = heading.begin(Some(Quantity {
            name: if known { "deviation" } else { "mean_curvature" }.to_owned(),
            kind: if known {
                QuantityKind::Length
            } else {
                QuantityKind::PerLength
            },
            limit: limit.filter(|_| known),
        }));
        let mesh = mesh::build(fair);
        let scattered = Scattered::new(deviations);
        let value = |vertex: usize| {
            if known {
                return scattered.at(&mesh.vertices[vertex]);
            }
            let [u, v] = mesh.places[vertex];
            // In a pole there is no normal, and no curvature to tell.
            Some(mean_curvature(&fair.surface, u, v).unwrap_or(0.0))
        };
        drawing.add_part("fair surface", &mesh.triangles, value);
        drawing.chordal_error = Some(mesh.chordal_error);
        drawing.vertices = mesh.vertices;
        drawing.normals = mesh.normals;
        drawing
    }

    /// Adds curves as lines.
    pub fn add_curves(&mut self, name: &str, curves: &[BSplineCurve]) {
        let lines: Vec<_> = curves.iter().map(polyline).collect();
        self.add_lines(name, None, lines);
    }
}

fn polyline(curve: &BSplineCurve) -> Vec<Point3<f64>> {
    let knots = curve.knot_vector().breakpoints();
    let mut points = vec![curve.start()];
    for pair in knots.windows(2) {
        let at = |k: u32| pair[0] + (pair[1] - pair[0]) * f64::from(k) / f64::from(PIECES);
        points.extend((1..=PIECES).map(|k| curve.point(at(k))));
    }
    points
}

/// H = (eG − 2fF + gE) / 2(EG − F²); `None` where the surface has no normal.
fn mean_curvature(surface: &BSplineSurface, u: f64, v: f64) -> Option<f64> {
    let jet = surface.derivatives(u, v);
    let normal = jet.normal()?;
    let [e, f, g] = [jet.duu, jet.duv, jet.dvv].map(|d| d.dot(&normal));
    let [first, mixed, second] = [
        jet.du.dot(&jet.du),
        jet.du.dot(&jet.dv),
        jet.dv.dot(&jet.dv),
    ];
    let area = first * second - mixed * mixed;
    let mean = (e * second - 2.0 * f * mixed + g * first) / (2.0 * area);
    mean.is_finite().then_some(mean)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Parametrization, interpolate_grid};

    #[test]
    fn the_mean_curvature_of_a_cylinder_is_half_of_its_curvature() {
        let place = |i: u32, j: u32| {
            let (sin, cos) = (f64::from(i) * 0.05).sin_cos();
            Point3::new(f64::from(j), 2.0 * cos, 2.0 * sin)
        };
        let grid: Vec<_> = (0..25)
            .flat_map(|i| (0..5).map(move |j| place(i, j)))
            .collect();
        let surface = interpolate_grid(&grid, [25, 5], [3, 3], Parametrization::Uniform).unwrap();
        let mean = mean_curvature(&surface, 0.4, 0.3).unwrap();
        assert!((mean.abs() - 0.25).abs() < 1e-4, "{mean}");
    }
}
