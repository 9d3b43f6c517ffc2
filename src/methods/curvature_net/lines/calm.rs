//! A calmer start: the coarse net without the noise of its points.
//!
//! The way from the start may not bend, so that a net that is laid right stays
//! as it is; the noise of a measured net stays with it, and a curvature that
//! changes sign from vertex to vertex leaves umbilics everywhere. A discrete
//! smoothing spline takes it out: Σ |P − P₀|² + λ Σ |Δ³P|² with the third
//! differences Δu³, Δv³, Δu²Δv, ΔuΔv², which vanish on every quadric graph, so
//! that the shape itself is not pulled flat as Zheng & Bo's F_fair (eq. 7: second
//! differences) would.

use crate::methods::curvature_net::net::Layout;
use crate::solver::levenberg_marquardt::{Settings, minimize};
use crate::solver::{Blocks, LeastSquares, NormalEquations, Unwatched};
use nalgebra::Point3;

/// Binomials of a third, second and first difference.
const THIRD: [f64; 4] = [-1.0, 3.0, -3.0, 1.0];
const SECOND: [f64; 3] = [1.0, -2.0, 1.0];
const FIRST: [f64; 2] = [-1.0, 1.0];

/// The points of a net with their third differences weighted by `weight`.
pub(super) fn calmed(layout: Layout, points: &[Point3<f64>], weight: f64) -> Vec<Point3<f64>> {
    let problem = Calm {
        points,
        weight: weight.sqrt(),
        stencils: stencils(layout),
    };
    let mut x: Vec<f64> = points.iter().flat_map(|p| [p.x, p.y, p.z]).collect();
    let settings = Settings {
        iterations: 4,
        damping: 1e-12,
        normal_equations: NormalEquations::Sparse,
        ..Settings::default()
    };
    // A linear problem: one step, which nothing needs to stop. Without it the
    // points stay as they are.
    let _ = minimize(&problem, &mut x, &settings, &Unwatched);
    x.chunks_exact(3)
        .map(|p| Point3::new(p[0], p[1], p[2]))
        .collect()
}

struct Calm<'a> {
    points: &'a [Point3<f64>],
    weight: f64,
    stencils: Vec<(Vec<usize>, Vec<f64>)>,
}

/// Vertices and factors of every third difference of a net.
fn stencils(layout: Layout) -> Vec<(Vec<usize>, Vec<f64>)> {
    let forms: [(&[f64], &[f64]); 4] = [
        (&THIRD, &[1.0]),
        (&[1.0], &THIRD),
        (&SECOND, &FIRST),
        (&FIRST, &SECOND),
    ];
    let counts = [layout.rows, layout.columns];
    let mut all = Vec::new();
    for (along, across) in forms {
        let places = |d: usize, length: usize| {
            if length > counts[d] {
                0
            } else if layout.closed[d] {
                counts[d]
            } else {
                counts[d] + 1 - length
            }
        };
        for i in 0..places(0, along.len()) {
            for j in 0..places(1, across.len()) {
                let (mut vertices, mut factors) = (Vec::new(), Vec::new());
                for (k, a) in along.iter().enumerate() {
                    for (l, b) in across.iter().enumerate() {
                        vertices.push(layout.vertex(i + k, j + l));
                        factors.push(a * b);
                    }
                }
                all.push((vertices, factors));
            }
        }
    }
    all
}

impl LeastSquares for Calm<'_> {
    fn dimension(&self) -> usize {
        3 * self.points.len()
    }

    fn evaluate(&self, x: &[f64], blocks: &mut Blocks) {
        for (v, point) in self.points.iter().enumerate() {
            for k in 0..3 {
                blocks.push(&[x[3 * v + k] - point[k]], &[3 * v + k], &[1.0]);
            }
        }
        for (vertices, factors) in &self.stencils {
            let jacobian: Vec<f64> = factors.iter().map(|f| self.weight * f).collect();
            for k in 0..3 {
                let columns: Vec<usize> = vertices.iter().map(|v| 3 * v + k).collect();
                let terms = columns.iter().zip(&jacobian).map(|(c, j)| x[*c] * j);
                blocks.push(&[terms.sum()], &columns, &jacobian);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::derivative_check::worst_disagreement;

    fn net(noise: f64) -> (Layout, Vec<Point3<f64>>) {
        let layout = Layout {
            rows: 7,
            columns: 6,
            closed: [false, false],
        };
        let points = (0..42).map(|k| {
            let (i, j) = ((k / 6) as f64, (k % 6) as f64);
            let rough = noise * (k as f64 * 97.3).sin();
            Point3::new(i, j + 0.1 * i * j, 0.1 * i * i - 0.2 * i * j + rough)
        });
        (layout, points.collect())
    }

    #[test]
    fn a_quadric_stays_and_noise_goes() {
        let (layout, quadric) = net(0.0);
        let calm = calmed(layout, &quadric, 3.0);
        let far = |a: &[Point3<f64>], b: &[Point3<f64>]| {
            let ways = a.iter().zip(b).map(|(a, b)| (a - b).norm_squared());
            (ways.sum::<f64>() / a.len() as f64).sqrt()
        };
        assert!(far(&calm, &quadric) < 1e-9);
        let (_, noisy) = net(0.05);
        let calm = calmed(layout, &noisy, 3.0);
        let (before, after) = (far(&noisy, &quadric), far(&calm, &quadric));
        assert!(after < 0.6 * before, "{before} {after}");
    }

    #[test]
    fn derivatives_agree_with_differences() {
        let (layout, points) = net(0.05);
        let problem = Calm {
            points: &points,
            weight: 1.7,
            stencils: stencils(layout),
        };
        let x: Vec<f64> = (0..126).map(|k| (k as f64 * 1.3).sin()).collect();
        let worst = worst_disagreement(&problem, &x, 1e-6);
        assert!(worst.relative < 1e-7, "{worst:?}");
    }
}
