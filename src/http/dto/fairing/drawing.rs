//! From a stored result to what the file writers draw.

use super::FairingResult;
use super::TableRows;
use super::result::{FairedKind, MoveResult};
use super::table::CellWord;
use crate::formats::brep::SheetModel;
use crate::formats::fair_curve::{self, FairCurveDrawing, Tooth};
use crate::formats::fair_points::FairPoint;
use crate::formats::fair_surface::{self, FairSurfaceDrawing, Isophotes};
use crate::formats::offsets::{self, Cell, OffsetsDrawing, Orientation};
use crate::geometry::BSplineCurve;
use crate::http::dto::cad;
use crate::http::methods::Format;
use crate::http::problem::{ApiError, Code};
use nalgebra::Vector3;
use std::collections::HashMap;

/// The title of a drawing whose job has no label.
const UNTITLED: &str = "Fairing";

impl FairingResult {
    /// The result in another form.
    ///
    /// # Errors
    /// `format-not-available` for the mesh of a curve; a stored result whose
    /// splines are none.
    pub fn write(&self, format: Format) -> Result<String, ApiError> {
        match (self.method_specific.kind, format) {
            (_, Format::Json | Format::Dxf) => Err(ApiError::internal(&"no form to be written")),
            (_, Format::Step | Format::Igs) => cad::write(&self.sheet_model()?, format),
            (FairedKind::Curve, Format::Obj) => {
                let detail = "a curve has no mesh; there are json, csv, svg, step, igs";
                Err(ApiError::new(Code::FormatNotAvailable, detail))
            }
            (FairedKind::Curve, Format::Csv) => Ok(fair_curve::correction_table(&self.curve()?)),
            (FairedKind::Curve, Format::Svg) => Ok(fair_curve::plot(&self.curve()?)),
            (FairedKind::Offsets, Format::Csv) => Ok(offsets::table(&self.offsets()?)),
            (FairedKind::Offsets, Format::Svg) => Ok(offsets::lines_plan(&self.offsets()?)),
            (FairedKind::Surface, Format::Csv) => {
                Ok(fair_surface::correction_table(&self.surface()?))
            }
            (FairedKind::Surface, Format::Svg) => Ok(fair_surface::plot(&self.surface()?)),
            (FairedKind::Surface | FairedKind::Offsets, Format::Obj) => {
                Ok(fair_surface::mesh(&self.surface()?))
            }
        }
    }

    fn sheet_model(&self) -> Result<SheetModel, ApiError> {
        Ok(SheetModel {
            title: self.title(),
            description: format!("{}; surfaces reach beyond their points", self.verdict),
            units: self.units.into(),
            sheets: cad::sheets(&self.surfaces)?,
            wires: vec![cad::wires("curves", &self.curves)?],
        })
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

    fn curve(&self) -> Result<FairCurveDrawing, ApiError> {
        let curve = self.curves.first();
        let curve = curve.ok_or_else(|| ApiError::internal(&"a fair curve without a curve"))?;
        let comb = self.method_specific.comb.iter().flatten();
        Ok(FairCurveDrawing {
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
        })
    }

    fn surface(&self) -> Result<FairSurfaceDrawing, ApiError> {
        let surface = self.surfaces.first();
        let surface =
            surface.ok_or_else(|| ApiError::internal(&"a fair surface without a surface"))?;
        let outline = self.method_specific.outline.clone();
        let (outer, holes) = outline.map_or_else(Default::default, |o| (o.outer, o.holes));
        let isophotes = self.method_specific.isophotes.as_ref();
        Ok(FairSurfaceDrawing {
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
        })
    }

    fn offsets(&self) -> Result<OffsetsDrawing, ApiError> {
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
        Ok(OffsetsDrawing {
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
        })
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
