//! Places all over the trimmed patches, for distances from them.

use super::{Link, Strip};
use nalgebra::{Point2, Point3};

/// Cells along and across a patch.
const CELLS: [u32; 2] = [32, 12];

/// A place on a patch that stands for the area around it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// The place.
    pub point: Point3<f64>,
    /// The area.
    pub area: f64,
}

/// Places on all patches between the four sides, at the corners of a grid, so
/// that rulings, joints and edges are among them.
pub(super) fn of(strip: &Strip) -> Vec<Sample> {
    strip
        .links
        .iter()
        .flat_map(|link| patch(strip, link))
        .collect()
}

fn patch(strip: &Strip, link: &Link) -> Vec<Sample> {
    let mut samples = Vec::new();
    let [along, across] = CELLS.map(f64::from);
    for i in 0..=CELLS[0] {
        let s = link.length * f64::from(i) / along;
        let [from, to] = strip
            .outline
            .sides_at(link.start + s)
            .map(|p| link.place(&p).y);
        for j in 0..=CELLS[1] {
            let lambda = from + (to - from) * f64::from(j) / across;
            // The end rulings may run past the short sides.
            let running = Point2::new(link.start + s, lambda + link.offset);
            if !strip.outline.is_between_ends(&running, strip.size) {
                continue;
            }
            let cell = link.length / along * (to - from).abs() / across;
            // The trapezoidal rule: half a cell at an edge.
            let share = half_at_ends(i, CELLS[0]) * half_at_ends(j, CELLS[1]);
            samples.push(Sample {
                point: link.point(&Point2::new(s, lambda)),
                area: share * cell * link.strain.speed(lambda),
            });
        }
    }
    samples
}

fn half_at_ends(i: u32, last: u32) -> f64 {
    if i == 0 || i == last { 0.5 } else { 1.0 }
}
