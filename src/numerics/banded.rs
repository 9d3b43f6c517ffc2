//! Direct solvers for the matrices that curves make: few nonzeros, all near
//! the diagonal.
//!
//! * [`EnvelopeMatrix`] for symmetric positive definite normal equations whose
//!   rows reach back by different lengths (band, arrow, any variable band);
//! * [`TiledFactor`] for the same on wide bands, as surfaces have them;
//! * [`BandedMatrix`] for the small unsymmetric bands of interpolation.
//!
//! Limits: neither reorders. The caller numbers the unknowns so that the band
//! is narrow.

#![allow(
    clippy::needless_range_loop,
    reason = "elimination reads as in the books, by indices"
)]

mod envelope;
mod lu;
mod tiled;

pub use envelope::{EnvelopeFactor, EnvelopeMatrix, NotPositiveDefinite};
pub use lu::{BandedLu, BandedMatrix, Singular};
pub use tiled::TiledFactor;
