//! What can be asked of a file: the unit of its lengths, the version of its
//! format.

use super::dto::job::Units;
use super::extract::{Given, Nothing, Parameters};
use super::methods::{Form, Format};
use super::problem::{ApiError, Code, FieldError};
use crate::formats::dxf::Version;
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};

/// A query that says how a file is to be written.
pub(super) trait FileQuery {
    /// The file in a format.
    ///
    /// # Errors
    /// `invalid-query` for what the format does not know.
    fn form(&self, format: Format) -> Result<Form, ApiError>;
}

/// A version of DXF.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub(super) enum DxfVersion {
    /// AC1015.
    R2000,
    /// AC1009, for old controllers.
    R12,
}

/// Query of files with lengths.
#[derive(Debug, Clone, Copy, IntoParams)]
#[into_params(parameter_in = Query)]
pub(super) struct UnitsQuery {
    /// The unit of all lengths in the file; without it the job's. Sentences
    /// keep the unit that they name.
    #[param(inline, nullable = false)]
    units: Option<Units>,
}

/// Query of files that may be drawings for the cutting table.
#[derive(Debug, Clone, Copy, IntoParams)]
#[into_params(parameter_in = Query)]
pub(super) struct CuttingQuery {
    /// The unit of all lengths in the file; without it the job's. Sentences
    /// keep the unit that they name.
    #[param(inline, nullable = false)]
    units: Option<Units>,
    /// The version of a DXF file; without it `r2000`.
    #[param(inline, nullable = false)]
    version: Option<DxfVersion>,
}

const UNITS: [(&str, Units); 5] = [
    ("mm", Units::Mm),
    ("cm", Units::Cm),
    ("m", Units::M),
    ("in", Units::In),
    ("ft", Units::Ft),
];

impl Parameters for UnitsQuery {
    const KNOWN: &'static [&'static str] = &["units"];

    fn read(given: &mut Given) -> Self {
        UnitsQuery {
            units: given.word("units", &UNITS),
        }
    }
}

impl Parameters for CuttingQuery {
    const KNOWN: &'static [&'static str] = &["units", "version"];

    fn read(given: &mut Given) -> Self {
        let versions = [("r2000", DxfVersion::R2000), ("r12", DxfVersion::R12)];
        CuttingQuery {
            units: given.word("units", &UNITS),
            version: given.word("version", &versions),
        }
    }
}

impl FileQuery for Nothing {
    fn form(&self, format: Format) -> Result<Form, ApiError> {
        Ok(format.into())
    }
}

impl FileQuery for UnitsQuery {
    fn form(&self, format: Format) -> Result<Form, ApiError> {
        Ok(Form {
            units: self.units,
            ..format.into()
        })
    }
}

impl FileQuery for CuttingQuery {
    fn form(&self, format: Format) -> Result<Form, ApiError> {
        let mut faults = Vec::new();
        let mut strange = |name: &str, why: &str| {
            let message = format!("{why}, and this is {}", format.extension());
            faults.push(FieldError::new(
                format!("?{name}"),
                "unknown-parameter",
                message,
            ));
        };
        if self.units.is_some() && !format.takes_units() {
            strange("units", "only files with lengths have \"units\"");
        }
        if self.version.is_some() && format != Format::Dxf {
            strange("version", "only dxf has a \"version\"");
        }
        if !faults.is_empty() {
            return Err(ApiError::at(Code::InvalidQuery, faults));
        }
        Ok(Form {
            format,
            units: self.units,
            version: match self.version {
                Some(DxfVersion::R12) => Version::R12,
                Some(DxfVersion::R2000) | None => Version::R2000,
            },
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_version_is_for_dxf_alone() {
        let query = CuttingQuery {
            units: Some(Units::In),
            version: Some(DxfVersion::R12),
        };
        let form = query.form(Format::Dxf).unwrap();
        assert_eq!((form.units, form.version), (Some(Units::In), Version::R12));
        let refused = query.form(Format::Glb).unwrap_err();
        assert_eq!(refused.code, Code::InvalidQuery);
        assert_eq!(refused.errors[0].pointer, "?version");
        assert_eq!(query.form(Format::Zip).unwrap_err().errors.len(), 2);
    }
}
