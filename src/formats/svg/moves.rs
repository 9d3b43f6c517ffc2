//! Points that moved, drawn so that the moves are seen: every point stands off
//! the fair shape by a stated multiple of its move.

use super::canvas::{Anchor, Canvas, Spot, Stroke, TextStyle};
use super::key::{Sample, cross};
use super::layout::round_step;
use super::panel::Panel;
use crate::formats::fair_points::FairPoint;
use nalgebra::{Point3, Vector3};

/// Colour of suspected slips.
pub(super) const SLIP: &str = "#d0021b";
/// Colour of points at the limit of their tolerance.
pub(super) const AT_LIMIT: &str = "#e07b00";
/// Colour of points that are as given.
const GIVEN: &str = "#1b1b1b";
/// The largest move drawn, mm.
const LONGEST: f64 = 6.0;
/// Points drawn at most; more would be a grey cloud. All slips are drawn, up
/// to [`MOST_SLIPS`].
const MOST: usize = 500;
/// Slips drawn at most.
const MOST_SLIPS: usize = 60;
/// With more points than this their discs are drawn smaller, so that they do
/// not hide the curve.
const CROWD: usize = 80;
/// Width of hair lines, mm.
const HAIR: f64 = 0.2;

/// The points worth drawing and how much their moves are enlarged.
pub(super) struct Moves<'a> {
    /// Slips first, then the others thinned out evenly.
    pub points: Vec<&'a FairPoint>,
    /// Factor on every move; 1 or more.
    pub factor: f64,
    /// Points there are in all.
    pub total: usize,
}

impl<'a> Moves<'a> {
    /// Chooses points and factor for a drawing with this many millimetres per
    /// unit of length.
    pub fn choose(points: &'a [FairPoint], scale: f64) -> Self {
        let (slips, plain): (Vec<&FairPoint>, Vec<&FairPoint>) = points
            .iter()
            .filter(|p| p.is_finite())
            .partition(|p| p.slip.is_some());
        let longest = plain
            .iter()
            .map(|p| p.distance.max((p.now - p.given).norm()))
            .fold(0.0, f64::max);
        // Not below 1: a move is never drawn smaller than it is.
        let factor = if longest > 0.0 {
            round_step(LONGEST / (longest * scale) / 1.25).max(1.0)
        } else {
            1.0
        };
        let stride = plain.len().div_ceil(MOST).max(1);
        let mut kept: Vec<&FairPoint> = slips.into_iter().take(MOST_SLIPS).collect();
        kept.extend(plain.into_iter().step_by(stride));
        Moves {
            points: kept,
            factor,
            total: points.len(),
        }
    }

    /// Draws them in a view along two axes.
    pub fn draw(&self, canvas: &mut Canvas, panel: &Panel, axes: [usize; 2]) {
        let place = |p: &Point3<f64>| panel.map(axes.map(|a| p[a]));
        let step = |v: Vector3<f64>| panel.map_step(axes.map(|a| v[a] * self.factor));
        let plain = || self.points.iter().filter(|p| p.slip.is_none());
        let mut stems = Vec::new();
        let mut limits = Vec::new();
        for point in plain() {
            let foot = place(&point.now);
            let offset = step(point.given - point.now);
            stems.push([foot, plus(foot, offset)]);
            limits.extend(limit_tick(point, foot, &step));
        }
        canvas.strokes(&limits, stroke("#8a8f98"));
        canvas.strokes(&stems, stroke(GIVEN));
        let radius = if self.points.len() > CROWD {
            0.45
        } else {
            0.75
        };
        for point in plain() {
            let tip = plus(place(&point.now), step(point.given - point.now));
            let fill = if point.at_limit { AT_LIMIT } else { "#ffffff" };
            canvas.circle(tip, radius, fill, stroke(GIVEN));
        }
        for point in self.points.iter().filter(|p| p.slip.is_some()) {
            draw_slip(canvas, point, place);
        }
    }

    /// What was drawn, for the key.
    pub fn key(&self) -> Vec<(Sample, String)> {
        let times = if self.factor > 1.0 {
            format!("moves enlarged {}×", self.factor)
        } else {
            "moves in true size".to_owned()
        };
        let mut shown = format!("point as given, {times}");
        if self.points.len() < self.total {
            shown.push_str(&format!("; {} of {} drawn", self.points.len(), self.total));
        }
        let mut entries = vec![(Sample::Disc("#ffffff", stroke(GIVEN)), shown)];
        if self.points.iter().any(|p| p.at_limit && p.slip.is_none()) {
            entries.push((
                Sample::Disc(AT_LIMIT, stroke(GIVEN)),
                "point at the limit of its tolerance".to_owned(),
            ));
        }
        if self
            .points
            .iter()
            .any(|p| p.tolerance.is_some_and(|t| t > 0.0))
        {
            let meaning = format!("limit of tolerance, {times}");
            entries.push((Sample::Line(stroke("#8a8f98")), meaning));
        }
        if self.points.iter().any(|p| p.slip.is_some()) {
            let meaning = "suspected slip, with its number; ring: place expected";
            entries.push((Sample::Cross(heavy()), meaning.to_owned()));
        }
        entries
    }
}

/// A bar across the move where the tolerance ends.
fn limit_tick(
    point: &FairPoint,
    foot: Spot,
    step: &impl Fn(Vector3<f64>) -> Spot,
) -> Option<[Spot; 2]> {
    const HALF: f64 = 0.9;
    let direction = (point.given - point.now).try_normalize(0.0)?;
    let tolerance = point.tolerance.filter(|t| *t > 0.0)?;
    let end = step(direction * tolerance);
    let length = end[0].hypot(end[1]);
    // Far outside the picture it says nothing.
    if !(length > 0.0 && length < 4.0 * LONGEST) {
        return None;
    }
    let across = [-end[1] / length * HALF, end[0] / length * HALF];
    let middle = plus(foot, end);
    Some([plus(middle, across), plus(middle, across.map(|c| -c))])
}

/// A cross where the point was given, a ring where it was expected.
fn draw_slip(canvas: &mut Canvas, point: &FairPoint, place: impl Fn(&Point3<f64>) -> Spot) {
    let Some(expected) = point.slip else { return };
    let [from, to] = [place(&point.given), place(&expected)];
    canvas.dashed(&[from, to], stroke(SLIP));
    canvas.circle(to, 1.3, "none", heavy());
    cross(canvas, from, heavy());
    let style = TextStyle {
        size: 2.6,
        colour: SLIP,
        anchor: Anchor::Start,
        bold: true,
    };
    canvas.text(
        [from[0] + 1.9, from[1] - 1.3],
        style,
        &point.index.to_string(),
    );
}

fn stroke(colour: &'static str) -> Stroke<'static> {
    Stroke {
        colour,
        width: HAIR,
    }
}

fn heavy() -> Stroke<'static> {
    Stroke {
        colour: SLIP,
        width: 0.45,
    }
}

fn plus(a: Spot, b: Spot) -> Spot {
    [a[0] + b[0], a[1] + b[1]]
}
