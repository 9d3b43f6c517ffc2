//! Scalar mathematics: quadrature, banded and variable-band systems, sin x / x. Knows
//! nobody else in the crate.

pub mod banded;
pub mod legendre;
pub mod quadrature;
mod sinc;

pub use banded::{
    BandedLu, BandedMatrix, EnvelopeFactor, EnvelopeMatrix, NotPositiveDefinite, Singular,
    TiledFactor,
};
pub use quadrature::GaussLegendre;
pub use sinc::sinc;
