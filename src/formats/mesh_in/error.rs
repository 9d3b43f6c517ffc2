//! What can be wrong with a mesh file, where, and what to do about it.

use crate::formats::excerpt::shortened;
use std::fmt;

/// A place in a mesh file that could not be read.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{}", self.sentence())]
pub struct MeshReadError {
    /// Where.
    pub place: Place,
    /// What stands there, shortened; empty where nothing does.
    pub found: String,
    /// What is wrong with it.
    pub fault: Fault,
}

/// Where in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// The file as such.
    File,
    /// A line, counted from 1.
    Line(usize),
    /// A vertex of a binary file, counted from 0.
    Vertex(usize),
    /// A face of a binary file, counted from 0.
    Face(usize),
    /// An offset in bytes, counted from 0.
    Byte(usize),
}

/// What is wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fault {
    /// Neither OBJ nor STL nor PLY.
    UnknownFormat,
    /// A file without faces.
    NoFaces,
    /// Text where a number should be, or one that is not finite.
    NotANumber,
    /// A vertex with fewer than three coordinates.
    TooFewCoordinates,
    /// An index that is no whole number, or 0 in a format that counts from 1.
    NotAnIndex,
    /// An index of a vertex that is not there.
    NoSuchVertex {
        /// How many vertices there are.
        vertices: usize,
    },
    /// A face with fewer than three or more than four corners.
    Corners,
    /// The file ends in the middle.
    EndsEarly,
    /// A header promises more than the file holds.
    Promises,
    /// A word that the format does not know in this place.
    UnexpectedWord,
    /// A facet that has not exactly three corners.
    FacetCorners,
    /// A PLY header that lacks what is needed.
    Header(&'static str),
    /// Numbers left over in a line.
    LeftOver,
}

impl MeshReadError {
    /// An error at a place.
    pub(super) fn new(place: Place, found: &str, fault: Fault) -> Self {
        MeshReadError {
            place,
            found: shortened(found),
            fault,
        }
    }

    /// Where, what and the text found, as a sentence.
    #[must_use]
    pub fn sentence(&self) -> String {
        let place = match self.place {
            Place::File => "The file".to_owned(),
            Place::Line(n) => format!("Line {n}"),
            Place::Vertex(n) => format!("Vertex {n}"),
            Place::Face(n) => format!("Face {n}"),
            Place::Byte(n) => format!("Byte {n}"),
        };
        if self.found.is_empty() {
            format!("{place}: {}.", self.fault)
        } else {
            format!("{place}: {}: “{}”.", self.fault, self.found)
        }
    }

    /// The place in a few words, for programmes: `file, line 7`.
    #[must_use]
    pub fn pointer(&self) -> String {
        match self.place {
            Place::File => "file".to_owned(),
            Place::Line(n) => format!("file, line {n}"),
            Place::Vertex(n) => format!("file, vertex {n}"),
            Place::Face(n) => format!("file, face {n}"),
            Place::Byte(n) => format!("file, byte {n}"),
        }
    }

    /// What to do about it, as a sentence.
    #[must_use]
    pub fn hint(&self) -> &'static str {
        match self.fault {
            Fault::UnknownFormat => "Send the mesh as OBJ, STL or PLY, not packed.",
            Fault::NoFaces => {
                "Export the surface as a mesh; points, lines and free-form surfaces have no faces."
            }
            Fault::NotANumber | Fault::LeftOver => "Write plain finite numbers: -1.5, 2e-3.",
            Fault::TooFewCoordinates => "A vertex has three coordinates.",
            Fault::NotAnIndex => {
                "OBJ counts vertices from 1, or back from the last with -1; PLY counts from 0."
            }
            Fault::NoSuchVertex { .. } => "Was part of the file lost, or is the mesh cut in two?",
            Fault::Corners => "Export triangles or quads; larger polygons can be cut in many ways.",
            Fault::EndsEarly | Fault::Promises => "The file seems cut short; send it again.",
            Fault::UnexpectedWord => "Export the file again; it does not follow its format.",
            Fault::FacetCorners => "A facet of an STL file has three vertices.",
            Fault::Header(_) => {
                "A PLY mesh has an element vertex with x, y, z and an element face with the list \
                 vertex_indices."
            }
        }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let words = match self {
            Fault::UnknownFormat => "neither OBJ nor STL nor PLY is recognised in it",
            Fault::NoFaces => "it holds no faces",
            Fault::NotANumber => "this is not a finite number",
            Fault::TooFewCoordinates => "three coordinates are needed",
            Fault::NotAnIndex => "this is not the number of a vertex",
            Fault::NoSuchVertex { vertices } => {
                return write!(f, "there are {vertices} vertices, but not this one");
            }
            Fault::Corners => "a face has three or four corners",
            Fault::EndsEarly => "the file ends here, in the middle",
            Fault::Promises => "the header promises more than the file holds",
            Fault::UnexpectedWord => "this word is not expected here",
            Fault::FacetCorners => "the facet has not three corners",
            Fault::Header(what) => what,
            Fault::LeftOver => "there is more in this line than the header announces",
        };
        f.write_str(words)
    }
}
