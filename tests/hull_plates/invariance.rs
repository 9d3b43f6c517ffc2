//! The answer does not depend on units, place, handedness, the order of the
//! profiles, or the number of threads.

use crate::support::*;
use mouldloft::methods::hull_plates::outcome::Outcome;
use mouldloft::methods::hull_plates::request::{Boundary, Options};
use nalgebra::Point3;

/// Twists of all plates, degrees, by the checker.
fn twists(outcome: &Outcome) -> Vec<[f64; 2]> {
    measured(outcome)
        .iter()
        .map(|f| [f.twist_max, f.twist_mean])
        .collect()
}

fn mapped(map: impl Fn(&Point3<f64>) -> Point3<f64>) -> Vec<Points> {
    trawler()
        .iter()
        .map(|c| c.iter().map(&map).collect())
        .collect()
}

/// The same twists to `most` degrees. Mean twists to a hundred times that:
/// where the greatest twist is held, the mean lies in a flat valley.
fn same(a: &[[f64; 2]], b: &[[f64; 2]], most: f64) {
    for (a, b) in a.iter().zip(b) {
        let off = [(a[0] - b[0]).abs(), (a[1] - b[1]).abs()];
        assert!(off[0] <= most && off[1] <= 100.0 * most, "{a:?} {b:?}");
    }
}

fn here() -> Vec<[f64; 2]> {
    twists(&fitted(&request(&trawler(), exact())))
}

#[test]
fn units_do_not_matter() {
    let before = here();
    for scale in [0.3048, 304.8, 1e-6] {
        let outcome = fitted(&request(&mapped(|p| p * scale), exact()));
        same(&twists(&outcome), &before, 1e-6);
        assert!((outcome.model_size - 70.0 * scale).abs() < 1e-9 * scale * 70.0);
    }
}

#[test]
fn units_do_not_matter_to_a_tolerance() {
    let pair = |scale: f64| -> Vec<Points> { mapped(|p| p * scale)[2..].to_vec() };
    let fit = |scale: f64| {
        let boundary = Boundary::Tolerance(0.0455 * scale);
        let curves = pair(scale);
        let outcome = fitted(&request(
            &curves,
            Options {
                boundary,
                ..Options::default()
            },
        ));
        let moves = outcome
            .profiles
            .iter()
            .map(|p| p.deviation.curve_max / scale)
            .fold(0.0, f64::max);
        (twists(&outcome), moves)
    };
    let (feet, metres) = (fit(1.0), fit(0.3048));
    same(&feet.0, &metres.0, 1e-3);
    assert!(
        (feet.1 - metres.1).abs() < 1e-4 && feet.1 <= 0.0455,
        "{} {}",
        feet.1,
        metres.1
    );
}

#[test]
fn the_place_does_not_matter() {
    let offset = nalgebra::Vector3::new(512.0, 64.0, -256.0);
    same(
        &twists(&fitted(&request(&mapped(|p| p + offset), exact()))),
        &here(),
        1e-6,
    );
}

#[test]
fn port_and_starboard_are_the_same() {
    let port = mapped(|p| Point3::new(p.x, -p.y, p.z));
    same(&twists(&fitted(&request(&port, exact()))), &here(), 1e-6);
}

#[test]
fn the_order_of_the_profiles_does_not_matter() {
    let mut hull = trawler();
    hull.reverse();
    let mut found = twists(&fitted(&request(&hull, exact())));
    found.reverse();
    same(&found, &here(), 1e-3);
}

#[test]
fn bow_first_is_as_good_as_stern_first() {
    let bow_first: Vec<Points> = trawler()
        .iter()
        .map(|c| c.iter().rev().copied().collect())
        .collect();
    let found = twists(&fitted(&request(&bow_first, exact())));
    // Another start, another local answer: as good, not the same to the last digit.
    same(&found, &here(), 0.05);
}

#[test]
fn one_thread_and_four_give_the_same_bits() {
    let boundary = Boundary::Tolerance(0.0455);
    for options in [
        exact(),
        Options {
            boundary,
            ..Options::default()
        },
    ] {
        let request = request(&trawler()[1..], options);
        let [one, four] = [1, 4].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            // Debug prints every bit of a float that counts, and the sign of zero.
            pool.install(|| format!("{:?}", fitted(&request)))
        });
        assert!(one == four, "the outcome depends on the thread count");
    }
}
