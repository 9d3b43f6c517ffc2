//! The surface method from outside: shapes whose truth is known, with noise
//! that it is not told.

mod clouds;
mod errors;
mod grids;

use super::request::{Options, Points, Tolerance};
use super::{Outcome, Request, fit};
use crate::geometry::BSplineSurface;
use crate::solver::Unwatched;
use nalgebra::{Point3, Vector3};

/// Normal noise that is the same every time (xorshift, Box–Muller).
pub(in super::super) struct Noise(u64);

impl Noise {
    pub(in super::super) fn new(seed: u64) -> Self {
        Noise(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1)
    }

    /// Even on [0, 1).
    pub(in super::super) fn even(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Normal with standard deviation 1.
    pub(in super::super) fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.even()).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.even()).cos()
    }

    fn vector(&mut self) -> Vector3<f64> {
        Vector3::new(self.normal(), self.normal(), self.normal())
    }
}

/// A bowl-like freeform patch, about 10 × 6 × 2.
fn bowl(u: f64, v: f64) -> Point3<f64> {
    let (x, y) = (10.0 * u, 6.0 * v);
    let z = 1.5 * (0.5 * x).sin() * (0.4 * y).cos() + 0.05 * x * y;
    Point3::new(x, y, z)
}

/// A shell of 200°: no height field.
fn shell(u: f64, v: f64) -> Point3<f64> {
    let angle = (200.0 * v - 10.0).to_radians();
    let radius = 1.0 + 0.1 * u + 0.05 * (3.0 * u).sin() * (2.0 * angle).cos();
    Point3::new(3.0 * u, radius * angle.cos(), radius * angle.sin())
}

fn grid(
    shape: impl Fn(f64, f64) -> Point3<f64>,
    [rows, columns]: [usize; 2],
    (sigma, noise): (f64, &mut Noise),
) -> Vec<Vec<Option<Point3<f64>>>> {
    let mut point = |r: usize, c: usize| {
        let place = shape(
            r as f64 / (rows - 1) as f64,
            c as f64 / (columns - 1) as f64,
        );
        Some(place + sigma * noise.vector())
    };
    (0..rows)
        .map(|r| (0..columns).map(|c| point(r, c)).collect())
        .collect()
}

fn cloud(
    shape: impl Fn(f64, f64) -> Point3<f64>,
    count: usize,
    (sigma, noise): (f64, &mut Noise),
) -> Vec<Point3<f64>> {
    (0..count)
        .map(|_| {
            let place = shape(noise.even(), noise.even());
            place + sigma * noise.vector()
        })
        .collect()
}

fn request(points: Points) -> Request {
    Request {
        points,
        options: Options::default(),
    }
}

fn within(mut request: Request, tolerance: f64) -> Request {
    request.options.tolerance = Some(Tolerance::Same(tolerance));
    request
}

fn done(request: &Request) -> Outcome {
    fit(request, &Unwatched).expect("a valid request")
}

/// Distance of a point from a surface: dense samples, then a descent that
/// knows nothing of the method's own feet.
fn distance(surface: &BSplineSurface, p: &Point3<f64>) -> f64 {
    let [ku, kv] = surface.knots();
    let (u0, u1) = (ku[0], ku[ku.len() - 1]);
    let (v0, v1) = (kv[0], kv[kv.len() - 1]);
    let n = 60;
    let mut best = (f64::INFINITY, [u0, v0]);
    let mut look = |at: [f64; 2]| {
        let at = [at[0].clamp(u0, u1), at[1].clamp(v0, v1)];
        let d = (surface.point(at[0], at[1]) - p).norm();
        if d < best.0 {
            best = (d, at);
            return true;
        }
        false
    };
    for i in 0..=n {
        for j in 0..=n {
            let (s, t) = (f64::from(i) / f64::from(n), f64::from(j) / f64::from(n));
            look([u0 + s * (u1 - u0), v0 + t * (v1 - v0)]);
        }
    }
    let mut step = [(u1 - u0) / 60.0, (v1 - v0) / 60.0];
    let mut at = best.1;
    while step[0] > 1e-9 * (u1 - u0) {
        let mut moved = false;
        for (a, b) in [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)] {
            let next = [at[0] + a * step[0], at[1] + b * step[1]];
            let d = |at: [f64; 2]| (surface.point(at[0], at[1]) - p).norm();
            if d(next) < d(at) {
                at = next;
                moved = true;
            }
        }
        if !moved {
            step = step.map(|s| 0.5 * s);
        }
    }
    best.0.min((surface.point(at[0], at[1]) - p).norm())
}

/// Rms distance of the true shape from the surface.
fn from_truth(surface: &BSplineSurface, shape: impl Fn(f64, f64) -> Point3<f64>) -> f64 {
    let n = 12;
    let mut sum = 0.0;
    for i in 0..=n {
        for j in 0..=n {
            let p = shape(f64::from(i) / f64::from(n), f64::from(j) / f64::from(n));
            sum += distance(surface, &p).powi(2);
        }
    }
    (sum / f64::from((n + 1) * (n + 1))).sqrt()
}
