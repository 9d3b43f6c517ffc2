use super::*;

fn cubic() -> Knots {
    Knots::new(3, vec![0., 0., 0., 0., 1., 2., 2., 2., 4., 5., 5., 5., 5.]).expect("valid")
}

#[test]
fn every_broken_rule_is_named_with_its_numbers() {
    let e = |degree, values: &[f64]| Knots::new(degree, values.to_vec()).unwrap_err();
    assert_eq!(e(0, &[0., 1.]), SplineError::Degree { degree: 0 });
    assert_eq!(e(10, &[0.; 22]), SplineError::Degree { degree: 10 });
    assert_eq!(
        e(2, &[0., 0., 1., 1.]),
        SplineError::TooFewKnots {
            knots: 4,
            degree: 2
        }
    );
    assert!(matches!(
        e(1, &[0., 0., f64::NAN, 1., 1.]),
        SplineError::KnotNotFinite { index: 2, .. }
    ));
    assert_eq!(
        e(1, &[0., 0., 0.7, 0.5, 1., 1.]),
        SplineError::KnotsDecrease {
            index: 3,
            value: 0.5,
            before: 0.7
        }
    );
    assert_eq!(
        e(1, &[0., 0.1, 0.2, 1., 1.]),
        SplineError::NotClamped {
            start: true,
            value: 0.0,
            multiplicity: 1,
            degree: 1
        }
    );
    assert_eq!(
        e(1, &[0., 0., 1., 1., 1.]),
        SplineError::NotClamped {
            start: false,
            value: 1.0,
            multiplicity: 3,
            degree: 1
        }
    );
    assert!(matches!(
        e(1, &[2.; 4]),
        SplineError::NotClamped {
            multiplicity: 4,
            ..
        }
    ));
    assert_eq!(
        e(1, &[0., 0., 1., 1., 2., 2.]),
        SplineError::Multiplicity {
            value: 1.0,
            multiplicity: 2,
            degree: 1
        }
    );
}

#[test]
fn spans_at_knots_between_and_outside() {
    let k = cubic();
    let right: Vec<usize> = [-1., 0., 0.5, 1., 2., 3., 4., 4.5, 5., 9.]
        .iter()
        .map(|u| k.span(*u))
        .collect();
    assert_eq!(right, [3, 3, 3, 4, 7, 7, 8, 8, 8, 8]);
    let left: Vec<usize> = [0., 1., 1.5, 2., 4., 5.]
        .iter()
        .map(|u| k.span_left(*u))
        .collect();
    assert_eq!(left, [3, 3, 4, 4, 7, 8]);
    assert_eq!(k.multiplicity(2.0), 3);
    assert_eq!(k.multiplicity(2.5), 0);
    assert_eq!(k.breakpoints(), [0., 1., 2., 4., 5.]);
}

#[test]
fn greville_abscissae_begin_and_end_with_the_domain() {
    let g = cubic().greville_abscissae();
    assert_eq!(g.len(), 9);
    assert_eq!((g[0], g[8]), (0.0, 5.0));
    assert!(g.is_sorted());
    assert_eq!(g[4], 2.0);
}

/// Piegl & Tiller, example 9.1: parameters 0, 5/17, 9/17, 14/17, 1 give
/// the inner knot 28/51 for a cubic.
#[test]
fn averaging_as_in_the_nurbs_book() {
    let p = [0.0, 5.0 / 17.0, 9.0 / 17.0, 14.0 / 17.0, 1.0];
    let k = Knots::averaged(3, &p).expect("increasing");
    assert_eq!(k.len(), 9);
    assert!((k[4] - 28.0 / 51.0).abs() < 1e-15);
    assert!(Knots::averaged(3, &[0.0, 1.0, 1.0, 2.0]).is_err());
    assert!(Knots::averaged(3, &[0.0, 1.0]).is_err());
}

#[test]
fn union_takes_the_larger_multiplicity() {
    let a = Knots::clamped(2, [0., 1.], &[0.3, 0.5, 0.5]).expect("valid");
    let b = Knots::clamped(2, [0., 1.], &[0.3, 0.3, 0.7]).expect("valid");
    let u = a.union(&b).expect("compatible");
    assert_eq!(u.values()[3..8], [0.3, 0.3, 0.5, 0.5, 0.7]);
    assert_eq!(a.missing_from(&b), [0.3, 0.7]);
    assert!(a.union(&cubic()).is_err());
}

#[test]
fn reversal_mirrors_the_domain_exactly() {
    let r = cubic().reversed();
    assert_eq!(
        r.values(),
        [0., 0., 0., 0., 1., 3., 3., 3., 4., 5., 5., 5., 5.]
    );
}

/// 1 − 1e-20 is 1: mirrored knots must not pile up on the end.
#[test]
fn reversal_keeps_knots_apart_that_rounding_would_merge() {
    let k = Knots::clamped(2, [0., 1.], &[1e-20, 1e-20, 2e-20, 0.5]).expect("sorted");
    let r = k.reversed();
    assert_eq!(Knots::new(2, r.values().to_vec()), Ok(r.clone()));
    assert_eq!(r.distinct().len(), k.distinct().len());
    assert_eq!(r.multiplicity(1f64.next_down()), 2);
}
