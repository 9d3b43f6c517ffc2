//! Scalar mathematics: quadrature, banded and variable-band systems. Knows
//! nobody else in the crate.

pub mod banded;
pub mod quadrature;

pub use banded::{
    BandedLu, BandedMatrix, EnvelopeFactor, EnvelopeMatrix, NotPositiveDefinite, Singular,
    TiledFactor,
};
pub use quadrature::GaussLegendre;
