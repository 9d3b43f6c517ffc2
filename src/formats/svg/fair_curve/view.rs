//! The curve in one projection.

use super::super::canvas::{Anchor, Canvas, Spot, Stroke, TextStyle};
use super::super::key::Sample;
use super::super::layout::round_step;
use super::super::moves::Moves;
use super::super::panel::Panel;
use super::super::text;
use super::super::views::INK;
use super::{BEFORE, COMB, CURVE, panel_left, panel_width, samples};
use crate::formats::fair_curve::{FairCurveDrawing, Tooth};
use nalgebra::Point3;

/// White space around the curve for its comb and moves, mm.
const PADDING: f64 = 17.0;
/// The longest tooth of the comb, mm; the next round scale below it is taken.
const LONGEST_TOOTH: f64 = 13.0;
/// Height of the curve itself in all views together, mm.
const HEIGHT: f64 = 120.0;
/// A curve flatter than this on paper is stretched, mm …
const FLAT: f64 = 20.0;
/// … to about this height, mm …
const STRETCHED: f64 = 38.0;
/// … by this factor at most: more would show rounding as shape.
const MOST_STRETCH: f64 = 100.0;
/// Space between views for their numbers and names, mm.
const GAP: f64 = 14.0;
/// Space between views side by side, mm.
const SIDE_GAP: f64 = 16.0;
/// Distance of drawn teeth, mm.
const TOOTH_SPACING: f64 = 0.9;

/// A projection of the curve on the page.
pub(super) struct View {
    /// Coordinate to the right, coordinate upwards.
    pub axes: [usize; 2],
    /// Its place.
    pub panel: Panel,
    /// How much more the second coordinate is enlarged than the first.
    pub stretch: f64,
    /// Samples along the curve on the page.
    line: Vec<Spot>,
    /// Millimetres of a tooth per unit of curvature.
    tooth: f64,
}

impl View {
    /// "z stretched 10×" or "same scale both ways".
    pub fn stretch_remark(&self) -> String {
        if self.stretch > 1.0 {
            let axis = AXES[self.axes[1]];
            format!(
                "along {}; {axis} stretched {}×",
                AXES[self.axes[0]], self.stretch
            )
        } else {
            "same scale both ways".to_owned()
        }
    }
}

/// Names of the coordinates.
const AXES: [&str; 3] = ["x", "y", "z"];

/// Least and greatest coordinates of what is drawn in true place.
fn ranges(drawing: &FairCurveDrawing, samples: &[(f64, Point3<f64>)]) -> [[f64; 2]; 3] {
    let points = drawing.points.iter().filter(|p| p.is_finite());
    // A slip stands where it was given; the others near the curve.
    let slips = points.filter_map(|p| p.slip.map(|slip| [slip, p.given]));
    let curve = samples.iter().map(|(_, p)| *p);
    let mut ranges = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
    for place in curve.chain(slips.flatten()) {
        for (range, c) in ranges.iter_mut().zip(place.iter()) {
            *range = [range[0].min(*c), range[1].max(*c)];
        }
    }
    ranges
}

/// The one or two projections that show most, the longest coordinate to the
/// right in both, z upwards wherever it is shown.
fn projections(drawing: &FairCurveDrawing, extent: [f64; 3]) -> Vec<[usize; 2]> {
    /// A share of the length below which a coordinate is constant.
    const FLAT_SHARE: f64 = 1e-9;
    if drawing.dimension < 3 {
        return vec![[0, 1]];
    }
    let mut order = [0, 1, 2];
    order.sort_by(|a, b| extent[*b].total_cmp(&extent[*a]));
    let [long, middle, short] = order;
    let upright = |a: usize, b: usize| if a == 2 { [b, a] } else { [a, b] };
    let mut views = vec![upright(long, middle)];
    if extent[short] > FLAT_SHARE * extent[long] {
        views.push(upright(long, short));
    }
    views
}

/// Places the views below `top` mm.
pub(super) fn arrange(
    drawing: &FairCurveDrawing,
    samples: &[(f64, Point3<f64>)],
    top: f64,
) -> Vec<View> {
    let ranges = ranges(drawing, samples);
    let extent = ranges.map(|r| r[1] - r[0]);
    let projections = projections(drawing, extent);
    let height = HEIGHT / projections.len() as f64;
    let room = panel_width() - 2.0 * PADDING;
    let mut corner = [panel_left(), top];
    let mut views: Vec<View> = Vec::new();
    for axes in projections {
        let extents = axes.map(|i| extent[i]);
        let [a, b] = extents;
        let scale = positive((room / a).min(height / b));
        let stretch = stretch(b * scale, height);
        let scales = [scale, scale * stretch];
        let size = [0, 1].map(|i| extents[i] * scales[i] + 2.0 * PADDING);
        if let Some(last) = views.last() {
            let beside = last.panel.right() + SIDE_GAP;
            corner = if beside + size[0] <= panel_left() + panel_width() {
                [beside, last.panel.corner[1]]
            } else {
                [panel_left(), last.panel.bottom() + GAP]
            };
        }
        let panel = Panel {
            corner,
            size,
            low: [0, 1].map(|i| ranges[axes[i]][0] - PADDING / scales[i]),
            scale: scales,
        };
        let line = samples.iter().map(|(_, p)| panel.map(axes.map(|i| p[i])));
        views.push(View {
            axes,
            panel,
            stretch,
            line: line.collect(),
            tooth: tooth_scale(&drawing.comb),
        });
    }
    views
}

/// A scale that can be drawn with.
fn positive(scale: f64) -> f64 {
    if scale > 0.0 && scale.is_finite() {
        scale
    } else {
        1.0
    }
}

/// The factor for a curve of this height on paper, mm.
fn stretch(height: f64, room: f64) -> f64 {
    if height >= FLAT || height <= 0.0 {
        return 1.0;
    }
    round_down(STRETCHED.min(room) / height).clamp(1.0, MOST_STRETCH)
}

/// The largest 1, 2 or 5 times a power of ten that is not above `value`.
fn round_down(value: f64) -> f64 {
    let step = round_step(value);
    if step <= value {
        return step;
    }
    // `round_step` went up by one step; the steps are factors of 2 or 2.5.
    round_step(step / 2.25)
}

/// Millimetres per unit of curvature: 1, 2 or 5 times a power of ten.
fn tooth_scale(comb: &[Tooth]) -> f64 {
    let largest = comb.iter().map(|t| t.curvature.abs());
    let largest = largest.filter(|k| k.is_finite()).fold(0.0, f64::max);
    if largest > 0.0 {
        round_down(LONGEST_TOOTH / largest)
    } else {
        0.0
    }
}

/// The moves, enlarged for the view with the largest scale.
pub(super) fn moves<'a>(drawing: &'a FairCurveDrawing, views: &[View]) -> Moves<'a> {
    let scale = views.iter().flat_map(|v| v.panel.scale).fold(0.0, f64::max);
    Moves::choose(&drawing.points, positive(scale))
}

/// Draws one view.
pub(super) fn draw(
    canvas: &mut Canvas,
    drawing: &FairCurveDrawing,
    view: &View,
    moves: &Moves<'_>,
) {
    let panel = &view.panel;
    let step = |axis: usize| round_step(30.0 / panel.scale[axis] / (1.0 + axis as f64));
    panel.grid(canvas, [step(0), step(1)]);
    heading(canvas, view, &drawing.units);
    draw_comb(canvas, drawing, view);
    if let Some(before) = &drawing.before {
        let line = samples(before);
        let line: Vec<Spot> = line
            .iter()
            .map(|(_, p)| panel.map(view.axes.map(|i| p[i])))
            .collect();
        let stroke = Stroke {
            colour: BEFORE,
            width: 0.25,
        };
        panel.clipped(canvas, &line, stroke);
    }
    canvas.polyline(
        &view.line,
        Stroke {
            colour: CURVE,
            width: 0.55,
        },
    );
    moves.draw(canvas, panel, view.axes);
}

/// The name of a view above its panel.
fn heading(canvas: &mut Canvas, view: &View, units: &str) {
    let [a, b] = view.axes.map(|i| AXES[i]);
    let [left, top] = view.panel.corner;
    let style = TextStyle {
        size: 3.0,
        colour: INK,
        anchor: Anchor::Start,
        bold: true,
    };
    let stretch = if view.stretch > 1.0 {
        format!(", {b} stretched {}×", view.stretch)
    } else {
        String::new()
    };
    let text = format!("Curve with comb ({a}–{b}, {units}{stretch})");
    let room = view.panel.size[0] + SIDE_GAP - 2.0;
    // Bold type runs a tenth wider than the estimate.
    let text = text::clip(&text, style.size, room / 1.1);
    canvas.text([left, top - 2.2], style, &text);
}

/// Teeth on the outside of the bend, and the line through their tips.
fn draw_comb(canvas: &mut Canvas, drawing: &FairCurveDrawing, view: &View) {
    let teeth = drawing.comb.iter().filter_map(|t| tooth(view, t));
    let teeth: Vec<[Spot; 2]> = teeth.collect();
    let mut kept: Vec<[Spot; 2]> = Vec::new();
    for tooth in &teeth {
        let far = |last: &[Spot; 2]| {
            (last[0][0] - tooth[0][0]).hypot(last[0][1] - tooth[0][1]) >= TOOTH_SPACING
        };
        if kept.last().is_none_or(far) {
            kept.push(*tooth);
        }
    }
    kept.extend(teeth.last());
    let stroke = Stroke {
        colour: COMB,
        width: 0.14,
    };
    canvas.strokes(&kept, stroke);
    let tips: Vec<Spot> = teeth.iter().map(|t| t[1]).collect();
    canvas.polyline(
        &tips,
        Stroke {
            width: 0.3,
            ..stroke
        },
    );
}

/// Foot and tip of a tooth on the page. In a stretched view it stands square
/// on the stretched curve, for normals are stretched the other way round.
pub(super) fn tooth(view: &View, tooth: &Tooth) -> Option<[Spot; 2]> {
    let [i, j] = view.axes;
    let foot = view.panel.map([tooth.point[i], tooth.point[j]]);
    let flat = [tooth.normal[i], tooth.normal[j]];
    let shown = flat[0].hypot(flat[1]);
    let page = [flat[0], -flat[1] / view.stretch];
    let length = page[0].hypot(page[1]);
    let reach = -tooth.curvature * view.tooth * shown / if length > 0.0 { length } else { 1.0 };
    let tip = [foot[0] + page[0] * reach, foot[1] + page[1] * reach];
    tip.iter()
        .chain(&foot)
        .all(|c| c.is_finite())
        .then_some([foot, tip])
}

/// Entries of the key for the lines.
pub(super) fn key(drawing: &FairCurveDrawing, views: &[View]) -> Vec<(Sample, String)> {
    let line = |colour, width| Stroke { colour, width };
    let mut entries = vec![(Sample::Line(line(CURVE, 0.55)), "fair curve".to_owned())];
    if drawing.before.is_some() {
        entries.push((
            Sample::Line(line(BEFORE, 0.25)),
            "curve through the points as given".to_owned(),
        ));
    }
    if let Some(view) = views.first().filter(|v| v.tooth > 0.0) {
        let ten = 10.0 / view.tooth;
        entries.push((
            Sample::Line(line(COMB, 0.3)),
            format!(
                "curvature comb: 10 mm of tooth = {} 1/{}",
                short(ten),
                drawing.units
            ),
        ));
    }
    entries
}

/// A round number without the dust of division.
fn short(value: f64) -> String {
    let text = format!("{value:.6e}");
    text.parse::<f64>().map_or(text, |v| v.to_string())
}
