//! A file as lines, a line as cells.

use super::error::{Fault, ReadError};
use super::how::Separator;
use std::borrow::Cow;

/// One cell without the blanks around it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Cell<'a> {
    /// Its text, quotes taken off.
    pub text: Cow<'a, str>,
    /// Whether it stood in quotes: a comma in it then separates nothing.
    pub quoted: bool,
}

/// Lines with their numbers; those that carry no data are counted on the way.
pub(super) struct Lines<'a> {
    rest: &'a str,
    next: usize,
    /// What stands between cells.
    pub separator: Separator,
    /// Lines that begin with a comment mark.
    pub comments: usize,
    /// Lines without a letter in any cell.
    pub empty: usize,
}

/// A line that may carry data.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Line<'a> {
    /// Number in the file, 1-based.
    pub number: usize,
    /// Without its end.
    pub text: &'a str,
}

impl<'a> Lines<'a> {
    /// The lines of a text whose first one has this number in the file.
    pub fn new(text: &'a str, first: FirstLine, separator: Separator) -> Self {
        let mut lines = Lines {
            rest: text,
            next: 1,
            separator,
            comments: 0,
            empty: 0,
        };
        if first == FirstLine::NamesSeparator {
            let _ = lines.next_raw();
        }
        lines
    }

    /// The next line that is neither comment nor empty.
    pub fn next_line(&mut self) -> Option<Line<'a>> {
        loop {
            let line = self.next_raw()?;
            let text = line.text.trim();
            if is_comment(text) {
                self.comments += 1;
            } else if is_empty(text, self.separator) {
                self.empty += 1;
            } else {
                return Some(line);
            }
        }
    }

    /// The number of the last line that was read.
    pub fn last_number(&self) -> usize {
        (self.next - 1).max(1)
    }

    /// The next line whatever it holds; ends are LF, CR LF or CR.
    fn next_raw(&mut self) -> Option<Line<'a>> {
        if self.rest.is_empty() {
            return None;
        }
        let end = self.rest.find(['\n', '\r']).unwrap_or(self.rest.len());
        let (text, tail) = self.rest.split_at(end);
        self.rest = tail
            .strip_prefix("\r\n")
            .or_else(|| tail.strip_prefix(['\n', '\r']))
            .unwrap_or(tail);
        let number = self.next;
        self.next += 1;
        Some(Line { number, text })
    }
}

/// What the first line of the file is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FirstLine {
    /// A line like the others.
    Plain,
    /// `sep=;`, which spreadsheets write to name the separator.
    NamesSeparator,
}

/// Whether a trimmed line is a comment.
pub(super) fn is_comment(text: &str) -> bool {
    text.starts_with(['#', '%']) || text.starts_with("//")
}

/// Whether a trimmed line holds separators at most.
fn is_empty(text: &str, separator: Separator) -> bool {
    text.chars()
        .all(|c| c.is_whitespace() || separator.letter() == Some(c))
}

/// Cells in a line at most: no table has so many, and a file without line ends
/// would fill the memory.
pub(super) const MOST_CELLS: usize = 100_000;

/// Splits a line into `cells`, which are emptied first.
///
/// # Errors
/// A quote that is not closed, more cells than [`MOST_CELLS`].
pub(super) fn split<'a>(
    line: Line<'a>,
    separator: Separator,
    cells: &mut Vec<Cell<'a>>,
) -> Result<(), ReadError> {
    cells.clear();
    match separator.letter() {
        None => cells.extend(line.text.split_whitespace().take(MOST_CELLS + 1).map(plain)),
        Some(letter) if !line.text.contains('"') => {
            let texts = line.text.split(letter).take(MOST_CELLS + 1);
            cells.extend(texts.map(|c| plain(c.trim())));
        }
        Some(letter) => split_quoted(line, letter, cells)?,
    }
    if cells.len() > MOST_CELLS {
        let expected = MOST_CELLS;
        return Err(ReadError::in_line(
            line.number,
            line.text,
            Fault::LongRow { expected },
        ));
    }
    Ok(())
}

fn plain(text: &str) -> Cell<'_> {
    Cell {
        text: Cow::Borrowed(text),
        quoted: false,
    }
}

/// As [`split`] where some cells are quoted (RFC 4180 §2.5–2.7; blanks around
/// the quotes are allowed, for hand-written files have them).
fn split_quoted<'a>(
    line: Line<'a>,
    letter: char,
    cells: &mut Vec<Cell<'a>>,
) -> Result<(), ReadError> {
    let mut rest = line.text;
    loop {
        let start = rest.trim_start_matches(|c: char| c.is_whitespace() && c != letter);
        let tail = match start.strip_prefix('"') {
            None => {
                let end = start.find(letter).unwrap_or(start.len());
                cells.push(plain(start[..end].trim()));
                &start[end..]
            }
            Some(inside) => {
                let open = || ReadError::at(line.number, cells.len(), start, Fault::OpenQuote);
                let end = closing_quote(inside).ok_or_else(open)?;
                let after = &inside[end + 1..];
                let next = after.find(letter).unwrap_or(after.len());
                // Letters after the closing quote would be lost in silence.
                if !after[..next].trim().is_empty() {
                    return Err(open());
                }
                cells.push(Cell {
                    text: unescaped(inside[..end].trim()),
                    quoted: true,
                });
                &after[next..]
            }
        };
        match tail.strip_prefix(letter) {
            Some(next) if cells.len() <= MOST_CELLS => rest = next,
            _ => return Ok(()),
        }
    }
}

/// The place of the quote that closes a field; doubled ones do not.
fn closing_quote(inside: &str) -> Option<usize> {
    let bytes = inside.as_bytes();
    let mut i = 0;
    while i < bytes.len() {
        match (bytes[i], bytes.get(i + 1)) {
            (b'"', Some(b'"')) => i += 2,
            (b'"', _) => return Some(i),
            _ => i += 1,
        }
    }
    None
}

fn unescaped(text: &str) -> Cow<'_, str> {
    if text.contains("\"\"") {
        Cow::Owned(text.replace("\"\"", "\""))
    } else {
        Cow::Borrowed(text)
    }
}

/// Drops empty cells at the end of a row, which trailing separators leave.
pub(super) fn drop_trailing(cells: &mut Vec<Cell<'_>>, least: usize) {
    while cells.len() > least && cells.last().is_some_and(|c| c.text.is_empty()) {
        cells.pop();
    }
}
