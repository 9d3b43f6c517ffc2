//! sin x / x.

/// sin x / x, 1 for x = 0.
#[must_use]
pub fn sinc(x: f64) -> f64 {
    // Below this the next term, x⁴/120, is lost in rounding.
    const SMALL: f64 = 1e-4;
    if x.abs() < SMALL {
        1.0 - x * x / 6.0
    } else {
        x.sin() / x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_forms_agree_where_they_meet() {
        assert_eq!(sinc(0.0), 1.0);
        assert!(sinc(std::f64::consts::PI).abs() < 1e-16);
        for x in [0.999e-4, -1.001e-4] {
            assert!((sinc(x) - (x / 2.0).cos() * sinc(x / 2.0)).abs() < 1e-15);
        }
    }
}
