//! From a stored result to what the file writers draw.

use super::ConeSplineResult;
use super::patch::ConePatch;
use super::result::{ConePatternPiece, ConeRuling};
use crate::formats::brep::SheetModel;
use crate::formats::cones::{self, ConeSheet, ConeSplineDrawing, EndRuling};
use crate::formats::dxf::Version;
use crate::formats::patterns::{self, Pattern, PatternSheet};
use crate::http::dto::cad;
use crate::http::dto::curves::Point;
use crate::http::methods::Format;
use crate::http::problem::ApiError;
use nalgebra::{Point2, Point3, Vector2};

/// The title of a drawing whose job has no label.
const UNTITLED: &str = "Cone spline";

impl ConeSplineResult {
    /// The result in another form.
    ///
    /// # Errors
    /// A stored result whose splines are none.
    pub fn write(&self, format: Format) -> Result<String, ApiError> {
        match format {
            Format::Json => Err(ApiError::internal(&"JSON is what is stored")),
            Format::Obj => Ok(cones::mesh(&self.drawing())),
            Format::Csv => Ok(cones::workshop_table(&self.drawing())),
            Format::Svg => Ok(patterns::page(&self.pattern_sheet())),
            Format::Dxf => Ok(patterns::cutting_drawing(
                &self.pattern_sheet(),
                Version::R2000,
            )),
            Format::Step | Format::Igs => cad::write(&self.model()?, format),
        }
    }

    fn title(&self) -> String {
        self.label.clone().unwrap_or_else(|| UNTITLED.to_owned())
    }

    fn model(&self) -> Result<SheetModel, ApiError> {
        let first = self.summary.first().map_or("", String::as_str);
        Ok(SheetModel {
            title: self.title(),
            description: format!("{}: {first}", self.verdict),
            units: self.units.into(),
            sheets: cad::sheets(&self.surfaces)?,
            wires: vec![cad::wires("rulings and sides", &self.curves)?],
        })
    }

    fn drawing(&self) -> ConeSplineDrawing {
        ConeSplineDrawing {
            title: self.title(),
            units: self.units.to_string(),
            verdict: self.verdict.to_string(),
            sheets: self
                .method_specific
                .patches
                .iter()
                .map(Into::into)
                .collect(),
            rulings: self
                .method_specific
                .rulings
                .iter()
                .map(Into::into)
                .collect(),
        }
    }

    fn pattern_sheet(&self) -> PatternSheet {
        let pieces = self.method_specific.pattern.iter();
        PatternSheet {
            title: self.title(),
            unit_name: self.units.to_string(),
            units: self.units.into(),
            patterns: pieces.map(|piece| self.pattern(piece)).collect(),
            none: "There is no flat pattern.",
            verdict: self.verdict.to_string(),
            summary: self.summary.clone(),
        }
    }

    /// A piece with its bend lines, the rulings between its patches, its base
    /// line (straight, from corner to corner along side 0) and the names of its
    /// patches.
    fn pattern(&self, piece: &ConePatternPiece) -> Pattern {
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
                .map(|(p, pair)| (middle(&[flat(&pair[0]), flat(&pair[1])]), caption(p)))
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

fn caption(patch: &ConePatch) -> String {
    use super::KindWord;
    match (patch.kind, patch.half_angle_deg, patch.radius) {
        (KindWord::Cone, Some(angle), _) => format!("{}: cone {angle:.2}°", patch.name),
        (KindWord::Cylinder, _, Some(radius)) => format!("{}: R {radius:.4}", patch.name),
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
