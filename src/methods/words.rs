//! Numbers in the sentences of all methods.

/// Four significant digits, without a tail of zeros.
pub(super) fn short(v: f64) -> String {
    if v == 0.0 {
        return "0".into();
    }
    let digits = 3 - v.abs().log10().floor() as i32;
    if !(0..=9).contains(&digits) {
        return format!("{v:.3e}");
    }
    let text = format!("{v:.*}", digits as usize);
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_string()
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn four_digits_whatever_the_size() {
        for (value, text) in [
            (0.0, "0"),
            (1.0, "1"),
            (12345.6, "1.235e4"),
            (0.012_345_6, "0.01235"),
            (-2.5, "-2.5"),
            (1e-9, "1.000e-9"),
        ] {
            assert_eq!(short(value), text);
        }
    }
}
