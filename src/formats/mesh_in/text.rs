//! Lines and numbers of text files.

use super::error::{Fault, MeshReadError, Place};
use std::borrow::Cow;

/// The lines of a file with their numbers, whatever ends them. Letters that
/// are not UTF-8, as old programmes put into comments, become `�`.
#[derive(Debug, Clone)]
pub(super) struct Lines<'a> {
    rest: Option<&'a [u8]>,
    number: usize,
    /// Bytes of the file before the rest.
    offset: usize,
}

impl<'a> Lines<'a> {
    pub fn new(bytes: &'a [u8]) -> Self {
        let mark = b"\xef\xbb\xbf";
        let rest = bytes.strip_prefix(mark).unwrap_or(bytes);
        Lines {
            rest: Some(rest),
            number: 0,
            offset: bytes.len() - rest.len(),
        }
    }

    /// The number of the line that was last given.
    pub fn number(&self) -> usize {
        self.number
    }

    /// Where in the file the next line begins.
    pub fn offset(&self) -> usize {
        self.offset
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = (usize, Cow<'a, str>);

    fn next(&mut self) -> Option<Self::Item> {
        let rest = self.rest?;
        let end = rest.iter().position(|b| matches!(b, b'\n' | b'\r'));
        let line = &rest[..end.unwrap_or(rest.len())];
        self.rest = end.map(|at| {
            let pair = rest[at..].starts_with(b"\r\n");
            let skip = at + 1 + usize::from(pair);
            self.offset += skip;
            &rest[skip..]
        });
        self.number += 1;
        Some((self.number, String::from_utf8_lossy(line)))
    }
}

/// The words of a line.
pub(super) fn words(line: &str) -> std::str::SplitAsciiWhitespace<'_> {
    line.split_ascii_whitespace()
}

/// A finite number.
pub(super) fn number(word: &str, line: usize) -> Result<f64, MeshReadError> {
    word.parse()
        .ok()
        .filter(|x: &f64| x.is_finite())
        .ok_or_else(|| MeshReadError::new(Place::Line(line), word, Fault::NotANumber))
}

/// Three finite numbers; what follows is left.
pub(super) fn point<'a>(
    words: &mut impl Iterator<Item = &'a str>,
    line: usize,
) -> Result<nalgebra::Point3<f64>, MeshReadError> {
    let mut x = [0.0; 3];
    for (axis, slot) in x.iter_mut().enumerate() {
        let word = words.next().ok_or_else(|| {
            let found = if axis == 0 { "" } else { "only some of them" };
            MeshReadError::new(Place::Line(line), found, Fault::TooFewCoordinates)
        })?;
        *slot = number(word, line)?;
    }
    Ok(x.into())
}
