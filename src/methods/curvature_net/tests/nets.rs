use super::models::{bilge, request, saddle, tube, vault};
use crate::methods::FitError;
use crate::methods::curvature_net::lines::REACHED;
use crate::methods::curvature_net::reasons::Why;
use crate::methods::curvature_net::request::{Solver, Umbilics};
use crate::methods::curvature_net::{Smooth, smooth};
use crate::solver::{Control, Stop, Unwatched};
use std::sync::atomic::{AtomicUsize, Ordering};

fn fitted(grid: crate::methods::curvature_net::request::Grid) -> Smooth {
    smooth(&request(grid), &Unwatched).expect("a surface")
}

#[test]
fn four_models_become_nets_of_curvature_lines_and_keep_their_shape() {
    let models = [
        ("vault", vault()),
        ("saddle", saddle()),
        ("tube", tube()),
        ("bilge", bilge()),
    ];
    for (name, grid) in models {
        let s = fitted(grid);
        let [n, m] = s.surface.layout().patch_counts();
        assert!(n * m >= 192, "{name}: {n} × {m}");
        assert!(
            s.borders.mean_torsion <= REACHED[0],
            "{name}: {:?}",
            s.borders.mean_torsion
        );
        assert!(
            s.borders.max_torsion.value <= REACHED[1],
            "{name}: {:?}",
            s.borders.max_torsion
        );
        assert!(s.borders.max_normal_jump < 1e-12, "{name}");
        assert!(s.umbilics.patches.is_empty(), "{name}: {:?}", s.umbilics);
        assert!(s.shape.mean_move <= 0.5, "{name}: {:?}", s.shape);
        assert!(s.shape.mean_turn_deg <= 3.0, "{name}: {:?}", s.shape);
    }
}

#[test]
fn a_plane_has_no_umbilics_that_matter() {
    // Rows that are neither even nor square, in a plane that is not level.
    let flat = super::models::grid([5, 5], [false, false], |u, v| {
        let (x, y) = (3.0 * u + 0.2 * v * v, 0.3 * u * v + 2.0 * v);
        [x, y, 0.3 * x - 0.1 * y]
    });
    let s = fitted(flat.clone());
    let count = s.surface.layout().patches().count();
    assert_eq!((s.umbilics.patches.len(), s.umbilics.flat), (0, count));
    assert!(s.borders.max_torsion.value <= REACHED[1]);
    let outcome = crate::methods::curvature_net::fit(&request(flat), &Unwatched);
    let outcome = outcome.expect("a net");
    assert!(outcome.within_limits, "{:?}", outcome.summary);
}

#[test]
fn lines_run_along_the_principal_directions() {
    let s = fitted(vault());
    // Computed from first and second derivatives of the surface alone.
    for (i, j) in s.surface.layout().patches() {
        let jet = s.surface.jet([i, j], [0.5, 0.0]);
        let normal = jet.normal().expect("a normal");
        let first = nalgebra::Matrix2::new(
            jet.du.dot(&jet.du),
            jet.du.dot(&jet.dv),
            jet.du.dot(&jet.dv),
            jet.dv.dot(&jet.dv),
        );
        let second = nalgebra::Matrix2::new(
            jet.duu.dot(&normal),
            jet.duv.dot(&normal),
            jet.duv.dot(&normal),
            jet.dvv.dot(&normal),
        );
        let shape = first.try_inverse().expect("regular") * second;
        // The shape operator maps S_u to a multiple of itself.
        assert!((shape[(1, 0)] / (shape[(0, 0)] - shape[(1, 1)])).abs() < 1e-3);
    }
}

#[test]
fn a_net_of_curvature_lines_stays() {
    // A torus's meridians and parallels.
    let torus = super::models::grid([16, 12], [true, true], |u, v| {
        let (u, v) = (std::f64::consts::TAU * u, std::f64::consts::TAU * v);
        let r = 5.0 + 2.0 * v.cos();
        [r * u.cos(), r * u.sin(), 2.0 * v.sin()]
    });
    let s = fitted(torus);
    assert!(s.shape.mean_move < 0.01, "{:?}", s.shape);
    assert!(s.shape.mean_turn_deg < 0.5, "{:?}", s.shape);
}

#[test]
fn a_hypar_along_its_rulings_says_why_it_cannot_keep_its_shape() {
    let hypar = super::models::grid([5, 5], [false, false], |u, v| {
        let (x, y) = (6.0 * u - 3.0, 6.0 * v - 3.0);
        [x, y, 0.08 * x * y]
    });
    let s = fitted(hypar);
    assert!(s.borders.mean_torsion <= REACHED[0]);
    assert!(s.umbilics.patches.is_empty(), "{:?}", s.umbilics.patches);
    assert!(s.shape.mean_turn_deg > 3.0);
    let why = s.moved.iter().map(|m| m.why);
    let off = why.filter(|why| matches!(why, Why::OffPrincipal(angle) if *angle > 40.0));
    assert!(off.count() > 0, "{:?}", s.moved);
    assert!(s.crossing.is_none());
}

#[test]
fn a_wave_says_between_which_places_it_must_have_umbilics() {
    let wave = super::models::grid([6, 6], [false, false], |u, v| {
        [
            6.0 * u,
            6.0 * v,
            0.5 * (5.0 * u + 1.0).sin() + 0.4 * (4.0 * v).cos(),
        ]
    });
    let mut request = request(wave);
    request.options.umbilics = Umbilics::KeepShape;
    let kept = smooth(&request, &Unwatched).expect("a surface");
    assert!(!kept.umbilics.patches.is_empty());
    let crossing = kept.crossing.expect("both lead");
    assert!(crossing.u.value > 0.1 && crossing.v.value > 0.1);
    // Or it goes without, and says where its shape went.
    request.options.umbilics = Umbilics::Avoid;
    let free = smooth(&request, &Unwatched).expect("a surface");
    assert!(
        free.umbilics.patches.is_empty(),
        "{:?}",
        free.umbilics.patches
    );
    assert!(free.borders.mean_torsion <= REACHED[0]);
    assert!(free.shape.mean_turn_deg > kept.shape.mean_turn_deg);
    let why = free.moved.iter().map(|m| m.why);
    assert!(
        why.filter(|why| *why == Why::OtherLeads).count() > 0,
        "{:?}",
        free.moved
    );
}

/// A part of a torus, each point off by up to `noise`.
fn rough_torus(noise: f64) -> crate::methods::curvature_net::request::Grid {
    let mut torus = super::models::grid([5, 5], [false, false], |u, v| {
        let (sin, cos) = (2.0 * u).sin_cos();
        let angle = 2.0 * v - 1.0;
        let radius = 3.0 + angle.cos();
        [radius * cos, radius * sin, angle.sin()]
    });
    for (k, p) in torus.points.iter_mut().enumerate() {
        let wild = |n: f64| noise * (n * (k as f64 + 1.0) * 12.9898).sin();
        *p += nalgebra::Vector3::new(wild(1.0), wild(1.7), wild(2.9));
    }
    torus
}

#[test]
fn measured_points_are_smoothed_where_they_would_make_umbilics() {
    let s = fitted(rough_torus(0.0));
    assert!(s.smoothed.is_none());
    let s = fitted(rough_torus(0.1));
    assert!(s.borders.mean_torsion <= REACHED[0]);
    assert!(s.umbilics.patches.is_empty(), "{:?}", s.umbilics.patches);
    assert!(s.shape.mean_turn_deg < 15.0, "{:?}", s.shape);
    let smoothed = s.smoothed.expect("told");
    assert!(
        smoothed.mean > 0.01 && smoothed.max.value < 0.3,
        "{smoothed:?}"
    );
}

#[test]
fn size_and_place_do_not_matter() {
    let near = fitted(saddle());
    let mut far = saddle();
    far.points
        .iter_mut()
        .for_each(|p| *p = (*p * 1e3) + nalgebra::Vector3::new(4e6, -7e5, 30.0));
    let far = fitted(far);
    let mapped = |p: nalgebra::Vector3<f64>| p * 1e3 + nalgebra::Vector3::new(4e6, -7e5, 30.0);
    for (a, b) in near.surface.vertices().iter().zip(far.surface.vertices()) {
        assert!((mapped(a.point) - b.point).norm() < 1e-3);
    }
}

#[test]
fn the_papers_way_comes_as_near_as_it_says() {
    let mut asked = request(tube());
    asked.options.solver = Solver::Paper;
    let paper = smooth(&asked, &Unwatched).expect("a surface");
    let own = fitted(tube());
    // Its mean was 1.5e-4 on its own models.
    assert!(
        (1e-5..5e-4).contains(&paper.borders.mean_torsion),
        "{:?}",
        paper.borders
    );
    assert!(own.borders.mean_torsion < 1e-2 * paper.borders.mean_torsion);
    assert!(paper.borders.max_normal_jump > 1e-9);
}

#[test]
fn threads_do_not_change_a_bit() {
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("threads").install(|| fitted(bilge()))
    };
    assert_eq!(run(1), run(3));
}

/// Stops after so many looks.
struct Impatient {
    looks: AtomicUsize,
}

impl Control for Impatient {
    fn check(&self) -> Result<(), Stop> {
        match self.looks.fetch_add(1, Ordering::Relaxed) {
            0..5 => Ok(()),
            _ => Err(Stop::Cancelled),
        }
    }
    fn progress(&self, _: &'static str, percent: f64) {
        assert!((0.0..=100.0).contains(&percent));
    }
}

#[test]
fn it_stops_when_told() {
    let control = Impatient {
        looks: AtomicUsize::new(0),
    };
    let stopped = smooth(&request(vault()), &control);
    assert_eq!(stopped, Err(FitError::Stopped(Stop::Cancelled)));
    assert!(control.looks.load(Ordering::Relaxed) < 10);
}
