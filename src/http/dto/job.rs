//! A job on the wire: the request as it is posted, the answer as it is told.

use super::cone_spline::{ConeSplineInput, ConeSplineOptions};
use super::curvature_net::{CurvatureNetInput, CurvatureNetOptions};
use super::fairing::{FairingInput, FairingOptions};
use super::hull_plates::{HullPlatesInput, HullPlatesOptions};
use crate::http::problem::FieldError;
use crate::jobs;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt;
use std::time::Duration;
use utoipa::ToSchema;
use uuid::Uuid;

/// How long a fit may run when the job does not say: far above what a hull
/// takes, far below what would block a worker for others.
pub const DEFAULT_BUDGET_S: f64 = 60.0;

/// A job as it is posted: one shape for each method.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[serde(untagged)]
#[allow(clippy::large_enum_variant)] // A schema, never a value.
pub enum JobRequest {
    /// Developable plates between a hull's profile curves.
    HullPlates(HullPlatesJob),
    /// The fairest curve or surface within a tolerance of measured points.
    Fairing(FairingJob),
    /// A surface whose patch borders are lines of curvature.
    CurvatureNet(CurvatureNetJob),
    /// A strip as few cones, cylinders and planes.
    ConeSpline(ConeSplineJob),
}

macro_rules! job_of_a_method {
    ($job:ident, $method:ident, $word:literal, $variant:ident, $input:ty, $options:ty, $doc:literal) => {
        #[doc = $doc]
        #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
        #[serde(deny_unknown_fields)]
        pub struct $job {
            /// The fitting method.
            pub method: $method,
            /// Your own name for the job; it becomes the name of result files.
            #[serde(default, skip_serializing_if = "Option::is_none")]
            #[schema(min_length = 1, max_length = 200, examples("UBC trawler"))]
            pub label: Option<String>,
            /// The unit of all lengths in the job and in its result, unless a
            /// name says otherwise (`_m`, `_deg`, `_percent`). There is no
            /// default.
            pub units: Units,
            /// What the method takes.
            pub input: $input,
            /// What is asked of it; everything has a default.
            #[serde(default)]
            pub options: $options,
            /// What it may use.
            #[serde(default)]
            pub budget: Budget,
        }

        #[doc = concat!("The word `", $word, "`.")]
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
        #[serde(rename_all = "snake_case")]
        pub enum $method {
            #[doc = $doc]
            $variant,
        }
    };
}

job_of_a_method!(
    HullPlatesJob,
    HullPlatesMethod,
    "hull_plates",
    HullPlates,
    HullPlatesInput,
    HullPlatesOptions,
    "A job for developable plates between a hull's profile curves."
);
job_of_a_method!(
    FairingJob,
    FairingMethod,
    "fairing",
    Fairing,
    FairingInput,
    FairingOptions,
    "A job for the fairest curve or surface within a tolerance of measured points."
);
job_of_a_method!(
    CurvatureNetJob,
    CurvatureNetMethod,
    "curvature_net",
    CurvatureNet,
    CurvatureNetInput,
    CurvatureNetOptions,
    "A job for a surface whose patch borders are lines of curvature."
);

job_of_a_method!(
    ConeSplineJob,
    ConeSplineMethod,
    "cone_spline",
    ConeSpline,
    ConeSplineInput,
    ConeSplineOptions,
    "A job for a strip as few cones, cylinders and planes."
);

/// What a job may use.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields, default)]
#[schema(default)]
pub struct Budget {
    /// Seconds of fitting; then the job fails with `budget-exceeded`.
    #[schema(minimum = 0.01, maximum = 3600)]
    pub time_s: f64,
}

impl Default for Budget {
    fn default() -> Self {
        Budget {
            time_s: DEFAULT_BUDGET_S,
        }
    }
}

impl Budget {
    /// The time as a duration; the schema keeps it within bounds.
    #[must_use]
    pub fn time(&self) -> Duration {
        Duration::try_from_secs_f64(self.time_s).unwrap_or(Duration::from_secs(60))
    }
}

/// A unit of length.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum Units {
    /// Millimetres.
    Mm,
    /// Centimetres.
    Cm,
    /// Metres.
    M,
    /// Inches, 25.4 mm.
    In,
    /// Feet, 304.8 mm.
    Ft,
}

impl Units {
    /// Metres in one unit.
    #[must_use]
    pub fn metres(self) -> f64 {
        match self {
            Units::Mm => 1e-3,
            Units::Cm => 1e-2,
            Units::M => 1.0,
            Units::In => 0.0254,
            Units::Ft => 0.3048,
        }
    }
}

impl fmt::Display for Units {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Units::Mm => "mm",
            Units::Cm => "cm",
            Units::M => "m",
            Units::In => "in",
            Units::Ft => "ft",
        })
    }
}

/// Where a job stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum StatusWord {
    /// On disk, waiting for a worker.
    Accepted,
    /// A worker has it.
    Running,
    /// Ended with a result.
    Successful,
    /// Ended with nothing to show but an error.
    Failed,
    /// Cancelled.
    Dismissed,
}

impl From<jobs::Status> for StatusWord {
    fn from(status: jobs::Status) -> Self {
        match status {
            jobs::Status::Accepted => StatusWord::Accepted,
            jobs::Status::Running => StatusWord::Running,
            jobs::Status::Successful => StatusWord::Successful,
            jobs::Status::Failed => StatusWord::Failed,
            jobs::Status::Dismissed => StatusWord::Dismissed,
        }
    }
}

impl From<StatusWord> for jobs::Status {
    fn from(status: StatusWord) -> Self {
        match status {
            StatusWord::Accepted => jobs::Status::Accepted,
            StatusWord::Running => jobs::Status::Running,
            StatusWord::Successful => jobs::Status::Successful,
            StatusWord::Failed => jobs::Status::Failed,
            StatusWord::Dismissed => jobs::Status::Dismissed,
        }
    }
}

/// Whether a successful job reached what was asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum VerdictWord {
    /// Every limit is kept.
    WithinLimits,
    /// The best surfaces found break at least one limit.
    OutsideLimits,
}

impl fmt::Display for VerdictWord {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            VerdictWord::WithinLimits => "within_limits",
            VerdictWord::OutsideLimits => "outside_limits",
        })
    }
}

impl From<jobs::Verdict> for VerdictWord {
    fn from(verdict: jobs::Verdict) -> Self {
        match verdict {
            jobs::Verdict::WithinLimits => VerdictWord::WithinLimits,
            jobs::Verdict::OutsideLimits => VerdictWord::OutsideLimits,
        }
    }
}

/// A job as it stands. Times are RFC 3339, UTC.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Job {
    /// Its unguessable name.
    pub id: Uuid,
    /// The fitting method.
    pub method: String,
    /// Your own name for it.
    pub label: Option<String>,
    /// Where it stands.
    pub status: StatusWord,
    /// What it is at: `queued`, `starting`, a word of the method's own, `done`.
    pub phase: String,
    /// Percent, never falling.
    #[schema(minimum = 0, maximum = 100)]
    pub progress: f64,
    /// A sentence about where it stands.
    pub message: String,
    /// When it was accepted.
    #[schema(format = DateTime)]
    pub created: String,
    /// When the current or last attempt began.
    #[schema(format = DateTime)]
    pub started: Option<String>,
    /// When it ended.
    #[schema(format = DateTime)]
    pub finished: Option<String>,
    /// When anything here last changed.
    #[schema(format = DateTime)]
    pub updated: String,
    /// How often a worker has taken it up.
    pub attempt: u32,
    /// 1 is next; only while `accepted`.
    pub queue_position: Option<u64>,
    /// Seconds until the end, estimated from recent jobs.
    pub eta_s: Option<f64>,
    /// Milliseconds of fitting; only for ended jobs that ran.
    pub solve_ms: Option<f64>,
    /// Somebody asked to cancel it and it has not ended yet.
    pub cancel_requested: bool,
    /// The version that accepted it.
    pub engine_version: String,
    /// SHA-256 of the posted body.
    pub input_sha256: String,
    /// Only for successful jobs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub verdict: Option<VerdictWord>,
    /// What you should know though it stopped nothing.
    pub warnings: Vec<String>,
    /// Only for failed jobs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub error: Option<JobError>,
    /// Where to go from here.
    pub links: Links,
}

/// Why a job failed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct JobError {
    /// A stable word: `invalid-input`, `budget-exceeded`, `worker-panic`,
    /// `worker-crashed`, `numerical`.
    pub code: String,
    /// A sentence.
    pub detail: String,
    /// Quote this when asking for help.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub reference: Option<Uuid>,
    /// The places of the job that are wrong.
    pub errors: Vec<FieldError>,
}

/// Paths below the server's address.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct Links {
    /// The job.
    #[serde(rename = "self")]
    pub this: String,
    /// Its result.
    pub result: String,
    /// The list of its files.
    pub artifacts: String,
    /// Its diagnostics.
    pub diagnostics: String,
    /// The body as it was posted.
    pub input: String,
    /// Post here to cancel it.
    pub cancel: String,
    /// The page that shows it.
    pub view: String,
}

impl Links {
    fn of(id: &jobs::JobId) -> Self {
        let this = format!("/v1/jobs/{id}");
        Links {
            result: format!("{this}/result"),
            artifacts: format!("{this}/artifacts"),
            diagnostics: format!("{this}/diagnostics"),
            input: format!("{this}/input"),
            cancel: format!("{this}/cancel"),
            view: format!("/jobs/{id}/view"),
            this,
        }
    }
}

impl From<&jobs::Failure> for JobError {
    fn from(failure: &jobs::Failure) -> Self {
        let errors = failure.errors_json.as_deref().map(serde_json::from_str);
        JobError {
            code: failure.code.clone(),
            detail: failure.detail.clone(),
            reference: failure.reference,
            // Only `http::engine` writes this text, as this very type.
            errors: errors.and_then(Result::ok).unwrap_or_default(),
        }
    }
}

impl From<&jobs::Job> for Job {
    fn from(job: &jobs::Job) -> Self {
        Job {
            id: job.id.as_uuid(),
            method: job.method.clone(),
            label: job.label.clone(),
            status: job.status.into(),
            phase: job.phase.clone(),
            progress: job.progress,
            message: job.message.clone(),
            created: job.created.to_string(),
            started: job.started.map(|t| t.to_string()),
            finished: job.finished.map(|t| t.to_string()),
            updated: job.updated.to_string(),
            attempt: job.attempt,
            queue_position: job.queue_position,
            eta_s: job.eta_s,
            solve_ms: job.solve_ms,
            cancel_requested: job.cancel_requested,
            engine_version: job.engine_version.clone(),
            input_sha256: job.input_sha256.clone(),
            verdict: job.verdict.map(Into::into),
            warnings: job.warnings.clone(),
            error: job.failure.as_ref().map(Into::into),
            links: Links::of(&job.id),
        }
    }
}

/// One page of jobs, newest first.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct JobList {
    /// The jobs.
    pub items: Vec<Job>,
    /// Hand it in as `cursor` for the next page; null on the last.
    pub next_cursor: Option<String>,
}

/// What a check of a job says without queueing it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Validation {
    /// Always true: an invalid job is a problem document.
    pub valid: bool,
    /// What the fit would warn of.
    pub warnings: Vec<String>,
    /// The job as it was understood.
    pub normalized: Normalized,
}

/// The job as it was understood; catches slips of the unit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Normalized {
    /// Box around all given points, in metres: least and greatest x, y, z.
    pub bbox_m: BoundingBox,
    /// How much there is, by name: profiles, plates, points and so on.
    pub counts: BTreeMap<String, usize>,
}

/// A box in metres.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct BoundingBox {
    /// Least x, y, z.
    pub min: super::Point,
    /// Greatest x, y, z.
    pub max: super::Point,
}
