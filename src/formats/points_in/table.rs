//! Tables of offsets: places along the first row and the first column, or
//! names there and places in a row or column of their own (`x`, `height`), in
//! a list of the caller's or by a spacing (module `places`).

use super::cells::{Cell, Line, Lines, drop_trailing, split};
use super::error::{Fault, ReadError};
use super::header;
use super::how::{HowRead, Skipped};
use super::list::thousands_note;
use super::number::{NumberReader, begins_like_a_number, is_missing, is_numeral};
use super::places::{Label, Places, Ruler, heads_places, placed};
use super::{Contents, OffsetTable, Orientation, Reading};

/// One direction of the table as it lies in the file.
#[derive(Default)]
struct Side {
    /// What the caller knows.
    ruler: Ruler,
    /// Names or places as written.
    labels: Vec<Label>,
    /// Places, one a label, as far as the file gives them.
    places: Vec<f64>,
    /// Whether the labels are names beside the places.
    named: bool,
}

/// The table as it lies in the file.
#[derive(Default)]
struct Grid {
    /// Along the first row.
    across: Side,
    /// Down the first column.
    down: Side,
    /// Whether the second column holds the places of the rows.
    place_column: bool,
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
    /// The last of them: its cells behind the corner.
    names: Vec<Label>,
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
pub(super) fn read(
    mut lines: Lines<'_>,
    orientation: Orientation,
    places: &Places,
) -> Result<Reading, ReadError> {
    let mut numbers = NumberReader::new();
    let mut cells = Vec::new();
    let mut above = Above::default();
    let mut grid = Grid::new(orientation, places);
    find_first_row(&mut lines, &mut cells, (&mut above, &grid.across.ruler))?;
    grid.take_head(&mut numbers, &cells, &above)?;
    while let Some(line) = lines.next_line() {
        split(line, lines.separator, &mut cells)?;
        if grid.rows.is_empty() && grid.wants_places(&cells) {
            grid.take_places(&mut numbers, &cells, line)?;
        } else if grid.rows.is_empty() && is_text(&cells) {
            above.take_text(line.number, &cells);
        } else {
            grid.take_row(&mut numbers, &cells, line)?;
        }
    }
    let mut notes = Vec::new();
    grid.settle(&mut notes, lines.last_number())?;
    let mut how = describe(&lines, above, &numbers, (&grid, orientation));
    how.notes.extend(notes);
    Ok(Reading {
        contents: Contents::Offsets(grid.into_table(orientation)),
        how,
    })
}

/// Whether a row has no number in it, and no mark for a missing one.
fn is_text(cells: &[Cell<'_>]) -> bool {
    let number = |c: &Cell<'_>| begins_like_a_number(&c.text);
    let missing = |c: &Cell<'_>| !c.text.is_empty() && is_missing(&c.text);
    let values = cells.get(1..).unwrap_or_default();
    !cells.iter().any(number) && !values.iter().any(missing)
}

/// Goes down to the first row with a number behind its corner, or, where the
/// caller knows the places, with names there; `cells` then holds that row.
fn find_first_row<'a>(
    lines: &mut Lines<'a>,
    cells: &mut Vec<Cell<'a>>,
    (above, ruler): (&mut Above, &Ruler),
) -> Result<(), ReadError> {
    let mut names_before = 0;
    while let Some(line) = lines.next_line() {
        split(line, lines.separator, cells)?;
        drop_trailing(cells, 1);
        let filled = cells.iter().filter(|c| !c.text.is_empty()).count();
        let mut behind = cells.iter().skip(1);
        // Names across go with a column of places too.
        let place_column = cells.get(1).is_some_and(|c| heads_places(&c.text));
        let names_do = (*ruler != Ruler::Written || place_column) && filled > 2;
        if !names_do && !behind.any(|c| begins_like_a_number(&c.text) || starts_a_fraction(c)) {
            names_before = filled;
            above.take_text(line.number, cells);
            continue;
        }
        let corner = &cells[0].text;
        // "Station; WL 1; WL 2" above "0; 0.4; 0.9": names in place of heights,
        // and the first station would be taken for the heights.
        if !names_do && begins_like_a_number(corner) && names_before + 1 >= cells.len() {
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

fn starts_a_fraction(cell: &Cell<'_>) -> bool {
    cell.text.starts_with(['½', '¼', '¾'])
}

/// The cells of a row from one on.
fn labels(cells: &[Cell<'_>], line: usize, from: usize) -> Vec<Label> {
    let cells = cells.iter().enumerate().skip(from);
    cells.map(|(i, c)| Label::of(c, line, i)).collect()
}

impl Above {
    fn take_text(&mut self, line: usize, cells: &[Cell<'_>]) {
        let unit = cells
            .iter()
            .find_map(|c| header::name(c).unit.or_else(|| header::unit(&c.text)));
        self.unit = self.unit.or(unit);
        self.names = labels(cells, line, 1);
        if self.text.len() < Skipped::MOST_TEXT_LINES {
            self.text.push(line);
        }
    }
}

/// The later of the first two entries that are equal.
fn repeated(places: &[f64]) -> Option<usize> {
    let mut order: Vec<usize> = (0..places.len()).collect();
    // Stable: of equal places the earlier comes first. `+ 0.0` makes -0 and 0 one.
    order.sort_by(|a, b| (places[*a] + 0.0).total_cmp(&(places[*b] + 0.0)));
    let equal = order.windows(2).filter(|w| places[w[0]] == places[w[1]]);
    equal.map(|w| w[1]).min()
}

impl Side {
    /// Checks and completes the places.
    ///
    /// # Errors
    /// Fewer than two lines, two at one place, a name that has none.
    fn settle(&mut self, notes: &mut Vec<String>, end: usize) -> Result<(), ReadError> {
        if self.ruler != Ruler::Written {
            self.places = placed(&self.labels, &self.ruler, notes)?;
            self.named = true;
        }
        if self.places.len() < 2 {
            let line = self.labels.first().map_or(end, |l| l.line);
            return Err(ReadError::in_line(line, "", Fault::TooSmallTable));
        }
        match repeated(&self.places) {
            Some(i) => Err(self.labels[i].fault(Fault::RepeatedPlace)),
            None => Ok(()),
        }
    }

    fn names(&self) -> Option<Vec<String>> {
        let names = self.labels.iter().map(|l| l.text.clone()).collect();
        self.named.then_some(names)
    }
}

impl Grid {
    fn new(orientation: Orientation, places: &Places) -> Self {
        let (across, down) = match orientation {
            Orientation::WaterlinesAcross => (&places.waterlines, &places.stations),
            Orientation::StationsAcross => (&places.stations, &places.waterlines),
        };
        let side = |ruler: &Ruler| Side {
            ruler: ruler.clone(),
            ..Side::default()
        };
        Grid {
            across: side(across),
            down: side(down),
            ..Grid::default()
        }
    }

    /// The first cell of a row that is not of its head.
    fn first(&self) -> usize {
        1 + usize::from(self.place_column)
    }

    /// The first row: places, or names whose places come elsewhere.
    fn take_head(
        &mut self,
        numbers: &mut NumberReader,
        cells: &[Cell<'_>],
        above: &Above,
    ) -> Result<(), ReadError> {
        self.place_column = cells.len() > 2 && heads_places(&cells[1].text);
        self.across.labels = labels(cells, above.line, self.first());
        if self.across.ruler != Ruler::Written {
            return Ok(());
        }
        let plain = |c: &Cell<'_>| is_numeral(&c.text) || is_missing(&c.text);
        if !cells[self.first()..].iter().all(plain) {
            // Perhaps names above a row of places; else the fault is told when
            // that row does not come.
            return Ok(());
        }
        self.across.places = places_in(numbers, cells, (above.line, self.first()))?;
        let beside = above.names.len() == self.across.labels.len() && heads_places(&cells[0].text);
        if beside {
            self.across.labels.clone_from(&above.names);
            self.across.named = true;
        }
        Ok(())
    }

    /// Whether a row holds the places of the lines along the first row.
    fn wants_places(&self, cells: &[Cell<'_>]) -> bool {
        let open = self.across.ruler == Ruler::Written && self.across.places.is_empty();
        open && cells.first().is_some_and(|c| heads_places(&c.text))
    }

    fn take_places(
        &mut self,
        numbers: &mut NumberReader,
        cells: &[Cell<'_>],
        line: Line<'_>,
    ) -> Result<(), ReadError> {
        self.check_length(cells, line)?;
        let expected = self.first() + self.across.labels.len();
        self.across.places = places_in(numbers, &cells[..expected], (line.number, self.first()))?;
        self.across.named = true;
        Ok(())
    }

    /// The first name of the first row as the number that it is not.
    fn head_fault(&self, numbers: &mut NumberReader) -> Option<ReadError> {
        self.across.labels.iter().find_map(|l| {
            let cell = Cell {
                text: l.text.as_str().into(),
                quoted: false,
            };
            numbers.read(&cell, l.line, l.cell).err()
        })
    }

    fn check_length(&self, cells: &[Cell<'_>], line: Line<'_>) -> Result<(), ReadError> {
        let expected = self.first() + self.across.labels.len();
        let mut beyond = cells.iter().enumerate().skip(expected);
        if let Some((index, cell)) = beyond.find(|(_, c)| !c.text.is_empty()) {
            let fault = Fault::LongRow { expected };
            return Err(ReadError::at(line.number, index, &cell.text, fault));
        }
        if cells.len() < expected {
            let fault = Fault::ShortRow { expected };
            return Err(ReadError::in_line(line.number, line.text.trim(), fault));
        }
        Ok(())
    }

    fn take_row(
        &mut self,
        numbers: &mut NumberReader,
        cells: &[Cell<'_>],
        line: Line<'_>,
    ) -> Result<(), ReadError> {
        if self.across.ruler == Ruler::Written && self.across.places.is_empty() {
            let fault = self.head_fault(numbers);
            return Err(fault.unwrap_or_else(|| {
                ReadError::in_line(line.number, line.text.trim(), Fault::NamesWithoutPlaces)
            }));
        }
        self.check_length(cells, line)?;
        let first = self.first();
        if self.down.ruler == Ruler::Written {
            let at = first - 1;
            let missing = || ReadError::at(line.number, at, &cells[at].text, Fault::MissingPlace);
            let place = numbers.read(&cells[at], line.number, at)?;
            self.down.places.push(place.ok_or_else(missing)?);
            self.down.named = self.place_column;
        }
        let row = cells[first..first + self.across.labels.len()].iter();
        let row = row.enumerate();
        let row = row.map(|(i, c)| numbers.read(c, line.number, i + first));
        self.rows.push(row.collect::<Result<_, _>>()?);
        self.down.labels.push(Label::of(&cells[0], line.number, 0));
        self.lines.push(line.number);
        Ok(())
    }

    fn settle(&mut self, notes: &mut Vec<String>, end: usize) -> Result<(), ReadError> {
        self.across.settle(notes, end)?;
        if self.rows.len() < 2 {
            return Err(ReadError::in_line(end, "", Fault::TooSmallTable));
        }
        self.down.settle(notes, end)
    }

    fn into_table(self, orientation: Orientation) -> OffsetTable {
        let turned = || {
            let column = |j: usize| self.rows.iter().map(|row| row[j]).collect();
            (0..self.across.places.len()).map(column).collect()
        };
        let (stations, waterlines, half_breadths) = match orientation {
            Orientation::WaterlinesAcross => (&self.down, &self.across, self.rows.clone()),
            Orientation::StationsAcross => (&self.across, &self.down, turned()),
        };
        OffsetTable {
            orientation,
            stations: stations.places.clone(),
            station_names: stations.names(),
            waterlines: waterlines.places.clone(),
            waterline_names: waterlines.names(),
            half_breadths,
            lines: self.lines,
        }
    }
}

/// Places in the cells of a row.
fn places_in(
    numbers: &mut NumberReader,
    cells: &[Cell<'_>],
    (line, first): (usize, usize),
) -> Result<Vec<f64>, ReadError> {
    let mut places = Vec::with_capacity(cells.len());
    for (index, cell) in cells.iter().enumerate().skip(first) {
        let place = numbers.read(cell, line, index)?;
        let missing = || ReadError::at(line, index, &cell.text, Fault::MissingPlace);
        places.push(place.ok_or_else(missing)?);
    }
    Ok(places)
}

fn describe(
    lines: &Lines<'_>,
    above: Above,
    numbers: &NumberReader,
    (grid, orientation): (&Grid, Orientation),
) -> HowRead {
    let (down, across) = (grid.down.places.len(), grid.across.places.len());
    let (stations, waterlines, way) = match orientation {
        Orientation::WaterlinesAcross => (down, across, "one station a row"),
        Orientation::StationsAcross => (across, down, "one waterline a row"),
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
