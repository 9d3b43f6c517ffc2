//! Random smooth pairs of curves: never a panic, always a finite, sound answer.
//! Few cases, and no shrinking, so that the time is bounded; the seed is
//! fixed, so that every run draws the same cases.

use crate::support::*;
use mouldloft::methods::FitError;
use mouldloft::methods::hull_plates::fit;
use mouldloft::methods::hull_plates::request::{Boundary, Ends, Options};
use mouldloft::solver::Unwatched;
use proptest::prelude::*;

/// A curve along x with gentle waves in y and z, a few ruling lengths long.
fn curve(y: f64) -> impl Strategy<Value = Points> {
    let wave = || (-0.6..0.6_f64, -0.4..0.4_f64, -0.2..0.2_f64);
    (3..20_usize, wave(), wave(), -0.5..0.5_f64, 5.0..9.0_f64).prop_map(
        move |(n, a, b, x0, length)| {
            let sum = |w: (f64, f64, f64), t: f64| {
                w.0 * (3.1 * t).sin() + w.1 * (3.1 * t).cos() + w.2 * (6.2 * t).sin()
            };
            along(n, |t| [x0 + length * t, y + sum(a, t), sum(b, t)])
        },
    )
}

fn options() -> impl Strategy<Value = Options> {
    let boundary = prop_oneof![
        Just(Boundary::Exact),
        (1e-4..0.1_f64).prop_map(Boundary::Tolerance)
    ];
    (boundary, any::<bool>()).prop_map(|(boundary, fans)| Options {
        boundary,
        ends: if fans { Ends::Fan } else { Ends::Extend },
        ..Options::default()
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 8, max_shrink_iters: 0, rng_seed: proptest::test_runner::RngSeed::Fixed(1887), failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn smooth_pairs_have_a_finite_answer(a in curve(0.0), b in curve(2.0), options in options()) {
        let tolerance = options.boundary;
        let asked = request(&[a.clone(), b.clone()], options);
        match fit(&asked, &Unwatched) {
            Err(FitError::Invalid(issues)) => prop_assert!(!issues.is_empty()),
            Err(other) => prop_assert!(false, "{other:?}"),
            Ok(outcome) => {
                let found = sound(&asked, &outcome);
                prop_assert!(found[0].twist_max.is_finite() && found[0].twist_mean.is_finite());
                let most = match tolerance {
                    Boundary::Tolerance(value) => value,
                    Boundary::Exact => MET * outcome.model_size,
                    Boundary::Auto => unreachable!("not drawn: many fits"),
                };
                for (k, given) in [a, b].iter().enumerate() {
                    let [points, along, _] = moved(&outcome, k, given);
                    prop_assert!(points.max(along) <= most, "{} {} > {}", points, along, most);
                }
            }
        }
    }
}
