//! Numbers and strings as part 21 writes them.

use std::fmt::Write as _;

/// A real: the shortest digits that read back as the same bits, with the point
/// that the standard asks for.
pub(super) fn real(x: f64) -> String {
    let plain = x == 0.0 || (1e-4..1e12).contains(&x.abs());
    let text = if plain {
        format!("{x}")
    } else {
        format!("{x:E}")
    };
    match text.split_once('E') {
        _ if text.contains('.') => text,
        Some((mantissa, exponent)) => format!("{mantissa}.E{exponent}"),
        None => text + ".",
    }
}

/// A list of reals in brackets.
pub(super) fn reals(list: &[f64]) -> String {
    bracketed(list.iter().map(|x| real(*x)))
}

/// Anything in brackets.
pub(super) fn bracketed(items: impl Iterator<Item = impl std::fmt::Display>) -> String {
    let mut text = String::from("(");
    for (i, item) in items.enumerate() {
        let comma = if i > 0 { "," } else { "" };
        // Writing to a String cannot fail.
        let _ = write!(text, "{comma}{item}");
    }
    text.push(')');
    text
}

/// A string: quotes and backslashes doubled, what is not printable ASCII as
/// UTF-16 between `\X2\` and `\X0\` (ISO 10303-21, 6.4.3).
pub(super) fn string(text: &str) -> String {
    let mut out = String::from("'");
    let mut wide = false;
    for c in text.chars() {
        let plain = matches!(c, ' '..='~');
        if plain == wide {
            out.push_str(if plain { "\\X0\\" } else { "\\X2\\" });
            wide = !plain;
        }
        match c {
            '\'' => out.push_str("''"),
            '\\' => out.push_str("\\\\"),
            c if plain => out.push(c),
            c => {
                for unit in c.encode_utf16(&mut [0; 2]) {
                    let _ = write!(out, "{unit:04X}");
                }
            }
        }
    }
    out.push_str(if wide { "\\X0\\'" } else { "'" });
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reals_have_a_point_and_read_back() {
        for (x, text) in [
            (0.0, "0."),
            (-1.0, "-1."),
            (0.5, "0.5"),
            (1e-7, "1.E-7"),
            (1.5e-9, "1.5E-9"),
            (1e12, "1.E12"),
            (21336.0, "21336."),
        ] {
            assert_eq!(real(x), text);
        }
        for x in [f64::MIN_POSITIVE, 1.0 / 3.0, -2e300, 123_456_789.125] {
            assert_eq!(real(x).parse::<f64>().unwrap().to_bits(), x.to_bits());
        }
    }

    #[test]
    fn strings_are_escaped() {
        assert_eq!(
            string("deck – 'keel' \\"),
            r"'deck \X2\2013\X0\ ''keel'' \\'"
        );
        assert_eq!(string("ä"), r"'\X2\00E4\X0\'");
        assert_eq!(string("a\n𝄞b"), r"'a\X2\000AD834DD1E\X0\b'");
    }
}
