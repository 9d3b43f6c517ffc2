//! A strip as few cones of revolution, cylinders and planes, joined with one
//! tangent plane.
//!
//! # The job
//! A plate roll makes cones and cylinders. Given a strip (a mesh or a ruled
//! surface), find the fewest patches that stay within a tolerance of it, joined
//! G¹, and all that a workshop needs to roll them.
//!
//! # Formulas
//! A frame travels along the strip: point p, ruling r, normal n, t = n × r, with
//! constant strain (g, k) on each patch:
//!
//! p′ = t, r′ = g t, t′ = −g r + k n, n′ = −k t.
//!
//! The rulings p + λ r then sweep a cone of revolution; with g = 0 a cylinder,
//! with k = 0 a plane; where k changes its sign a ruling is a reflection line.
//! A spline of K patches is a frame and (gᵢ, kᵢ, sᵢ):
//!
//! Fᵢ₊₁ = Fᵢ · exp(sᵢ ξᵢ) · slide(dᵢ),
//!
//! dᵢ a fixed slide along the ruling that keeps p on the strip. Every G¹ cone
//! spline is such a chain: 3K + 3 unknowns, joins exact to rounding.
//!
//! Residuals are the distances of the strip's vertices, weighted by area, in
//! closed form with closed derivatives (`geometry::cone`).
//!
//! # Sources
//! Zhang, Bo, Zheng & Zhang, *Cone spline surface fitting* (in Chinese); Chen,
//! Lee, Leopoldseder, Pottmann, Randrup & Wallner 1999 (GMIP 61); Leopoldseder
//! & Pottmann 1998.

#[allow(dead_code)] // Until the fit that makes chains stands on it.
mod chain;
#[allow(dead_code)] // As above.
mod distances;
pub mod outcome;
#[allow(dead_code)] // As above.
mod report;
pub mod request;
#[allow(dead_code)] // As above.
mod sheet;
pub mod target;

pub use outcome::Outcome;
pub use request::Request;
