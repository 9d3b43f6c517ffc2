//! B-splines (skeleton).

use nalgebra::Point3;
use thiserror::Error;

/// Why a spline cannot be.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SplineError {
    /// Placeholder.
    #[error("invalid spline")]
    Invalid,
}

/// A B-spline curve in space.
#[derive(Debug, Clone, PartialEq)]
pub struct BSplineCurve {
    degree: usize,
    knots: Vec<f64>,
    control_points: Vec<Point3<f64>>,
    weights: Option<Vec<f64>>,
}

impl BSplineCurve {
    /// # Errors
    /// Placeholder.
    pub fn new(
        degree: usize,
        knots: Vec<f64>,
        control_points: Vec<Point3<f64>>,
        weights: Option<Vec<f64>>,
    ) -> Result<Self, SplineError> {
        Ok(BSplineCurve { degree, knots, control_points, weights })
    }
    /// Degree.
    pub fn degree(&self) -> usize {
        self.degree
    }
    /// Knot vector, multiplicities written out.
    pub fn knots(&self) -> &[f64] {
        &self.knots
    }
    /// Control points.
    pub fn control_points(&self) -> &[Point3<f64>] {
        &self.control_points
    }
    /// Weights of a rational curve.
    pub fn weights(&self) -> Option<&[f64]> {
        self.weights.as_deref()
    }
}

/// A tensor-product B-spline surface; control points indexed `[u][v]`, stored
/// with `v` running fastest.
#[derive(Debug, Clone, PartialEq)]
pub struct BSplineSurface {
    degrees: [usize; 2],
    knots: [Vec<f64>; 2],
    control_points: Vec<Point3<f64>>,
    weights: Option<Vec<f64>>,
}

impl BSplineSurface {
    /// # Errors
    /// Placeholder.
    pub fn new(
        degrees: [usize; 2],
        knots: [Vec<f64>; 2],
        control_points: Vec<Point3<f64>>,
        weights: Option<Vec<f64>>,
    ) -> Result<Self, SplineError> {
        Ok(BSplineSurface { degrees, knots, control_points, weights })
    }
    /// Degrees in u and v.
    pub fn degrees(&self) -> [usize; 2] {
        self.degrees
    }
    /// Knot vectors in u and v.
    pub fn knots(&self) -> &[Vec<f64>; 2] {
        &self.knots
    }
    /// Number of control points in u and v.
    pub fn counts(&self) -> [usize; 2] {
        [
            self.knots[0].len().saturating_sub(self.degrees[0] + 1),
            self.knots[1].len().saturating_sub(self.degrees[1] + 1),
        ]
    }
    /// All control points, `v` fastest.
    pub fn control_points(&self) -> &[Point3<f64>] {
        &self.control_points
    }
    /// Weights of a rational surface, `v` fastest.
    pub fn weights(&self) -> Option<&[f64]> {
        self.weights.as_deref()
    }
}
