//! The net of lines of curvature.

mod border;
pub(super) mod edge;
mod hold;
mod model;
mod solve;
mod start;

pub use solve::Step;
pub(super) use solve::solve;
