//! STL, as text and binary. The format has no vertices, only corners: those in
//! the same place are made one vertex.

use super::Soup;
use super::bytes::{ByteOrder, Bytes, Scalar};
use super::error::{Fault, MeshReadError, Place};
use super::text::{Lines, point, words};
use super::weld::Weld;
use nalgebra::Point3;

/// Bytes before the first facet: a comment of 80, the number of facets.
pub(super) const HEADER: usize = 84;
/// Bytes of a facet: normal and three corners in single precision, a spare
/// word of two bytes.
const FACET: usize = 50;

/// The number of facets that the header of a binary file gives.
fn promised(bytes: &[u8]) -> Option<usize> {
    let count = bytes.get(80..HEADER)?;
    let count = u32::from_le_bytes(count.try_into().ok()?);
    usize::try_from(count).ok()
}

/// Whether the length is just that of a binary file with its facets.
pub(super) fn length_fits(bytes: &[u8]) -> bool {
    let facets = (bytes.len().checked_sub(HEADER)).filter(|body| body % FACET == 0);
    facets.is_some_and(|body| promised(bytes) == Some(body / FACET))
}

pub(super) fn read_binary(bytes: &[u8]) -> Result<Soup, MeshReadError> {
    let promised = promised(bytes).unwrap_or(0);
    let held = bytes.len().saturating_sub(HEADER) / FACET;
    if promised > held {
        let found = format!("{promised} facets promised, {held} found");
        return Err(MeshReadError::new(Place::Byte(80), &found, Fault::Promises));
    }
    let mut soup = Soup::default();
    let mut weld = Weld::default();
    for facet in 0..promised {
        let mut reader = Bytes::new(bytes, HEADER + facet * FACET + 12, ByteOrder::Little);
        let mut corners = [0; 3];
        for corner in &mut corners {
            let mut x = [0.0; 3];
            for x in &mut x {
                *x = reader.scalar(Scalar::F32)?;
                if !x.is_finite() {
                    let found = x.to_string();
                    return Err(MeshReadError::new(
                        Place::Face(facet),
                        &found,
                        Fault::NotANumber,
                    ));
                }
            }
            *corner = weld.vertex(Point3::from(x), &mut soup.vertices);
        }
        soup.push(&corners, Place::Face(facet))?;
    }
    Ok(soup)
}

pub(super) fn read_text(bytes: &[u8]) -> Result<Soup, MeshReadError> {
    let mut soup = Soup::default();
    let mut weld = Weld::default();
    let mut open: Option<(usize, Vec<usize>)> = None;
    let mut lines = Lines::new(bytes);
    for (line, text) in lines.by_ref() {
        let mut words = words(&text);
        let Some(head) = words.next() else { continue };
        let fail = |fault| Err(MeshReadError::new(Place::Line(line), text.trim(), fault));
        match (head.to_ascii_lowercase().as_str(), &mut open) {
            ("facet", None) => open = Some((line, Vec::with_capacity(3))),
            ("vertex", Some((_, corners))) => {
                let p = point(&mut words, line)?;
                corners.push(weld.vertex(p, &mut soup.vertices));
            }
            ("endfacet", Some((start, corners))) => {
                if corners.len() != 3 {
                    return fail(Fault::FacetCorners);
                }
                soup.push(corners, Place::Line(*start))?;
                open = None;
            }
            ("outer" | "endloop", Some(_)) | ("solid" | "endsolid", None) => {}
            _ => return fail(Fault::UnexpectedWord),
        }
    }
    match open {
        Some(_) => Err(MeshReadError::new(
            Place::Line(lines.number()),
            "",
            Fault::EndsEarly,
        )),
        None => Ok(soup),
    }
}
