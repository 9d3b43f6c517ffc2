//! A key to a drawing: samples of lines and marks with what they mean, in
//! columns, and a scale bar.

use super::canvas::{Anchor, Canvas, Spot, Stroke, TextStyle};
use super::layout::MARGIN;
use super::text;
use super::views::INK;

/// Height of the type, mm.
const TYPE: f64 = 2.8;
/// Distance of two entries, mm.
const LINE: f64 = 5.0;
/// Width of a sample, mm.
const SAMPLE: f64 = 9.0;
/// Width of a column, mm.
const COLUMN: f64 = 112.0;

/// How a meaning is shown.
#[derive(Debug, Clone, Copy)]
pub(super) enum Sample {
    /// A full line.
    Line(Stroke<'static>),
    /// A small disc with a border.
    Disc(&'static str, Stroke<'static>),
    /// A cross.
    Cross(Stroke<'static>),
    /// A filled field.
    Field(&'static str),
}

/// Draws the entries in two columns below `top`; returns the last base line.
pub(super) fn draw(canvas: &mut Canvas, entries: &[(Sample, String)], top: f64) -> f64 {
    let rows = entries.len().div_ceil(2);
    for (index, (sample, meaning)) in entries.iter().enumerate() {
        let x = MARGIN + COLUMN * (index / rows.max(1)) as f64;
        let y = top + LINE * (index % rows.max(1)) as f64;
        draw_sample(canvas, *sample, [x, y - 0.95]);
        let style = TextStyle {
            size: TYPE,
            colour: INK,
            anchor: Anchor::Start,
            bold: false,
        };
        let room = COLUMN - SAMPLE - 5.0;
        canvas.text(
            [x + SAMPLE + 2.0, y],
            style,
            &text::clip(meaning, TYPE, room),
        );
    }
    top + LINE * rows.saturating_sub(1) as f64
}

fn draw_sample(canvas: &mut Canvas, sample: Sample, [x, y]: Spot) {
    let ends = [[x, y], [x + SAMPLE, y]];
    let middle = [x + SAMPLE / 2.0, y];
    match sample {
        Sample::Line(stroke) => canvas.polyline(&ends, stroke),
        Sample::Disc(fill, stroke) => canvas.circle(middle, 0.9, fill, stroke),
        Sample::Cross(stroke) => cross(canvas, middle, stroke),
        Sample::Field(fill) => canvas.rectangle([x, y - 1.4], [SAMPLE, 2.8], fill),
    }
}

/// A diagonal cross.
pub(super) fn cross(canvas: &mut Canvas, [x, y]: Spot, stroke: Stroke<'_>) {
    const ARM: f64 = 1.3;
    let arms = [
        [[x - ARM, y - ARM], [x + ARM, y + ARM]],
        [[x - ARM, y + ARM], [x + ARM, y - ARM]],
    ];
    canvas.strokes(&arms, stroke);
}
