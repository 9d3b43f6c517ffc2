//! Surfaces from STEP files (ISO 10303-21 with the geometry of part 42), as CAD
//! writes them under AP203, AP214 and AP242.
//!
//! Read are the B-spline surfaces of the faces, rational or not, whole: a face
//! that is trimmed within its surface is marked. Faces on planes, cylinders and
//! other elementary surfaces are named and left out.

mod clamp;
mod error;
mod part21;
mod surfaces;
#[cfg(test)]
mod tests;

pub use error::{StepFault, StepReadError};

use crate::geometry::BSplineSurface;

/// What a STEP file holds.
#[derive(Debug, Clone, PartialEq)]
pub struct StepReading {
    /// Metres in the unit of its lengths.
    pub metres: f64,
    /// Its surfaces in the order of the faces, lengths in the file's unit.
    pub surfaces: Vec<StepSurface>,
    /// Faces that are not on B-spline surfaces: how many of each kind.
    pub left_out: Vec<(String, usize)>,
    /// Whether parts are placed by transformations, which are not followed.
    pub is_assembly: bool,
}

/// A surface of a STEP file.
#[derive(Debug, Clone, PartialEq)]
pub struct StepSurface {
    /// The name of the face, or of the surface where that has none.
    pub name: Option<String>,
    /// The whole surface.
    pub surface: BSplineSurface,
    /// Whether its face is only a part of it.
    pub is_trimmed: bool,
}

/// Reads a STEP file.
///
/// # Errors
/// The first thing that cannot be read, with its line.
pub fn read(bytes: &[u8]) -> Result<StepReading, StepReadError> {
    surfaces::collect(&part21::parse(bytes)?)
}
