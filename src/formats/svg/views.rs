//! One view: grid, rulings, profile curves and the places of largest twist.

use super::canvas::{Anchor, Canvas, Spot, Stroke, TextStyle};
use super::colour;
use super::layout::{Layout, View};
use crate::formats::plates::{HullDrawing, PlateDrawing, RulingLine, is_finite};

/// Rulings of nearly one colour go into one path; this many colours below the
/// limit are more than the eye tells apart.
const COLOURS: usize = 32;
/// Rulings closer than this on paper run together: mm between kept ones.
const RULING_SPACING: f64 = 0.8;
/// Body and fore body lie on top of each other in the body view; wider spacing
/// there keeps the lower one visible.
const BODY_SPACING: f64 = 1.3;
/// Width of a ruling within and above the limit, mm. A red line that is also
/// thicker survives a black-and-white print.
const RULING_WIDTH: [f64; 2] = [0.24, 0.38];
/// Width of a profile curve, mm.
const PROFILE_WIDTH: f64 = 0.5;
/// Radius of a plate's number, mm.
pub(super) const MARK_RADIUS: f64 = 1.9;
/// Ink of lines and text.
pub(super) const INK: &str = "#111111";
/// Lesser text.
pub(super) const GREY: &str = "#555555";

/// Draws one view of the hull.
pub(super) fn draw(canvas: &mut Canvas, hull: &HullDrawing, layout: &Layout, view: &View) {
    draw_grid(canvas, layout.step, view);
    draw_rulings(canvas, hull, view);
    for profile in &hull.profiles {
        let points: Vec<Spot> = profile
            .points
            .iter()
            .filter(|p| is_finite(p))
            .map(|p| view.map(p))
            .collect();
        canvas.polyline(
            &points,
            Stroke {
                colour: INK,
                width: PROFILE_WIDTH,
            },
        );
    }
    draw_marks(canvas, hull, view);
}

/// Numbers the plates on their worst rulings: in the middle, or where another
/// number is in the way further along, or beside a ruling seen end on.
fn draw_marks(canvas: &mut Canvas, hull: &HullDrawing, view: &View) {
    /// Shares of the ruling, the preferred first.
    const PLACES: [f64; 5] = [0.5, 0.3, 0.7, 0.1, 0.9];
    let mut taken: Vec<Spot> = Vec::new();
    for (index, plate) in hull.plates.iter().enumerate() {
        let Some(worst) = worst(plate) else { continue };
        let mut spots = PLACES
            .map(|share| view.map(&worst.from.lerp(&worst.to, share)))
            .to_vec();
        spots.extend([-2.4, 2.4].map(|side| [spots[0][0] + side * MARK_RADIUS, spots[0][1]]));
        let is_free = |spot: &&Spot| {
            taken
                .iter()
                .all(|other| distance(**spot, *other) > 2.2 * MARK_RADIUS)
        };
        let spot = *spots.iter().find(is_free).unwrap_or(&spots[0]);
        mark(canvas, spot, index + 1);
        taken.push(spot);
    }
}

/// The ruling with the largest |twist| of a plate.
pub(super) fn worst(plate: &PlateDrawing) -> Option<&RulingLine> {
    let drawn = plate
        .rulings
        .iter()
        .filter(|r| r.is_finite() && r.twist_deg.is_finite());
    drawn.max_by(|a, b| a.twist_deg.abs().total_cmp(&b.twist_deg.abs()))
}

/// A plate's number in a circle.
pub(super) fn mark(canvas: &mut Canvas, at: Spot, number: usize) {
    canvas.circle(
        at,
        MARK_RADIUS,
        "#ffffff",
        Stroke {
            colour: INK,
            width: 0.3,
        },
    );
    let style = TextStyle {
        size: 2.6,
        colour: INK,
        anchor: Anchor::Middle,
        bold: true,
    };
    // A third of the type's height brings the digits to the middle.
    canvas.text([at[0], at[1] + 0.93], style, &number.to_string());
}

fn draw_grid(canvas: &mut Canvas, step: f64, view: &View) {
    view.panel().grid(canvas, [step; 2]);
    let [left, top] = view.corner;
    let axes = view.axes.map(|i| ["x", "y", "z"][i]);
    let style = TextStyle {
        size: 3.0,
        colour: INK,
        anchor: Anchor::Start,
        bold: true,
    };
    canvas.text(
        [left, top - 2.2],
        style,
        &format!("{} ({}–{})", view.name, axes[0], axes[1]),
    );
}

/// Rulings as strokes, the most twisted last and so on top.
fn draw_rulings(canvas: &mut Canvas, hull: &HullDrawing, view: &View) {
    let mut within: Vec<Vec<[Spot; 2]>> = vec![Vec::new(); COLOURS + 1];
    let mut above = Vec::new();
    for plate in &hull.plates {
        for (ruling, ends) in kept(plate, view) {
            let share = ruling.twist_deg.abs() / hull.twist_limit_deg;
            if share <= 1.0 {
                within[(share * COLOURS as f64).round() as usize].push(ends);
            } else {
                above.push(ends);
            }
        }
    }
    for (level, segments) in within.iter().enumerate() {
        let colour = colour::of_share(level as f64 / COLOURS as f64);
        canvas.strokes(
            segments,
            Stroke {
                colour: &colour,
                width: RULING_WIDTH[0],
            },
        );
    }
    canvas.strokes(
        &above,
        Stroke {
            colour: colour::ABOVE_LIMIT,
            width: RULING_WIDTH[1],
        },
    );
}

/// The rulings worth drawing in this view, with their ends on the page: the
/// first, the last, the worst, and those far enough from the one before.
fn kept<'a>(plate: &'a PlateDrawing, view: &View) -> Vec<(&'a RulingLine, [Spot; 2])> {
    let spacing = if view.axes.contains(&0) {
        RULING_SPACING
    } else {
        BODY_SPACING
    };
    let mut kept: Vec<(&RulingLine, [Spot; 2])> = Vec::new();
    let musts = [plate.rulings.last(), worst(plate)];
    for ruling in plate.rulings.iter().filter(|r| r.is_finite()) {
        let ends = [view.map(&ruling.from), view.map(&ruling.to)];
        let far = kept.last().is_none_or(|(_, before)| {
            distance(before[0], ends[0]).max(distance(before[1], ends[1])) >= spacing
        });
        let must = musts.iter().flatten().any(|m| std::ptr::eq(*m, ruling));
        if far || must {
            kept.push((ruling, ends));
        }
    }
    kept
}

fn distance(a: Spot, b: Spot) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}
