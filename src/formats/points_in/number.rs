//! One cell as a number, or the reason why it is none.

use super::cells::Cell;
use super::error::{Fault, ReadError};
use super::how::DecimalMark;

/// Reads cells and keeps to the decimal mark of the first number that has one.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct NumberReader {
    /// The mark and the line that it was first seen in.
    mark: Option<(DecimalMark, usize)>,
    /// Whether every comma so far stood before exactly three digits, as it
    /// does between thousands.
    only_groups: bool,
}

/// Longest text that can be a number: 17 digits, 300 zeros, mark and exponent
/// leave room to spare. Longer ones are not numbers of this world.
const LONGEST: usize = 400;

impl NumberReader {
    pub fn new() -> Self {
        NumberReader {
            mark: None,
            only_groups: true,
        }
    }

    /// The decimal mark of the file; `None` when there were whole numbers only.
    pub fn mark(&self) -> Option<DecimalMark> {
        self.mark.map(|(mark, _)| mark)
    }

    /// Whether the commas of this file could also stand between thousands.
    pub fn commas_could_be_thousands(&self) -> bool {
        self.mark() == Some(DecimalMark::Comma) && self.only_groups
    }

    /// The number in a cell; `None` where the cell says that there is none.
    ///
    /// # Errors
    /// Text that is no number, with the most helpful reason.
    pub fn read(
        &mut self,
        cell: &Cell<'_>,
        line: usize,
        column: usize,
    ) -> Result<Option<f64>, ReadError> {
        let text = cell.text.as_ref();
        if is_missing(text) {
            return Ok(None);
        }
        let fail = |fault| ReadError::at(line, column, text, fault);
        if !is_numeral(text) {
            return Err(fail(reason(text)));
        }
        if let Some(at) = text.find(['.', ',']) {
            let mark = DecimalMark::of(text.as_bytes()[at]);
            self.agree(mark, line)
                .map_err(|other_line| fail(Fault::MixedDecimalMarks { other_line }))?;
            self.only_groups &= looks_like_thousands(text, at);
        }
        let value = parse(text).ok_or_else(|| fail(Fault::NotANumber))?;
        if value.is_finite() {
            Ok(Some(value))
        } else {
            Err(fail(Fault::NotFinite))
        }
    }

    /// Keeps the first mark, or tells the line of it when this one differs.
    fn agree(&mut self, mark: DecimalMark, line: usize) -> Result<(), usize> {
        match self.mark {
            Some((first, first_line)) if first != mark => Err(first_line),
            Some(_) => Ok(()),
            None => {
                self.mark = Some((mark, line));
                Ok(())
            }
        }
    }
}

/// Whether a cell says that there is no value.
pub(super) fn is_missing(text: &str) -> bool {
    matches!(text, "" | "-" | "–" | "—" | "--" | "\u{2212}")
        || ["n/a", "na", "nan", "#n/a"]
            .iter()
            .any(|word| text.eq_ignore_ascii_case(word))
}

/// `[sign] digits [mark digits] [e [sign] digits]`, with a digit on one side of
/// the mark at least.
pub(super) fn is_numeral(text: &str) -> bool {
    if text.len() > LONGEST {
        return false;
    }
    let unsigned = text.strip_prefix(['+', '-', '\u{2212}']).unwrap_or(text);
    let (mantissa, exponent) = match unsigned.find(['e', 'E']) {
        Some(at) => (&unsigned[..at], Some(&unsigned[at + 1..])),
        None => (unsigned, None),
    };
    let digits = |s: &str| s.bytes().all(|b| b.is_ascii_digit());
    let (whole, part) = match mantissa.find(['.', ',']) {
        Some(at) => (&mantissa[..at], &mantissa[at + 1..]),
        None => (mantissa, ""),
    };
    let exponent_is_whole = exponent.is_none_or(|e| {
        let e = e.strip_prefix(['+', '-', '\u{2212}']).unwrap_or(e);
        !e.is_empty() && digits(e)
    });
    digits(whole) && digits(part) && whole.len() + part.len() > 0 && exponent_is_whole
}

/// A numeral's value; infinite where it is too large.
fn parse(text: &str) -> Option<f64> {
    if !text.contains([',', '\u{2212}']) {
        return text.parse().ok();
    }
    let mut buffer = String::with_capacity(text.len());
    buffer.extend(text.chars().map(|c| match c {
        ',' => '.',
        '\u{2212}' => '-',
        other => other,
    }));
    buffer.parse().ok()
}

/// Whether the mark at this byte could stand between thousands: one to three
/// digits before it that do not begin with 0, exactly three after.
fn looks_like_thousands(text: &str, at: usize) -> bool {
    let before = text[..at].trim_start_matches(['+', '-', '\u{2212}']);
    let after = &text[at + 1..];
    let is_group = after.len() == 3 && after.bytes().all(|b| b.is_ascii_digit());
    is_group && (1..=3).contains(&before.len()) && !before.starts_with('0')
}

/// Whether a text begins as numbers do, so that it was meant as one.
pub(super) fn begins_like_a_number(text: &str) -> bool {
    let unsigned = text.trim_start_matches(['+', '-', '\u{2212}', '.', ',']);
    unsigned.starts_with(|c: char| c.is_ascii_digit())
}

/// Why a text is no number.
fn reason(text: &str) -> Fault {
    const FRACTIONS: [char; 7] = ['½', '¼', '¾', '⅛', '⅜', '⅝', '⅞'];
    let unsigned = text.trim_start_matches(['+', '-', '\u{2212}']);
    if ["inf", "infinity", "∞"]
        .iter()
        .any(|word| unsigned.eq_ignore_ascii_case(word))
    {
        return Fault::NotFinite;
    }
    let has_digit = text.contains(|c: char| c.is_ascii_digit());
    if text.contains(FRACTIONS) || (has_digit && unsigned.contains(['/', '⁄'])) {
        return Fault::Fraction;
    }
    if !begins_like_a_number(text) {
        return Fault::NotANumber;
    }
    // After an `e` a hyphen belongs to the exponent.
    let inner_hyphen = unsigned
        .char_indices()
        .any(|(i, c)| c == '-' && !unsigned[..i].ends_with(['e', 'E']));
    if inner_hyphen || unsigned.contains(['\'', '"', '′', '″']) && !is_grouped(unsigned) {
        return Fault::Fraction;
    }
    if is_grouped(unsigned) {
        return Fault::Thousands;
    }
    let ends_in_letters = unsigned.ends_with(|c: char| c.is_alphabetic() || c == '°' || c == '%');
    if ends_in_letters {
        Fault::UnitInCell
    } else {
        Fault::NotANumber
    }
}

/// Digits in groups of three behind marks or blanks: `1.234,5`, `1 234`,
/// `1'234.5`, `1,234,567`.
fn is_grouped(text: &str) -> bool {
    let is_mark = |c: char| matches!(c, '.' | ',' | '\'' | '’' | ' ' | '\u{a0}' | '\u{202f}');
    if !text.chars().all(|c| c.is_ascii_digit() || is_mark(c)) {
        return false;
    }
    let mut groups = text.split(is_mark);
    let first = groups.next().map_or(0, str::len);
    let second = groups.next().map_or(0, str::len);
    (1..=3).contains(&first) && second == 3
}
