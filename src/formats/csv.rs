//! The roll table: one row a ruling, as RFC 4180 comma-separated values. A
//! ruling along which the flat pattern is cut has a row for either piece.
//!
//! Numbers are written with as many digits as it takes to read the same bits
//! back. A flat place has no bend radius: its field is empty. Spreadsheets run
//! text that begins with `=`, `+`, `-` or `@` as a formula, so such a plate
//! name gets a leading apostrophe.

use super::plates::{HullDrawing, RollRow, RulingLine};

/// RFC 4180 §2: records end in CR LF.
pub(super) const END_OF_RECORD: &str = "\r\n";

/// One record a ruling below one header record that carries the units; plates
/// and rulings in the order of the drawing, rulings counted from 1. A plate that
/// has no flat pattern has its rulings in space alone.
#[must_use]
pub fn roll_table(hull: &HullDrawing) -> String {
    let mut table = header(&hull.units);
    for plate in &hull.plates {
        let name = field(&harmless(&plate.name));
        if plate.rolls.is_empty() {
            for (index, ruling) in plate.rulings.iter().enumerate() {
                table.push_str(&record(&name, index + 1, ruling, None));
            }
        }
        for row in &plate.rolls {
            if let Some(ruling) = plate.rulings.get(row.ruling) {
                table.push_str(&record(&name, row.ruling + 1, ruling, Some(row)));
            }
        }
    }
    table
}

/// The first record: a name for each column with its unit.
fn header(units: &str) -> String {
    let lengths = |name: &str| field(&format!("{name} ({units})"));
    let columns = [
        "plate".to_owned(),
        "ruling".to_owned(),
        "u".to_owned(),
        lengths("from_x"),
        lengths("from_y"),
        lengths("from_z"),
        lengths("to_x"),
        lengths("to_y"),
        lengths("to_z"),
        lengths("length"),
        "twist (deg)".to_owned(),
        lengths("bend_radius_from"),
        lengths("bend_radius_to"),
        "piece".to_owned(),
        lengths("flat_from_x"),
        lengths("flat_from_y"),
        lengths("flat_to_x"),
        lengths("flat_to_y"),
        "angle_to_base_line (deg)".to_owned(),
        "bend_up_to_next (deg)".to_owned(),
        "strain (%)".to_owned(),
    ];
    columns.join(",") + END_OF_RECORD
}

/// One ruling, its plate's name already quoted.
fn record(plate: &str, number: usize, ruling: &RulingLine, row: Option<&RollRow>) -> String {
    let RulingLine {
        u,
        from,
        to,
        twist_deg,
        bend_radius_from,
        bend_radius_to,
    } = ruling;
    let length = (to - from).norm();
    let numbers = [
        *u,
        from.x,
        from.y,
        from.z,
        to.x,
        to.y,
        to.z,
        length,
        *twist_deg,
        *bend_radius_from,
        *bend_radius_to,
    ];
    let mut fields: Vec<String> = numbers.iter().map(|n| number_field(*n)).collect();
    let flat = row.map_or([f64::NAN; 7], |row| {
        let [from, to] = row.flat;
        let RollRow {
            angle_deg,
            bend_deg,
            strain_percent,
            ..
        } = row;
        [
            from.x,
            from.y,
            to.x,
            to.y,
            *angle_deg,
            *bend_deg,
            *strain_percent,
        ]
    });
    fields.push(row.map_or_else(String::new, |row| row.piece.to_string()));
    fields.extend(flat.iter().map(|n| number_field(*n)));
    format!("{plate},{number},{}{END_OF_RECORD}", fields.join(","))
}

/// Shortest text that reads back as the same number; empty when there is none.
pub(super) fn number_field(number: f64) -> String {
    if number.is_finite() {
        format!("{number}")
    } else {
        String::new()
    }
}

/// Quotes a text where the format demands it (RFC 4180 §2.5–2.7).
pub(super) fn field(text: &str) -> String {
    if text.contains(['"', ',', '\r', '\n']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

/// Keeps a spreadsheet from taking a user's name for a formula.
pub(super) fn harmless(text: &str) -> String {
    if text.starts_with(['=', '+', '-', '@', '\t', '\r']) {
        format!("'{text}")
    } else {
        text.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::super::plates::PlateDrawing;
    use super::*;
    use nalgebra::{Point2, Point3};

    fn hull(name: &str, radius: f64) -> HullDrawing {
        let ruling = RulingLine {
            u: 0.1,
            from: Point3::new(1.0, 2.0, 3.0),
            to: Point3::new(4.0, 6.0, 3.0),
            twist_deg: -1.25,
            bend_radius_from: radius,
            bend_radius_to: 1.0 / 3.0,
        };
        HullDrawing {
            title: "t".into(),
            units: "ft".into(),
            twist_limit_deg: 6.0,
            plates: vec![PlateDrawing {
                name: name.into(),
                rulings: vec![ruling],
                rolls: Vec::new(),
                within_limits: true,
            }],
            profiles: Vec::new(),
            verdict: String::new(),
            summary: Vec::new(),
        }
    }

    #[test]
    fn a_row_carries_the_ruling_and_its_length() {
        let table = roll_table(&hull("deck – chine", 12.5));
        let rows: Vec<&str> = table.split("\r\n").collect();
        assert!(rows[0].starts_with("plate,ruling,u,from_x (ft)"));
        assert_eq!(
            rows[1],
            "deck – chine,1,0.1,1,2,3,4,6,3,5,-1.25,12.5,0.3333333333333333,,,,,,,,"
        );
        assert_eq!(rows[2], "", "the last record ends too");
        assert_eq!(rows[0].matches(',').count(), rows[1].matches(',').count());
    }

    #[test]
    fn a_cut_ruling_has_a_row_for_either_piece() {
        let row = |piece: usize, x: f64| RollRow {
            piece,
            ruling: 0,
            flat: [Point2::new(x, 0.0), Point2::new(x, 5.0)],
            angle_deg: 90.0,
            bend_deg: -0.5,
            strain_percent: 0.01,
        };
        let mut hull = hull("a", 1.0);
        hull.plates[0].rolls = vec![row(1, 7.0), row(2, 0.0)];
        let table = roll_table(&hull);
        let rows: Vec<&str> = table.split("\r\n").collect();
        assert!(rows[1].starts_with("a,1,0.1,") && rows[1].ends_with(",1,7,0,7,5,90,-0.5,0.01"));
        assert!(rows[2].starts_with("a,1,0.1,") && rows[2].ends_with(",2,0,0,0,5,90,-0.5,0.01"));
        assert_eq!(rows[0].matches(',').count(), rows[1].matches(',').count());
    }

    #[test]
    fn a_flat_place_has_no_radius() {
        assert!(roll_table(&hull("a", f64::INFINITY)).contains("-1.25,,0.33"));
    }

    #[test]
    fn names_are_quoted_and_disarmed() {
        assert!(roll_table(&hull("a, \"b\"", 1.0)).contains("\"a, \"\"b\"\"\",1,"));
        assert!(roll_table(&hull("=1+1", 1.0)).contains("'=1+1,1,"));
    }
}
