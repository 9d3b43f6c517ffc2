//! The page of a faired curve: one or two projections with the curvature comb
//! and the enlarged moves, the curvature along the curve, the tolerance used.
//!
//! A long flat curve is stretched upwards by a stated round factor. A curve in
//! space is drawn in the two projections that show most of it.

mod strips;
mod view;

use super::canvas::Canvas;
use super::layout::{MARGIN, PAGE_WIDTH};
use super::page::{self, Words};
use super::sample::samples;
use super::{key, legend};
use crate::formats::fair_curve::FairCurveDrawing;
use view::View;

/// Colour of the fair curve.
const CURVE: &str = "#0b4f8a";
/// Colour of its comb.
const COMB: &str = "#7fb2d9";
/// Colour of the curve before.
const BEFORE: &str = "#9a6b3f";

/// The whole page.
pub(in crate::formats) fn plot(drawing: &FairCurveDrawing) -> String {
    let mut canvas = Canvas::default();
    let words = Words {
        title: &drawing.title,
        units: &drawing.units,
        verdict: &drawing.verdict,
        good: drawing.verdict != "outside_limits",
        summary: &drawing.summary,
    };
    let mut y = page::heading(&mut canvas, &words) + 9.0;
    let samples = samples(&drawing.curve);
    let views = view::arrange(drawing, &samples, y);
    let moves = view::moves(drawing, &views);
    for view in &views {
        view::draw(&mut canvas, drawing, view, &moves);
        y = y.max(view.panel.bottom());
    }
    y = strips::draw(&mut canvas, drawing, &moves, y + 13.0);
    let mut entries = view::key(drawing, &views);
    entries.extend(moves.key());
    if let Some(view) = views.first() {
        scale_bar(&mut canvas, drawing, view, y + 11.0);
    }
    y = key::draw(&mut canvas, &entries, y + 11.0);
    y = page::sentences(&mut canvas, &words, y + 8.5);
    canvas.finish([PAGE_WIDTH, page::height(y)], &drawing.title)
}

fn scale_bar(canvas: &mut Canvas, drawing: &FairCurveDrawing, view: &View, top: f64) {
    let remark = view.stretch_remark();
    legend::scale_bar(canvas, &drawing.units, [top, view.panel.scale[0]], &remark);
}

/// Left edge of every panel, mm: room for the numbers of the axes.
fn panel_left() -> f64 {
    MARGIN + 12.0
}

/// Width of every panel, mm.
fn panel_width() -> f64 {
    PAGE_WIDTH - MARGIN - panel_left()
}

#[cfg(test)]
mod tests;
