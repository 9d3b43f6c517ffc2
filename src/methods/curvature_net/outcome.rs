//! What the method gives. Lengths in the unit of the request; nothing here
//! depends on time or thread count.

use super::Smooth;
use super::cyclide::Certificate;
use super::net::Net;
use super::structure::{Member, Offset, Strip, Support};
use crate::geometry::{BSplineSurface, CyclidePatch};

/// The surface, its net and what is built from them.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// Whether the borders are lines of curvature as asked, none of the net's
    /// patches has an umbilic, and the cyclide spline, its offsets and supports
    /// are there without a gap or a fold.
    pub within_limits: bool,
    /// Sentences, the verdict first.
    pub summary: Vec<String>,
    /// What the user should know about the input.
    pub warnings: Vec<String>,
    /// The longest side of the net's bounding box.
    pub model_size: f64,
    /// The smooth surface as one C¹ bicubic spline; a net that closes is cut
    /// at its first row or column.
    pub surface: BSplineSurface,
    /// The smooth surface with its figures.
    pub smooth: Smooth,
    /// Vertices and frames as delivered: of the cyclide spline where that was
    /// asked, else of the smooth surface.
    pub net: Net,
    /// The cyclide spline; none unless asked.
    pub cyclides: Option<Cyclides>,
}

/// The exact cyclide spline and what is built from it.
#[derive(Debug, Clone, PartialEq)]
pub struct Cyclides {
    /// Circular quads with mirrored frames.
    pub net: Net,
    /// One patch a quad, row after row; none where a side turns by half a turn
    /// or more, or two corners are one point.
    pub patches: Vec<Option<CyclidePatch>>,
    /// The proof of each patch.
    pub certificates: Vec<Option<Certificate>>,
    /// Figures of the whole.
    pub figures: CyclideFigures,
    /// Conical strips, line by line.
    pub strips: Vec<Strip>,
    /// Offsets in the order asked.
    pub offsets: Vec<Offset>,
    /// Supports on all lines; empty unless asked.
    pub supports: Vec<Support>,
    /// Every arc of the net.
    pub members: Vec<Member>,
}

/// Figures of a cyclide spline.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CyclideFigures {
    /// The largest residual of each kind, and the patch of the largest of all
    /// by row and column.
    pub worst: Certificate,
    /// Where the worst of them is.
    pub worst_patch: [usize; 2],
    /// Patches that could not be made.
    pub missing: usize,
    /// What carrying one frame through the net by mirrors would miss.
    pub closure: f64,
    /// The mean edge of the net.
    pub mean_edge: f64,
    /// Ways of the vertices from the smooth surface's.
    pub moved: Spread,
    /// Turns of the normals, radians.
    pub turned: Spread,
    /// Iterations of the solver.
    pub iterations: usize,
}

/// Mean and largest of a figure over the vertices.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Spread {
    /// Mean.
    pub mean: f64,
    /// Largest.
    pub max: f64,
    /// Row and column of the largest.
    pub at: [usize; 2],
}

impl Spread {
    /// Of one value a vertex of a net with so many columns.
    #[must_use]
    pub fn of(values: &[f64], columns: usize) -> Self {
        let mut spread = Spread::default();
        for (index, value) in values.iter().enumerate() {
            spread.mean += value / values.len() as f64;
            if *value > spread.max {
                spread.max = *value;
                spread.at = [index / columns, index % columns];
            }
        }
        spread
    }
}

impl CyclideFigures {
    /// Whether it is what it is called: every patch there, every residual at
    /// most [`PROOF`].
    #[must_use]
    pub fn is_proved(&self) -> bool {
        self.missing == 0 && self.worst.worst() <= PROOF && self.closure <= PROOF
    }
}

/// What a certificate may have left, radians or without unit.
pub const PROOF: f64 = 1e-9;
