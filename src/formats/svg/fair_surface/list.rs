//! The largest moves and the suspected slips: numbers on the sheet, a list
//! beside it.

use super::super::canvas::{Anchor, Canvas, Spot, Stroke, TextStyle};
use super::super::key::{Sample, cross};
use super::super::layout::{MARGIN, PAGE_WIDTH};
use super::super::moves::{AT_LIMIT, SLIP};
use super::super::panel::Panel;
use super::super::text;
use super::super::views::{GREY, INK, MARK_RADIUS, mark};
use super::LIST_WIDTH;
use super::chart::Chart;
use crate::formats::fair_points::FairPoint;
use crate::formats::fair_surface::FairSurfaceDrawing;

/// Moves in the list.
const MOST_MOVES: usize = 12;
/// Slips in the list.
const MOST_SLIPS: usize = 10;
/// Points drawn as dots when there are no more than this: a grid or a table,
/// not a scan.
const FEW: usize = 1500;
/// Room for the use of the tolerance at the end of a line, mm.
const USED_WIDTH: f64 = 16.0;
/// Height of the type, mm.
const TYPE: f64 = 2.8;
/// Distance of two lines, mm.
const LINE: f64 = 4.9;

/// Draws marks and list; returns the lower edge of the list, mm.
pub(super) fn draw(
    canvas: &mut Canvas,
    drawing: &FairSurfaceDrawing,
    chart: &Chart<'_>,
    panel: &Panel,
) -> f64 {
    let place = |p: &FairPoint| panel.map(chart.place_in_space(&p.now));
    dots(canvas, drawing, &place, panel);
    let slips = slips(drawing);
    for slip in slips.iter().take(MOST_SLIPS) {
        let heavy = Stroke {
            colour: SLIP,
            width: 0.45,
        };
        let at = place(slip);
        cross(canvas, at, heavy);
        let style = style(SLIP, true);
        canvas.text([at[0] + 1.9, at[1] - 1.3], style, &slip.index.to_string());
    }
    let moves = largest(drawing);
    // The largest last, and so on top.
    for (rank, point) in moves.iter().enumerate().rev() {
        let at = place(point);
        if panel.holds(at) {
            mark(canvas, at, rank + 1);
        }
    }
    let left = PAGE_WIDTH - MARGIN - LIST_WIDTH;
    let mut y = panel.corner[1] + 1.0;
    y = move_list(canvas, drawing, &moves, [left, y]);
    if !slips.is_empty() {
        y = slip_list(canvas, drawing, &slips, [left, y + 4.0]);
    }
    y
}

/// What the marks mean.
pub(super) fn key(drawing: &FairSurfaceDrawing) -> Vec<(Sample, String)> {
    let ink = Stroke {
        colour: INK,
        width: 0.3,
    };
    let mut entries = Vec::new();
    if !largest(drawing).is_empty() {
        entries.push((
            Sample::Disc("#ffffff", ink),
            "one of the largest moves, by its number in the list".to_owned(),
        ));
    }
    if !slips(drawing).is_empty() {
        let stroke = Stroke {
            colour: SLIP,
            width: 0.45,
        };
        let meaning = "suspected slip, with the number of the point";
        entries.push((Sample::Cross(stroke), meaning.to_owned()));
    }
    if drawing.points.len() <= FEW && drawing.points.iter().any(|p| p.at_limit) {
        entries.push((
            Sample::Disc(AT_LIMIT, ink),
            "small: point at the limit of its tolerance".to_owned(),
        ));
    }
    entries
}

/// All points as dots, where they are few.
fn dots(
    canvas: &mut Canvas,
    drawing: &FairSurfaceDrawing,
    place: &impl Fn(&FairPoint) -> Spot,
    panel: &Panel,
) {
    if drawing.points.len() > FEW {
        return;
    }
    for point in drawing.points.iter().filter(|p| p.is_finite()) {
        let (fill, radius) = if point.at_limit {
            (AT_LIMIT, 0.6)
        } else {
            ("#ffffff", 0.4)
        };
        let border = Stroke {
            colour: GREY,
            width: 0.12,
        };
        let at = place(point);
        if panel.holds(at) {
            canvas.circle(at, radius, fill, border);
        }
    }
}

/// Suspected slips, the farthest off first.
fn slips(drawing: &FairSurfaceDrawing) -> Vec<&FairPoint> {
    let off = |p: &FairPoint| p.slip.map_or(0.0, |s| (s - p.given).norm());
    let finite = drawing.points.iter().filter(|p| p.is_finite());
    let mut slips: Vec<&FairPoint> = finite.filter(|p| p.slip.is_some()).collect();
    slips.sort_by(|a, b| off(b).total_cmp(&off(a)));
    slips
}

/// The largest moves of points that are not slips.
fn largest(drawing: &FairSurfaceDrawing) -> Vec<&FairPoint> {
    let finite = drawing.points.iter().filter(|p| p.is_finite());
    let plain = finite.filter(|p| p.slip.is_none() && p.distance > 0.0);
    let mut moves: Vec<&FairPoint> = plain.collect();
    moves.sort_by(|a, b| b.distance.total_cmp(&a.distance));
    moves.truncate(MOST_MOVES);
    moves
}

fn move_list(
    canvas: &mut Canvas,
    drawing: &FairSurfaceDrawing,
    moves: &[&FairPoint],
    [left, mut y]: Spot,
) -> f64 {
    let heading = format!("Largest moves ({})", drawing.units);
    canvas.text([left, y], style(INK, true), &heading);
    for (rank, point) in moves.iter().enumerate() {
        y += LINE;
        mark(canvas, [left + MARK_RADIUS, y - 0.95], rank + 1);
        let words = format!("point {}", point.index);
        canvas.text([left + 5.5, y], style(INK, false), &words);
        line_end(
            canvas,
            [left + LIST_WIDTH - USED_WIDTH, y],
            &short(point.distance),
        );
        if let Some(share) = point.used() {
            line_end(
                canvas,
                [left + LIST_WIDTH, y],
                &format!("{:.0} %", share * 100.0),
            );
        }
    }
    y + LINE
}

fn slip_list(
    canvas: &mut Canvas,
    drawing: &FairSurfaceDrawing,
    slips: &[&FairPoint],
    [left, mut y]: Spot,
) -> f64 {
    let heading = format!("Suspected slips: off by ({})", drawing.units);
    canvas.text([left, y], style(SLIP, true), &heading);
    for slip in slips.iter().take(MOST_SLIPS) {
        y += LINE;
        let words = format!("point {}", slip.index);
        canvas.text([left + 5.5, y], style(INK, false), &words);
        let off = slip
            .slip
            .map_or(0.0, |expected| (expected - slip.given).norm());
        line_end(canvas, [left + LIST_WIDTH - USED_WIDTH, y], &short(off));
    }
    if slips.len() > MOST_SLIPS {
        y += LINE;
        let more = format!("and {} more, in the table", slips.len() - MOST_SLIPS);
        canvas.text([left + 5.5, y], style(GREY, false), &more);
    }
    y + LINE
}

/// A figure that ends here.
fn line_end(canvas: &mut Canvas, at: Spot, figure: &str) {
    let style = TextStyle {
        anchor: Anchor::End,
        ..style(INK, false)
    };
    canvas.text(at, style, &text::clip(figure, TYPE, LIST_WIDTH - 28.0));
}

fn style(colour: &'static str, bold: bool) -> TextStyle {
    TextStyle {
        size: TYPE,
        colour,
        anchor: Anchor::Start,
        bold,
    }
}

/// A length to three digits.
fn short(length: f64) -> String {
    if !(length > 0.0 && length.is_finite()) {
        return "0".to_owned();
    }
    let decimals = (2.0 - length.log10().floor()).clamp(0.0, 12.0) as usize;
    format!("{length:.decimals$}")
}
