//! The net of lines of curvature.

pub(super) mod border;
mod calm;
pub(super) mod edge;
mod hold;
mod lead;
mod model;
mod solve;
mod start;

pub(super) use solve::{Lines, solve};
pub use solve::{REACHED, Step};
pub(super) use start::through;
