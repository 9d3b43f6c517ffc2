//! B-spline curves and tensor-product surfaces, polynomial or rational.
//!
//! Conventions: a knot vector has all multiplicities written out and clamped
//! ends (the first and the last knot `degree + 1` times), so that a curve
//! begins and ends in its first and last control point. Inner knots occur at
//! most `degree` times: every curve is continuous. Parameters outside the
//! domain are moved to its nearer end, never extrapolated.
//!
//! Curves and surfaces are evaluated by de Boor's triangle (module `deboor`):
//! derivatives come from differences of control points, so that a run of equal
//! control points has derivatives that are exactly zero, as the apex of a cone
//! needs. Methods that ask at very many parameters take [`BasisTable`].
//!
//! Sources: de Boor, *A Practical Guide to Splines* (1978); Piegl & Tiller,
//! *The NURBS Book* (2nd ed. 1997), cited by algorithm number.

mod basis;
mod curve;
mod curve_forms;
mod deboor;
mod error;
mod gram;
mod interpolate;
mod join;
mod kinks;
mod knots;
mod pieces;
mod refine;
mod rows;
mod surface;
mod surface_curves;
mod surface_forms;

pub use basis::{BasisJet, basis_jet};
pub use curve::{BSplineCurve, CurveJet};
pub use error::SplineError;
pub use gram::gram;
pub use interpolate::{
    Parametrization, complete_cubic, interpolate, interpolate_at, interpolation_parameters,
};
pub use join::join_c0;
pub use knots::{Knots, MAX_DEGREE};
pub use pieces::{BasisTable, Pieces};
pub use rows::surface_from_rows;
pub use surface::{Axis, BSplineSurface, SurfaceJet};
pub use surface_forms::interpolate_grid;
