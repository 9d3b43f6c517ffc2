//! Where the three views stand on the page.

use super::super::canvas::Spot;
use super::super::layout::{MARGIN, PAGE_WIDTH};
use super::super::panel::Panel;
use super::super::sample::samples;
use super::MOST_MOVES;
use crate::formats::offsets::{OffsetsDrawing, placed};
use nalgebra::Point3;

/// Room left of a panel for its numbers, mm.
const GUTTER: f64 = 12.0;
/// Width and height of the body plan at most, mm.
const BODY: Spot = [176.0, 92.0];
/// Height of profile and half-breadth plan at most, mm.
const LONG_HEIGHT: f64 = 60.0;
/// White space around what is drawn, mm.
const PADDING: f64 = 4.0;
/// Space between two panels for numbers and names, mm.
const GAP: f64 = 15.0;

/// The three panels.
pub(super) struct Panels {
    /// Stations, seen from ahead and astern.
    pub body: Panel,
    /// Buttocks, seen from the side.
    pub profile: Panel,
    /// Waterlines, seen from above.
    pub plan: Panel,
    /// Between fore and aft body.
    pub midship: f64,
}

/// Places the panels; `None` when there is nothing to draw.
pub(super) fn arrange(drawing: &OffsetsDrawing, top: f64) -> Option<Panels> {
    let [low, high] = bounds(drawing)?;
    let left = MARGIN + GUTTER;
    let breadth = high.y.max(-low.y).max(0.0);
    let body = fitted([[-breadth, breadth], [low.z, high.z]], [left, top], BODY);
    let list = top + 5.2 * (MOST_MOVES as f64 + 1.0);
    let room = [PAGE_WIDTH - MARGIN - left, LONG_HEIGHT];
    let below = body.bottom().max(list) + GAP;
    // One scale for both, whichever is the taller.
    let sides = [[low.z, high.z], [low.y.min(0.0), high.y]];
    let height = |r: [f64; 2]| r[1] - r[0];
    let taller = sides.map(height)[0].max(sides.map(height)[1]);
    let along = [low.x, high.x];
    let common = fitted([along, [0.0, taller]], [left, below], room).scale[0];
    let long = |range: [f64; 2], top: f64| Panel {
        corner: [left, top],
        size: [along, range].map(|r| height(r) * common + 2.0 * PADDING),
        low: [along[0], range[0]].map(|c| c - PADDING / common),
        scale: [common; 2],
    };
    let profile = long(sides[0], below);
    Some(Panels {
        body,
        profile,
        plan: long(sides[1], profile.bottom() + GAP),
        midship: (low.x + high.x) / 2.0,
    })
}

/// A panel of one scale both ways, no larger than `room`.
fn fitted(ranges: [[f64; 2]; 2], corner: Spot, room: Spot) -> Panel {
    let extent = ranges.map(|r| r[1] - r[0]);
    let fits = [0, 1].map(|i| (room[i] - 2.0 * PADDING) / extent[i]);
    let scale = fits[0].min(fits[1]);
    let scale = if scale > 0.0 && scale.is_finite() {
        scale
    } else {
        1.0
    };
    Panel {
        corner,
        size: extent.map(|e| e * scale + 2.0 * PADDING),
        low: ranges.map(|r| r[0] - PADDING / scale),
        scale: [scale; 2],
    }
}

/// Least and greatest coordinates of offsets and curves.
fn bounds(drawing: &OffsetsDrawing) -> Option<[Point3<f64>; 2]> {
    let offsets = placed(drawing).flat_map(|p| {
        let values = [p.cell.old, p.cell.new, p.cell.slip].into_iter().flatten();
        values.map(move |y| Point3::new(p.station, y, p.waterline))
    });
    let curves = [
        &drawing.station_curves,
        &drawing.waterline_curves,
        &drawing.buttock_curves,
    ];
    let curves = curves.into_iter().flatten().flat_map(|(_, c)| samples(c));
    let points = offsets.chain(curves.map(|(_, p)| p));
    let finite = points.filter(|p| p.iter().all(|c| c.is_finite()));
    finite.fold(None, |corners, p| {
        let [low, high] = corners.unwrap_or([p, p]);
        Some([low.inf(&p), high.sup(&p)])
    })
}
