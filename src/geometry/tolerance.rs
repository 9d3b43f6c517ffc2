//! How near is near enough: lengths that count as equal, always relative to
//! the size of the model and always handed over by the caller. There is no
//! global epsilon.

/// A length below which two places are one, in the model's unit. Positive and
/// finite.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub struct Tolerance(f64);

/// The finest tolerance relative to the model: below it coordinates themselves
/// are rounded. About 4,500 units in the last place.
const FINEST: f64 = 1e-12;

impl Tolerance {
    /// An absolute length; `None` unless it is positive and finite.
    #[must_use]
    pub fn absolute(length: f64) -> Option<Self> {
        (length > 0.0 && length.is_finite()).then_some(Tolerance(length))
    }

    /// A share of the model's size (its longest side), raised to the finest
    /// length that its coordinates can tell apart. `None` unless both are
    /// positive and finite.
    #[must_use]
    pub fn relative(share: f64, model_size: f64) -> Option<Self> {
        Self::absolute(share.max(FINEST) * model_size).filter(|_| share > 0.0)
    }

    /// The length.
    #[must_use]
    pub fn length(self) -> f64 {
        self.0
    }

    /// This tolerance times a positive factor; itself for any other factor.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Self {
        Self::absolute(self.0 * factor).unwrap_or(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_lengths_are_tolerances() {
        assert_eq!(Tolerance::absolute(0.5).map(Tolerance::length), Some(0.5));
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert_eq!(Tolerance::absolute(bad), None);
            assert_eq!(Tolerance::relative(1e-6, bad), None);
            assert_eq!(Tolerance::relative(bad.min(0.0), 1.0), None);
        }
        assert_eq!(
            Tolerance::relative(1e-6, 70.0).map(Tolerance::length),
            Some(7e-5)
        );
        assert_eq!(
            Tolerance::relative(1e-30, 2.0).map(Tolerance::length),
            Some(2e-12)
        );
    }
}
