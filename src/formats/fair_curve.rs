//! A faired curve as its writers draw it: the table of corrections and the
//! plot with its curvature comb.

use super::fair_points;
pub use super::fair_points::FairPoint;
use super::svg;
use crate::geometry::BSplineCurve;
use nalgebra::{Point3, Vector3};

/// A faired curve to be written as a file; all lengths in
/// [`FairCurveDrawing::units`].
#[derive(Debug, Clone, PartialEq)]
pub struct FairCurveDrawing {
    /// The user's label of the job, or a name for it.
    pub title: String,
    /// Unit of every length, as the user wrote it.
    pub units: String,
    /// 2 for a curve in the x–y plane, 3 for one in space.
    pub dimension: usize,
    /// The fair curve.
    pub curve: BSplineCurve,
    /// The curve through the points as given, for comparison.
    pub before: Option<BSplineCurve>,
    /// The points in the user's order.
    pub points: Vec<FairPoint>,
    /// The curvature comb of the fair curve, in order along it.
    pub comb: Vec<Tooth>,
    /// `within_limits` or `outside_limits`.
    pub verdict: String,
    /// Sentences about the result.
    pub summary: Vec<String>,
}

/// One tooth of a curvature comb.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tooth {
    /// Arc length from the start of the curve.
    pub s: f64,
    /// The place on the curve.
    pub point: Point3<f64>,
    /// Unit normal.
    pub normal: Vector3<f64>,
    /// Curvature in one over the unit of length; `curvature * normal` is the
    /// curvature vector, so that a plane curve with normals all on one side
    /// has signs, and a change of sign is an inflection.
    pub curvature: f64,
}

/// The loftsman's table as RFC 4180 comma-separated values, one record a
/// point; without z columns for a plane curve.
#[must_use]
pub fn correction_table(drawing: &FairCurveDrawing) -> String {
    fair_points::correction_table(&drawing.points, &drawing.units, drawing.dimension)
}

/// A page of SVG: the curve with its comb, the moves enlarged, suspected slips;
/// below it the curvature and the use of the tolerance along the curve.
#[must_use]
pub fn plot(drawing: &FairCurveDrawing) -> String {
    svg::fair_curve::plot(drawing)
}
