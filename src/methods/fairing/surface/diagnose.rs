//! Fairness figures of a sheet over the region of its data, and isophotes.

use super::net::Sheet;
use super::outcome::{Fairness, Isophotes};
use super::region::Region;
use super::task::Task;
use super::tolerance::energy_of;
use crate::numerics::EnvelopeMatrix;
use nalgebra::Vector3;
use rayon::prelude::*;

/// Samples along the longer side of the net.
const SAMPLES: f64 = 64.0;
/// Fewest samples along the shorter side.
const FEWEST: f64 = 16.0;

/// Samples of a sheet inside its region.
struct Sampled {
    u: Vec<f64>,
    v: Vec<f64>,
    /// Place and n·l, v fastest.
    light: Vec<Option<(Vector3<f64>, f64)>>,
    /// Gaussian and mean curvature.
    bend: Vec<Option<[f64; 2]>>,
}

fn sample(sheet: &Sheet, region: &Region, light: &Vector3<f64>) -> Sampled {
    let domain = region.domain();
    let length = domain.map(|[a, b]| b - a);
    let longer = length[0].max(length[1]);
    let axis = |k: usize| -> Vec<f64> {
        let n = (SAMPLES * length[k] / longer).ceil().max(FEWEST) as usize;
        (0..=n)
            .map(|i| domain[k][0] + length[k] * i as f64 / n as f64)
            .collect()
    };
    let (u, v) = (axis(0), axis(1));
    let look = |k: usize| {
        let at = [u[k / v.len()], v[k % v.len()]];
        if !region.contains(at) {
            return (None, None);
        }
        let bends = sheet.bends(at);
        let shade = bends
            .first
            .normal()
            .map(|n| (bends.first.point, n.dot(light)));
        (shade, bends.curvatures())
    };
    let (light, bend) = (0..u.len() * v.len()).into_par_iter().map(look).unzip();
    Sampled { u, v, light, bend }
}

/// Figures and isophotes of a sheet.
pub(in super::super) fn diagnose(
    (sheet, energy): (&Sheet, &EnvelopeMatrix),
    region: &Region,
    task: &Task,
) -> (Fairness, Isophotes) {
    let (frame, light) = (task.frame, &task.light);
    let inside = frame.axes.tr_mul(light);
    let sampled = sample(sheet, region, &inside);
    let mut range = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
    for b in sampled.bend.iter().flatten() {
        for k in 0..2 {
            range[k][0] = range[k][0].min(b[k]);
            range[k][1] = range[k][1].max(b[k]);
        }
    }
    let size = frame.size;
    let fairness = Fairness {
        energy: energy_of(sheet, energy, task.freedom),
        gaussian_min: range[0][0] / (size * size),
        gaussian_max: range[0][1] / (size * size),
        mean_min: range[1][0] / size,
        mean_max: range[1][1] / size,
        isophote_roughness: roughness(&sampled) / (size * size),
    };
    let isophotes = Isophotes {
        light: *light,
        values: sampled.light.iter().map(|s| s.map(|(_, x)| x)).collect(),
        u: sampled.u,
        v: sampled.v,
    };
    (fairness, isophotes)
}

/// Rms second divided difference of n·l by distance, along both families.
fn roughness(s: &Sampled) -> f64 {
    let (nu, nv) = (s.u.len(), s.v.len());
    let mut squares = (0.0, 0usize);
    let mut triple = |a: usize, b: usize, c: usize| {
        let (Some((p, f)), Some((q, g)), Some((r, h))) = (s.light[a], s.light[b], s.light[c])
        else {
            return;
        };
        let (d, e) = ((q - p).norm(), (r - q).norm());
        if d > 0.0 && e > 0.0 {
            let second = 2.0 * ((h - g) / e - (g - f) / d) / (d + e);
            squares = (squares.0 + second * second, squares.1 + 1);
        }
    };
    for i in 0..nu {
        for j in 0..nv {
            let k = i * nv + j;
            if i >= 1 && i + 1 < nu {
                triple(k - nv, k, k + nv);
            }
            if j >= 1 && j + 1 < nv {
                triple(k - 1, k, k + 1);
            }
        }
    }
    (squares.0 / squares.1.max(1) as f64).sqrt()
}
