//! Surfaces and curves on their way to a CAD desk: what the STEP and the IGES
//! writer draw, and how faces are sewn along the edges that they share.

mod bounds;
mod sew;

use super::length_unit::LengthUnit;
use crate::geometry::{BSplineCurve, BSplineSurface};
use nalgebra::{Point2, Point3};

pub(super) use bounds::{Bound, bounds};
pub(super) use sew::{Edge, Face, Sewn, sew};

/// Surfaces and curves with their names; all lengths in `units`.
#[derive(Debug, Clone, PartialEq)]
pub struct SheetModel {
    /// The user's label of the job, or a name for it.
    pub title: String,
    /// What a reader should know: verdict, limits, source.
    pub description: String,
    /// Unit of every length.
    pub units: LengthUnit,
    /// The surfaces; those that share a boundary are sewn there.
    pub sheets: Vec<Sheet>,
    /// Curves beside the surfaces, group by group.
    pub wires: Vec<WireGroup>,
}

/// A surface with its name.
#[derive(Debug, Clone, PartialEq)]
pub struct Sheet {
    /// Its name.
    pub name: String,
    /// The surface.
    pub surface: BSplineSurface,
    /// Where only a part of it is meant: that part's outline in (u, v), closed,
    /// the first point not repeated.
    pub outline: Option<Vec<Point2<f64>>>,
}

/// Curves that belong together: the profiles of a hull, the rulings of a
/// plate.
#[derive(Debug, Clone, PartialEq)]
pub struct WireGroup {
    /// What they are.
    pub name: String,
    /// The curves.
    pub wires: Vec<Wire>,
}

/// A curve with its name.
#[derive(Debug, Clone, PartialEq)]
pub struct Wire {
    /// Its name.
    pub name: String,
    /// The curve.
    pub path: Path,
}

/// A curve as files know it.
#[derive(Debug, Clone, PartialEq)]
pub enum Path {
    /// A straight line between two points.
    Line([Point3<f64>; 2]),
    /// Any other curve.
    Spline(BSplineCurve),
}
