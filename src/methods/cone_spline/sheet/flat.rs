//! The flat pattern: the chain with its bending taken out.

use super::super::outcome::FlatPiece;
use super::{Link, Strip};
use crate::geometry::cone::{Frame, Strain};
use crate::geometry::convex_overlap;
use nalgebra::{Point2, Point3, Vector3};

/// Bend lines, and the fields by which overlap is judged, stand at most so far
/// apart.
const FIELD_DEG: f64 = 10.0;
/// Fields of a patch, at least and at most.
const FIELDS: [f64; 2] = [4.0, 72.0];

/// All patches laid out flat.
pub(super) struct Laid {
    /// The frame of each patch's first ruling in the plane of its piece.
    pub frames: Vec<Frame>,
    /// Pieces that do not overlap themselves.
    pub pieces: Vec<FlatPiece>,
}

/// Lays the strip out, its front up, side 0 above, beginning at the left; a new
/// piece begins at the joint before a patch that would lie on another one.
pub(super) fn lay(strip: &Strip) -> Laid {
    let mut laid = Laid {
        frames: Vec::with_capacity(strip.links.len()),
        pieces: Vec::new(),
    };
    let mut fields: Vec<Vec<Vec<Point2<f64>>>> = Vec::new();
    for (i, link) in strip.links.iter().enumerate() {
        let before = i.checked_sub(1).map(|b| (&strip.links[b], laid.frames[b]));
        let joined = before.map(|(b, frame)| next(b, &frame, link));
        let mut frame = joined.unwrap_or_else(origin);
        let mut own = cells(strip, link, &frame);
        let hits = |own: &[Vec<Point2<f64>>]| {
            // The last fields of the patch before touch the first ones of this.
            let others = fields.iter().flatten();
            let before = fields.last().and_then(|f| f.last());
            others
                .filter(|f| before != Some(*f))
                .any(|f| own.iter().skip(1).any(|o| convex_overlap(f, o)))
        };
        if laid.pieces.is_empty() || hits(&own) {
            frame = origin();
            own = cells(strip, link, &frame);
            fields.clear();
            laid.pieces.push(FlatPiece {
                patches: [i, i],
                outline: Vec::new(),
                area: 0.0,
            });
        }
        fields.push(own);
        laid.frames.push(frame);
        if let Some(piece) = laid.pieces.last_mut() {
            piece.patches[1] = i + 1;
        }
    }
    for piece in &mut laid.pieces {
        piece.outline = outline(strip, &laid.frames, piece.patches);
        piece.area = area(&piece.outline);
    }
    laid
}

/// A place of a patch in the plane.
pub(super) fn place(frame: &Frame, strain: Strain, place: &Point2<f64>) -> Point2<f64> {
    let point = frame.carried(unbent(strain), place.x).at(place.y);
    Point2::new(point.x, point.y)
}

/// The flat strain: geodesic curvature stays, bending goes.
fn unbent(strain: Strain) -> Strain {
    Strain { k: 0.0, ..strain }
}

/// Seen from the front, the strip runs to the right and its rulings down.
fn origin() -> Frame {
    Frame {
        point: Point3::origin(),
        ruling: -Vector3::y(),
        normal: Vector3::z(),
    }
}

/// The first ruling of a patch, given where the one before was laid.
fn next(before: &Link, laid: &Frame, link: &Link) -> Frame {
    laid.carried(unbent(before.strain), before.length)
        .slid(link.offset - before.offset)
}

/// Values of s at equal steps from the first to the last ruling.
pub(super) fn steps(link: &Link) -> impl Iterator<Item = f64> + use<> {
    let turn = (link.strain.rate() * link.length).to_degrees();
    let count = (turn / FIELD_DEG).ceil().clamp(FIELDS[0], FIELDS[1]);
    let length = link.length;
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let last = count as u32;
    (0..=last).map(move |i| length * f64::from(i) / count)
}

/// The rulings at these steps between the sides of the strip, in (s, λ).
pub(super) fn rulings(strip: &Strip, link: &Link) -> Vec<[Point2<f64>; 2]> {
    steps(link)
        .map(|s| {
            let ends = strip.outline.sides_at(link.start + s);
            ends.map(|p| link.place(&p))
        })
        .collect()
}

/// A patch as convex fields in the plane.
fn cells(strip: &Strip, link: &Link, frame: &Frame) -> Vec<Vec<Point2<f64>>> {
    let flat: Vec<[Point2<f64>; 2]> = (rulings(strip, link).iter())
        .map(|ends| ends.map(|p| place(frame, link.strain, &p)))
        .collect();
    let cell = |pair: &[[Point2<f64>; 2]]| vec![pair[0][0], pair[1][0], pair[1][1], pair[0][1]];
    flat.windows(2).map(cell).collect()
}

/// The outline of patches that lie in one piece.
fn outline(strip: &Strip, frames: &[Frame], [first, end]: [usize; 2]) -> Vec<Point2<f64>> {
    let range = [strip.links[first].start, strip.links[end - 1].finish()];
    let polygon = strip.outline.between(range);
    let flat = |running: &Point2<f64>| {
        let inside = first..end;
        let patch = inside
            .rev()
            .find(|i| strip.links[*i].start <= running.x)
            .unwrap_or(first);
        let link = &strip.links[patch];
        place(&frames[patch], link.strain, &link.place(running))
    };
    polygon.iter().map(flat).collect()
}

/// Area of a closed polygon.
fn area(polygon: &[Point2<f64>]) -> f64 {
    let next = polygon.iter().cycle().skip(1);
    let twice: f64 = (polygon.iter().zip(next))
        .map(|(a, b)| a.x * b.y - a.y * b.x)
        .sum();
    0.5 * twice.abs()
}
