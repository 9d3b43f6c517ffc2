//! The whole fit on strips whose answer is known.

use super::fit::fit_target;
use super::outcome::{Kind, Outcome};
use super::request::{Goal, Input, Norm, Options, Request};
use super::target::Target;
use crate::geometry::cone::{Frame, Strain};
use crate::solver::Unwatched;
use nalgebra::{Isometry3, Point3, Vector3};

/// Columns of the test strips.
const ACROSS: usize = 7;

/// A strip as a grid of triangles; rows run from side 0 to side 1.
pub(super) fn target(rows: &[Vec<Point3<f64>>]) -> Target {
    let points: Vec<Point3<f64>> = rows.concat();
    let mut triangles = Vec::new();
    for i in 0..rows.len() - 1 {
        for j in 0..ACROSS - 1 {
            let at = |a: usize, b: usize| (i + a) * ACROSS + j + b;
            triangles.push([at(0, 0), at(0, 1), at(1, 1)]);
            triangles.push([at(0, 0), at(1, 1), at(1, 0)]);
        }
    }
    let mut weights = vec![0.0; points.len()];
    for t in &triangles {
        let [a, b, c] = t.map(|v| points[v]);
        let area = (b - a).cross(&(c - a)).norm() / 6.0;
        t.iter().for_each(|v| weights[*v] += area);
    }
    let last = rows.len() - 1;
    let ruling = |i: usize| {
        let row = &rows[i * last / 40];
        [row[0], row[ACROSS - 1]]
    };
    Target {
        weights,
        triangles,
        sides: [0, ACROSS - 1].map(|j| rows.iter().map(|r| r[j]).collect()),
        ends: [rows[0].clone(), rows[last].clone()],
        rulings: (0..=40).map(ruling).collect(),
        warnings: Vec::new(),
        closed: false,
        points,
    }
}

/// Rows of a strip that is carried with strains given by arc length.
pub(super) fn carried(
    strain: impl Fn(f64) -> (f64, f64),
    length: f64,
    width: f64,
) -> Vec<Vec<Point3<f64>>> {
    const ROWS: usize = 120;
    const FINE: usize = 20;
    let mut frame = Frame {
        point: Point3::new(0.1, 0.2, -0.1),
        ruling: Vector3::new(0.6, 0.0, 0.8),
        normal: Vector3::y(),
    };
    let step = length / (ROWS * FINE) as f64;
    let mut rows = Vec::new();
    for i in 0..=ROWS * FINE {
        if i % FINE == 0 {
            let at = |j: usize| frame.at(width * (j as f64 / (ACROSS - 1) as f64 - 0.5));
            rows.push((0..ACROSS).map(at).collect());
        }
        let (g, k) = strain((i as f64 + 0.5) * step);
        frame = frame.carried(Strain { g, k }, step);
    }
    rows
}

/// Constant strains one after the other, with their lengths.
pub(super) fn pieces(list: &'static [(f64, f64, f64)]) -> impl Fn(f64) -> (f64, f64) {
    move |s| {
        let mut end = 0.0;
        for (g, k, length) in list {
            end += length;
            if s < end {
                return (*g, *k);
            }
        }
        (0.0, 0.0)
    }
}

fn fit(target: &Target, goal: Goal, norm: Option<Norm>) -> Outcome {
    let request = Request {
        name: "strip".to_owned(),
        input: Input::Mesh {
            vertices: Vec::new(),
            faces: Vec::new(),
        },
        options: Options {
            goal,
            norm,
            ..Options::default()
        },
    };
    fit_target(&request, target, &Unwatched).expect("a strip")
}

const FIVE: [(f64, f64, f64); 5] = [
    (0.5, 1.5, 0.24),
    (-0.3, 0.6, 0.27),
    (0.0, 1.0, 0.21),
    (0.4, -0.8, 0.24),
    (-0.6, -1.6, 0.24),
];

#[test]
fn an_exact_spline_is_found_with_its_number_and_kinds() {
    let strip = target(&carried(pieces(&FIVE), 1.2, 0.2));
    let outcome = fit(&strip, Goal::Tolerance(1e-9), None);
    assert!(
        outcome.within_limits && outcome.reachable,
        "{:?}",
        outcome.summary
    );
    assert!(outcome.to_surface.max < 1e-11);
    let kinds: Vec<Kind> = outcome.patches.iter().map(|p| p.kind).collect();
    let mut expected = [Kind::Cone; 5];
    expected[2] = Kind::Cylinder;
    assert_eq!(kinds, expected);
    assert!(
        outcome
            .joins
            .iter()
            .all(|j| j.gap < 1e-12 && j.angle_deg < 1e-10)
    );
}

#[test]
fn planes_and_a_cylinder_are_found() {
    const LIST: [(f64, f64, f64); 3] = [(0.0, 0.0, 0.3), (0.0, 2.5, 0.4), (0.0, 0.0, 0.35)];
    let strip = target(&carried(pieces(&LIST), 1.05, 0.3));
    let outcome = fit(&strip, Goal::Tolerance(1e-9), None);
    let kinds: Vec<Kind> = outcome.patches.iter().map(|p| p.kind).collect();
    assert_eq!(kinds, [Kind::Plane, Kind::Cylinder, Kind::Plane]);
    assert!(outcome.to_surface.max < 1e-11 && outcome.to_mesh.max < 4e-5);
}

/// Strains that change all the way.
fn wave(s: f64) -> (f64, f64) {
    (0.7 * (3.0 * s).sin(), 2.5 * (4.0 * s + 0.3).sin())
}

#[test]
fn errors_fall_with_the_cube_of_the_number() {
    let strip = target(&carried(wave, 1.2, 0.2));
    let outcome = fit(&strip, Goal::Pieces(12), None);
    let rms = |k: usize| {
        outcome
            .error_curve
            .iter()
            .find(|p| p.patches == k)
            .expect("on the curve")
            .rms
    };
    let slope = (rms(12) / rms(6)).ln() / 2_f64.ln();
    assert!(slope < -2.6, "{slope}");
    assert!(outcome.error_curve.windows(2).all(|p| p[1].rms <= p[0].rms));
    assert!(outcome.floor.max <= outcome.to_surface.max);
}

#[test]
fn a_tolerance_is_kept_with_no_patch_too_many() {
    let strip = target(&carried(wave, 1.2, 0.2));
    let outcome = fit(&strip, Goal::Tolerance(1e-3), None);
    assert!(outcome.within_limits && outcome.to_surface.max <= 1e-3);
    let fewer = fit(
        &strip,
        Goal::Pieces(outcome.patches.len() - 1),
        Some(Norm::Minimax),
    );
    assert!(fewer.to_surface.max > 1e-3);
}

#[test]
fn the_answer_does_not_depend_on_pose_or_direction() {
    let rows = carried(wave, 1.2, 0.2);
    let here = fit(&target(&rows), Goal::Pieces(6), None);
    let pose = Isometry3::new(Vector3::new(40.0, -7.0, 3.0), Vector3::new(0.4, 1.1, -0.8));
    let moved: Vec<Vec<_>> = (rows.iter())
        .map(|r| r.iter().map(|p| pose * p).collect())
        .collect();
    let mut other = target(&moved);
    other.sides.iter_mut().for_each(|s| s.reverse());
    other.ends.swap(0, 1);
    other.rulings.reverse();
    other.triangles.iter_mut().for_each(|t| t.swap(0, 1));
    let there = fit(&other, Goal::Pieces(6), None);
    for (a, b) in here.vertex_distances.iter().zip(&there.vertex_distances) {
        assert!((a + b).abs() < 1e-6, "{a} {b}");
    }
}

#[test]
fn patches_become_simpler_within_the_tolerance() {
    let strip = target(&carried(|s| (0.02 * (5.0 * s).sin(), 1.5), 0.8, 0.2));
    let request = |simplify| Request {
        name: "strip".to_owned(),
        input: Input::Mesh {
            vertices: Vec::new(),
            faces: Vec::new(),
        },
        options: Options {
            goal: Goal::Tolerance(4e-3),
            simplify,
            ..Options::default()
        },
    };
    let of = |simplify| fit_target(&request(simplify), &strip, &Unwatched).expect("a strip");
    assert!(of(false).patches.iter().all(|p| p.kind == Kind::Cone));
    let simple = of(true);
    assert!(simple.patches.iter().all(|p| p.kind == Kind::Cylinder) && simple.within_limits);
}

#[test]
fn outliers_lose_their_hold() {
    let rows = carried(pieces(&FIVE), 1.2, 0.2);
    let mut strip = target(&rows);
    let clean = strip.points.clone();
    for i in (25..strip.points.len()).step_by(50) {
        strip.points[i].y += 0.03;
    }
    let request = Request {
        name: "strip".to_owned(),
        input: Input::Mesh {
            vertices: Vec::new(),
            faces: Vec::new(),
        },
        options: Options {
            goal: Goal::Pieces(5),
            robust: true,
            ..Options::default()
        },
    };
    let outcome = fit_target(&request, &strip, &Unwatched).expect("a strip");
    let moved = |i: &usize| (strip.points[*i] - clean[*i]).norm() > 0.0;
    let others = (0..clean.len()).filter(|i| !moved(i));
    let worst = others
        .map(|i| outcome.vertex_distances[i].abs())
        .fold(0.0, f64::max);
    assert!(worst < 1e-5, "{worst}");
    assert!(outcome.report.outliers.iter().all(moved) && outcome.report.outliers.len() > 10);
}

#[test]
fn a_sphere_band_says_how_near_patches_can_come() {
    let (radius, half) = (0.5, 15_f64.to_radians());
    let row = |i: usize| {
        let at = move |j: usize| {
            let turn = std::f64::consts::PI * i as f64 / 120.0;
            let up = half * (2.0 * j as f64 / (ACROSS - 1) as f64 - 1.0);
            Point3::new(up.cos() * turn.cos(), up.cos() * turn.sin(), up.sin()) * radius
        };
        (0..ACROSS).map(at).collect()
    };
    let strip = target(&(0..=120).map(row).collect::<Vec<_>>());
    let outcome = fit(&strip, Goal::Pieces(1), Some(Norm::Minimax));
    let best = 0.5 * radius * (1.0 - half.cos());
    assert!(
        outcome.to_surface.max < 1.02 * best,
        "{:?}",
        outcome.to_surface
    );
    let outcome = fit(&strip, Goal::Tolerance(1e-3), None);
    assert!(!outcome.reachable && !outcome.within_limits);
    assert!(outcome.floor.max > 1e-3);
}
