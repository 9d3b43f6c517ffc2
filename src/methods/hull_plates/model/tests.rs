//! The model's Jacobian against differences.

use super::*;
use crate::geometry::{Parametrization, interpolate};
use crate::solver::derivative_check::worst_disagreement;
use nalgebra::Point3;

fn wave(height: f64, phase: f64) -> Profile {
    let points: Vec<Point3<f64>> = (0..9)
        .map(|i| {
            let x = f64::from(i) / 8.0;
            Point3::new(
                x,
                0.2 * height + 0.1 * (2.0 * x + phase).sin(),
                height + 0.05 * x * x,
            )
        })
        .collect();
    Profile::new(interpolate(&points, 3, Parametrization::ChordLength).expect("a curve"))
}

/// Unknowns off every symmetric place, the ends clear of zero.
fn scattered(count: usize) -> Vec<f64> {
    (0..count)
        .map(|i| 0.3 * ((i * i + 3 * i + 1) as f64).sin())
        .collect()
}

fn check(free: bool) {
    let profiles = [wave(0.0, 0.0), wave(0.3, 0.7), wave(0.5, 1.1)];
    let shape = PathShape::new(&[0.0, 0.1, 0.3, 0.5, 0.6, 0.8, 1.0], 3).expect("a shape");
    let paths: Vec<Vec<f64>> = (0..2)
        .map(|p| shape.unknowns_from(|w| 0.05 * (3.0 * w + f64::from(p)).cos()))
        .collect();
    let movables: Vec<Movable> = if free {
        profiles
            .iter()
            .map(|p| Movable::new(p, 4, 0.01, (7.0, [false; 2])).expect("movable"))
            .collect()
    } else {
        Vec::new()
    };
    let moves: Vec<Vec<f64>> = movables.iter().map(|m| scattered(m.unknowns())).collect();
    let weights = Weights {
        ceiling: 0.02,
        ceiling_weight: 3.0,
        twist: 0.7,
        share: 0.01,
        clearance: 2.0,
        spacing: 0.01,
        end_limit: 0.06,
        move_fairness: 0.8,
    };
    let plates = [EndSpeeds::AcrossTheRuling, EndSpeeds::AlongTheCurves]
        .into_iter()
        .enumerate()
        .map(|(p, speeds)| PlateSpec {
            profiles: [p, p + 1],
            shape: shape.clone(),
            pins: vec![(0.4, 0.42)],
            speeds,
            tips: [false, p == 1],
        })
        .collect();
    let mut model = Model::new(&profiles, plates, movables, &|_, s| s, weights);
    model
        .move_weights
        .iter_mut()
        .flatten()
        .for_each(|w| *w = 1.3);
    let x = model.gather(&paths, &moves);
    let worst = worst_disagreement(&model, &x, 1e-6);
    assert!(worst.relative < 2e-6, "free {free}: {worst:?}");
}

#[test]
fn jacobian_agrees_with_differences_for_exact_boundaries() {
    check(false);
}

#[test]
fn jacobian_agrees_with_differences_for_free_boundaries() {
    check(true);
}
