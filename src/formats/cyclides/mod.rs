//! A net of patches as its writers draw it: the mesh, the bill of its arcs,
//! the flat patterns of its strips.

mod bill;
mod mesh;
#[cfg(test)]
mod tests;

use super::svg;
use crate::geometry::BSplineSurface;
use nalgebra::Point2;

/// A net to be written as a file; all lengths in [`NetDrawing::units`].
#[derive(Debug, Clone, PartialEq)]
pub struct NetDrawing {
    /// The user's label of the job, or a name for it.
    pub title: String,
    /// Unit of every length, as the user wrote it.
    pub units: String,
    /// Millimetres in that unit, for the scale of the patterns.
    pub unit_mm: f64,
    /// The surfaces: the net itself, its offsets.
    pub sheets: Vec<PatchSheet>,
    /// Every arc of the net.
    pub members: Vec<MemberLine>,
    /// Flat patterns.
    pub patterns: Vec<Pattern>,
    /// `within_limits` or `outside_limits`.
    pub verdict: String,
    /// Sentences about the result.
    pub summary: Vec<String>,
}

/// A surface of patches in rows and columns; neighbours share their borders.
#[derive(Debug, Clone, PartialEq)]
pub struct PatchSheet {
    /// What it is called.
    pub name: String,
    /// Rows and columns of patches.
    pub counts: [usize; 2],
    /// Whether u, whether v closes.
    pub closed: [bool; 2],
    /// The patches, one Bézier piece each, row after row; `None`: a gap.
    pub patches: Vec<Option<BSplineSurface>>,
}

/// An arc between two nodes.
#[derive(Debug, Clone, PartialEq)]
pub struct MemberLine {
    /// Name of its line.
    pub line: String,
    /// Row and column of its two nodes.
    pub nodes: [[usize; 2]; 2],
    /// Radius; infinite for a straight one.
    pub radius: f64,
    /// Length.
    pub length: f64,
    /// Angle, degrees.
    pub angle_deg: f64,
    /// Angle between the nodes' normals about the chord, degrees.
    pub torsion_deg: f64,
}

/// A flat pattern.
#[derive(Debug, Clone, PartialEq)]
pub struct Pattern {
    /// What it is called: shown on the sheet.
    pub name: String,
    /// What kind of strip it is: patterns of one kind stand together under it.
    pub kind: String,
    /// The closed outline, the first point not repeated.
    pub outline: Vec<Point2<f64>>,
    /// The line that the strip was laid along.
    pub line: Vec<Point2<f64>>,
    /// Rulings at the nodes.
    pub rulings: Vec<[Point2<f64>; 2]>,
}

/// All surfaces as Wavefront OBJ, one object each: triangles, watertight
/// across the borders of patches, the winding that of ∂S/∂u × ∂S/∂v.
#[must_use]
pub fn mesh(drawing: &NetDrawing) -> String {
    mesh::write(drawing)
}

/// The bill of the arcs as RFC 4180 comma-separated values, one record an arc.
#[must_use]
pub fn bill_of_quantities(drawing: &NetDrawing) -> String {
    bill::write(drawing)
}

/// The flat patterns as an SVG page, all to one stated scale.
#[must_use]
pub fn pattern_sheet(drawing: &NetDrawing) -> String {
    svg::patterns::page(drawing)
}
