//! Curves and surfaces: B-splines, ruled surfaces, distances. Knows numerics,
//! nothing above.

mod bspline;

pub use bspline::{BSplineCurve, BSplineSurface, SplineError};
