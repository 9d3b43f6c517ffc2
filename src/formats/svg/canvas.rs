//! A page of SVG under construction: shapes and text in millimetres, escaped
//! and rounded in one place.

use std::fmt::Write as _;

/// Typefaces by preference; the last is what every reader has.
const FONTS: &str = "Helvetica, Arial, 'Liberation Sans', 'DejaVu Sans', sans-serif";

/// Where a text is held.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Anchor {
    /// At its left end.
    Start,
    /// In its middle.
    Middle,
    /// At its right end.
    End,
}

/// How a text looks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct TextStyle {
    /// Height of the type, mm.
    pub size: f64,
    /// Colour of the type.
    pub colour: &'static str,
    /// Where it is held.
    pub anchor: Anchor,
    /// Bold or not.
    pub bold: bool,
}

/// How a line looks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stroke<'a> {
    /// Colour.
    pub colour: &'a str,
    /// Width, mm.
    pub width: f64,
}

/// A point on the page, mm from its top left corner.
pub(super) type Spot = [f64; 2];

/// The page so far.
#[derive(Debug, Default)]
pub(super) struct Canvas {
    body: String,
}

impl Canvas {
    /// Separate strokes as one path.
    pub fn strokes(&mut self, segments: &[[Spot; 2]], stroke: Stroke<'_>) {
        if segments.is_empty() {
            return;
        }
        let data: String = segments
            .iter()
            .map(|[a, b]| format!("M{}L{}", spot(*a), spot(*b)))
            .collect();
        self.path(&data, stroke);
    }

    /// One line through several points.
    pub fn polyline(&mut self, points: &[Spot], stroke: Stroke<'_>) {
        let Some((first, rest)) = points.split_first() else {
            return;
        };
        let mut data = format!("M{}", spot(*first));
        for point in rest {
            data.push('L');
            data.push_str(&spot(*point));
        }
        self.path(&data, stroke);
    }

    /// Areas with one fill; where rings lie in one another, every second one is
    /// a hole.
    pub fn areas(&mut self, rings: &[Vec<Spot>], fill: &str) {
        let data: String = rings.iter().map(|ring| closed(ring)).collect();
        if !data.is_empty() {
            self.push(format_args!(
                "<path d=\"{data}\" fill=\"{fill}\" fill-rule=\"evenodd\"/>\n"
            ));
        }
    }

    /// As [`Canvas::polyline`], dashed.
    pub fn dashed(&mut self, points: &[Spot], stroke: Stroke<'_>) {
        const DASH: &str = "1.6 1.1";
        self.push(format_args!("<g stroke-dasharray=\"{DASH}\">\n"));
        self.polyline(points, stroke);
        self.push(format_args!("</g>\n"));
    }

    fn path(&mut self, data: &str, stroke: Stroke<'_>) {
        self.push(format_args!(
            "<path d=\"{data}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\"/>\n",
            stroke.colour,
            number(stroke.width)
        ));
    }

    /// A filled rectangle without a border.
    pub fn rectangle(&mut self, corner: Spot, size: Spot, fill: &str) {
        self.push(format_args!(
            "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"{fill}\"/>\n",
            number(corner[0]),
            number(corner[1]),
            number(size[0]),
            number(size[1])
        ));
    }

    /// A filled circle with a border.
    pub fn circle(&mut self, centre: Spot, radius: f64, fill: &str, stroke: Stroke<'_>) {
        self.push(format_args!(
            "<circle cx=\"{}\" cy=\"{}\" r=\"{}\" fill=\"{fill}\" stroke=\"{}\" stroke-width=\"{}\"/>\n",
            number(centre[0]),
            number(centre[1]),
            number(radius),
            stroke.colour,
            number(stroke.width)
        ));
    }

    /// One line of text, its base line at `at`.
    pub fn text(&mut self, at: Spot, style: TextStyle, text: &str) {
        let anchor = match style.anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let weight = if style.bold {
            " font-weight=\"bold\""
        } else {
            ""
        };
        self.push(format_args!(
            "<text x=\"{}\" y=\"{}\" font-size=\"{}\" fill=\"{}\" text-anchor=\"{anchor}\"{weight}>{}</text>\n",
            number(at[0]),
            number(at[1]),
            number(style.size),
            style.colour,
            escape(text)
        ));
    }

    /// The whole document, `size` in millimetres, on white paper.
    pub fn finish(self, size: Spot, title: &str) -> String {
        let [width, height] = size.map(number);
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}mm\" height=\"{height}mm\" \
             viewBox=\"0 0 {width} {height}\" font-family=\"{FONTS}\" \
             stroke-linecap=\"round\" stroke-linejoin=\"round\">\n\
             <title>{}</title>\n\
             <rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n{}</svg>\n",
            escape(title),
            self.body
        )
    }

    fn push(&mut self, what: std::fmt::Arguments<'_>) {
        // Writing to a `String` cannot fail.
        let _ = self.body.write_fmt(what);
    }
}

/// A ring as path data; nothing where it has no area.
fn closed(ring: &[Spot]) -> String {
    let [first, rest @ ..] = ring else {
        return String::new();
    };
    if rest.len() < 2 {
        return String::new();
    }
    let mut data = format!("M{}", spot(*first));
    for point in rest {
        data.push('L');
        data.push_str(&spot(*point));
    }
    data.push('Z');
    data
}

/// "x y" in the shortest form a path understands.
fn spot([x, y]: Spot) -> String {
    format!("{} {}", number(x), number(y))
}

/// A length to a hundredth of a millimetre, finer than any printer's dot,
/// without trailing zeros and never `-0`; what is no number becomes 0, for a
/// page must stay readable whatever it is asked to show.
fn number(value: f64) -> String {
    let hundredths = (value * 100.0).round();
    let drawable = hundredths.is_finite() && hundredths != 0.0;
    format!("{}", if drawable { hundredths / 100.0 } else { 0.0 })
}

/// Text as XML character data; characters that XML 1.0 forbids become U+FFFD.
fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            '\t' | '\n' | '\r' => escaped.push(' '),
            '\0'..='\u{1f}' | '\u{fffe}' | '\u{ffff}' => escaped.push('\u{fffd}'),
            _ => escaped.push(c),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn users_words_stay_words() {
        assert_eq!(
            escape("<a> & \"b\"\u{1}\n'"),
            "&lt;a&gt; &amp; &quot;b&quot;\u{fffd} &#39;"
        );
    }

    #[test]
    fn numbers_are_short() {
        assert_eq!(
            [1.0, -0.001, 12.345_678, -3.5].map(number),
            ["1", "0", "12.35", "-3.5"]
        );
    }
}
