//! The forms in which results can be had.

/// A form of a result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// The result itself.
    Json,
    /// A mesh.
    Obj,
    /// A table.
    Csv,
    /// A drawing.
    Svg,
    /// Surfaces and curves for CAD, sewn: ISO 10303-21, AP 214.
    Step,
    /// Surfaces and curves for older CAD: IGES 5.3.
    Igs,
    /// Flat patterns for the cutting table: DXF R2000.
    Dxf,
}

impl Format {
    /// All forms.
    pub const ALL: [Format; 7] = [
        Format::Json,
        Format::Obj,
        Format::Csv,
        Format::Svg,
        Format::Step,
        Format::Igs,
        Format::Dxf,
    ];

    /// The file name's ending.
    #[must_use]
    pub fn extension(self) -> &'static str {
        match self {
            Format::Json => "json",
            Format::Obj => "obj",
            Format::Csv => "csv",
            Format::Svg => "svg",
            Format::Step => "step",
            Format::Igs => "igs",
            Format::Dxf => "dxf",
        }
    }

    /// The media type.
    #[must_use]
    pub fn content_type(self) -> &'static str {
        match self {
            Format::Json => "application/json",
            Format::Obj => "model/obj",
            Format::Csv => "text/csv; charset=utf-8",
            Format::Svg => "image/svg+xml",
            Format::Step => "model/step",
            Format::Igs => "model/iges",
            Format::Dxf => "image/vnd.dxf",
        }
    }

    /// The media type without parameters.
    #[must_use]
    pub fn essence(self) -> &'static str {
        self.content_type().split(';').next().unwrap_or_default()
    }
}
