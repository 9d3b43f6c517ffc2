//! What the results of all methods have in common.

use super::cone_spline::ConeSplineResult;
use super::curvature_net::CurvatureNetResult;
use super::curves::{NamedCurve, Surface};
use super::fairing::FairingResult;
use super::hull_plates::HullPlatesResult;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// The result of a job: one shape for each method.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[serde(untagged)]
#[allow(clippy::large_enum_variant)] // A schema, never a value.
pub enum ResultDocument {
    /// Of `hull_plates`.
    HullPlates(HullPlatesResult),
    /// Of `fairing`.
    Fairing(FairingResult),
    /// Of `curvature_net`.
    CurvatureNet(CurvatureNetResult),
    /// Of `cone_spline`.
    ConeSpline(ConeSplineResult),
}

/// What every result says in words, read back from any of them.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Sentences {
    /// The fitting method.
    pub method: String,
    /// What the user should know about the input.
    pub warnings: Vec<String>,
    /// The verdict, then what it rests on.
    pub summary: Vec<String>,
}

/// What a method puts into the envelope that all results have.
#[derive(Debug, Clone, PartialEq)]
pub struct Contents<S, D> {
    /// Whether every limit is kept.
    pub within_limits: bool,
    /// The verdict, then what it rests on.
    pub summary: Vec<String>,
    /// What the user should know about the input.
    pub warnings: Vec<String>,
    /// The surfaces.
    pub surfaces: Vec<Surface>,
    /// The curves.
    pub curves: Vec<NamedCurve>,
    /// What only this method gives.
    pub method_specific: S,
    /// All figures.
    pub diagnostics: D,
}

/// A result as those see it who do not care which method made it.
pub trait Envelope: Serialize {
    /// The figures alone.
    type Figures: Serialize;
    /// The figures.
    fn figures(&self) -> &Self::Figures;
    /// Whether every limit is kept.
    fn is_within_limits(&self) -> bool;
    /// The verdict, then what it rests on.
    fn summary(&self) -> &[String];
    /// What the user should know about the input.
    fn warnings(&self) -> &[String];
}

/// The result type of a method: the envelope, the same for all, around what
/// only this method gives. It holds no id and no time, so that the same job
/// gives the same bytes.
macro_rules! result_of_a_method {
    (
        $result:ident, $job:ty, $method:ty, $specific:ty, $figures:ty,
        about = $about:literal,
        verdict = $verdict:literal,
        summary = $summary:literal,
        surfaces = $surfaces:literal,
        curves = $curves:literal,
        diagnostics = $diagnostics:literal $(,)?
    ) => {
        #[doc = $about]
        #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
        pub struct $result {
            /// The fitting method.
            pub method: $method,
            /// The job's label.
            pub label: Option<String>,
            /// The unit of all lengths here.
            pub units: $crate::http::dto::job::Units,
            /// The version that made it.
            pub engine_version: String,
            /// SHA-256 of the job it was made from.
            pub input_sha256: String,
            #[doc = $verdict]
            pub verdict: $crate::http::dto::job::VerdictWord,
            #[doc = $summary]
            pub summary: Vec<String>,
            /// What you should know about the input.
            pub warnings: Vec<String>,
            #[doc = $surfaces]
            pub surfaces: Vec<$crate::http::dto::curves::Surface>,
            #[doc = $curves]
            pub curves: Vec<$crate::http::dto::curves::NamedCurve>,
            /// What only this method gives.
            pub method_specific: $specific,
            #[doc = $diagnostics]
            pub diagnostics: $figures,
        }

        impl $result {
            /// The contents in their envelope.
            fn of(
                job: &$job,
                input_sha256: String,
                contents: $crate::http::dto::result::Contents<$specific, $figures>,
            ) -> Self {
                use $crate::http::dto::job::VerdictWord;
                $result {
                    method: job.method,
                    label: job.label.clone(),
                    units: job.units,
                    engine_version: $crate::http::ENGINE_VERSION.to_owned(),
                    input_sha256,
                    verdict: if contents.within_limits {
                        VerdictWord::WithinLimits
                    } else {
                        VerdictWord::OutsideLimits
                    },
                    summary: contents.summary,
                    warnings: contents.warnings,
                    surfaces: contents.surfaces,
                    curves: contents.curves,
                    method_specific: contents.method_specific,
                    diagnostics: contents.diagnostics,
                }
            }
        }

        impl $crate::http::dto::result::Envelope for $result {
            type Figures = $figures;

            fn figures(&self) -> &Self::Figures {
                &self.diagnostics
            }

            fn is_within_limits(&self) -> bool {
                self.verdict == $crate::http::dto::job::VerdictWord::WithinLimits
            }

            fn summary(&self) -> &[String] {
                &self.summary
            }

            fn warnings(&self) -> &[String] {
                &self.warnings
            }
        }
    };
}
pub(super) use result_of_a_method;
