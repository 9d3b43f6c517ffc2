//! The smooth surface as a spline.

use super::surface::Surface;
use crate::geometry::{BSplineSurface, SplineError};
use nalgebra::{Point3, Vector3};

/// The bicubic Hermite patches as one spline with double inner knots, which is
/// C¹ by that alone; a direction that closes is cut at its first line.
///
/// # Errors
/// None for a surface with finite vertices.
pub(super) fn spline(surface: &Surface) -> Result<BSplineSurface, SplineError> {
    let sides = [0, 1].map(|d| Side::of(&surface.widths()[d]));
    let mut points = Vec::with_capacity(sides[0].handles.len() * sides[1].handles.len());
    for (i, a) in &sides[0].handles {
        for (j, b) in &sides[1].handles {
            let vertex = &surface.vertices()[surface.layout().vertex(*i, *j)];
            let place: Vector3<f64> =
                vertex.point + vertex.du * *a + vertex.dv * *b + vertex.duv * (a * b);
            points.push(Point3::from(place));
        }
    }
    BSplineSurface::new([3, 3], sides.map(|s| s.knots), points, None)
}

/// One parameter direction.
struct Side {
    knots: Vec<f64>,
    /// The control points: at which vertex, and how far along its tangent.
    handles: Vec<(usize, f64)>,
}

impl Side {
    /// Of patches of these widths: a cubic's inner Bézier points lie a third
    /// of the width along the tangents of its ends.
    fn of(widths: &[f64]) -> Self {
        let mut side = Side {
            knots: vec![0.0; 4],
            handles: vec![(0, 0.0)],
        };
        let mut end = 0.0;
        for (k, width) in widths.iter().enumerate() {
            side.handles.push((k, width / 3.0));
            side.handles.push((k + 1, -width / 3.0));
            end += width;
            side.knots.extend([end; 2]);
        }
        side.handles.push((widths.len(), 0.0));
        side.knots.extend([end; 2]);
        side
    }
}
