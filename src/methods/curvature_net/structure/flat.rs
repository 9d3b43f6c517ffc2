//! Unrolling a ribbon: a line whose arcs have constant geodesic curvature, and
//! straight rulings square to it.

use crate::geometry::convex_overlap;
use crate::numerics::sinc;
use nalgebra::{Point2, Rotation2, Vector2};

/// Samples of the edges from vertex to vertex, both counted once.
pub const SAMPLES: usize = 8;

/// A ribbon from one vertex to the next.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Piece {
    /// Length of the line.
    pub length: f64,
    /// Its geodesic curvature on the ribbon, positive to the left.
    pub bend: f64,
    /// How far the ribbon reaches to the left and right of the line, at
    /// [`SAMPLES`] + 1 equal shares of its length.
    pub reach: [[f64; SAMPLES + 1]; 2],
}

/// A flat pattern in one piece.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Sheet {
    /// The vertex of the line at which it begins.
    pub first: usize,
    /// The unrolled line.
    pub line: Vec<Point2<f64>>,
    /// The edge to the left of the line.
    pub left: Vec<Point2<f64>>,
    /// The edge to the right of it.
    pub right: Vec<Point2<f64>>,
}

impl Sheet {
    /// The rulings at the vertices, from right to left.
    pub fn rulings(&self) -> impl Iterator<Item = [Point2<f64>; 2]> {
        let both = self.right.iter().zip(&self.left);
        both.step_by(SAMPLES).map(|(r, l)| [*r, *l])
    }

    /// The closed outline: along the right edge and back along the left one.
    #[must_use]
    pub fn outline(&self) -> Vec<Point2<f64>> {
        let back = self.left.iter().rev();
        self.right.iter().chain(back).copied().collect()
    }
}

/// Unrolls a ribbon into as few sheets as do not overlap themselves; it is cut
/// along the ruling of a vertex.
pub(super) fn unroll(pieces: &[Piece]) -> Vec<Sheet> {
    let mut sheets: Vec<Sheet> = Vec::new();
    let mut fields: Vec<Vec<Point2<f64>>> = Vec::new();
    let mut pen = Pen::default();
    for (position, piece) in pieces.iter().enumerate() {
        let mut drawn = pen.draw(piece);
        let mut field = drawn.outline();
        // The piece before shares a ruling.
        let before = fields.len().saturating_sub(1);
        if sheets.is_empty() || fields[..before].iter().any(|f| convex_overlap(f, &field)) {
            pen = Pen::default();
            drawn = pen.draw(piece);
            field = drawn.outline();
            fields.clear();
            sheets.push(Sheet {
                first: position,
                ..Sheet::default()
            });
        }
        if let Some(sheet) = sheets.last_mut() {
            sheet.append(drawn);
        }
        fields.push(field);
    }
    sheets
}

impl Sheet {
    fn append(&mut self, next: Sheet) {
        let shared = usize::from(!self.line.is_empty());
        self.line.extend(next.line.into_iter().skip(shared));
        self.left.extend(next.left.into_iter().skip(shared));
        self.right.extend(next.right.into_iter().skip(shared));
    }
}

/// Where the unrolled line has come to.
struct Pen {
    place: Point2<f64>,
    heading: Vector2<f64>,
}

impl Default for Pen {
    fn default() -> Self {
        Pen {
            place: Point2::origin(),
            heading: Vector2::x(),
        }
    }
}

impl Pen {
    fn draw(&mut self, piece: &Piece) -> Sheet {
        let mut sheet = Sheet::default();
        let at = |share: f64| {
            let length = share * piece.length;
            let half = Rotation2::new(0.5 * piece.bend * length);
            let chord = half * self.heading * (length * sinc(0.5 * piece.bend * length));
            (self.place + chord, half * (half * self.heading))
        };
        for k in 0..=SAMPLES {
            let (place, heading) = at(k as f64 / SAMPLES as f64);
            let left = Vector2::new(-heading.y, heading.x);
            sheet.line.push(place);
            sheet.left.push(place + left * piece.reach[0][k]);
            sheet.right.push(place - left * piece.reach[1][k]);
        }
        let (place, heading) = at(1.0);
        *self = Pen {
            place,
            heading: heading.normalize(),
        };
        sheet
    }
}
