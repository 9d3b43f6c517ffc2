//! Derivatives, and nets that become exact.

use super::problem::{MirroredFrames, Soft, UNKNOWNS};
use super::samples::{ellipsoid, enneper, net_of, torus, vase};
use super::{certificates, closure, offset, solve};
use crate::solver::Unwatched;
use crate::solver::derivative_check::worst_disagreement;
use nalgebra::{Point3, Vector3};

#[test]
fn derivatives_agree_with_differences() {
    let net = net_of([3, 3], [false, true], |u, v| vase(v, u));
    let soft = Soft {
        closeness: 0.3,
        fairness: 0.2,
    };
    let problem = MirroredFrames::new(&net, soft);
    let x: Vec<f64> = (0..UNKNOWNS * 9).map(|i| 0.2 * (i as f64).sin()).collect();
    let worst = worst_disagreement(&problem, &x, 1e-6);
    assert!(worst.relative < 1e-8, "{worst:?}");
}

#[test]
fn discs_annuli_and_tori_become_exact() {
    let nets = [
        ("ellipsoid", net_of([7, 9], [false; 2], ellipsoid)),
        ("enneper", net_of([8, 6], [false; 2], enneper)),
        ("vase", net_of([12, 7], [true, false], vase)),
        ("torus", net_of([12, 8], [true, true], torus)),
        (
            "plane",
            net_of([4, 5], [false; 2], |u, v| Point3::new(u, 2.0 * v, 0.0)),
        ),
    ];
    for (name, net) in nets {
        let spline = solve(&net, &Unwatched).expect("nobody stops it");
        assert!(spline.is_exact(), "{name}: {spline:?}");
        let edge = net.mean_edge();
        let moves: f64 = spline
            .net
            .points
            .iter()
            .zip(&net.points)
            .map(|(a, b)| (a - b).norm())
            .sum();
        let mean = moves / edge / net.points.len() as f64;
        assert!(mean < 0.1, "{name}: moved {mean} edges");
        assert!(closure(&spline.net) < 1e-11, "{name}");
        for distance in [0.0, 0.05] {
            let net = offset(&spline.net, distance);
            for certificate in certificates(&net) {
                let certificate = certificate.expect("a patch");
                assert!(certificate.worst() < 1e-10, "{name}: {certificate:?}");
            }
        }
    }
}

#[test]
fn a_rough_net_becomes_exact() {
    let mut net = net_of([9, 9], [false; 2], ellipsoid);
    let edge = net.mean_edge();
    for (i, p) in net.points.iter_mut().enumerate() {
        let i = i as f64;
        *p += Vector3::new((3.0 * i).sin(), (5.0 * i).cos(), (7.0 * i).sin()) * 0.1 * edge;
    }
    let spline = solve(&net, &Unwatched).expect("nobody stops it");
    assert!(spline.is_exact(), "{}", spline.mirror);
}
