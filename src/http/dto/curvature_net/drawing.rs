//! From a stored result to what the file writers draw.

use super::CurvatureNetResult;
use super::DirectionWord;
use super::result::{CYCLIDE, OFFSET, SMOOTH};
use super::specific::{MemberResult, SheetResult};
use crate::formats::brep::SheetModel;
use crate::formats::cyclides::{self, MemberLine, NetDrawing, PatchSheet};
use crate::formats::length_unit::LengthUnit;
use crate::formats::measured::in_unit;
use crate::formats::mesh_out::{MeshDrawing, Reference};
use crate::formats::patterns::{self, Pattern, PatternSheet};
use crate::geometry::{Axis, BSplineSurface};
use crate::http::dto::cad;
use crate::http::dto::curves::Surface;
use crate::http::methods::curvature_net::CurvatureNet;
use crate::http::methods::{Document, Format, Method as _};
use crate::http::problem::ApiError;
use std::collections::HashMap;

/// The title of a drawing whose job has no label.
const UNTITLED: &str = "Curvature net";
/// Points of a pattern's edge from vertex to vertex, one counted.
const PER_PIECE: usize = crate::methods::curvature_net::structure::flat::SAMPLES;

impl Document for CurvatureNetResult {
    fn units(&self) -> LengthUnit {
        self.units.into()
    }

    fn formats(&self) -> Vec<Format> {
        CurvatureNet.formats().to_vec()
    }

    /// The cyclide spline and its offsets; without them the smooth surface.
    fn mesh(&self) -> Result<MeshDrawing, ApiError> {
        let own: LengthUnit = self.units.into();
        let drawing = self.drawing(self.sheets()?, own);
        let smooth = self.surfaces.iter().find(|s| s.role == SMOOTH);
        let smooth = smooth.map(Surface::tensor).transpose()?;
        let reference = match &smooth {
            Some(smooth) if self.is_built() => Reference::Smooth(smooth),
            _ => Reference::Itself,
        };
        Ok(MeshDrawing::of_net(&drawing, own, reference))
    }

    /// The faces of the cyclide spline and its offsets; without them the
    /// smooth surface.
    fn model(&self) -> Result<SheetModel, ApiError> {
        let exact = |s: &&Surface| s.role != SMOOTH;
        let mut faces: Vec<Surface> = self.surfaces.iter().filter(exact).cloned().collect();
        if faces.is_empty() {
            faces.clone_from(&self.surfaces);
        }
        let first = self.summary.first().map_or("", String::as_str);
        Ok(SheetModel {
            title: self.title(),
            description: format!("{}: {first}", self.verdict),
            units: self.units.into(),
            sheets: cad::sheets(&faces)?,
            wires: Vec::new(),
        })
    }

    fn table(&self, unit: LengthUnit) -> Result<String, ApiError> {
        Ok(cyclides::bill_of_quantities(
            &self.drawing(Vec::new(), unit),
        ))
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
}

impl CurvatureNetResult {
    /// Whether there is a cyclide spline.
    fn is_built(&self) -> bool {
        self.surfaces.iter().any(|s| s.role == CYCLIDE)
    }

    fn title(&self) -> String {
        self.label.clone().unwrap_or_else(|| UNTITLED.to_owned())
    }

    fn drawing(&self, sheets: Vec<PatchSheet>, unit: LengthUnit) -> NetDrawing {
        let members = self.method_specific.members.iter();
        let drawing = NetDrawing {
            title: self.title(),
            units: self.units.to_string(),
            sheets,
            members: members.map(Into::into).collect(),
            verdict: self.verdict.to_string(),
        };
        in_unit(drawing, self.units.into(), unit)
    }

    fn pattern_sheet(&self, unit: LengthUnit) -> PatternSheet {
        let sheet = PatternSheet {
            title: self.title(),
            unit_name: self.units.to_string(),
            units: self.units.into(),
            patterns: self.pieces(),
            none: "There are no flat patterns: ask for \"strips\" or \"supports\".",
            verdict: self.verdict.to_string(),
            summary: self.summary.clone(),
        };
        in_unit(sheet, self.units.into(), unit)
    }

    /// The cyclide spline and its offsets; without them the smooth surface.
    fn sheets(&self) -> Result<Vec<PatchSheet>, ApiError> {
        let of_role = |role: &'static str| self.surfaces.iter().filter(move |s| s.role == role);
        if !self.is_built() {
            let smooth = of_role(SMOOTH).map(|s| cells(&s.tensor()?, &s.name, self.closed()));
            return smooth.collect();
        }
        let mut sheets = vec![self.sheet("cyclide spline", "patch ", CYCLIDE)?];
        for offset in &self.method_specific.offsets {
            let name = format!("offset {}", offset.distance);
            let prefix = format!("{name}, patch ");
            sheets.push(self.sheet(&name, &prefix, OFFSET)?);
        }
        Ok(sheets)
    }

    /// The patches whose names begin with `prefix`, each in its place.
    fn sheet(&self, name: &str, prefix: &str, role: &str) -> Result<PatchSheet, ApiError> {
        let named: HashMap<&str, &Surface> = (self.surfaces.iter())
            .filter(|s| s.role == role)
            .filter_map(|s| Some((s.name.strip_prefix(prefix)?, s)))
            .collect();
        let counts = self.diagnostics.patches.numbers();
        let places = (0..counts[0]).flat_map(|i| (0..counts[1]).map(move |j| (i, j)));
        let patches = places.map(|(i, j)| {
            let surface = named.get(format!("{i},{j}").as_str());
            surface.map(|s| s.tensor()).transpose()
        });
        Ok(PatchSheet {
            name: name.to_owned(),
            prefix: prefix.to_owned(),
            counts,
            closed: self.closed(),
            patches: patches.collect::<Result<_, _>>()?,
        })
    }

    fn closed(&self) -> [bool; 2] {
        let closed = &self.method_specific.closed;
        [DirectionWord::U, DirectionWord::V].map(|d| closed.contains(&d))
    }

    fn pieces(&self) -> Vec<Pattern> {
        let specific = &self.method_specific;
        let along = |name: &str| if name.starts_with('u') { "u" } else { "v" };
        let strips = specific.strips.iter().map(|s| {
            let kind = format!("Conical strips along {}", along(&s.name));
            (&s.name, kind, &s.sheets)
        });
        let supports = specific.supports.iter().map(|s| {
            let kind = format!("Supports along {}", along(&s.name));
            (&s.name, kind, &s.sheets)
        });
        strips
            .chain(supports)
            .flat_map(|(name, kind, sheets)| {
                let one = sheets.len() == 1;
                sheets.iter().enumerate().map(move |(k, sheet)| {
                    let name = if one {
                        name.clone()
                    } else {
                        format!("{name}/{}", k + 1)
                    };
                    pattern(name, kind.clone(), sheet)
                })
            })
            .collect()
    }
}

fn pattern(name: String, kind: String, sheet: &SheetResult) -> Pattern {
    let back = sheet.left.iter().rev();
    let pairs = sheet.right.iter().zip(&sheet.left).step_by(PER_PIECE);
    Pattern {
        name,
        kind,
        outline: sheet
            .right
            .iter()
            .chain(back)
            .map(|p| (*p).into())
            .collect(),
        line: sheet.line.iter().map(|p| (*p).into()).collect(),
        rulings: pairs.map(|(r, l)| [(*r).into(), (*l).into()]).collect(),
        side: "front side",
        ..Pattern::default()
    }
}

impl From<&MemberResult> for MemberLine {
    fn from(member: &MemberResult) -> Self {
        MemberLine {
            line: member.line.clone(),
            nodes: [member.from.numbers(), member.to.numbers()],
            radius: member.radius.unwrap_or(f64::INFINITY),
            length: member.length,
            angle_deg: member.angle_deg,
            torsion_deg: member.torsion_deg,
        }
    }
}

/// A spline cut into its patches. Its borders are polynomial, so that
/// neighbours agree by themselves.
fn cells(surface: &BSplineSurface, name: &str, closed: [bool; 2]) -> Result<PatchSheet, ApiError> {
    let strips = split(surface, Axis::U)?;
    let mut patches = Vec::new();
    for strip in &strips {
        patches.extend(split(strip, Axis::V)?.into_iter().map(Some));
    }
    Ok(PatchSheet {
        name: name.to_owned(),
        prefix: "patch ".to_owned(),
        counts: [strips.len(), patches.len() / strips.len().max(1)],
        closed,
        patches,
    })
}

/// The pieces between the knots of one direction.
fn split(surface: &BSplineSurface, axis: Axis) -> Result<Vec<BSplineSurface>, ApiError> {
    let mut inner = surface.knots()[axis.index()].clone();
    let [first, last] = surface.domain(axis);
    inner.retain(|k| *k > first && *k < last);
    inner.dedup();
    let mut rest = surface.clone();
    let mut pieces = Vec::new();
    for knot in inner {
        let (piece, after) = rest.split(axis, knot).map_err(|e| ApiError::internal(&e))?;
        pieces.push(piece);
        rest = after;
    }
    pieces.push(rest);
    Ok(pieces)
}
