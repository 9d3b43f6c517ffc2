//! Minimisation on plain vectors. Knows numerics, not geometry.
//!
//! * [`levenberg_marquardt::minimize`]: nonlinear least squares on blocks of
//!   residuals. Every method of this crate ends here; what differs from method
//!   to method is the residual blocks.
//! * [`lbfgs::minimize`]: limited-memory quasi-Newton for the formulations of
//!   the papers, kept as references.
//! * [`derivative_check`]: compares an analytic Jacobian with differences.
//!
//! A run is described by three types: settings go in, the state lives inside,
//! a report comes out. Not converging is a report, not an error.

mod blocks;
mod control;
pub mod derivative_check;
pub mod lbfgs;
pub mod levenberg_marquardt;
mod normal;

pub use blocks::Blocks;
pub use control::{Control, Stop, Unwatched};
pub use normal::NormalEquations;

/// A nonlinear least-squares problem, ½ Σ rᵢ(x)², given by blocks.
pub trait LeastSquares {
    /// Number of unknowns.
    fn dimension(&self) -> usize;

    /// Pushes every residual block at `x`, in the same order on every call;
    /// the Jacobian only where [`Blocks::wants_jacobian`]. A point outside the
    /// domain is told by a residual that is not finite: the step is refused.
    fn evaluate(&self, x: &[f64], blocks: &mut Blocks);
}

/// Why a minimisation ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Termination {
    /// The gradient is as small as asked.
    SmallGradient,
    /// The step is small against the unknowns.
    SmallStep,
    /// The cost no longer falls.
    SmallReduction,
    /// The iteration limit was reached.
    IterationLimit,
    /// No damping gives a step that lowers the cost.
    Stalled,
    /// The start has a cost or gradient that is not finite.
    BadStart,
}

impl Termination {
    /// A stable word for reports.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Termination::SmallGradient => "small-gradient",
            Termination::SmallStep => "small-step",
            Termination::SmallReduction => "small-reduction",
            Termination::IterationLimit => "iteration-limit",
            Termination::Stalled => "stalled",
            Termination::BadStart => "bad-start",
        }
    }

    /// Whether a local minimum was reached to the accuracy asked.
    #[must_use]
    pub fn converged(self) -> bool {
        matches!(
            self,
            Termination::SmallGradient | Termination::SmallStep | Termination::SmallReduction
        )
    }
}

/// What a minimisation did.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Report {
    /// Why it ended.
    pub termination: Termination,
    /// Accepted and refused steps together.
    pub iterations: usize,
    /// Evaluations of residuals or of the objective.
    pub evaluations: usize,
    /// Cost at the start.
    pub initial_cost: f64,
    /// Cost at the end.
    pub cost: f64,
    /// Largest gradient component at the end.
    pub gradient: f64,
}
