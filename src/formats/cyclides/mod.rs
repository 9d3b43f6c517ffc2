//! A net of patches as its writers draw it: the lattice of its mesh, the bill
//! of its arcs.

mod bill;
mod mesh;
#[cfg(test)]
mod tests;

pub(super) use mesh::{Lattice, Place};

use crate::geometry::BSplineSurface;

/// A net to be written as a file; all lengths in [`NetDrawing::units`].
#[derive(Debug, Clone, PartialEq)]
pub struct NetDrawing {
    /// The user's label of the job, or a name for it.
    pub title: String,
    /// Unit of every length, as the user wrote it.
    pub units: String,
    /// The surfaces: the net itself, its offsets.
    pub sheets: Vec<PatchSheet>,
    /// Every arc of the net.
    pub members: Vec<MemberLine>,
    /// `within_limits` or `outside_limits`.
    pub verdict: String,
}

/// A surface of patches in rows and columns; neighbours share their borders.
#[derive(Debug, Clone, PartialEq)]
pub struct PatchSheet {
    /// What it is called.
    pub name: String,
    /// What stands before row and column in the name of a patch.
    pub prefix: String,
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

/// The bill of the arcs as RFC 4180 comma-separated values, one record an arc.
#[must_use]
pub fn bill_of_quantities(drawing: &NetDrawing) -> String {
    bill::write(drawing)
}
