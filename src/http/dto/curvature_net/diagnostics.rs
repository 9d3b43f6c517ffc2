//! The figures of a `curvature_net` fit on the wire.

use super::super::curves::Point;
use super::super::index::IndexPair;
use super::specific::CertificateResult;
use crate::methods::curvature_net::diagnose::At;
use crate::methods::curvature_net::outcome::{CyclideFigures, Cyclides, Outcome, Spread};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// All figures of a `curvature_net` fit. Lengths in the job's unit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CurvatureNetDiagnostics {
    /// The longest side of the net's bounding box.
    pub model_size: f64,
    /// Rows and columns of patches.
    pub patches: IndexPair,
    /// The mean distance of neighbouring vertices.
    pub mean_edge: f64,
    /// How far the smooth surface's borders are from lines of curvature.
    pub borders: BorderResult,
    /// Where its two curvatures come near each other.
    pub umbilics: UmbilicResult,
    /// How far it is from the start.
    pub shape: ShapeResult,
    /// How far the given points were smoothed before; null where they were not.
    /// They are where the net has umbilics as it is given.
    pub smoothed: Option<SmoothedResult>,
    /// How far it is from the target; null without one.
    pub target: Option<TargetResult>,
    /// The cyclide spline; null unless asked.
    pub cyclides: Option<CyclideResult>,
    /// Iterations of the solver for the smooth surface, level by level and
    /// weight by weight.
    pub steps: Vec<StepResult>,
}

/// A value and where it stands.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct PlaceResult {
    /// The value.
    pub value: f64,
    /// The place in space.
    pub at: Point,
    /// Row of the net; a fraction between two rows.
    pub row: f64,
    /// Column of the net; a fraction between two columns.
    pub column: f64,
}

/// How far borders are from lines of curvature.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct BorderResult {
    /// Mean |geodesic torsion · length|, radians.
    pub torsion_mean: f64,
    /// The largest.
    pub torsion_max: PlaceResult,
    /// Largest deviation of two lines from a right angle, degrees.
    pub skew_max_deg: PlaceResult,
    /// Mean angle between a border and the nearest line of curvature, degrees,
    /// where the two curvatures differ enough to have any.
    pub off_principal_mean_deg: f64,
    /// The largest.
    pub off_principal_max_deg: PlaceResult,
    /// Largest angle between the normals of neighbouring patches, degrees.
    pub normal_jump_max_deg: f64,
}

/// Where the two curvatures come near each other.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct UmbilicResult {
    /// Least |κ₁ − κ₂| over its mean.
    pub least_difference: PlaceResult,
    /// Mean |κ₁ − κ₂|, 1/length.
    pub mean_difference: f64,
    /// Patches with an umbilic, by row and column.
    pub patches: Vec<IndexPair>,
    /// Where the start itself makes umbilics unavoidable; null where it does
    /// not.
    pub crossing: Option<CrossingResult>,
}

/// Places of the start between which its curvatures pass each other.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CrossingResult {
    /// Where the line along u is bent more, by most: κ_u − κ_v.
    pub u: PlaceResult,
    /// Where the line along v is: κ_v − κ_u.
    pub v: PlaceResult,
}

/// How far points were smoothed. Lengths.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct SmoothedResult {
    /// Mean way of a vertex.
    pub moved_mean: f64,
    /// The largest.
    pub moved_max: PlaceResult,
}

/// How far the smooth surface is from a target. Lengths.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct TargetResult {
    /// Mean distance of a vertex.
    pub distance_mean: f64,
    /// The largest.
    pub distance_max: PlaceResult,
}

/// A vertex of the given net that could not be kept.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct LeftResult {
    /// Its index among the given vertices; of a grid row · columns + column.
    pub vertex: usize,
    /// Where it is now.
    pub at: Point,
    /// Its way, in mean edges.
    pub moved: f64,
    /// The turn of its normal, degrees.
    pub turned_deg: f64,
    /// What about the start asked for it.
    pub why: String,
}

/// How far the smooth surface is from the start.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ShapeResult {
    /// Mean way of a vertex, in mean edges.
    pub moved_mean: f64,
    /// The largest.
    pub moved_max: PlaceResult,
    /// Mean turn of a normal, degrees.
    pub turned_mean_deg: f64,
    /// The largest.
    pub turned_max_deg: PlaceResult,
    /// Where the net as a whole could not be kept, the vertices that went
    /// furthest, with reasons.
    pub left: Vec<LeftResult>,
}

/// How exact the cyclide spline is, and how far from the smooth surface.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CyclideResult {
    /// The largest residual of each kind.
    pub worst: CertificateResult,
    /// Row and column of the patch with the largest of all.
    pub worst_patch: IndexPair,
    /// Quads without a patch.
    pub missing: usize,
    /// What carrying one frame through the net by mirrors would miss.
    pub closure: f64,
    /// Ways of the vertices, a length.
    pub moved: SpreadResult,
    /// Turns of the normals, degrees.
    pub turned_deg: SpreadResult,
    /// Iterations of the solver.
    pub iterations: usize,
}

/// Mean and largest of a figure over the vertices.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct SpreadResult {
    /// Mean.
    pub mean: f64,
    /// Largest.
    pub max: f64,
    /// Row and column of the largest.
    pub at: IndexPair,
}

/// One minimisation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct StepResult {
    /// How often quads had been split.
    pub level: usize,
    /// The weight of the torsion.
    pub weight: f64,
    /// Iterations.
    pub iterations: usize,
    /// Whether they ended at a minimum.
    pub converged: bool,
}

/// A value times a factor, with its place.
fn place(at: &At, factor: f64) -> PlaceResult {
    PlaceResult {
        value: at.value * factor,
        at: at.point.into(),
        row: at.place[0],
        column: at.place[1],
    }
}

fn spread(s: &Spread, factor: f64) -> SpreadResult {
    SpreadResult {
        mean: s.mean * factor,
        max: s.max * factor,
        at: s.at.into(),
    }
}

/// Degrees in a radian.
const DEGREES: f64 = 180.0 / std::f64::consts::PI;

impl From<&Outcome> for CurvatureNetDiagnostics {
    fn from(outcome: &Outcome) -> Self {
        let smooth = &outcome.smooth;
        let (borders, umbilics) = (&smooth.borders, &smooth.umbilics);
        CurvatureNetDiagnostics {
            model_size: outcome.model_size,
            patches: outcome.net.layout().patch_counts().into(),
            mean_edge: outcome.net.mean_edge(),
            borders: BorderResult {
                torsion_mean: borders.mean_torsion,
                torsion_max: place(&borders.max_torsion, 1.0),
                skew_max_deg: place(&borders.max_skew, DEGREES),
                off_principal_mean_deg: borders.mean_off_principal * DEGREES,
                off_principal_max_deg: place(&borders.max_off_principal, DEGREES),
                normal_jump_max_deg: borders.max_normal_jump * DEGREES,
            },
            umbilics: UmbilicResult {
                least_difference: place(&umbilics.least_difference, 1.0),
                mean_difference: umbilics.mean_difference,
                patches: umbilics.patches.iter().map(|p| (*p).into()).collect(),
                crossing: smooth.crossing.as_ref().map(|c| CrossingResult {
                    u: place(&c.u, 1.0),
                    v: place(&c.v, 1.0),
                }),
            },
            shape: ShapeResult {
                moved_mean: smooth.shape.mean_move,
                moved_max: place(&smooth.shape.max_move, 1.0),
                turned_mean_deg: smooth.shape.mean_turn_deg,
                turned_max_deg: place(&smooth.shape.max_turn_deg, 1.0),
                left: left(outcome),
            },
            smoothed: smooth.smoothed.as_ref().map(|s| SmoothedResult {
                moved_mean: s.mean,
                moved_max: place(&s.max, 1.0),
            }),
            target: smooth.target.as_ref().map(|t| TargetResult {
                distance_mean: t.mean_distance,
                distance_max: place(&t.max_distance, 1.0),
            }),
            cyclides: outcome.cyclides.as_ref().map(Into::into),
            steps: steps(outcome),
        }
    }
}

fn left(outcome: &Outcome) -> Vec<LeftResult> {
    let moved = outcome.smooth.moved.iter().map(|m| LeftResult {
        vertex: m.vertex,
        at: m.point.into(),
        moved: m.moved,
        turned_deg: m.turned_deg,
        why: m.why.to_string(),
    });
    moved.collect()
}

fn steps(outcome: &Outcome) -> Vec<StepResult> {
    let steps = outcome.smooth.steps.iter().map(|s| StepResult {
        level: s.level,
        weight: s.torsion,
        iterations: s.iterations,
        converged: s.converged,
    });
    steps.collect()
}

impl From<&Cyclides> for CyclideResult {
    fn from(cyclides: &Cyclides) -> Self {
        let CyclideFigures {
            worst,
            worst_patch,
            missing,
            closure,
            mean_edge: _,
            moved,
            turned,
            iterations,
        } = &cyclides.figures;
        CyclideResult {
            worst: worst.into(),
            worst_patch: (*worst_patch).into(),
            missing: *missing,
            closure: *closure,
            moved: spread(moved, 1.0),
            turned_deg: spread(turned, DEGREES),
            iterations: *iterations,
        }
    }
}
