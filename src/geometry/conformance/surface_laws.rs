//! The laws of surfaces, run on samples and on random nets.

use super::samples;
use crate::geometry::bspline::surface_from_rows;
use crate::geometry::{
    Axis, BSplineCurve, BSplineSurface, Knots, Parametrization, interpolate_grid,
};
use nalgebra::{Point3, Vector3, point};

fn parameters(s: &BSplineSurface, axis: Axis) -> Vec<f64> {
    let mut t = s.knot_vector(axis).breakpoints();
    let [a, b] = s.domain(axis);
    t.extend((0..=7).map(|i| a + (b - a) * (i as f64 / 7.0)));
    t
}

fn size(s: &BSplineSurface) -> f64 {
    let least = s.bounding_box().diagonal();
    s.control_points()
        .iter()
        .map(|p| p.coords.amax())
        .fold(least, f64::max)
}

/// Largest distance of points of equal parameters, relative to the size.
fn apart(a: &BSplineSurface, b: &BSplineSurface, map: impl Fn(f64, f64) -> [f64; 2]) -> f64 {
    let mut worst = 0.0_f64;
    for u in parameters(a, Axis::U) {
        for v in parameters(a, Axis::V) {
            let [x, y] = map(u, v);
            worst = worst.max((a.point(u, v) - b.point(x, y)).norm());
        }
    }
    worst / size(a)
}

/// All laws at once.
pub(crate) fn check(name: &str, s: &BSplineSurface) {
    derivatives(name, s);
    boundaries(name, s);
    for axis in [Axis::U, Axis::V] {
        forms(name, s, axis);
    }
}

/// Partial derivatives against differences, inside the spans.
fn derivatives(name: &str, s: &BSplineSurface) {
    let (bu, bv) = (
        s.knot_vector(Axis::U).breakpoints(),
        s.knot_vector(Axis::V).breakpoints(),
    );
    for (pu, pv) in bu
        .windows(2)
        .flat_map(|u| bv.windows(2).map(move |v| (u, v)))
    {
        let (wu, wv) = (pu[1] - pu[0], pv[1] - pv[0]);
        let (u, v) = (pu[0] + 0.37 * wu, pv[0] + 0.61 * wv);
        let (hu, hv) = (1e-4 * wu, 1e-4 * wv);
        let at = s.derivatives(u, v);
        let [u0, u1] = [s.derivatives(u - hu, v), s.derivatives(u + hu, v)];
        let [v0, v1] = [s.derivatives(u, v - hv), s.derivatives(u, v + hv)];
        let near = |got: Vector3<f64>, want: Vector3<f64>, scale: f64, h: f64| {
            let allowed = 1e-5 * (want.norm() + scale) + 1e-14 * scale / h;
            assert!(
                (got - want).norm() < allowed,
                "{name} at {u} {v}: {got} for {want}"
            );
        };
        let k = size(s);
        near((u1.point - u0.point) / (2.0 * hu), at.du, k / wu, 1e-4);
        near((v1.point - v0.point) / (2.0 * hv), at.dv, k / wv, 1e-4);
        near((u1.du - u0.du) / (2.0 * hu), at.duu, k / wu / wu, 1e-4);
        near((v1.dv - v0.dv) / (2.0 * hv), at.dvv, k / wv / wv, 1e-4);
        near((u1.dv - u0.dv) / (2.0 * hu), at.duv, k / wu / wv, 1e-4);
        near((v1.du - v0.du) / (2.0 * hv), at.duv, k / wu / wv, 1e-4);
    }
}

fn boundaries(name: &str, s: &BSplineSurface) {
    let ([a, b], [c, d]) = (s.domain(Axis::U), s.domain(Axis::V));
    let [v0, v1, u0, u1] = s.boundary_curves();
    let box_ = s.bounding_box();
    for u in parameters(s, Axis::U) {
        assert!(
            (v0.point(u) - s.point(u, c)).norm() < 1e-14 * size(s),
            "{name}"
        );
        assert!(
            (v1.point(u) - s.point(u, d)).norm() < 1e-14 * size(s),
            "{name}"
        );
        for v in parameters(s, Axis::V) {
            assert!(box_.contains(&s.point(u, v), 1e-14 * size(s)), "{name}");
        }
    }
    for v in parameters(s, Axis::V) {
        assert!(
            (u0.point(v) - s.point(a, v)).norm() < 1e-14 * size(s),
            "{name}"
        );
        assert!(
            (u1.point(v) - s.point(b, v)).norm() < 1e-14 * size(s),
            "{name}"
        );
    }
    let corners = [v0.start(), v0.end(), v1.start(), v1.end()];
    let from_v = [u0.start(), u1.start(), u0.end(), u1.end()];
    assert_eq!(corners, from_v, "{name}");
    assert_eq!(
        corners,
        [s.point(a, c), s.point(b, c), s.point(a, d), s.point(b, d)],
        "{name}"
    );
}

fn forms(name: &str, s: &BSplineSurface, axis: Axis) {
    let [a, b] = s.domain(axis);
    let inside = |x: f64| a + (b - a) * x;
    let same = |u: f64, v: f64| [u, v];
    let fine = s
        .insert_knots(axis, &[inside(0.313), inside(0.77)])
        .expect("inside");
    assert!(apart(s, &fine, same) < 5e-15, "{name}");
    let raised = s.elevated(axis).expect("below the largest degree");
    assert!(apart(s, &raised, same) < 1e-13, "{name}");
    let (left, right) = s.split(axis, inside(0.37)).expect("inside");
    assert!(
        apart(&left, s, same) < 5e-15 && apart(&right, s, same) < 5e-15,
        "{name}"
    );
    let mirrored = |u: f64, v: f64| match axis {
        Axis::U => [a + (b - u), v],
        Axis::V => [u, a + (b - v)],
    };
    assert!(
        apart(s, &s.reversed(axis).expect("valid"), mirrored) < 1e-13,
        "{name}"
    );
    let across = if axis == Axis::U { Axis::V } else { Axis::U };
    for t in parameters(s, axis) {
        let iso = s.iso_curve(across, t).expect("valid");
        for x in parameters(s, across) {
            let want = if axis == Axis::U {
                s.point(t, x)
            } else {
                s.point(x, t)
            };
            assert!((iso.point(x) - want).norm() < 1e-14 * size(s), "{name}");
        }
    }
}

/// A net with the knots of two sample curves, rational where the first is.
fn net(u: &BSplineCurve, v: &BSplineCurve) -> BSplineSurface {
    let rows: Vec<BSplineCurve> = v
        .control_points()
        .iter()
        .enumerate()
        .map(|(k, p)| {
            u.translated(&(p.coords * 0.7))
                .scaled(1.0 + 0.05 * k as f64)
        })
        .collect();
    surface_from_rows(Axis::U, &rows, v.knot_vector().clone()).expect("valid")
}

/// A quarter of a cylinder of radius 2 between z = 1 and z = 4.
fn cylinder() -> BSplineSurface {
    let arc = samples::quarter_circle(2.0);
    let rows = [arc.clone(), arc.translated(&Vector3::new(0., 0., 3.))];
    let across = Knots::clamped(1, [0., 1.], &[]).expect("valid");
    surface_from_rows(Axis::U, &rows, across).expect("valid")
}

#[test]
fn sample_surfaces_keep_the_laws() {
    check("cylinder", &cylinder());
    for p in 1..=5 {
        for q in 1..=3 {
            check("net", &net(&samples::wild(p), &samples::wild(q)));
            check(
                "rational net",
                &net(&samples::wild_rational(p), &samples::wild(q)),
            );
        }
    }
}

#[test]
fn a_cylinder_is_round_and_its_normal_points_along_the_radius() {
    let s = cylinder();
    for u in [0.0, 0.2, 0.5, 1.0] {
        for v in [0.0, 0.3, 1.0] {
            let p = s.point(u, v);
            assert!((p.coords.xy().norm() - 2.0).abs() < 1e-14);
            let n = s.normal(u, v).expect("regular");
            let radial = Vector3::new(p.x, p.y, 0.0) / 2.0;
            assert!((n - radial).norm() < 1e-14);
        }
    }
}

#[test]
fn counts_are_checked() {
    let k = || vec![0., 0., 1., 1.];
    let few = BSplineSurface::new([1, 1], [k(), k()], vec![Point3::origin(); 3], None);
    assert!(few.is_err());
    let weights = Some(vec![1.0, 1.0, 0.0, 1.0]);
    assert!(BSplineSurface::new([1, 1], [k(), k()], vec![Point3::origin(); 4], weights).is_err());
}

#[test]
fn a_surface_through_a_grid_of_points() {
    let f = |i: usize, j: usize| {
        let (x, y) = (i as f64 * 0.5, j as f64 * 0.4);
        point![x, y, (0.7 * x).sin() * y.cos()]
    };
    let (n, m) = (9, 7);
    let grid: Vec<_> = (0..n).flat_map(|i| (0..m).map(move |j| f(i, j))).collect();
    let s = interpolate_grid(&grid, [n, m], [3, 2], Parametrization::Uniform).expect("distinct");
    for (k, p) in grid.iter().enumerate() {
        let (u, v) = (
            (k / m) as f64 / (n - 1) as f64,
            (k % m) as f64 / (m - 1) as f64,
        );
        assert!((s.point(u, v) - p).norm() < 1e-13);
    }
    check("grid", &s);
    let short = interpolate_grid(&grid[1..], [n, m], [3, 2], Parametrization::Uniform);
    assert!(short.is_err());
}
