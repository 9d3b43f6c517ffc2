//! What can be wrong with a file of points, where, and what to do about it.

use crate::formats::excerpt::shortened;
use std::fmt;

/// A place in the file that could not be read.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{}", self.sentence())]
pub struct ReadError {
    /// Line of the file, 1-based; the last line for what is missing.
    pub line: usize,
    /// Column of cells (not of letters), 1-based; `None` for a whole line.
    pub column: Option<usize>,
    /// The text found there, shortened; empty where nothing was.
    pub found: String,
    /// What is wrong with it.
    pub fault: Fault,
}

/// What is wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fault {
    /// Bytes that are not UTF-8, from this offset on (0-based).
    NotUtf8 {
        /// Offset of the first such byte in the file.
        offset: usize,
    },
    /// The file begins like UTF-16.
    Utf16,
    /// No row of numbers in the file.
    NoNumbers,
    /// Commas may separate or be decimal marks: both readings are possible.
    AmbiguousComma,
    /// A quote is opened and not closed on its line.
    OpenQuote,
    /// Text where a number should be.
    NotANumber,
    /// A fraction, or feet, inches and eighths.
    Fraction,
    /// A number with marks or blanks between its thousands.
    Thousands,
    /// A number followed by its unit.
    UnitInCell,
    /// A number too large for a computer, or the word for infinity.
    NotFinite,
    /// A decimal comma where points were used before, or the reverse.
    MixedDecimalMarks {
        /// Line of the first number with the other mark.
        other_line: usize,
    },
    /// Fewer cells than the rows before or the heading promise.
    ShortRow {
        /// Cells there should be.
        expected: usize,
    },
    /// More cells than the rows before or the heading have.
    LongRow {
        /// Cells there should be.
        expected: usize,
    },
    /// Only one column of numbers.
    OneColumn,
    /// Two columns are named for the same coordinate.
    RepeatedName,
    /// The columns used are headed by different units.
    MixedUnits,
    /// The first row of a table names its columns but gives no places.
    NamesWithoutPlaces,
    /// The place of a station or the height of a waterline is missing.
    MissingPlace,
    /// A name of which a spacing cannot tell the place.
    NameWithoutPlace,
    /// A list of places that does not go with the lines of the table.
    PlaceCount {
        /// Places in the list.
        given: usize,
        /// Lines in the table.
        needed: usize,
    },
    /// Two stations or two waterlines at the same place.
    RepeatedPlace,
    /// A table without a second row or column.
    TooSmallTable,
}

impl ReadError {
    /// An error at a cell, counted from 0 within its line.
    pub(super) fn at(line: usize, cell: usize, found: &str, fault: Fault) -> Self {
        ReadError {
            line,
            column: Some(cell + 1),
            found: shortened(found),
            fault,
        }
    }

    /// An error of a whole line.
    pub(super) fn in_line(line: usize, found: &str, fault: Fault) -> Self {
        ReadError {
            line,
            column: None,
            found: shortened(found),
            fault,
        }
    }

    /// An error of the file as such.
    pub(super) fn whole_file(fault: Fault) -> Self {
        Self::in_line(1, "", fault)
    }

    /// Where, what and the text found, as a sentence.
    #[must_use]
    pub fn sentence(&self) -> String {
        let mut place = format!("Line {}", self.line);
        if let Some(column) = self.column {
            place.push_str(&format!(", column {column}"));
        }
        if self.found.is_empty() {
            format!("{place}: {}.", self.fault)
        } else {
            format!("{place}: {}: “{}”.", self.fault, self.found)
        }
    }

    /// What to do about it, as a sentence.
    #[must_use]
    pub fn hint(&self) -> &'static str {
        match self.fault {
            Fault::NotUtf8 { .. } | Fault::Utf16 => {
                "Save the file as UTF-8 (in spreadsheets: “CSV UTF-8”)."
            }
            Fault::NoNumbers => {
                "One point or station a line; lines that begin with #, // or % are comments."
            }
            Fault::AmbiguousComma => {
                "Write a semicolon between the numbers, or decimal points within them."
            }
            Fault::OpenQuote => "Close the quote on the same line, or leave quotes out.",
            Fault::NotANumber => {
                "Write a plain number; begin a line of text with #. Leave a cell empty, or write - or n/a, where a value is missing."
            }
            Fault::Fraction => {
                "Write decimals: 10-3-6 (feet, inches, eighths) is 10.3125 ft, 1 1/2 is 1.5."
            }
            Fault::Thousands => "Write 1234.5 or 1234,5, without anything between the thousands.",
            Fault::UnitInCell => {
                "Leave units out of the cells; the header may name them: “x [mm]”."
            }
            Fault::NotFinite => "Write a number that is finite.",
            Fault::MixedDecimalMarks { .. } => "Use one decimal mark in the whole file.",
            Fault::ShortRow { .. } => {
                "Leave a cell empty between separators, or write - or n/a, where a value is missing."
            }
            Fault::LongRow { .. } => {
                "Check for a decimal comma in a file separated by commas; put such numbers in quotes."
            }
            Fault::OneColumn => "A point needs two or three coordinates in one line.",
            Fault::RepeatedName => "Name each coordinate once.",
            Fault::MixedUnits => "Bring all columns to one unit.",
            Fault::NamesWithoutPlaces => {
                "Write the place of each column as a number into the first row (heights of the waterlines, or places of the stations)."
            }
            Fault::NameWithoutPlace => {
                "A spacing places numbers (3, ½, 9 1/2) and perpendiculars at the ends; list the places of all lines instead, or write them into a row or column headed x, z or position."
            }
            Fault::PlaceCount { .. } => "List one place for each line of the table, in its order.",
            Fault::MissingPlace => "Give every station and every waterline its place as a number.",
            Fault::RepeatedPlace => "Leave one of the two out.",
            Fault::TooSmallTable => "A table has at least two stations and two waterlines.",
        }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Fault::NotUtf8 { offset } => write!(f, "not UTF-8 from byte {offset} on"),
            Fault::Utf16 => f.write_str("the file is UTF-16"),
            Fault::NoNumbers => f.write_str("the file holds no row of numbers"),
            Fault::AmbiguousComma => {
                f.write_str("the commas could separate numbers or be decimal marks")
            }
            Fault::OpenQuote => f.write_str("a quote is opened and not closed"),
            Fault::NotANumber => f.write_str("this is not a number"),
            Fault::Fraction => f.write_str("fractions are not read"),
            Fault::Thousands => f.write_str("thousands are set apart in this number"),
            Fault::UnitInCell => f.write_str("something follows the number"),
            Fault::NotFinite => f.write_str("this number is not finite"),
            Fault::MixedDecimalMarks { other_line } => {
                write!(f, "another decimal mark than in line {other_line}")
            }
            Fault::ShortRow { expected } => write!(f, "the row ends before {expected} cells"),
            Fault::LongRow { expected } => write!(f, "the row goes on after {expected} cells"),
            Fault::OneColumn => f.write_str("the file has only one column"),
            Fault::RepeatedName => f.write_str("a second column for the same coordinate"),
            Fault::MixedUnits => f.write_str("another unit than the columns before"),
            Fault::NamesWithoutPlaces => {
                f.write_str("the columns have names but no places, so this row of numbers cannot be told from a first row")
            }
            Fault::MissingPlace => f.write_str("a place is missing"),
            Fault::NameWithoutPlace => f.write_str("this name has no number"),
            Fault::PlaceCount { given, needed } => {
                write!(f, "{given} places are listed for {needed} lines of the table")
            }
            Fault::RepeatedPlace => f.write_str("this place occurs twice"),
            Fault::TooSmallTable => f.write_str("the table is too small"),
        }
    }
}
