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
