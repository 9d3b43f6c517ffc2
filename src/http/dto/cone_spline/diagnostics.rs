//! The figures of `cone_spline` on the wire.

use super::super::curves::Point;
use crate::methods::cone_spline::outcome::{Distance, Floor, Outcome};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// All figures, measured on the patches that are returned.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ConeSplineDiagnostics {
    /// The longest side of the strip's bounding box.
    pub model_size: f64,
    /// Number of patches.
    pub patches: usize,
    /// From the vertices of the strip to the patches.
    pub to_surface: ConeDistance,
    /// From the patches to the strip's triangles.
    pub to_mesh: ConeDistance,
    /// The best developable surface found, which more patches can hardly beat.
    pub floor: ConeFloor,
    /// False: the tolerance lies below what patches can reach.
    pub reachable: bool,
    /// Largest angle between neighbouring patches along their ruling, degrees.
    pub join_angle_deg: f64,
    /// Largest distance of a common ruling from its patches.
    pub join_gap: f64,
    /// `asked`, `the tolerance` or `the noise`: where the number of patches
    /// comes from.
    pub pieces_from: String,
    /// `least_squares`, `eighth_powers` or `minimax`: what was made small.
    pub norm: String,
    /// Standard deviation of the vertices across the surface, where the number
    /// of patches follows from it; else null.
    pub noise: Option<f64>,
    /// Vertices that lost their hold on the shape (`robust`).
    pub outliers: Vec<usize>,
    /// Iterations of the solver, all stages together.
    pub iterations: usize,
    /// Why the last stage stopped.
    pub termination: String,
}

/// Figures of a distance.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ConeDistance {
    /// Largest.
    pub max: f64,
    /// Where the largest begins.
    pub at: Point,
    /// The vertex there; null where it does not begin at one.
    pub vertex: Option<usize>,
    /// Mean, by area.
    pub mean: f64,
    /// Root mean square, by area.
    pub rms: f64,
}

/// The best developable surface found for the strip.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ConeFloor {
    /// Largest distance of a vertex.
    pub max: f64,
    /// Mean distance, by area.
    pub mean: f64,
    /// Root mean square, by area.
    pub rms: f64,
    /// Patches of the fine chain behind it.
    pub patches: usize,
}

impl From<&Outcome> for ConeSplineDiagnostics {
    fn from(o: &Outcome) -> Self {
        ConeSplineDiagnostics {
            model_size: o.model_size,
            patches: o.patches.len(),
            to_surface: (&o.to_surface).into(),
            to_mesh: (&o.to_mesh).into(),
            floor: (&o.floor).into(),
            reachable: o.reachable,
            join_angle_deg: o.joins.iter().fold(0.0, |m, j| j.angle_deg.max(m)),
            join_gap: o.joins.iter().fold(0.0, |m, j| j.gap.max(m)),
            pieces_from: o.report.pieces_from.to_owned(),
            norm: o.report.norm.to_owned(),
            noise: o.report.noise,
            outliers: o.report.outliers.clone(),
            iterations: o.report.iterations,
            termination: o.report.termination.to_owned(),
        }
    }
}

impl From<&Distance> for ConeDistance {
    fn from(d: &Distance) -> Self {
        ConeDistance {
            max: d.max,
            at: d.at.into(),
            vertex: d.vertex,
            mean: d.mean,
            rms: d.rms,
        }
    }
}

impl From<&Floor> for ConeFloor {
    fn from(f: &Floor) -> Self {
        ConeFloor {
            max: f.max,
            mean: f.mean,
            rms: f.rms,
            patches: f.patches,
        }
    }
}
