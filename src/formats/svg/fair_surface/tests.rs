use super::*;
use crate::formats::fair_points::FairPoint;
use crate::formats::fair_surface::Isophotes;
use crate::geometry::{BSplineSurface, Parametrization, interpolate_grid};
use nalgebra::{Point3, Vector3};

fn surface(place: impl Fn(f64, f64) -> Point3<f64>) -> BSplineSurface {
    let at = |k: usize| k as f64 / 8.0;
    let grid = (0..9).flat_map(|i| (0..9).map(move |j| (at(i), at(j))));
    let grid: Vec<Point3<f64>> = grid.map(|(u, v)| place(u, v)).collect();
    interpolate_grid(&grid, [9, 9], [3, 3], Parametrization::Uniform).expect("a regular grid")
}

fn drawing(surface: BSplineSurface) -> FairSurfaceDrawing {
    let grid: Vec<f64> = (0..21).map(|i| f64::from(i) / 20.0).collect();
    let angle = |u: f64, v: f64| {
        let normal = surface.normal(u, v)?;
        (u + v < 1.6).then(|| normal.dot(&Vector3::new(0.6, 0.0, 0.8)).acos().to_degrees())
    };
    let row = |u: &f64| grid.iter().map(|v| angle(*u, *v)).collect();
    let values = grid.iter().map(row).collect();
    let point = |i: usize| {
        let now = surface.point(i as f64 / 20.0, 0.3);
        FairPoint {
            index: 100 + i,
            given: now + Vector3::z() * (0.001 * i as f64),
            now,
            distance: 0.001 * i as f64,
            tolerance: Some(0.02),
            slip: (i == 15).then_some(now),
            at_limit: i == 19,
        }
    };
    FairSurfaceDrawing {
        title: "Sheet & more".into(),
        units: "m".into(),
        points: (0..20).map(point).collect(),
        isophotes: Some(Isophotes {
            u: grid.clone(),
            v: grid.clone(),
            values,
        }),
        surface,
        outer: vec![[0.0, 0.0], [1.0, 0.0], [1.0, 0.6], [0.6, 1.0], [0.0, 1.0]],
        holes: vec![vec![[0.2, 0.2], [0.3, 0.2], [0.3, 0.3]]],
        verdict: "outside_limits".into(),
        summary: vec!["One sheet.".into()],
    }
}

fn dome(u: f64, v: f64) -> Point3<f64> {
    Point3::new(4.0 * u, 2.0 * v, (3.0 * u).sin() * 0.5 + 0.3 * v * v)
}

#[test]
fn the_page_shows_bands_moves_and_slips() {
    let page = plot(&drawing(surface(dome)));
    for expected in [
        "Isophotes (x–y, m)",
        "normal to light in bands of ",
        "Largest moves (m)",
        "point 119",
        ">0.0190<",
        ">95 %<",
        "Suspected slips: off by (m)",
        "point 115",
        "fill-rule=\"evenodd\"",
        "Sheet &amp; more",
        "outside limits · lengths in m",
        "One sheet.",
    ] {
        assert!(page.contains(expected), "no {expected:?}");
    }
    assert!(!page.contains("NaN") && !page.contains("href"));
}

#[test]
fn a_sheet_that_folds_over_is_drawn_developed() {
    let tube = |u: f64, v: f64| {
        let (sin, cos) = (u * 4.5).sin_cos();
        Point3::new(cos, 3.0 * v, sin)
    };
    let page = plot(&drawing(surface(tube)));
    assert!(page.contains("developed along u and v") && !page.contains("same scale"));
}

#[test]
fn a_side_of_a_ship_stands_upright() {
    let side = |u: f64, v: f64| Point3::new(30.0 * u, 4.0 - v + 0.4 * u * u, 3.0 * v);
    assert!(plot(&drawing(surface(side))).contains("Isophotes ("));
    let wall = |u: f64, v: f64| Point3::new(30.0 * u, 4.0 - 0.2 * u * u * v, 3.0 * v);
    assert!(plot(&drawing(surface(wall))).contains("Isophotes (x–z, m)"));
}

#[test]
fn empty_and_broken_drawings_are_still_pages() {
    let mut empty = drawing(surface(dome));
    empty.points.clear();
    empty.isophotes = None;
    assert!(plot(&empty).contains("One sheet."));
    let knots = vec![0.0, 0.0, 1.0, 1.0];
    let point = vec![Point3::new(1.0, 1.0, 1.0); 4];
    let point = BSplineSurface::new([1, 1], [knots.clone(), knots], point, None);
    let mut broken = drawing(point.expect("a point is a surface"));
    broken.points[3].now.x = f64::NAN;
    if let Some(isophotes) = &mut broken.isophotes {
        isophotes.values.truncate(7);
        isophotes.values[0][0] = Some(f64::INFINITY);
        isophotes.u[3] = f64::NAN;
    }
    let page = plot(&broken);
    assert!(!page.contains("NaN") && !page.contains("inf"));
}
