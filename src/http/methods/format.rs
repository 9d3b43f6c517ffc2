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
}

impl Format {
    /// All forms.
    pub const ALL: [Format; 4] = [Format::Json, Format::Obj, Format::Csv, Format::Svg];

    /// The file name's ending.
    #[must_use]
    pub fn extension(self) -> &'static str {
        match self {
            Format::Json => "json",
            Format::Obj => "obj",
            Format::Csv => "csv",
            Format::Svg => "svg",
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
        }
    }

    /// The media type without parameters.
    #[must_use]
    pub fn essence(self) -> &'static str {
        self.content_type().split(';').next().unwrap_or_default()
    }
}
