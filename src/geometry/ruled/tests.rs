use super::*;
use crate::geometry::conformance::{samples, surface_laws};
use nalgebra::point;

fn ruled(a: BSplineCurve, b: BSplineCurve) -> RuledSurface {
    RuledSurface::new(a, b).expect("one domain")
}

fn line(a: Point3<f64>, b: Point3<f64>) -> BSplineCurve {
    BSplineCurve::line(a, b, 3).expect("valid")
}

/// z = xy over the unit square.
fn hypar() -> RuledSurface {
    ruled(
        line(point![0., 0., 0.], point![1., 0., 0.]),
        line(point![0., 1., 0.], point![1., 1., 1.]),
    )
}

/// Frustum of a cone: radius 1 at z = 0, 2 at z = 1; apex at z = −1.
fn cone() -> RuledSurface {
    let arc = samples::quarter_circle(1.0).translated(&Vector3::new(0., 0., -1.0));
    let wide = samples::quarter_circle(2.0);
    ruled(arc, wide)
}

#[test]
fn the_hypar_has_its_textbook_curvatures() {
    let s = hypar();
    for (u, v) in [(0.0, 0.0), (0.3, 0.8), (1.0, 1.0)] {
        let w = 1.0 + u * u + v * v;
        let k = s.gaussian_curvature(u, v).expect("regular");
        assert!((k + 1.0 / (w * w)).abs() < 1e-14);
        let forms = s.fundamental_forms(u, v).expect("regular");
        assert!((forms.mean_curvature() + u * v / w.powf(1.5)).abs() < 1e-14);
        // Normals (−y, −x, 1) at y = 0 and 1.
        let cos = (1.0 + u * u) / ((1.0 + u * u) * (2.0 + u * u)).sqrt();
        assert!((s.twist(u).abs() - cos.acos()).abs() < 1e-14);
    }
}

#[test]
fn a_cone_bends_as_its_distance_from_the_apex() {
    let s = cone();
    for (u, v) in [(0.0, 0.0), (0.4, 0.5), (1.0, 1.0)] {
        let ruling = s.ruling(u);
        assert!(ruling.twist().abs() < 1e-15);
        assert!(s.gaussian_curvature(u, v).expect("regular").abs() < 1e-15);
        // 1/(r √2) on a cone of half angle 45°.
        let radius = (1.0 + v) * 2f64.sqrt();
        let bend = s.bend_curvature(u, v).expect("regular");
        assert!((bend.abs() * radius - 1.0).abs() < 1e-13, "{bend}");
        assert!((ruling.regression() + 1.0).abs() < 1e-13);
        assert!((ruling.clearance() - 1.0).abs() < 1e-13);
    }
}

/// A cylinder cut askew: the rulings are not perpendicular to the curves.
#[test]
fn a_sheared_cylinder_keeps_its_radius() {
    let arc = samples::quarter_circle(2.0);
    let s = ruled(arc.clone(), arc.translated(&Vector3::new(0., 0., 3.0)));
    let sheared = {
        let tilted = arc.control_points().iter();
        let tilted = tilted
            .map(|p| point![p.x, p.y, p.z + 0.8 * p.x + 3.0])
            .collect();
        let weights = arc.weights().map(<[f64]>::to_vec);
        let top = BSplineCurve::from_knots(arc.knot_vector().clone(), tilted, weights);
        ruled(arc, top.expect("valid"))
    };
    for s in [s, sheared] {
        for u in [0.0, 0.3, 1.0] {
            let bend = s.bend_curvature(u, 0.4).expect("regular").abs();
            assert!((bend - 0.5).abs() < 1e-14, "{bend}");
            assert!(s.twist(u).abs() < 1e-15);
        }
    }
    let straight = ruled(samples::line(), samples::line().translated(&Vector3::z()));
    assert_eq!(straight.ruling(0.5).clearance(), f64::INFINITY);
    assert_eq!(straight.bend_curvature(0.5, 0.5), Some(0.0));
}

#[test]
fn crossing_rulings_have_no_clearance_and_a_fan_touches_its_apex() {
    let a = line(point![0., 0., 0.], point![1., 0., 0.]);
    let turned = ruled(a.clone(), line(point![1., 1., 0.], point![0., 1., 0.]));
    assert_eq!(turned.ruling(0.5).clearance(), 0.0);
    let apex = line(point![0., 1., 0.], point![0., 1., 0.]);
    let fan = ruled(a, apex);
    assert_eq!(fan.twist(0.7), 0.0);
    assert_eq!(fan.ruling(0.7).regression(), 1.0);
    assert_eq!(fan.bend_curvature(0.7, 1.0), None);
}

#[test]
fn the_tensor_surface_is_the_same_surface() {
    let (a, b) = (
        samples::wild(3),
        samples::wild(2).translated(&Vector3::new(0., 5., 1.)),
    );
    for s in [
        ruled(a, b),
        ruled(samples::standing(), samples::wild(5)),
        hypar(),
        cone(),
    ] {
        let t = s.to_bspline().expect("valid");
        assert_eq!(t.degrees()[1], 1);
        for i in 0..=40 {
            let (u, v) = (i as f64 / 40.0, (i * 7 % 11) as f64 / 10.0);
            assert!((t.point(u, v) - s.point(u, v)).norm() < 1e-13);
            let (x, y) = (t.derivatives(u, v), s.derivatives(u, v));
            let error = (x.du - y.du).norm() + (x.dv - y.dv).norm() + (x.duv - y.duv).norm();
            assert!(error < 1e-11 * (1.0 + y.duu.norm()), "{error}");
        }
        surface_laws::check("ruled", &t);
    }
    // Rational against polynomial: the rulings are the same lines.
    let mixed = ruled(samples::quarter_circle(1.0), samples::wild(3));
    let t = mixed.to_bspline().expect("valid");
    for u in [0.1, 0.5, 0.9] {
        assert!((t.point(u, 0.0) - mixed.point(u, 0.0)).norm() < 1e-14);
        assert!((t.point(u, 1.0) - mixed.point(u, 1.0)).norm() < 1e-13);
        let off = (t.point(u, 0.5) - mixed.point(u, 0.0)).cross(&mixed.ruling(u).direction());
        assert!(off.norm() < 1e-13);
    }
    let other = samples::line().on_domain([0.0, 2.0]).expect("valid");
    assert!(RuledSurface::new(samples::line(), other).is_err());
}

#[test]
fn standing_control_points_stay_equal_on_the_surface() {
    let s = ruled(samples::standing(), samples::wild(3));
    let t = s.to_bspline().expect("valid");
    let jet = t.derivatives(0.41, 0.0);
    assert_eq!((jet.du, jet.duu), (Vector3::zeros(), Vector3::zeros()));
}
