//! Points and offset tables from the text files of yards: comma, semicolon,
//! tab or blank between the numbers, decimal point or decimal comma, header
//! rows, comments, empty lines, a byte order mark.
//!
//! Nothing is guessed that changes a number. What could be read in two ways
//! (`1.234,5`, `1 1/2`, two decimal marks in one file, a name where a height
//! should be) is an error that names line and column; what was decided is told
//! in [`HowRead`], so that a person can object.
//!
//! Limits: UTF-8 only; a quoted field ends on its own line; lengths stay in
//! the file's own unit.

mod cells;
mod error;
mod header;
mod how;
mod list;
mod number;
mod places;
mod sniff;
mod table;
#[cfg(test)]
mod tests;

pub use error::{Fault, ReadError};
pub use how::{ColumnRead, DecimalMark, HowRead, Separator, Skipped};
pub use places::{Places, Ruler};

use cells::Lines;

/// What the caller expects in the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Expected {
    /// One point a row, two or three coordinates.
    Points,
    /// A table of half-breadths.
    Offsets(Orientation),
}

/// How a table of offsets lies on the page.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Orientation {
    /// The first row holds the heights of the waterlines, the first column the
    /// places of the stations: one station a row.
    #[default]
    WaterlinesAcross,
    /// The first row holds the places of the stations, the first column the
    /// heights of the waterlines: one waterline a row.
    StationsAcross,
}

/// The coordinate that a column of points holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Coordinate {
    /// Along the ship.
    X,
    /// Athwartships.
    Y,
    /// Upwards.
    Z,
}

/// Points in the order of the file.
#[derive(Debug, Clone, PartialEq)]
pub struct PointList {
    /// The two or three coordinates that were read, in the order x, y, z.
    /// Without names they are the first ones in the order of the columns.
    pub coordinates: Vec<Coordinate>,
    /// One entry a point; the first `coordinates.len()` values count, the rest
    /// is `None`. `None` among those that count: missing in the file.
    pub rows: Vec<[Option<f64>; 3]>,
    /// The line of the file (1-based) that each point stood in.
    pub lines: Vec<usize>,
}

/// Half-breadths by station and waterline, whatever way round the file had them.
#[derive(Debug, Clone, PartialEq)]
pub struct OffsetTable {
    /// How the table lay in the file.
    pub orientation: Orientation,
    /// Places of the stations, in the order of the file.
    pub stations: Vec<f64>,
    /// Their names, where the file has names beside or instead of places.
    pub station_names: Option<Vec<String>>,
    /// The same for the waterlines.
    pub waterline_names: Option<Vec<String>>,
    /// Heights of the waterlines, in the order of the file.
    pub waterlines: Vec<f64>,
    /// Half-breadths `[station][waterline]`; `None` where the cell was empty,
    /// `-`, `n/a` or `NaN`.
    pub half_breadths: Vec<Vec<Option<f64>>>,
    /// The line of the file (1-based) of each row of the table as it lay there.
    pub lines: Vec<usize>,
}

/// What stood in the file.
#[derive(Debug, Clone, PartialEq)]
pub enum Contents {
    /// For [`Expected::Points`].
    Points(PointList),
    /// For [`Expected::Offsets`].
    Offsets(OffsetTable),
}

/// A file that was understood.
#[derive(Debug, Clone, PartialEq)]
pub struct Reading {
    /// The numbers.
    pub contents: Contents,
    /// How they were found.
    pub how: HowRead,
}

/// Reads a file.
///
/// # Errors
/// The first place that cannot be read without a guess, with line, column, the
/// text found there and a hint; see [`Fault`].
pub fn read(bytes: &[u8], expected: Expected) -> Result<Reading, ReadError> {
    let text = decode(bytes)?;
    let style = sniff::style(text)?;
    let lines = Lines::new(text, style.first_line, style.separator);
    match expected {
        Expected::Points => list::read(lines),
        Expected::Offsets(orientation) => table::read(lines, orientation, &Places::default()),
    }
}

/// Reads a table of offsets whose lines have names; the caller knows more of
/// their places than the file.
///
/// # Errors
/// As [`read()`].
pub fn read_table(
    bytes: &[u8],
    orientation: Orientation,
    places: &Places,
) -> Result<Reading, ReadError> {
    let text = decode(bytes)?;
    let style = sniff::style(text)?;
    let lines = Lines::new(text, style.first_line, style.separator);
    table::read(lines, orientation, places)
}

/// The text of the file without its byte order mark.
fn decode(bytes: &[u8]) -> Result<&str, ReadError> {
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        return Err(ReadError::whole_file(Fault::Utf16));
    }
    let text = std::str::from_utf8(bytes).map_err(|e| {
        let offset = e.valid_up_to();
        let before = &bytes[..offset];
        ReadError {
            line: 1 + count_line_ends(before),
            column: None,
            found: format!("byte 0x{:02X}", bytes[offset]),
            fault: Fault::NotUtf8 { offset },
        }
    })?;
    Ok(text.strip_prefix('\u{feff}').unwrap_or(text))
}

/// Ends of lines in the three conventions, as [`Lines`] counts them.
fn count_line_ends(bytes: &[u8]) -> usize {
    let ends = |i: usize, b: u8| b == b'\n' || (b == b'\r' && bytes.get(i + 1) != Some(&b'\n'));
    bytes
        .iter()
        .enumerate()
        .filter(|(i, b)| ends(*i, **b))
        .count()
}
