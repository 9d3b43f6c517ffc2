//! The lines plan of a faired table of offsets: body plan (fore body to the
//! right, aft body to the left) in its own larger scale, profile with the
//! buttocks and half-breadth plan in one scale below each other.

mod arrange;
mod list;

use super::canvas::{Anchor, Canvas, Spot, Stroke, TextStyle};
use super::key::{self, cross};
use super::layout::{PAGE_WIDTH, round_step};
use super::legend;
use super::moves::SLIP;
use super::page::{self, Words};
use super::panel::Panel;
use super::sample::samples;
use super::text;
use super::views::{INK, mark};
use crate::formats::offsets::{OffsetsDrawing, Placed, by_size, placed};
use crate::geometry::BSplineCurve;
use arrange::{Panels, arrange};
use list::short;
use nalgebra::Point3;

/// Colour of faired lines.
const LINE: &str = "#0b4f8a";
/// Colour of old offsets.
const OLD: &str = "#b5651d";
/// Lines of the table: where stations and waterlines run straight.
const TABLE_LINE: &str = "#c3d3e2";
/// Moves in the list.
const MOST_MOVES: usize = 12;
/// Half the length of a tick, mm.
const TICK: f64 = 0.9;

/// The whole page.
pub(in crate::formats) fn plot(drawing: &OffsetsDrawing) -> String {
    let mut canvas = Canvas::default();
    let words = Words {
        title: &drawing.title,
        units: &drawing.units,
        verdict: &drawing.verdict,
        good: drawing.verdict != "outside_limits",
        summary: &drawing.summary,
    };
    let top = page::heading(&mut canvas, &words) + 9.0;
    let mut y = top;
    if let Some(panels) = arrange(drawing, top) {
        draw_body(&mut canvas, drawing, &panels);
        draw_profile(&mut canvas, drawing, &panels.profile);
        draw_plan(&mut canvas, drawing, &panels.plan);
        let list = list::moves(&mut canvas, drawing, top);
        let bar = [panels.body.bottom().max(list) - 3.0, panels.body.scale[0]];
        legend::scale_bar(&mut canvas, &drawing.units, bar, "body plan");
        y = panels.plan.bottom() + 12.0;
        let bar = [y, panels.plan.scale[0]];
        legend::scale_bar(
            &mut canvas,
            &drawing.units,
            bar,
            "profile and half-breadth plan",
        );
        y = key::draw(&mut canvas, &list::key(drawing), y);
    }
    y = page::sentences(&mut canvas, &words, y + 9.5);
    canvas.finish([PAGE_WIDTH, page::height(y)], &drawing.title)
}

fn frame(canvas: &mut Canvas, panel: &Panel, name: &str) {
    let step = round_step(16.0 / panel.scale[0]);
    panel.grid(canvas, [step; 2]);
    let style = TextStyle {
        size: 3.0,
        colour: INK,
        anchor: Anchor::Start,
        bold: true,
    };
    canvas.text([panel.corner[0], panel.corner[1] - 2.2], style, name);
}

/// Straight lines of the table: across at heights, upright at places.
fn table_lines(canvas: &mut Canvas, panel: &Panel, upright: &[f64], across: &[f64]) {
    let [left, top] = panel.corner;
    let finite = |v: &&f64| v.is_finite();
    let up = upright
        .iter()
        .filter(finite)
        .map(|x| panel.map([*x, panel.low[1]])[0]);
    let over = across
        .iter()
        .filter(finite)
        .map(|z| panel.map([panel.low[0], *z])[1]);
    let up = up.map(|x| [[x, top], [x, panel.bottom()]]);
    let lines: Vec<[Spot; 2]> = up
        .chain(over.map(|y| [[left, y], [panel.right(), y]]))
        .collect();
    let stroke = Stroke {
        colour: TABLE_LINE,
        width: 0.2,
    };
    canvas.strokes(&lines, stroke);
}

/// A curve by two of its coordinates.
fn draw_curve(
    canvas: &mut Canvas,
    curve: &BSplineCurve,
    to: impl Fn(&Point3<f64>) -> Spot,
) -> Vec<Spot> {
    let line: Vec<Spot> = samples(curve).iter().map(|(_, p)| to(p)).collect();
    let stroke = Stroke {
        colour: LINE,
        width: 0.4,
    };
    canvas.polyline(&line, stroke);
    line
}

/// Names of curves at one of their ends, left out where they would collide.
#[derive(Default)]
struct Names {
    taken: Vec<Spot>,
}

impl Names {
    fn put(&mut self, canvas: &mut Canvas, at: Spot, anchor: Anchor, name: f64) {
        const SIZE: f64 = 2.2;
        let name = short(name);
        let room = text::width(&name, SIZE) + 0.8;
        let collides = |t: &Spot| (t[0] - at[0]).abs() < room && (t[1] - at[1]).abs() < SIZE;
        if self.taken.iter().any(collides) {
            return;
        }
        self.taken.push(at);
        let style = TextStyle {
            size: SIZE,
            colour: LINE,
            anchor,
            bold: false,
        };
        canvas.text(at, style, &name);
    }
}

/// The body plan with the old offsets and the largest moves.
fn draw_body(canvas: &mut Canvas, drawing: &OffsetsDrawing, panels: &Panels) {
    let panel = &panels.body;
    let units = &drawing.units;
    frame(
        canvas,
        panel,
        &format!("Body plan: aft body left, fore body right (y–z, {units})"),
    );
    table_lines(canvas, panel, &[0.0], &drawing.waterlines);
    let mut names = Names::default();
    for side in sides() {
        for (x, curve) in drawing
            .station_curves
            .iter()
            .filter(|(x, _)| side.shows(*x, panels))
        {
            let line = draw_curve(canvas, curve, |p| panel.map([side.sign() * p.y, p.z]));
            let top = line.iter().copied().min_by(|a, b| a[1].total_cmp(&b[1]));
            if let Some([x_top, y_top]) = top {
                names.put(canvas, [x_top, y_top - 1.2], Anchor::Middle, *x);
            }
        }
    }
    for side in sides() {
        let shown = placed(drawing).filter(|p| side.shows(p.station, panels));
        let to = |p: &Placed, y: f64| panel.map([side.sign() * y, p.waterline]);
        draw_offsets(canvas, shown, to, [0.0, TICK]);
    }
    for (rank, p) in by_size(drawing).iter().take(MOST_MOVES).enumerate().rev() {
        let sign = if p.station < panels.midship {
            -1.0
        } else {
            1.0
        };
        let at = panel.map([sign * p.cell.old.unwrap_or_default(), p.waterline]);
        // Beside the tick, outboard.
        mark(canvas, [at[0] + sign * 3.2, at[1]], rank + 1);
    }
}

/// A side of the body plan.
#[derive(Clone, Copy, PartialEq)]
enum Side {
    Aft,
    Fore,
}

fn sides() -> [Side; 2] {
    [Side::Aft, Side::Fore]
}

impl Side {
    fn sign(self) -> f64 {
        match self {
            Side::Aft => -1.0,
            Side::Fore => 1.0,
        }
    }

    /// Whether a station is drawn on this side; the midship one is on both.
    fn shows(self, station: f64, panels: &Panels) -> bool {
        self.sign() * (station - panels.midship) >= 0.0
    }
}

/// Old offsets as ticks, filled ones as discs, slips with their expected place.
fn draw_offsets(
    canvas: &mut Canvas,
    offsets: impl Iterator<Item = Placed>,
    to: impl Fn(&Placed, f64) -> Spot,
    tick: Spot,
) {
    let heavy = Stroke {
        colour: SLIP,
        width: 0.4,
    };
    let old = Stroke {
        colour: OLD,
        width: 0.35,
    };
    let mut ticks = Vec::new();
    let finite = |v: Option<f64>| v.filter(|y| y.is_finite());
    for place in offsets {
        let cell = place.cell;
        if let (Some(given), Some(expected)) = (finite(cell.old), finite(cell.slip)) {
            let [from, at] = [to(&place, given), to(&place, expected)];
            canvas.dashed(
                &[from, at],
                Stroke {
                    width: 0.2,
                    ..heavy
                },
            );
            canvas.circle(at, 1.1, "none", heavy);
            cross(canvas, from, heavy);
        } else if let Some(given) = finite(cell.old) {
            let at = to(&place, given);
            ticks.push([
                [at[0] - tick[0], at[1] - tick[1]],
                [at[0] + tick[0], at[1] + tick[1]],
            ]);
        } else if let Some(filled) = finite(cell.new).filter(|_| cell.filled) {
            canvas.circle(
                to(&place, filled),
                0.6,
                "#ffffff",
                Stroke { width: 0.2, ..old },
            );
        }
    }
    canvas.strokes(&ticks, old);
}

fn draw_profile(canvas: &mut Canvas, drawing: &OffsetsDrawing, panel: &Panel) {
    frame(
        canvas,
        panel,
        &format!("Profile with buttocks (x–z, {})", drawing.units),
    );
    table_lines(canvas, panel, &drawing.stations, &drawing.waterlines);
    let mut names = Names::default();
    for (y, curve) in &drawing.buttock_curves {
        let line = draw_curve(canvas, curve, |p| panel.map([p.x, p.z]));
        if let Some(end) = line.last() {
            names.put(canvas, [end[0] + 0.8, end[1] - 0.6], Anchor::Start, *y);
        }
    }
}

fn draw_plan(canvas: &mut Canvas, drawing: &OffsetsDrawing, panel: &Panel) {
    frame(
        canvas,
        panel,
        &format!("Half-breadth plan with waterlines (x–y, {})", drawing.units),
    );
    table_lines(canvas, panel, &drawing.stations, &[0.0]);
    let mut names = Names::default();
    for (z, curve) in &drawing.waterline_curves {
        let line = draw_curve(canvas, curve, |p| panel.map([p.x, p.y]));
        if let Some(end) = line.last() {
            names.put(canvas, [end[0] + 0.8, end[1] - 0.6], Anchor::Start, *z);
        }
    }
    let to = |p: &Placed, y: f64| panel.map([p.station, y]);
    draw_offsets(canvas, placed(drawing), to, [TICK, 0.0]);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::offsets::tests::hull;

    #[test]
    fn the_page_shows_three_views_and_the_moves() {
        let page = plot(&hull());
        for expected in [
            "Body plan: aft body left, fore body right (y–z, m)",
            "Profile with buttocks (x–z, m)",
            "Half-breadth plan with waterlines (x–y, m)",
            "+0.25",
            "suspected slip; ring",
            "offset that was missing",
            "Pinnace &lt;1&gt;",
            "One slip.",
        ] {
            assert!(page.contains(expected), "no {expected:?}");
        }
        assert!(!page.contains("NaN") && !page.contains("href"));
    }

    #[test]
    fn aft_stations_are_on_the_left() {
        let drawing = hull();
        let panels = arrange(&drawing, 20.0).expect("a hull");
        assert!(Side::Aft.shows(-4.0, &panels) && !Side::Fore.shows(-4.0, &panels));
        assert!(sides().iter().all(|side| side.shows(0.0, &panels)));
        assert!(panels.body.map([-1.0, 0.0])[0] < panels.body.map([1.0, 0.0])[0]);
        assert!(panels.plan.corner[1] > panels.profile.bottom());
    }

    #[test]
    fn empty_and_broken_tables_are_still_pages() {
        let mut empty = hull();
        empty.cells.clear();
        empty.station_curves.clear();
        empty.waterline_curves.clear();
        empty.buttock_curves.clear();
        assert!(plot(&empty).contains("One slip."));
        let mut broken = hull();
        broken.stations[1] = f64::NAN;
        broken.cells[2][0].old = Some(f64::INFINITY);
        broken.cells[3].clear();
        broken.waterlines.push(f64::INFINITY);
        let page = plot(&broken);
        assert!(!page.contains("NaN") && !page.contains("inf"), "{page}");
    }

    #[test]
    fn figures_are_short() {
        assert_eq!(
            [0.0, -4.0, 0.123_456, 1234.56, 20.0].map(short),
            ["0", "-4", "0.1235", "1235", "20"]
        );
    }
}
