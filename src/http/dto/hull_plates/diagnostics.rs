//! The figures of a `hull_plates` fit on the wire.

use super::super::curves::{Point, finite};
use crate::methods::hull_plates::outcome::{Outcome, Plate};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// All figures of a `hull_plates` fit, measured on the delivered surfaces.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct HullPlatesDiagnostics {
    /// The longest side of the profiles' bounding box.
    pub model_size: f64,
    /// One a plate.
    pub plates: Vec<PlateFigures>,
}

/// The figures of one plate. Lengths in the job's unit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct PlateFigures {
    /// `"first profile – second profile"`.
    pub name: String,
    /// Whether it keeps every limit.
    pub within_limits: bool,
    /// The reason, a sentence.
    pub sentence: String,
    /// Largest |twist|, degrees.
    pub twist_max_deg: f64,
    /// Where: surface parameter.
    pub twist_max_u: f64,
    /// Where: the middle of that ruling.
    pub twist_max_at: Point,
    /// Mean |twist| weighted by area, degrees.
    pub twist_mean_deg: f64,
    /// 95 % of the area has less, degrees.
    pub twist_p95_deg: f64,
    /// |Twist| of the straight rulings between the two start corners and the
    /// two end corners: why corner to corner cannot pass.
    #[schema(min_items = 2, max_items = 2, value_type = Vec<f64>)]
    pub corner_warp_deg: [f64; 2],
    /// No set of rulings between nodes of a grid, within the same bounds, has
    /// a smaller largest twist: the discrete optimum for the profiles as given.
    pub bottleneck_deg: f64,
    /// Grid nodes per curve behind `bottleneck_deg`.
    pub bottleneck_grid: usize,
    /// Distance of the edge of regression from the plate outside its fans, in
    /// ruling lengths; null if there is none (a cylinder).
    pub regression_clearance: Option<f64>,
    /// Pairs of neighbouring rulings that cross.
    pub crossing_rulings: usize,
    /// Least bend radius across the rulings outside the fans; null if flat.
    pub min_bend_radius: Option<f64>,
    /// Where: surface parameter.
    pub min_bend_radius_u: f64,
    /// Outer-fibre strain, percent; null without a thickness.
    pub bend_strain_percent: Option<f64>,
    /// Share of the first and the second curve swept by fans, percent.
    #[schema(min_items = 2, max_items = 2, value_type = Vec<f64>)]
    pub fan_percent: [f64; 2],
    /// Largest extension past an end, percent of the model's longest side.
    pub extension_percent: f64,
    /// Membrane strain θ²/8 of the worst ruling, percent.
    pub membrane_strain_percent: f64,
    /// Largest |Gaussian curvature| outside the fans, 1/length².
    pub gaussian_curvature_max: f64,
    /// Area.
    pub area: f64,
    /// Largest distance of a pinned ruling's end from the delivered one; null
    /// without pins.
    pub pinned_deviation: Option<f64>,
    /// Iterations of the solver, all stages together.
    pub iterations: usize,
    /// Why its last stage stopped.
    pub termination: String,
}

impl From<&Outcome> for HullPlatesDiagnostics {
    fn from(outcome: &Outcome) -> Self {
        HullPlatesDiagnostics {
            model_size: outcome.model_size,
            plates: outcome.plates.iter().map(Into::into).collect(),
        }
    }
}

impl From<&Plate> for PlateFigures {
    fn from(plate: &Plate) -> Self {
        let d = &plate.diagnostics;
        PlateFigures {
            name: plate.name.clone(),
            within_limits: plate.within_limits,
            sentence: plate.sentence.clone(),
            twist_max_deg: d.twist_max_deg,
            twist_max_u: d.twist_max_u,
            twist_max_at: d.twist_max_at.into(),
            twist_mean_deg: d.twist_mean_deg,
            twist_p95_deg: d.twist_p95_deg,
            corner_warp_deg: d.corner_warp_deg,
            bottleneck_deg: d.bottleneck_deg,
            bottleneck_grid: d.bottleneck_grid,
            regression_clearance: finite(d.regression_clearance),
            crossing_rulings: d.crossing_rulings,
            min_bend_radius: finite(d.min_bend_radius),
            min_bend_radius_u: d.min_bend_radius_u,
            bend_strain_percent: d.bend_strain_percent,
            fan_percent: d.fan_percent,
            extension_percent: d.extension_percent,
            membrane_strain_percent: d.membrane_strain_percent,
            gaussian_curvature_max: d.gaussian_curvature_max,
            area: d.area,
            pinned_deviation: d.pinned_deviation,
            iterations: d.termination.iterations,
            termination: d.termination.reason.to_owned(),
        }
    }
}
