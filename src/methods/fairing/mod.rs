//! Fairing: the fairest curve or surface within a tolerance of measured points.

pub mod curve;
pub mod offsets;
pub mod surface;
