//! The result of a job on the wire. It holds no id and no time, so that the
//! same job gives the same bytes.

use super::super::curves::{NamedCurve, Point, Surface, finite};
use super::super::job::{HullPlatesJob, HullPlatesMethod};
use super::super::result::{Contents, result_of_a_method};
use super::{HullPlatesDiagnostics, HullPlatesOptions, PlateFlatResult, patterns};
use crate::methods::hull_plates::outcome::{
    Deviation, Fan, MovedPoint, Outcome, OutcomeProfile, Plate, Ruling,
};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

result_of_a_method!(
    HullPlatesResult,
    HullPlatesJob,
    HullPlatesMethod,
    HullPlatesSpecific,
    HullPlatesDiagnostics,
    about = "The result of a `hull_plates` job. Lengths in `units`.",
    verdict = "Whether every limit is kept.",
    summary = "One sentence for the job, then one a plate, then one on the flat patterns.",
    surfaces = "The plates: degree `[3, 1]`, `v = 0` on the first profile, `v = 1` on\nthe second; control points indexed `[u][v]`.",
    curves = "The profiles as the plates use them; neighbours share theirs.",
    diagnostics = "All figures, measured on the delivered surfaces.",
);

/// What only `hull_plates` gives.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct HullPlatesSpecific {
    /// The options as they were understood, defaults filled in.
    pub options: HullPlatesOptions,
    /// One a plate, in the order of `surfaces`.
    pub plates: Vec<PlateResult>,
    /// One a profile, in the order of `curves`.
    pub profiles: Vec<ProfileResult>,
}

/// A plate beyond its surface.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct PlateResult {
    /// `"first profile – second profile"`.
    pub name: String,
    /// Whether this plate keeps every limit.
    pub within_limits: bool,
    /// Rulings from one end to the other, ends and fan joins included.
    pub rulings: Vec<RulingResult>,
    /// Fans at the ends, at most one an end.
    pub fans: Vec<FanResult>,
    /// How far the curves run on past their ends: first profile's start and
    /// end, second profile's start and end.
    #[schema(min_items = 4, max_items = 4, value_type = Vec<f64>)]
    pub extensions: [f64; 4],
    /// The plate as it is cut and rolled; null if it has no area.
    pub flat: Option<PlateFlatResult>,
}

/// One ruling.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct RulingResult {
    /// Surface parameter.
    pub u: f64,
    /// End on the first profile.
    pub from: Point,
    /// End on the second profile.
    pub to: Point,
    /// Angle between the surface normals at the two ends, signed, degrees.
    pub twist_deg: f64,
    /// Bend radius across the ruling at `from`; the sign tells the side; null
    /// where flat.
    pub bend_radius_from: Option<f64>,
    /// The same at `to`.
    pub bend_radius_to: Option<f64>,
}

/// A fan: an exact cone with its apex in a corner of the plate.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct FanResult {
    /// At the start (`u = 0`) or the end (`u = 1`).
    pub at_start: bool,
    /// Whether the apex lies on the first profile; the fan then sweeps the
    /// second.
    pub apex_on_first: bool,
    /// Share of the swept curve's length, percent.
    pub swept_percent: f64,
    /// Surface parameters between which the fan lies.
    #[schema(min_items = 2, max_items = 2, value_type = Vec<f64>)]
    pub u_range: [f64; 2],
}

/// A profile beyond its curve.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ProfileResult {
    /// The user's name for it.
    pub name: String,
    /// How far it was moved.
    pub deviation: DeviationResult,
    /// Given points that moved by more than 1e-6 of the model's longest side.
    pub moved_points: Vec<MovedPointResult>,
}

/// Distance of the given points and curve to the delivered curve.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct DeviationResult {
    /// Largest distance of a given point.
    pub points_max: f64,
    /// Largest distance anywhere along the given curve.
    pub curve_max: f64,
    /// Mean along the given curve.
    pub curve_mean: f64,
    /// Root mean square along the given curve.
    pub curve_rms: f64,
}

/// A given point and where the delivered curve now passes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct MovedPointResult {
    /// Index in the profile's list of points.
    pub index: usize,
    /// As given.
    pub given: Point,
    /// Where the curve now passes.
    pub now: Point,
    /// The distance between the two.
    pub distance: f64,
}

impl HullPlatesResult {
    /// The result of a job out of its request, the method's outcome and the
    /// flat patterns of its plates.
    #[must_use]
    pub fn new(
        job: &HullPlatesJob,
        input_sha256: String,
        outcome: &Outcome,
        flats: Vec<Option<PlateFlatResult>>,
    ) -> Self {
        let mut summary = outcome.summary.clone();
        summary.extend(patterns::sentence(&flats, job.units));
        let plates = outcome.plates.iter().zip(flats);
        let contents = Contents {
            within_limits: outcome.within_limits,
            summary,
            warnings: outcome.warnings.clone(),
            surfaces: (outcome.plates.iter())
                .map(|p| Surface::new(&p.name, "plate", &p.surface))
                .collect(),
            curves: (outcome.profiles.iter())
                .map(|p| NamedCurve::new(&p.name, "profile", &p.curve))
                .collect(),
            method_specific: HullPlatesSpecific {
                options: job.options.clone(),
                plates: plates.map(|(p, flat)| PlateResult::new(p, flat)).collect(),
                profiles: outcome.profiles.iter().map(Into::into).collect(),
            },
            diagnostics: outcome.into(),
        };
        Self::of(job, input_sha256, contents)
    }
}

impl PlateResult {
    fn new(plate: &Plate, flat: Option<PlateFlatResult>) -> Self {
        PlateResult {
            name: plate.name.clone(),
            within_limits: plate.within_limits,
            rulings: plate.rulings.iter().map(Into::into).collect(),
            fans: plate.fans.iter().map(Into::into).collect(),
            extensions: plate.extensions,
            flat,
        }
    }
}

impl From<&Ruling> for RulingResult {
    fn from(ruling: &Ruling) -> Self {
        RulingResult {
            u: ruling.u,
            from: ruling.from.into(),
            to: ruling.to.into(),
            twist_deg: ruling.twist_deg,
            bend_radius_from: finite(ruling.bend_radius_from),
            bend_radius_to: finite(ruling.bend_radius_to),
        }
    }
}

impl From<&Fan> for FanResult {
    fn from(fan: &Fan) -> Self {
        FanResult {
            at_start: fan.at_start,
            apex_on_first: fan.apex_on_first,
            swept_percent: fan.swept_percent,
            u_range: fan.u_range,
        }
    }
}

impl From<&OutcomeProfile> for ProfileResult {
    fn from(profile: &OutcomeProfile) -> Self {
        ProfileResult {
            name: profile.name.clone(),
            deviation: profile.deviation.into(),
            moved_points: profile.moved_points.iter().map(Into::into).collect(),
        }
    }
}

impl From<Deviation> for DeviationResult {
    fn from(d: Deviation) -> Self {
        DeviationResult {
            points_max: d.points_max,
            curve_max: d.curve_max,
            curve_mean: d.curve_mean,
            curve_rms: d.curve_rms,
        }
    }
}

impl From<&MovedPoint> for MovedPointResult {
    fn from(moved: &MovedPoint) -> Self {
        MovedPointResult {
            index: moved.index,
            given: moved.given.into(),
            now: moved.now.into(),
            distance: moved.distance,
        }
    }
}
