//! The answer of `…/diagnostics`.

use super::cone_spline::ConeSplineDiagnostics;
use super::curvature_net::CurvatureNetDiagnostics;
use super::fairing::FairingDiagnostics;
use super::hull_plates::HullPlatesDiagnostics;
use super::job::{JobError, StatusWord, VerdictWord};
use crate::jobs;
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;
use utoipa::ToSchema;
use uuid::Uuid;

/// The figures of a fit, by its method.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[serde(untagged)]
#[allow(clippy::large_enum_variant)] // A schema, never a value.
pub enum Figures {
    /// Of `hull_plates`.
    HullPlates(HullPlatesDiagnostics),
    /// Of `fairing`.
    Fairing(FairingDiagnostics),
    /// Of `curvature_net`.
    CurvatureNet(CurvatureNetDiagnostics),
    /// Of `cone_spline`.
    ConeSpline(ConeSplineDiagnostics),
}

/// What is known about how a job went, failed jobs included.
#[derive(Debug, Clone, Serialize, Deserialize, ToSchema)]
pub struct DiagnosticsAnswer {
    /// The job.
    pub job: Uuid,
    /// Where it stands.
    pub status: StatusWord,
    /// What it is, or was, at.
    pub phase: String,
    /// Percent.
    #[schema(minimum = 0, maximum = 100)]
    pub progress: f64,
    /// How often a worker has taken it up.
    pub attempt: u32,
    /// Milliseconds of fitting; only once ended.
    pub solve_ms: Option<f64>,
    /// Only for successful jobs.
    pub verdict: Option<VerdictWord>,
    /// What you should know though it stopped nothing.
    pub warnings: Vec<String>,
    /// Only for failed jobs.
    pub error: Option<JobError>,
    /// The figures; null while the job runs and for jobs that left none.
    #[schema(value_type = Option<Figures>)]
    pub figures: Option<Box<RawValue>>,
}

impl DiagnosticsAnswer {
    /// What is known about a job, with the figures it left.
    #[must_use]
    pub fn new(job: &jobs::Job, figures: Option<Box<RawValue>>) -> Self {
        DiagnosticsAnswer {
            job: job.id.as_uuid(),
            status: job.status.into(),
            phase: job.phase.clone(),
            progress: job.progress,
            attempt: job.attempt,
            solve_ms: job.solve_ms,
            verdict: job.verdict.map(Into::into),
            warnings: job.warnings.clone(),
            error: job.failure.as_ref().map(Into::into),
            figures,
        }
    }
}
