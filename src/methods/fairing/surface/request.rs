//! What the method takes.

use nalgebra::{Point3, Vector3};

/// Measured points of a sheet and what is asked of the surface through them.
#[derive(Debug, Clone, PartialEq)]
pub struct Request {
    /// The points.
    pub points: Points,
    /// What is asked.
    pub options: Options,
}

/// The points of a sheet.
#[derive(Debug, Clone, PartialEq)]
pub enum Points {
    /// Rows of points, neighbours in the table neighbours on the sheet;
    /// `None` where a cell was not measured. Point (r, c) has the index
    /// `r · columns + c`.
    Grid(Vec<Vec<Option<Point3<f64>>>>),
    /// Points in any order; the method finds their parameters.
    Scattered(Vec<Point3<f64>>),
}

/// How far points may move, in their own unit.
#[derive(Debug, Clone, PartialEq)]
pub enum Tolerance {
    /// The same for all, > 0.
    Same(f64),
    /// One a point, > 0, in the order of their indices (missing cells of a
    /// grid included, their value is not looked at).
    Each(Vec<f64>),
}

/// Which algorithm fits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Solver {
    /// This crate's own.
    Own,
    /// The paper's: bicubic, uniform knots, one spring stiffness that is
    /// raised and lowered until the largest move is the tolerance.
    Paper,
}

/// Weights of the paper's energy (eq. 2), all ≥ 0, for parameters that run
/// from 0 to 1 in both directions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EnergyWeights {
    /// |r_u|²
    pub alpha11: f64,
    /// |r_v|²
    pub alpha22: f64,
    /// |r_uu|²
    pub beta11: f64,
    /// |r_uv|²
    pub beta12: f64,
    /// |r_vv|²
    pub beta22: f64,
}

/// What is asked of the surface.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// No point moves farther than this. `None`: as far as its noise, which
    /// is estimated from the points.
    pub tolerance: Option<Tolerance>,
    /// Relative spring stiffness a point, > 0 (default 1).
    pub stiffness: Option<Vec<f64>>,
    /// Indices of points through which the surface passes.
    pub locked: Vec<usize>,
    /// Axes (x, y, z) along which points may move, at least one. Scattered
    /// points with one free axis are a field along that axis.
    pub freedom: [bool; 3],
    /// The energy; `None`: the one that weighs the change of curvature (order
    /// 3 or 4, its stretch along v chosen from the data). Of a folded sheet it
    /// is that of the height across its coarse base.
    pub energy: Option<EnergyWeights>,
    /// Springs of points on a grid's border are stiffer by this factor (1 by
    /// default, 100 by default for [`Solver::Paper`]); > 0.
    pub boundary_factor: Option<f64>,
    /// Number of control points in u and v; `None`: chosen from the data.
    pub control_points: Option<[usize; 2]>,
    /// Rows and columns of a grid (not the first or last) across which the
    /// sheet may have a knuckle.
    pub knuckles: [Vec<usize>; 2],
    /// A place near which a sheet of scattered points that closes all round (a
    /// tube) is cut along its axis; without it such a sheet is refused.
    pub cut: Option<Point3<f64>>,
    /// Gross errors lose their pull instead of bending the surface.
    pub robust: bool,
    /// Which algorithm.
    pub solver: Solver,
    /// Direction of the light for isophotes, any length but zero.
    pub light: Vector3<f64>,
}

impl Default for Options {
    fn default() -> Self {
        Options {
            tolerance: None,
            stiffness: None,
            locked: Vec::new(),
            freedom: [true; 3],
            energy: None,
            boundary_factor: None,
            control_points: None,
            knuckles: [Vec::new(), Vec::new()],
            cut: None,
            robust: false,
            solver: Solver::Own,
            light: Vector3::new(0.5, 0.5, std::f64::consts::FRAC_1_SQRT_2),
        }
    }
}
