//! The forms in which results can be had.

use crate::formats::dxf::Version;
use crate::http::dto::job::Units;

/// A form of a result.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Format {
    /// The result itself.
    Json,
    /// A mesh as text.
    Obj,
    /// A mesh, triangles alone.
    Stl,
    /// A mesh with colours and the number that they stand for.
    Ply,
    /// A scene: a mesh with named parts, colours, numbers and lines.
    Glb,
    /// A table.
    Csv,
    /// A drawing.
    Svg,
    /// Surfaces and curves for CAD, sewn: ISO 10303-21, AP 214.
    Step,
    /// Surfaces and curves for older CAD: IGES 5.3.
    Igs,
    /// Flat patterns for the cutting table: DXF R2000, or R12.
    Dxf,
    /// All the others with the job.
    Zip,
}

impl Format {
    /// All forms.
    pub const ALL: [Format; 11] = [
        Format::Json,
        Format::Obj,
        Format::Stl,
        Format::Ply,
        Format::Glb,
        Format::Csv,
        Format::Svg,
        Format::Step,
        Format::Igs,
        Format::Dxf,
        Format::Zip,
    ];

    /// The file name's ending.
    #[must_use]
    pub fn extension(self) -> &'static str {
        match self {
            Format::Json => "json",
            Format::Obj => "obj",
            Format::Stl => "stl",
            Format::Ply => "ply",
            Format::Glb => "glb",
            Format::Csv => "csv",
            Format::Svg => "svg",
            Format::Step => "step",
            Format::Igs => "igs",
            Format::Dxf => "dxf",
            Format::Zip => "zip",
        }
    }

    /// The media type.
    #[must_use]
    pub fn content_type(self) -> &'static str {
        match self {
            Format::Json => "application/json",
            Format::Obj => "model/obj",
            Format::Stl => "model/stl",
            Format::Ply => "application/x-ply",
            Format::Glb => "model/gltf-binary",
            Format::Csv => "text/csv; charset=utf-8",
            Format::Svg => "image/svg+xml",
            Format::Step => "model/step",
            Format::Igs => "model/iges",
            Format::Dxf => "image/vnd.dxf",
            Format::Zip => "application/zip",
        }
    }

    /// The media type without parameters.
    #[must_use]
    pub fn essence(self) -> &'static str {
        self.content_type().split(';').next().unwrap_or_default()
    }

    /// What it is good for, in a few words.
    #[must_use]
    pub fn purpose(self) -> &'static str {
        match self {
            Format::Json => "the whole result",
            Format::Obj => "mesh, watertight along shared borders",
            Format::Stl => "mesh, triangles alone",
            Format::Ply => "mesh with colours and values",
            Format::Glb => "coloured mesh with named parts, values and lines",
            Format::Csv => "table",
            Format::Svg => "drawing",
            Format::Step => "surfaces and curves for CAD",
            Format::Igs => "surfaces and curves for older CAD",
            Format::Dxf => "flat patterns for the cutting table",
            Format::Zip => "all files with the job",
        }
    }

    /// Whether it can be told in another unit.
    #[must_use]
    pub fn takes_units(self) -> bool {
        !matches!(self, Format::Json | Format::Zip)
    }

    /// Whether it is a triangle mesh.
    #[must_use]
    pub fn is_mesh(self) -> bool {
        matches!(self, Format::Obj | Format::Stl | Format::Ply | Format::Glb)
    }
}

/// What is asked of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Form {
    /// Its format.
    pub format: Format,
    /// The unit of its lengths; without it the job's.
    pub units: Option<Units>,
    /// The version of a DXF file; others have none.
    pub version: Version,
}

impl From<Format> for Form {
    /// As it is when nothing else is said.
    fn from(format: Format) -> Self {
        Form {
            format,
            units: None,
            version: Version::R2000,
        }
    }
}
