//! A faired table of offsets as its writers draw it: the table itself and the
//! lines plan.
//!
//! Coordinates of the curves: x along the ship, forward, y half-breadth, z
//! height.

use super::csv::{END_OF_RECORD, field, number_field};
use super::fair_points::{quantum, rounded};
pub use super::points_in::Orientation;
use super::svg;
use crate::geometry::BSplineCurve;

/// A faired table to be written as a file; all lengths in
/// [`OffsetsDrawing::units`].
#[derive(Debug, Clone, PartialEq)]
pub struct OffsetsDrawing {
    /// The user's label of the job, or a name for it.
    pub title: String,
    /// Unit of every length, as the user wrote it.
    pub units: String,
    /// How the table lay when it came, and lies when it is written.
    pub orientation: Orientation,
    /// Places of the stations, in the user's order.
    pub stations: Vec<f64>,
    /// Heights of the waterlines, in the user's order.
    pub waterlines: Vec<f64>,
    /// The user's names of stations and waterlines, in the same orders.
    pub names: [Option<Vec<String>>; 2],
    /// Half-breadths `[station][waterline]`.
    pub cells: Vec<Vec<Cell>>,
    /// Faired stations by their place.
    pub station_curves: Vec<(f64, BSplineCurve)>,
    /// Faired waterlines by their height.
    pub waterline_curves: Vec<(f64, BSplineCurve)>,
    /// Buttocks by their half-breadth.
    pub buttock_curves: Vec<(f64, BSplineCurve)>,
    /// `within_limits` or `outside_limits`.
    pub verdict: String,
    /// Sentences about the result.
    pub summary: Vec<String>,
}

/// One half-breadth.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Cell {
    /// As given; `None` where the table had none.
    pub old: Option<f64>,
    /// As faired; `None` outside the hull.
    pub new: Option<f64>,
    /// What the fair shape expects, for a suspected slip.
    pub slip: Option<f64>,
    /// Whether the table had none and the fair shape gives it.
    pub filled: bool,
}

impl Cell {
    /// How far it moved, outwards positive; `None` without both values.
    #[must_use]
    pub fn step(&self) -> Option<f64> {
        let step = self.new? - self.old?;
        step.is_finite().then_some(step)
    }
}

/// A cell and where it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Placed {
    /// Place of its station.
    pub station: f64,
    /// Height of its waterline.
    pub waterline: f64,
    /// The half-breadths.
    pub cell: Cell,
}

/// All cells whose station and waterline are known, station by station.
pub(super) fn placed(drawing: &OffsetsDrawing) -> impl Iterator<Item = Placed> + '_ {
    let rows = drawing.stations.iter().zip(&drawing.cells);
    rows.flat_map(|(station, row)| {
        drawing
            .waterlines
            .iter()
            .zip(row)
            .map(|(waterline, cell)| Placed {
                station: *station,
                waterline: *waterline,
                cell: *cell,
            })
    })
}

/// Cells that moved, the largest move first; equal ones in the order of the
/// table.
pub(super) fn by_size(drawing: &OffsetsDrawing) -> Vec<Placed> {
    let size = |p: &Placed| p.cell.step().map_or(0.0, f64::abs);
    let mut moved: Vec<Placed> = placed(drawing).filter(|p| size(p) > 0.0).collect();
    moved.sort_by(|a, b| size(b).total_cmp(&size(a)));
    moved
}

/// The table as RFC 4180 comma-separated values: the new half-breadths, the
/// old ones and the moves in the layout that the table came in, then the cells
/// that moved or were filled, by the size of the move. Computed lengths are
/// rounded to nine digits below the leading one of the greatest half-breadth:
/// far finer than wood or steel, and without the dust of binary fractions.
#[must_use]
pub fn table(drawing: &OffsetsDrawing) -> String {
    let quantum = quantum_of(drawing);
    let step = |c: &Cell| c.step().map(|s| rounded(s, quantum));
    let blocks = [
        block(drawing, "New half-breadths", |c| {
            c.new.map(|y| rounded(y, quantum))
        }),
        block(drawing, "Old half-breadths", |c| c.old),
        block(drawing, "Moves, outwards positive", step),
        list(drawing, quantum),
    ];
    // An empty record sets the blocks apart in a spreadsheet.
    blocks.join(END_OF_RECORD)
}

fn quantum_of(drawing: &OffsetsDrawing) -> f64 {
    let values = drawing
        .cells
        .iter()
        .flatten()
        .filter_map(|c| c.new.or(c.old));
    let largest = values.map(f64::abs).filter(|v| v.is_finite());
    quantum(largest.fold(0.0, f64::max))
}

/// One value of every cell, below a record that says which.
fn block(drawing: &OffsetsDrawing, name: &str, value: impl Fn(&Cell) -> Option<f64>) -> String {
    let number = |v: Option<f64>| v.map_or(String::new(), number_field);
    let cell = |i: usize, j: usize| {
        let cell = drawing.cells.get(i).and_then(|row| row.get(j));
        number(cell.and_then(&value))
    };
    let [stations, waterlines] = [
        ("station", "x", &drawing.stations, &drawing.names[0]),
        ("waterline", "z", &drawing.waterlines, &drawing.names[1]),
    ];
    let (across, down) = match drawing.orientation {
        Orientation::WaterlinesAcross => (waterlines, stations),
        Orientation::StationsAcross => (stations, waterlines),
    };
    let mut text = field(&format!("{name} ({})", drawing.units)) + END_OF_RECORD;
    let mut record = |start: &[String], cells: &mut dyn Iterator<Item = String>| {
        let fields: Vec<String> = start.iter().cloned().chain(cells).collect();
        text.push_str(&fields.join(","));
        text.push_str(END_OF_RECORD);
    };
    // Names have their places in a column, or in a row, of their own.
    let place_head = format!("{} ({})", down.1, drawing.units);
    let corner = format!("{} \\ {}", down.0, across.0);
    let start = |first: String| match down.3 {
        Some(_) => vec![first, field(&place_head)],
        None => vec![first],
    };
    let mut places = across.2.iter().map(|v| number_field(*v));
    match across.3 {
        Some(names) => {
            record(&start(corner), &mut names.iter().map(|n| field(n)));
            let mut head = vec![field(&format!("{} ({})", across.1, drawing.units))];
            head.extend(down.3.is_some().then(String::new));
            record(&head, &mut places);
        }
        None => record(&start(corner), &mut places),
    }
    for (i, place) in down.2.iter().enumerate() {
        let mut values = (0..across.2.len()).map(|j| match drawing.orientation {
            Orientation::WaterlinesAcross => cell(i, j),
            Orientation::StationsAcross => cell(j, i),
        });
        let name = down.3.as_ref().and_then(|names| names.get(i));
        let mut start = Vec::from_iter(name.map(|n| field(n)));
        start.push(number_field(*place));
        record(&start, &mut values);
    }
    text
}

/// Cells that moved by size, then suspected slips that did not move, then
/// filled cells.
fn list(drawing: &OffsetsDrawing, quantum: f64) -> String {
    let lengths = ["station", "waterline", "old", "new", "move", "expected"];
    let lengths = lengths.map(|name| field(&format!("{name} ({})", drawing.units)));
    let mut text = field(&format!("Moves by size ({})", drawing.units)) + END_OF_RECORD;
    text.push_str(&format!("{},note{END_OF_RECORD}", lengths.join(",")));
    let mut listed = by_size(drawing);
    let rest = |p: &Placed| p.cell.step().is_none_or(|s| s == 0.0);
    listed.extend(placed(drawing).filter(|p| rest(p) && p.cell.slip.is_some()));
    listed.extend(placed(drawing).filter(|p| rest(p) && p.cell.slip.is_none() && p.cell.filled));
    for place in &listed {
        text.push_str(&record(place, quantum));
    }
    text
}

fn record(place: &Placed, quantum: f64) -> String {
    let Placed {
        station,
        waterline,
        cell,
    } = place;
    let numbers = [
        Some(*station),
        Some(*waterline),
        cell.old,
        cell.new.map(|y| rounded(y, quantum)),
        cell.step().map(|s| rounded(s, quantum)),
        cell.slip.map(|y| rounded(y, quantum)),
    ];
    let mut fields: Vec<String> = numbers
        .iter()
        .map(|n| n.map_or(String::new(), number_field))
        .collect();
    let notes = [
        (cell.slip.is_some(), "suspected slip"),
        (cell.filled, "filled"),
    ];
    let told: Vec<&str> = notes
        .iter()
        .filter(|(is, _)| *is)
        .map(|(_, n)| *n)
        .collect();
    fields.push(told.join("; "));
    fields.join(",") + END_OF_RECORD
}

/// A page of SVG: body plan with the old offsets as ticks, profile with the
/// buttocks, half-breadth plan with the waterlines.
#[must_use]
pub fn lines_plan(drawing: &OffsetsDrawing) -> String {
    svg::offsets::plot(drawing)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::geometry::{Parametrization, interpolate};
    use nalgebra::Point3;

    fn half_breadth(x: f64, z: f64) -> f64 {
        2.0 * (1.0 - x * x / 25.0) * (0.2 + z).sqrt()
    }

    /// A small hull, five stations by three waterlines; one cell moved, one
    /// filled, one a slip.
    pub fn hull() -> OffsetsDrawing {
        let stations: Vec<f64> = (0..5).map(|i| 2.0 * f64::from(i) - 4.0).collect();
        let waterlines = vec![0.0, 0.5, 1.0];
        let cell = |x: f64, z: f64| {
            let y = half_breadth(x, z);
            Cell {
                old: Some(y),
                new: Some(y),
                ..Cell::default()
            }
        };
        let row = |x: &f64| waterlines.iter().map(|z| cell(*x, *z)).collect();
        let mut cells: Vec<Vec<Cell>> = stations.iter().map(row).collect();
        cells[0][0] = Cell {
            old: None,
            filled: true,
            ..cells[0][0]
        };
        cells[1][1].old = cells[1][1].new.map(|y| y - 0.25);
        cells[2][2] = Cell {
            old: Some(3.5),
            slip: cells[2][2].new,
            ..cells[2][2]
        };
        let curve = |points: Vec<Point3<f64>>| {
            interpolate(&points, 3, Parametrization::ChordLength).expect("apart")
        };
        let at = |x: f64, z: f64| Point3::new(x, half_breadth(x, z), z);
        let station = |x: &f64| (*x, curve(waterlines.iter().map(|z| at(*x, *z)).collect()));
        let waterline = |z: &f64| (*z, curve(stations.iter().map(|x| at(*x, *z)).collect()));
        OffsetsDrawing {
            title: "Pinnace <1>".into(),
            units: "m".into(),
            orientation: Orientation::WaterlinesAcross,
            names: [None, None],
            station_curves: stations.iter().map(station).collect(),
            waterline_curves: waterlines.iter().map(waterline).collect(),
            buttock_curves: vec![(0.9, curve(vec![at(-4.0, 0.9), at(0.0, 0.1), at(4.0, 0.9)]))],
            stations,
            waterlines,
            cells,
            verdict: "within_limits".into(),
            summary: vec!["One slip.".into()],
        }
    }

    #[test]
    fn three_blocks_and_a_list() {
        let table = table(&hull());
        let blocks: Vec<Vec<&str>> = table
            .split("\r\n\r\n")
            .map(|b| b.lines().collect())
            .collect();
        assert_eq!(blocks.len(), 4);
        assert_eq!(blocks[0][0], "New half-breadths (m)");
        assert_eq!(blocks[0][1], "station \\ waterline,0,0.5,1");
        assert!(blocks[0][2].starts_with("-4,0.32"));
        assert!(blocks[1][2].starts_with("-4,,0."));
        assert_eq!(blocks[2][3], "-2,0,0.25,0");
        assert!(blocks.iter().take(3).all(|b| b.len() == 7));
        let [_, head, first, second, third] = &blocks[3][..] else {
            panic!("{:?}", blocks[3]);
        };
        assert!(head.ends_with("move (m),expected (m),note"));
        assert!(first.starts_with("0,1,3.5,2.19") && first.ends_with(",suspected slip"));
        assert!(second.starts_with("-2,0.5,") && second.ends_with(",0.25,,"));
        assert!(third.starts_with("-4,0,,0.32") && third.ends_with(",filled"));
    }

    #[test]
    fn the_layout_is_that_of_the_file() {
        use crate::formats::points_in::{Contents, Expected, read};
        for orientation in [Orientation::WaterlinesAcross, Orientation::StationsAcross] {
            let drawing = OffsetsDrawing {
                orientation,
                ..hull()
            };
            let table = table(&drawing);
            let new = table.split("\r\n\r\n").next().expect("blocks");
            let reading = read(new.as_bytes(), Expected::Offsets(orientation)).expect("a table");
            let Contents::Offsets(offsets) = reading.contents else {
                panic!("not a table");
            };
            assert_eq!(offsets.stations, drawing.stations);
            assert_eq!(offsets.waterlines, drawing.waterlines);
            assert_eq!(reading.how.unit.as_deref(), Some("m"));
            assert_eq!(offsets.half_breadths.len(), drawing.cells.len());
            for (read, cells) in offsets.half_breadths.iter().zip(&drawing.cells) {
                for (read, cell) in read.iter().zip(cells) {
                    let gap = read.expect("all filled") - cell.new.expect("all filled");
                    assert!(gap.abs() < 1e-9, "{gap}");
                }
            }
        }
    }

    #[test]
    fn names_are_written_beside_their_places() {
        use crate::formats::points_in::{Contents, Places, read_table};
        let names = |n: &[&str]| Some(n.iter().map(|s| (*s).to_owned()).collect::<Vec<_>>());
        for orientation in [Orientation::WaterlinesAcross, Orientation::StationsAcross] {
            let stations = names(&["Tr", "AP", "½", "1, aft", "FP"]);
            for waterlines in [None, names(&["BL", "WL 1", "WL 2"])] {
                let drawing = OffsetsDrawing {
                    orientation,
                    names: [stations.clone(), waterlines],
                    ..hull()
                };
                let table = table(&drawing);
                let new = table.split("\r\n\r\n").next().expect("blocks");
                let read = read_table(new.as_bytes(), orientation, &Places::default());
                let Contents::Offsets(offsets) = read.expect(new).contents else {
                    panic!("not a table");
                };
                assert_eq!(offsets.stations, drawing.stations);
                assert_eq!(offsets.waterlines, drawing.waterlines);
                assert_eq!(
                    [offsets.station_names, offsets.waterline_names],
                    drawing.names
                );
            }
        }
    }

    #[test]
    fn ragged_and_broken_tables_are_written() {
        let mut drawing = hull();
        drawing.cells.truncate(3);
        drawing.cells[0].pop();
        drawing.cells[1][0].new = Some(f64::NAN);
        let table = table(&drawing);
        assert!(!table.contains("NaN"));
        assert!(table.contains("\r\n2,,,\r\n"));
    }
}
