//! The paper's solver on strips whose answer is known, its gradient, and what
//! was mended of its text.

use super::super::fit_tests::{carried, pieces, target};
use super::super::request::Input;
use super::axes::Axis;
use super::objective::Objective;
use super::*;
use crate::geometry::cone::{Frame, Strain};
use crate::solver::Unwatched;
use crate::solver::lbfgs::Objective as _;
use nalgebra::Vector3;

fn request(pieces: usize) -> Request {
    Request {
        name: "strip".to_owned(),
        input: Input::Mesh {
            vertices: Vec::new(),
            faces: Vec::new(),
        },
        options: Options {
            goal: Goal::Pieces(pieces),
            ..Options::default()
        },
    }
}

fn fit(target: &Target, pieces: usize) -> Outcome {
    fit_target(&request(pieces), pieces, target, &Unwatched).expect("a strip")
}

const TWO: [(f64, f64, f64); 2] = [(0.5, 1.5, 0.6), (-0.3, 2.6, 0.6)];

#[test]
fn two_cones_are_found_again() {
    let outcome = fit(&target(&carried(pieces(&TWO), 1.2, 0.2)), 2);
    assert!(outcome.warnings.is_empty(), "{:?}", outcome.warnings);
    assert!(outcome.to_surface.max < 2e-3, "{}", outcome.to_surface.max);
    assert!(outcome.to_mesh.max < 2e-3, "{}", outcome.to_mesh.max);
    // From either end.
    let halves = |list: [f64; 2]| [list[0].min(list[1]), list[0].max(list[1])];
    let found = halves([0, 1].map(|i| outcome.patches[i].half_angle_deg.expect("a cone")));
    let expected = halves(TWO.map(|(g, k, _)| (g / k).atan().to_degrees().abs()));
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() < 0.5, "{found} {expected}");
    }
    // Stitched: exact, whatever the surface was.
    for join in &outcome.joins {
        assert!(join.gap < 1e-12 && join.angle_deg < 1e-10, "{join:?}");
    }
}

/// Strains of a strip that bends to and fro.
fn wave(s: f64) -> (f64, f64) {
    (0.3 * (1.1 * s).cos(), 1.6 * (1.6 * s + 0.25).sin())
}

#[test]
fn a_bending_strip_is_met_in_the_papers_league() {
    // Its S in 8 patches: 0.007 of the longest side at most, 0.002 on average.
    let strip = target(&carried(|s| wave(4.0 * s), 1.0, 0.2));
    let outcome = fit(&strip, 8);
    let size = outcome.model_size;
    assert!(
        outcome.to_surface.max < 0.007 * size,
        "{}",
        outcome.to_surface.max / size
    );
    assert!(outcome.to_surface.mean < 0.002 * size);
    assert_eq!(outcome.patches.len(), 8);
    assert!(outcome.floor.max <= outcome.to_surface.max);
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let strip = target(&carried(|s| wave(4.0 * s), 1.0, 0.2));
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("threads").install(|| fit(&strip, 8))
    };
    assert_eq!(with(1), with(4));
}

/// A cone's rulings, 0.2 long, a turn of 1.2.
fn cone_strip(shift: f64) -> (Ruled, Frame, Strain) {
    let frame = Frame {
        point: Point3::new(0.1, 0.2, 0.3 + shift),
        ruling: Vector3::x(),
        normal: Vector3::z(),
    };
    let strain = Strain { g: 1.0, k: -2.0 };
    let ruling = |i: i32| {
        let there = frame.carried(strain, f64::from(i) * 0.6 / 40.0);
        [there.at(0.0), there.at(0.2)]
    };
    let rulings: Vec<_> = (0..=40).map(ruling).collect();
    (Ruled::through(&rulings).expect("rulings"), frame, strain)
}

#[test]
fn osculating_axes_of_a_cone_are_its_axis() {
    let (surface, frame, strain) = cone_strip(0.0);
    let rate = strain.rate();
    let direction = (strain.k.abs() * frame.ruling - strain.g * frame.normal) / rate;
    let through = frame.point + (strain.k * frame.normal - strain.g * frame.ruling) / (rate * rate);
    let axes = axes::along(&surface, 30);
    for axis in &axes {
        // The ends of a spline through points bend a little otherwise.
        if !(0.1..0.9).contains(&axis.u) {
            continue;
        }
        assert!((axis.direction - direction).norm() < 1e-3, "{axis:?}");
        let moment = through.coords.cross(&axis.direction);
        assert!((axis.moment - moment).norm() < 1e-3, "{axis:?}");
    }
    let cone = Cone::near(&axes[5..25], &surface);
    assert!((cone.along.cross(&direction)).norm() < 1e-3);
    // The apex lies on side 0's side, and V runs against the rulings.
    let half = (strain.g / strain.k).atan().abs();
    assert!((cone.angle - half).abs() < 1e-3, "{cone:?}");
    let chain = stitch::stitched(&surface, &[cone], &[0.0, 1.0]).expect("a chain");
    let homes = distances::homes(
        &chain,
        &[surface.jet(0.5, 0.5).point, surface.jet(0.2, 1.0).point],
    );
    assert!(homes.iter().all(|h| h.distance.abs() < 1e-3), "{homes:?}");
    // The strip bends away from its normals: k < 0.
    assert!(chain.strains[0].k < 0.0 && chain.strains[0].g > 0.0);
}

#[test]
fn an_axis_and_its_opposite_are_one() {
    let axis = |i: usize| {
        let x = i as f64 / 40.0;
        let direction = if i < 15 { Vector3::x() } else { Vector3::y() };
        Axis {
            u: x,
            place: Point3::new(0.05 * x, 0.0, 0.0),
            direction,
            moment: Vector3::new(0.0, 0.0, 0.3),
        }
    };
    let axes: Vec<Axis> = (0..40).map(axis).collect();
    let mut flipped = axes.clone();
    for (i, axis) in flipped.iter_mut().enumerate() {
        if i % 3 == 0 {
            axis.direction = -axis.direction;
            axis.moment = -axis.moment;
        }
    }
    // Places also count: 10 / 0.05 × the way along the strip.
    let regions = clusters::regions(&axes, 2);
    assert_eq!((regions[0], regions[2]), (0, 40));
    assert_eq!(regions, clusters::regions(&flipped, 2));
    for list in [&axes, &flipped] {
        let [direction, moment] = clusters::mean_axis(&list[20..30]);
        let sign = direction.y.signum();
        assert!((sign * direction - Vector3::y()).norm() < 1e-15);
        assert!((sign * moment - Vector3::new(0.0, 0.0, 0.3)).norm() < 1e-15);
    }
}

#[test]
fn gradient_agrees_with_central_differences() {
    let breaks = [0.0, 0.45, 1.0];
    let surface = cone_strip(0.0).0.with_regions(&breaks).expect("knots");
    let off = cone_strip(0.05).0;
    let points: Vec<_> = (0..12)
        .map(|i| off.jet(f64::from(i) / 11.0, f64::from(i % 4) / 3.0).point)
        .collect();
    let side = |k: usize| -> Vec<_> { points.iter().skip(k).step_by(3).copied().collect() };
    let (sides, ends) = ([side(0), side(1)], [side(2), side(1)]);
    let weights = vec![0.7; points.len()];
    let data = Data {
        points: &points,
        weights: &weights,
        sides: sides.each_ref().map(Vec::as_slice),
        ends: ends.each_ref().map(Vec::as_slice),
    };
    // Cones on both sides of the strip, one of them nearly a cylinder.
    let cone = |z: f64, angle: f64, distance: f64| Cone {
        point: Point3::new(0.2, 0.35, z),
        along: Vector3::new(-1.1, 0.3, 0.2),
        angle,
        distance,
    };
    let cones = [cone(-0.2, 0.3, 0.4), cone(0.9, -1e-3, 0.5)];
    let objective = Objective::new(&surface, &breaks, data, 3.0);
    let x = Objective::gather(&surface, &cones);
    let mut gradient = vec![0.0; x.len()];
    let here = objective.evaluate(&x, &mut gradient);
    assert!(here > 3.0 * objective.broken(&x));
    let value = |i: usize, h: f64| {
        let mut y = x.clone();
        y[i] += h;
        objective.evaluate(&y, &mut vec![0.0; x.len()])
    };
    for (i, analytic) in gradient.iter().enumerate() {
        let h = 1e-5;
        let numerical = (value(i, h) - value(i, -h)) / (2.0 * h);
        let error = (analytic - numerical).abs() / (1.0 + numerical.abs());
        assert!(error < 1e-6, "unknown {i}: {analytic} against {numerical}");
    }
}

#[test]
fn what_the_paper_cannot_do_is_named() {
    let asked = |change: fn(&mut Options)| {
        let mut options = request(4).options;
        change(&mut options);
        let issues = check_options(&options);
        issues.iter().map(|i| i.path.join("/")).collect::<Vec<_>>()
    };
    assert!(asked(|_| ()).is_empty());
    assert_eq!(
        asked(|o| o.goal = Goal::Tolerance(0.1)),
        ["options/tolerance"]
    );
    assert_eq!(asked(|o| o.goal = Goal::Noise), ["options/pieces"]);
    let all = asked(|o| {
        (o.simplify, o.robust) = (true, true);
        o.norm = Some(Norm::Minimax);
        o.classes.planes = false;
    });
    let names = ["norm", "classes", "simplify", "robust"];
    assert_eq!(all, names.map(|n| format!("options/{n}")));
}
