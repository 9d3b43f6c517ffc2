//! How a file was read, for people to check.

use super::Coordinate;

/// What stands between the cells of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Separator {
    /// `,`
    Comma,
    /// `;`
    Semicolon,
    /// Tabulator.
    Tab,
    /// One or more blanks or tabulators.
    Blanks,
}

impl Separator {
    /// The one letter that separates; `None` for runs of blanks.
    #[must_use]
    pub fn letter(self) -> Option<char> {
        match self {
            Separator::Comma => Some(','),
            Separator::Semicolon => Some(';'),
            Separator::Tab => Some('\t'),
            Separator::Blanks => None,
        }
    }

    /// As a word: `comma`, `semicolon`, `tab`, `blanks`.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Separator::Comma => "comma",
            Separator::Semicolon => "semicolon",
            Separator::Tab => "tab",
            Separator::Blanks => "blanks",
        }
    }
}

/// What stands before the decimals of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DecimalMark {
    /// `1.5`
    Point,
    /// `1,5`
    Comma,
}

impl DecimalMark {
    pub(super) fn of(byte: u8) -> Self {
        if byte == b',' {
            DecimalMark::Comma
        } else {
            DecimalMark::Point
        }
    }

    /// As a word: `point`, `comma`.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            DecimalMark::Point => "point",
            DecimalMark::Comma => "comma",
        }
    }
}

/// Lines that carried no data, by reason.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Skipped {
    /// Comments.
    pub comments: usize,
    /// Empty lines, also such with separators only.
    pub empty: usize,
    /// Lines of text above the numbers, by line number; the header row that
    /// named the columns is not among them. The first
    /// [`Skipped::MOST_TEXT_LINES`] of them.
    pub text: Vec<usize>,
}

impl Skipped {
    /// Lines of text that are listed.
    pub const MOST_TEXT_LINES: usize = 20;
}

/// One column of coordinates.
#[derive(Debug, Clone, PartialEq)]
pub struct ColumnRead {
    /// Number in the file, 1-based.
    pub number: usize,
    /// What it was read as.
    pub coordinate: Coordinate,
    /// Its name in the header, if there was one.
    pub name: Option<String>,
    /// The unit that its header gives in brackets.
    pub unit: Option<String>,
}

/// How a file was read.
#[derive(Debug, Clone, PartialEq)]
pub struct HowRead {
    /// What separates cells.
    pub separator: Separator,
    /// The decimal mark; `None` when all numbers were whole.
    pub decimal_mark: Option<DecimalMark>,
    /// The line of the row that named the columns.
    pub header_line: Option<usize>,
    /// The names in that row, as written.
    pub header: Vec<String>,
    /// The columns of coordinates used, in the order x, y, z; none for a table.
    pub columns: Vec<ColumnRead>,
    /// The unit that the header gives for all columns used.
    pub unit: Option<String>,
    /// Lines without data.
    pub skipped: Skipped,
    /// What was read, in one phrase: "120 points", "21 stations × 9 waterlines".
    pub amount: String,
    /// Values that were missing among those expected.
    pub missing: usize,
    /// What a person should know: columns ignored, names understood freely.
    pub notes: Vec<String>,
}

impl HowRead {
    /// All of it in one or two sentences, then the notes.
    #[must_use]
    pub fn sentence(&self) -> String {
        let mut text = format!("Read {}", self.amount);
        if !self.columns.is_empty() {
            let columns: Vec<String> = self.columns.iter().map(ColumnRead::phrase).collect();
            text.push_str(&format!(" from columns {}", columns.join(", ")));
        }
        text.push_str(&format!("; separated by {}", self.separator.word()));
        if let Some(mark) = self.decimal_mark {
            text.push_str(&format!(", decimal {}", mark.word()));
        }
        if let Some(line) = self.header_line {
            text.push_str(&format!(", names in line {line}"));
        }
        text.push('.');
        let skipped = self.skipped_phrases();
        if !skipped.is_empty() {
            text.push_str(&format!(" Skipped: {}.", skipped.join(", ")));
        }
        for note in &self.notes {
            text.push(' ');
            text.push_str(note);
        }
        text
    }

    fn skipped_phrases(&self) -> Vec<String> {
        let mut phrases = Vec::new();
        let mut count = |n: usize, one: &str, many: &str| match n {
            0 => {}
            1 => phrases.push(format!("1 {one}")),
            n => phrases.push(format!("{n} {many}")),
        };
        count(self.skipped.comments, "comment line", "comment lines");
        count(self.skipped.empty, "empty line", "empty lines");
        count(self.skipped.text.len(), "line of text", "lines of text");
        count(self.missing, "missing value", "missing values");
        phrases
    }
}

impl ColumnRead {
    fn phrase(&self) -> String {
        let coordinate = match self.coordinate {
            Coordinate::X => "x",
            Coordinate::Y => "y",
            Coordinate::Z => "z",
        };
        match &self.name {
            Some(name) if !name.eq_ignore_ascii_case(coordinate) => {
                format!("{} (“{name}” as {coordinate})", self.number)
            }
            _ => format!("{} ({coordinate})", self.number),
        }
    }
}
