//! What the results of all methods have in common.

use super::curvature_net::CurvatureNetResult;
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
