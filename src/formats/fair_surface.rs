//! A faired surface as its writers draw it: the trimmed mesh, the table of
//! corrections, the plot with its isophotes.

mod delaunay;
pub(super) mod mesh;
pub(super) mod outline;

use super::fair_points;
pub use super::fair_points::FairPoint;
use super::svg;
use crate::geometry::BSplineSurface;

/// A faired surface to be written as a file; all lengths in
/// [`FairSurfaceDrawing::units`].
#[derive(Debug, Clone, PartialEq)]
pub struct FairSurfaceDrawing {
    /// The user's label of the job, or a name for it.
    pub title: String,
    /// Unit of every length, as the user wrote it.
    pub units: String,
    /// The fair surface.
    pub surface: BSplineSurface,
    /// Corners (u, v) of the closed outline within which the surface counts,
    /// the first not repeated; with fewer than three corners the whole surface
    /// counts.
    pub outer: Vec<[f64; 2]>,
    /// Outlines of holes, as `outer`.
    pub holes: Vec<Vec<[f64; 2]>>,
    /// The points in the user's order.
    pub points: Vec<FairPoint>,
    /// The isophotes, where they were asked for.
    pub isophotes: Option<Isophotes>,
    /// `within_limits` or `outside_limits`.
    pub verdict: String,
    /// Sentences about the result.
    pub summary: Vec<String>,
}

/// The angle between the surface's normal and the light on a grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Isophotes {
    /// Parameters u of the grid, increasing.
    pub u: Vec<f64>,
    /// Parameters v of the grid, increasing.
    pub v: Vec<f64>,
    /// Angles `[u][v]`, degrees; `None` outside the outline.
    pub values: Vec<Vec<Option<f64>>>,
}

/// The loftsman's table as RFC 4180 comma-separated values, one record a point.
#[must_use]
pub fn correction_table(drawing: &FairSurfaceDrawing) -> String {
    fair_points::correction_table(&drawing.points, &drawing.units, 3)
}

/// A page of SVG: isophotes as bands, the outline, the largest moves and the
/// suspected slips by number.
#[must_use]
pub fn plot(drawing: &FairSurfaceDrawing) -> String {
    svg::fair_surface::plot(drawing)
}
