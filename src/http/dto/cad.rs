//! From the surfaces and curves that every result has to what a CAD desk gets.

use super::curves::{NamedCurve, Surface};
use super::job::Units;
use crate::formats::brep::{Path, Sheet, Wire, WireGroup};
use crate::formats::length_unit::LengthUnit;
use crate::http::problem::ApiError;

impl From<Units> for LengthUnit {
    fn from(units: Units) -> Self {
        match units {
            Units::Mm => LengthUnit::Millimetre,
            Units::Cm => LengthUnit::Centimetre,
            Units::M => LengthUnit::Metre,
            Units::In => LengthUnit::Inch,
            Units::Ft => LengthUnit::Foot,
        }
    }
}

/// Surfaces to be sewn.
///
/// # Errors
/// A stored surface that is none, a fault of ours.
pub(super) fn sheets(surfaces: &[Surface]) -> Result<Vec<Sheet>, ApiError> {
    let sheet = |s: &Surface| {
        Ok(Sheet {
            name: s.name.clone(),
            surface: s.tensor()?,
            outline: None,
        })
    };
    surfaces.iter().map(sheet).collect()
}

/// Curves, one group.
///
/// # Errors
/// A stored curve that is none, a fault of ours.
pub(super) fn wires(name: &str, curves: &[NamedCurve]) -> Result<WireGroup, ApiError> {
    let wire = |c: &NamedCurve| {
        Ok(Wire {
            name: c.name.clone(),
            path: Path::Spline(c.spline()?),
        })
    };
    Ok(WireGroup {
        name: name.to_owned(),
        wires: curves.iter().map(wire).collect::<Result<_, ApiError>>()?,
    })
}
