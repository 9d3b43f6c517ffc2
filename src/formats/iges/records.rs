//! The five sections of an IGES file, 80 columns a line.

use std::fmt::Write as _;

/// Columns for free text in a line of the global section.
const GLOBAL_WIDTH: usize = 72;
/// The same in the parameter section, before the pointer to the directory.
const PARAMETER_WIDTH: usize = 64;

/// One value of the global or the parameter section.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Field {
    /// An integer.
    Integer(i64),
    /// A real.
    Real(f64),
    /// A string, ASCII.
    Text(String),
}

impl Field {
    /// A count or an index.
    #[allow(clippy::cast_possible_wrap)] // No list is that long.
    pub fn count(n: usize) -> Field {
        Field::Integer(n as i64)
    }

    /// A string; IGES knows ASCII alone, so dashes become hyphens and other
    /// foreign signs question marks.
    pub fn text(text: &str) -> Field {
        let ascii = |c: char| match c {
            ' '..='~' => c,
            '–' | '—' => '-',
            _ => '?',
        };
        Field::Text(text.chars().map(ascii).collect())
    }

    fn written(&self) -> String {
        match self {
            Field::Integer(n) => n.to_string(),
            Field::Real(x) => real(*x),
            Field::Text(text) if text.is_empty() => String::new(),
            Field::Text(text) => format!("{}H{text}", text.len()),
        }
    }
}

/// A real, shortest digits, with the point that makes it one and `D` before
/// the exponent, which says double precision.
fn real(x: f64) -> String {
    let plain = x == 0.0 || (1e-4..1e12).contains(&x.abs());
    let text = if plain {
        format!("{x}")
    } else {
        format!("{x:E}").replace('E', "D")
    };
    match text.split_once('D') {
        _ if text.contains('.') => text,
        Some((mantissa, exponent)) => format!("{mantissa}.D{exponent}"),
        None => text + ".",
    }
}

/// Directory and parameter sections under construction.
#[derive(Default)]
pub(super) struct Records {
    directory: String,
    directory_lines: usize,
    parameters: String,
    parameter_lines: usize,
}

/// What an entity is to others: digits 3 to 6 of its status.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Role {
    /// It stands for itself.
    Free,
    /// It is a part of another.
    Part,
    /// It is a part of another and a curve in the parameters of a surface.
    Parametric,
    /// It is a property of another and no geometry of its own.
    Property,
}

impl Role {
    fn status(self) -> &'static str {
        match self {
            Role::Free => "00000000",
            Role::Part => "00010000",
            Role::Parametric => "00010500",
            Role::Property => "00010300",
        }
    }
}

impl Records {
    /// Adds an entity and, before it, the property with its name.
    pub fn add(&mut self, kind: u32, form: u32, fields: &[Field], name: &str) {
        let property = [Field::Integer(1), Field::text(name)];
        let name = self.entity(406, 15, &property, Role::Property);
        let mut fields = fields.to_vec();
        // No associativities, one property.
        fields.extend([Field::Integer(0), Field::Integer(1), Field::count(name)]);
        self.entity(kind, form, &fields, Role::Free);
    }

    /// Adds an entity and tells its line in the directory.
    pub fn entity(&mut self, kind: u32, form: u32, fields: &[Field], role: Role) -> usize {
        let pointer = self.directory_lines + 1;
        let first = self.parameter_lines + 1;
        let mut text = kind.to_string();
        for field in fields {
            let _ = write!(text, ",{}", field.written());
        }
        text.push(';');
        for line in wrapped(&text, PARAMETER_WIDTH) {
            self.parameter_lines += 1;
            let number = self.parameter_lines;
            let _ = writeln!(self.parameters, "{line:<64} {pointer:>7}P{number:>7}");
        }
        let lines = self.parameter_lines + 1 - first;
        let status = role.status();
        let second = pointer + 1;
        let _ = writeln!(
            self.directory,
            "{kind:>8}{first:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{status}D{pointer:>7}",
            0, 0, 0, 0, 0, 0
        );
        let _ = writeln!(
            self.directory,
            "{kind:>8}{:>8}{:>8}{lines:>8}{form:>8}{:>8}{:>8}{:>8}{:>8}D{second:>7}",
            0, 0, "", "", "", 0
        );
        self.directory_lines += 2;
        pointer
    }

    /// The whole file.
    pub fn file(&self, start: &str, global: &[Field]) -> String {
        let mut out = String::new();
        let Field::Text(start) = Field::text(start) else {
            return out;
        };
        let start = section(&mut out, &start, 'S');
        let mut text = String::from(",");
        for field in global {
            let _ = write!(text, ",{}", field.written());
        }
        text.push(';');
        let global = section(&mut out, &text, 'G');
        out.push_str(&self.directory);
        out.push_str(&self.parameters);
        let counts = format!(
            "S{start:>7}G{global:>7}D{:>7}P{:>7}",
            self.directory_lines, self.parameter_lines
        );
        let _ = writeln!(out, "{counts:<72}T{:>7}", 1);
        out
    }
}

/// Writes a section of free text and tells how many lines it has.
fn section(out: &mut String, text: &str, letter: char) -> usize {
    let lines = wrapped(text, GLOBAL_WIDTH);
    for (i, line) in lines.iter().enumerate() {
        let _ = writeln!(out, "{line:<72}{letter}{:>7}", i + 1);
    }
    lines.len()
}

/// Cuts text into lines: after a comma where there is one in the line, so that
/// no number is torn; a string longer than a line runs on, as it may.
fn wrapped(text: &str, width: usize) -> Vec<&str> {
    let mut lines = Vec::new();
    let mut rest = text;
    while rest.len() > width {
        let end = rest[..width].rfind(',').map_or(width, |comma| comma + 1);
        let (line, after) = rest.split_at(end);
        lines.push(line);
        rest = after;
    }
    lines.push(rest);
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_break_after_commas() {
        assert_eq!(wrapped("1.5,2.25,3", 6), ["1.5,", "2.25,3"]);
        assert_eq!(wrapped("abcdefgh", 3), ["abc", "def", "gh"]);
        assert_eq!(wrapped("", 3), [""]);
    }

    #[test]
    fn reals_read_back() {
        for (x, text) in [
            (0.0, "0."),
            (2.0, "2."),
            (1e-7, "1.D-7"),
            (-2.5e13, "-2.5D13"),
        ] {
            assert_eq!(real(x), text);
        }
    }

    #[test]
    fn strings_are_ascii_with_their_length() {
        assert_eq!(Field::text("deck – keel").written(), "11Hdeck - keel");
        assert_eq!(Field::text("ä\n").written(), "2H??");
        assert_eq!(Field::text("").written(), "");
    }
}
