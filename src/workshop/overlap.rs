//! Where a flat pattern would lie on itself, as a helix of more than a full
//! turn does.

use super::development::FlatLine;
use crate::geometry::convex_overlap;
use nalgebra::Point2;

/// Triangles smaller than this share of the size squared are lines.
const NO_AREA: f64 = 1e-14;

/// The fields between neighbouring rulings, gathered into pieces that do not
/// overlap themselves: first and last ruling of each. A piece ends at the ruling
/// before the field that would lie on an earlier one.
pub(super) fn pieces(rulings: &[FlatLine], size: f64) -> Vec<[usize; 2]> {
    let mut pieces = Vec::new();
    let mut start = 0;
    let mut laid: Vec<Field> = Vec::new();
    for (i, pair) in rulings.windows(2).enumerate() {
        let field = Field::new(pair, size);
        // The field before shares a ruling.
        let others = laid.len().saturating_sub(1);
        if laid[..others].iter().any(|other| other.overlaps(&field)) {
            pieces.push([start, i]);
            start = i;
            laid.clear();
        }
        laid.push(field);
    }
    pieces.push([start, rulings.len().saturating_sub(1)]);
    pieces
}

/// The plane between two rulings, as triangles.
struct Field {
    triangles: Vec<[Point2<f64>; 3]>,
    low: Point2<f64>,
    high: Point2<f64>,
}

impl Field {
    fn new(pair: &[FlatLine], size: f64) -> Self {
        let [a, b, c, d] = [pair[0].from, pair[1].from, pair[1].to, pair[0].to];
        let mut triangles = vec![[a, b, c], [a, c, d]];
        triangles.retain(|[p, q, r]| (q - p).perp(&(r - p)).abs() > NO_AREA * size * size);
        Field {
            triangles,
            low: a.inf(&b).inf(&c).inf(&d),
            high: a.sup(&b).sup(&c).sup(&d),
        }
    }

    fn overlaps(&self, other: &Field) -> bool {
        let apart = |k: usize| self.high[k] <= other.low[k] || other.high[k] <= self.low[k];
        if apart(0) || apart(1) {
            return false;
        }
        let hits = |a: &[Point2<f64>; 3]| other.triangles.iter().any(|b| convex_overlap(a, b));
        self.triangles.iter().any(hits)
    }
}
