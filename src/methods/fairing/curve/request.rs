//! What the method takes.

use nalgebra::{Point3, Vector3};

/// Points of a curve and what is asked of it. Lengths in the unit of the
/// points.
#[derive(Debug, Clone, PartialEq)]
pub struct Request {
    /// The user's name for the curve.
    pub name: String,
    /// Points; with dimension 2 their z is not looked at and answered as 0.
    pub points: Vec<Point3<f64>>,
    /// 2 or 3.
    pub dimension: usize,
    /// Whether the points come in their order along the curve.
    pub ordered: bool,
    /// Whether the curve is closed. `None`: ordered points are open unless the
    /// last repeats the first; unordered ones are looked at.
    pub closed: Option<bool>,
    /// What is asked.
    pub options: Options,
}

/// Which algorithm fits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Solver {
    /// This crate's own: the fairest curve within the tolerances, or, without
    /// any, the stiffest that the noise of the points allows.
    #[default]
    Own,
    /// The paper's: a cubic with one spring stiffness for all points, raised
    /// or lowered until the largest move is the tolerance.
    Paper,
}

/// Weights of the paper's energy ∫ α|r′|² + β|r″|² + γ|r‴|² du over the chord
/// length u, curve scaled to unit size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EnergyWeights {
    /// α ≥ 0: resistance to stretching.
    pub tension: f64,
    /// β ≥ 0: resistance to bending.
    pub bending: f64,
    /// γ ≥ 0: resistance to change of bending.
    pub jerk: f64,
}

/// What is asked of the curve.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// The most that any point may move, ≥ 0; 0: the curve passes through the
    /// points. `None` (and no `tolerances`): the moves follow from the noise
    /// of the points.
    pub tolerance: Option<f64>,
    /// A tolerance for each point, in place of the common one: empty, or one
    /// per point.
    pub tolerances: Vec<f64>,
    /// How much each point counts against the others, > 0, 1 by default:
    /// empty, or one per point.
    pub stiffness: Vec<f64>,
    /// Points that must stay where they are.
    pub locked: Vec<usize>,
    /// The axes x, y, z along which points may move; all by default.
    pub freedom: [bool; 3],
    /// Tangent at the start and at the end, of any length.
    pub end_tangents: [Option<Vector3<f64>>; 2],
    /// Curvature at the start and at the end, 1/length; in the plane positive
    /// to the left.
    pub end_curvatures: [Option<f64>; 2],
    /// Points where the curve may have a corner.
    pub knuckles: Vec<usize>,
    /// Stretches that must be straight, from point to point.
    pub straight: Vec<[usize; 2]>,
    /// The paper's energy in place of ∫ κ′² ds.
    pub energy: Option<EnergyWeights>,
    /// Degree of the spline, 3 to 7. `None`: 5, or 3 for the paper's solver.
    pub degree: Option<usize>,
    /// Number of control points. `None`: from the points.
    pub control_points: Option<usize>,
    /// Whether suspected slips lose their hold on the curve.
    pub robust: bool,
    /// Which algorithm.
    pub solver: Solver,
}

impl Default for Options {
    fn default() -> Self {
        Options {
            tolerance: None,
            tolerances: Vec::new(),
            stiffness: Vec::new(),
            locked: Vec::new(),
            freedom: [true; 3],
            end_tangents: [None; 2],
            end_curvatures: [None; 2],
            knuckles: Vec::new(),
            straight: Vec::new(),
            energy: None,
            degree: None,
            control_points: None,
            robust: false,
            solver: Solver::Own,
        }
    }
}

impl Request {
    /// Ordered points of a plane or space curve, nothing else asked.
    #[must_use]
    pub fn through(points: Vec<Point3<f64>>, dimension: usize) -> Self {
        Request {
            name: String::new(),
            points,
            dimension,
            ordered: true,
            closed: None,
            options: Options::default(),
        }
    }
}
