use super::models::{grid, request};
use crate::geometry::BSplineSurface;
use crate::methods::FitError;
use crate::methods::curvature_net::lines::REACHED;
use crate::methods::curvature_net::request::{QuadMesh, Request, Target};
use crate::methods::curvature_net::smooth;
use crate::solver::Unwatched;
use nalgebra::{Point3, Vector3};

/// A trough that is bent along its length too.
fn shape(u: f64, v: f64) -> [f64; 3] {
    let (x, y) = (8.0 * u, 6.0 * v - 3.0);
    [x, y, 0.15 * y * y - 0.03 * (x - 4.0).powi(2)]
}

/// The shape, which is biquadratic, as a spline.
fn spline() -> BSplineSurface {
    let knots = vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
    // Blossoms of x, y and their squares over the domain.
    let (x, y) = ([0.0, 4.0, 8.0], [-3.0, 0.0, 3.0]);
    let bend_x = [0.03 * 16.0, -0.03 * 16.0, 0.03 * 16.0];
    let bend_y = [0.15 * 9.0, -0.15 * 9.0, 0.15 * 9.0];
    let points = (0..9).map(|k| Point3::new(x[k / 3], y[k % 3], bend_y[k % 3] - bend_x[k / 3]));
    let made = BSplineSurface::new([2, 2], [knots.clone(), knots], points.collect(), None);
    made.expect("a surface")
}

/// A flat net over the target.
fn flat(target: Target) -> Request {
    let mut asked = request(grid([5, 5], [false, false], |u, v| {
        [0.5 + 7.0 * u, 5.0 * v - 2.5, 0.5]
    }));
    asked.options.target = Some(target);
    asked.options.levels = Some(2);
    asked
}

#[test]
fn a_net_lies_on_a_spline() {
    let s = smooth(&flat(Target::BSpline(Box::new(spline()))), &Unwatched).expect("a surface");
    let figures = s.target.expect("a target");
    assert!(figures.max_distance.value < 0.03, "{figures:?}");
    assert!(
        s.borders.mean_torsion < REACHED[0],
        "{:?}",
        s.borders.mean_torsion
    );
    // Measured here, on the formula of the target.
    let heights = s.surface.vertices().iter().map(|k| {
        let (u, v) = (k.point.x / 8.0, (k.point.y + 3.0) / 6.0);
        (shape(u, v)[2] - k.point.z).abs()
    });
    assert!(heights.fold(0.0, f64::max) < 0.04);
}

#[test]
fn a_net_lies_on_a_mesh() {
    let fine = grid([41, 31], [false, false], shape);
    let quad = |k: usize| vec![k, k + 31, k + 32, k + 1];
    let faces = (0..40 * 31).filter(|k| k % 31 < 30).map(quad);
    let mesh = QuadMesh {
        faces: faces.collect(),
        vertices: fine.points,
    };
    let s = smooth(&flat(Target::Mesh(mesh)), &Unwatched).expect("a surface");
    let figures = s.target.expect("a target");
    assert!(figures.max_distance.value < 0.03, "{figures:?}");
    assert!(
        s.borders.mean_torsion < REACHED[0],
        "{:?}",
        s.borders.mean_torsion
    );
}

#[test]
fn a_target_elsewhere_is_refused() {
    let mut asked = flat(Target::BSpline(Box::new(spline())));
    if let crate::methods::curvature_net::request::Input::Grid(grid) = &mut asked.input {
        grid.points
            .iter_mut()
            .for_each(|p| *p += Vector3::new(0.0, 500.0, 0.0));
    }
    match smooth(&asked, &Unwatched) {
        Err(FitError::Invalid(issues)) => {
            assert_eq!(issues[0].code, "target-too-far");
            assert_eq!(issues[0].path, ["options", "target", "bspline"]);
        }
        other => panic!("not refused: {other:?}"),
    }
}
