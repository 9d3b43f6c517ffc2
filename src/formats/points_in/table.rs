//! Tables of offsets: places along the first row and the first column.

use super::cells::{Cell, Line, Lines, drop_trailing, split};
use super::error::{Fault, ReadError};
use super::header;
use super::how::{HowRead, Skipped};
use super::list::thousands_note;
use super::number::{NumberReader, begins_like_a_number};
use super::{Contents, OffsetTable, Orientation, Reading};

/// The table as it lies in the file.
#[derive(Default)]
struct Grid {
    /// Places along the first row.
    across: Vec<f64>,
    /// Places down the first column.
    down: Vec<f64>,
    /// Cells by row.
    rows: Vec<Vec<Option<f64>>>,
    /// Line of each row.
    lines: Vec<usize>,
}

/// What stood above the table or in its corner.
#[derive(Default)]
struct Above {
    /// Lines of text.
    text: Vec<usize>,
    /// The first row of the table.
    line: usize,
    /// Cells of that row as written.
    header: Vec<String>,
    /// A unit found in the corner or in a row of units.
    unit: Option<&'static str>,
}

/// Reads the table.
///
/// # Errors
/// The first row that does not fit, or the first cell that is not a number.
pub(super) fn read(mut lines: Lines<'_>, orientation: Orientation) -> Result<Reading, ReadError> {
    let mut numbers = NumberReader::new();
    let mut cells = Vec::new();
    let mut above = Above::default();
    let mut grid = Grid::default();
    find_first_row(&mut lines, &mut cells, &mut above)?;
    grid.across = first_row(&mut numbers, &cells, above.line)?;
    while let Some(line) = lines.next_line() {
        split(line, lines.separator, &mut cells)?;
        let is_text = cells.iter().all(|c| !begins_like_a_number(&c.text));
        if grid.rows.is_empty() && is_text {
            above.take_text(line.number, &cells);
        } else {
            grid.take_row(&mut numbers, &cells, line)?;
        }
    }
    if grid.down.len() < 2 {
        return Err(ReadError::in_line(
            lines.last_number(),
            "",
            Fault::TooSmallTable,
        ));
    }
    if let Some(row) = repeated(&grid.down) {
        let place = grid.down[row].to_string();
        return Err(ReadError::at(
            grid.lines[row],
            0,
            &place,
            Fault::RepeatedPlace,
        ));
    }
    let how = describe(&lines, above, &numbers, &grid, orientation);
    Ok(Reading {
        contents: Contents::Offsets(grid.into_table(orientation)),
        how,
    })
}

/// Goes down to the first row with a number behind its corner; `cells` then
/// holds that row.
fn find_first_row<'a>(
    lines: &mut Lines<'a>,
    cells: &mut Vec<Cell<'a>>,
    above: &mut Above,
) -> Result<(), ReadError> {
    let mut names_before = 0;
    while let Some(line) = lines.next_line() {
        split(line, lines.separator, cells)?;
        drop_trailing(cells, 1);
        if !cells.iter().skip(1).any(|c| begins_like_a_number(&c.text)) {
            names_before = cells.iter().filter(|c| !c.text.is_empty()).count();
            above.take_text(line.number, cells);
            continue;
        }
        let corner = &cells[0].text;
        // "Station; WL 1; WL 2" above "0; 0.4; 0.9": names in place of heights,
        // and the first station would be taken for the heights.
        if begins_like_a_number(corner) && names_before + 1 >= cells.len() {
            return Err(ReadError::in_line(
                line.number,
                line.text.trim(),
                Fault::NamesWithoutPlaces,
            ));
        }
        above.line = line.number;
        above.unit = above.unit.or_else(|| header::name(&cells[0]).unit);
        above.header = cells.iter().map(|c| c.text.clone().into_owned()).collect();
        return Ok(());
    }
    Err(ReadError::in_line(
        lines.last_number(),
        "",
        Fault::NoNumbers,
    ))
}

impl Above {
    fn take_text(&mut self, line: usize, cells: &[Cell<'_>]) {
        let unit = cells
            .iter()
            .find_map(|c| header::name(c).unit.or_else(|| header::unit(&c.text)));
        self.unit = self.unit.or(unit);
        if self.text.len() < Skipped::MOST_TEXT_LINES {
            self.text.push(line);
        }
    }
}

/// The places along the first row, at least two, all different.
fn first_row(
    numbers: &mut NumberReader,
    cells: &[Cell<'_>],
    line: usize,
) -> Result<Vec<f64>, ReadError> {
    let mut across = Vec::with_capacity(cells.len());
    for (index, cell) in cells.iter().enumerate().skip(1) {
        let place = numbers.read(cell, line, index)?;
        let missing = || ReadError::at(line, index, &cell.text, Fault::MissingPlace);
        across.push(place.ok_or_else(missing)?);
    }
    if let Some(index) = repeated(&across) {
        let found = &cells[index + 1].text;
        return Err(ReadError::at(line, index + 1, found, Fault::RepeatedPlace));
    }
    if across.len() < 2 {
        return Err(ReadError::in_line(line, "", Fault::TooSmallTable));
    }
    Ok(across)
}

/// The later of the first two entries that are equal.
fn repeated(places: &[f64]) -> Option<usize> {
    let mut order: Vec<usize> = (0..places.len()).collect();
    // Stable: of equal places the earlier comes first. `+ 0.0` makes -0 and 0 one.
    order.sort_by(|a, b| (places[*a] + 0.0).total_cmp(&(places[*b] + 0.0)));
    let equal = order.windows(2).filter(|w| places[w[0]] == places[w[1]]);
    equal.map(|w| w[1]).min()
}

impl Grid {
    fn take_row(
        &mut self,
        numbers: &mut NumberReader,
        cells: &[Cell<'_>],
        line: Line<'_>,
    ) -> Result<(), ReadError> {
        let expected = self.across.len() + 1;
        if let Some((index, cell)) = cells
            .iter()
            .enumerate()
            .skip(expected)
            .find(|(_, c)| !c.text.is_empty())
        {
            return Err(ReadError::at(
                line.number,
                index,
                &cell.text,
                Fault::LongRow { expected },
            ));
        }
        if cells.len() < expected {
            let fault = Fault::ShortRow { expected };
            return Err(ReadError::in_line(line.number, line.text.trim(), fault));
        }
        let missing = || ReadError::at(line.number, 0, &cells[0].text, Fault::MissingPlace);
        let place = numbers
            .read(&cells[0], line.number, 0)?
            .ok_or_else(missing)?;
        let row = cells[1..expected].iter().enumerate();
        let row = row.map(|(i, c)| numbers.read(c, line.number, i + 1));
        self.rows.push(row.collect::<Result<_, _>>()?);
        self.down.push(place);
        self.lines.push(line.number);
        Ok(())
    }

    fn into_table(self, orientation: Orientation) -> OffsetTable {
        let (stations, waterlines, half_breadths) = match orientation {
            Orientation::WaterlinesAcross => (self.down, self.across, self.rows),
            Orientation::StationsAcross => {
                let column = |j: usize| self.rows.iter().map(|row| row[j]).collect();
                let turned = (0..self.across.len()).map(column).collect();
                (self.across, self.down, turned)
            }
        };
        OffsetTable {
            orientation,
            stations,
            waterlines,
            half_breadths,
            lines: self.lines,
        }
    }
}

fn describe(
    lines: &Lines<'_>,
    above: Above,
    numbers: &NumberReader,
    grid: &Grid,
    orientation: Orientation,
) -> HowRead {
    let (stations, waterlines, way) = match orientation {
        Orientation::WaterlinesAcross => (grid.down.len(), grid.across.len(), "one station a row"),
        Orientation::StationsAcross => (grid.across.len(), grid.down.len(), "one waterline a row"),
    };
    HowRead {
        separator: lines.separator,
        decimal_mark: numbers.mark(),
        header_line: Some(above.line),
        header: above.header,
        columns: Vec::new(),
        unit: above.unit.map(str::to_owned),
        skipped: Skipped {
            comments: lines.comments,
            empty: lines.empty,
            text: above.text,
        },
        amount: format!("{stations} stations × {waterlines} waterlines, {way}"),
        missing: grid.rows.iter().flatten().filter(|c| c.is_none()).count(),
        notes: thousands_note(numbers).into_iter().collect(),
    }
}
