//! The curves against truths that are known, and the contract.

mod contract;
mod derivatives;
mod given;
mod noise;
mod slips;
mod unordered;

use super::fit;
use super::outcome::Outcome;
use super::request::Request;
use crate::solver::Unwatched;
use nalgebra::Point3;

/// A deterministic source of normal deviates: xorshift and twelve summands.
pub(super) struct Noise(pub(super) u64);

impl Noise {
    pub(super) fn uniform(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub(super) fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }
}

/// A frame of a hull by its curvature: 10 long, 196° of turn, 2 inflections.
pub(super) fn frame_curvature(s: f64) -> f64 {
    let bump = |at: f64, width: f64| (-((s - at) / width).powi(2)).exp();
    0.35 + 0.5 * bump(3.2, 0.9) - 0.45 * bump(7.0, 1.1)
}

/// ∫ κ′² ds of the frame, by the same midpoint sums as its points.
pub(super) fn frame_variation() -> f64 {
    let h = 1e-3;
    let slope = |s: f64| (frame_curvature(s + h) - frame_curvature(s - h)) / (2.0 * h);
    (0..10_000)
        .map(|k| slope((f64::from(k) + 0.5) * h).powi(2) * h)
        .sum()
}

/// `count` points of the frame at random places, ends included, with noise.
pub(super) fn frame(count: usize, sigma: f64, seed: u64) -> Vec<Point3<f64>> {
    const STEPS: usize = 20_000;
    let h = 10.0 / STEPS as f64;
    let (mut x, mut y, mut turn) = (0.0, 0.0, -0.4_f64);
    let mut table = vec![(0.0, 0.0)];
    for k in 0..STEPS {
        let kappa = frame_curvature((k as f64 + 0.5) * h);
        let middle = turn + 0.5 * h * kappa;
        x += h * middle.cos();
        y += h * middle.sin();
        turn += h * kappa;
        table.push((x, y));
    }
    let mut noise = Noise(seed);
    let mut places: Vec<f64> = (0..count).map(|_| noise.uniform()).collect();
    places.sort_by(f64::total_cmp);
    places[0] = 0.0;
    places[count - 1] = 1.0;
    places
        .into_iter()
        .map(|t| {
            let (x, y) = table[(t * STEPS as f64) as usize];
            Point3::new(x + sigma * noise.normal(), y + sigma * noise.normal(), 0.0)
        })
        .collect()
}

pub(super) fn half_circle(count: usize) -> Vec<Point3<f64>> {
    let angle = |k: usize| std::f64::consts::PI * k as f64 / (count - 1) as f64;
    (0..count)
        .map(|k| Point3::new(angle(k).cos(), angle(k).sin(), 0.0))
        .collect()
}

pub(super) fn shuffled(mut points: Vec<Point3<f64>>) -> Vec<Point3<f64>> {
    let mut noise = Noise(77);
    for k in (1..points.len()).rev() {
        let other = (noise.uniform() * (k + 1) as f64) as usize;
        points.swap(k, other);
    }
    points
}

pub(super) fn fitted(request: &Request) -> Outcome {
    fit(request, &Unwatched).expect("the request is sound")
}

pub(super) fn curvature_range(o: &Outcome) -> (f64, f64) {
    let all = o.comb.iter().map(|t| t.curvature);
    all.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), k| {
        (a.min(k), b.max(k))
    })
}
