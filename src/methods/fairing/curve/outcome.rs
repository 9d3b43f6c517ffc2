//! What the method gives. Lengths in the unit of the request; nothing here
//! depends on time or thread count.

use crate::geometry::BSplineCurve;
use nalgebra::{Point3, Vector3};

/// The fair curve, with the proof.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// The user's name.
    pub name: String,
    /// The curve, with clamped ends; a closed one ends where it begins.
    pub curve: BSplineCurve,
    /// Whether every point keeps its tolerance (true where none was given).
    pub within_limits: bool,
    /// What was done, in sentences; the first is the verdict.
    pub summary: Vec<String>,
    /// What the user should know about the input.
    pub warnings: Vec<String>,
    /// Whether the curve is closed.
    pub closed: bool,
    /// Order of the points along the curve: indices of the request.
    pub order: Vec<usize>,
    /// How the fit came about.
    pub report: Report,
    /// Every point, in the order of the request.
    pub moves: Vec<Move>,
    /// Figures of the moves.
    pub move_figures: MoveFigures,
    /// Suspected slips, the surest first.
    pub slips: Vec<Slip>,
    /// Fairness of the spline through the given points (or, where they are
    /// too many or too dense for one, through means of neighbours).
    pub before: Option<Fairness>,
    /// Fairness of the curve.
    pub after: Fairness,
    /// What other tolerances would give.
    pub trade_off: Vec<TradeOff>,
    /// The curvature along the curve, for combs.
    pub comb: Vec<CombTooth>,
}

/// How the fit came about.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// Number of control points and why that many.
    pub control_points: usize,
    /// `"asked"`, `"one a point"`, `"enough for the shape"`, `"the tolerance"`.
    pub control_points_from: &'static str,
    /// Degree.
    pub degree: usize,
    /// Estimated noise (standard deviation of one coordinate across the
    /// curve).
    pub noise: f64,
    /// Whether the points tell noise from shape; otherwise the figure above is
    /// the most that they could hide.
    pub noise_evident: bool,
    /// Effective number of parameters that the points determine.
    pub degrees_of_freedom: f64,
    /// Stiffness of the curve against springs of weight 1, in unit scale.
    pub stiffness: f64,
    /// Iterations of the solver that ended the fit.
    pub iterations: usize,
    /// Duality gap, as a share of the energy, where there were tolerances: no
    /// curve within them, with feet near these, is fairer by more.
    pub gap: Option<f64>,
    /// Largest angle between an end tangent and the one asked, degrees.
    pub tangent_error_deg: Option<f64>,
    /// Largest distance of a straight stretch from its chord.
    pub straightness: Option<f64>,
}

/// A point and what became of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Move {
    /// Index in the request.
    pub index: usize,
    /// As given.
    pub given: Point3<f64>,
    /// Where it is now, on the curve.
    pub now: Point3<f64>,
    /// Parameter of that place.
    pub parameter: f64,
    /// Distance between the two.
    pub distance: f64,
    /// Distance from the curve's nearest place: not more than `distance`.
    pub off_curve: f64,
    /// Its tolerance, where there is one.
    pub tolerance: Option<f64>,
    /// How much ∫ κ′² ds would fall per unit of more tolerance here: what
    /// this point holds the shape back. 0 where it has room.
    pub holds_back: f64,
}

/// Figures of all moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MoveFigures {
    /// Largest.
    pub max: f64,
    /// Index of the point that moved most.
    pub max_index: usize,
    /// Root mean square.
    pub rms: f64,
    /// Points that use more than 99.9 % of their tolerance.
    pub at_limit: usize,
    /// Points that moved by more than half of their tolerance.
    pub past_half: usize,
}

/// A point that does not fit its neighbours.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slip {
    /// Index in the request.
    pub index: usize,
    /// As given.
    pub given: Point3<f64>,
    /// Where the fair shape, fitted without it, would have it.
    pub expected: Point3<f64>,
    /// Distance between the two.
    pub off: f64,
    /// The same in standard deviations of the noise.
    pub deviations: f64,
    /// Probability that noise alone makes the worst of all points this bad.
    pub chance: f64,
    /// Whether the curve disregards it (`robust`).
    pub disregarded: bool,
}

/// How fair a curve is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fairness {
    /// ∫ κ′² ds, in space ∫ κ′² + κ²τ² ds; 1/length³. 0 on lines and circles.
    pub curvature_variation: f64,
    /// ∫ κ² ds, 1/length.
    pub bending: f64,
    /// Number of local extrema of the curvature.
    pub extrema: usize,
    /// Number of inflections (plane curves; 0 in space).
    pub inflections: usize,
    /// Largest |κ|, 1/length.
    pub max_curvature: f64,
    /// Length.
    pub length: f64,
}

/// What another tolerance would give.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TradeOff {
    /// The tolerance (of the point with the common one; others in proportion).
    pub tolerance: f64,
    /// Whether a curve within it was found.
    pub reached: bool,
    /// Largest move.
    pub max_move: f64,
    /// ∫ κ′² ds.
    pub curvature_variation: f64,
}

/// One tooth of the curvature comb.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CombTooth {
    /// Arc length from the start.
    pub s: f64,
    /// Parameter.
    pub u: f64,
    /// The point.
    pub point: Point3<f64>,
    /// Unit normal: to the left in the plane, towards the centre of curvature
    /// in space.
    pub normal: Vector3<f64>,
    /// Curvature, 1/length: signed in the plane.
    pub curvature: f64,
    /// Torsion, 1/length; 0 in the plane and where the curvature vanishes.
    pub torsion: f64,
}
