//! Places all over a patch, row by row along its rulings, to show it by.

use super::super::outcome::Grid;
use super::Link;
use nalgebra::Point2;

/// Places in a row.
const ACROSS: usize = 9;
/// Rows of a patch whose sides have no corners: at least so many.
const ROWS: usize = 24;
/// Rows nearer to each other than this share of the patch's length are one.
const CLOSEST: f64 = 1.0 / 96.0;
/// Sharp corners nearer than this share of the length have one row.
const SAME: f64 = 1e-9;
/// Turns of an outline that are sharp corners, radians.
const SHARP: f64 = 0.3;

/// The places of a patch inside its outline in (s, λ); no distances yet. Rows
/// stand at the corners of the outline and evenly between them, so that the
/// sides are followed and neighbours have the places on their ruling in common.
pub(super) fn of(link: &Link, outline: &[Point2<f64>]) -> Grid {
    let mut grid = Grid {
        across: ACROSS,
        points: Vec::new(),
        distances: Vec::new(),
    };
    for s in rows(outline) {
        let Some([from, to]) = interval(outline, s) else {
            continue;
        };
        let lambda = |k: usize| from + (to - from) * (k as f64 / (ACROSS - 1) as f64);
        let row = (0..ACROSS).map(|k| link.point(&Point2::new(s, lambda(k))));
        grid.points.extend(row);
    }
    grid
}

/// Where the rows are, increasing: at all sharp corners, so that ends that are no
/// rulings are followed, at the others and between where there is room.
fn rows(outline: &[Point2<f64>]) -> Vec<f64> {
    let corners = || outline.iter().map(|p| p.x);
    let first = corners().fold(f64::INFINITY, f64::min);
    let last = corners().fold(f64::NEG_INFINITY, f64::max);
    if first >= last {
        return Vec::new();
    }
    let even = (1..ROWS).map(|i| first + (last - first) * (i as f64 / ROWS as f64));
    let needed = sharp_corners(outline).map(|s| (s, SAME));
    let wanted = corners().chain(even).map(|s| (s, CLOSEST));
    let mut rows = vec![first, last];
    for (s, share) in needed.chain(wanted) {
        let closest = share * (last - first);
        let at = rows.partition_point(|r| *r < s);
        let behind = rows.get(at).is_none_or(|r| r - s >= closest);
        if behind && at > 0 && s - rows[at - 1] >= closest {
            rows.insert(at, s);
        }
    }
    rows
}

/// Where the outline turns sharply.
fn sharp_corners(outline: &[Point2<f64>]) -> impl Iterator<Item = f64> {
    let count = outline.len();
    let at = move |i: usize| outline[i % count];
    let is_sharp = move |i: &usize| {
        let (a, b) = (at(*i) - at(i + count - 1), at(i + 1) - at(*i));
        a.perp(&b).atan2(a.dot(&b)).abs() > SHARP
    };
    (0..count).filter(is_sharp).map(move |i| at(i).x)
}

/// Least and largest λ of the outline at s.
fn interval(outline: &[Point2<f64>], s: f64) -> Option<[f64; 2]> {
    let next = outline.iter().cycle().skip(1);
    let mut found: Option<[f64; 2]> = None;
    let mut take = |lambda: f64| {
        let [low, high] = found.unwrap_or([lambda, lambda]);
        found = Some([low.min(lambda), high.max(lambda)]);
    };
    for (p, q) in outline.iter().zip(next) {
        if p.x.min(q.x) > s || s > p.x.max(q.x) {
            continue;
        }
        if p.x == q.x {
            take(p.y);
            take(q.y);
        } else {
            take(p.y + (q.y - p.y) * ((s - p.x) / (q.x - p.x)));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_stand_at_corners_and_between() {
        let outline = [[0.0, 0.0], [4.0, 0.0], [3.0, 2.0], [1.0, 2.0]].map(Point2::from);
        let rows = rows(&outline);
        assert_eq!((rows[0], rows[rows.len() - 1]), (0.0, 4.0));
        assert!(rows.contains(&1.0) && rows.contains(&3.0));
        assert!(rows.len() >= ROWS && rows.windows(2).all(|w| w[0] < w[1]));
        assert_eq!(interval(&outline, 0.5), Some([0.0, 1.0]));
        assert_eq!(interval(&outline, 2.0), Some([0.0, 2.0]));
        assert_eq!(interval(&outline, 4.0), Some([0.0, 0.0]));
        assert_eq!(interval(&outline, 5.0), None);
        assert!(super::rows(&[]).is_empty());
        // A corner near the end is no less one; a place on a side is.
        let slanted = [[0.0, 0.0], [0.01, 3.0], [3.99, 3.1], [4.0, 3.0], [4.0, 0.0]];
        let rows = super::rows(&slanted.map(Point2::from));
        assert!(rows.contains(&0.01) && rows.contains(&3.99));
        let straight = [[0.0, 0.0], [0.0, 3.0], [0.01, 3.0], [4.0, 3.0], [4.0, 0.0]];
        assert!(!super::rows(&straight.map(Point2::from)).contains(&0.01));
    }
}
