//! Stage 2: the exact cyclide spline nearest to a net of curvature lines.
//!
//! # Problem
//! A net of quads with a frame at each vertex carries one patch of a Dupin
//! cyclide a quad, all joined with one tangent plane along circular arcs, if
//! and only if along every edge the frame of one end is the mirror image of
//! the other's in the edge's bisecting plane, the tangent along the edge
//! mirrored and reversed (Bobenko & Huhnen-Venedey, arXiv 1101.5955, §2;
//! Zheng & Bo 2019, eq. 3). Four such mirrors in a row are the identity, so
//! the four corners of every quad then lie on a circle.
//!
//! # Unknowns
//! At every vertex its way from the start, in mean edge lengths, and the turn
//! ω of its frame: six numbers. The frame is a unit quaternion
//! q = (1 + ω/2)/|1 + ω/2| · q₀.
//!
//! # Residuals
//! * Mirror, for an edge along u (a = i) or v (a = j) with the unit direction
//!   e: `σ q₁ a q̄₂ − e`, four numbers, of which three are independent. The
//!   mirror in a plane with normal e is −e·e for vectors and the half turn e
//!   for frames of one hand, so that q₂ = −σ e q₁ a says the same. σ = ±1
//!   tells the two quaternions of a frame apart, which a net that closes
//!   cannot do for all edges at once.
//! * Closeness: way and turn of every vertex.
//! * Fairness: how way and turn change along every edge.
//!
//! # Method
//! Closeness and fairness choose among the nets that there are (one degree of
//! freedom a quad, three an edge of the first row and column) and must not
//! keep the mirrors from being exact: they are faded out from run to run of
//! the least-squares solver. What is left at the end is Newton's iteration on
//! the mirrors alone.
//!
//! # What was changed against the paper
//! The paper moves the control points of bicubic patches until they nearly
//! keep the conditions of a cyclide. Here the conditions are met to rounding
//! and the patches are rational, so that the result *is* a cyclide spline.
//!
//! # Limits
//! A quad whose side turns by half a turn or more has no patch.

mod certificate;
mod closure;
mod patches;
mod problem;
#[cfg(test)]
pub(crate) mod samples;
mod solve;
#[cfg(test)]
mod tests;

pub use certificate::{Certificate, certificates};
pub use closure::closure;
pub use patches::{offset, patches};
pub use solve::{Spline, solve};
