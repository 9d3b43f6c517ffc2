//! Scalar mathematics: quadrature, banded and sparse systems.
