//! A rectangle on the page with two axes, each with its own scale.

use super::canvas::{Anchor, Canvas, Spot, Stroke, TextStyle};
use super::layout::{grid_label, multiples};
use super::views::GREY;

/// Grid lines.
const GRID_COLOUR: &str = "#d9dde2";
/// Height of grid numbers, mm.
const GRID_TEXT: f64 = 2.5;

/// A rectangle with coordinates: the first to the right, the second upwards.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Panel {
    /// Top left corner, mm.
    pub corner: Spot,
    /// Width and height, mm.
    pub size: Spot,
    /// Coordinates of the lower left corner.
    pub low: [f64; 2],
    /// Millimetres per unit of each coordinate.
    pub scale: [f64; 2],
}

impl Panel {
    /// The rectangle showing these ranges in full.
    pub fn showing(ranges: [[f64; 2]; 2], corner: Spot, size: Spot) -> Self {
        let scale = |axis: usize| {
            let scale = size[axis] / (ranges[axis][1] - ranges[axis][0]);
            // A range without width: any scale shows it.
            if scale.is_finite() && scale > 0.0 {
                scale
            } else {
                1.0
            }
        };
        Panel {
            corner,
            size,
            low: [ranges[0][0], ranges[1][0]],
            scale: [scale(0), scale(1)],
        }
    }

    /// Where a place appears.
    pub fn map(&self, place: [f64; 2]) -> Spot {
        [
            self.corner[0] + (place[0] - self.low[0]) * self.scale[0],
            self.bottom() - (place[1] - self.low[1]) * self.scale[1],
        ]
    }

    /// A step between two places on the page, mm.
    pub fn map_step(&self, step: [f64; 2]) -> Spot {
        [step[0] * self.scale[0], -step[1] * self.scale[1]]
    }

    /// Upper end of the coordinate on this axis.
    pub fn high(&self, axis: usize) -> f64 {
        self.low[axis] + self.size[axis] / self.scale[axis]
    }

    /// The lower edge, mm.
    pub fn bottom(&self) -> f64 {
        self.corner[1] + self.size[1]
    }

    /// The right edge, mm.
    pub fn right(&self) -> f64 {
        self.corner[0] + self.size[0]
    }

    /// Whether a place on the page lies in the panel.
    pub fn holds(&self, spot: Spot) -> bool {
        let within = |i: usize| (self.corner[i]..=self.corner[i] + self.size[i]).contains(&spot[i]);
        within(0) && within(1)
    }

    /// Lines at multiples of the steps, with their numbers.
    pub fn grid(&self, canvas: &mut Canvas, steps: [f64; 2]) {
        let [left, top] = self.corner;
        let stroke = Stroke {
            colour: GRID_COLOUR,
            width: 0.15,
        };
        let mut style = TextStyle {
            size: GRID_TEXT,
            colour: GREY,
            anchor: Anchor::Middle,
            bold: false,
        };
        let mut lines = Vec::new();
        for value in multiples(steps[0], self.low[0], self.high(0)) {
            let x = left + (value - self.low[0]) * self.scale[0];
            lines.push([[x, top], [x, self.bottom()]]);
            let label = grid_label(value, steps[0]);
            canvas.text([x, self.bottom() + 3.4], style, &label);
        }
        style.anchor = Anchor::End;
        for value in multiples(steps[1], self.low[1], self.high(1)) {
            let y = self.bottom() - (value - self.low[1]) * self.scale[1];
            lines.push([[left, y], [self.right(), y]]);
            canvas.text([left - 1.5, y + 0.9], style, &grid_label(value, steps[1]));
        }
        canvas.strokes(&lines, stroke);
    }

    /// A line through places on the page, cut off at the edges of the panel.
    pub fn clipped(&self, canvas: &mut Canvas, points: &[Spot], stroke: Stroke<'_>) {
        let mut run: Vec<Spot> = Vec::new();
        for pair in points.windows(2) {
            let Some([from, to]) = self.inside([pair[0], pair[1]]) else {
                continue;
            };
            if run.last() != Some(&from) {
                canvas.polyline(&run, stroke);
                run = vec![from];
            }
            run.push(to);
        }
        canvas.polyline(&run, stroke);
    }

    /// The part of a segment within the panel (Liang & Barsky 1984).
    fn inside(&self, [a, b]: [Spot; 2]) -> Option<[Spot; 2]> {
        let mut share = [0.0_f64, 1.0_f64];
        for axis in 0..2 {
            let step = b[axis] - a[axis];
            let low = self.corner[axis] - a[axis];
            let high = low + self.size[axis];
            if step == 0.0 {
                if low > 0.0 || high < 0.0 {
                    return None;
                }
                continue;
            }
            let ends = [low / step, high / step];
            share[0] = share[0].max(ends[0].min(ends[1]));
            share[1] = share[1].min(ends[0].max(ends[1]));
        }
        // A coordinate that is not finite fails this comparison too.
        if !(share[0] <= share[1] && a.iter().chain(&b).all(|c| c.is_finite())) {
            return None;
        }
        let at = |t: f64| match t {
            0.0 => a,
            1.0 => b,
            t => [0, 1].map(|i| a[i] + (b[i] - a[i]) * t),
        };
        Some([at(share[0]), at(share[1])])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn segments_end_at_the_edges() {
        let panel = Panel::showing([[0.0, 1.0], [0.0, 1.0]], [10.0, 20.0], [30.0, 40.0]);
        assert_eq!(panel.map([0.0, 0.0]), [10.0, 60.0]);
        assert_eq!(panel.map([1.0, 1.0]), [40.0, 20.0]);
        let through = panel.inside([[0.0, 40.0], [50.0, 40.0]]);
        assert_eq!(through, Some([[10.0, 40.0], [40.0, 40.0]]));
        assert_eq!(panel.inside([[0.0, 0.0], [5.0, 90.0]]), None);
        assert_eq!(panel.inside([[20.0, f64::NAN], [30.0, 40.0]]), None);
        let within = [[11.0, 21.0], [12.0, 22.0]];
        assert_eq!(panel.inside(within), Some(within));
    }
}
