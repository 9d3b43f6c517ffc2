//! fairing
pub mod curve;
