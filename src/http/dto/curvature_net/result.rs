//! The result of `curvature_net` on the wire. It holds no id and no time, so
//! that the same job gives the same bytes.

use super::super::curves::{Surface, finite};
use super::super::job::{CurvatureNetJob, CurvatureNetMethod};
use super::super::result::{Contents, result_of_a_method};
use super::specific::{CurvatureNetSpecific, VertexResult, vector};
use super::{CurvatureNetDiagnostics, DirectionWord};
use crate::geometry::CyclidePatch;
use crate::methods::curvature_net::outcome::Outcome;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

result_of_a_method!(
    CurvatureNetResult,
    CurvatureNetJob,
    CurvatureNetMethod,
    CurvatureNetSpecific,
    CurvatureNetDiagnostics,
    about = "The result of a `curvature_net` job. Lengths in `units`.",
    verdict = "Whether everything is as asked.",
    summary = "Sentences, the verdict first.",
    surfaces = "The smooth surface (role `smooth`, bicubic), the patches of the cyclide\nspline (role `cyclide`, rational, degree `[2, 2]`, row after row) and those\nof the offsets (role `offset`); control points indexed `[u][v]`.",
    curves = "None: the borders of the patches are the curves.",
    diagnostics = "All figures.",
);

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
        let contents = Contents {
            within_limits: outcome.within_limits,
            summary: outcome.summary.clone(),
            warnings: outcome.warnings.clone(),
            surfaces: surfaces(outcome),
            curves: Vec::new(),
            method_specific: specific(job, outcome),
            diagnostics: outcome.into(),
        };
        Self::of(job, input_sha256, contents)
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
