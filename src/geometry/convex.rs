//! Convex polygons in the plane.

use nalgebra::{Point2, Vector2};

/// Polygons that share no more than this part of their width only touch.
const TOUCH: f64 = 1e-9;

/// Whether two convex polygons overlap, by separating lines along their edges
/// (neighbours that share an edge do not). Of polygons that are bent inwards it
/// may be said though they only come near, never the other way round.
#[must_use]
pub fn convex_overlap(a: &[Point2<f64>], b: &[Point2<f64>]) -> bool {
    !splits(a, b) && !splits(b, a)
}

/// Whether an edge of `a` has all of `b` on its other side.
fn splits(a: &[Point2<f64>], b: &[Point2<f64>]) -> bool {
    (0..a.len()).any(|i| {
        let side = a[(i + 1) % a.len()] - a[i];
        let across = Vector2::new(-side.y, side.x);
        let ([a0, a1], [b0, b1]) = (span(&across, a), span(&across, b));
        let slack = TOUCH * (a1 - a0).min(b1 - b0);
        a1 <= b0 + slack || b1 <= a0 + slack
    })
}

/// Least and largest component of points along a direction.
fn span(along: &Vector2<f64>, points: &[Point2<f64>]) -> [f64; 2] {
    let ends = [f64::INFINITY, f64::NEG_INFINITY];
    points.iter().fold(ends, |[low, high], p| {
        let x = along.dot(&p.coords);
        [low.min(x), high.max(x)]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(x: f64, y: f64) -> Vec<Point2<f64>> {
        [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
            .map(|[a, b]| Point2::new(x + a, y + b))
            .to_vec()
    }

    #[test]
    fn squares_overlap_where_they_share_area() {
        for (x, y, expected) in [(0.9, 0.9, true), (1.0, 0.0, false), (0.5, 1.1, false)] {
            assert_eq!(convex_overlap(&square(0.0, 0.0), &square(x, y)), expected);
            assert_eq!(convex_overlap(&square(x, y), &square(0.0, 0.0)), expected);
        }
    }

    #[test]
    fn a_corner_between_two_corners_does_not_overlap() {
        let diamond = [[1.2, 0.5], [1.7, 0.0], [2.2, 0.5], [1.7, 1.0]];
        let diamond = diamond.map(|[x, y]| Point2::new(x, y)).to_vec();
        assert!(!convex_overlap(&square(0.0, 0.0), &diamond));
    }
}
