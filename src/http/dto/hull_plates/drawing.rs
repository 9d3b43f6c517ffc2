//! From a stored result to what the file writers draw.

use super::result::{HullPlatesResult, PlateResult, RulingResult};
use crate::formats::brep::{Path, SheetModel, Wire, WireGroup};
use crate::formats::length_unit::LengthUnit;
use crate::formats::measured::in_unit;
use crate::formats::mesh_out::MeshDrawing;
use crate::formats::patterns::PatternSheet;
use crate::formats::plates::{HullDrawing, PlateDrawing, ProfileLine, RulingLine};
use crate::formats::{csv, svg};
use crate::http::dto::cad;
use crate::http::methods::hull_plates::HullPlates;
use crate::http::methods::{Document, Format, Method as _};
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
            rolls: plate.roll_rows(),
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

impl Document for HullPlatesResult {
    fn units(&self) -> LengthUnit {
        self.units.into()
    }

    fn formats(&self) -> Vec<Format> {
        HullPlates.formats().to_vec()
    }

    fn mesh(&self) -> Result<MeshDrawing, ApiError> {
        Ok(MeshDrawing::of_hull(&self.into(), self.units.into()))
    }

    /// The plates, sewn along their chines, with profiles and rulings.
    fn model(&self) -> Result<SheetModel, ApiError> {
        let mut wires = vec![cad::wires("profiles", &self.curves)?];
        wires.extend(self.method_specific.plates.iter().map(rulings));
        let first = self.summary.first().map_or("", String::as_str);
        Ok(SheetModel {
            title: self.title(),
            description: format!("{}: {first}", self.verdict),
            units: self.units.into(),
            sheets: cad::sheets(&self.surfaces)?,
            wires,
        })
    }

    fn table(&self, unit: LengthUnit) -> Result<String, ApiError> {
        Ok(csv::roll_table(&self.hull(unit)))
    }

    fn picture(&self, unit: LengthUnit) -> Result<String, ApiError> {
        let sheet = in_unit(self.pattern_sheet(), self.units.into(), unit);
        Ok(svg::lines_plan(&self.hull(unit), Some(&sheet)))
    }

    fn patterns(&self, unit: LengthUnit) -> Option<PatternSheet> {
        Some(in_unit(self.pattern_sheet(), self.units.into(), unit))
    }

    fn part_word(&self) -> &'static str {
        "plate"
    }

    fn part_tables(&self) -> usize {
        self.method_specific.plates.len()
    }

    fn part_table(&self, part: usize, unit: LengthUnit) -> Result<Option<String>, ApiError> {
        let mut hull = self.hull(unit);
        if part >= hull.plates.len() {
            return Ok(None);
        }
        hull.plates = vec![hull.plates.swap_remove(part)];
        Ok(Some(csv::roll_table(&hull)))
    }
}

impl HullPlatesResult {
    fn hull(&self, unit: LengthUnit) -> HullDrawing {
        in_unit(self.into(), self.units.into(), unit)
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
