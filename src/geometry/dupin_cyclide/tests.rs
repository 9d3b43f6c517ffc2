//! Patches of surfaces known in closed form, and of their Möbius images.

use super::{CyclideCorner, CyclideError, CyclidePatch};
use crate::geometry::Axis;
use nalgebra::{Point3, Vector3};

/// A surface of revolution between meridians and parallels, moved by an
/// inversion: corners and any point of the patch.
struct Principal {
    /// Point and unit tangents at shares (u, v).
    at: Box<dyn Fn(f64, f64) -> CyclideCorner>,
    /// Zero on the surface.
    implicit: Box<dyn Fn(Point3<f64>) -> f64>,
}

fn torus(radius: f64, tube: f64, [u0, u1]: [f64; 2], [v0, v1]: [f64; 2]) -> Principal {
    Principal {
        at: Box::new(move |u, v| {
            let (u, v) = (u0 + u * (u1 - u0), v0 + v * (v1 - v0));
            let (su, cu) = u.sin_cos();
            let (sv, cv) = v.sin_cos();
            let out = radius + tube * cv;
            CyclideCorner {
                point: Point3::new(out * cu, out * su, tube * sv),
                tangents: [
                    Vector3::new(-su, cu, 0.0),
                    Vector3::new(-sv * cu, -sv * su, cv),
                ],
            }
        }),
        implicit: Box::new(move |p| (p.x.hypot(p.y) - radius).hypot(p.z) - tube),
    }
}

/// A cone, a cylinder (`slope` 0) or a plane (`slope` infinite).
fn cone(slope: f64) -> Principal {
    let (along, out) = if slope.is_infinite() {
        (0.0, 1.0)
    } else {
        let length = slope.hypot(1.0);
        (1.0 / length, slope / length)
    };
    Principal {
        at: Box::new(move |u, v| {
            let (s, c) = (0.2 + 1.1 * u).sin_cos();
            let radius = 1.0 + 0.7 * v * out;
            CyclideCorner {
                point: Point3::new(radius * c, radius * s, 0.7 * v * along),
                tangents: [
                    Vector3::new(-s, c, 0.0),
                    Vector3::new(out * c, out * s, along),
                ],
            }
        }),
        implicit: Box::new(move |p| (p.x.hypot(p.y) - 1.0) * along - p.z * out),
    }
}

const CENTRE: Point3<f64> = Point3::new(0.9, -0.6, 2.0);

fn invert(p: Point3<f64>) -> Point3<f64> {
    let d = p - CENTRE;
    CENTRE + d / d.norm_squared()
}

/// The image under the inversion about [`CENTRE`].
fn inverted(surface: Principal) -> Principal {
    let Principal { at, implicit } = surface;
    Principal {
        at: Box::new(move |u, v| {
            let corner = at(u, v);
            let d = (corner.point - CENTRE).normalize();
            CyclideCorner {
                point: invert(corner.point),
                tangents: corner.tangents.map(|t| t - d * (2.0 * d.dot(&t))),
            }
        }),
        implicit: Box::new(move |p| implicit(invert(p))),
    }
}

fn surfaces() -> Vec<Principal> {
    let plain = || {
        vec![
            torus(3.0, 1.0, [0.1, 0.9], [-0.3, 0.8]),
            torus(3.0, 1.0, [0.0, 1.5], [2.0, 3.9]),
            // A sphere, and a spindle's inner sheet.
            torus(0.0, 1.0, [0.4, 1.1], [0.1, 0.9]),
            torus(0.5, 1.0, [0.4, 1.1], [0.1, 0.9]),
            cone(0.6),
            cone(0.0),
            cone(f64::INFINITY),
        ]
    };
    plain()
        .into_iter()
        .chain(plain().into_iter().map(inverted))
        .collect()
}

fn patch_of(surface: &Principal) -> CyclidePatch {
    let at = &surface.at;
    CyclidePatch::new([at(0.0, 0.0), at(1.0, 0.0), at(0.0, 1.0), at(1.0, 1.0)])
        .expect("a usable patch")
}

#[test]
fn the_patch_lies_on_the_surface_that_its_corners_came_from() {
    for (index, surface) in surfaces().iter().enumerate() {
        let patch = patch_of(surface);
        assert!(patch.defect() < 1e-14, "{index}: {}", patch.defect());
        let spline = patch.surface().expect("positive weights");
        for (u, v) in [(0.0, 0.5), (0.3, 0.0), (0.5, 0.5), (0.8, 0.35), (1.0, 0.7)] {
            let point = patch.point(u, v);
            let off = (surface.implicit)(point).abs();
            assert!(off < 1e-12, "{index} at ({u}, {v}): {off}");
            let apart = (spline.point(u, v) - point).norm();
            assert!(apart < 1e-13, "{index} at ({u}, {v}): {apart}");
        }
    }
}

#[test]
fn the_corners_have_the_given_tangents() {
    for surface in &surfaces() {
        let patch = patch_of(surface);
        let spline = patch.surface().expect("positive weights");
        let places = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)];
        for ((u, v), corner) in places.into_iter().zip(patch.corners()) {
            let jet = spline.derivatives_left(u, v);
            assert!((jet.du.normalize() - corner.tangents[0]).norm() < 1e-12);
            assert!((jet.dv.normalize() - corner.tangents[1]).norm() < 1e-12);
            assert_eq!(jet.point, corner.point);
        }
    }
}

#[test]
fn parameter_lines_are_lines_of_curvature() {
    for (index, surface) in surfaces().iter().enumerate() {
        let spline = patch_of(surface).surface().expect("positive weights");
        for (u, v) in [(0.2, 0.3), (0.5, 0.5), (0.9, 0.6)] {
            let jet = spline.derivatives(u, v);
            let normal = jet.normal().expect("regular");
            let lengths = jet.du.norm() * jet.dv.norm();
            assert!(jet.du.dot(&jet.dv).abs() < 1e-12 * lengths, "{index}");
            assert!(jet.duv.dot(&normal).abs() < 1e-12 * lengths, "{index}");
        }
    }
}

#[test]
fn the_sides_are_the_arcs_of_the_corners() {
    for surface in &surfaces() {
        let patch = patch_of(surface);
        let spline = patch.surface().expect("positive weights");
        let [low, high, left, right] = patch.sides().map(|arc| arc.expect("a side"));
        for (arc, along, at) in [
            (low, Axis::U, 0.0),
            (high, Axis::U, 1.0),
            (left, Axis::V, 0.0),
            (right, Axis::V, 1.0),
        ] {
            let side = spline.iso_curve(along, at).expect("a side");
            let middle = side.point(0.5);
            let expected = arc.control_point().expect("less than half a turn");
            assert!((side.control_points()[1] - expected).norm() < 1e-12);
            match (arc.centre(), arc.radius()) {
                (Some(centre), radius) if radius < 1e6 => {
                    assert!(((middle - centre).norm() - radius).abs() < 1e-12 * radius);
                }
                _ => assert!((middle - arc.start()).cross(&arc.tangent()).norm() < 1e-12),
            }
        }
    }
}

#[test]
fn the_cones_along_opposite_sides_meet_in_the_conic_of_the_tangents() {
    for (index, surface) in surfaces().iter().enumerate() {
        let patch = patch_of(surface);
        let spline = patch.surface().expect("positive weights");
        for along in [Axis::U, Axis::V] {
            for parameter in [0.0, 0.3, 0.75] {
                let (low, high) = match along {
                    Axis::U => ([parameter, 0.0], [parameter, 1.0]),
                    Axis::V => ([0.0, parameter], [1.0, parameter]),
                };
                let meet = patch.tangents_meet(along, parameter);
                for [u, v] in [low, high] {
                    let jet = spline.derivatives_left(u, v);
                    let across = if along == Axis::U { jet.dv } else { jet.du };
                    let off = (meet - jet.point).cross(&across.normalize()).norm();
                    assert!(off < 1e-12, "{index}: {off}");
                }
            }
        }
    }
}

#[test]
fn neighbours_agree_about_the_places_on_a_side() {
    let surface = torus(3.0, 1.0, [0.1, 0.9], [-0.3, 0.8]);
    let beside = torus(3.0, 1.0, [0.1, 0.9], [0.8, 1.4]);
    for (surface, beside) in [
        (patch_of(&surface), patch_of(&beside)),
        (patch_of(&inverted(surface)), patch_of(&inverted(beside))),
    ] {
        for parameter in [0.1, 0.5, 0.8] {
            let [[u, v], [s, t]] = [surface.on_side(1, parameter), beside.on_side(0, parameter)];
            assert!((surface.point(u, v) - beside.point(s, t)).norm() < 1e-13);
        }
    }
}

#[test]
fn unusable_corners_are_refused() {
    let surface = torus(3.0, 1.0, [0.0, 3.2], [0.0, 0.5]);
    let wide = patch_of(&surface);
    assert_eq!(wide.surface(), Err(CyclideError::HalfTurn));
    let corner = (surface.at)(0.0, 0.0);
    assert_eq!(
        CyclidePatch::new([corner; 4]),
        Err(CyclideError::Degenerate)
    );
}
