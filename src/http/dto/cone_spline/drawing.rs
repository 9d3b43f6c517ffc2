//! From a stored result to what the file writers draw.

use super::ConeSplineResult;
use super::patch::ConePatch;
use super::result::{ConePatternPiece, ConeRuling};
use crate::formats::brep::SheetModel;
use crate::formats::cones::{self, ConeSheet, ConeSplineDrawing, EndRuling};
use crate::formats::length_unit::LengthUnit;
use crate::formats::measured::in_unit;
use crate::formats::mesh_out::{ConeGrid, MeshDrawing};
use crate::formats::patterns::{self, Pattern, PatternSheet};
use crate::http::dto::cad;
use crate::http::dto::curves::Point;
use crate::http::methods::cone_spline::ConeSpline;
use crate::http::methods::{Document, Format, Method as _};
use crate::http::problem::ApiError;
use nalgebra::{Point2, Point3, Vector2};

/// The title of a drawing whose job has no label.
const UNTITLED: &str = "Cone spline";

impl Document for ConeSplineResult {
    fn units(&self) -> LengthUnit {
        self.units.into()
    }

    fn formats(&self) -> Vec<Format> {
        ConeSpline.formats().to_vec()
    }

    fn mesh(&self) -> Result<MeshDrawing, ApiError> {
        let tolerance = self.method_specific.options.tolerance;
        let drawing = self.drawing(self.units.into());
        Ok(MeshDrawing::of_cones(
            &drawing,
            self.units.into(),
            tolerance,
        ))
    }

    fn model(&self) -> Result<SheetModel, ApiError> {
        let first = self.summary.first().map_or("", String::as_str);
        let mut sheets = cad::sheets(&self.surfaces)?;
        for (sheet, patch) in sheets.iter_mut().zip(&self.method_specific.patches) {
            let outline: Vec<Point2<f64>> = patch.outline_uv.iter().map(|p| (*p).into()).collect();
            // Results of earlier versions have none.
            sheet.outline = (!outline.is_empty()).then_some(outline);
        }
        Ok(SheetModel {
            title: self.title(),
            description: format!("{}: {first}", self.verdict),
            units: self.units.into(),
            sheets,
            wires: vec![cad::wires("rulings and sides", &self.curves)?],
        })
    }

    fn table(&self, unit: LengthUnit) -> Result<String, ApiError> {
        Ok(cones::workshop_table(&self.drawing(unit)))
    }

    fn picture(&self, unit: LengthUnit) -> Result<String, ApiError> {
        Ok(patterns::page(&self.pattern_sheet(unit)))
    }

    fn patterns(&self, unit: LengthUnit) -> Option<PatternSheet> {
        Some(self.pattern_sheet(unit))
    }

    fn part_word(&self) -> &'static str {
        "patch"
    }

    fn part_tables(&self) -> usize {
        self.method_specific.patches.len()
    }

    fn part_table(&self, part: usize, unit: LengthUnit) -> Result<Option<String>, ApiError> {
        let mut drawing = self.drawing(unit);
        if part >= drawing.sheets.len() || part + 1 >= drawing.rulings.len() {
            return Ok(None);
        }
        drawing.sheets = vec![drawing.sheets.swap_remove(part)];
        drawing.rulings = drawing.rulings[part..=part + 1].to_vec();
        Ok(Some(cones::workshop_table(&drawing)))
    }
}

impl ConeSplineResult {
    fn title(&self) -> String {
        self.label.clone().unwrap_or_else(|| UNTITLED.to_owned())
    }

    fn drawing(&self, unit: LengthUnit) -> ConeSplineDrawing {
        let specific = &self.method_specific;
        let drawing = ConeSplineDrawing {
            title: self.title(),
            units: self.units.to_string(),
            verdict: self.verdict.to_string(),
            sheets: specific.patches.iter().map(Into::into).collect(),
            rulings: specific.rulings.iter().map(Into::into).collect(),
        };
        in_unit(drawing, self.units.into(), unit)
    }

    fn pattern_sheet(&self, unit: LengthUnit) -> PatternSheet {
        let own: LengthUnit = self.units.into();
        let pieces = self.method_specific.pattern.iter();
        let sheet = PatternSheet {
            title: self.title(),
            unit_name: self.units.to_string(),
            units: own,
            patterns: (pieces.map(|piece| self.pattern(piece, own.in_terms_of(unit)))).collect(),
            none: "There is no flat pattern.",
            verdict: self.verdict.to_string(),
            summary: self.summary.clone(),
        };
        in_unit(sheet, own, unit)
    }

    /// A piece with its bend lines, the rulings between its patches, its base
    /// line (straight, from corner to corner along side 0) and the names of its
    /// patches, in whose words lengths are scaled.
    fn pattern(&self, piece: &ConePatternPiece, scale: f64) -> Pattern {
        let [first, end] = piece.patches.numbers();
        let patches = self
            .method_specific
            .patches
            .get(first..end)
            .unwrap_or_default();
        let rulings = self
            .method_specific
            .rulings
            .get(first..=end)
            .unwrap_or_default();
        let lines = patches.iter().flat_map(|p| &p.bend_lines);
        let flat = |r: &ConeRuling| r.flat.map(Into::into);
        let name = match self.method_specific.pattern.len() {
            1 => format!("{} patches, front up", patches.len()),
            _ => format!("patches {} to {end}, front up", first + 1),
        };
        Pattern {
            name,
            kind: "Flat pattern".to_owned(),
            outline: piece.outline.iter().map(|p| (*p).into()).collect(),
            line: [rulings.first(), rulings.last()]
                .into_iter()
                .flatten()
                .map(|r| flat(r)[0])
                .collect(),
            rulings: lines
                .map(|l| l.map(Into::into))
                .chain(rulings.iter().map(flat))
                .collect(),
            labels: (patches.iter().zip(rulings.windows(2)))
                .map(|(p, pair)| (middle(&[flat(&pair[0]), flat(&pair[1])]), caption(p, scale)))
                .collect(),
            side: "front side",
            ..Pattern::default()
        }
    }
}

fn middle(rulings: &[[Point2<f64>; 2]]) -> Point2<f64> {
    let ends = || rulings.iter().flatten();
    let sum: Vector2<f64> = ends().map(|p| p.coords).sum();
    Point2::from(sum / ends().count().max(1) as f64)
}

fn caption(patch: &ConePatch, scale: f64) -> String {
    use super::KindWord;
    match (patch.kind, patch.half_angle_deg, patch.radius) {
        (KindWord::Cone, Some(angle), _) => format!("{}: cone {angle:.2}°", patch.name),
        (KindWord::Cylinder, _, Some(radius)) => format!("{}: R {:.4}", patch.name, radius * scale),
        _ => format!("{}: plane", patch.name),
    }
}

fn points(list: &[Point]) -> Vec<Point3<f64>> {
    list.iter().map(|p| (*p).into()).collect()
}

impl From<&ConePatch> for ConeSheet {
    fn from(p: &ConePatch) -> Self {
        use super::KindWord;
        use super::patch::BendSideWord;
        ConeSheet {
            name: p.name.clone(),
            kind: match p.kind {
                KindWord::Cone => "cone",
                KindWord::Cylinder => "cylinder",
                KindWord::Plane => "plane",
            },
            apex: p.apex.map(Into::into),
            axis: p.axis.map(|a| (a.point.into(), a.direction.into())),
            half_angle_deg: p.half_angle_deg,
            radius: p.radius,
            slant_range: p.slant_range,
            end_radii: p.end_radii,
            turn_deg: p.turn_deg,
            min_bend_radius: p.min_bend_radius,
            bend_strain_percent: p.bend_strain_percent,
            bend_side: p.bend_side.map(|side| match side {
                BendSideWord::Front => "front",
                BendSideWord::Back => "back",
            }),
            sides: p.trims.each_ref().map(|t| points(&t.points)),
            grid: ConeGrid {
                across: p.grid.across,
                points: points(&p.grid.points),
                distances: p.grid.distances.clone(),
            },
            area: p.area,
            errors: [p.error_max, p.error_mean],
        }
    }
}

impl From<&ConeRuling> for EndRuling {
    fn from(r: &ConeRuling) -> Self {
        EndRuling {
            id: r.id,
            ends: [r.from.into(), r.to.into()],
            flat: r.flat.map(Into::into),
        }
    }
}
