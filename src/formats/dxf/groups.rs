//! Pairs of a code and a value, of which a DXF file is made.

use nalgebra::Point2;
use std::fmt::Write as _;

/// A file under construction.
#[derive(Default)]
pub(super) struct Groups {
    out: String,
    handle: u32,
}

impl Groups {
    /// A pair with a word.
    pub fn text(&mut self, code: u16, value: &str) {
        // Writing to a String cannot fail.
        let _ = write!(self.out, "{code:>3}\r\n{}\r\n", escaped(value));
    }

    /// A pair with a whole number.
    pub fn integer(&mut self, code: u16, value: impl Into<i64>) {
        let value: i64 = value.into();
        let _ = write!(self.out, "{code:>3}\r\n{value:>6}\r\n");
    }

    /// A pair with a number: shortest digits, always with a point.
    pub fn real(&mut self, code: u16, value: f64) {
        let _ = write!(self.out, "{code:>3}\r\n{value:?}\r\n");
    }

    /// Two or three coordinates from a code on.
    pub fn point(&mut self, code: u16, p: &Point2<f64>, z: Option<f64>) {
        self.real(code, p.x);
        self.real(code + 10, p.y);
        if let Some(z) = z {
            self.real(code + 20, z);
        }
    }

    /// A new handle, which names an object once.
    pub fn new_handle(&mut self) -> String {
        self.handle += 1;
        format!("{:X}", self.handle)
    }

    /// A class marker.
    pub fn class(&mut self, name: &str) {
        self.text(100, name);
    }

    /// Begins a section.
    pub fn section(&mut self, name: &str) {
        self.text(0, "SECTION");
        self.text(2, name);
    }

    /// Ends a section.
    pub fn end_section(&mut self) {
        self.text(0, "ENDSEC");
    }

    /// What was written.
    pub fn finish(self) -> String {
        self.out
    }
}

/// One line of ASCII: other signs as `\U+` with four digits, which readers of
/// both versions understand.
fn escaped(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        match c {
            ' '..='~' => out.push(c),
            c if c.is_control() => out.push(' '),
            c => {
                for unit in c.encode_utf16(&mut [0; 2]) {
                    let _ = write!(out, "\\U+{unit:04X}");
                }
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_stay_on_their_line() {
        let mut groups = Groups::default();
        groups.text(1, "a\nb – ä");
        groups.real(40, 1.0);
        groups.integer(70, 1);
        let expected = "  1\r\na b \\U+2013 \\U+00E4\r\n 40\r\n1.0\r\n 70\r\n     1\r\n";
        assert_eq!(groups.finish(), expected);
    }
}
