//! Analytic derivatives against differences.

use super::super::energy::{Energy, Model, unevenness, variation, variation_value};
use super::super::holds::{Condition, Holds};
use super::super::space::{Space, Vector};
use super::Noise;

const STEP: f64 = 1e-6;

fn random<const D: usize>(noise: &mut Noise) -> Vector<D> {
    Vector::from_fn(|_, _| noise.normal())
}

fn check_variation<const D: usize>() {
    let mut noise = Noise(5);
    for _ in 0..20 {
        let d = [
            random::<D>(&mut noise),
            random(&mut noise),
            random(&mut noise),
        ];
        if d[0].norm() < 0.3 {
            continue;
        }
        let v = variation(&d);
        let (_, by_uneven) = unevenness(&d);
        assert!((v.value - variation_value(&d)).norm() < 1e-12 * v.value.norm().max(1.0));
        for order in 0..3 {
            for c in 0..D {
                let (mut low, mut high) = (d, d);
                low[order][c] -= STEP;
                high[order][c] += STEP;
                let want = (variation_value(&high) - variation_value(&low)) / (2.0 * STEP);
                let got = v.by[order].column(c);
                assert!(
                    (got - want).norm() < 1e-5 * want.norm().max(1.0),
                    "order {order}"
                );
                if order < 2 {
                    let want = (unevenness(&high).0 - unevenness(&low).0) / (2.0 * STEP);
                    assert!((by_uneven[order][c] - want).abs() < 1e-5 * want.abs().max(1.0));
                }
            }
        }
    }
}

#[test]
fn the_change_of_curvature_in_the_plane_and_in_space() {
    check_variation::<2>();
    check_variation::<3>();
}

/// Gradients of whole costs, which pass through scatter and numbering.
fn check_gradient<const D: usize>(
    space: &Space,
    cost: impl Fn(&[Vector<D>]) -> f64,
    add: impl Fn(&[Vector<D>], &mut Model),
) {
    let mut noise = Noise(9);
    let n = space.unknowns();
    let x: Vec<Vector<D>> = (0..n)
        .map(|k| {
            let t = k as f64 / n as f64;
            let mut v = random::<D>(&mut noise) * 0.02;
            v[0] += (6.0 * t).cos();
            v[1] += (6.0 * t).sin();
            v
        })
        .collect();
    let mut model = Model {
        matrix: space.matrix(D),
        gradient: vec![0.0; n * D],
    };
    add(&x, &mut model);
    let size = model.gradient.iter().fold(0.0_f64, |m, g| m.max(g.abs()));
    for k in 0..n {
        for c in 0..D {
            let (mut low, mut high) = (x.clone(), x.clone());
            low[k][c] -= STEP;
            high[k][c] += STEP;
            let want = (cost(&high) - cost(&low)) / (4.0 * STEP);
            let got = model.gradient[k * D + c];
            assert!(
                (got - want).abs() < 1e-5 * size,
                "unknown {k}: {got} for {want}"
            );
        }
    }
}

fn spaces() -> [Space; 2] {
    let inner: Vec<f64> = (1..14).map(|k| f64::from(k) / 14.0 * 6.0).collect();
    [
        Space::open(5, [0.0, 6.0], &inner).expect("valid"),
        Space::closed(5, [0.0, 6.0], &inner).expect("valid"),
    ]
}

#[test]
fn energies_of_open_and_closed_splines() {
    for space in spaces() {
        let energy = Energy::new(&space, None);
        check_gradient::<3>(
            &space,
            |x| energy.cost(&space, x).iter().sum(),
            |x, model| energy.add(&space, x, [1.0; 2], model),
        );
        let energy = Energy::new(&space, Some([0.3, 0.2, 1.0]));
        check_gradient::<2>(
            &space,
            |x| energy.cost(&space, x).iter().sum(),
            |x, model| energy.add(&space, x, [1.0; 2], model),
        );
    }
}

#[test]
fn holds() {
    let [space, _] = spaces();
    let mut holds = Holds::<2>::none();
    holds.push(0.0, Condition::Direction(Vector::<2>::new(0.6, 0.8)), false);
    holds.push(6.0, Condition::Curvature(0.7), false);
    holds.push(0.0, Condition::Curvature(0.0), false);
    holds.push(
        2.5,
        Condition::Place(Vector::<2>::new(0.1, 0.2), Vector::<2>::new(1.0, 0.0)),
        true,
    );
    check_gradient::<2>(
        &space,
        |x| holds.cost(&space, x),
        |x, model| holds.add(&space, x, model),
    );
    let mut holds = Holds::<3>::none();
    holds.push(6.0, Condition::Curvature(0.7), false);
    holds.push(
        3.0,
        Condition::Direction(Vector::<3>::new(0.0, 0.6, 0.8)),
        false,
    );
    check_gradient::<3>(
        &space,
        |x| holds.cost(&space, x),
        |x, model| holds.add(&space, x, model),
    );
}
