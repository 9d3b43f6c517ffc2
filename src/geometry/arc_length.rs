//! Arc length of a curve and its inverse, both in a few dozen operations.
//!
//! On each cell the speed `|C′|` is sampled at Gauss nodes and expanded in
//! Legendre polynomials; the integral of the expansion is the length. Cells
//! are knot spans, halved until the last coefficients are negligible, which
//! spectral convergence reaches after one or two halvings of a fair curve.
//! Evaluation is a search and one three-term recurrence; the inverse is
//! Newton's method kept inside a shrinking bracket.
//!
//! Limits: where the speed vanishes inside a span, halving stops at
//! [`MAX_HALVINGS`], with an error of the square of the last cell's width.

use super::BSplineCurve;
use crate::numerics::GaussLegendre;

/// Nodes per cell: degree 11 in the speed. Fewer need more cells, more cost
/// every evaluation.
const NODES: usize = 12;

/// The last coefficients of a cell's speed, times its width, relative to the
/// whole length. The sum over cells stays below 1e-12.
const TAIL: f64 = 1e-14;

/// Halvings of a knot span: below 2⁻⁴⁰ of it a kink of the speed contributes
/// less than rounding.
const MAX_HALVINGS: u32 = 40;

/// Newton steps of the inverse; bisection inside the bracket makes each of
/// them at least halve it, and smooth cells need three or four.
const MAX_STEPS: usize = 60;

/// The arc-length function of one curve. Lengths in the curve's unit.
#[derive(Debug, Clone, PartialEq)]
pub struct ArcLength {
    cells: Vec<Cell>,
    domain: [f64; 2],
    total: f64,
}

/// The speed on `[u, u + 2·half]` as a Legendre series, and the length so far.
#[derive(Debug, Clone, PartialEq)]
struct Cell {
    u: f64,
    half: f64,
    length_before: f64,
    length: f64,
    speed: [f64; NODES],
}

impl ArcLength {
    /// Measures a curve to about 1e-12 of its length.
    #[must_use]
    pub fn new(curve: &BSplineCurve) -> Self {
        let builder = Builder::new(curve);
        let mut cells = Vec::new();
        for piece in curve.knot_vector().breakpoints().windows(2) {
            builder.add(piece[0], piece[1], MAX_HALVINGS, &mut cells);
        }
        let mut total = 0.0;
        for cell in &mut cells {
            cell.length_before = total;
            total += cell.length;
        }
        ArcLength {
            cells,
            domain: curve.domain(),
            total,
        }
    }

    /// Length of the whole curve.
    #[must_use]
    pub fn total(&self) -> f64 {
        self.total
    }

    /// Length from the start to parameter `u` (moved into the domain).
    #[must_use]
    pub fn length_at(&self, u: f64) -> f64 {
        let u = u.clamp(self.domain[0], self.domain[1]);
        let cell = &self.cells[self.cells.partition_point(|c| c.u <= u).max(1) - 1];
        cell.length_before + cell.length_and_speed((u - cell.u) / cell.half - 1.0).0
    }

    /// The speed `|C′|` at `u`, from the table.
    #[must_use]
    pub fn speed_at(&self, u: f64) -> f64 {
        let u = u.clamp(self.domain[0], self.domain[1]);
        let cell = &self.cells[self.cells.partition_point(|c| c.u <= u).max(1) - 1];
        cell.length_and_speed((u - cell.u) / cell.half - 1.0).1 / cell.half
    }

    /// The least parameter whose length is `length` (moved into
    /// `[0, total]`). Where the curve stands still that is the start of the
    /// standstill; from `total` on it is the end of the domain.
    #[must_use]
    pub fn parameter_at(&self, length: f64) -> f64 {
        if length.is_nan() || length <= 0.0 {
            return self.domain[0];
        }
        if length >= self.total {
            return self.domain[1];
        }
        let after = self.cells.partition_point(|c| c.length_before < length);
        let cell = &self.cells[after.max(1) - 1];
        cell.u + cell.half * (1.0 + cell.solve(length - cell.length_before))
    }

    /// `n` parameters (at least 2 are given) at equal steps of length, both
    /// ends included.
    #[must_use]
    pub fn even_parameters(&self, n: usize) -> Vec<f64> {
        let last = n.max(2) - 1;
        let at = |i: usize| self.parameter_at(self.total * i as f64 / last as f64);
        let mut parameters: Vec<f64> = (0..=last).map(at).collect();
        parameters[last] = self.domain[1];
        parameters
    }
}

impl Cell {
    /// Length from the cell's start and speed times `half`, at `x` in [−1, 1].
    /// Legendre series by `(k+1) P_{k+1} = (2k+1) x P_k − k P_{k−1}`, integral
    /// by `∫ P_k = (P_{k+1} − P_{k−1})/(2k+1)`.
    fn length_and_speed(&self, x: f64) -> (f64, f64) {
        let (mut before, mut p) = (1.0, x);
        let mut speed = self.speed[0];
        let mut length = self.speed[0] * (x + 1.0);
        for (c, [grow, shrink, inverse]) in self.speed.iter().zip(&RECURRENCE).skip(1) {
            let next = grow * x * p - shrink * before;
            speed += c * p;
            length += c * (next - before) * inverse;
            (before, p) = (p, next);
        }
        // The series may leave the range by rounding; lengths must not.
        (length.clamp(0.0, self.length), speed)
    }

    /// The `x` in [−1, 1] at a length from the cell's start.
    fn solve(&self, target: f64) -> f64 {
        let (mut low, mut high) = (-1.0, 1.0);
        let mut x = if self.length > 0.0 {
            2.0 * target / self.length - 1.0
        } else {
            -1.0
        };
        for _ in 0..MAX_STEPS {
            let (length, speed) = self.length_and_speed(x);
            let error = length - target;
            if error > 0.0 {
                high = x
            } else {
                low = x
            }
            let newton = x - error / speed;
            // NaN and runaways (speed near zero) fall back on bisection.
            let next = if newton >= low && newton <= high {
                newton
            } else {
                0.5 * (low + high)
            };
            let done = (next - x).abs() <= 2.0 * f64::EPSILON;
            x = next;
            if done || error == 0.0 {
                break;
            }
        }
        x
    }
}

/// `(2k+1)/(k+1)`, `k/(k+1)` and `1/(2k+1)` for each `k`.
const RECURRENCE: [[f64; 3]; NODES] = {
    let mut table = [[0.0; 3]; NODES];
    let mut k = 0;
    while k < NODES {
        let f = k as f64;
        table[k] = [
            (2.0 * f + 1.0) / (f + 1.0),
            f / (f + 1.0),
            1.0 / (2.0 * f + 1.0),
        ];
        k += 1;
    }
    table
};

/// What building the table needs once.
struct Builder<'a> {
    curve: &'a BSplineCurve,
    nodes: Vec<f64>,
    /// `(2k+1)/2 · wᵢ · P_k(xᵢ)`: from speeds at the nodes to coefficients.
    transform: Vec<[f64; NODES]>,
    /// A rough length of the whole curve, the scale of what is negligible.
    scale: f64,
}

impl<'a> Builder<'a> {
    fn new(curve: &'a BSplineCurve) -> Self {
        let rule = GaussLegendre::new(NODES);
        let transform = rule.nodes().iter().zip(rule.weights()).map(|(x, w)| {
            let mut row = [0.0; NODES];
            let (mut before, mut p) = (0.0, 1.0);
            for k in 0..NODES {
                row[k] = (k as f64 + 0.5) * w * p;
                (before, p) = (p, RECURRENCE[k][0] * x * p - RECURRENCE[k][1] * before);
            }
            row
        });
        let transform = transform.collect();
        let scale = curve
            .control_points()
            .windows(2)
            .map(|w| (w[1] - w[0]).norm())
            .sum();
        Builder {
            curve,
            nodes: rule.nodes().to_vec(),
            transform,
            scale,
        }
    }

    /// Adds the cells of `[a, b]`.
    fn add(&self, a: f64, b: f64, halvings: u32, cells: &mut Vec<Cell>) {
        let half = 0.5 * (b - a);
        let mut speed = [0.0; NODES];
        for (x, row) in self.nodes.iter().zip(&self.transform) {
            let at_node = self.curve.derivatives(a + half * (1.0 + x)).d1.norm() * half;
            for (c, t) in speed.iter_mut().zip(row) {
                *c += t * at_node;
            }
        }
        let middle = a + half;
        let tail: f64 = speed[NODES - 2..].iter().map(|c| c.abs()).sum();
        if tail <= TAIL * self.scale.max(speed[0]) || halvings == 0 || middle <= a || middle >= b {
            cells.push(Cell {
                u: a,
                half,
                length_before: 0.0,
                length: 2.0 * speed[0],
                speed,
            });
        } else {
            self.add(a, middle, halvings - 1, cells);
            self.add(middle, b, halvings - 1, cells);
        }
    }
}

#[cfg(test)]
mod tests;
