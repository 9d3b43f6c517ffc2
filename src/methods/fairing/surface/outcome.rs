//! What the method gives. Lengths in the unit of the request, angles in
//! degrees; nothing here depends on time or thread count.

use crate::geometry::BSplineSurface;
use nalgebra::{Point3, Vector3};

/// The fair surface, with the proof.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// Whether no point moves farther than its tolerance (true where none was
    /// asked).
    pub within_tolerance: bool,
    /// Sentences for people, the verdict first.
    pub summary: Vec<String>,
    /// What the user should know about the input.
    pub warnings: Vec<String>,
    /// The surface.
    pub surface: BSplineSurface,
    /// Where the data are: beyond, the surface is only the continuation that
    /// costs least energy.
    pub outline: Outline,
    /// How parameters were found.
    pub parametrisation: Parametrisation,
    /// One a measured point, in the order of the request.
    pub moves: Vec<Move>,
    /// Largest distance.
    pub move_max: f64,
    /// Root mean square distance.
    pub move_rms: f64,
    /// Standard deviation of the points' noise across the surface, estimated
    /// from the points alone.
    pub noise: f64,
    /// λ: weight of the energy against springs of stiffness 1 (lengths in
    /// units of the longest side); the paper's K is its reciprocal. `None`
    /// where a hard tolerance takes its place.
    pub stiffness: Option<f64>,
    /// Points that look like mistakes; none is left out unless `robust` was
    /// asked.
    pub slips: Vec<Slip>,
    /// Points that hold the surface at their tolerance, strongest first.
    pub active: Vec<Active>,
    /// Of the surface that follows the points as nearly as its control points
    /// can.
    pub before: Fairness,
    /// Of the delivered surface.
    pub after: Fairness,
    /// What other stiffnesses would give, stiffest springs first.
    pub trade_off: Vec<TradeOff>,
    /// Data for an isophote plot of the delivered surface.
    pub isophotes: Isophotes,
}

/// How the parameters of the points were found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Parametrisation {
    /// From the rows and columns of the grid.
    Grid,
    /// The sheet is a height field along this unit vector.
    HeightField(Vector3<f64>),
    /// A folded sheet, unrolled along its geodesics.
    Unrolled,
}

/// The trimmed region in (u, v).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Outline {
    /// Closed polyline, anticlockwise, first point not repeated.
    pub outer: Vec<[f64; 2]>,
    /// Closed polylines, clockwise.
    pub holes: Vec<Vec<[f64; 2]>>,
}

/// A measured point and its place on the surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Move {
    /// Index in the request.
    pub index: usize,
    /// Where the surface now passes.
    pub now: Point3<f64>,
    /// Its parameters.
    pub at: [f64; 2],
    /// Distance, positive where the point lies on the side of u × v.
    pub distance: f64,
}

/// A point that looks like a mistake.
#[derive(Debug, Clone, PartialEq)]
pub struct Slip {
    /// Index in the request.
    pub index: usize,
    /// Row and column, for grids.
    pub cell: Option<[usize; 2]>,
    /// As given.
    pub given: Point3<f64>,
    /// Where the fair surface passes that was fitted without the point.
    pub expected: Point3<f64>,
    /// Distance between the two.
    pub off: f64,
    /// The same in standard deviations of the noise.
    pub sigmas: f64,
    /// Probability that noise alone would not do this anywhere in the data.
    pub confidence: f64,
}

/// A point at its tolerance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Active {
    /// Index in the request.
    pub index: usize,
    /// Share of all the pull on the surface, percent, with the sign of
    /// the side to which it pulls.
    pub pull_percent: f64,
}

/// Fairness figures over the trimmed region.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fairness {
    /// The energy that was minimised (over the whole net, lengths in units of
    /// the longest side).
    pub energy: f64,
    /// Least and largest Gaussian curvature, 1/length².
    pub gaussian_min: f64,
    /// Largest Gaussian curvature.
    pub gaussian_max: f64,
    /// Least mean curvature, 1/length; the sign depends on u × v.
    pub mean_min: f64,
    /// Largest mean curvature.
    pub mean_max: f64,
    /// Root mean square of the second derivative of n·l by arc length along
    /// both families of parameter lines (n unit normal, l direction of the
    /// light), 1/length²: how much the isophotes wave.
    pub isophote_roughness: f64,
}

/// One line of the trade-off table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TradeOff {
    /// λ as in [`Outcome::stiffness`].
    pub stiffness: f64,
    /// Largest move.
    pub move_max: f64,
    /// Root mean square move.
    pub move_rms: f64,
    /// Energy as in [`Fairness::energy`].
    pub energy: f64,
}

/// n·l on a grid of parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Isophotes {
    /// Unit vector to the light.
    pub light: Vector3<f64>,
    /// Parameters of the samples in u.
    pub u: Vec<f64>,
    /// Parameters of the samples in v.
    pub v: Vec<f64>,
    /// n·l, v fastest; `None` outside the outline.
    pub values: Vec<Option<f64>>,
}
