//! A strip of cones, cylinders and planes as its writers draw it, and the table
//! of its workshop sheets.

use super::csv::{END_OF_RECORD, field, harmless, number_field};
use super::mesh_out::ConeGrid;
use nalgebra::{Point2, Point3, Vector3};

/// A strip to be written as a file; all lengths in
/// [`ConeSplineDrawing::units`].
#[derive(Debug, Clone, PartialEq)]
pub struct ConeSplineDrawing {
    /// The user's label of the job, or a name for it.
    pub title: String,
    /// Unit of every length, as the user wrote it.
    pub units: String,
    /// `within_limits` or `outside_limits`.
    pub verdict: String,
    /// The patches in order.
    pub sheets: Vec<ConeSheet>,
    /// The rulings that bound them, one more.
    pub rulings: Vec<EndRuling>,
}

/// What a patch is rolled from.
#[derive(Debug, Clone, PartialEq)]
pub struct ConeSheet {
    /// Its name.
    pub name: String,
    /// `cone`, `cylinder` or `plane`.
    pub kind: &'static str,
    /// Apex of a cone.
    pub apex: Option<Point3<f64>>,
    /// Point and direction of the axis.
    pub axis: Option<(Point3<f64>, Vector3<f64>)>,
    /// Of a cone, degrees.
    pub half_angle_deg: Option<f64>,
    /// Of a cylinder.
    pub radius: Option<f64>,
    /// Least and largest distance from the apex.
    pub slant_range: [f64; 2],
    /// Radii at either end of it.
    pub end_radii: Option<[f64; 2]>,
    /// By how much it is rolled, degrees.
    pub turn_deg: f64,
    /// `None` for a plane.
    pub min_bend_radius: Option<f64>,
    /// Of the outer fibre, percent.
    pub bend_strain_percent: Option<f64>,
    /// `front` or `back`.
    pub bend_side: Option<&'static str>,
    /// Points along side 0 and side 1, on the patch.
    pub sides: [Vec<Point3<f64>>; 2],
    /// Places all over it.
    pub grid: ConeGrid,
    /// Its area.
    pub area: f64,
    /// Largest and mean distance of the strip's vertices.
    pub errors: [f64; 2],
}

/// A ruling at the end of a patch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EndRuling {
    /// Its number.
    pub id: usize,
    /// On side 0 and side 1.
    pub ends: [Point3<f64>; 2],
    /// The same in the flat pattern.
    pub flat: [Point2<f64>; 2],
}

/// The workshop sheets as RFC 4180 comma-separated values, one record a patch,
/// its two end rulings in space and in the flat pattern included. Lengths carry
/// their unit in the header; what a kind of patch does not have stays empty.
#[must_use]
pub fn workshop_table(drawing: &ConeSplineDrawing) -> String {
    let records: Vec<Vec<(String, String)>> = (drawing.sheets.iter())
        .zip(drawing.rulings.windows(2))
        .map(|(sheet, ends)| record(sheet, [&ends[0], &ends[1]], &drawing.units))
        .collect();
    let mut table = String::new();
    if let Some(first) = records.first() {
        let names: Vec<String> = first.iter().map(|(name, _)| field(name)).collect();
        table += &(names.join(",") + END_OF_RECORD);
    }
    for record in records {
        let values: Vec<String> = record.into_iter().map(|(_, value)| value).collect();
        table += &(values.join(",") + END_OF_RECORD);
    }
    table
}

/// Names and values of one patch.
fn record(sheet: &ConeSheet, ends: [&EndRuling; 2], units: &str) -> Vec<(String, String)> {
    let mut fields = vec![
        ("patch".to_owned(), field(&harmless(&sheet.name))),
        ("kind".to_owned(), sheet.kind.to_owned()),
    ];
    let mut number = |name: &str, unit: &str, value: Option<f64>| {
        let value = value.map_or(String::new(), number_field);
        let unit = if unit.is_empty() {
            String::new()
        } else {
            format!(" ({unit})")
        };
        fields.push((format!("{name}{unit}"), value));
    };
    let axes = ["x", "y", "z"];
    let place = |name: &str, axis: usize| format!("{name}_{}", axes[axis]);
    for k in 0..3 {
        number(&place("apex", k), units, sheet.apex.map(|p| p[k]));
    }
    for k in 0..3 {
        number(&place("axis", k), units, sheet.axis.map(|(p, _)| p[k]));
    }
    for k in 0..3 {
        number(
            &place("axis_direction", k),
            "",
            sheet.axis.map(|(_, d)| d[k]),
        );
    }
    number("half_angle", "deg", sheet.half_angle_deg);
    number("radius", units, sheet.radius);
    number("slant_from", units, Some(sheet.slant_range[0]));
    number("slant_to", units, Some(sheet.slant_range[1]));
    number("end_radius_from", units, sheet.end_radii.map(|r| r[0]));
    number("end_radius_to", units, sheet.end_radii.map(|r| r[1]));
    number("turn", "deg", Some(sheet.turn_deg));
    number("min_bend_radius", units, sheet.min_bend_radius);
    number("bend_strain", "percent", sheet.bend_strain_percent);
    number("area", &format!("{units}²"), Some(sheet.area));
    number("error_max", units, Some(sheet.errors[0]));
    number("error_mean", units, Some(sheet.errors[1]));
    for (which, ruling) in ["first", "last"].iter().zip(ends) {
        for (end, p) in ["from", "to"].iter().zip(&ruling.ends) {
            for k in 0..3 {
                number(
                    &place(&format!("{which}_ruling_{end}"), k),
                    units,
                    Some(p[k]),
                );
            }
        }
        for (end, p) in ["from", "to"].iter().zip(&ruling.flat) {
            for k in 0..2 {
                number(
                    &place(&format!("{which}_ruling_flat_{end}"), k),
                    units,
                    Some(p[k]),
                );
            }
        }
    }
    let side = sheet.bend_side.unwrap_or_default().to_owned();
    fields.insert(2, ("bend_side".to_owned(), side));
    fields.insert(3, ("first_ruling".to_owned(), ends[0].id.to_string()));
    fields.insert(4, ("last_ruling".to_owned(), ends[1].id.to_string()));
    fields
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawing() -> ConeSplineDrawing {
        let side = |y: f64, xs: &[f64]| xs.iter().map(|x| Point3::new(*x, y, 0.0)).collect();
        let sheet = |name: &str, a: &[f64], b: &[f64]| ConeSheet {
            name: name.into(),
            kind: "plane",
            apex: None,
            axis: None,
            half_angle_deg: None,
            radius: None,
            slant_range: [0.0, 1.0],
            end_radii: None,
            turn_deg: 0.0,
            min_bend_radius: None,
            bend_strain_percent: None,
            bend_side: None,
            sides: [side(1.0, a), side(0.0, b)],
            grid: ConeGrid::default(),
            area: 2.0,
            errors: [0.5, 0.25],
        };
        let ruling = |id: usize, x: f64| EndRuling {
            id,
            ends: [Point3::new(x, 1.0, 0.0), Point3::new(x, 0.0, 0.0)],
            flat: [Point2::new(x, 1.0), Point2::new(x, 0.0)],
        };
        ConeSplineDrawing {
            title: "shelf".into(),
            units: "m".into(),
            verdict: "within_limits".into(),
            sheets: vec![
                sheet("=1", &[0.0, 0.5, 2.0], &[0.0, 2.0]),
                sheet("b, 2", &[2.0, 3.0], &[2.0, 2.2, 2.9, 3.0]),
            ],
            rulings: vec![ruling(0, 0.0), ruling(1, 2.0), ruling(2, 3.0)],
        }
    }

    #[test]
    fn the_table_has_a_record_a_patch_and_keeps_spreadsheets_calm() {
        let table = workshop_table(&drawing());
        let lines: Vec<&str> = table.split("\r\n").collect();
        assert_eq!(lines.len(), 4);
        assert!(lines[0].starts_with("patch,kind,bend_side,first_ruling,last_ruling,apex_x (m)"));
        assert!(lines[1].starts_with("'=1,plane,,0,1,,,"));
        assert!(lines[2].starts_with("\"b, 2\",plane,,1,2,"));
        let columns = |line: &str| line.replace("b, 2", "b").split(',').count();
        assert_eq!(columns(lines[1]), columns(lines[0]));
        assert_eq!(columns(lines[2]), columns(lines[0]));
    }
}
