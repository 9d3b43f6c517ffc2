//! From a stored result to what the file writers draw.

use super::FairingResult;
use super::TableRows;
use super::result::{FairedKind, MoveResult};
use super::table::CellWord;
use crate::formats::brep::SheetModel;
use crate::formats::fair_curve::{self, FairCurveDrawing, Tooth};
use crate::formats::fair_points::FairPoint;
use crate::formats::fair_surface::{self, FairSurfaceDrawing, Isophotes};
use crate::formats::length_unit::LengthUnit;
use crate::formats::measured::in_unit;
use crate::formats::mesh_out::MeshDrawing;
use crate::formats::offsets::{self, Cell, OffsetsDrawing, Orientation};
use crate::geometry::BSplineCurve;
use crate::http::dto::cad;
use crate::http::methods::fairing::Fairing;
use crate::http::methods::{Document, Format, Method as _};
use crate::http::problem::ApiError;
use nalgebra::{Point3, Vector3};
use std::collections::HashMap;

/// The title of a drawing whose job has no label.
const UNTITLED: &str = "Fairing";

impl Document for FairingResult {
    fn units(&self) -> LengthUnit {
        self.units.into()
    }

    /// A curve has no mesh.
    fn formats(&self) -> Vec<Format> {
        let formats = Fairing.formats().iter().copied();
        let is_curve = self.method_specific.kind == FairedKind::Curve;
        formats.filter(|f| !(is_curve && f.is_mesh())).collect()
    }

    fn mesh(&self) -> Result<MeshDrawing, ApiError> {
        let own: LengthUnit = self.units.into();
        let fair = self.surface(own)?;
        let (deviations, limit) = self.deviations();
        let mut mesh = MeshDrawing::of_fair_surface(&fair, own, &deviations, limit);
        for (role, name) in [
            ("station", "stations"),
            ("waterline", "waterlines"),
            ("buttock", "buttocks"),
        ] {
            let curves = self.family(role)?.into_iter().map(|(_, c)| c);
            mesh.add_curves(name, &curves.collect::<Vec<_>>());
        }
        Ok(mesh)
    }

    fn model(&self) -> Result<SheetModel, ApiError> {
        Ok(SheetModel {
            title: self.title(),
            description: format!("{}; surfaces reach beyond their points", self.verdict),
            units: self.units.into(),
            sheets: cad::sheets(&self.surfaces)?,
            wires: vec![cad::wires("curves", &self.curves)?],
        })
    }

    fn table(&self, unit: LengthUnit) -> Result<String, ApiError> {
        Ok(match self.method_specific.kind {
            FairedKind::Curve => fair_curve::correction_table(&self.curve(unit)?),
            FairedKind::Surface => fair_surface::correction_table(&self.surface(unit)?),
            FairedKind::Offsets => offsets::table(&self.offsets(unit)?),
        })
    }

    fn picture(&self, unit: LengthUnit) -> Result<String, ApiError> {
        Ok(match self.method_specific.kind {
            FairedKind::Curve => fair_curve::plot(&self.curve(unit)?),
            FairedKind::Surface => fair_surface::plot(&self.surface(unit)?),
            FairedKind::Offsets => offsets::lines_plan(&self.offsets(unit)?),
        })
    }

    fn part_word(&self) -> &'static str {
        "surface"
    }
}

impl FairingResult {
    /// Signed deviations of the given points from the shape by the places on
    /// it, of a table outwards positive, and the largest that was allowed,
    /// where it was the same for all. None where not all points are listed: those
    /// that are have moved most.
    fn deviations(&self) -> (Vec<(Point3<f64>, f64)>, Option<f64>) {
        let specific = &self.method_specific;
        if let Some(table) = &specific.table {
            let mut known = Vec::new();
            for (x, row) in table.stations.iter().zip(&table.cells) {
                for (z, cell) in table.waterlines.iter().zip(row) {
                    if let (Some(old), Some(new)) = (cell.old, cell.new) {
                        known.push((Point3::new(*x, new, *z), old - new));
                    }
                }
            }
            let single = specific.options.cell_tolerances.is_empty();
            return (known, specific.options.tolerance.filter(|_| single));
        }
        if specific.moves.len() < specific.points {
            return (Vec::new(), None);
        }
        let moves = specific.moves.iter();
        let first = specific.moves.first().and_then(|m| m.tolerance);
        let same = moves.clone().all(|m| m.tolerance == first);
        let known = moves.map(|m| (m.now.into(), m.distance)).collect();
        (known, first.filter(|_| same))
    }

    fn title(&self) -> String {
        self.label.clone().unwrap_or_else(|| UNTITLED.to_owned())
    }

    fn points(&self) -> Vec<FairPoint> {
        let slips = self.method_specific.slips.iter();
        let slips: HashMap<usize, _> = slips.map(|s| (s.index, s.expected.into())).collect();
        let point = |m: &MoveResult| FairPoint {
            index: m.index,
            given: m.given.into(),
            now: m.now.into(),
            distance: m.distance.abs(),
            tolerance: m.tolerance,
            slip: slips.get(&m.index).copied(),
            at_limit: m.holds_back != 0.0,
        };
        self.method_specific.moves.iter().map(point).collect()
    }

    fn curve(&self, unit: LengthUnit) -> Result<FairCurveDrawing, ApiError> {
        let curve = self.curves.first();
        let curve = curve.ok_or_else(|| ApiError::internal(&"a fair curve without a curve"))?;
        let comb = self.method_specific.comb.iter().flatten();
        let drawing = FairCurveDrawing {
            title: self.title(),
            units: self.units.to_string(),
            dimension: self.method_specific.dimension,
            curve: curve.spline()?,
            before: None,
            points: self.points(),
            comb: comb
                .map(|t| Tooth {
                    s: t.s,
                    point: t.point.into(),
                    normal: Vector3::from(t.normal.0),
                    curvature: t.curvature,
                })
                .collect(),
            verdict: self.verdict.to_string(),
            summary: self.summary.clone(),
        };
        Ok(in_unit(drawing, self.units.into(), unit))
    }

    fn surface(&self, unit: LengthUnit) -> Result<FairSurfaceDrawing, ApiError> {
        let surface = self.surfaces.first();
        let surface =
            surface.ok_or_else(|| ApiError::internal(&"a fair surface without a surface"))?;
        let outline = self.method_specific.outline.clone();
        let (outer, holes) = outline.map_or_else(Default::default, |o| (o.outer, o.holes));
        let isophotes = self.method_specific.isophotes.as_ref();
        let drawing = FairSurfaceDrawing {
            title: self.title(),
            units: self.units.to_string(),
            surface: surface.tensor()?,
            outer,
            holes,
            points: self.points(),
            isophotes: isophotes.map(|i| Isophotes {
                u: i.u.clone(),
                v: i.v.clone(),
                values: (i.values.chunks(i.v.len().max(1)))
                    .map(|row| row.iter().map(|n| n.map(angle)).collect())
                    .collect(),
            }),
            verdict: self.verdict.to_string(),
            summary: self.summary.clone(),
        };
        Ok(in_unit(drawing, self.units.into(), unit))
    }

    fn offsets(&self, unit: LengthUnit) -> Result<OffsetsDrawing, ApiError> {
        let table = self.method_specific.table.as_ref();
        let table = table.ok_or_else(|| ApiError::internal(&"a faired table without a table"))?;
        let columns = table.waterlines.len();
        let slips = self.method_specific.slips.iter();
        let slips: HashMap<usize, f64> = slips.map(|s| (s.index, s.expected.0[1])).collect();
        let mut cells = Vec::new();
        for (i, row) in table.cells.iter().enumerate() {
            let cell = |(j, c): (usize, &super::table::CellResult)| Cell {
                old: c.old,
                new: c.new,
                slip: slips.get(&(i * columns + j)).copied(),
                filled: c.kind == CellWord::Filled,
            };
            cells.push(row.iter().enumerate().map(cell).collect());
        }
        let [mut stations, mut waterlines] = [table.stations.clone(), table.waterlines.clone()];
        let mut names = [table.station_names.clone(), table.waterline_names.clone()];
        if table.layout.stations_falling {
            stations.reverse();
            cells.reverse();
            names[0].iter_mut().for_each(|n| n.reverse());
        }
        if table.layout.waterlines_falling {
            waterlines.reverse();
            cells
                .iter_mut()
                .for_each(|row: &mut Vec<Cell>| row.reverse());
            names[1].iter_mut().for_each(|n| n.reverse());
        }
        let drawing = OffsetsDrawing {
            title: self.title(),
            units: self.units.to_string(),
            orientation: match table.layout.rows {
                TableRows::Stations => Orientation::WaterlinesAcross,
                TableRows::Waterlines => Orientation::StationsAcross,
            },
            stations,
            waterlines,
            names,
            cells,
            station_curves: self.family("station")?,
            waterline_curves: self.family("waterline")?,
            buttock_curves: self.family("buttock")?,
            verdict: self.verdict.to_string(),
            summary: self.summary.clone(),
        };
        Ok(in_unit(drawing, self.units.into(), unit))
    }

    /// The curves of one role with the coordinate that they share, which is
    /// in every one of their control points.
    fn family(&self, role: &str) -> Result<Vec<(f64, BSplineCurve)>, ApiError> {
        let axis = match role {
            "station" => 0,
            "buttock" => 1,
            _ => 2,
        };
        let own = self.curves.iter().filter(|c| c.role == role);
        // Adding zero makes −0 plain.
        own.map(|c| Ok((c.control_points[0].0[axis] + 0.0, c.spline()?)))
            .collect()
    }
}

/// The angle whose cosine is n·l, degrees.
fn angle(cosine: f64) -> f64 {
    cosine.clamp(-1.0, 1.0).acos().to_degrees()
}
