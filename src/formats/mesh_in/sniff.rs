//! What a mesh file is, told from what is in it.

use super::error::{Fault, MeshReadError, Place};
use super::stl;
use super::text::{Lines, words};
use std::fmt;

/// The formats that are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MeshFormat {
    /// Wavefront OBJ.
    Obj,
    /// STL as text.
    AsciiStl,
    /// STL, binary.
    BinaryStl,
    /// PLY, text or binary.
    Ply,
}

impl MeshFormat {
    /// What the format calls its first vertex.
    pub(super) fn first_index(self) -> usize {
        usize::from(self == MeshFormat::Obj)
    }
}

impl fmt::Display for MeshFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            MeshFormat::Obj => "OBJ",
            MeshFormat::AsciiStl => "STL (text)",
            MeshFormat::BinaryStl => "STL (binary)",
            MeshFormat::Ply => "PLY",
        })
    }
}

/// Lines looked at for a word of OBJ: comments at the top may be long.
const SAMPLE: usize = 10_000;

/// Words that only OBJ files begin a line with, and that every mesh has.
const OBJ_WORDS: [&str; 2] = ["v", "f"];

/// The format. Binary STL files may begin with `solid` too, so the length
/// decides first; a binary one that was cut short is told from text by its
/// bytes.
pub(super) fn format(bytes: &[u8]) -> Result<MeshFormat, MeshReadError> {
    if bytes.starts_with(b"ply\n") || bytes.starts_with(b"ply\r") {
        return Ok(MeshFormat::Ply);
    }
    if stl::length_fits(bytes) {
        return Ok(MeshFormat::BinaryStl);
    }
    let is_text = !bytes.contains(&0);
    let mut heads = Lines::new(bytes)
        .filter_map(|(_, line)| words(&line).next().map(str::to_ascii_lowercase))
        .take(SAMPLE);
    if is_text && heads.clone().next().is_some_and(|word| word == "solid") {
        return Ok(MeshFormat::AsciiStl);
    }
    if is_text && heads.any(|word| OBJ_WORDS.contains(&word.as_str())) {
        return Ok(MeshFormat::Obj);
    }
    if !is_text && bytes.len() > stl::HEADER {
        return Ok(MeshFormat::BinaryStl);
    }
    Err(MeshReadError::new(Place::File, "", Fault::UnknownFormat))
}
