//! Drawings told in another unit: every length multiplied, every area by the
//! square, every curvature divided, and the new unit named.
//!
//! Each kind of drawing lists its own lengths; what is not listed has none.
//! Sentences stay as they are: they name the unit of the numbers in them.

use super::brep::{Path, SheetModel};
use super::cones::{ConeSheet, ConeSplineDrawing, EndRuling};
use super::cyclides::NetDrawing;
use super::fair_curve::FairCurveDrawing;
use super::fair_points::FairPoint;
use super::fair_surface::FairSurfaceDrawing;
use super::length_unit::LengthUnit;
use super::mesh_out::MeshDrawing;
use super::offsets::OffsetsDrawing;
use super::patterns::PatternSheet;
use super::plates::HullDrawing;
use crate::geometry::{BSplineCurve, BSplineSurface};
use nalgebra::{Point2, Point3};

/// A drawing whose lengths have a unit.
pub trait Measured {
    /// Multiplies every length.
    fn scale(&mut self, by: f64);
    /// Names the unit that the lengths have now.
    fn name_unit(&mut self, unit: LengthUnit);
}

/// The drawing with its lengths, which are in `from`, in `to`.
#[must_use]
pub fn in_unit<D: Measured>(mut drawing: D, from: LengthUnit, to: LengthUnit) -> D {
    if from != to {
        drawing.scale(from.in_terms_of(to));
        drawing.name_unit(to);
    }
    drawing
}

/// Something made of lengths.
trait Lengths {
    fn scale(&mut self, by: f64);
}

impl Lengths for f64 {
    fn scale(&mut self, by: f64) {
        *self *= by;
    }
}

impl Lengths for Point2<f64> {
    fn scale(&mut self, by: f64) {
        self.coords *= by;
    }
}

impl Lengths for Point3<f64> {
    fn scale(&mut self, by: f64) {
        self.coords *= by;
    }
}

impl Lengths for BSplineCurve {
    fn scale(&mut self, by: f64) {
        *self = self.scaled(by);
    }
}

impl Lengths for BSplineSurface {
    fn scale(&mut self, by: f64) {
        *self = self.scaled(by);
    }
}

impl<T: Lengths> Lengths for Option<T> {
    fn scale(&mut self, by: f64) {
        each(self, by);
    }
}

impl<T: Lengths> Lengths for Vec<T> {
    fn scale(&mut self, by: f64) {
        each(self, by);
    }
}

impl<T: Lengths, const N: usize> Lengths for [T; N] {
    fn scale(&mut self, by: f64) {
        each(self, by);
    }
}

fn each<'a, T: Lengths + 'a>(all: impl IntoIterator<Item = &'a mut T>, by: f64) {
    all.into_iter().for_each(|one| one.scale(by));
}

impl Measured for HullDrawing {
    fn scale(&mut self, by: f64) {
        for ruling in self.plates.iter_mut().flat_map(|p| &mut p.rulings) {
            ruling.from.scale(by);
            ruling.to.scale(by);
            ruling.bend_radius_from.scale(by);
            ruling.bend_radius_to.scale(by);
        }
        let rolls = self.plates.iter_mut().flat_map(|p| &mut p.rolls);
        each(rolls.map(|row| &mut row.flat), by);
        each(self.profiles.iter_mut().map(|p| &mut p.points), by);
    }

    fn name_unit(&mut self, unit: LengthUnit) {
        self.units = unit.to_string();
    }
}

impl Measured for ConeSplineDrawing {
    fn scale(&mut self, by: f64) {
        each(&mut self.sheets, by);
        each(&mut self.rulings, by);
    }

    fn name_unit(&mut self, unit: LengthUnit) {
        self.units = unit.to_string();
    }
}

impl Lengths for ConeSheet {
    fn scale(&mut self, by: f64) {
        self.apex.scale(by);
        if let Some((point, _direction)) = &mut self.axis {
            point.scale(by);
        }
        self.radius.scale(by);
        self.slant_range.scale(by);
        self.end_radii.scale(by);
        self.min_bend_radius.scale(by);
        self.sides.scale(by);
        self.area.scale(by * by);
        self.errors.scale(by);
    }
}

impl Lengths for EndRuling {
    fn scale(&mut self, by: f64) {
        self.ends.scale(by);
        self.flat.scale(by);
    }
}

impl Measured for NetDrawing {
    fn scale(&mut self, by: f64) {
        each(self.sheets.iter_mut().map(|s| &mut s.patches), by);
        for member in &mut self.members {
            member.radius.scale(by);
            member.length.scale(by);
        }
    }

    fn name_unit(&mut self, unit: LengthUnit) {
        self.units = unit.to_string();
    }
}

impl Lengths for FairPoint {
    fn scale(&mut self, by: f64) {
        self.given.scale(by);
        self.now.scale(by);
        self.distance.scale(by);
        self.tolerance.scale(by);
        self.slip.scale(by);
    }
}

impl Measured for FairCurveDrawing {
    fn scale(&mut self, by: f64) {
        self.curve.scale(by);
        self.before.scale(by);
        self.points.scale(by);
        for tooth in &mut self.comb {
            tooth.s.scale(by);
            tooth.point.scale(by);
            tooth.curvature /= by;
        }
    }

    fn name_unit(&mut self, unit: LengthUnit) {
        self.units = unit.to_string();
    }
}

impl Measured for FairSurfaceDrawing {
    fn scale(&mut self, by: f64) {
        self.surface.scale(by);
        self.points.scale(by);
    }

    fn name_unit(&mut self, unit: LengthUnit) {
        self.units = unit.to_string();
    }
}

impl Measured for OffsetsDrawing {
    fn scale(&mut self, by: f64) {
        self.stations.scale(by);
        self.waterlines.scale(by);
        for cell in self.cells.iter_mut().flatten() {
            cell.old.scale(by);
            cell.new.scale(by);
            cell.slip.scale(by);
        }
        let families = [
            &mut self.station_curves,
            &mut self.waterline_curves,
            &mut self.buttock_curves,
        ];
        for (place, curve) in families.into_iter().flatten() {
            place.scale(by);
            curve.scale(by);
        }
    }

    fn name_unit(&mut self, unit: LengthUnit) {
        self.units = unit.to_string();
    }
}

impl Measured for PatternSheet {
    fn scale(&mut self, by: f64) {
        for pattern in &mut self.patterns {
            pattern.outline.scale(by);
            pattern.line.scale(by);
            pattern.rulings.scale(by);
            each(pattern.labels.iter_mut().map(|(place, _)| place), by);
            each(pattern.cut.iter_mut().map(|corner| &mut corner.at), by);
            each(pattern.marks.iter_mut().map(|mark| &mut mark.line), by);
        }
    }

    fn name_unit(&mut self, unit: LengthUnit) {
        self.units = unit;
        self.unit_name = unit.to_string();
    }
}

impl Measured for SheetModel {
    fn scale(&mut self, by: f64) {
        each(self.sheets.iter_mut().map(|s| &mut s.surface), by);
        for wire in self.wires.iter_mut().flat_map(|g| &mut g.wires) {
            match &mut wire.path {
                Path::Line(ends) => ends.scale(by),
                Path::Spline(curve) => curve.scale(by),
            }
        }
    }

    fn name_unit(&mut self, unit: LengthUnit) {
        self.units = unit;
    }
}

impl Measured for MeshDrawing {
    fn scale(&mut self, by: f64) {
        self.vertices.scale(by);
        each(self.lines.iter_mut().map(|g| &mut g.lines), by);
        self.chordal_error.scale(by);
        let Some(quantity) = &mut self.quantity else {
            return;
        };
        let factor = by.powi(quantity.kind.power());
        quantity.limit.scale(factor);
        each(self.parts.iter_mut().map(|p| &mut p.values), factor);
    }

    fn name_unit(&mut self, unit: LengthUnit) {
        self.units = unit;
    }
}

#[cfg(test)]
mod tests;
