//! What the method takes.

use crate::geometry::BSplineSurface;
use nalgebra::Point3;

/// A coarse net and what is asked of the surface near it.
#[derive(Debug, Clone, PartialEq)]
pub struct Request {
    /// The net to start from.
    pub input: Input,
    /// What is asked.
    pub options: Options,
}

/// A net of quads, each inner vertex with four neighbours.
#[derive(Debug, Clone, PartialEq)]
pub enum Input {
    /// Vertices and faces in any order; rows and columns are found.
    Mesh(QuadMesh),
    /// Points in rows and columns.
    Grid(Grid),
}

/// Faces by the indices of their vertices, 0-based.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct QuadMesh {
    /// The vertices.
    pub vertices: Vec<Point3<f64>>,
    /// The corners of each face in order round it.
    pub faces: Vec<Vec<usize>>,
}

/// Rows of points.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// Number of rows, ≥ 2; ≥ 3 where rows close.
    pub rows: usize,
    /// Number of points in a row, ≥ 2; ≥ 3 where columns close.
    pub columns: usize,
    /// Whether the last row is followed by the first, and the last point of a
    /// row by its first. The first is not repeated.
    pub closed: [bool; 2],
    /// `rows × columns` points, row after row.
    pub points: Vec<Point3<f64>>,
}

/// A surface that the net keeps close to instead of the start.
#[derive(Debug, Clone, PartialEq)]
pub enum Target {
    /// A mesh of polygons.
    Mesh(QuadMesh),
    /// A spline.
    BSpline(Box<BSplineSurface>),
}

/// A direction of the net.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// From row to row.
    U,
    /// Along a row.
    V,
}

/// Which algorithm fits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Solver {
    /// This crate's own.
    Own,
    /// The paper's Bézier patches, for comparison.
    Paper,
}

/// What goes first where a net cannot both keep its shape and be without
/// umbilics.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Umbilics {
    /// That it has none: the shape goes as far as it must.
    Avoid,
    /// The shape: umbilics stay where the curvatures of the start pass each
    /// other.
    KeepShape,
}

/// Strips that stand on the lines of the net along the normals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Supports {
    /// Their height along the normal, not 0; negative: against it.
    pub height: f64,
}

/// What is asked of the surface. Lengths in the unit of the input.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// How often each patch is split in four. `None`: until there are
    /// [`USUAL_PATCHES`].
    pub levels: Option<usize>,
    /// How strongly the net is held, relative to the usual, in [1e-3, 1e3].
    pub closeness: f64,
    /// What goes first, the shape or that there are no umbilics.
    pub umbilics: Umbilics,
    /// What it is held to; `None`: the start.
    pub target: Option<Target>,
    /// Whether an exact cyclide spline is asked.
    pub cyclide: bool,
    /// Directions along which conical strips are asked; needs `cyclide`.
    pub strips: Vec<Direction>,
    /// Distances of offsets along the normal, none 0; needs `cyclide`.
    pub offsets: Vec<f64>,
    /// The support structure; needs `cyclide`.
    pub supports: Option<Supports>,
    /// Which algorithm.
    pub solver: Solver,
}

/// The number of patches that is usually fine enough: 16 × 16.
pub const USUAL_PATCHES: usize = 256;

impl Default for Options {
    fn default() -> Self {
        Options {
            levels: None,
            closeness: 1.0,
            umbilics: Umbilics::Avoid,
            target: None,
            cyclide: true,
            strips: Vec::new(),
            offsets: Vec::new(),
            supports: None,
            solver: Solver::Own,
        }
    }
}
