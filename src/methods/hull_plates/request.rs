//! What the method takes.

use crate::geometry::BSplineCurve;
use nalgebra::Point3;

/// A hull's profiles, neighbours bounding one plate each, and what is asked.
#[derive(Debug, Clone, PartialEq)]
pub struct Request {
    /// At least two curves, all in the same direction; plate `i` lies between
    /// profile `i` and `i + 1`.
    pub profiles: Vec<Profile>,
    /// What is asked of the plates.
    pub options: Options,
}

/// One profile curve (deck edge, chine, keel).
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    /// The user's name for it.
    pub name: String,
    /// Its shape.
    pub shape: ProfileShape,
}

/// A profile as offsets or as a spline.
#[derive(Debug, Clone, PartialEq)]
pub enum ProfileShape {
    /// Points that a cubic B-spline with chord-length parameters and averaged
    /// knots interpolates (Zheng & Bo 2018, eqs. 1 and 2).
    Points(Vec<Point3<f64>>),
    /// The curve itself.
    BSpline(BSplineCurve),
}

/// How far the plates' boundaries may leave the profiles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Boundary {
    /// Not at all (1e-6 of the model's longest side).
    Exact,
    /// By at most this length, everywhere.
    Tolerance(f64),
    /// Not at all where the twist limit can be met so, else by the least
    /// length that meets it.
    Auto,
}

/// How a plate reaches its four corners when its end rulings do not.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ends {
    /// A cone with its apex in the corner covers the rest exactly.
    Fan,
    /// The curves run on past their ends, to be trimmed.
    Extend,
}

/// Which algorithm fits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Solver {
    /// This crate's own.
    Own,
    /// The paper's L-BFGS formulation, for comparison.
    Paper,
}

/// A ruling that the user prescribes on one plate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PinnedRuling {
    /// Plate index, 0-based.
    pub plate: usize,
    /// A point on (or very near) the plate's first profile.
    pub from: Point3<f64>,
    /// A point on (or very near) the plate's second profile.
    pub to: Point3<f64>,
}

/// What is asked of the plates. Lengths in the unit of the profiles.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// Freedom of the boundaries.
    pub boundary: Boundary,
    /// The largest twist a plate may have, degrees, in (0, 45].
    pub max_twist_deg: f64,
    /// Plate thickness, > 0.
    pub thickness: Option<f64>,
    /// Least bend radius the yard can roll, > 0.
    pub min_bend_radius: Option<f64>,
    /// Rulings that must be there.
    pub pinned_rulings: Vec<PinnedRuling>,
    /// How corners are reached.
    pub ends: Ends,
    /// Share of a curve that an end fan may sweep, percent, in [0, 50].
    pub max_fan_percent: f64,
    /// How far a curve may be extended, percent of the model's longest side,
    /// in [0, 20].
    pub max_extension_percent: f64,
    /// Least distance of the regression curve from the plate, in ruling
    /// lengths, as percent, in [1, 50]. `None`: 100/7 where boundaries stay
    /// (speeds of a ruling's two ends within 1/8..8), 5 where they move by a
    /// tolerance, given or found by `auto` (1/21..21).
    pub min_clearance_percent: Option<f64>,
    /// Which algorithm.
    pub solver: Solver,
}

impl Options {
    /// The clearance asked for where boundaries stay, or where they may move;
    /// percent of a ruling's length.
    #[must_use]
    pub fn clearance_percent(&self, may_move: bool) -> f64 {
        let usual = if may_move { 5.0 } else { 100.0 / 7.0 };
        self.min_clearance_percent.unwrap_or(usual)
    }
}

impl Default for Options {
    fn default() -> Self {
        Options {
            boundary: Boundary::Auto,
            max_twist_deg: 6.0,
            thickness: None,
            min_bend_radius: None,
            pinned_rulings: Vec::new(),
            ends: Ends::Fan,
            max_fan_percent: 20.0,
            max_extension_percent: 6.0,
            min_clearance_percent: None,
            solver: Solver::Own,
        }
    }
}
