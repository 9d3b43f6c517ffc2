//! The units of length that files can say.

use std::fmt;

/// A unit of length.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum LengthUnit {
    /// Millimetre.
    Millimetre,
    /// Centimetre.
    Centimetre,
    /// Metre.
    Metre,
    /// International inch, 25.4 mm.
    Inch,
    /// International foot, 304.8 mm.
    Foot,
}

impl LengthUnit {
    /// All units.
    pub const ALL: [LengthUnit; 5] = [
        LengthUnit::Millimetre,
        LengthUnit::Centimetre,
        LengthUnit::Metre,
        LengthUnit::Inch,
        LengthUnit::Foot,
    ];

    /// Metres in one unit.
    #[must_use]
    pub fn metres(self) -> f64 {
        f64::from(self.tenths_of_a_millimetre()) / 1e4
    }

    /// Its short name.
    #[must_use]
    pub fn symbol(self) -> &'static str {
        match self {
            LengthUnit::Millimetre => "mm",
            LengthUnit::Centimetre => "cm",
            LengthUnit::Metre => "m",
            LengthUnit::Inch => "in",
            LengthUnit::Foot => "ft",
        }
    }

    /// How many of `other` make one of this: the double nearest to the exact
    /// ratio, so that 1 ft is 304.8 mm to the last bit.
    #[must_use]
    pub fn in_terms_of(self, other: LengthUnit) -> f64 {
        f64::from(self.tenths_of_a_millimetre()) / f64::from(other.tenths_of_a_millimetre())
    }

    /// Whole, and so exact, for every unit.
    fn tenths_of_a_millimetre(self) -> u16 {
        match self {
            LengthUnit::Millimetre => 10,
            LengthUnit::Centimetre => 100,
            LengthUnit::Metre => 10_000,
            LengthUnit::Inch => 254,
            LengthUnit::Foot => 3_048,
        }
    }
}

impl fmt::Display for LengthUnit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.symbol())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ratios_are_exact() {
        assert_eq!(LengthUnit::Foot.in_terms_of(LengthUnit::Millimetre), 304.8);
        assert_eq!(LengthUnit::Foot.in_terms_of(LengthUnit::Inch), 12.0);
        assert_eq!(LengthUnit::Millimetre.in_terms_of(LengthUnit::Metre), 1e-3);
        assert_eq!(LengthUnit::Inch.metres(), 0.0254);
        assert_eq!(LengthUnit::Foot.metres(), 0.3048);
        assert_eq!(LengthUnit::Millimetre.metres(), 1e-3);
    }
}
