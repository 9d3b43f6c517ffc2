//! Points before and after fairing, and the loftsman's correction table.

use super::csv::{END_OF_RECORD, field, number_field};
use nalgebra::Point3;

/// One point that was faired.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FairPoint {
    /// The number that the user knows the point by.
    pub index: usize,
    /// Where it was given.
    pub given: Point3<f64>,
    /// Its place on the fair shape.
    pub now: Point3<f64>,
    /// How far it moved.
    pub distance: f64,
    /// How far it might; 0 for a locked point, `None` without a limit.
    pub tolerance: Option<f64>,
    /// Where the fair shape expects it, for a suspected slip.
    pub slip: Option<Point3<f64>>,
    /// Whether it uses all of its tolerance, and so holds the shape back.
    pub at_limit: bool,
}

impl FairPoint {
    /// Whether it can be drawn.
    pub(super) fn is_finite(&self) -> bool {
        let all = [Some(self.given), Some(self.now), self.slip];
        all.iter().flatten().all(super::plates::is_finite)
    }

    /// Whether it must stay where it is.
    #[must_use]
    pub fn is_locked(&self) -> bool {
        self.tolerance == Some(0.0)
    }

    /// Share of the tolerance that was used, 1 at the limit; `None` for points
    /// without a limit and for locked ones.
    #[must_use]
    pub fn used(&self) -> Option<f64> {
        let share = self.distance / self.tolerance?;
        share.is_finite().then_some(share)
    }
}

/// One record a point below one header record with the units: where it was,
/// where it is, the move by coordinate, its length, the tolerance and how much
/// of it was used, where a suspected slip was expected, and a note. Coordinates
/// are exact; moves are rounded to nine digits below the size of the model, so
/// that the dust of subtraction does not look like precision.
pub(super) fn correction_table(points: &[FairPoint], units: &str, dimension: usize) -> String {
    let axes = dimension.clamp(2, 3);
    let mut table = header(units, axes);
    let sizes = points.iter().flat_map(|p| p.given.iter().map(|c| c.abs()));
    let quantum = quantum(sizes.filter(|c| c.is_finite()).fold(0.0, f64::max));
    for point in points {
        table.push_str(&record(point, axes, quantum));
    }
    table
}

fn header(units: &str, axes: usize) -> String {
    let mut columns = vec!["index".to_owned()];
    for group in ["given", "new", "move"] {
        columns.extend(letters(axes).map(|axis| field(&format!("{group}_{axis} ({units})"))));
    }
    columns.extend(["distance", "tolerance"].map(|name| field(&format!("{name} ({units})"))));
    columns.push("used (%)".to_owned());
    columns.extend(letters(axes).map(|axis| field(&format!("expected_{axis} ({units})"))));
    columns.push("note".to_owned());
    columns.join(",") + END_OF_RECORD
}

fn letters(axes: usize) -> impl Iterator<Item = &'static str> {
    ["x", "y", "z"].into_iter().take(axes)
}

fn record(point: &FairPoint, axes: usize, quantum: f64) -> String {
    let mut fields = vec![point.index.to_string()];
    let mut triple = |p: &Point3<f64>| fields.extend(p.iter().take(axes).map(|c| number_field(*c)));
    triple(&point.given);
    triple(&point.now);
    let step = point.now - point.given;
    triple(&Point3::from(step.map(|c| rounded(c, quantum))));
    fields.push(number_field(rounded(point.distance, quantum)));
    fields.push(point.tolerance.map_or(String::new(), number_field));
    // A tenth of a per cent is finer than any tolerance is meant.
    let used = point.used().map(|share| rounded(share * 100.0, 0.1));
    fields.push(used.map_or(String::new(), number_field));
    match &point.slip {
        Some(expected) => fields.extend(expected.iter().take(axes).map(|c| number_field(*c))),
        None => fields.extend(std::iter::repeat_n(String::new(), axes)),
    }
    fields.push(note(point));
    fields.join(",") + END_OF_RECORD
}

/// What is special about a point.
fn note(point: &FairPoint) -> String {
    let notes = [
        (point.slip.is_some(), "suspected slip"),
        (point.is_locked(), "locked"),
        (point.at_limit && !point.is_locked(), "at limit"),
    ];
    let told: Vec<&str> = notes
        .iter()
        .filter(|(is, _)| *is)
        .map(|(_, n)| *n)
        .collect();
    told.join("; ")
}

/// The step that moves are rounded to in a model of this size: nine digits
/// below its leading one.
pub(super) fn quantum(size: f64) -> f64 {
    const DIGITS: i32 = 9;
    if !(size > 0.0 && size.is_finite()) {
        return 0.0;
    }
    10f64.powi(size.log10().floor() as i32 - DIGITS)
}

/// A number rounded to a multiple of a power of ten; itself where the power is
/// 0, and never -0.
pub(super) fn rounded(value: f64, quantum: f64) -> f64 {
    if quantum == 0.0 || !value.is_finite() {
        return value;
    }
    // Dividing by an exact power of ten gives the shortest decimals.
    let rounded = if quantum < 1.0 {
        let inverse = (1.0 / quantum).round();
        (value * inverse).round() / inverse
    } else {
        (value / quantum).round() * quantum
    };
    if rounded == 0.0 { 0.0 } else { rounded }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A point moved in y.
    pub fn moved(index: usize, x: f64, y: f64, step: f64) -> FairPoint {
        FairPoint {
            index,
            given: Point3::new(x, y, 0.0),
            now: Point3::new(x, y + step, 0.0),
            distance: step.abs(),
            tolerance: Some(0.02),
            slip: None,
            at_limit: false,
        }
    }

    #[test]
    fn the_table_tells_moves_and_notes() {
        let mut points = vec![
            moved(1, 1.0, 2.1, 0.01),
            moved(2, 3.0, 4.0, -0.02),
            moved(3, 5.0, 6.0, 0.0),
        ];
        points[1].at_limit = true;
        points[1].slip = Some(Point3::new(3.0, 3.9, 0.0));
        points[2].tolerance = Some(0.0);
        let table = correction_table(&points, "m", 2);
        let rows: Vec<&str> = table.split("\r\n").collect();
        assert_eq!(
            rows[0],
            "index,given_x (m),given_y (m),new_x (m),new_y (m),move_x (m),move_y (m),distance (m),tolerance (m),used (%),expected_x (m),expected_y (m),note"
        );
        assert_eq!(rows[1], "1,1,2.1,1,2.11,0,0.01,0.01,0.02,50,,,");
        assert_eq!(
            rows[2],
            "2,3,4,3,3.98,0,-0.02,0.02,0.02,100,3,3.9,suspected slip; at limit"
        );
        assert_eq!(rows[3], "3,5,6,5,6,0,0,0,0,,,,locked");
        assert!(rows.iter().take(4).all(|r| r.matches(',').count() == 12));
        let spatial = correction_table(&points, "m", 3);
        assert!(spatial.lines().all(|r| r.matches(',').count() == 16));
    }

    #[test]
    fn broken_points_leave_fields_empty() {
        let mut point = moved(1, f64::NAN, 2.0, 0.01);
        point.tolerance = None;
        let table = correction_table(&[point], "a,b", 2);
        assert!(table.starts_with("index,\"given_x (a,b)\""));
        assert!(
            table.ends_with("\r\n1,,2,,2.01,,0.01,0.01,,,,,\r\n"),
            "{table}"
        );
    }
}
