//! What can be wrong with a STEP file, where, and what to do about it.

use crate::formats::excerpt::shortened;
use crate::geometry::SplineError;
use std::fmt;

/// A place in a STEP file that could not be read.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("line {line}: {fault}{}", .found.as_ref().map_or(String::new(), |f| format!(": “{f}”")))]
pub struct StepReadError {
    /// The line, counted from 1.
    pub line: usize,
    /// What stands there, shortened.
    pub found: Option<String>,
    /// What is wrong with it.
    pub fault: StepFault,
}

/// What is wrong.
#[derive(Debug, Clone, PartialEq)]
pub enum StepFault {
    /// The file does not begin with `ISO-10303-21;`.
    NotStep,
    /// It ends in the middle.
    EndsEarly,
    /// A sign that the format does not know in this place.
    Unexpected,
    /// Lists within lists, too deep.
    TooDeep,
    /// An entity that is told twice.
    Twice(u64),
    /// A reference to an entity that is not there.
    Missing(u64),
    /// An entity that is not what stands in this place.
    Kind {
        /// Its number.
        entity: u64,
        /// What it should be.
        wanted: &'static str,
    },
    /// An entity without the parameter that is needed, or with another in its
    /// place.
    Parameter {
        /// Its number.
        entity: u64,
        /// What should stand there.
        wanted: &'static str,
    },
    /// No unit of length.
    NoUnit,
    /// Two units of length in one file.
    TwoUnits,
    /// Nothing that can be measured.
    NoSurfaces,
    /// A B-spline that breaks a rule.
    Spline(SplineError),
}

impl StepReadError {
    pub(super) fn new(line: usize, found: &str, fault: StepFault) -> Self {
        let found = (!found.is_empty()).then(|| shortened(found));
        StepReadError { line, found, fault }
    }

    /// The place in a few words, for programmes: `file, line 7`.
    #[must_use]
    pub fn pointer(&self) -> String {
        format!("file, line {}", self.line)
    }

    /// What to do about it, as a sentence.
    #[must_use]
    pub fn hint(&self) -> &'static str {
        match self.fault {
            StepFault::NotStep => "Send a STEP file as text (ISO 10303-21), not packed.",
            StepFault::EndsEarly => "The file seems cut short; send it again.",
            StepFault::NoUnit | StepFault::TwoUnits => {
                "Export the model with one unit of length for all parts."
            }
            StepFault::NoSurfaces => {
                "Export the surfaces as free-form faces (B_SPLINE_SURFACE); planes, cylinders and \
                 other elementary faces can be converted to NURBS in CAD."
            }
            StepFault::Spline(_) => "Knots must be clamped, poles finite, weights positive.",
            _ => "Export the file again; it does not follow ISO 10303.",
        }
    }
}

impl fmt::Display for StepFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            StepFault::NotStep => f.write_str("this is not the beginning of a STEP file"),
            StepFault::EndsEarly => f.write_str("the file ends here, in the middle"),
            StepFault::Unexpected => f.write_str("this is not expected here"),
            StepFault::TooDeep => f.write_str("lists within lists are too deep here"),
            StepFault::Twice(n) => write!(f, "#{n} is told a second time"),
            StepFault::Missing(n) => write!(f, "there is no #{n}"),
            StepFault::Kind { entity, wanted } => write!(f, "#{entity} is no {wanted}"),
            StepFault::Parameter { entity, wanted } => {
                write!(f, "#{entity} lacks {wanted} in its place")
            }
            StepFault::NoUnit => f.write_str("the file tells no unit of length"),
            StepFault::TwoUnits => f.write_str("the file tells a second unit of length"),
            StepFault::NoSurfaces => f.write_str("the file holds no B-spline surface"),
            StepFault::Spline(error) => error.fmt(f),
        }
    }
}
