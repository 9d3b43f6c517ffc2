//! The result of `curvature_net` on the wire. It holds no id and no time, so
//! that the same job gives the same bytes.

use super::super::curves::{Surface, finite};
use super::super::job::{CurvatureNetJob, CurvatureNetMethod, Units, VerdictWord};
use super::specific::{CurvatureNetSpecific, VertexResult, vector};
use super::{CurvatureNetDiagnostics, DirectionWord};
use crate::geometry::CyclidePatch;
use crate::methods::curvature_net::outcome::Outcome;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// The result of a `curvature_net` job. Lengths in `units`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CurvatureNetResult {
    /// The fitting method.
    pub method: CurvatureNetMethod,
    /// The job's label.
    pub label: Option<String>,
    /// The unit of all lengths here.
    pub units: Units,
    /// The version that made it.
    pub engine_version: String,
    /// SHA-256 of the job it was made from.
    pub input_sha256: String,
    /// Whether everything is as asked.
    pub verdict: VerdictWord,
    /// Sentences, the verdict first.
    pub summary: Vec<String>,
    /// What you should know about the input.
    pub warnings: Vec<String>,
    /// The smooth surface (role `smooth`, bicubic), the patches of the cyclide
    /// spline (role `cyclide`, rational, degree [2,2], row after row) and those
    /// of the offsets (role `offset`). Control points indexed `[u][v]`.
    pub surfaces: Vec<Surface>,
    /// What only this method gives.
    pub method_specific: CurvatureNetSpecific,
    /// All figures.
    pub diagnostics: CurvatureNetDiagnostics,
}

/// Roles of the surfaces.
pub(super) const SMOOTH: &str = "smooth";
/// Of the cyclide spline's patches.
pub(super) const CYCLIDE: &str = "cyclide";
/// Of the offsets' patches.
pub(super) const OFFSET: &str = "offset";

impl CurvatureNetResult {
    /// The document of an outcome.
    #[must_use]
    pub fn new(job: &CurvatureNetJob, input_sha256: String, outcome: &Outcome) -> Self {
        CurvatureNetResult {
            method: job.method,
            label: job.label.clone(),
            units: job.units,
            engine_version: env!("CARGO_PKG_VERSION").into(),
            input_sha256,
            verdict: if outcome.within_limits {
                VerdictWord::WithinLimits
            } else {
                VerdictWord::OutsideLimits
            },
            summary: outcome.summary.clone(),
            warnings: outcome.warnings.clone(),
            surfaces: surfaces(outcome),
            method_specific: specific(job, outcome),
            diagnostics: outcome.into(),
        }
    }
}

fn surfaces(outcome: &Outcome) -> Vec<Surface> {
    let mut surfaces = vec![Surface::new("smooth surface", SMOOTH, &outcome.surface)];
    let columns = outcome.net.layout().patch_counts()[1].max(1);
    let mut add = |patches: &[Option<CyclidePatch>], role: &str, prefix: &str| {
        for (index, patch) in patches.iter().enumerate() {
            let Some(Ok(surface)) = patch.as_ref().map(CyclidePatch::surface) else {
                continue;
            };
            let name = format!("{prefix}{},{}", index / columns, index % columns);
            surfaces.push(Surface::new(&name, role, &surface));
        }
    };
    if let Some(cyclides) = &outcome.cyclides {
        add(&cyclides.patches, CYCLIDE, "patch ");
        for offset in &cyclides.offsets {
            add(
                &offset.patches,
                OFFSET,
                &format!("offset {}, patch ", offset.distance),
            );
        }
    }
    surfaces
}

fn specific(job: &CurvatureNetJob, outcome: &Outcome) -> CurvatureNetSpecific {
    let net = &outcome.net;
    let mut options = job.options.clone();
    options.levels = Some(super::Index(outcome.smooth.levels));
    let closed = [DirectionWord::U, DirectionWord::V]
        .into_iter()
        .zip(net.closed);
    let built = outcome.cyclides.as_ref();
    CurvatureNetSpecific {
        options,
        rows: net.rows,
        columns: net.columns,
        closed: closed.filter(|(_, c)| *c).map(|(d, _)| d).collect(),
        vertices: vertices(outcome),
        certificates: built.map_or_else(Vec::new, |c| {
            let all = c.certificates.iter();
            all.map(|c| c.as_ref().map(Into::into)).collect()
        }),
        strips: built.map_or_else(Vec::new, |c| c.strips.iter().map(Into::into).collect()),
        supports: built.map_or_else(Vec::new, |c| c.supports.iter().map(Into::into).collect()),
        offsets: built.map_or_else(Vec::new, |c| c.offsets.iter().map(Into::into).collect()),
        members: built.map_or_else(Vec::new, |c| c.members.iter().map(Into::into).collect()),
    }
}

fn vertices(outcome: &Outcome) -> Vec<VertexResult> {
    let (net, smooth) = (&outcome.net, &outcome.smooth);
    let start = smooth.surface.net();
    let torsions = torsions(outcome);
    (0..net.points.len())
        .map(|k| VertexResult {
            point: net.points[k].into(),
            normal: vector(&net.normals[k]),
            tangents: net.tangents[k].map(|t| vector(&t)),
            curvatures: smooth.umbilics.curvatures[k].map(|x| finite(x).unwrap_or(0.0)),
            torsion: torsions[k],
            moved: (net.points[k] - start.points[k]).norm(),
            turned_deg: {
                let (now, before) = (&net.normals[k], &start.normals[k]);
                now.cross(before).norm().atan2(now.dot(before)).to_degrees()
            },
        })
        .collect()
}

/// The largest torsion of the borders that end at each vertex.
fn torsions(outcome: &Outcome) -> Vec<f64> {
    let layout = outcome.net.layout();
    let mut largest = vec![0.0f64; layout.vertex_count()];
    let edges = layout.edges(0).chain(layout.edges(1));
    for (ends, torsion) in edges.zip(&outcome.smooth.borders.torsions) {
        for end in ends {
            largest[end] = largest[end].max(*torsion);
        }
    }
    largest
}
