//! What the method promises, from meshes of strips like those of the paper:
//! C and S, a helix, varying width, a wave.

use super::outcome::Outcome;
use super::request::{Goal, Input, Norm, Options, Request};
use super::{FitError, fit};
use crate::geometry::cone::{Frame, Strain};
use crate::methods::{Control, Stop};
use crate::solver::Unwatched;
use nalgebra::{Isometry3, Point3, Vector3};
use std::f64::consts::PI;
use std::sync::atomic::{AtomicUsize, Ordering};

/// A mesh in rows across, longest side 1.
#[derive(Clone)]
struct Strip {
    vertices: Vec<Point3<f64>>,
    faces: Vec<Vec<usize>>,
}

const ROWS: usize = 110;
const ACROSS: usize = 9;

impl Strip {
    fn of(rows: Vec<Vec<Point3<f64>>>) -> Strip {
        let mut faces = Vec::new();
        for i in 0..rows.len() - 1 {
            for j in 0..ACROSS - 1 {
                let at = |a: usize, b: usize| (i + a) * ACROSS + j + b;
                faces.push(vec![at(0, 0), at(0, 1), at(1, 1)]);
                faces.push(vec![at(0, 0), at(1, 1), at(1, 0)]);
            }
        }
        let vertices = rows.concat();
        let side = crate::geometry::BoundingBox::of(&vertices).map_or(1.0, |b| b.longest_side());
        Strip {
            vertices: vertices.iter().map(|p| p / side).collect(),
            faces,
        }
    }

    /// Swept by a frame: strain and half width by arc length.
    fn swept(
        strain: impl Fn(f64) -> [f64; 2],
        half_width: impl Fn(f64) -> f64,
        length: f64,
    ) -> Strip {
        const FINE: usize = 30;
        let step = length / (ROWS * FINE) as f64;
        let mut frame = Frame {
            point: Point3::origin(),
            ruling: Vector3::x(),
            normal: Vector3::z(),
        };
        let mut rows = Vec::new();
        for i in 0..=ROWS * FINE {
            let s = i as f64 * step;
            if i % FINE == 0 {
                let at = |j: usize| {
                    frame.at(half_width(s) * (2.0 * j as f64 / (ACROSS - 1) as f64 - 1.0))
                };
                rows.push((0..ACROSS).map(at).collect());
            }
            let [g, k] = strain(s + 0.5 * step);
            frame = frame.carried(Strain { g, k }, step);
        }
        Strip::of(rows)
    }

    fn c() -> Strip {
        let bend = |s: f64| {
            0.45 + 1.3 * (PI * s / 3.0 - 0.3).sin().powi(4)
                + 0.5 * (-((s - 2.7) / 0.4).powi(2)).exp()
        };
        Strip::swept(|s| [0.25 * (1.3 * s + 0.4).sin(), bend(s)], |_| 0.3, 3.0)
    }

    fn s() -> Strip {
        let strain = |s: f64| {
            [
                0.3 * (1.1 * s).cos() + 0.15 * (2.3 * s).sin(),
                1.6 * (0.5 * PI * s + 0.25).sin() + 0.3 * (3.0 * s).sin(),
            ]
        };
        Strip::swept(strain, |_| 0.3, 4.0)
    }

    fn of_varying_width() -> Strip {
        let strain = |s: f64| {
            [
                0.5 * (1.7 * s - 0.5).sin(),
                1.2 + 1.3 * (2.1 * s).cos() + 0.5 * (4.0 * s).sin(),
            ]
        };
        Strip::swept(strain, |s| 0.16 + 0.28 * ((s - 1.6) / 1.6).powi(2), 3.2)
    }

    fn wave() -> Strip {
        let strain = |s: f64| {
            [
                0.35 * (2.0 * s).sin() + 0.2 * (3.1 * s).cos(),
                2.6 * (2.0 * PI * s / 1.7).sin() + 0.7 * (2.2 * s).cos(),
            ]
        };
        Strip::swept(strain, |_| 0.3, 5.0)
    }

    /// The tangents of a helix: rulings run across the strip at 45°.
    fn helix() -> Strip {
        let row = |i: usize| {
            let u = 3.2 * PI * i as f64 / ROWS as f64;
            let on = Point3::new(u.cos(), u.sin(), 0.35 * u);
            let along = Vector3::new(-u.sin(), u.cos(), 0.35);
            (0..ACROSS)
                .map(|j| on + along * (0.9 + 0.5 * j as f64 / (ACROSS - 1) as f64))
                .collect()
        };
        Strip::of((0..=ROWS).map(row).collect())
    }

    fn request(&self, options: Options) -> Request {
        Request {
            name: "strip".to_owned(),
            input: Input::Mesh {
                vertices: self.vertices.clone(),
                faces: self.faces.clone(),
            },
            options,
        }
    }

    fn fitted(&self, goal: Goal, norm: Option<Norm>) -> Outcome {
        let options = Options {
            goal,
            norm,
            ..Options::default()
        };
        fit(&self.request(options), &Unwatched).expect("a strip")
    }
}

/// Neighbours meet as they must, measured on what is returned.
fn joins(outcome: &Outcome) {
    for join in &outcome.joins {
        assert!(join.angle_deg.to_radians() <= 1e-10, "{join:?}");
        assert!(join.gap <= 1e-10 * outcome.model_size, "{join:?}");
    }
}

fn largest(strip: &Strip, pieces: usize) -> f64 {
    let outcome = strip.fitted(Goal::Pieces(pieces), Some(Norm::Minimax));
    joins(&outcome);
    assert_eq!(outcome.patches.len(), pieces);
    // The flat triangles themselves are off by some 1e-3.
    let limit = 3.0 * outcome.to_surface.max + 2e-3;
    assert!(outcome.to_mesh.max < limit, "{:?}", outcome.to_mesh);
    outcome.to_surface.max
}

#[test]
fn patches_come_as_near_as_promised() {
    let list: [(Strip, &[(usize, f64)]); 5] = [
        (Strip::c(), &[(4, 2e-3), (8, 3e-4)]),
        (Strip::s(), &[(8, 1e-3)]),
        (Strip::of_varying_width(), &[(6, 1.3e-3)]),
        (Strip::helix(), &[(8, 3e-3), (13, 8e-4)]),
        (Strip::wave(), &[(8, 4e-3), (16, 8e-4), (20, 5e-4)]),
    ];
    for (i, (strip, limits)) in list.iter().enumerate() {
        for (pieces, limit) in *limits {
            let max = largest(strip, *pieces);
            assert!(max <= *limit, "strip {i}, {pieces} patches: {max}");
        }
    }
}

#[test]
fn no_more_patches_than_a_tolerance_needs() {
    let list = [
        (Strip::c(), 5),
        (Strip::s(), 7),
        (Strip::of_varying_width(), 6),
        (Strip::helix(), 10),
        (Strip::wave(), 13),
    ];
    for (i, (strip, most)) in list.iter().enumerate() {
        let outcome = strip.fitted(Goal::Tolerance(1e-3), None);
        joins(&outcome);
        assert!(outcome.within_limits && outcome.reachable, "strip {i}");
        assert!(outcome.patches.len() <= *most, "{:?}", outcome.summary);
    }
}

#[test]
fn few_patches_for_the_shape_do_not_collapse() {
    let outcome = Strip::wave().fitted(Goal::Pieces(4), None);
    joins(&outcome);
    assert!(outcome.to_surface.max < 0.07, "{:?}", outcome.to_surface);
    assert!(outcome.to_mesh.max < 0.1, "{:?}", outcome.to_mesh);
}

#[test]
fn a_ruled_surface_is_fitted_along_its_own_rulings() {
    use crate::geometry::BSplineSurface;
    // A cubic through points of the helix's rulings would do as well; two
    // rows of control points are a strip with straight rulings already.
    let row = |i: usize| {
        let u = 3.2 * PI * i as f64 / 40.0;
        let on = Point3::new(u.cos(), u.sin(), 0.35 * u);
        let along = Vector3::new(-u.sin(), u.cos(), 0.35);
        [on + along * 0.9, on + along * 1.4]
    };
    let points: Vec<Point3<f64>> = (0..=40).flat_map(row).collect();
    let mut knots = vec![0.0; 4];
    knots.extend((1..38).map(f64::from));
    knots.extend([38.0; 4]);
    let across = vec![0.0, 0.0, 1.0, 1.0];
    let surface = BSplineSurface::new([3, 1], [knots, across], points, None).expect("a surface");
    let request = Request {
        name: "helix".to_owned(),
        input: Input::Ruled(surface),
        options: Options {
            goal: Goal::Pieces(13),
            ..Options::default()
        },
    };
    let outcome = fit(&request, &Unwatched).expect("a strip");
    joins(&outcome);
    assert!(
        outcome.to_surface.max < 2e-3 * outcome.model_size,
        "{:?}",
        outcome.to_surface
    );
}

#[test]
fn errors_fall_with_every_patch_and_with_their_cube() {
    for strip in [Strip::s(), Strip::wave()] {
        let curve = strip.fitted(Goal::Pieces(16), None).error_curve;
        assert!(
            curve
                .windows(2)
                .all(|p| p[1].rms <= p[0].rms * (1.0 + 1e-9)),
            "{curve:?}"
        );
        let rms = |k: usize| curve.iter().find(|p| p.patches == k).expect("solved").rms;
        let slope = (rms(18) / rms(8)).ln() / (18.0_f64 / 8.0).ln();
        assert!(slope <= -2.6, "{slope}");
    }
}

#[test]
fn pose_order_and_sides_do_not_matter() {
    let strip = Strip::c();
    let here = strip.fitted(Goal::Tolerance(1e-3), None);
    let pose = Isometry3::new(Vector3::new(30.0, -7.0, 3.0), Vector3::new(0.4, 1.1, -0.8));
    // Vertices in steps that have no factor in common with their number.
    let count = strip.vertices.len();
    let step = (2..)
        .find(|s| gcd(*s * 100 + 37, count) == 1)
        .expect("some")
        * 100
        + 37;
    let to = |i: usize| i * step % count;
    let mut other = strip.clone();
    for (i, p) in strip.vertices.iter().enumerate() {
        other.vertices[to(i)] = pose * p;
    }
    other.faces.reverse();
    for face in &mut other.faces {
        face.iter_mut().for_each(|v| *v = to(*v));
        face.swap(0, 1);
    }
    let there = other.fitted(Goal::Tolerance(1e-3), None);
    assert_eq!(here.patches.len(), there.patches.len());
    for (i, d) in here.vertex_distances.iter().enumerate() {
        let e = there.vertex_distances[to(i)];
        assert!((d + e).abs() < 1e-6, "{i}: {d} {e}");
    }
}

fn gcd(a: usize, b: usize) -> usize {
    if b == 0 { a } else { gcd(b, a % b) }
}

#[test]
fn the_answer_is_the_same_whatever_the_number_of_threads() {
    let strip = Strip::s();
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("threads")
            .install(|| strip.fitted(Goal::Tolerance(1e-3), None))
    };
    assert!(with(1) == with(3));
}

/// Stops after a number of questions.
struct Patience(AtomicUsize);

impl Control for Patience {
    fn check(&self) -> Result<(), Stop> {
        let left = self
            .0
            .fetch_update(Ordering::Relaxed, Ordering::Relaxed, |n| n.checked_sub(1));
        left.map(|_| ()).map_err(|_| Stop::Cancelled)
    }
    fn progress(&self, _phase: &'static str, _percent: f64) {}
}

#[test]
fn a_fit_ends_when_it_is_told_to() {
    let request = Strip::s().request(Options {
        goal: Goal::Tolerance(1e-3),
        ..Options::default()
    });
    for questions in [0, 1, 10, 60, 300, 1000] {
        let stopped = fit(&request, &Patience(AtomicUsize::new(questions)));
        let cancelled = FitError::Stopped(Stop::Cancelled);
        assert_eq!(stopped.err(), Some(cancelled), "{questions}");
    }
}

/// Normal numbers, the same on every machine: Box and Muller's on a
/// multiplicative generator (Park & Miller 1988).
struct Noise(u64);

impl Noise {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0 * 48_271 % 2_147_483_647;
        self.0 as f64 / 2_147_483_647.0
    }

    fn normal(&mut self) -> f64 {
        let (a, b) = (self.uniform(), self.uniform());
        (-2.0 * a.ln()).sqrt() * (2.0 * PI * b).cos()
    }
}

/// Mean distance of the vertices without noise: noise along the normal moves
/// the distance by itself.
fn true_mean(outcome: &Outcome, clean: &Strip, noisy: &Strip) -> f64 {
    let normals = normals(clean);
    let distance = |i: usize| {
        let moved = (noisy.vertices[i] - clean.vertices[i]).dot(&normals[i]);
        (outcome.vertex_distances[i] - moved).abs()
    };
    let count = clean.vertices.len();
    (0..count).map(distance).sum::<f64>() / count as f64
}

/// Unit normals of the vertices, by area.
fn normals(strip: &Strip) -> Vec<Vector3<f64>> {
    let mut sums = vec![Vector3::zeros(); strip.vertices.len()];
    for face in &strip.faces {
        let [a, b, c] = [0, 1, 2].map(|i| strip.vertices[face[i]]);
        let normal = (b - a).cross(&(c - a));
        face.iter().for_each(|v| sums[*v] += normal);
    }
    sums.iter().map(|s| s.normalize()).collect()
}

#[test]
fn noise_averages_out() {
    const SIGMA: f64 = 0.004;
    let clean = Strip::s();
    let mut noise = Noise(4711);
    let mut noisy = clean.clone();
    for p in &mut noisy.vertices {
        *p += Vector3::from_fn(|_, _| SIGMA * noise.normal());
    }
    let outcome = noisy.fitted(Goal::Noise, None);
    joins(&outcome);
    let mean = true_mean(&outcome, &clean, &noisy);
    assert!(mean <= 0.25 * SIGMA, "{mean}, {:?}", outcome.report);
}

#[test]
fn two_in_a_hundred_outliers_hardly_matter() {
    let clean = Strip::c();
    let mut noise = Noise(99);
    let mut spoilt = clean.clone();
    for i in (ACROSS + 3..clean.vertices.len()).step_by(50) {
        // The outline is read as it is.
        let inner = i % ACROSS != 0 && i % ACROSS != ACROSS - 1;
        if inner {
            spoilt.vertices[i] += Vector3::from_fn(|_, _| 0.03 * noise.normal());
        }
    }
    let goal = Goal::Pieces(4);
    let options = Options {
        goal,
        robust: true,
        ..Options::default()
    };
    let robust = fit(&spoilt.request(options), &Unwatched).expect("a strip");
    joins(&robust);
    let stayed = |i: &usize| spoilt.vertices[*i] == clean.vertices[*i];
    let with = (0..clean.vertices.len())
        .filter(stayed)
        .map(|i| robust.vertex_distances[i].abs())
        .fold(0.0, f64::max);
    let without = clean.fitted(goal, None).to_surface.max;
    assert!(with <= 1.5 * without, "{with} {without}");
}
