//! Meshes from the files that CAD programmes and scanners write: OBJ, STL and
//! PLY, told apart by what is in them, never by a name.
//!
//! | format | what is read | what is passed over |
//! |---|---|---|
//! | OBJ | `v`, `f` (`v`, `v/t`, `v//n`, `v/t/n`, counted from 1 or back from the last), lines continued with `\` | groups, materials, texture, normals, points and lines |
//! | STL | ASCII and binary; corners in the very same place become one vertex | normals, attributes |
//! | PLY | ASCII, binary of both byte orders, properties of any type in any order | other properties and elements |
//!
//! A header's word about sizes is never believed: nothing is set aside for
//! more than the file can hold. Faces of more than four corners are refused,
//! for how to cut them is the designer's choice.
//!
//! Limits: coordinates as they stand in the file, in its own unit; PLY triangle
//! strips and OBJ free-form surfaces are not read; OBJ weights and colours
//! behind the coordinates are passed over.

mod bytes;
mod error;
mod obj;
mod ply;
mod ply_header;
mod sniff;
mod stl;
#[cfg(test)]
mod tests;
mod text;
mod weld;

pub use error::{Fault, MeshReadError, Place};
pub use sniff::MeshFormat;

use crate::geometry::{Face, Mesh, MeshError};
use nalgebra::Point3;

/// A mesh file that was understood.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshReading {
    /// The mesh, vertices and faces in the order of the file.
    pub mesh: Mesh,
    /// How it was read.
    pub how: HowRead,
}

/// How a mesh file was read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct HowRead {
    /// Its format.
    pub format: MeshFormat,
    /// Faces left out because two of their corners are in one place.
    pub collapsed: usize,
}

impl MeshReading {
    /// How the file was read, as a sentence.
    #[must_use]
    pub fn sentence(&self) -> String {
        let (vertices, faces) = (self.mesh.vertices().len(), self.mesh.faces());
        let quads = faces.iter().filter(|f| f.corners().len() == 4).count();
        let triangles = faces.len() - quads;
        let mut sentence = format!(
            "read as {}: {vertices} vertices, {triangles} triangles, {quads} quads",
            self.how.format
        );
        if self.how.collapsed > 0 {
            let left_out = self.how.collapsed;
            sentence.push_str(&format!(
                "; {left_out} faces with two corners in one place left out"
            ));
        }
        sentence
    }
}

/// Reads a mesh.
///
/// # Errors
/// The first place that cannot be read, with what was found there and a hint.
pub fn read(bytes: &[u8]) -> Result<MeshReading, MeshReadError> {
    let format = sniff::format(bytes)?;
    let soup = match format {
        MeshFormat::Obj => obj::read(bytes),
        MeshFormat::AsciiStl => stl::read_text(bytes),
        MeshFormat::BinaryStl => stl::read_binary(bytes),
        MeshFormat::Ply => ply::read(bytes),
    }?;
    soup.into_reading(format)
}

/// What a reader has gathered: faces, and the place in the file of each.
#[derive(Debug, Default)]
struct Soup {
    vertices: Vec<Point3<f64>>,
    faces: Vec<Face>,
    places: Vec<Place>,
    collapsed: usize,
}

impl Soup {
    /// Adds a face; one with two corners in the same vertex is left out.
    fn push(&mut self, corners: &[usize], place: Place) -> Result<(), MeshReadError> {
        let repeated = (1..corners.len()).any(|i| corners[..i].contains(&corners[i]));
        match Face::of(corners) {
            Some(_) if repeated => self.collapsed += 1,
            Some(face) => {
                self.faces.push(face);
                self.places.push(place);
            }
            None => {
                let found = format!("{} corners", corners.len());
                return Err(MeshReadError::new(place, &found, Fault::Corners));
            }
        }
        Ok(())
    }

    /// Checks the indices, which may point forward in the file.
    fn into_reading(self, format: MeshFormat) -> Result<MeshReading, MeshReadError> {
        if self.faces.is_empty() {
            return Err(MeshReadError::new(Place::File, "", Fault::NoFaces));
        }
        let places = self.places;
        let mesh = Mesh::new(self.vertices, self.faces).map_err(|error| match error {
            MeshError::OutOfRange {
                face,
                vertex,
                vertices,
                ..
            } => {
                let found = (vertex + format.first_index()).to_string();
                MeshReadError::new(places[face], &found, Fault::NoSuchVertex { vertices })
            }
            // Readers check these as they go.
            MeshError::NotFinite { .. } | MeshError::RepeatedCorner { .. } => {
                MeshReadError::new(Place::File, &error.to_string(), Fault::NotANumber)
            }
        })?;
        let how = HowRead {
            format,
            collapsed: self.collapsed,
        };
        Ok(MeshReading { mesh, how })
    }
}
