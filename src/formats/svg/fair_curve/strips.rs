//! Two strips along the curve: its curvature, and how much of the tolerance
//! each point uses.

use super::super::canvas::{Anchor, Canvas, Spot, Stroke, TextStyle};
use super::super::layout::round_step;
use super::super::moves::{AT_LIMIT, Moves};
use super::super::panel::Panel;
use super::super::views::INK;
use super::{BEFORE, CURVE, panel_left, panel_width, samples};
use crate::formats::fair_curve::{FairCurveDrawing, Tooth};
use crate::formats::fair_points::FairPoint;
use crate::geometry::BSplineCurve;

/// Height of the strip of curvature, mm.
const CURVATURE_HEIGHT: f64 = 42.0;
/// Height of the strip of moves, mm.
const USED_HEIGHT: f64 = 20.0;
/// Space between the two for numbers and names, mm.
const GAP: f64 = 14.0;
/// Use of the tolerance is shown up to this, per cent: what lies above it has
/// missed the limit, and by how much stands in the table.
const MOST_USED: f64 = 150.0;
/// Colour of a curve before that swings beyond the strip: pale, for it would
/// cover the fair one.
const WILD: &str = "#dcc7b3";
/// The curve before may be this many times as far from 0 as the fair one
/// before it is cut off.
const SHOW_BEFORE: f64 = 1.8;

/// Draws both below `top` mm; returns the lower edge of the last.
pub(super) fn draw(
    canvas: &mut Canvas,
    drawing: &FairCurveDrawing,
    moves: &Moves<'_>,
    top: f64,
) -> f64 {
    let teeth: Vec<&Tooth> = drawing
        .comb
        .iter()
        .filter(|t| t.s.is_finite() && t.curvature.is_finite())
        .collect();
    let (Some(first), Some(last)) = (teeth.first(), teeth.last()) else {
        return top - 13.0;
    };
    let length = [first.s, last.s];
    let bottom = curvature(canvas, drawing, &teeth, [top, length[0], length[1]]);
    used(canvas, drawing, &teeth, moves, bottom + GAP)
}

/// κ over the arc length; `at` is the top and the ends of the arc length.
fn curvature(
    canvas: &mut Canvas,
    drawing: &FairCurveDrawing,
    teeth: &[&Tooth],
    [top, start, end]: [f64; 3],
) -> f64 {
    let before = drawing.before.as_ref();
    let before = before
        .map(|c| curvature_along(c, teeth, [start, end]))
        .unwrap_or_default();
    let mut range = range(teeth.iter().map(|t| t.curvature));
    let reach = SHOW_BEFORE * range[0].abs().max(range[1].abs());
    for (_, k) in before.iter().filter(|(_, k)| k.is_finite()) {
        range = [range[0].min(k.max(-reach)), range[1].max(k.min(reach))];
    }
    let margin = 0.08 * (range[1] - range[0]);
    let ranges = [[start, end], [range[0] - margin, range[1] + margin]];
    let size = [panel_width(), CURVATURE_HEIGHT];
    let panel = Panel::showing(ranges, [panel_left(), top], size);
    panel.grid(canvas, steps(&panel));
    zero_line(canvas, &panel);
    let line: Vec<Spot> = before.iter().map(|(s, k)| panel.map([*s, *k])).collect();
    let edges = [panel.corner[1], panel.bottom()];
    let cut = line.iter().any(|p| p[1] < edges[0] || p[1] > edges[1]);
    let thin = Stroke {
        colour: if cut { WILD } else { BEFORE },
        width: 0.25,
    };
    panel.clipped(canvas, &line, thin);
    let line: Vec<Spot> = teeth
        .iter()
        .map(|t| panel.map([t.s, t.curvature]))
        .collect();
    let heavy = Stroke {
        colour: CURVE,
        width: 0.55,
    };
    panel.clipped(canvas, &line, heavy);
    let note = if cut {
        "; the curve before is cut off"
    } else {
        ""
    };
    let units = &drawing.units;
    title(
        canvas,
        &panel,
        &format!("Curvature κ (1/{units}) along the arc length s ({units}){note}"),
    );
    panel.bottom()
}

/// The range of values with 0 in it; never empty.
fn range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let [low, high] = values.fold([0.0_f64, 0.0_f64], |r, v| [r[0].min(v), r[1].max(v)]);
    if high > low { [low, high] } else { [-1.0, 1.0] }
}

fn steps(panel: &Panel) -> [f64; 2] {
    [
        round_step(30.0 / panel.scale[0]),
        round_step(9.0 / panel.scale[1]),
    ]
}

fn zero_line(canvas: &mut Canvas, panel: &Panel) {
    let y = panel.map([panel.low[0], 0.0])[1];
    let stroke = Stroke {
        colour: INK,
        width: 0.25,
    };
    canvas.strokes(&[[[panel.corner[0], y], [panel.right(), y]]], stroke);
}

fn title(canvas: &mut Canvas, panel: &Panel, text: &str) {
    let style = TextStyle {
        size: 3.0,
        colour: INK,
        anchor: Anchor::Start,
        bold: true,
    };
    canvas.text([panel.corner[0], panel.corner[1] - 2.2], style, text);
}

/// The curvature of another curve over its arc length, which is brought to the
/// given ends; signed by the normals of the teeth.
fn curvature_along(
    curve: &BSplineCurve,
    teeth: &[&Tooth],
    [start, end]: [f64; 2],
) -> Vec<(f64, f64)> {
    let samples = samples(curve);
    let mut lengths = vec![0.0];
    let mut sum = 0.0;
    for pair in samples.windows(2) {
        sum += (pair[1].1 - pair[0].1).norm();
        lengths.push(sum);
    }
    let is_signed = teeth.iter().any(|t| t.curvature < 0.0);
    let at = |(u, _): &(f64, _), length: &f64| {
        let s = start + (end - start) * (length / sum);
        let jet = curve.derivatives(*u);
        let speed = jet.d1.norm();
        let tangent = jet.d1 / speed;
        let vector = (jet.d2 - tangent * tangent.dot(&jet.d2)) / (speed * speed);
        let near = teeth.partition_point(|t| t.s < s).min(teeth.len() - 1);
        let along = vector.dot(&teeth[near].normal);
        let is_plane = vector.z == 0.0 && teeth[near].normal.z == 0.0;
        let sign = if is_signed || is_plane {
            along.signum()
        } else {
            1.0
        };
        (s, sign * vector.norm())
    };
    samples
        .iter()
        .zip(&lengths)
        .map(|(a, b)| at(a, b))
        .collect()
}

/// A stem a point: the share of its tolerance, or its move where there is no
/// tolerance.
fn used(
    canvas: &mut Canvas,
    drawing: &FairCurveDrawing,
    teeth: &[&Tooth],
    moves: &Moves<'_>,
    top: f64,
) -> f64 {
    let limited = moves.points.iter().any(|p| p.used().is_some());
    let height = |p: &FairPoint| {
        if limited {
            p.used().map(|share| (share * 100.0).min(MOST_USED))
        } else {
            Some(p.distance)
        }
    };
    let plain = moves.points.iter().filter(|p| p.slip.is_none());
    let stems = plain.filter_map(|p| Some((nearest(teeth, p), height(p)?, p.at_limit)));
    let stems: Vec<(f64, f64, bool)> = stems.collect();
    let Some(last) = teeth.last().filter(|_| !stems.is_empty()) else {
        return top - GAP;
    };
    let highest = stems
        .iter()
        .map(|s| s.1)
        .fold(if limited { 100.0 } else { 0.0 }, f64::max);
    let ranges = [[teeth[0].s, last.s], [0.0, highest * 1.08]];
    let panel = Panel::showing(ranges, [panel_left(), top], [panel_width(), USED_HEIGHT]);
    let step = if limited {
        50.0
    } else {
        round_step(7.0 / panel.scale[1])
    };
    panel.grid(canvas, [steps(&panel)[0], step]);
    zero_line(canvas, &panel);
    for (is_limit, colour) in [(false, CURVE), (true, AT_LIMIT)] {
        let kept = stems.iter().filter(|s| s.2 == is_limit);
        let lines: Vec<[Spot; 2]> = kept
            .map(|(s, h, _)| [panel.map([*s, 0.0]), panel.map([*s, *h])])
            .collect();
        canvas.strokes(&lines, Stroke { colour, width: 0.8 });
    }
    let text = if limited {
        "Tolerance used by each point (%)".to_owned()
    } else {
        format!("Move of each point ({})", drawing.units)
    };
    title(canvas, &panel, &text);
    panel.bottom()
}

/// The arc length of the tooth nearest to a point.
fn nearest(teeth: &[&Tooth], point: &FairPoint) -> f64 {
    let distance = |t: &&&Tooth| (t.point - point.now).norm_squared();
    let near = teeth
        .iter()
        .min_by(|a, b| distance(a).total_cmp(&distance(b)));
    near.map_or(0.0, |t| t.s)
}
