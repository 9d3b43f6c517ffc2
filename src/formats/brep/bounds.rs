//! The outline of a part of a surface as a few edges.

use super::Sheet;
use crate::geometry::{Axis, BSplineCurve, SplineError};
use nalgebra::{Point2, Point3, Vector2};

/// Turns of an outline sharper than this part two edges, radians.
const CORNER: f64 = 0.5;

/// An edge of a part of a surface.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::formats) struct Bound {
    /// In space.
    pub curve: BSplineCurve,
    /// The same in (u, v) as x and y; with the same parameter, unless the curve
    /// is a straight line.
    pub under: BSplineCurve,
}

/// The outline of a sheet as edges of its face, counter-clockwise; none where it
/// is the whole surface.
pub(in crate::formats) fn bounds(sheet: &Sheet) -> Vec<Bound> {
    let bound = |chain: &[Point2<f64>]| -> Result<Bound, SplineError> {
        Ok(Bound {
            curve: sheet.surface.curve_over(chain)?,
            under: polyline(chain)?,
        })
    };
    // None is refused: a chain has two places at least, and they differ.
    let made = |chain: &Vec<Point2<f64>>| bound(chain).ok();
    chains(sheet).iter().filter_map(made).collect()
}

/// A polyline as a curve in the plane z = 0, its parameter its length.
fn polyline(chain: &[Point2<f64>]) -> Result<BSplineCurve, SplineError> {
    let mut knots = vec![0.0; 2];
    let mut length = 0.0;
    for pair in chain.windows(2) {
        length += (pair[1] - pair[0]).norm();
        knots.push(length);
    }
    knots.push(length);
    let points = chain.iter().map(|p| Point3::new(p.x, p.y, 0.0)).collect();
    BSplineCurve::new(1, knots, points, None)
}

/// The outline in (u, v), cut into chains.
///
/// Cut it is where it turns sharply and where it meets or leaves the first or
/// last u, along which neighbours are joined.
fn chains(sheet: &Sheet) -> Vec<Vec<Point2<f64>>> {
    let mut outline = sheet.outline.clone().unwrap_or_default();
    outline.dedup();
    if outline.len() > 1 && outline.first() == outline.last() {
        outline.pop();
    }
    let count = outline.len();
    if count < 3 {
        return Vec::new();
    }
    if doubled_area(&outline) < 0.0 {
        outline.reverse();
    }
    let ends = sheet.surface.domain(Axis::U);
    let at = |i: usize| outline[i % count];
    // Whether the outline leaves a place along the first or last u.
    let side = |i: usize| ends.map(|u| at(i).x == u && at(i + 1).x == u);
    let is_cut = |i: &usize| {
        let [before, here, after] = [at(i + count - 1), at(*i), at(i + 1)];
        side(*i) != side(i + count - 1) || turn(&(here - before), &(after - here)) > CORNER
    };
    let cuts: Vec<usize> = (0..count).filter(is_cut).collect();
    let Some(first) = cuts.first() else {
        // A smooth round outline: two edges, as one would have no ends.
        let half = count / 2;
        return [0..=half, half..=count]
            .map(|run| run.map(at).collect())
            .to_vec();
    };
    let nexts = cuts.iter().skip(1).copied().chain([first + count]);
    cuts.iter()
        .zip(nexts)
        .map(|(from, to)| (*from..=to).map(at).collect())
        .collect()
}

/// Angle between two directions, 0 to π.
fn turn(a: &Vector2<f64>, b: &Vector2<f64>) -> f64 {
    a.perp(b).atan2(a.dot(b)).abs()
}

/// Twice the area, positive where it runs counter-clockwise.
fn doubled_area(outline: &[Point2<f64>]) -> f64 {
    let next = outline.iter().cycle().skip(1);
    (outline.iter().zip(next))
        .map(|(a, b)| a.coords.perp(&b.coords))
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::BSplineSurface;
    use nalgebra::Point3;

    fn square(outline: &[[f64; 2]]) -> Sheet {
        let knots = || vec![0.0, 0.0, 2.0, 2.0];
        let points = [[0.0, 0.0], [0.0, 2.0], [2.0, 0.0], [2.0, 2.0]];
        let points = points.map(|[x, y]| Point3::new(x, y, 0.0)).to_vec();
        let surface = BSplineSurface::new([1, 1], [knots(), knots()], points, None);
        Sheet {
            name: "square".into(),
            surface: surface.expect("a square"),
            outline: Some(outline.iter().map(|p| Point2::from(*p)).collect()),
        }
    }

    fn lengths(sheet: &Sheet) -> Vec<usize> {
        chains(sheet).iter().map(Vec::len).collect()
    }

    #[test]
    fn an_outline_is_cut_at_corners_and_at_the_ends() {
        // Clockwise, with a place on the first ruling and a bent side.
        let strip = [
            [0.0, 0.2],
            [0.0, 1.0],
            [0.0, 1.8],
            [1.0, 1.9],
            [2.0, 1.8],
            [2.0, 0.2],
        ];
        let found = chains(&square(&strip));
        let sizes: Vec<usize> = found.iter().map(Vec::len).collect();
        assert_eq!(sizes.iter().sum::<usize>(), 6 + 4);
        assert!(sizes.contains(&3), "{sizes:?}");
        for (chain, next) in found.iter().zip(found.iter().cycle().skip(1)) {
            assert_eq!(chain.last(), next.first());
        }
        // A slanting ruling leaves no sharp corner, yet is an edge.
        let slant = [
            [0.0, 0.0],
            [1.7, 0.0],
            [2.0, 0.1],
            [2.0, 2.0],
            [1.0, 1.9],
            [0.0, 1.8],
        ];
        assert!(chains(&square(&slant)).contains(&vec![slant[2].into(), slant[3].into()]));
    }

    #[test]
    fn a_round_outline_has_two_edges() {
        let turn = |k: usize| std::f64::consts::TAU * k as f64 / 40.0;
        let circle: Vec<[f64; 2]> = (0..40)
            .map(|k| [1.0 + 0.5 * turn(k).cos(), 1.0 + 0.5 * turn(k).sin()])
            .collect();
        assert_eq!(lengths(&square(&circle)), [21, 21]);
        assert!(chains(&square(&circle[..2])).is_empty());
        assert!(
            lengths(&Sheet {
                outline: None,
                ..square(&[])
            })
            .is_empty()
        );
    }
}
