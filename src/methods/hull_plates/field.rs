//! The twist of every possible ruling: θ(s, t) between the point at arc-length
//! fraction `s` of one profile and the point at fraction `t` of the other, on
//! a grid. Its zero set explains a plate; paths through it are rulings.

use super::profile::Jet;
use super::twist::twist_angle;
use nalgebra::Vector3;

/// θ and the ratio of crossing speeds on a grid of rulings.
#[derive(Debug, Clone)]
pub(super) struct TwistField {
    rows: usize,
    columns: usize,
    /// Signed twist, radians, `[row * columns + column]`.
    twist: Vec<f64>,
    /// |L×D₁′| / |L×D₂′| for equal speeds ds = dt.
    speed_ratio: Vec<f64>,
}

/// Rulings shorter than this share of the model have no direction worth a
/// twist: the two profiles meet there.
pub(super) const SHORTEST_RULING: f64 = 1e-6;

impl TwistField {
    /// The field between samples of two profiles in unit scale, derivatives
    /// with respect to arc-length fraction.
    pub(super) fn new(first: &[Jet], second: &[Jet]) -> Self {
        let (rows, columns) = (first.len(), second.len());
        let mut twist = Vec::with_capacity(rows * columns);
        let mut speed_ratio = Vec::with_capacity(rows * columns);
        for a in first {
            for b in second {
                let l = b.point - a.point;
                let (angle, ratio) = if l.norm() < SHORTEST_RULING {
                    (0.0, 1.0)
                } else {
                    (
                        twist_angle(&l, &a.d1, &b.d1),
                        crossing_ratio(&l, &a.d1, &b.d1),
                    )
                };
                twist.push(angle);
                speed_ratio.push(ratio);
            }
        }
        TwistField {
            rows,
            columns,
            twist,
            speed_ratio,
        }
    }

    pub(super) fn rows(&self) -> usize {
        self.rows
    }

    pub(super) fn columns(&self) -> usize {
        self.columns
    }

    /// Signed twist at a node, radians.
    pub(super) fn at(&self, row: usize, column: usize) -> f64 {
        self.twist[row * self.columns + column]
    }

    /// |L×D₁′| / |L×D₂′| at a node.
    pub(super) fn ratio(&self, row: usize, column: usize) -> f64 {
        self.speed_ratio[row * self.columns + column]
    }

    /// |θ| between nodes, by bilinear interpolation of the signed twist.
    pub(super) fn between(&self, row: f64, column: f64) -> f64 {
        let i = (row as usize).min(self.rows - 2);
        let j = (column as usize).min(self.columns - 2);
        let (a, b) = (row - i as f64, column - j as f64);
        let k = i * self.columns + j;
        let t = &self.twist;
        let corners = [t[k], t[k + 1], t[k + self.columns], t[k + self.columns + 1]];
        let (low, high) = corners
            .iter()
            .fold((f64::MAX, f64::MIN), |(l, h), c| (l.min(*c), h.max(*c)));
        if high - low > std::f64::consts::PI {
            // The angle wraps around within this cell: no way through.
            return high.max(-low);
        }
        let near = t[k] + b * (t[k + 1] - t[k]);
        let far = t[k + self.columns] + b * (t[k + self.columns + 1] - t[k + self.columns]);
        (near + a * (far - near)).abs()
    }
}

fn crossing_ratio(l: &Vector3<f64>, d1: &Vector3<f64>, d2: &Vector3<f64>) -> f64 {
    let second = l.cross(d2).norm();
    if second > 0.0 {
        l.cross(d1).norm() / second
    } else {
        f64::INFINITY
    }
}
