use super::*;
use crate::geometry::{Parametrization, interpolate_grid};
use std::collections::HashMap;

/// A shallow dome over 4 × 2 with the given outline and holes in (u, v).
fn dome(outer: Vec<[f64; 2]>, holes: Vec<Vec<[f64; 2]>>) -> FairSurfaceDrawing {
    let place = |i: usize, j: usize| {
        let [x, y] = [i as f64 * 0.25, j as f64 * 0.25];
        Point3::new(x, y, 0.3 * (0.8 * x).sin() * (1.2 * y).sin())
    };
    let grid: Vec<Point3<f64>> = (0..17)
        .flat_map(|i| (0..9).map(move |j| place(i, j)))
        .collect();
    let surface = interpolate_grid(&grid, [17, 9], [3, 3], Parametrization::Uniform);
    FairSurfaceDrawing {
        title: "dome".into(),
        units: "m".into(),
        surface: surface.expect("a regular grid"),
        outer,
        holes,
        points: Vec::new(),
        isophotes: None,
        verdict: "within_limits".into(),
        summary: Vec::new(),
    }
}

fn circle(centre: [f64; 2], radius: f64, n: usize) -> Vec<[f64; 2]> {
    let corner = |k: usize| {
        let (sin, cos) = (k as f64 / n as f64 * std::f64::consts::TAU).sin_cos();
        [centre[0] + radius * cos, centre[1] + radius * sin]
    };
    (0..n).map(corner).collect()
}

/// Area seen from above, loops of border edges; panics where an edge is not
/// shared by two triangles that run it in opposite directions or by one.
fn check(mesh: &Mesh) -> (f64, usize) {
    let mut edges: HashMap<[usize; 2], usize> = HashMap::new();
    let mut area = 0.0;
    for t in &mesh.triangles {
        for k in 0..3 {
            *edges.entry([t[k], t[(k + 1) % 3]]).or_default() += 1;
        }
        let [a, b, c] = t.map(|i| mesh.vertices[i]);
        let above = (b - a).cross(&(c - a));
        assert!(above.z > 0.0, "a triangle is turned over");
        t.iter()
            .for_each(|i| assert!(above.dot(&mesh.normals[*i]) > 0.0));
        area += above.z / 2.0;
    }
    assert!(edges.values().all(|n| *n == 1));
    let border: HashMap<usize, usize> = edges
        .keys()
        .filter(|[a, b]| !edges.contains_key(&[*b, *a]))
        .map(|[a, b]| (*a, *b))
        .collect();
    let mut left = border.clone();
    let mut loops = 0;
    while let Some(first) = left.keys().next().copied() {
        let mut at = first;
        while let Some(next) = left.remove(&at) {
            at = next;
        }
        assert_eq!(at, first, "the border is not closed");
        loops += 1;
    }
    (area, loops)
}

#[test]
fn the_whole_surface_is_meshed_to_its_corners() {
    let mesh = build(&dome(Vec::new(), Vec::new()));
    let (area, loops) = check(&mesh);
    assert!((area - 8.0).abs() < 1e-6, "{area}");
    assert_eq!(loops, 1);
    assert!(
        mesh.chordal_error < 3.0 * CHORDAL_SHARE * 4.5,
        "{}",
        mesh.chordal_error
    );
}

#[test]
fn outlines_and_holes_are_followed() {
    let drawing = dome(
        circle([0.5, 0.5], 0.45, 90),
        vec![circle([0.4, 0.6], 0.1, 40)],
    );
    let (area, loops) = check(&build(&drawing));
    let polygon = |n: f64, r: f64| n / 2.0 * r * r * (std::f64::consts::TAU / n).sin();
    let expected = 8.0 * (polygon(90.0, 0.45) - polygon(40.0, 0.1));
    assert!(
        (area / expected - 1.0).abs() < 1e-5,
        "{area} for {expected}"
    );
    assert_eq!(loops, 2);
}

#[test]
fn sharp_concave_and_touching_outlines() {
    // A star with thin rays, its tips on the border of the domain.
    let star = (0..14).map(|k| {
        let radius = if k % 2 == 0 { 0.5 } else { 0.08 };
        let (sin, cos) = (f64::from(k) / 14.0 * std::f64::consts::TAU).sin_cos();
        [0.5 + radius * cos, 0.5 + radius * sin]
    });
    let (_, loops) = check(&build(&dome(star.collect(), Vec::new())));
    assert_eq!(loops, 1);
    // A hole nearly as large as the outline, and a needle of a hole.
    let holes = vec![vec![[0.01, 0.01], [0.99, 0.01], [0.99, 0.5], [0.01, 0.5]]];
    assert_eq!(check(&build(&dome(Vec::new(), holes))).1, 2);
    let holes = vec![vec![[0.2, 0.5], [0.8, 0.5], [0.8, 0.500_01]]];
    assert_eq!(check(&build(&dome(Vec::new(), holes))).1, 2);
}

#[test]
fn nonsense_gives_the_whole_surface_or_nothing() {
    let broken = dome(vec![[f64::NAN, 0.0]; 5], vec![vec![[0.1, 0.1]; 2]]);
    assert!((check(&build(&broken)).0 - 8.0).abs() < 1e-6);
    assert!(
        build(&dome(vec![[0.5, 0.5]; 9], Vec::new()))
            .triangles
            .is_empty()
    );
    let beyond = dome(
        vec![[-9.0, -9.0], [9.0, -9.0], [9.0, 9.0], [-9.0, 9.0]],
        Vec::new(),
    );
    assert!((check(&build(&beyond)).0 - 8.0).abs() < 1e-6);
}
