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

/// Where the rows are, increasing.
fn rows(outline: &[Point2<f64>]) -> Vec<f64> {
    let corners = || outline.iter().map(|p| p.x);
    let first = corners().fold(f64::INFINITY, f64::min);
    let last = corners().fold(f64::NEG_INFINITY, f64::max);
    if first >= last {
        return Vec::new();
    }
    let even = (1..ROWS).map(|i| first + (last - first) * (i as f64 / ROWS as f64));
    let mut wanted: Vec<f64> = corners().chain(even).collect();
    wanted.sort_by(f64::total_cmp);
    let closest = CLOSEST * (last - first);
    let mut rows = vec![first];
    for s in wanted {
        let before = rows.last().copied().unwrap_or(first);
        if s - before >= closest && last - s >= closest {
            rows.push(s);
        }
    }
    rows.push(last);
    rows
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
    }
}
