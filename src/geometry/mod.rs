//! Curves and surfaces: B-splines, ruled surfaces, meshes, distances. Knows numerics,
//! nothing above.

mod arc_length;
mod bounding_box;
pub mod bspline;
mod circular_arc;
mod closest;
pub mod cone;
#[cfg(test)]
pub(crate) mod conformance;
mod convex;
mod distance;
mod dupin_cyclide;
pub mod mesh;
mod ruled;
mod tolerance;

pub use arc_length::ArcLength;
pub use bounding_box::BoundingBox;
pub use bspline::{
    Axis, BSplineCurve, BSplineSurface, BasisJet, CurveJet, Knots, MAX_DEGREE, Parametrization,
    SplineError, SurfaceJet, basis_jet, complete_cubic, gram, interpolate, interpolate_at,
    interpolate_grid, interpolation_parameters, join_c0,
};
pub use circular_arc::CircularArc;
pub use closest::{Closest, CurveIndex};
pub use convex::convex_overlap;
pub use distance::{CurveDistance, directed_distance, directed_distance_between};
pub use dupin_cyclide::{CyclideCorner, CyclideError, CyclidePatch};
pub use mesh::{Face, Manifold, Mesh, MeshError, MeshFault, Topology};
pub use ruled::{FundamentalForms, RuledSurface, RulingJet};
pub use tolerance::Tolerance;
