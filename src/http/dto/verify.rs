//! Surfaces to be measured, and what was measured.

use super::curves::{Point, check_points};
use super::hull_plates::{FlatStrainResult, RefoldResult};
use super::index::{Index, IndexPair};
use super::job::Units;
use super::surface_input::SurfaceInput;
use crate::formats::step_in::{StepReading, StepSurface};
use crate::geometry::BSplineSurface;
use crate::http::problem::FieldError;
use nalgebra::Point3;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Surfaces to be measured. The `surfaces` of a result can be sent as they are.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct VerifyRequest {
    /// The unit of all lengths, also in the answer.
    pub units: Units,
    /// The surfaces.
    #[schema(min_items = 1, max_items = 100)]
    pub surfaces: Vec<VerifySurface>,
    /// Points that edges of the surfaces should pass, for example the profiles.
    #[serde(default)]
    #[schema(max_items = 100)]
    pub target: Vec<VerifyTarget>,
    /// The largest twist that a ruled surface may have, degrees; 6 without it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(exclusive_minimum = 0, maximum = 45)]
    pub max_twist_deg: Option<f64>,
    /// Edges no further apart are joined; a length. Without it 1e-4 of the
    /// longest side of the box around all control points.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(exclusive_minimum = 0)]
    pub join_tolerance: Option<f64>,
}

/// A tensor-product B-spline surface, rational when it has weights.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct VerifySurface {
    /// Your name for it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(max_length = 200)]
    pub name: Option<String>,
    /// What it is; not looked at.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(max_length = 200)]
    pub role: Option<String>,
    /// Degrees in u and v.
    #[schema(min_items = 2, max_items = 2, value_type = Vec<Index>)]
    pub degree: [Index; 2],
    /// Knots in u and in v, multiplicities written out.
    #[schema(min_items = 2, max_items = 2, value_type = Vec<Vec<f64>>)]
    pub knots: [Vec<f64>; 2],
    /// Control points, indexed `[u][v]`.
    #[schema(min_items = 2, max_items = 10_000)]
    pub control_points: Vec<Vec<Point>>,
    /// Positive weights, indexed `[u][v]`; none for a polynomial surface.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub weights: Option<Vec<Vec<f64>>>,
}

/// Points with a name.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct VerifyTarget {
    /// Your name for them.
    #[schema(min_length = 1, max_length = 100)]
    pub name: String,
    /// The points.
    #[schema(min_items = 1, max_items = 10_000)]
    pub points: Vec<Point>,
}

const UNITS: [Units; 5] = [Units::Mm, Units::Cm, Units::M, Units::In, Units::Ft];
/// Units of a file that differ by less than this share are one: a surveyor's
/// foot is none of ours.
const SAME_UNIT: f64 = 1e-9;

/// What was measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Verification {
    /// The unit of all lengths.
    pub units: Units,
    /// What it comes to, in sentences.
    pub summary: Vec<String>,
    /// What was not looked at: faces of a STEP file that are on no B-spline
    /// surface, trims.
    pub warnings: Vec<String>,
    /// One a surface.
    pub surfaces: Vec<SurfaceFigures>,
    /// Edges that meet along all of their length.
    pub joins: Vec<JoinFigures>,
    /// Edges that meet no other one; those without length are left out.
    pub open_edges: Vec<EdgeName>,
    /// One a target.
    pub target: Vec<TargetFigures>,
}

/// The figures of a surface.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct SurfaceFigures {
    /// Its name.
    pub name: String,
    /// Area.
    pub area: f64,
    /// Largest |Gaussian curvature| at Gauss nodes, 1/length².
    pub gaussian_curvature_max: f64,
    /// Where.
    pub gaussian_curvature_max_at: Point,
    /// `∫ |K| dA`, which knows no scale: 0 for a developable surface.
    pub total_curvature: f64,
    /// Least radius of normal curvature; null on a plane.
    pub least_radius: Option<f64>,
    /// Places where it has no normal.
    pub singular_places: usize,
    /// Null for a surface that is not linear in u or v.
    pub ruled: Option<RuledFigures>,
}

/// The figures of a ruled surface.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct RuledFigures {
    /// The direction of its rulings.
    pub along: DirectionWord,
    /// Whether the largest twist is within `max_twist_deg`.
    pub within_limits: bool,
    /// Largest |twist|: the angle between the normals at a ruling's ends, degrees.
    pub twist_max_deg: f64,
    /// Where: the other parameter.
    pub twist_max_parameter: f64,
    /// Where: the middle of the ruling.
    pub twist_max_at: Point,
    /// Mean |twist| weighted by area, degrees.
    pub twist_mean_deg: f64,
    /// Least distance of the edge of regression from a ruling, in its lengths;
    /// null if there is none (a cylinder).
    pub regression_clearance: Option<f64>,
    /// Rulings, of those looked at, at which the surface folds back.
    pub folds: usize,
    /// Least bend radius across the rulings; null if flat.
    pub min_bend_radius: Option<f64>,
    /// What flattening does to it; null if it has no area.
    pub flat: Option<FlatFigures>,
}

/// A surface against its flat pattern, which keeps the lengths of both edges and
/// of all rulings.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct FlatFigures {
    /// Area of the pattern.
    pub area: f64,
    /// Pieces; more than one where it would lie on itself.
    pub pieces: usize,
    /// Longer and shorter side of the least rectangle around each piece.
    #[schema(value_type = Vec<Vec<f64>>)]
    pub sheets: Vec<[f64; 2]>,
    /// Strains.
    pub strain: FlatStrainResult,
    /// The pattern bent along its rulings alone.
    pub refolds: Vec<RefoldResult>,
}

/// A parameter direction.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum DirectionWord {
    /// The first parameter.
    U,
    /// The second parameter.
    V,
}

/// An edge of a surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct EdgeName {
    /// Index of the surface.
    pub surface: usize,
    /// Which edge.
    pub edge: EdgeWord,
}

/// `v0`: along u where v is least; the others likewise.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum EdgeWord {
    /// v least.
    V0,
    /// v greatest.
    V1,
    /// u least.
    U0,
    /// u greatest.
    U1,
}

/// Where two edges, or parts of them, meet.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct JoinFigures {
    /// The surfaces' indices.
    pub surfaces: IndexPair,
    /// Their edges.
    #[schema(min_items = 2, max_items = 2, value_type = Vec<EdgeWord>)]
    pub edges: [EdgeWord; 2],
    /// Length.
    pub length: f64,
    /// Largest distance of either from the other.
    pub gap: f64,
    /// Largest angle between the surfaces, degrees; 0 where one goes on into the
    /// other.
    pub knuckle_max_deg: f64,
    /// Mean angle, degrees.
    pub knuckle_mean_deg: f64,
}

/// Distances of points from the nearest edge.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct TargetFigures {
    /// Their name.
    pub name: String,
    /// The largest; null if no surface has an edge.
    pub distance_max: Option<f64>,
    /// Which point.
    pub distance_max_index: Option<usize>,
    /// The mean.
    pub distance_mean: Option<f64>,
}

/// Surfaces that are measured in one request, at the most.
const MOST_SURFACES: usize = 100;
/// Control points that are measured in one request, at the most.
const MOST_CONTROL_POINTS: usize = 50_000;

impl VerifyRequest {
    /// The surfaces of a STEP file, in its unit, or in metres where that is none
    /// of ours.
    ///
    /// # Errors
    /// More surfaces than are measured at a time.
    pub fn of_step(step: StepReading) -> Result<Self, Vec<FieldError>> {
        let found = step.surfaces.len();
        if found > MOST_SURFACES {
            let message = format!(
                "the file has {found} surfaces, at most {MOST_SURFACES} are measured at a time"
            );
            return Err(vec![FieldError::new("file", "too-many", message)]);
        }
        let own = UNITS.into_iter();
        let own = own.min_by(|a, b| {
            let off = |unit: &Units| (unit.metres() / step.metres).ln().abs();
            off(a).total_cmp(&off(b))
        });
        let own = own.filter(|unit| (unit.metres() / step.metres - 1.0).abs() < SAME_UNIT);
        let (units, scale) = own.map_or((Units::M, step.metres), |unit| (unit, 1.0));
        let surface = |s: StepSurface| VerifySurface {
            name: s.name,
            role: None,
            degree: s.surface.degrees().map(Index),
            knots: s.surface.knots().clone(),
            control_points: (s.surface.control_points())
                .chunks(s.surface.counts()[1])
                .map(|row| row.iter().map(|p| (p * scale).into()).collect())
                .collect(),
            weights: s.surface.weights().map(|w| {
                let rows = w.chunks(s.surface.counts()[1]);
                rows.map(<[f64]>::to_vec).collect()
            }),
        };
        Ok(VerifyRequest {
            units,
            surfaces: step.surfaces.into_iter().map(surface).collect(),
            target: Vec::new(),
            max_twist_deg: None,
            join_tolerance: None,
        })
    }

    /// The surfaces.
    ///
    /// # Errors
    /// Every fault, with its JSON pointer.
    pub fn surfaces(&self) -> Result<Vec<BSplineSurface>, Vec<FieldError>> {
        let mut faults = Vec::new();
        let rows = self.surfaces.iter().flat_map(|s| &s.control_points);
        let total: usize = rows.map(Vec::len).sum();
        if total > MOST_CONTROL_POINTS {
            let message = format!(
                "the surfaces have {total} control points, at most {MOST_CONTROL_POINTS} are \
                 measured at a time"
            );
            return Err(vec![FieldError::new("/surfaces", "too-many", message)]);
        }
        let surfaces: Vec<BSplineSurface> = (self.surfaces.iter().enumerate())
            .filter_map(|(i, s)| {
                s.input()
                    .to_surface(&format!("/surfaces/{i}"), self.units, &mut faults)
            })
            .collect();
        for (i, target) in self.target.iter().enumerate() {
            let at = format!("/target/{i}/points");
            check_points(&target.points, &at, self.units, &mut faults);
        }
        if faults.is_empty() {
            Ok(surfaces)
        } else {
            Err(faults)
        }
    }

    /// The name of a surface, or a name for it.
    #[must_use]
    pub fn name(&self, surface: usize) -> String {
        let given = self.surfaces.get(surface).and_then(|s| s.name.clone());
        given.unwrap_or_else(|| usual_name(surface))
    }
}

/// What a surface is called that has no name.
#[must_use]
pub fn usual_name(surface: usize) -> String {
    format!("surface {}", surface + 1)
}

impl VerifySurface {
    fn input(&self) -> SurfaceInput {
        SurfaceInput {
            degree: self.degree,
            knots: self.knots.clone(),
            control_points: self.control_points.clone(),
            weights: self.weights.clone(),
        }
    }
}

impl VerifyTarget {
    /// The points.
    #[must_use]
    pub fn points(&self) -> Vec<Point3<f64>> {
        self.points.iter().map(|p| (*p).into()).collect()
    }
}
