//! Lists of points: one a row.

use super::cells::{Cell, Line, Lines, split};
use super::error::{Fault, ReadError};
use super::header::{self, Name};
use super::how::{ColumnRead, HowRead, Separator, Skipped};
use super::number::{NumberReader, begins_like_a_number, is_missing};
use super::{Contents, Coordinate, PointList, Reading};

/// Coordinates in the order of columns without names.
const BY_POSITION: [Coordinate; 3] = [Coordinate::X, Coordinate::Y, Coordinate::Z];

/// Rows of text above the numbers.
#[derive(Default)]
struct Heading {
    /// Names with the line they stand in.
    names: Option<(usize, Vec<Name>)>,
    /// A row of units below them, by column.
    units: Vec<Option<&'static str>>,
    /// Lines of other text.
    text: Vec<usize>,
}

/// Where the coordinates stand in a row.
struct Columns {
    /// Index in the row, coordinate.
    used: Vec<(usize, Coordinate)>,
    /// Cells that a row may have.
    width: usize,
    /// Whether their names told.
    by_name: bool,
}

/// Reads the points.
///
/// # Errors
/// The first row that is not like the others, or not numbers.
pub(super) fn read(mut lines: Lines<'_>) -> Result<Reading, ReadError> {
    let mut cells = Vec::new();
    let (heading, first) = read_heading(&mut lines, &mut cells)?;
    let columns = columns(&heading, &cells, first)?;
    check_units(&heading, &columns)?;
    let mut numbers = NumberReader::new();
    let mut list = PointList {
        coordinates: columns.used.iter().map(|(_, c)| *c).collect(),
        rows: Vec::new(),
        lines: Vec::new(),
    };
    let mut next = Some(first);
    while let Some(line) = next {
        split(line, lines.separator, &mut cells)?;
        list.rows.push(point(&mut numbers, &columns, &cells, line)?);
        list.lines.push(line.number);
        next = lines.next_line();
    }
    if could_be_decimals(lines.separator, &columns, &numbers) {
        return Err(ReadError::in_line(
            first.number,
            first.text.trim(),
            Fault::AmbiguousComma,
        ));
    }
    let how = describe(&lines, heading, &columns, &numbers, &list);
    Ok(Reading {
        contents: Contents::Points(list),
        how,
    })
}

/// Everything above the first row with a number in it; `cells` then holds that
/// row.
fn read_heading<'a>(
    lines: &mut Lines<'a>,
    cells: &mut Vec<Cell<'a>>,
) -> Result<(Heading, Line<'a>), ReadError> {
    let mut heading = Heading::default();
    while let Some(line) = lines.next_line() {
        split(line, lines.separator, cells)?;
        let is_text = |c: &Cell<'_>| !begins_like_a_number(&c.text);
        let says_something = cells.iter().any(|c| !is_missing(&c.text));
        if !(cells.iter().all(is_text) && says_something) {
            return Ok((heading, line));
        }
        heading.take_row(line.number, cells);
    }
    Err(ReadError::in_line(
        lines.last_number(),
        "",
        Fault::NoNumbers,
    ))
}

impl Heading {
    /// A row of text: units, names, or something else. Of several rows the
    /// last with the most known names counts.
    fn take_row(&mut self, line: usize, cells: &[Cell<'_>]) {
        let filled = || cells.iter().filter(|c| !c.text.is_empty());
        if self.names.is_some() && filled().all(|c| header::unit(&c.text).is_some()) {
            self.units = cells.iter().map(|c| header::unit(&c.text)).collect();
            return;
        }
        let names: Vec<Name> = cells.iter().map(header::name).collect();
        let known = |names: &[Name]| names.iter().filter(|n| n.coordinate.is_some()).count();
        let replaces = self
            .names
            .as_ref()
            .is_none_or(|(_, old)| known(&names) >= known(old));
        let text_line = if replaces {
            self.names.replace((line, names)).map(|(old, _)| old)
        } else {
            Some(line)
        };
        self.text.extend(text_line);
        self.text.truncate(Skipped::MOST_TEXT_LINES);
    }

    fn name(&self, column: usize) -> Option<&Name> {
        self.names.as_ref().and_then(|(_, names)| names.get(column))
    }

    fn unit(&self, column: usize) -> Option<&'static str> {
        let below = self.units.get(column).copied().flatten();
        below.or_else(|| self.name(column).and_then(|n| n.unit))
    }
}

/// Chooses the columns by two or three known names, or else by position.
fn columns(heading: &Heading, cells: &[Cell<'_>], first: Line<'_>) -> Result<Columns, ReadError> {
    let named = heading.names.as_ref().map_or(&[][..], |(_, names)| names);
    let mut used: Vec<(usize, Coordinate)> = Vec::new();
    for (index, name) in named.iter().enumerate() {
        let Some(coordinate) = name.coordinate else {
            continue;
        };
        if used.iter().any(|(_, c)| *c == coordinate) {
            let line = heading
                .names
                .as_ref()
                .map_or(first.number, |(line, _)| *line);
            return Err(ReadError::at(line, index, &name.text, Fault::RepeatedName));
        }
        used.push((index, coordinate));
    }
    let by_name = used.len() > 1;
    if by_name {
        used.sort_by_key(|(_, coordinate)| *coordinate);
    } else {
        let filled = cells
            .iter()
            .rposition(|c| !c.text.is_empty())
            .map_or(0, |i| i + 1);
        used = (0..filled).zip(BY_POSITION).collect();
    }
    if used.len() < 2 {
        return Err(ReadError::in_line(
            first.number,
            first.text.trim(),
            Fault::OneColumn,
        ));
    }
    Ok(Columns {
        used,
        width: cells.len().max(named.len()),
        by_name,
    })
}

/// Columns in different units would make a shape that is none.
fn check_units(heading: &Heading, columns: &Columns) -> Result<(), ReadError> {
    let mut first = None;
    for (index, _) in &columns.used {
        let Some(unit) = heading.unit(*index) else {
            continue;
        };
        if *first.get_or_insert(unit) != unit {
            let line = heading.names.as_ref().map_or(1, |(line, _)| *line);
            return Err(ReadError::at(line, *index, unit, Fault::MixedUnits));
        }
    }
    Ok(())
}

/// One row as a point.
fn point(
    numbers: &mut NumberReader,
    columns: &Columns,
    cells: &[Cell<'_>],
    line: Line<'_>,
) -> Result<[Option<f64>; 3], ReadError> {
    let expected = columns.width;
    let beyond = cells.iter().enumerate().skip(expected);
    if let Some((index, cell)) = beyond.clone().find(|(_, c)| !c.text.is_empty()) {
        return Err(ReadError::at(
            line.number,
            index,
            &cell.text,
            Fault::LongRow { expected },
        ));
    }
    let mut point = [None; 3];
    for (slot, (index, _)) in point.iter_mut().zip(&columns.used) {
        let short = || {
            let expected = columns.used.iter().map(|(i, _)| i + 1).max().unwrap_or(0);
            ReadError::in_line(line.number, line.text.trim(), Fault::ShortRow { expected })
        };
        let cell = cells.get(*index).ok_or_else(short)?;
        *slot = numbers.read(cell, line.number, *index)?;
    }
    Ok(point)
}

/// Four or six columns of whole numbers between commas look like two or three
/// with decimal commas; names would have settled it.
fn could_be_decimals(separator: Separator, columns: &Columns, numbers: &NumberReader) -> bool {
    let even = columns.width == 4 || columns.width == 6;
    separator == Separator::Comma && even && !columns.by_name && numbers.mark().is_none()
}

fn describe(
    lines: &Lines<'_>,
    mut heading: Heading,
    columns: &Columns,
    numbers: &NumberReader,
    list: &PointList,
) -> HowRead {
    let notes = notes(&heading, columns, numbers);
    let read = columns.used.iter().map(|(index, coordinate)| ColumnRead {
        number: index + 1,
        coordinate: *coordinate,
        name: heading.name(*index).map(|n| n.text.clone()),
        unit: heading.unit(*index).map(str::to_owned),
    });
    let read: Vec<ColumnRead> = read.collect();
    let expected = list.coordinates.len();
    let missing = list
        .rows
        .iter()
        .flat_map(|r| &r[..expected])
        .filter(|v| v.is_none());
    let (header_line, header) = match heading.names.take() {
        Some((line, names)) => (Some(line), names.into_iter().map(|n| n.text).collect()),
        None => (None, Vec::new()),
    };
    HowRead {
        separator: lines.separator,
        decimal_mark: numbers.mark(),
        header_line,
        header,
        unit: read.iter().find_map(|c| c.unit.clone()),
        columns: read,
        skipped: Skipped {
            comments: lines.comments,
            empty: lines.empty,
            text: heading.text,
        },
        amount: match list.rows.len() {
            1 => "1 point".to_owned(),
            n => format!("{n} points"),
        },
        missing: missing.count(),
        notes,
    }
}

/// What a person should know about the columns.
fn notes(heading: &Heading, columns: &Columns, numbers: &NumberReader) -> Vec<String> {
    let mut notes = Vec::new();
    let is_used = |i: &usize| columns.used.iter().any(|(used, _)| used == i);
    let ignored: Vec<String> = (0..columns.width)
        .filter(|i| !is_used(i))
        .map(|i| match heading.name(i) {
            Some(name) if !name.text.is_empty() => format!("{} (“{}”)", i + 1, name.text),
            _ => (i + 1).to_string(),
        })
        .collect();
    if !ignored.is_empty() {
        notes.push(format!("Columns not used: {}.", ignored.join(", ")));
    }
    if heading.names.is_some() && !columns.by_name {
        notes.push(
            "The names of the columns are not known; the first ones were taken as x, y, z."
                .to_owned(),
        );
    }
    let whole = columns.used.iter().filter_map(|(i, _)| heading.name(*i));
    for name in whole.filter(|n| columns.by_name && n.is_whole_breadth) {
        notes.push(format!("“{}” was taken as written, not halved.", name.text));
    }
    notes.extend(thousands_note(numbers));
    notes
}

/// Commas that all stand before three digits are decimal marks here, but might
/// have been meant otherwise.
pub(super) fn thousands_note(numbers: &NumberReader) -> Option<String> {
    let note = "All commas stand before exactly three digits; they were read as decimal marks, not between thousands.";
    numbers.commas_could_be_thousands().then(|| note.to_owned())
}
