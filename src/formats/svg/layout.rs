//! Where the three views stand on the page, and how a point of the hull gets
//! there: one scale for all, profile and plan above one another, profile and
//! body side by side, as on a drawing board.

use super::canvas::Spot;
use super::panel::Panel;
use nalgebra::Point3;

/// Page width: A4 on its side, mm. The height follows from the contents.
pub(super) const PAGE_WIDTH: f64 = 297.0;
/// White border, mm.
pub(super) const MARGIN: f64 = 12.0;
/// Room left of the views for the numbers of the grid, mm.
const GUTTER: f64 = 9.0;
/// Room between profile and body, mm.
const COLUMN_GAP: f64 = 16.0;
/// Room between profile and plan, mm.
const ROW_GAP: f64 = 14.0;
/// The views together are never taller than this, mm, so that a tall hull does
/// not run off a sheet.
const MAX_HEIGHT: f64 = 140.0;
/// The longest side of the hull is divided into about this many grid steps.
const GRID_STEPS: f64 = 7.0;

/// One orthographic view.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct View {
    /// What it is called.
    pub name: &'static str,
    /// Coordinate drawn to the right and coordinate drawn upwards (0 = x).
    pub axes: [usize; 2],
    /// Top left corner on the page, mm.
    pub corner: Spot,
    /// Width and height on the page, mm.
    pub size: Spot,
    /// Least coordinates of the hull.
    low: Point3<f64>,
    /// Millimetres on the page per unit of length.
    pub scale: f64,
}

impl View {
    /// Where a point of the hull appears.
    pub fn map(&self, point: &Point3<f64>) -> Spot {
        let along = |axis: usize| (point[axis] - self.low[axis]) * self.scale;
        [
            self.corner[0] + along(self.axes[0]),
            self.corner[1] + self.size[1] - along(self.axes[1]),
        ]
    }

    /// Lower end of the coordinate on this axis of the view (0 right, 1 up).
    pub fn low(&self, axis: usize) -> f64 {
        self.low[self.axes[axis]]
    }

    /// The same place and scales as a panel.
    pub fn panel(&self) -> Panel {
        Panel {
            corner: self.corner,
            size: self.size,
            low: [self.low(0), self.low(1)],
            scale: [self.scale; 2],
        }
    }

    /// The y coordinate of its lower edge, mm.
    pub fn bottom(&self) -> f64 {
        self.corner[1] + self.size[1]
    }
}

/// The three views and what they have in common.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Layout {
    /// Profile, body and plan.
    pub views: [View; 3],
    /// Distance between grid lines in the hull's unit.
    pub step: f64,
}

/// Places the three views of the box `low..high` below `top` mm.
pub(super) fn arrange([low, high]: [Point3<f64>; 2], top: f64) -> Layout {
    let [dx, dy, dz] = [0, 1, 2].map(|i| high[i] - low[i]);
    let room = [
        PAGE_WIDTH - 2.0 * MARGIN - GUTTER - COLUMN_GAP,
        MAX_HEIGHT - ROW_GAP,
    ];
    let scale = (room[0] / (dx + dy)).min(room[1] / (dz + dy));
    // A single point has no size; any scale shows it.
    let scale = if scale.is_finite() { scale } else { 1.0 };
    let left = MARGIN + GUTTER;
    let view = |name, axes: [usize; 2], corner| View {
        name,
        axes,
        corner,
        size: axes.map(|i| (high[i] - low[i]) * scale),
        low,
        scale,
    };
    let right = left + dx * scale + COLUMN_GAP;
    let below = top + dz * scale + ROW_GAP;
    Layout {
        views: [
            view("Profile", [0, 2], [left, top]),
            view("Body", [1, 2], [right, top]),
            view("Plan", [0, 1], [left, below]),
        ],
        step: round_step(dx.max(dy).max(dz) / GRID_STEPS),
    }
}

/// The step of 1, 2 or 5 times a power of ten that is next to `rough`; 1 where
/// `rough` is no positive number.
pub(super) fn round_step(rough: f64) -> f64 {
    if !(rough > 0.0 && rough.is_finite()) {
        return 1.0;
    }
    let decade = 10f64.powf(rough.log10().floor());
    // Limits halfway between the steps, geometrically.
    let factor = match rough / decade {
        r if r < 1.5 => 1.0,
        r if r < 3.5 => 2.0,
        r if r < 7.5 => 5.0,
        _ => 10.0,
    };
    factor * decade
}

/// The multiples of `step` within `low..=high`.
pub(super) fn multiples(step: f64, low: f64, high: f64) -> Vec<f64> {
    /// More lines than this would be a grey wall (and a runaway loop).
    const MOST: usize = 200;
    // A hair of slack keeps the line at the very end.
    let slack = 1e-9 * step;
    let first = ((low - slack) / step).ceil();
    (0..MOST)
        .map(|i| (first + i as f64) * step)
        .take_while(|v| *v <= high + slack)
        .collect()
}

/// A coordinate on the grid as text, with no more decimals than its step has.
pub(super) fn grid_label(value: f64, step: f64) -> String {
    let decimals = (-step.log10().floor()).clamp(0.0, 12.0) as usize;
    let value = if value.abs() < step * 1e-6 {
        0.0
    } else {
        value
    };
    format!("{value:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn trawler() -> [Point3<f64>; 2] {
        [
            Point3::new(0.0, 0.0, -0.12),
            Point3::new(70.0, 11.49, 14.19),
        ]
    }

    #[test]
    fn the_views_fit_side_by_side() {
        for corners in [
            trawler(),
            [Point3::origin(), Point3::new(1.0, 1.0, 1.0)],
            [Point3::origin(), Point3::new(0.0, 0.0, 9.0)],
            [Point3::new(1e6, 1e6, 1e6), Point3::new(1e6, 1e6, 1e6)],
        ] {
            let layout = arrange(corners, 30.0);
            let [profile, body, plan] = layout.views;
            assert!(body.corner[0] + body.size[0] <= PAGE_WIDTH - MARGIN + 1e-9);
            assert!(plan.bottom() <= 30.0 + MAX_HEIGHT + 1e-9);
            assert!(profile.corner[0] + profile.size[0] < body.corner[0]);
            assert!(profile.bottom() < plan.corner[1]);
        }
    }

    #[test]
    fn up_is_up() {
        let [profile, ..] = arrange(trawler(), 30.0).views;
        let [keel, deck] = [Point3::new(0.0, 0.0, 0.0), Point3::new(0.0, 0.0, 14.19)];
        assert!(profile.map(&keel)[1] > profile.map(&deck)[1]);
        assert!((profile.map(&deck)[1] - profile.corner[1]).abs() < 1e-9);
    }

    #[test]
    fn steps_and_labels_are_round() {
        assert_eq!(
            [10.0, 0.013, 4.0, 999.0].map(round_step),
            [10.0, 0.01, 5.0, 1000.0]
        );
        assert_eq!(round_step(f64::NAN), 1.0);
        assert_eq!(multiples(10.0, -0.12, 70.0).len(), 8);
        assert_eq!(grid_label(0.300_000_000_1, 0.1), "0.3");
        assert_eq!(grid_label(-0.0, 10.0), "0");
    }
}
