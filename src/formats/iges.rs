//! IGES 5.3: surfaces and curves for older CAD.
//!
//! | what | entity |
//! |---|---|
//! | surface | 128, rational B-spline surface |
//! | part of a surface | 144, trimmed; its bound 142 in space and in (u, v), each 102 |
//! | curve | 126, rational B-spline curve |
//! | straight line | 110 |
//! | name | 406 form 15, attached to each |
//!
//! The unit stands in the global section. IGES knows no shared edges: a reader
//! that wants a shell sews. The file holds no time and no host, so that the
//! same model gives the same bytes; the date it must have is that of the
//! specification.

mod records;

use super::brep::{Path, Sheet, SheetModel, bounds};
use super::length_unit::LengthUnit;
use crate::geometry::{Axis, BSplineCurve, BSplineSurface, BoundingBox};
use nalgebra::Point3;
use records::{Field, Records, Role};

/// Any date will do but none may be missing: 1996, when IGES 5.3 was printed.
const DATE: &str = "19960101.000000";

/// The smallest distance that the file tells apart, of the model's size.
const RESOLUTION: f64 = 1e-7;

/// The model as an IGES file.
#[must_use]
pub fn write(model: &SheetModel) -> String {
    let mut records = Records::default();
    for sheet in &model.sheets {
        add_sheet(&mut records, sheet);
    }
    for wire in model.wires.iter().flat_map(|g| &g.wires) {
        match &wire.path {
            Path::Spline(spline) => records.add(126, 0, &curve(spline), &wire.name),
            Path::Line(ends) => {
                let fields: Vec<Field> = ends.iter().flat_map(coordinates).collect();
                records.add(110, 0, &fields, &wire.name);
            }
        }
    }
    let start = format!("{}: {}", model.title, model.description);
    records.file(&start, &global(model))
}

/// A surface, or the part of it that is meant.
fn add_sheet(records: &mut Records, sheet: &Sheet) {
    let bounds = bounds(sheet);
    let whole = surface(&sheet.surface);
    if bounds.is_empty() {
        return records.add(128, 0, &whole, &sheet.name);
    }
    let whole = records.entity(128, 0, &whole, Role::Part);
    let mut composite = |role: Role, curves: Vec<&BSplineCurve>| {
        let parts = curves
            .into_iter()
            .map(|c| records.entity(126, 0, &curve(c), role));
        let parts: Vec<usize> = parts.collect();
        let list = std::iter::once(parts.len()).chain(parts).map(Field::count);
        records.entity(102, 0, &list.collect::<Vec<_>>(), role)
    };
    let plane = composite(Role::Parametric, bounds.iter().map(|b| &b.under).collect());
    let space = composite(Role::Part, bounds.iter().map(|b| &b.curve).collect());
    // Made in no particular way; both curves are as good.
    let [made, preferred] = [0, 3].map(Field::Integer);
    let fields = [
        made,
        Field::count(whole),
        Field::count(plane),
        Field::count(space),
        preferred,
    ];
    let bound = records.entity(142, 0, &fields, Role::Part);
    // The outer bound is not that of the surface; no holes.
    let fields = [
        Field::count(whole),
        Field::Integer(1),
        Field::Integer(0),
        Field::count(bound),
    ];
    records.add(144, 0, &fields, &sheet.name);
}

/// The global section's fields, 3 to 26; the first two, the delimiters, are
/// those that are the default.
fn global(model: &SheetModel) -> Vec<Field> {
    let (flag, unit) = match model.units {
        LengthUnit::Inch => (1, "IN"),
        LengthUnit::Millimetre => (2, "MM"),
        LengthUnit::Foot => (4, "FT"),
        LengthUnit::Metre => (6, "M"),
        LengthUnit::Centimetre => (10, "CM"),
    };
    let version = concat!("mouldloft ", env!("CARGO_PKG_VERSION"));
    let points = (model.sheets.iter()).flat_map(|s| s.surface.control_points());
    let bounds = BoundingBox::of(points);
    let size = bounds.map_or(1.0, |b| b.longest_side());
    let largest = bounds.map_or(1.0, |b| b.min.coords.amax().max(b.max.coords.amax()));
    vec![
        Field::text(&model.title),
        Field::text(&model.title),
        Field::text(version),
        Field::text(version),
        // Bits of an integer; decimal range and digits of single and double.
        Field::Integer(32),
        Field::Integer(38),
        Field::Integer(6),
        Field::Integer(308),
        Field::Integer(15),
        Field::text(&model.title),
        Field::Real(1.0),
        Field::Integer(flag),
        Field::text(unit),
        // Line weights: one, of no particular width.
        Field::Integer(1),
        Field::Real(0.0),
        Field::text(DATE),
        Field::Real(RESOLUTION * size),
        Field::Real(largest),
        Field::text(""),
        Field::text(""),
        // Version 5.3, no drafting standard.
        Field::Integer(11),
        Field::Integer(0),
        Field::text(DATE),
    ]
}

fn surface(surface: &BSplineSurface) -> Vec<Field> {
    let [n, m] = surface.counts();
    let [p, q] = surface.degrees();
    let rational = surface.weights().is_some();
    let mut fields: Vec<Field> = [n - 1, m - 1, p, q].map(Field::count).to_vec();
    // Closed in u, in v; polynomial; periodic in u, in v.
    fields.extend([0, 0, i64::from(!rational), 0, 0].map(Field::Integer));
    fields.extend(surface.knots().iter().flatten().map(|u| Field::Real(*u)));
    // IGES runs through u first.
    let order = (0..m).flat_map(|j| (0..n).map(move |i| i * m + j));
    let weight = |k: usize| Field::Real(surface.weights().map_or(1.0, |w| w[k]));
    fields.extend(order.clone().map(weight));
    fields.extend(order.flat_map(|k| coordinates(&surface.control_points()[k])));
    for axis in [Axis::U, Axis::V] {
        fields.extend(surface.domain(axis).map(Field::Real));
    }
    fields
}

fn curve(curve: &BSplineCurve) -> Vec<Field> {
    let count = curve.control_points().len();
    let rational = curve.weights().is_some();
    let mut fields: Vec<Field> = [count - 1, curve.degree()].map(Field::count).to_vec();
    let closed = curve.start() == curve.end();
    // In a plane (not told); closed; polynomial; periodic.
    fields.extend([0, i64::from(closed), i64::from(!rational), 0].map(Field::Integer));
    fields.extend(curve.knots().iter().map(|u| Field::Real(*u)));
    let weight = |k: usize| Field::Real(curve.weights().map_or(1.0, |w| w[k]));
    fields.extend((0..count).map(weight));
    fields.extend(curve.control_points().iter().flat_map(coordinates));
    fields.extend(curve.domain().map(Field::Real));
    // The normal of a plane that it is not said to lie in.
    fields.extend([0.0; 3].map(Field::Real));
    fields
}

fn coordinates(p: &Point3<f64>) -> [Field; 3] {
    [p.x, p.y, p.z].map(Field::Real)
}

#[cfg(test)]
mod tests;
