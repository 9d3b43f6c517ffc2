//! Laws that every curve and surface must keep, and a zoo of samples to keep
//! them with. Tests of other modules borrow the samples.

pub(crate) mod curve_laws;
mod frozen;
pub(crate) mod samples;
pub(crate) mod surface_laws;
