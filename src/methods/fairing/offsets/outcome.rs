//! What the method gives. Lengths in the unit of the table.

use crate::geometry::BSplineCurve;
use crate::methods::fairing::surface;

/// The faired table, its curves and the surface behind both.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// Sentences for people, the verdict first.
    pub summary: Vec<String>,
    /// What was made of zeros and gaps, and what else to know.
    pub notes: Vec<String>,
    /// One row a station, one cell a waterline.
    pub table: Vec<Vec<Cell>>,
    /// Suspected slips.
    pub slips: Vec<CellSlip>,
    /// Faired stations, planar curves x = const: for each its pieces, upwards
    /// (more than one where the profile cuts it; none where it has no cells).
    pub stations: Vec<Vec<BSplineCurve>>,
    /// Faired waterlines, planar curves z = const: for each its pieces, aft to
    /// fore.
    pub waterlines: Vec<Vec<BSplineCurve>>,
    /// Buttocks, aft to fore.
    pub buttocks: Vec<Buttock>,
    /// The surface (x(u), y(u, v), z(v)) with its figures; its `moves` are of
    /// the measured cells, index = station · waterlines + waterline.
    pub surface: surface::Outcome,
}

/// What a cell of the table is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CellKind {
    /// Measured on the hull.
    Measured,
    /// A zero next to the hull that is its ending: it counts as measured.
    Ending,
    /// Not measured, inside the hull: the surface's own value.
    Filled,
    /// Beyond the hull's outline: no value.
    Outside,
}

/// A cell of the faired table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cell {
    /// What it is.
    pub kind: CellKind,
    /// As given.
    pub old: Option<f64>,
    /// Faired; `None` outside.
    pub new: Option<f64>,
    /// new − old, where both are.
    pub change: Option<f64>,
}

/// A cell that looks mis-typed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CellSlip {
    /// Station index.
    pub station: usize,
    /// Waterline index.
    pub waterline: usize,
    /// As given.
    pub given: f64,
    /// Of the fair surface that was fitted without the cell.
    pub expected: f64,
    /// The difference in standard deviations of the table's noise.
    pub sigmas: f64,
    /// Probability that noise alone would not do this anywhere in the table.
    pub confidence: f64,
}

/// The pieces of the curve y = const.
#[derive(Debug, Clone, PartialEq)]
pub struct Buttock {
    /// Distance from the centreline.
    pub y: f64,
    /// Its pieces, aft to fore; none where the hull is narrower.
    pub curves: Vec<BSplineCurve>,
}
