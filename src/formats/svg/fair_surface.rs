//! The page of a faired surface: isophotes as bands, the outline, the largest
//! moves and the suspected slips by number.
//!
//! The sheet is drawn as seen square to its best plane; one that folds over
//! itself there is drawn in its parameters.

mod bands;
mod chart;
mod list;

use super::canvas::{Anchor, Canvas, Spot, Stroke, TextStyle};
use super::key::{self, Sample};
use super::layout::{MARGIN, PAGE_WIDTH, round_step};
use super::legend;
use super::page::{self, Words};
use super::panel::Panel;
use super::views::INK;
use crate::formats::fair_surface::FairSurfaceDrawing;
use crate::formats::fair_surface::outline::Outline;
use chart::Chart;

/// Room for the list of moves at the right, mm.
const LIST_WIDTH: f64 = 76.0;
/// The drawing is never taller than this, mm.
const HEIGHT: f64 = 150.0;
/// White space around the sheet, mm.
const PADDING: f64 = 5.0;

/// The whole page.
pub(in crate::formats) fn plot(drawing: &FairSurfaceDrawing) -> String {
    let mut canvas = Canvas::default();
    let words = Words {
        title: &drawing.title,
        units: &drawing.units,
        verdict: &drawing.verdict,
        good: drawing.verdict != "outside_limits",
        summary: &drawing.summary,
    };
    let top = page::heading(&mut canvas, &words) + 9.0;
    let outline = Outline::of(drawing);
    let chart = Chart::of(drawing, &outline);
    let panel = panel(&chart, top);
    let step = round_step(30.0 / panel.scale[0]);
    let key = bands::draw(&mut canvas, drawing, &chart, &panel);
    trim(&mut canvas, &outline, &chart, &panel);
    panel.grid(&mut canvas, [step; 2]);
    heading(&mut canvas, &chart, &panel, &drawing.units);
    let bottom = list::draw(&mut canvas, drawing, &chart, &panel);
    let mut y = bottom.max(panel.bottom()) + 12.0;
    if chart.is_true_to_scale() {
        let at = [y, panel.scale[0]];
        legend::scale_bar(&mut canvas, &drawing.units, at, "same scale both ways");
    }
    let mut entries: Vec<(Sample, String)> = key.into_iter().collect();
    entries.extend(list::key(drawing));
    y = key::draw(&mut canvas, &entries, y);
    y = page::sentences(&mut canvas, &words, y.max(bottom) + 10.5);
    canvas.finish([PAGE_WIDTH, page::height(y)], &drawing.title)
}

/// The panel that shows the whole chart.
fn panel(chart: &Chart, top: f64) -> Panel {
    let left = MARGIN + 12.0;
    let extent = chart.ranges.map(|r| r[1] - r[0]);
    let room = [PAGE_WIDTH - MARGIN - LIST_WIDTH - 8.0 - left, HEIGHT];
    let fits = [0, 1].map(|i| (room[i] - 2.0 * PADDING) / extent[i]);
    let scale = fits[0].min(fits[1]);
    let scale = if scale.is_finite() && scale > 0.0 {
        scale
    } else {
        1.0
    };
    Panel {
        corner: [left, top],
        size: extent.map(|e| e * scale + 2.0 * PADDING),
        low: chart.ranges.map(|r| r[0] - PADDING / scale),
        scale: [scale; 2],
    }
}

/// Covers what lies beyond the outline and draws it.
fn trim(canvas: &mut Canvas, outline: &Outline, chart: &Chart, panel: &Panel) {
    let rings = outline.rings.iter().map(|ring| chart.ring(ring, panel));
    let rings: Vec<Vec<Spot>> = rings.collect();
    let [left, top] = panel.corner;
    let [right, bottom] = [panel.right(), panel.bottom()];
    let sheet = vec![[left, top], [right, top], [right, bottom], [left, bottom]];
    if let [outer, holes @ ..] = &rings[..] {
        canvas.areas(&[sheet, outer.clone()], "#ffffff");
        for hole in holes {
            canvas.areas(std::slice::from_ref(hole), "#ffffff");
        }
    }
    for ring in &rings {
        let closed: Vec<Spot> = ring.iter().chain(ring.first()).copied().collect();
        let stroke = Stroke {
            colour: INK,
            width: 0.4,
        };
        canvas.polyline(&closed, stroke);
    }
}

fn heading(canvas: &mut Canvas, chart: &Chart, panel: &Panel, units: &str) {
    let style = TextStyle {
        size: 3.0,
        colour: INK,
        anchor: Anchor::Start,
        bold: true,
    };
    let text = format!("Isophotes ({})", chart.name(units));
    canvas.text([panel.corner[0], panel.corner[1] - 2.2], style, &text);
}

#[cfg(test)]
mod tests;
