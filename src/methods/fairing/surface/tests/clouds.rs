use super::super::outcome::Parametrisation;
use super::super::validate;
use super::*;
use crate::methods::FitError;

#[test]
fn a_height_field_along_its_own_axis() {
    let sigma = 0.02;
    let points = cloud(bowl, 5000, (sigma, &mut Noise::new(11)));
    let outcome = done(&request(Points::Scattered(points)));
    assert_eq!(
        outcome.parametrisation,
        Parametrisation::HeightField(Vector3::z())
    );
    assert!(
        (outcome.noise / sigma - 1.0).abs() < 0.06,
        "{}",
        outcome.noise
    );
    let off = from_truth(&outcome.surface, bowl);
    // Some 150 degrees of freedom from 5000 points: √(150/5000) = 0.17.
    assert!(off < 0.2 * sigma, "{off}");
}

#[test]
fn a_shell_of_200_degrees_is_unrolled() {
    let sigma = 0.004;
    let points = cloud(shell, 6000, (sigma, &mut Noise::new(12)));
    let outcome = done(&request(Points::Scattered(points)));
    assert_eq!(outcome.parametrisation, Parametrisation::Unrolled);
    assert!(
        (outcome.noise / sigma - 1.0).abs() < 0.06,
        "{}",
        outcome.noise
    );
    let off = from_truth(&outcome.surface, shell);
    assert!(off < 0.25 * sigma, "{off}");
}

#[test]
fn a_tube_closed_all_round_is_refused() {
    let tube = |u: f64, v: f64| {
        let angle = std::f64::consts::TAU * v;
        Point3::new(3.0 * u, angle.cos(), angle.sin())
    };
    let points = cloud(tube, 4000, (0.003, &mut Noise::new(13)));
    match fit(&request(Points::Scattered(points)), &Unwatched) {
        Err(FitError::Invalid(issues)) => assert_eq!(issues[0].code, "not-a-sheet"),
        other => panic!("{other:?}"),
    }
}

#[test]
fn no_scattered_point_leaves_its_tolerance() {
    for (shape, sigma, tolerance) in [
        (bowl as fn(f64, f64) -> Point3<f64>, 0.02, 0.09),
        (shell, 0.004, 0.018),
    ] {
        let points = cloud(shape, 900, (sigma, &mut Noise::new(14)));
        let outcome = done(&within(
            request(Points::Scattered(points.clone())),
            tolerance,
        ));
        assert!(outcome.within_tolerance, "{:?}", outcome.summary);
        for p in &points {
            let d = distance(&outcome.surface, p);
            assert!(d <= tolerance * (1.0 + 1e-9), "{d}");
        }
    }
}

#[test]
fn holes_show_in_the_outline() {
    let noise = &mut Noise::new(15);
    let mut points = cloud(bowl, 9000, (0.01, noise));
    points.retain(|p| (p.x - 5.0).hypot(p.y - 3.0) > 1.2);
    let outcome = done(&request(Points::Scattered(points)));
    assert_eq!(outcome.outline.holes.len(), 1);
    assert!(outcome.outline.outer.len() > 8);
    assert!(from_truth(&outcome.surface, bowl) < 0.02);
}

#[test]
fn one_free_axis_makes_it_a_field_of_that_axis() {
    let points = cloud(bowl, 2000, (0.01, &mut Noise::new(16)));
    let mut asked = request(Points::Scattered(points.clone()));
    asked.options.freedom = [false, false, true];
    let outcome = done(&asked);
    for (m, p) in outcome.moves.iter().zip(&points) {
        assert!((m.now.x - p.x).abs() < 1e-9 && (m.now.y - p.y).abs() < 1e-9);
    }
}

/// A hole in a folded sheet: the shortest way along the sheet goes round it.
#[test]
fn a_hole_does_not_bend_a_folded_sheet() {
    let sigma = 0.004;
    let noise = &mut Noise::new(21);
    let outside = |u: f64, v: f64| (u - 0.4).hypot(v - 0.55) > 0.2;
    let mut points = Vec::new();
    while points.len() < 8000 {
        let (u, v) = (noise.even(), noise.even());
        if outside(u, v) {
            points.push(shell(u, v) + sigma * noise.vector());
        }
    }
    let outcome = done(&request(Points::Scattered(points)));
    assert_eq!(outcome.outline.holes.len(), 1);
    let (mut worst, n) = (0.0_f64, 10);
    for (i, j) in (0..=n).flat_map(|i| (0..=n).map(move |j| (i, j))) {
        let [u, v] = [i, j].map(|k| f64::from(k) / f64::from(n));
        if outside(u, v) {
            worst = worst.max(distance(&outcome.surface, &shell(u, v)));
        }
    }
    assert!(worst < sigma, "{worst}");
}

/// A long sheet that is wavy across and nearly straight along: the stretch of
/// the energy is found, so that few degrees of freedom are spent along it.
#[test]
fn a_sheet_is_stiffer_along_than_across() {
    let long = |u: f64, v: f64| {
        let (x, y) = (20.0 * u, 5.0 * v);
        Point3::new(x, y, 0.4 * (2.0 * y).sin() + 0.002 * x * x)
    };
    let sigma = 0.02;
    let points = cloud(long, 6000, (sigma, &mut Noise::new(22)));
    let outcome = done(&request(Points::Scattered(points)));
    // Some 90 degrees of freedom: √(90/6000) = 0.12, and more at the border.
    let off = from_truth(&outcome.surface, long);
    assert!(off < 0.2 * sigma, "{off}");
}

fn tube(u: f64, v: f64) -> Point3<f64> {
    let angle = std::f64::consts::TAU * v;
    let radius = 1.0 + 0.05 * (2.0 * u).sin() * (2.0 * angle).cos();
    Point3::new(3.0 * u, radius * angle.cos(), radius * angle.sin())
}

#[test]
fn a_tube_is_cut_where_the_user_says() {
    let sigma = 0.004;
    let points = cloud(tube, 8000, (sigma, &mut Noise::new(23)));
    let mut asked = request(Points::Scattered(points));
    asked.options.cut = Some(Point3::new(1.5, 0.0, -1.0));
    let outcome = done(&asked);
    assert!(
        outcome.warnings.iter().any(|w| w.contains("was cut")),
        "{:?}",
        outcome.warnings
    );
    let off = from_truth(&outcome.surface, tube);
    assert!(off < 0.3 * sigma, "{off}");
    // Both borders of the cut are the same line.
    for u in [0.1, 0.5, 0.9] {
        assert!(distance(&outcome.surface, &tube(u, 0.75)) < sigma);
    }
    let area = |loop_: &[[f64; 2]]| {
        let pairs = loop_.iter().zip(loop_.iter().cycle().skip(1));
        0.5 * pairs.map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum::<f64>()
    };
    let frame = 3.0; // the longest side
    let want = 3.0 * std::f64::consts::TAU / (frame * frame);
    let have = area(&outcome.outline.outer).abs();
    assert!((have / want - 1.0).abs() < 0.05, "{have} {want}");
}

#[test]
fn points_slide_in_their_planes_where_two_axes_are_free() {
    for (shape, sigma, held) in [
        (bowl as fn(f64, f64) -> Point3<f64>, 0.02, 0),
        (shell, 0.004, 0),
        (bowl, 0.02, 1),
    ] {
        let points = cloud(shape, 3000, (sigma, &mut Noise::new(24)));
        let mut asked = request(Points::Scattered(points.clone()));
        asked.options.freedom = [0, 1, 2].map(|k| k != held);
        let outcome = done(&asked);
        for (m, p) in outcome.moves.iter().zip(&points) {
            assert!((m.now[held] - p[held]).abs() < 1e-6 * sigma, "{m:?} {p}");
            assert!((outcome.surface.point(m.at[0], m.at[1]) - m.now).norm() < 1e-6);
        }
        assert!(from_truth(&outcome.surface, shape) < 0.35 * sigma);
        let tolerance = 4.5 * sigma;
        let outcome = done(&within(asked, tolerance));
        assert!(outcome.within_tolerance, "{:?}", outcome.summary);
        for (m, p) in outcome.moves.iter().zip(&points) {
            assert!((m.now[held] - p[held]).abs() < 1e-6 * sigma);
            assert!((m.now - p).norm() <= tolerance * (1.0 + 1e-9));
        }
    }
}

#[test]
fn a_field_along_any_axis_keeps_its_tolerance() {
    let turned = |u: f64, v: f64| {
        let p = bowl(u, v);
        Point3::new(p.x, p.z, p.y)
    };
    let points = cloud(turned, 900, (0.02, &mut Noise::new(25)));
    let mut asked = within(request(Points::Scattered(points.clone())), 0.09);
    asked.options.freedom = [false, true, false];
    let outcome = done(&asked);
    assert!(outcome.within_tolerance, "{:?}", outcome.summary);
    for (m, p) in outcome.moves.iter().zip(&points) {
        assert!((m.now - p).cross(&Vector3::y()).norm() < 1e-9);
        assert!((m.now - p).norm() <= 0.09 * (1.0 + 1e-9));
    }
}

#[test]
fn a_dozen_points_are_enough() {
    let points = cloud(bowl, 12, (0.0, &mut Noise::new(17)));
    let asked = request(Points::Scattered(points));
    assert!(validate(&asked).is_empty());
    assert!(done(&asked).move_max.is_finite());
}

#[test]
fn threads_do_not_matter() {
    for shape in [bowl as fn(f64, f64) -> Point3<f64>, shell] {
        let points = cloud(shape, 3000, (0.004, &mut Noise::new(18)));
        let asked = request(Points::Scattered(points));
        let run = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            pool.expect("threads").install(|| done(&asked))
        };
        assert_eq!(run(1), run(3));
    }
}
