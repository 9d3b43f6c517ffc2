//! Stage 3: what is built from a cyclide spline.
//!
//! # Conical strips
//! Along a circular line of curvature the tangent planes envelope a cone of
//! revolution (or a cylinder, or a plane); its rulings are the tangents across
//! the line, its apex lies 1/κ_g away, κ_g being the line's geodesic curvature.
//! Consecutive cones share a ruling and the tangent plane there. The cones
//! along two neighbouring lines meet in a conic, where the tangents at the two
//! ends of the arcs between them meet ([`CyclidePatch::tangents_meet`]); there
//! a strip ends. Each strip reaches from its line to those conics, or to the
//! line itself at the border of the net.
//!
//! # Supports
//! The normals along a line of curvature are a developable too, with the
//! normal curvature κ_n in the place of κ_g. Two supports that cross do so in
//! a common straight line, the normal of a vertex: the nodes have no torsion.
//!
//! # Flat patterns
//! On either surface a line has constant geodesic curvature from vertex to
//! vertex, so that it unrolls into arcs, and the rulings into their normals
//! ([`flat`]): no approximation, no numerical development.
//!
//! [`CyclidePatch::tangents_meet`]: crate::geometry::CyclidePatch::tangents_meet

mod bill;
pub mod flat;
mod line;
mod offsets;
mod strips;
mod supports;
#[cfg(test)]
mod tests;

pub use bill::{Member, bill};
pub use flat::Sheet;
pub use offsets::{Offset, offset};
pub use strips::{Cone, ConeKind, Strip, strips};
pub use supports::{Support, supports};
