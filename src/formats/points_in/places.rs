//! Names of stations and waterlines, and the places that they stand for.
//!
//! A table may head its lines with their places, or with names ("AP", "½",
//! "9 1/2", "WL 3", "Tr") that stand for places only together with a list of
//! places or a spacing. Nothing is guessed: a name that a spacing cannot place
//! is an error.

use super::cells::Cell;
use super::error::{Fault, ReadError};
use super::number::is_numeral;

/// What the caller knows of the places along one direction of a table.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Ruler {
    /// They are written in the table.
    #[default]
    Written,
    /// One a line, in the order of the file; the table has names.
    Listed(Vec<f64>),
    /// The distance from number to number; the table has numbers as names.
    Spaced(f64),
}

/// What the caller knows of the places of a table.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Places {
    /// Of the stations.
    pub stations: Ruler,
    /// Of the waterlines.
    pub waterlines: Ruler,
}

/// The name of a line of the table, and where it stands.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Label {
    pub text: String,
    pub line: usize,
    /// Cell of the line, from 0.
    pub cell: usize,
}

impl Label {
    pub fn of(cell: &Cell<'_>, line: usize, index: usize) -> Self {
        Label {
            text: cell.text.clone().into_owned(),
            line,
            cell: index,
        }
    }

    pub fn fault(&self, fault: Fault) -> ReadError {
        ReadError::at(self.line, self.cell, &self.text, fault)
    }
}

/// Places of named lines by a list or a spacing; what was made of
/// perpendiculars goes to `notes`.
///
/// # Errors
/// A list of another length, a name without a number where there is only a
/// spacing.
pub(super) fn placed(
    labels: &[Label],
    ruler: &Ruler,
    notes: &mut Vec<String>,
) -> Result<Vec<f64>, ReadError> {
    match ruler {
        Ruler::Listed(list) if list.len() == labels.len() => Ok(list.clone()),
        Ruler::Listed(list) => {
            let fault = Fault::PlaceCount {
                given: list.len(),
                needed: labels.len(),
            };
            let line = labels.first().map_or(1, |l| l.line);
            Err(ReadError::in_line(line, "", fault))
        }
        Ruler::Spaced(spacing) => {
            let numbers = numbers(labels, notes)?;
            Ok(numbers.into_iter().map(|n| n * spacing).collect())
        }
        Ruler::Written => Ok(Vec::new()),
    }
}

/// The numbers in names. A perpendicular at an end of the table has the next
/// whole number beyond its neighbour; a base line has 0.
fn numbers(labels: &[Label], notes: &mut Vec<String>) -> Result<Vec<f64>, ReadError> {
    let own: Vec<Option<f64>> = labels.iter().map(|l| number_in(&l.text)).collect();
    let mut all = Vec::with_capacity(labels.len());
    for (i, label) in labels.iter().enumerate() {
        let number = match own[i] {
            Some(number) => number,
            None => {
                let number = perpendicular(&own, i).filter(|_| is_perpendicular(&label.text));
                let number = number.ok_or_else(|| label.fault(Fault::NameWithoutPlace))?;
                notes.push(format!("“{}” was taken as number {number}.", label.text));
                number
            }
        };
        all.push(number);
    }
    Ok(all)
}

/// The whole number beyond the neighbour of the first or last line, in the
/// direction in which the numbers run there.
fn perpendicular(own: &[Option<f64>], i: usize) -> Option<f64> {
    let last = own.len() - 1;
    let (near, far) = match i {
        0 => (own.get(1), own.get(2)),
        _ if i == last => (own.get(last.checked_sub(1)?), own.get(last.checked_sub(2)?)),
        _ => return None,
    };
    let (near, far) = ((*near?)?, (*far?)?);
    Some(if near > far {
        near.floor() + 1.0
    } else {
        near.ceil() - 1.0
    })
}

/// Names of perpendiculars in English, German and French, letters only.
const PERPENDICULARS: [&str; 8] = ["ap", "fp", "ape", "fpe", "hl", "vl", "ppar", "ppav"];
/// Names of the base line.
const BASE_LINES: [&str; 4] = ["bl", "base", "baseline", "basis"];

fn letters(text: &str) -> String {
    let alphabetic = text.chars().filter(|c| c.is_alphabetic());
    alphabetic.flat_map(char::to_lowercase).collect()
}

fn is_perpendicular(text: &str) -> bool {
    PERPENDICULARS.contains(&letters(text).as_str())
}

/// The number in a name: "3", "9½", "9 1/2", "WL 3", "St. 2,5", "-1"; 0 for
/// the base line.
fn number_in(text: &str) -> Option<f64> {
    if BASE_LINES.contains(&letters(text).as_str()) {
        return Some(0.0);
    }
    let starts = |c: char| c.is_ascii_digit() || part(c).is_some() || c == '-' || c == '\u{2212}';
    let bare = text[text.find(starts)?..].trim();
    let (sign, bare) = match bare.strip_prefix(['-', '\u{2212}']) {
        Some(rest) => (-1.0, rest.trim_start()),
        None => (1.0, bare),
    };
    unsigned(bare).map(|n| sign * n)
}

/// Whole number, decimal, fraction or both.
fn unsigned(text: &str) -> Option<f64> {
    if let Some(value) = text.chars().next_back().and_then(part) {
        let whole = text[..text.len() - text.chars().next_back()?.len_utf8()].trim();
        let whole = if whole.is_empty() { 0.0 } else { plain(whole)? };
        return Some(whole + value);
    }
    let Some((head, below)) = text.split_once(['/', '⁄']) else {
        return plain(text);
    };
    let (whole, above) = match head.trim().rsplit_once([' ', '-']) {
        Some((whole, above)) => (plain(whole.trim())?, above),
        None => (0.0, head.trim()),
    };
    let (above, below) = (plain(above)?, plain(below.trim())?);
    (below > 0.0).then(|| whole + above / below)
}

fn plain(text: &str) -> Option<f64> {
    let number = is_numeral(text) && !text.starts_with(['+', '-', '\u{2212}']);
    let value: f64 = number.then(|| text.replace(',', ".").parse().ok())??;
    value.is_finite().then_some(value)
}

/// The value of a fraction that is one letter.
fn part(letter: char) -> Option<f64> {
    const PARTS: [(char, f64); 9] = [
        ('½', 0.5),
        ('¼', 0.25),
        ('¾', 0.75),
        ('⅛', 0.125),
        ('⅜', 0.375),
        ('⅝', 0.625),
        ('⅞', 0.875),
        ('⅓', 1.0 / 3.0),
        ('⅔', 2.0 / 3.0),
    ];
    PARTS.iter().find(|(l, _)| *l == letter).map(|(_, v)| *v)
}

/// Whether a cell heads a row or a column of places: "x (m)", "height",
/// "distance from AP".
pub(super) fn heads_places(text: &str) -> bool {
    const WORDS: [&str; 20] = [
        "x",
        "z",
        "xm",
        "zm",
        "xmm",
        "zmm",
        "pos",
        "position",
        "place",
        "dist",
        "distance",
        "distancefromap",
        "fromap",
        "height",
        "heightabovebl",
        "abstand",
        "höhe",
        "hoogte",
        "hauteur",
        "altezza",
    ];
    let bare = text.split(['[', '(']).next().unwrap_or_default();
    WORDS.contains(&letters(bare).as_str())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_in_names() {
        for (text, number) in [
            ("3", Some(3.0)),
            ("½", Some(0.5)),
            ("9 1/2", Some(9.5)),
            ("9-1/2", Some(9.5)),
            ("9½", Some(9.5)),
            ("1/4", Some(0.25)),
            ("WL 3", Some(3.0)),
            ("St. 2,5", Some(2.5)),
            ("-1", Some(-1.0)),
            ("− ½", Some(-0.5)),
            ("BL", Some(0.0)),
            ("Tr", None),
            ("AP", None),
            ("3a", None),
            ("1/0", None),
        ] {
            assert_eq!(number_in(text), number, "{text}");
        }
    }

    #[test]
    fn perpendiculars_are_whole_numbers_beyond_their_neighbours() {
        let labels = |texts: &[&str]| -> Vec<Label> {
            let label = |t: &&str| Label {
                text: (*t).to_owned(),
                line: 1,
                cell: 0,
            };
            texts.iter().map(label).collect()
        };
        let mut notes = Vec::new();
        let found = numbers(&labels(&["AP", "½", "1", "9", "9½", "FP"]), &mut notes);
        assert_eq!(found, Ok(vec![0.0, 0.5, 1.0, 9.0, 9.5, 10.0]));
        assert_eq!(notes.len(), 2);
        let found = numbers(&labels(&["FP", "1", "2", "AP"]), &mut notes);
        assert_eq!(found, Ok(vec![0.0, 1.0, 2.0, 3.0]));
        let fault = numbers(&labels(&["Tr", "1", "2"]), &mut notes).map_err(|e| e.fault);
        assert_eq!(fault, Err(Fault::NameWithoutPlace));
    }
}
