//! Wavefront OBJ.

use super::Soup;
use super::error::{Fault, MeshReadError, Place};
use super::text::{Lines, point, words};

pub(super) fn read(bytes: &[u8]) -> Result<Soup, MeshReadError> {
    let mut soup = Soup::default();
    let mut corners = Vec::new();
    let mut lines = Lines::new(bytes);
    while let Some((line, text)) = lines.next() {
        let mut text = text.into_owned();
        while text.ends_with('\\') {
            text.pop();
            text.push(' ');
            match lines.next() {
                Some((_, more)) => text.push_str(&more),
                None => break,
            }
        }
        let code = text.split('#').next().unwrap_or_default();
        let mut words = words(code);
        match words.next() {
            Some("v") => soup.vertices.push(point(&mut words, line)?),
            Some("f" | "fo") => {
                corners.clear();
                for word in words {
                    corners.push(index(word, soup.vertices.len(), line)?);
                }
                soup.push(&corners, Place::Line(line))?;
            }
            _ => {}
        }
    }
    Ok(soup)
}

/// The vertex of a corner `v`, `v/t`, `v//n` or `v/t/n`, counted from 0. An
/// index beyond those seen so far is left to be checked at the end.
fn index(word: &str, seen: usize, line: usize) -> Result<usize, MeshReadError> {
    let fail = |fault| MeshReadError::new(Place::Line(line), word, fault);
    let number = word.split('/').next().unwrap_or_default();
    let number: i64 = number.parse().map_err(|_| fail(Fault::NotAnIndex))?;
    if number > 0 {
        return usize::try_from(number - 1).map_err(|_| fail(Fault::NotAnIndex));
    }
    let back = usize::try_from(number.unsigned_abs()).unwrap_or(usize::MAX);
    match seen.checked_sub(back) {
        _ if back == 0 => Err(fail(Fault::NotAnIndex)),
        Some(vertex) => Ok(vertex),
        None => Err(fail(Fault::NoSuchVertex { vertices: seen })),
    }
}
