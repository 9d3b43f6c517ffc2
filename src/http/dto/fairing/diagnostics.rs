//! The figures of a `fairing` fit on the wire.

use super::super::curves::finite;
use crate::methods::fairing::{Outcome, curve, offsets, surface};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// All figures of a `fairing` fit, measured on the delivered shape. What goes
/// with curves or with surfaces only is null for the others.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct FairingDiagnostics {
    /// Estimated standard deviation of the points across the shape.
    pub noise: f64,
    /// Whether the points tell noise from shape; otherwise `noise` is the most
    /// that they could hide (curves).
    pub noise_evident: Option<bool>,
    /// Largest move.
    pub move_max: f64,
    /// Root mean square of all moves.
    pub move_rms: f64,
    /// Points at their tolerance.
    pub at_limit: usize,
    /// Points that look like slips.
    pub slips: usize,
    /// Control points: of a curve, or in u and in v.
    pub control_points: Vec<usize>,
    /// What the number of control points follows from (curves).
    pub control_points_from: Option<String>,
    /// Degree: of a curve, or in u and in v.
    pub degree: Vec<usize>,
    /// Effective number of parameters that the points determine (curves).
    pub degrees_of_freedom: Option<f64>,
    /// Stiffness of the shape against springs of weight 1, in unit scale.
    pub stiffness: Option<f64>,
    /// Iterations of the solver (curves).
    pub iterations: Option<usize>,
    /// Duality gap as a share of the energy, where a curve has tolerances.
    pub gap: Option<f64>,
    /// Largest angle between an end tangent and the one asked, degrees.
    pub tangent_error_deg: Option<f64>,
    /// Largest distance of a straight stretch from its chord.
    pub straightness: Option<f64>,
    /// How a surface's parameters were found: `grid`, `height_field`,
    /// `unrolled`.
    pub parametrisation: Option<String>,
    /// Of the shape that follows the points as nearly as it can.
    pub before: Option<FairnessFigures>,
    /// Of the delivered shape.
    pub after: FairnessFigures,
}

/// How fair a shape is.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(untagged)]
pub enum FairnessFigures {
    /// Of a curve.
    Curve(CurveFairness),
    /// Of a surface.
    Surface(SurfaceFairness),
}

/// How fair a curve is.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CurveFairness {
    /// ∫ κ′² ds, in space ∫ κ′² + κ²τ² ds, 1/length³: 0 on lines and circles.
    pub curvature_variation: f64,
    /// ∫ κ² ds, 1/length.
    pub bending: f64,
    /// Local extrema of the curvature.
    pub extrema: usize,
    /// Inflections (plane curves).
    pub inflections: usize,
    /// Largest |κ|, 1/length.
    pub max_curvature: f64,
    /// Length.
    pub length: f64,
}

/// How fair a surface is, over its trimmed region.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct SurfaceFairness {
    /// The energy that was minimised, lengths in units of the longest side.
    pub energy: f64,
    /// Least Gaussian curvature, 1/length².
    pub gaussian_min: Option<f64>,
    /// Largest Gaussian curvature, 1/length².
    pub gaussian_max: Option<f64>,
    /// Least mean curvature, 1/length; the sign depends on u × v.
    pub mean_min: Option<f64>,
    /// Largest mean curvature, 1/length.
    pub mean_max: Option<f64>,
    /// How much the isophotes wave: root mean square of the second derivative
    /// of n·l by arc length along both families of parameter lines, 1/length².
    pub isophote_roughness: Option<f64>,
}

impl From<&Outcome> for FairingDiagnostics {
    fn from(outcome: &Outcome) -> Self {
        match outcome {
            Outcome::Curve(o) => of_curve(o),
            Outcome::Surface(o) => of_surface(o),
            Outcome::Offsets(o) => of_offsets(o),
        }
    }
}

fn of_curve(o: &curve::Outcome) -> FairingDiagnostics {
    let r = &o.report;
    FairingDiagnostics {
        noise: r.noise,
        noise_evident: Some(r.noise_evident),
        move_max: o.move_figures.max,
        move_rms: o.move_figures.rms,
        at_limit: o.move_figures.at_limit,
        slips: o.slips.len(),
        control_points: vec![r.control_points],
        control_points_from: Some(r.control_points_from.to_owned()),
        degree: vec![r.degree],
        degrees_of_freedom: finite(r.degrees_of_freedom),
        stiffness: finite(r.stiffness),
        iterations: Some(r.iterations),
        gap: r.gap.and_then(finite),
        tangent_error_deg: r.tangent_error_deg,
        straightness: r.straightness,
        parametrisation: None,
        before: o.before.as_ref().map(|f| FairnessFigures::Curve(f.into())),
        after: FairnessFigures::Curve((&o.after).into()),
    }
}

fn of_surface(o: &surface::Outcome) -> FairingDiagnostics {
    use surface::outcome::Parametrisation;
    FairingDiagnostics {
        noise: o.noise,
        noise_evident: None,
        move_max: o.move_max,
        move_rms: o.move_rms,
        at_limit: o.active.len(),
        slips: o.slips.len(),
        control_points: o.surface.counts().to_vec(),
        control_points_from: None,
        degree: o.surface.degrees().to_vec(),
        degrees_of_freedom: None,
        stiffness: o.stiffness.and_then(finite),
        iterations: None,
        gap: None,
        tangent_error_deg: None,
        straightness: None,
        parametrisation: Some(
            match o.parametrisation {
                Parametrisation::Grid => "grid",
                Parametrisation::HeightField(_) => "height_field",
                Parametrisation::Unrolled => "unrolled",
            }
            .to_owned(),
        ),
        before: Some(FairnessFigures::Surface((&o.before).into())),
        after: FairnessFigures::Surface((&o.after).into()),
    }
}

fn of_offsets(o: &offsets::Outcome) -> FairingDiagnostics {
    FairingDiagnostics {
        slips: o.slips.len(),
        ..of_surface(&o.surface)
    }
}

impl From<&curve::outcome::Fairness> for CurveFairness {
    fn from(f: &curve::outcome::Fairness) -> Self {
        CurveFairness {
            curvature_variation: f.curvature_variation,
            bending: f.bending,
            extrema: f.extrema,
            inflections: f.inflections,
            max_curvature: f.max_curvature,
            length: f.length,
        }
    }
}

impl From<&surface::outcome::Fairness> for SurfaceFairness {
    fn from(f: &surface::outcome::Fairness) -> Self {
        SurfaceFairness {
            energy: f.energy,
            gaussian_min: finite(f.gaussian_min),
            gaussian_max: finite(f.gaussian_max),
            mean_min: finite(f.mean_min),
            mean_max: finite(f.mean_max),
            isophote_roughness: finite(f.isophote_roughness),
        }
    }
}
