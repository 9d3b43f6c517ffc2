//! What the method takes.

use crate::geometry::BSplineSurface;
use nalgebra::Point3;

/// A strip and what is asked of it. Lengths in the unit of the strip.
#[derive(Debug, Clone, PartialEq)]
pub struct Request {
    /// The user's name for the strip.
    pub name: String,
    /// The shape to be rolled.
    pub input: Input,
    /// What is asked.
    pub options: Options,
}

/// A strip-like shape.
#[derive(Debug, Clone, PartialEq)]
pub enum Input {
    /// A mesh of triangles and quadrangles.
    Mesh {
        /// Corners of the faces.
        vertices: Vec<Point3<f64>>,
        /// Three or four indices a face.
        faces: Vec<Vec<usize>>,
    },
    /// A ruled surface of degree 1 in v, as a plate of `hull_plates` is.
    Ruled(BSplineSurface),
}

/// How many patches.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Goal {
    /// As few as keep every vertex within this distance, > 0.
    Tolerance(f64),
    /// So many, 1 to [`MOST_PIECES`].
    Pieces(usize),
    /// As many as the noise of the vertices lets one tell apart (Bayesian
    /// information criterion).
    Noise,
}

/// The most patches of one strip.
pub const MOST_PIECES: usize = 60;

/// What is made small.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Norm {
    /// The sum of squared distances, by area.
    LeastSquares,
    /// The sum of their eighth powers, by area: nearly the least largest
    /// distance, and as sharply determined as the least squares.
    EighthPowers,
    /// The largest distance of a vertex.
    Minimax,
}

/// Which algorithm fits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Solver {
    /// This crate's own.
    Own,
    /// The paper's, for comparison; needs [`Goal::Pieces`].
    Paper,
}

/// Which kinds of patches may be used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Classes {
    /// Cones of revolution.
    pub cones: bool,
    /// Cylinders of revolution.
    pub cylinders: bool,
    /// Planes.
    pub planes: bool,
}

impl Default for Classes {
    fn default() -> Self {
        Classes {
            cones: true,
            cylinders: true,
            planes: true,
        }
    }
}

/// What is asked of the patches. Lengths in the unit of the strip.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// How many patches.
    pub goal: Goal,
    /// What is made small. `None`: the largest distance for
    /// [`Goal::Tolerance`]; for [`Goal::Pieces`] eighth powers where the
    /// distances come from the shape; else the squares.
    pub norm: Option<Norm>,
    /// Which kinds of patches may be used.
    pub classes: Classes,
    /// Whether cones become cylinders, and both become planes, where the
    /// tolerance (else the error reached) allows it.
    pub simplify: bool,
    /// Whether vertices far off lose their hold on the shape (Tukey).
    pub robust: bool,
    /// Where a closed ring is to be cut: the ruling nearest to this point.
    pub cut: Option<Point3<f64>>,
    /// Plate thickness, > 0, for the strain of bending.
    pub thickness: Option<f64>,
    /// Least bend radius the yard can roll, > 0.
    pub min_bend_radius: Option<f64>,
    /// Which algorithm.
    pub solver: Solver,
}

impl Default for Options {
    fn default() -> Self {
        Options {
            goal: Goal::Noise,
            norm: None,
            classes: Classes::default(),
            simplify: false,
            robust: false,
            cut: None,
            thickness: None,
            min_bend_radius: None,
            solver: Solver::Own,
        }
    }
}
