//! The page of flat patterns: every strip by its name, all to one scale, kind
//! by kind, the way they would be nested on a table.

use super::canvas::{Anchor, Canvas, Spot, Stroke, TextStyle};
use super::colour;
use super::layout::{MARGIN, PAGE_WIDTH};
use super::legend;
use super::page::{self, Words};
use super::text;
use super::views::{GREY, INK};
use crate::formats::patterns::{Pattern, PatternSheet};
use nalgebra::{Matrix2, Point2, SymmetricEigen, Vector2};

/// Height of the names' type, mm.
const NAME_TYPE: f64 = 2.6;
/// Height of the kinds' type, mm.
const KIND_TYPE: f64 = 4.0;
/// Room between patterns, mm.
const GAP: f64 = 4.0;
/// The longest pattern is drawn no longer than this, mm: two in a row.
const LONGEST: f64 = 130.0;
/// Colour of marks.
const MARK: &str = "#4f9d5b";
/// Colour of the rulings.
const RULING: &str = "#7aa5c9";

/// The whole page.
pub(in crate::formats) fn page(drawing: &PatternSheet) -> String {
    let mut canvas = Canvas::default();
    let words = Words {
        title: &drawing.title,
        units: &drawing.unit_name,
        verdict: &drawing.verdict,
        good: drawing.verdict != "outside_limits",
        summary: &drawing.summary,
    };
    let y = page::heading(&mut canvas, &words) + 9.0;
    let y = all(&mut canvas, drawing, LONGEST, y);
    let y = page::sentences(&mut canvas, &words, y + 6.0);
    canvas.finish([PAGE_WIDTH, page::height(y)], &drawing.title)
}

/// All patterns to one scale with its bar below `top`, none longer than
/// `longest`; returns where they end, mm.
pub(super) fn all(canvas: &mut Canvas, drawing: &PatternSheet, longest: f64, top: f64) -> f64 {
    let laid: Vec<(&Pattern, Laid)> = (drawing.patterns.iter())
        .map(|p| (p, Laid::of(p)))
        .collect();
    if laid.is_empty() {
        canvas.text([MARGIN, top], plain(INK), drawing.none);
        return top + 8.0;
    }
    let unit_mm = 1000.0 * drawing.units.metres();
    let denominator = scale_denominator(&laid, unit_mm / longest);
    let scale = unit_mm / denominator;
    let remark = format!("flat patterns, 1 : {denominator}");
    legend::scale_bar(canvas, &drawing.unit_name, [top, scale], &remark);
    shelves(canvas, &laid, scale, top + 14.0)
}

fn plain(colour: &'static str) -> TextStyle {
    TextStyle {
        size: NAME_TYPE,
        colour,
        anchor: Anchor::Start,
        bold: false,
    }
}

/// N of the scale 1 : N, 1, 2 or 5 times a power of ten, at which the longest
/// pattern is short enough: a unit is so many times the room.
fn scale_denominator(laid: &[(&Pattern, Laid)], unit: f64) -> f64 {
    let longest = laid.iter().fold(0.0, |m: f64, (_, l)| m.max(l.size[0]));
    let least = (longest * unit).max(f64::MIN_POSITIVE);
    let decade = 10f64.powf(least.log10().floor());
    let steps = [1.0, 2.0, 5.0, 10.0].map(|step| step * decade);
    // A hair of slack: the decade itself is rounded.
    let fits = steps.into_iter().find(|n| *n >= least * (1.0 - 1e-9));
    let denominator = fits.unwrap_or(10.0 * decade);
    if denominator.is_finite() && denominator > 0.0 {
        denominator
    } else {
        1.0
    }
}

/// A pattern turned so that it lies as flat as it can.
struct Laid {
    right: Vector2<f64>,
    up: Vector2<f64>,
    low: [f64; 2],
    /// Width and height.
    size: [f64; 2],
}

impl Laid {
    fn of(pattern: &Pattern) -> Self {
        let points = &pattern.outline;
        let count = points.len().max(1) as f64;
        let middle = points.iter().map(|p| p.coords).sum::<Vector2<f64>>() / count;
        let spread: Matrix2<f64> = points
            .iter()
            .map(|p| (p.coords - middle) * (p.coords - middle).transpose())
            .sum();
        let eigen = SymmetricEigen::new(spread);
        let long = usize::from(eigen.eigenvalues[1] > eigen.eigenvalues[0]);
        let mut right: Vector2<f64> = eigen.eigenvectors.column(long).into_owned();
        // The strip's line runs to the right.
        if let [first, .., last] = &pattern.line[..]
            && (last - first).dot(&right) < 0.0
        {
            right = -right;
        }
        let up = Vector2::new(-right.y, right.x);
        let mut laid = Laid {
            right,
            up,
            low: [f64::INFINITY; 2],
            size: [0.0; 2],
        };
        let mut high = [f64::NEG_INFINITY; 2];
        for p in points {
            for (k, x) in [right.dot(&p.coords), up.dot(&p.coords)]
                .into_iter()
                .enumerate()
            {
                laid.low[k] = laid.low[k].min(x);
                high[k] = high[k].max(x);
            }
        }
        laid.size = [0, 1].map(|k| (high[k] - laid.low[k]).max(0.0));
        laid
    }

    /// Where a point comes to lie, mm from the corner at the bottom left.
    fn map(&self, p: &Point2<f64>, corner: Spot, scale: f64) -> Spot {
        [
            corner[0] + (self.right.dot(&p.coords) - self.low[0]) * scale,
            corner[1] - (self.up.dot(&p.coords) - self.low[1]) * scale,
        ]
    }
}

/// Patterns side by side in rows below `top`; returns where they end, mm.
fn shelves(canvas: &mut Canvas, laid: &[(&Pattern, Laid)], scale: f64, top: f64) -> f64 {
    let mut y = top;
    for group in laid.chunk_by(|a, b| a.0.kind == b.0.kind) {
        let Some((first, _)) = group.first() else {
            continue;
        };
        let style = TextStyle {
            size: KIND_TYPE,
            bold: true,
            ..plain(INK)
        };
        canvas.text([MARGIN, y + KIND_TYPE], style, &first.kind);
        y += KIND_TYPE + GAP;
        let mut row: Vec<(&Pattern, &Laid, f64)> = Vec::new();
        let mut x = MARGIN;
        for (pattern, laid) in group {
            let name_width = text::width(&pattern.name, NAME_TYPE);
            let width = (laid.size[0] * scale).max(name_width);
            if x + width > PAGE_WIDTH - MARGIN && !row.is_empty() {
                y = shelf(canvas, &row, scale, y);
                row.clear();
                x = MARGIN;
            }
            row.push((pattern, laid, x));
            x += width + GAP;
        }
        y = shelf(canvas, &row, scale, y) + GAP;
    }
    y
}

/// One row; returns where it ends, mm.
fn shelf(canvas: &mut Canvas, row: &[(&Pattern, &Laid, f64)], scale: f64, top: f64) -> f64 {
    let tallest = row
        .iter()
        .fold(0.0, |m: f64, (_, l, _)| m.max(l.size[1] * scale));
    let base = top + NAME_TYPE + 1.0 + tallest;
    for (pattern, laid, x) in row {
        let corner = [*x, base];
        let name_at = [*x, base - laid.size[1] * scale - 1.0];
        canvas.text(name_at, plain(GREY), &pattern.name);
        draw(canvas, pattern, laid, (corner, scale));
    }
    base + GAP
}

/// A share of the limit in as many steps as the eye tells apart; above it stays
/// above.
fn step_of(share: f64) -> f64 {
    const STEPS: f64 = 32.0;
    if share > 1.0 {
        2.0
    } else {
        (share * STEPS).round() / STEPS
    }
}

fn draw(canvas: &mut Canvas, pattern: &Pattern, laid: &Laid, (corner, scale): (Spot, f64)) {
    let map = |p: &Point2<f64>| laid.map(p, corner, scale);
    let stroke = |colour, width| Stroke { colour, width };
    let rulings: Vec<[Spot; 2]> = (pattern.rulings.iter())
        .map(|r| [map(&r[0]), map(&r[1])])
        .collect();
    if pattern.twist_shares.len() == rulings.len() {
        let colour = |i: &usize| step_of(pattern.twist_shares[*i]);
        let all: Vec<usize> = (0..rulings.len()).collect();
        for run in all.chunk_by(|a, b| colour(a) == colour(b)) {
            let lines: Vec<[Spot; 2]> = run.iter().map(|i| rulings[*i]).collect();
            let ink = colour::of_share(colour(&run[0]));
            let stroke = Stroke {
                colour: &ink,
                width: 0.15,
            };
            canvas.strokes(&lines, stroke);
        }
    } else {
        canvas.strokes(&rulings, stroke(RULING, 0.12));
    }
    for mark in &pattern.marks {
        let line: Vec<Spot> = mark.line.iter().map(map).collect();
        canvas.polyline(&line, stroke(MARK, 0.18));
    }
    let line: Vec<Spot> = pattern.line.iter().map(map).collect();
    canvas.polyline(&line, stroke(GREY, 0.12));
    let closed = pattern.outline.iter().chain(pattern.outline.first());
    let outline: Vec<Spot> = closed.map(map).collect();
    canvas.polyline(&outline, stroke(INK, 0.25));
    for (at, label) in &pattern.labels {
        let style = TextStyle {
            anchor: Anchor::Middle,
            ..plain(INK)
        };
        canvas.text(map(at), style, label);
    }
}
