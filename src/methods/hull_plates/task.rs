//! What is asked of the plates, in unit scale.

/// Bounds of every plate, dimensionless.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limits {
    /// Largest share of a curve that an end fan sweeps.
    pub(super) end_limit: f64,
    /// Largest ratio of the end speeds of a ruling, either way.
    pub(super) speed_ratio: f64,
}

/// Which speeds of a ruling's two ends are kept within the ratio.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum EndSpeeds {
    /// Across the ruling: exactly the clearance of the regression curve.
    AcrossTheRuling,
    /// Along the curves, as shares of their lengths. The two differ where a
    /// ruling runs nearly along a curve, as where two profiles all but meet.
    AlongTheCurves,
}

/// Rulings that a plate's path must pass, as arc-length fractions (s, t).
pub(super) type Pins = Vec<(f64, f64)>;
