//! What the method gives. Lengths in the unit of the request, angles in
//! degrees; nothing here depends on time or thread count.

use crate::geometry::{BSplineCurve, BSplineSurface};
use nalgebra::Point3;

/// All plates of a hull, with the proof.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// Whether every plate keeps every limit that was asked.
    pub within_limits: bool,
    /// One sentence for the job, then one a plate.
    pub summary: Vec<String>,
    /// What the user should know about the input (merged points, …).
    pub warnings: Vec<String>,
    /// The longest side of the profiles' bounding box: the "model size".
    pub model_size: f64,
    /// The profiles as the plates use them: interpolated, moved where the
    /// boundary was free. One per profile of the request, in order.
    pub profiles: Vec<OutcomeProfile>,
    /// One per pair of neighbouring profiles, in order.
    pub plates: Vec<Plate>,
}

/// A profile after the fit.
#[derive(Debug, Clone, PartialEq)]
pub struct OutcomeProfile {
    /// The user's name.
    pub name: String,
    /// The curve that both neighbouring plates share.
    pub curve: BSplineCurve,
    /// How far it was moved.
    pub deviation: Deviation,
    /// Given points that moved by more than 1e-6 of the model size.
    pub moved_points: Vec<MovedPoint>,
}

/// Distance of given points and given curve to the delivered curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Deviation {
    /// Largest distance of a given point.
    pub points_max: f64,
    /// Largest distance anywhere along the given curve.
    pub curve_max: f64,
    /// Mean distance along the given curve.
    pub curve_mean: f64,
    /// Root mean square along the given curve.
    pub curve_rms: f64,
}

/// A given point and the place on the delivered curve nearest to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MovedPoint {
    /// Index in the request's list of points (before any merging).
    pub index: usize,
    /// As given.
    pub given: Point3<f64>,
    /// Where the curve now passes.
    pub now: Point3<f64>,
    /// The distance between the two.
    pub distance: f64,
}

/// One plate.
#[derive(Debug, Clone, PartialEq)]
pub struct Plate {
    /// `"first name – second name"`.
    pub name: String,
    /// Degree `[3, 1]`, `v = 0` on the first profile, `v = 1` on the second.
    pub surface: BSplineSurface,
    /// Whether this plate keeps every limit.
    pub within_limits: bool,
    /// One sentence with the reason.
    pub sentence: String,
    /// Rulings for tables and pictures, from one end of the plate to the
    /// other, ends and fan joins included; the mesh uses exactly these.
    pub rulings: Vec<Ruling>,
    /// Fans at the ends, if any (at most one an end).
    pub fans: Vec<Fan>,
    /// Extensions past the profiles' ends (`Ends::Extend`), four lengths:
    /// first profile start, first end, second start, second end.
    pub extensions: [f64; 4],
    /// All the figures.
    pub diagnostics: PlateDiagnostics,
}

/// One ruling of a plate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ruling {
    /// Surface parameter.
    pub u: f64,
    /// End on the first profile.
    pub from: Point3<f64>,
    /// End on the second profile.
    pub to: Point3<f64>,
    /// Angle between the surface normals at the two ends, signed, degrees.
    pub twist_deg: f64,
    /// Bend radius across the ruling at its first end; infinite where flat;
    /// the sign tells the side.
    pub bend_radius_from: f64,
    /// The same at its second end.
    pub bend_radius_to: f64,
}

/// A fan: an exact cone with its apex in a corner of the plate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fan {
    /// At the start (`u = 0`) or at the end (`u = 1`) of the plate.
    pub at_start: bool,
    /// Whether the apex is the corner of the first profile (it then sweeps the
    /// second) or of the second.
    pub apex_on_first: bool,
    /// Share of the swept curve's length, percent.
    pub swept_percent: f64,
    /// Surface parameters between which the fan lies.
    pub u_range: [f64; 2],
}

/// How a plate's iteration ended: the solver's closed list, as a word.
#[derive(Debug, Clone, PartialEq)]
pub struct Termination {
    /// Iterations of the least-squares solver, all stages together.
    pub iterations: usize,
    /// Why the last stage stopped.
    pub reason: &'static str,
}

/// Figures of one plate, all measured on the delivered surface.
#[derive(Debug, Clone, PartialEq)]
pub struct PlateDiagnostics {
    /// Largest |twist|, degrees.
    pub twist_max_deg: f64,
    /// Where: surface parameter.
    pub twist_max_u: f64,
    /// Where: the middle of that ruling.
    pub twist_max_at: Point3<f64>,
    /// Mean |twist| weighted by area.
    pub twist_mean_deg: f64,
    /// 95 % of the area has less.
    pub twist_p95_deg: f64,
    /// |Twist| of the straight ruling between the two start corners, and the
    /// two end corners: why corner to corner cannot pass.
    pub corner_warp_deg: [f64; 2],
    /// The bounded discrete optimum: no set of rulings between nodes of the
    /// grid, within the same bounds, has a smaller largest twist. For the
    /// profiles as given.
    pub bottleneck_deg: f64,
    /// Grid nodes per curve behind `bottleneck_deg`.
    pub bottleneck_grid: usize,
    /// Distance of the regression curve from the plate outside its fans, in
    /// ruling lengths.
    pub regression_clearance: f64,
    /// Pairs of neighbouring rulings that cross (must be 0).
    pub crossing_rulings: usize,
    /// Least bend radius across the rulings, outside the fans.
    pub min_bend_radius: f64,
    /// Where: the ruling's surface parameter.
    pub min_bend_radius_u: f64,
    /// Outer-fibre strain thickness / (2 R), percent, when a thickness is given.
    pub bend_strain_percent: Option<f64>,
    /// Share of the first and second curve swept by fans, percent.
    pub fan_percent: [f64; 2],
    /// Largest extension past an end, percent of the model size.
    pub extension_percent: f64,
    /// Membrane strain θ²/8 of the worst ruling, percent.
    pub membrane_strain_percent: f64,
    /// Largest |Gaussian curvature| on the plate outside its fans, 1/length².
    pub gaussian_curvature_max: f64,
    /// Plate area.
    pub area: f64,
    /// Rulings pinned by the user: largest distance of a pinned end from the
    /// delivered ruling's end.
    pub pinned_deviation: Option<f64>,
    /// How the iteration ended.
    pub termination: Termination,
}
