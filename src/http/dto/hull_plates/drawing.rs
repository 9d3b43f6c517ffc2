//! From a stored result to what the file writers draw.

use super::result::{HullPlatesResult, PlateResult, RulingResult};
use crate::formats::brep::{Path, SheetModel, Wire, WireGroup};
use crate::formats::plates::{HullDrawing, PlateDrawing, ProfileLine, RulingLine};
use crate::http::dto::cad;
use crate::http::methods::Format;
use crate::http::problem::ApiError;

/// The title of a drawing whose job has no label.
const UNTITLED: &str = "Hull plates";

impl From<&HullPlatesResult> for HullDrawing {
    fn from(result: &HullPlatesResult) -> Self {
        let plates = &result.method_specific.plates;
        HullDrawing {
            title: result.title(),
            units: result.units.to_string(),
            twist_limit_deg: result.method_specific.options.max_twist_deg,
            plates: plates.iter().map(Into::into).collect(),
            profiles: profile_lines(result),
            verdict: result.verdict.to_string(),
            summary: result.summary.clone(),
        }
    }
}

impl From<&PlateResult> for PlateDrawing {
    fn from(plate: &PlateResult) -> Self {
        PlateDrawing {
            name: plate.name.clone(),
            rulings: plate.rulings.iter().map(Into::into).collect(),
            within_limits: plate.within_limits,
        }
    }
}

impl From<&RulingResult> for RulingLine {
    fn from(ruling: &RulingResult) -> Self {
        RulingLine {
            u: ruling.u,
            from: ruling.from.into(),
            to: ruling.to.into(),
            twist_deg: ruling.twist_deg,
            bend_radius_from: ruling.bend_radius_from.unwrap_or(f64::INFINITY),
            bend_radius_to: ruling.bend_radius_to.unwrap_or(f64::INFINITY),
        }
    }
}

impl HullPlatesResult {
    /// The plates, sewn along their chines, with profiles and rulings, for a
    /// CAD desk.
    ///
    /// # Errors
    /// A format that is none of CAD, or a stored result that is broken; faults
    /// of ours.
    pub fn write_cad(&self, format: Format) -> Result<String, ApiError> {
        let mut wires = vec![cad::wires("profiles", &self.curves)?];
        wires.extend(self.method_specific.plates.iter().map(rulings));
        let first = self.summary.first().map_or("", String::as_str);
        let model = SheetModel {
            title: self.title(),
            description: format!("{}: {first}", self.verdict),
            units: self.units.into(),
            sheets: cad::sheets(&self.surfaces)?,
            wires,
        };
        cad::write(&model, format)
    }

    pub(super) fn title(&self) -> String {
        self.label.clone().unwrap_or_else(|| UNTITLED.to_owned())
    }
}

/// The rulings of a plate, numbered from 1.
fn rulings(plate: &PlateResult) -> WireGroup {
    let wire = |(i, r): (usize, &RulingResult)| Wire {
        name: format!("ruling {}", i + 1),
        path: Path::Line([r.from.into(), r.to.into()]),
    };
    WireGroup {
        name: format!("rulings of {}", plate.name),
        wires: plate.rulings.iter().enumerate().map(wire).collect(),
    }
}

/// Each profile through the ruling ends on it, which the mesh uses too: of the
/// plate that begins there, or for the last profile of the plate that ends
/// there.
fn profile_lines(result: &HullPlatesResult) -> Vec<ProfileLine> {
    let plates = &result.method_specific.plates;
    let points = |i: usize| match (plates.get(i), plates.last()) {
        (Some(plate), _) => plate.rulings.iter().map(|r| r.from.into()).collect(),
        (None, Some(last)) => last.rulings.iter().map(|r| r.to.into()).collect(),
        (None, None) => Vec::new(),
    };
    (result.curves.iter().enumerate())
        .map(|(i, curve)| ProfileLine {
            name: curve.name.clone(),
            points: points(i),
        })
        .collect()
}
