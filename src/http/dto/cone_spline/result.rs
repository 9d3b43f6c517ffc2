//! The result of `cone_spline` on the wire. It holds no id and no time, so
//! that the same job gives the same bytes.

use super::super::curves::{NamedCurve, Point, Surface};
use super::super::flat::FlatPoint;
use super::super::index::IndexPair;
use super::super::job::{ConeSplineJob, ConeSplineMethod};
use super::super::result::{Contents, result_of_a_method};
use super::patch::ConePatch;
use super::{ConeSplineDiagnostics, ConeSplineOptions};
use crate::geometry::BSplineCurve;
use crate::methods::cone_spline::outcome::{ErrorPoint, FlatPiece, Join, Outcome, Ruling, Trim};
use nalgebra::Point3;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

result_of_a_method!(
    ConeSplineResult,
    ConeSplineJob,
    ConeSplineMethod,
    ConeSplineSpecific,
    ConeSplineDiagnostics,
    about = "The result of a `cone_spline` job. Lengths in `units`.",
    verdict = "Whether every limit that was asked is kept.",
    summary = "The verdict, then what a loftsman should know.",
    surfaces = "The patches, exact: degree `[2, 1]`, rational, u along the arc, v along the\nrulings; `outline_uv` of its patch bounds the part that is meant. Control points\n`[u][v]`.",
    curves = "The rulings where patches meet and at the ends (role `ruling`), and the\npatches' edges along the strip's sides (role `side`, straight pieces).",
    diagnostics = "All figures, measured on the patches that are returned.",
);

/// What only `cone_spline` gives.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ConeSplineSpecific {
    /// The options as they were understood, defaults filled in.
    pub options: ConeSplineOptions,
    /// The workshop sheet of each patch, in the order of `surfaces`.
    pub patches: Vec<ConePatch>,
    /// The rulings that bound the patches, one more than patches: patch i lies
    /// between ruling i and i + 1.
    pub rulings: Vec<ConeRuling>,
    /// One an inner ruling, measured on the apex, axis, angle and radius of the
    /// patches.
    pub joins: Vec<ConeJoin>,
    /// The flat pattern: one piece, or several where it would overlap itself.
    pub pattern: Vec<ConePatternPiece>,
    /// What other numbers of patches would give, by least squares.
    pub error_curve: Vec<ConeErrorPoint>,
    /// Signed distance of every vertex, in the order of the mesh (for a
    /// surface: of the mesh laid on it), positive on the side of its normals;
    /// values to colour by. Vertices that the cut of a ring doubled come again
    /// at the end.
    pub vertex_distances: Vec<f64>,
}

/// A ruling, from side 0 of the strip to side 1.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ConeRuling {
    /// Its number, from the start of the strip.
    pub id: usize,
    /// End on side 0.
    pub from: Point,
    /// End on side 1.
    pub to: Point,
    /// The same in the flat pattern.
    #[schema(min_items = 2, max_items = 2, value_type = Vec<FlatPoint>)]
    pub flat: [FlatPoint; 2],
}

/// Where two patches meet.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ConeJoin {
    /// The ruling where they do.
    pub ruling: usize,
    /// Largest angle between their normals along it, degrees.
    pub angle_deg: f64,
    /// Largest distance of the ruling from either.
    pub gap: f64,
}

/// A flat pattern, true to size.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ConePatternPiece {
    /// Its first patch and one past its last.
    pub patches: IndexPair,
    /// Closed outline; the first point is not repeated.
    pub outline: Vec<FlatPoint>,
    /// Area.
    pub area: f64,
}

/// What a number of patches gives.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ConeErrorPoint {
    /// Number of patches.
    pub patches: usize,
    /// Largest distance of a vertex.
    pub max: f64,
    /// Mean distance, by area.
    pub mean: f64,
    /// Root mean square, by area.
    pub rms: f64,
}

/// Roles of the curves.
pub(super) const RULING: &str = "ruling";
/// Of the edges along the sides.
pub(super) const SIDE: &str = "side";

impl ConeSplineResult {
    /// The document of an outcome.
    #[must_use]
    pub fn new(job: &ConeSplineJob, input_sha256: String, outcome: &Outcome) -> Self {
        let contents = Contents {
            within_limits: outcome.within_limits,
            summary: outcome.summary.clone(),
            warnings: outcome.warnings.clone(),
            surfaces: (outcome.patches.iter())
                .map(|p| Surface::new(&p.name, p.kind.as_str(), &p.surface))
                .collect(),
            curves: curves(outcome),
            method_specific: ConeSplineSpecific {
                options: job.options.clone(),
                patches: outcome.patches.iter().map(Into::into).collect(),
                rulings: outcome.rulings.iter().map(Into::into).collect(),
                joins: outcome.joins.iter().map(Into::into).collect(),
                pattern: outcome.pattern.iter().map(Into::into).collect(),
                error_curve: outcome.error_curve.iter().map(Into::into).collect(),
                vertex_distances: outcome.vertex_distances.clone(),
            },
            diagnostics: outcome.into(),
        };
        Self::of(job, input_sha256, contents)
    }
}

fn curves(outcome: &Outcome) -> Vec<NamedCurve> {
    let ruling = |r: &Ruling| {
        let line = BSplineCurve::line(r.from, r.to, 1).ok()?;
        Some(NamedCurve::new(&format!("ruling {}", r.id), RULING, &line))
    };
    let mut curves: Vec<NamedCurve> = outcome.rulings.iter().filter_map(ruling).collect();
    for patch in &outcome.patches {
        let edges = patch.trims.iter().enumerate().filter_map(|(side, trim)| {
            let name = format!("{}, side {side}", patch.name);
            Some(NamedCurve::new(&name, SIDE, &polyline(trim)?))
        });
        curves.extend(edges);
    }
    curves
}

/// Straight pieces by length; none where all its points are one.
fn polyline(trim: &Trim) -> Option<BSplineCurve> {
    let mut points: Vec<Point3<f64>> = Vec::new();
    let mut lengths = Vec::new();
    for point in &trim.points {
        let step = points.last().map_or(0.0, |last| (point - last).norm());
        if points.is_empty() || step > 0.0 {
            lengths.push(lengths.last().map_or(0.0, |l| l + step));
            points.push(*point);
        }
    }
    let (first, last) = (*lengths.first()?, *lengths.last()?);
    let knots = [&[first][..], &lengths, &[last]].concat();
    BSplineCurve::new(1, knots, points, None).ok()
}

impl From<&Ruling> for ConeRuling {
    fn from(r: &Ruling) -> Self {
        ConeRuling {
            id: r.id,
            from: r.from.into(),
            to: r.to.into(),
            flat: r.flat.map(Into::into),
        }
    }
}

impl From<&Join> for ConeJoin {
    fn from(j: &Join) -> Self {
        ConeJoin {
            ruling: j.ruling,
            angle_deg: j.angle_deg,
            gap: j.gap,
        }
    }
}

impl From<&FlatPiece> for ConePatternPiece {
    fn from(p: &FlatPiece) -> Self {
        ConePatternPiece {
            patches: p.patches.into(),
            outline: p.outline.iter().map(|p| (*p).into()).collect(),
            area: p.area,
        }
    }
}

impl From<&ErrorPoint> for ConeErrorPoint {
    fn from(e: &ErrorPoint) -> Self {
        ConeErrorPoint {
            patches: e.patches,
            max: e.max,
            mean: e.mean,
            rms: e.rms,
        }
    }
}
