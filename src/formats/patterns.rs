//! Flat patterns: as a page to look at, and as a drawing for the cutting
//! table.

pub use super::dxf::Corner;
use super::dxf::{self, Drawing, Entity, Layer, Version};
use super::length_unit::LengthUnit;
use super::svg;
use nalgebra::{Point2, Vector2};

/// Patterns that are drawn together; all lengths in `units`.
#[derive(Debug, Clone, PartialEq)]
pub struct PatternSheet {
    /// The user's label of the job, or a name for it.
    pub title: String,
    /// Unit of every length, as the user wrote it.
    pub unit_name: String,
    /// The same for programmes.
    pub units: LengthUnit,
    /// The patterns.
    pub patterns: Vec<Pattern>,
    /// What stands in their place if there are none.
    pub none: &'static str,
    /// `within_limits` or `outside_limits`.
    pub verdict: String,
    /// Sentences about the result.
    pub summary: Vec<String>,
}

/// A flat pattern.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Pattern {
    /// What it is called: shown on the sheet.
    pub name: String,
    /// What kind it is: patterns of one kind stand together under it.
    pub kind: String,
    /// The closed outline, the first point not repeated.
    pub outline: Vec<Point2<f64>>,
    /// A line to mark; the base line that a strip was laid along.
    pub line: Vec<Point2<f64>>,
    /// Rulings: lines to bend over.
    pub rulings: Vec<[Point2<f64>; 2]>,
    /// Twist of each ruling as a share of the limit, by which the page colours
    /// it; empty: all one colour.
    pub twist_shares: Vec<f64>,
    /// Words at places, for example the names of patches.
    pub labels: Vec<(Point2<f64>, String)>,
    /// Its side that is seen.
    pub side: &'static str,
    /// The outline as it is cut, where arcs are nearer to it than straight lines
    /// between a few corners; empty: as `outline` has it.
    pub cut: Vec<Corner>,
    /// Lines to mark and what they are, for example stations.
    pub marks: Vec<Mark>,
    /// Sentences that stand below the pattern on the cutting table's drawing.
    pub notes: Vec<String>,
    /// Whether it keeps its limits though others of the sheet do not.
    pub within_limits: bool,
}

/// A line to mark.
#[derive(Debug, Clone, PartialEq)]
pub struct Mark {
    /// What it is.
    pub name: String,
    /// From place to place.
    pub line: Vec<Point2<f64>>,
}

/// The patterns as an SVG page, all to one stated scale.
#[must_use]
pub fn page(sheet: &PatternSheet) -> String {
    svg::patterns::page(sheet)
}

/// Room between patterns and height of letters, of the largest pattern's longer
/// side.
const GAP: f64 = 0.05;
/// See [`GAP`].
const LETTER: f64 = 0.015;
/// Height of a mark's letters, of the others.
const MARK_LETTER: f64 = 0.6;
/// Letters in a line of text: about as long as the largest pattern.
const LETTERS: usize = 90;
/// Distance of lines of text, of their letters' height.
const LINE: f64 = 1.5;

/// The patterns as a drawing for the cutting table, true to size, one above
/// the other, each with its name; one that is outside its limits says so.
#[must_use]
pub fn cutting_drawing(sheet: &PatternSheet, version: Version) -> String {
    let boxes: Vec<[Point2<f64>; 2]> = sheet.patterns.iter().map(bounds).collect();
    let longest = (boxes.iter())
        .map(|[low, high]| (high - low).max())
        .fold(0.0, f64::max);
    let mut drawing = Drawing {
        units: sheet.units,
        entities: Vec::new(),
    };
    let letter = LETTER * longest;
    let mut top = 0.0;
    let write = |drawing: &mut Drawing, top: &mut f64, text: &str| {
        for line in lines(text) {
            *top -= LINE * letter;
            let at = Point2::new(0.0, *top);
            drawing.entities.push(words(at, letter, line));
        }
    };
    for (pattern, [low, high]) in sheet.patterns.iter().zip(&boxes) {
        let shift = Vector2::new(-low.x, top - high.y);
        drawing.entities.extend(entities(pattern, shift, letter));
        top -= high.y - low.y;
        write(&mut drawing, &mut top, &sentence(sheet, pattern));
        for note in &pattern.notes {
            write(&mut drawing, &mut top, note);
        }
        top -= GAP * longest;
    }
    for line in &sheet.summary {
        write(&mut drawing, &mut top, line);
    }
    dxf::write(&drawing, version)
}

/// A text in lines, broken between words.
fn lines(text: &str) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        let longer = |line: &String| line.chars().count() + 1 + word.chars().count();
        match lines.last_mut() {
            Some(line) if longer(line) <= LETTERS => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// Name, side, and the verdict where it is bad: what must not get lost between
/// the office and the shop.
fn sentence(sheet: &PatternSheet, pattern: &Pattern) -> String {
    let warning = if sheet.verdict == "outside_limits" && !pattern.within_limits {
        " - OUTSIDE LIMITS"
    } else {
        ""
    };
    format!(
        "{} - {} - {} up - lengths in {}{warning}",
        sheet.title, pattern.name, pattern.side, sheet.unit_name
    )
}

fn bounds(pattern: &Pattern) -> [Point2<f64>; 2] {
    let points = pattern
        .outline
        .iter()
        .chain(pattern.cut.iter().map(|c| &c.at));
    let corners = points.fold(None, |corners, p| {
        let [low, high] = corners.unwrap_or([*p, *p]);
        Some([low.inf(p), high.sup(p)])
    });
    corners.unwrap_or([Point2::origin(); 2])
}

fn entities(pattern: &Pattern, shift: Vector2<f64>, letter: f64) -> Vec<Entity> {
    let polyline = |layer, points: &[Point2<f64>], closed| Entity::Polyline {
        layer,
        corners: (points.iter())
            .map(|p| Corner {
                at: p + shift,
                bulge: 0.0,
            })
            .collect(),
        closed,
    };
    let cut = if pattern.cut.is_empty() {
        polyline(Layer::Cut, &pattern.outline, true)
    } else {
        let corners = pattern.cut.iter().map(|c| Corner {
            at: c.at + shift,
            bulge: c.bulge,
        });
        Entity::Polyline {
            layer: Layer::Cut,
            corners: corners.collect(),
            closed: true,
        }
    };
    let mut entities = vec![cut];
    if pattern.line.len() > 1 {
        entities.push(polyline(Layer::Frame, &pattern.line, false));
    }
    entities.extend(pattern.rulings.iter().map(|ends| Entity::Line {
        layer: Layer::Roll,
        ends: ends.map(|p| p + shift),
    }));
    for mark in &pattern.marks {
        entities.push(polyline(Layer::Frame, &mark.line, false));
        let at = mark.line.first();
        let name = |at: &Point2<f64>| words(at + shift, MARK_LETTER * letter, mark.name.clone());
        entities.extend(at.map(name));
    }
    let labels = pattern.labels.iter();
    entities.extend(labels.map(|(at, text)| words(at + shift, letter, text.clone())));
    entities
}

fn words(at: Point2<f64>, height: f64, text: String) -> Entity {
    Entity::Text {
        layer: Layer::Text,
        at,
        height,
        angle_deg: 0.0,
        text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sheet(verdict: &str) -> PatternSheet {
        let square = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]];
        let outline: Vec<Point2<f64>> = square.map(|[x, y]| Point2::new(x, y)).to_vec();
        let pattern = |name: &str| Pattern {
            name: name.into(),
            kind: "strips".into(),
            rulings: vec![[outline[0], outline[3]]],
            line: vec![outline[0], outline[1]],
            labels: vec![(outline[0], "A".into())],
            outline: outline.clone(),
            side: "front",
            ..Pattern::default()
        };
        PatternSheet {
            title: "net".into(),
            unit_name: "m".into(),
            units: LengthUnit::Metre,
            patterns: vec![pattern("u1"), pattern("u2")],
            none: "none",
            verdict: verdict.into(),
            summary: vec!["It is so.".into()],
        }
    }

    #[test]
    fn patterns_do_not_lie_on_each_other() {
        let text = cutting_drawing(&sheet("within_limits"), Version::R12);
        assert_eq!(text.matches("POLYLINE\r\n").count(), 4);
        let lines: Vec<&str> = text.lines().collect();
        let ys: Vec<f64> = (lines.windows(10))
            .filter(|w| w[1] == "VERTEX" && w[3] == "CUT")
            .map(|w| w[7].parse().unwrap())
            .collect();
        let (first, second) = ys.split_at(4);
        let low = first.iter().copied().fold(f64::INFINITY, f64::min);
        let high = second.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        assert!(high < low, "{first:?} {second:?}");
        assert!(!text.contains("OUTSIDE LIMITS"));
    }

    #[test]
    fn the_page_names_every_pattern_and_its_scale() {
        let text = page(&sheet("within_limits"));
        assert!(text.contains(">u1<") && text.contains(">u2<") && text.contains(">A<"));
        assert!(text.contains("1 : "), "{text}");
        assert_eq!(text.matches(">strips<").count(), 1);
        let mut empty = sheet("within_limits");
        empty.patterns.clear();
        assert!(page(&empty).contains(">none<"));
    }

    #[test]
    fn arcs_marks_and_notes_stand_on_their_layers() {
        let mut sheet = sheet("outside_limits");
        let pattern = &mut sheet.patterns[0];
        pattern.cut = (pattern.outline.iter())
            .map(|at| Corner {
                at: *at,
                bulge: 0.25,
            })
            .collect();
        pattern.marks = vec![Mark {
            name: "x = 1".into(),
            line: vec![Point2::new(1.0, 0.0), Point2::new(1.0, 1.0)],
        }];
        pattern.notes = vec!["Roll it cold.".into()];
        pattern.within_limits = true;
        let text = cutting_drawing(&sheet, Version::R2000);
        assert_eq!(text.matches(" 42\r\n0.25\r\n").count(), 4);
        assert!(text.contains("x = 1\r\n") && text.contains("Roll it cold."));
        // Two base lines and the mark.
        assert_eq!(text.matches("LWPOLYLINE\r\n").count(), 5);
        assert_eq!(text.matches("OUTSIDE LIMITS").count(), 1);
    }

    #[test]
    fn long_sentences_are_broken_between_words() {
        let text = "so many words ".repeat(20);
        let broken = lines(&text);
        assert!(broken.iter().all(|l| l.chars().count() <= LETTERS) && broken.len() == 4);
        assert_eq!(broken.join(" "), text.trim());
    }

    #[test]
    fn what_is_outside_its_limits_says_so_in_the_file() {
        let text = cutting_drawing(&sheet("outside_limits"), Version::R2000);
        assert_eq!(text.matches("OUTSIDE LIMITS").count(), 2);
        assert!(text.contains("It is so."));
    }
}
