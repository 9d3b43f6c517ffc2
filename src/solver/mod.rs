//! Minimisation on plain vectors. Knows numerics, not geometry.

mod control;

pub use control::{Control, Stop, Unwatched};
