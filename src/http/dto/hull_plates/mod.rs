//! The job of `hull_plates` on the wire. Bounds of single values are written
//! here, as the schema that is published and checked; its way into the
//! method's request is [`to_request`].

mod diagnostics;
mod drawing;
mod flat;
mod patterns;
mod result;
mod to_request;

pub use diagnostics::{HullPlatesDiagnostics, PlateFigures};
pub use flat::{DevelopedWord, FlatStrainResult, PlateFlatResult, RefoldResult, flat_patterns};
pub use result::HullPlatesResult;
pub use to_request::to_request;

use super::curves::{Point, Spline, whole_number};
use crate::methods::hull_plates::request::{Ends, Options, Solver};
use crate::workshop::Face;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// What `hull_plates` takes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct HullPlatesInput {
    /// The profile curves in order, for example deck edge, chines, keel, all
    /// in the same direction (stern to bow). Neighbours bound one plate each.
    #[schema(min_items = 2, max_items = 1000)]
    pub profiles: Vec<ProfileCurve>,
}

/// A profile: exactly one of `points` and `bspline`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ProfileCurve {
    /// Your name for it; plates are called after their two profiles.
    #[schema(min_length = 1, max_length = 100, examples("main_deck"))]
    pub name: String,
    /// Points in order; a cubic B-spline with chord-length parameters and
    /// averaged knots interpolates them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(min_items = 2, max_items = 1_000_000)]
    pub points: Option<Vec<Point>>,
    /// The curve itself.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bspline: Option<Spline>,
}

/// What is asked of the plates. Lengths in the job's unit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields, default)]
#[schema(default)]
pub struct HullPlatesOptions {
    /// How far the plates' boundaries may leave the profiles.
    pub boundary: BoundaryOption,
    /// The largest twist a plate may have, degrees: the angle between the
    /// surface normals at the two ends of a ruling. Steel stands about 6.
    #[schema(exclusive_minimum = 0, maximum = 45)]
    pub max_twist_deg: f64,
    /// Plate thickness, for the strain of bending and the flat pattern; a length.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(exclusive_minimum = 0)]
    pub thickness: Option<f64>,
    /// Where in the thickness the surface through the profiles lies. The pattern
    /// is that of the middle.
    pub surface_side: SurfaceSide,
    /// The least bend radius that the yard can roll; a length.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(exclusive_minimum = 0)]
    pub min_bend_radius: Option<f64>,
    /// Rulings that must be there (a frame, a butt).
    #[schema(max_items = 1000)]
    pub pinned_rulings: Vec<PinnedRulingOption>,
    /// How a plate reaches its corners when its end rulings do not.
    pub ends: EndsOption,
    /// Share of a curve that a fan at an end may sweep, percent.
    #[schema(minimum = 0, maximum = 50)]
    pub max_fan_percent: f64,
    /// How far a curve may run on past its end, percent of the model's longest
    /// side.
    #[schema(minimum = 0, maximum = 20)]
    pub max_extension_percent: f64,
    /// Least distance of the edge of regression (where the plate would fold)
    /// from the plate, percent of a ruling's length. Without it 100/7, which
    /// keeps the speeds of a ruling's two ends within 1/8 to 8, or 5 (1/21 to
    /// 21) where the boundary moves, by a tolerance that is given or found.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(minimum = 1, maximum = 50)]
    pub min_clearance_percent: Option<f64>,
    /// Which algorithm fits.
    pub solver: SolverOption,
}

/// Where in a plate the surface through the profiles lies: on its `inside`
/// (moulded lines), in its `middle`, on its `outside`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum SurfaceSide {
    /// The side that lies up in the pattern.
    #[default]
    Inside,
    /// Half-way.
    Middle,
    /// The other side.
    Outside,
}

impl From<SurfaceSide> for Face {
    fn from(side: SurfaceSide) -> Self {
        match side {
            SurfaceSide::Inside => Face::Up,
            SurfaceSide::Middle => Face::Middle,
            SurfaceSide::Outside => Face::Down,
        }
    }
}

/// How far the plates' boundaries may leave the profiles.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct BoundaryOption {
    /// `exact`: not at all (1e-6 of the model's longest side). `tolerance`: by
    /// at most `value`, everywhere. `auto`: not at all where the twist limit
    /// can be met so, else by the least length that meets it.
    pub mode: BoundaryMode,
    /// The tolerance, a length; with mode `tolerance` only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(exclusive_minimum = 0)]
    pub value: Option<f64>,
}

/// The word of a [`BoundaryOption`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum BoundaryMode {
    /// Not at all.
    Exact,
    /// By at most a given length.
    Tolerance,
    /// As little as the twist limit needs.
    Auto,
}

/// How a plate reaches its corners: `fan`, a cone with its apex in the corner,
/// or `extend`, the curves run on past their ends, to be trimmed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum EndsOption {
    /// A cone with its apex in the corner.
    Fan,
    /// The curves run on past their ends.
    Extend,
}

/// Which algorithm fits: `own`, this service's, or `paper`, the formulation of
/// Zheng & Bo 2018, much slower and for comparison only.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum SolverOption {
    /// This service's own.
    Own,
    /// The paper's.
    Paper,
}

/// A ruling that must be there.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct PinnedRulingOption {
    /// Which plate, counted from 0: plate i lies between profiles i and i + 1.
    #[schema(minimum = 0, maximum = 998, value_type = u32)]
    #[serde(deserialize_with = "whole_number")]
    pub plate: usize,
    /// A point on, or very near, the plate's first profile.
    pub from: Point,
    /// A point on, or very near, the plate's second profile.
    pub to: Point,
}

impl Default for HullPlatesOptions {
    fn default() -> Self {
        let Options {
            boundary: _,
            max_twist_deg,
            thickness,
            min_bend_radius,
            pinned_rulings: _,
            ends,
            max_fan_percent,
            max_extension_percent,
            min_clearance_percent,
            solver,
        } = Options::default();
        HullPlatesOptions {
            boundary: BoundaryOption {
                mode: BoundaryMode::Auto,
                value: None,
            },
            max_twist_deg,
            thickness,
            surface_side: SurfaceSide::Inside,
            min_bend_radius,
            pinned_rulings: Vec::new(),
            ends: match ends {
                Ends::Fan => EndsOption::Fan,
                Ends::Extend => EndsOption::Extend,
            },
            max_fan_percent,
            max_extension_percent,
            min_clearance_percent,
            solver: match solver {
                Solver::Own => SolverOption::Own,
                Solver::Paper => SolverOption::Paper,
            },
        }
    }
}
