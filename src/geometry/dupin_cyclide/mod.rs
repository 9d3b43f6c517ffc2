//! Patches of Dupin cyclides bounded by lines of curvature.
//!
//! # Problem
//! Given are four points on a circle and at each a unit frame (t₁, t₂), the
//! frame at the far end of a side being the mirror image of that at the near
//! end in the side's bisecting plane (the tangent along the side mirrored and
//! reversed). There is exactly one patch of a Dupin cyclide with these corners
//! and tangents; its sides and all its parameter lines are circular arcs and
//! lines of curvature, its neighbours across a side join with one tangent plane
//! (Bobenko & Huhnen-Venedey, arXiv 1101.5955, §2).
//!
//! # Formulas
//! With points and vectors as imaginary quaternions, the first corner as the
//! origin and bilinear Bernstein polynomials Bᵢ (Zube & Krasauskas,
//! *Representation of Dupin cyclides using quaternions*, Graphical Models 82,
//! 2015):
//!
//! ```text
//! S = (Σ pᵢ wᵢ Bᵢ)(Σ wᵢ Bᵢ)⁻¹
//! w₀₀ = 1,  w₁₀ ∥ (p₁₀ − p₀₀)⁻¹ t₁,  w₀₁ ∥ (p₀₁ − p₀₀)⁻¹ t₂,
//! w₁₁ ∥ (p₁₁ − p₁₀)⁻¹ t₂⁽¹⁰⁾ w₁₀,
//! ```
//!
//! all with positive factors. Those of w₁₀ and w₀₁ only move the parameters.
//! The last is usually found from Re S = 0, which says nothing on planes and
//! spheres. Here: |w₁₁||w₀₀| : |w₁₀||w₀₁| = |p₁₀ − p₀₁| : |p₁₁ − p₀₀|. Both
//! sides change by the same factor under a Möbius map, and both are 1 for a
//! patch of a torus, a cone, a cylinder or a plane between meridians and
//! parallels, whose corners are an isosceles trapezoid: every principal patch
//! is a Möbius image of one of these. Re S = 0 is left as the check
//! [`CyclidePatch::defect`].
//!
//! Multiplied by the conjugate of the denominator, S is a rational biquadratic
//! patch.
//!
//! # Limits
//! A side of half a turn or more has a control point at infinity: refused.

mod patch;
#[cfg(test)]
mod tests;

pub use patch::{CyclideCorner, CyclideError, CyclidePatch};
