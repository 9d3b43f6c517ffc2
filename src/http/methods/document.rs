//! A stored result as what its files are written from: each method draws, the
//! files of all are written here.

use super::{Form, Format};
use crate::formats::brep::SheetModel;
use crate::formats::length_unit::LengthUnit;
use crate::formats::measured::in_unit;
use crate::formats::mesh_out::MeshDrawing;
use crate::formats::patterns::{self, PatternSheet};
use crate::formats::{glb, iges, obj, ply, step, stl};
use crate::http::problem::{ApiError, Code};

/// A result that was read back.
///
/// What is drawn has the job's unit unless a unit is handed in.
pub trait Document {
    /// The unit of its lengths.
    fn units(&self) -> LengthUnit;
    /// The forms that it has, of those that its method may give.
    fn formats(&self) -> Vec<Format>;
    /// Its surfaces as a mesh.
    ///
    /// # Errors
    /// A stored result that is broken; a fault of ours.
    fn mesh(&self) -> Result<MeshDrawing, ApiError>;
    /// Its surfaces and curves for CAD.
    ///
    /// # Errors
    /// As of the mesh.
    fn model(&self) -> Result<SheetModel, ApiError>;
    /// Its table.
    ///
    /// # Errors
    /// As of the mesh.
    fn table(&self, unit: LengthUnit) -> Result<String, ApiError>;
    /// Its drawing.
    ///
    /// # Errors
    /// As of the mesh.
    fn picture(&self, unit: LengthUnit) -> Result<String, ApiError>;
    /// Its flat patterns; `None` where the method has none.
    fn patterns(&self, _unit: LengthUnit) -> Option<PatternSheet> {
        None
    }
    /// What a part of its mesh is: `plate`, `patch`.
    fn part_word(&self) -> &'static str;
    /// How many parts have a table of their own: those of the mesh, in order.
    fn part_tables(&self) -> usize {
        0
    }
    /// The table of one part.
    ///
    /// # Errors
    /// As of the mesh.
    fn part_table(&self, _part: usize, _unit: LengthUnit) -> Result<Option<String>, ApiError> {
        Ok(None)
    }
}

/// A file that belongs to one part of a result.
#[derive(Debug, Clone, PartialEq)]
pub struct PartFile {
    /// Its name in the path.
    pub name: String,
    /// The part, as the result names it.
    pub part: String,
    /// Its format.
    pub format: Format,
    of: Of,
}

/// What a file of a part shows.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Of {
    Mesh(usize),
    Table(usize),
    Pattern(usize),
}

/// The result in one of its forms.
///
/// # Errors
/// `format-not-available`, naming those that are.
pub fn write(document: &dyn Document, form: Form) -> Result<Vec<u8>, ApiError> {
    let formats = document.formats();
    if !formats.contains(&form.format) {
        return Err(not_available(form.format.extension(), &formats));
    }
    let own = document.units();
    let unit = form.units.map_or(own, Into::into);
    let mesh = || Ok::<_, ApiError>(in_unit(document.mesh()?, own, unit));
    let model = || Ok::<_, ApiError>(in_unit(document.model()?, own, unit));
    Ok(match form.format {
        Format::Obj | Format::Stl | Format::Ply | Format::Glb => mesh_file(&mesh()?, form.format),
        Format::Csv => document.table(unit)?.into_bytes(),
        Format::Svg => document.picture(unit)?.into_bytes(),
        Format::Step => step::write(&model()?).into_bytes(),
        Format::Igs => iges::write(&model()?).into_bytes(),
        Format::Dxf => {
            let sheet = document.patterns(unit);
            let sheet = sheet.ok_or_else(|| ApiError::internal(&"no patterns to be cut"))?;
            patterns::cutting_drawing(&sheet, form.version).into_bytes()
        }
        Format::Json | Format::Zip => {
            return Err(ApiError::internal(&"not written from drawings"));
        }
    })
}

fn mesh_file(mesh: &MeshDrawing, format: Format) -> Vec<u8> {
    match format {
        Format::Stl => stl::write(mesh),
        Format::Ply => ply::write(mesh),
        Format::Glb => glb::write(mesh),
        _ => obj::write(mesh).into_bytes(),
    }
}

/// The refusal of a form, naming those that there are.
#[must_use]
pub fn not_available(extension: &str, formats: &[Format]) -> ApiError {
    let known: Vec<&str> = formats.iter().map(|f| f.extension()).collect();
    let detail = format!(
        "there is no result.{extension}; there are {}",
        known.join(", ")
    );
    ApiError::new(Code::FormatNotAvailable, detail)
}

/// The files of the parts: for each part of the mesh a scene and a table, for
/// each flat pattern a drawing to cut and one to look at.
///
/// # Errors
/// As of the mesh.
pub fn part_files(document: &dyn Document) -> Result<Vec<PartFile>, ApiError> {
    let mut files = Vec::new();
    let mut add = |stem: &str, number: usize, part: &str, format: Format, of: Of| {
        files.push(PartFile {
            name: format!("{stem}-{}.{}", number + 1, format.extension()),
            part: part.to_owned(),
            format,
            of,
        });
    };
    let word = document.part_word();
    if document.formats().contains(&Format::Glb) {
        let mesh = document.mesh()?;
        // One part alone is the whole.
        let parts = if mesh.parts.len() > 1 {
            &mesh.parts[..]
        } else {
            &[]
        };
        for (i, part) in parts.iter().enumerate() {
            add(word, i, &part.name, Format::Glb, Of::Mesh(i));
            if i < document.part_tables() {
                add(word, i, &part.name, Format::Csv, Of::Table(i));
            }
        }
    }
    let sheet = document.patterns(document.units());
    for (i, pattern) in sheet.iter().flat_map(|s| &s.patterns).enumerate() {
        for format in [Format::Dxf, Format::Svg] {
            add("pattern", i, &pattern.name, format, Of::Pattern(i));
        }
    }
    Ok(files)
}

/// A file of a part.
///
/// # Errors
/// As of the mesh.
pub fn write_part(
    document: &dyn Document,
    file: &PartFile,
    form: Form,
) -> Result<Vec<u8>, ApiError> {
    let own = document.units();
    let unit = form.units.map_or(own, Into::into);
    let lost = || ApiError::internal(&"a part that was listed is not there");
    match file.of {
        Of::Mesh(part) => {
            let mesh = document.mesh()?.only(part).ok_or_else(lost)?;
            Ok(mesh_file(&in_unit(mesh, own, unit), form.format))
        }
        Of::Table(part) => {
            let table = document.part_table(part, unit)?;
            Ok(table.ok_or_else(lost)?.into_bytes())
        }
        Of::Pattern(pattern) => {
            let mut sheet = document.patterns(unit).ok_or_else(lost)?;
            if pattern >= sheet.patterns.len() {
                return Err(lost());
            }
            sheet.patterns = vec![sheet.patterns.swap_remove(pattern)];
            Ok(match form.format {
                Format::Dxf => patterns::cutting_drawing(&sheet, form.version),
                _ => patterns::page(&sheet),
            }
            .into_bytes())
        }
    }
}
