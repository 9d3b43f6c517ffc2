use super::*;
use crate::geometry::BSplineSurface;
use crate::methods::cone_spline::request::Options;
use crate::solver::Unwatched;
use nalgebra::{Isometry3, Vector3, distance};
use std::f64::consts::{PI, TAU};

type Polygons = (Vec<Point3<f64>>, Vec<Vec<usize>>);

/// Rows of quads; `at(u, v)` with u and v in [0, 1].
fn grid(rows: usize, columns: usize, at: impl Fn(f64, f64) -> [f64; 3]) -> Polygons {
    let share = |i: usize, n: usize| i as f64 / n as f64;
    let vertices = (0..=rows).flat_map(|i| (0..=columns).map(move |j| (i, j)));
    let vertices = vertices.map(|(i, j)| Point3::from(at(share(i, rows), share(j, columns))));
    let quad = |i: usize, j: usize| {
        let (a, b) = (i * (columns + 1) + j, (i + 1) * (columns + 1) + j);
        vec![a, b, b + 1, a + 1]
    };
    let faces = (0..rows).flat_map(|i| (0..columns).map(move |j| quad(i, j)));
    (vertices.collect(), faces.collect())
}

/// Rows that close: the last is the first.
fn ring(rows: usize, columns: usize, at: impl Fn(f64, f64) -> [f64; 3]) -> Polygons {
    let (mut vertices, mut faces) = grid(rows, columns, at);
    vertices.truncate(rows * (columns + 1));
    let count = vertices.len();
    for corner in faces.iter_mut().flatten() {
        *corner %= count;
    }
    (vertices, faces)
}

/// Part of a cone of half angle 30°: rulings of length 0.4 from 1 to 1.4.
fn cone(u: f64, v: f64) -> [f64; 3] {
    let (angle, slant) = (2.5 * u, 1.0 + 0.4 * v);
    [
        0.5 * slant * angle.cos(),
        0.5 * slant * angle.sin(),
        0.75_f64.sqrt() * slant,
    ]
}

fn request((vertices, faces): Polygons, cut: Option<Point3<f64>>) -> Request {
    Request {
        name: "strip".into(),
        input: Input::Mesh { vertices, faces },
        options: Options {
            cut,
            ..Options::default()
        },
    }
}

fn target(mesh: Polygons) -> Target {
    Target::of(&request(mesh, None), &Unwatched).unwrap()
}

fn refusal(mesh: Polygons) -> (String, &'static str) {
    match Target::of(&request(mesh, None), &Unwatched) {
        Err(FitError::Invalid(issues)) => (issues[0].path.join("/"), issues[0].code),
        other => panic!("{other:?}"),
    }
}

/// How far rulings are from those of the cone above: its apex is the origin.
fn off_the_apex(target: &Target) -> f64 {
    let miss = |[p, q]: &[Point3<f64>; 2]| {
        let r = (q - p).normalize();
        r.cross(&p.coords).norm()
    };
    target.rulings.iter().map(miss).fold(0.0, f64::max)
}

#[test]
fn a_cone_has_its_rulings_and_corners() {
    let target = target(grid(60, 6, cone));
    assert!(off_the_apex(&target) < 0.02, "{}", off_the_apex(&target));
    assert_eq!(target.sides.each_ref().map(Vec::len), [61, 61]);
    assert_eq!(target.ends.each_ref().map(Vec::len), [7, 7]);
    // They close the outline.
    for e in 0..2 {
        let corner = |s: usize| target.sides[s][e * 60];
        assert_eq!(
            [corner(0), corner(1)],
            [target.ends[e][0], target.ends[e][6]]
        );
    }
    let area: f64 = target.weights.iter().sum();
    assert!((area - 0.6).abs() < 1e-3, "{area}");
    // r × t looks where the triangles look.
    let [p, q] = target.rulings[20];
    let t = target.rulings[21][0] - p;
    let away = |v: &[usize; 3]| distance(&target.points[v[0]], &p);
    let nearest = target
        .triangles
        .iter()
        .min_by(|s, t| away(s).total_cmp(&away(t)));
    let [a, b, c] = nearest.unwrap().map(|v| target.points[v]);
    assert!((q - p).cross(&t).dot(&(b - a).cross(&(c - a))) > 0.0);
}

#[test]
fn order_pose_and_orientation_change_nothing() {
    let (vertices, faces) = grid(40, 5, |u, v| {
        // One end wider than the other, so that it is no mirror image.
        let wide = 0.5 + (v - 0.5) * (1.0 + 0.6 * u);
        cone(u, wide)
    });
    let plain = target((vertices.clone(), faces.clone()));
    let n = vertices.len();
    let moved = Isometry3::new(Vector3::new(3.0, -2.0, 1.0), Vector3::new(0.3, 1.1, -0.7));
    let renamed = |i: usize| (i * 101 + 17) % n;
    let mut there = vec![Point3::origin(); n];
    for (i, p) in vertices.iter().enumerate() {
        there[renamed(i)] = moved * p;
    }
    let mut turned: Vec<Vec<usize>> = (faces.iter())
        .map(|f| f.iter().rev().map(|v| renamed(*v)).collect())
        .collect();
    turned.rotate_left(77);
    let other = target((there, turned));
    // Turned inside out, so that the sides have changed places.
    for (a, b) in plain.rulings.iter().zip(&other.rulings) {
        for (p, q) in a.iter().zip([b[1], b[0]]) {
            assert!(distance(&(moved * p), &q) < 1e-9);
        }
    }
}

#[test]
fn noise_makes_no_corners() {
    let mut state = 7_u64;
    let mut noise = move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        ((state >> 33) as f64 / f64::from(u32::MAX >> 1) - 0.5) * 0.02
    };
    let (mut vertices, faces) = grid(100, 12, |u, v| [u, 0.1 * (5.0 * u).sin(), 0.25 * v]);
    vertices.iter_mut().for_each(|p| {
        p.coords += Vector3::new(noise(), noise(), noise());
    });
    let corners = [0, 12, 100 * 13, 100 * 13 + 12].map(|i| vertices[i]);
    let target = target((vertices, faces));
    for end in &target.ends {
        for tip in [end[0], end[end.len() - 1]] {
            let near = corners
                .iter()
                .map(|c| distance(c, &tip))
                .fold(1.0, f64::min);
            assert!(near < 0.03, "{near}");
        }
    }
}

#[test]
fn a_ring_is_cut_where_it_is_narrow_or_where_one_says() {
    let band = |u: f64, v: f64| {
        let width = 1.0 - 0.4 * (-(20.0 * (u - 0.25)).powi(2)).exp();
        [(TAU * u).cos(), (TAU * u).sin(), 0.3 * width * v]
    };
    let mesh = ring(48, 4, band);
    let narrow = target(mesh.clone());
    assert!(narrow.closed && narrow.warnings[0].contains("closed ring"));
    assert_eq!(narrow.points.len(), 48 * 5 + 5);
    for end in &narrow.ends {
        assert!(
            end.iter()
                .all(|p| (p - Point3::new(0.0, 1.0, p.z)).norm() < 1e-12)
        );
    }
    let area: f64 = narrow.weights.iter().sum();
    let there = Point3::new(-1.1, 0.0, 0.1);
    let asked = Target::of(&request(mesh, Some(there)), &Unwatched).unwrap();
    for end in &asked.ends {
        assert!(
            end.iter()
                .all(|p| (p - Point3::new(-1.0, 0.0, p.z)).norm() < 1e-12)
        );
    }
    assert!((asked.weights.iter().sum::<f64>() - area).abs() < 1e-12);
    let lengths = asked.rulings.iter().map(|[p, q]| distance(p, q));
    assert!(lengths.fold(0.0, f64::max) < 0.35);
}

#[test]
fn what_is_no_strip_is_refused_with_its_place() {
    let flat = |u: f64, v: f64| [4.0 * u, v, 0.0];
    // A Möbius band: the last row is the first upside down.
    let (mut vertices, mut faces) = grid(40, 4, |u, v| {
        let (a, w) = (TAU * u, 0.4 * (v - 0.5));
        let r = 1.0 + w * (0.5 * a).cos();
        [r * a.cos(), r * a.sin(), w * (0.5 * a).sin()]
    });
    vertices.truncate(40 * 5);
    for corner in faces.iter_mut().flatten().filter(|c| **c >= 200) {
        *corner = 204 - *corner;
    }
    assert_eq!(refusal((vertices, faces)).1, "moebius-band");

    let (vertices, mut faces) = grid(20, 5, flat);
    faces.remove(52);
    let (place, code) = refusal((vertices, faces));
    assert_eq!((place.as_str(), code), ("input/mesh/vertices/62", "hole"));

    let (mut vertices, mut faces) = grid(20, 5, flat);
    let (more, others) = grid(3, 3, |u, v| [u, v, 5.0]);
    faces.extend(others.iter().map(|f| f.iter().map(|v| v + 126).collect()));
    vertices.extend(more);
    let (place, code) = refusal((vertices, faces));
    assert_eq!(
        (place.as_str(), code),
        ("input/mesh/faces/100", "several-pieces")
    );

    let fold = |u: f64, v: f64| [4.0 * u, (v - 0.5).abs(), (v - 0.5).max(0.0)];
    assert_eq!(refusal(grid(20, 6, fold)).1, "crease");
    let knee = |u: f64, v: f64| [(u - 0.5).min(0.0), v * 0.2, (u - 0.5).max(0.0)];
    assert_eq!(refusal(grid(20, 6, knee)).1, "crease");

    let disc = |u: f64, v: f64| {
        [
            (0.01 + v) * (TAU * u).cos(),
            (0.01 + v) * (TAU * u).sin(),
            0.0,
        ]
    };
    let (mut vertices, mut faces) = ring(40, 6, disc);
    vertices.push(Point3::origin());
    faces.extend(
        (0..40)
            .map(|i| vec![280, (i + 1) % 40 * 7, i * 7])
            .map(|mut f| {
                f.reverse();
                f
            }),
    );
    assert_eq!(
        refusal((vertices, faces)),
        ("input/mesh".into(), "not-a-strip")
    );

    let (vertices, mut faces) = grid(20, 5, flat);
    faces.push(vec![7, 8, 80]);
    assert_eq!(refusal((vertices.clone(), faces)).1, "non-manifold-edge");
    let (_, faces) = grid(20, 5, flat);
    let mut doubled = vertices.clone();
    doubled[7] = doubled[8];
    doubled[13] = doubled[14];
    assert_eq!(
        refusal((doubled, faces.clone())),
        ("input/mesh/faces/6".into(), "degenerate-face")
    );
    let mut spare = vertices;
    spare.push(Point3::origin());
    assert_eq!(
        refusal((spare, faces)),
        ("input/mesh/vertices/126".into(), "unused-vertex")
    );
}

#[test]
fn a_bend_of_a_coarse_mesh_is_no_crease() {
    let bend = |u: f64, v: f64| [(PI * u).cos(), (PI * u).sin(), 0.4 * v];
    assert_eq!(target(grid(5, 1, bend)).rulings.len(), 41);
}

/// A ruled surface of degree [1, 1] or [2, 1] between two rows of points.
fn ruled(degree: usize, rows: &[[[f64; 3]; 2]]) -> Request {
    let inner = rows.len() - degree;
    let mut knots = vec![0.0; degree];
    knots.extend((0..=inner).map(|i| i as f64));
    knots.extend(vec![inner as f64; degree]);
    let points = rows.iter().flatten().map(|p| Point3::from(*p)).collect();
    let surface = BSplineSurface::new([degree, 1], [knots, vec![0.0, 0.0, 1.0, 1.0]], points, None);
    Request {
        name: "plate".into(),
        input: Input::Ruled(surface.unwrap()),
        options: Options::default(),
    }
}

#[test]
fn a_plate_may_run_out_in_a_point() {
    let rows = [
        [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        [[2.0, 0.0, 0.0], [2.0, 1.0, 0.3]],
        [[4.0, 0.2, 1.0], [4.0, 0.2, 1.0]],
    ];
    let target = Target::of(&ruled(2, &rows), &Unwatched).unwrap();
    assert!(target.warnings[0].contains("(4.000000, 0.200000, 1.000000)"));
    let tip = Point3::new(4.0, 0.2, 1.0);
    assert_eq!(target.ends[1].len(), 3);
    assert_eq!(target.ends[1][1], tip);
    assert!(distance(&target.rulings[40][0], &tip) < 0.2);
    // As a mesh the same plate has the same ends.
    let mesh = (
        target.points.clone(),
        target.triangles.iter().map(|t| t.to_vec()).collect(),
    );
    let again = Target::of(&request(mesh, None), &Unwatched).unwrap();
    assert!(again.ends[1].iter().any(|p| distance(p, &tip) < 1e-9));
}

#[test]
fn surfaces_that_are_not_ruled_or_have_a_knuckle_are_refused() {
    let knuckle = [
        [[0.0, 0.0, 0.0], [0.0, 0.3, 0.0]],
        [[2.0, 0.0, 0.0], [2.0, 0.3, 0.0]],
        [[2.0, 0.0, 2.0], [2.0, 0.3, 2.0]],
    ];
    let Err(FitError::Invalid(issues)) = Target::of(&ruled(1, &knuckle), &Unwatched) else {
        panic!("a knuckle went through");
    };
    assert_eq!(
        (issues[0].path.join("/").as_str(), issues[0].code),
        ("input/surface", "crease")
    );
    let points = (0..9)
        .map(|i| Point3::new(f64::from(i / 3), f64::from(i % 3), 0.0))
        .collect();
    let knots = vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
    let surface = BSplineSurface::new([2, 2], [knots.clone(), knots], points, None).unwrap();
    let request = Request {
        input: Input::Ruled(surface),
        ..ruled(1, &knuckle)
    };
    let Err(FitError::Invalid(issues)) = Target::of(&request, &Unwatched) else {
        panic!("not ruled, yet it went through");
    };
    assert_eq!(issues[0].code, "not-ruled");
}
