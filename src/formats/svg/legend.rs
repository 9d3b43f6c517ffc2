//! What the colours, numbers and lengths mean: colour bar with the limit, the
//! plates by number, a scale bar.

use super::canvas::{Anchor, Canvas, Stroke, TextStyle};
use super::colour;
use super::layout::{MARGIN, PAGE_WIDTH, grid_label, multiples, round_step};
use super::text;
use super::views::{GREY, INK, MARK_RADIUS, mark, worst};
use crate::formats::plates::HullDrawing;

/// Colour bar, mm: length of 0..limit, length of the part above, height.
const BAR: [f64; 3] = [80.0, 22.0, 4.2];
/// Patches in the bar; one more than what the eye resolves.
const PATCHES: usize = 80;
/// Left edge of the list of plates, mm.
const LIST_LEFT: f64 = 128.0;
/// Room for the list of plates, mm; the scale bar stands to its right.
const LIST_WIDTH: f64 = 100.0;
/// Height of a line of the list, mm.
const LIST_LINE: f64 = 5.2;
/// Height of the type, mm.
const TYPE: f64 = 3.0;

/// Draws the legend with its top at `top` and returns its bottom, mm. `scale`
/// is millimetres on the page per unit of length.
pub(super) fn draw(canvas: &mut Canvas, hull: &HullDrawing, top: f64, scale: f64) -> f64 {
    let bar = colour_bar(canvas, hull.twist_limit_deg, top);
    let list = plate_list(canvas, hull, top);
    scale_bar(canvas, &hull.units, [top, scale], "all views to one scale");
    bar.max(list)
}

fn style(anchor: Anchor, bold: bool) -> TextStyle {
    TextStyle {
        size: TYPE,
        colour: INK,
        anchor,
        bold,
    }
}

/// The colours from no twist to the limit, and the warning colour above it.
fn colour_bar(canvas: &mut Canvas, limit: f64, top: f64) -> f64 {
    canvas.text(
        [MARGIN, top],
        style(Anchor::Start, true),
        "Twist along a ruling",
    );
    let [length, above, height] = BAR;
    let y = top + 2.5;
    let patch = length / PATCHES as f64;
    for i in 0..PATCHES {
        let share = (i as f64 + 0.5) / PATCHES as f64;
        // Overlapping the next patch a little leaves no white seam.
        let width = if i + 1 < PATCHES { patch + 0.2 } else { patch };
        let corner = [MARGIN + i as f64 * patch, y];
        canvas.rectangle(corner, [width, height], &colour::of_share(share));
    }
    let end = MARGIN + length;
    canvas.rectangle([end, y], [above, height], colour::ABOVE_LIMIT);
    let heavy = Stroke {
        colour: INK,
        width: 0.6,
    };
    canvas.strokes(&[[[end, y - 1.6], [end, y + height + 1.6]]], heavy);
    ticks(canvas, limit, y + height);
    let label = format!("limit {}°", short(limit));
    canvas.text([end, y + height + 5.0], style(Anchor::Middle, true), &label);
    canvas.text(
        [end + above, y + height + 5.0],
        style(Anchor::End, false),
        "above",
    );
    y + height + 5.0
}

/// Numbers below the bar, none of them so near the limit that they collide.
fn ticks(canvas: &mut Canvas, limit: f64, y: f64) {
    let step = round_step(limit / 5.0);
    for value in multiples(step, 0.0, limit * 0.85) {
        let x = MARGIN + BAR[0] * value / limit;
        canvas.strokes(
            &[[[x, y], [x, y + 1.0]]],
            Stroke {
                colour: INK,
                width: 0.25,
            },
        );
        let anchor = if value == 0.0 {
            Anchor::Start
        } else {
            Anchor::Middle
        };
        canvas.text(
            [x, y + 5.0],
            style(anchor, false),
            &format!("{}°", grid_label(value, step)),
        );
    }
}

/// The plates by number with their largest twist; the number stands on the
/// drawing where that is.
fn plate_list(canvas: &mut Canvas, hull: &HullDrawing, top: f64) -> f64 {
    let heading = "Plates: the number stands where a plate twists most";
    canvas.text(
        [LIST_LEFT, top],
        style(Anchor::Start, true),
        &text::clip(heading, TYPE, LIST_WIDTH),
    );
    let mut y = top;
    for (index, plate) in hull.plates.iter().enumerate() {
        y += LIST_LINE;
        mark(canvas, [LIST_LEFT + MARK_RADIUS, y - 1.0], index + 1);
        let twist = worst(plate).map_or("–".to_owned(), |r| {
            format!("{}°", short(r.twist_deg.abs()))
        });
        let room = LIST_WIDTH - 7.0 - text::width(&twist, TYPE) - 2.0;
        let name = text::clip(&plate.name, TYPE, room);
        canvas.text([LIST_LEFT + 6.0, y], style(Anchor::Start, false), &name);
        let colour = if plate.within_limits {
            INK
        } else {
            colour::ABOVE_LIMIT
        };
        let figure = TextStyle {
            colour,
            ..style(Anchor::End, true)
        };
        canvas.text([LIST_LEFT + LIST_WIDTH - 1.0, y], figure, &twist);
    }
    y
}

/// A bar of a round length at the right, with its top at the first number (mm)
/// and to the scale of the second (mm per unit of length), and a remark below.
pub(super) fn scale_bar(canvas: &mut Canvas, units: &str, [top, scale]: [f64; 2], remark: &str) {
    /// About how long the bar should be, mm.
    const LENGTH: f64 = 30.0;
    let step = round_step(LENGTH / scale);
    let [right, y] = [PAGE_WIDTH - MARGIN, top + 4.6];
    let left = right - step * scale;
    let ends = [
        [[left, y - 1.2], [left, y + 1.2]],
        [[right, y - 1.2], [right, y + 1.2]],
    ];
    let stroke = Stroke {
        colour: INK,
        width: 0.5,
    };
    canvas.strokes(&[[[left, y], [right, y]], ends[0], ends[1]], stroke);
    let label = format!("{} {units}", grid_label(step, step));
    canvas.text([right, top], style(Anchor::End, true), &label);
    let note = TextStyle {
        colour: GREY,
        size: 2.5,
        ..style(Anchor::End, false)
    };
    canvas.text([right, y + 5.0], note, remark);
}

/// An angle with as many digits as are worth reading.
fn short(degrees: f64) -> String {
    match degrees {
        d if d >= 0.995 => format!("{d:.2}")
            .trim_end_matches('0')
            .trim_end_matches('.')
            .to_owned(),
        d if d >= 0.001 => format!("{d:.3}"),
        _ => "0".to_owned(),
    }
}
