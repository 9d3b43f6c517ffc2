//! What separates the cells of a file, told from its first lines.

use super::cells::{FirstLine, is_comment};
use super::error::{Fault, ReadError};
use super::how::Separator;
use super::number::{begins_like_a_number, is_numeral};

/// What is found out before any cell is read.
pub(super) struct Style {
    pub separator: Separator,
    pub first_line: FirstLine,
}

/// Lines with digits that are looked at: enough to outvote a few odd ones.
const SAMPLE: usize = 200;

/// Finds the separator: named in a first line `sep=;`, or else the first of
/// semicolon, tab, comma and blanks that most lines with digits speak for.
///
/// # Errors
/// [`Fault::AmbiguousComma`] where commas are found both as in `1, 2` and as
/// in `1,5`, and no decimal point settles it.
pub(super) fn style(text: &str) -> Result<Style, ReadError> {
    if let Some(separator) = named_separator(text) {
        return Ok(Style {
            separator,
            first_line: FirstLine::NamesSeparator,
        });
    }
    let sample: Vec<(usize, &str)> = text
        .split(['\n', '\r'])
        .enumerate()
        .filter(|(_, l)| !is_comment(l.trim_start()) && l.contains(|c: char| c.is_ascii_digit()))
        .take(SAMPLE)
        .collect();
    let most = |test: fn(&str) -> bool| {
        let votes = sample.iter().filter(|(_, l)| test(l)).count();
        votes * 2 > sample.len()
    };
    let separator = if most(|l| l.contains(';')) {
        Separator::Semicolon
    } else if most(is_tabbed) {
        Separator::Tab
    } else if most(is_comma_separated) {
        refuse_ambiguous_commas(&sample, text)?;
        Separator::Comma
    } else {
        Separator::Blanks
    };
    Ok(Style {
        separator,
        first_line: FirstLine::Plain,
    })
}

/// The line `sep=;` that spreadsheets put first.
fn named_separator(text: &str) -> Option<Separator> {
    let first = text.split(['\n', '\r']).next()?;
    let bare = first.trim_matches(['"', ' ']);
    if !bare.get(..4)?.eq_ignore_ascii_case("sep=") {
        return None;
    }
    match bare.get(4..)? {
        ";" => Some(Separator::Semicolon),
        "," => Some(Separator::Comma),
        "\t" => Some(Separator::Tab),
        "" => Some(Separator::Blanks),
        _ => None,
    }
}

/// Tabs with nothing but single cells between them. Where blanks separate
/// numbers too, tabs are just blanks.
fn is_tabbed(line: &str) -> bool {
    let is_single = |cell: &str| {
        let mut numbers = cell.split_whitespace().filter(|t| is_numeral(t));
        numbers.next().is_none() || numbers.next().is_none()
    };
    line.trim().contains('\t') && line.split('\t').all(is_single)
}

/// Commas that are not all inside numbers set apart by blanks, as in
/// `1,5 2,5`.
fn is_comma_separated(line: &str) -> bool {
    let stands_apart = |t: &str| !begins_like_a_number(t) || is_numeral(t);
    let mut words = 0;
    let apart = line
        .split_whitespace()
        .inspect(|_| words += 1)
        .all(|t| stands_apart(t) && !t.starts_with(',') && !t.ends_with(','));
    line.contains(',') && !(apart && words > 1)
}

/// `1,5, 2,5` may be two numbers or four; a decimal point anywhere says four.
fn refuse_ambiguous_commas(sample: &[(usize, &str)], text: &str) -> Result<(), ReadError> {
    let unquoted = |l: &str| !l.contains('"');
    if sample.iter().any(|(_, l)| l.contains('.') || !unquoted(l)) {
        return Ok(());
    }
    let is_both = |l: &str| {
        let follows = |blank: bool| {
            l.trim_end().char_indices().any(|(i, c)| {
                let next = l[i + c.len_utf8()..].chars().next();
                c == ',' && next.is_some_and(|n| n.is_whitespace() == blank && n != ',')
            })
        };
        follows(true) && follows(false)
    };
    match sample.iter().find(|(_, l)| is_both(l)) {
        None => Ok(()),
        Some((index, line)) => {
            let number = line_number(text, *index);
            Err(ReadError::in_line(
                number,
                line.trim(),
                Fault::AmbiguousComma,
            ))
        }
    }
}

/// The number of the `index`-th piece between line ends, where CR LF is one.
fn line_number(text: &str, index: usize) -> usize {
    let pieces = text.split(['\n', '\r']).take(index);
    let bytes: usize = pieces.map(|p| p.len() + 1).sum();
    1 + super::count_line_ends(text.as_bytes().get(..bytes).unwrap_or_default())
}
