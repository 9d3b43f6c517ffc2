//! The words beside the lines plan: the largest moves, the key.

use super::super::canvas::{Anchor, Canvas, Stroke, TextStyle};
use super::super::key::Sample;
use super::super::layout::{MARGIN, PAGE_WIDTH};
use super::super::moves::SLIP;
use super::super::text;
use super::super::views::{GREY, INK, MARK_RADIUS, mark};
use super::{LINE, MOST_MOVES, OLD};
use crate::formats::offsets::{OffsetsDrawing, Placed, by_size, placed};

/// Width of the list of moves, mm.
const LIST_WIDTH: f64 = 68.0;

/// The largest moves at the right; returns the lower edge, mm.
pub(super) fn moves(canvas: &mut Canvas, drawing: &OffsetsDrawing, top: f64) -> f64 {
    const SIZE: f64 = 2.8;
    let left = PAGE_WIDTH - MARGIN - LIST_WIDTH;
    let style = |anchor, bold, colour| TextStyle {
        size: SIZE,
        colour,
        anchor,
        bold,
    };
    let mut y = top + 1.0;
    let columns = [left + 26.0, left + 44.0, left + LIST_WIDTH];
    let heads = ["station", "waterline", "move"];
    let bold = style(Anchor::End, true, INK);
    for (x, head) in columns.iter().zip(heads) {
        canvas.text([*x, y], bold, head);
    }
    for (rank, p) in by_size(drawing).iter().take(MOST_MOVES).enumerate() {
        y += 5.0;
        mark(canvas, [left + MARK_RADIUS, y - 0.95], rank + 1);
        let step = p.cell.step().unwrap_or_default();
        let step = format!(
            "{}{}",
            if step < 0.0 { "−" } else { "+" },
            short(step.abs())
        );
        let colour = if p.cell.slip.is_some() { SLIP } else { INK };
        let figures = [short(p.station), short(p.waterline), step];
        for (x, figure) in columns.iter().zip(figures) {
            let figure = text::clip(&figure, SIZE, 24.0);
            canvas.text([*x, y], style(Anchor::End, false, colour), &figure);
        }
    }
    if y < top + 2.0 {
        canvas.text(
            [left, y + 5.0],
            style(Anchor::Start, false, GREY),
            "no offset moved",
        );
    }
    y + 9.0
}

/// What lines and marks mean.
pub(super) fn key(drawing: &OffsetsDrawing) -> Vec<(Sample, String)> {
    let line = |colour, width| Stroke { colour, width };
    let mut entries = vec![
        (
            Sample::Line(line(LINE, 0.4)),
            "faired line, named by its place".to_owned(),
        ),
        (
            Sample::Line(line(OLD, 0.35)),
            "offset as given (tick)".to_owned(),
        ),
    ];
    let any = |test: fn(&Placed) -> bool| placed(drawing).any(|p| test(&p));
    if any(|p| p.cell.slip.is_some()) {
        let meaning = "suspected slip; ring: place expected";
        entries.push((Sample::Cross(line(SLIP, 0.4)), meaning.to_owned()));
    }
    if any(|p| p.cell.filled) {
        let meaning = "offset that was missing, from the fair shape";
        entries.push((Sample::Disc("#ffffff", line(OLD, 0.2)), meaning.to_owned()));
    }
    entries
}

/// A figure to four digits without trailing zeros.
pub(super) fn short(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return "0".to_owned();
    }
    let decimals = (3.0 - value.abs().log10().floor()).clamp(0.0, 12.0) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}
