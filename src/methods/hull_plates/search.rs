//! The best rulings between nodes of a grid: a monotone path through the
//! twist field from corner to corner.
//!
//! Wang & Tang (2005) and Liu, Tang & Gong (2011) find the best triangulated
//! strip between two sampled curves by dynamic programming over its rulings.
//! Here the same idea carries the bounds that make a plate one that a yard
//! would bend: end fans of limited sweep, and between them speeds of the two
//! ruling ends whose ratio keeps the regression curve outside the plate.
//! Without these bounds two cones with their apices in opposite corners
//! "solve" any plate.
//!
//! Two passes over the same steps: the first finds the **bottleneck** (the
//! smallest largest twist; no set of rulings between nodes within the same
//! bounds has a smaller one), the second the smoothest path not much above it.

use super::field::TwistField;
use super::task::EndSpeeds;

/// Bounds within which paths are searched, in grid cells.
#[derive(Debug, Clone)]
pub(super) struct Bounds {
    /// Cells that a fan may sweep at the start and at the end.
    pub(super) fans: [usize; 2],
    /// Largest ratio of the speeds of a ruling's two ends, either way.
    pub(super) speed_ratio: f64,
    /// Which speeds.
    pub(super) speeds: EndSpeeds,
    /// Rulings that the path must pass, as grid coordinates.
    pub(super) pins: Vec<(f64, f64)>,
}

/// A path and the largest twist on it.
#[derive(Debug, Clone)]
pub(super) struct GridPath {
    /// Nodes from start to end, grid coordinates.
    pub(super) nodes: Vec<(f64, f64)>,
    /// Largest |θ| on nodes and between them, radians.
    pub(super) bottleneck: f64,
}

/// Steps between nodes, coprime so that each slope occurs once; mixing
/// neighbours gives the slopes between them.
const STEPS: [(usize, usize); 13] = [
    (1, 1),
    (1, 2),
    (2, 1),
    (2, 3),
    (3, 2),
    (1, 3),
    (3, 1),
    (1, 4),
    (4, 1),
    (1, 6),
    (6, 1),
    (1, 8),
    (8, 1),
];

/// How far above the bottleneck the second pass may go to find a smooth path.
const SLACK: f64 = 1.005;
/// Twist, radians, that the second pass may add in any case.
const NEGLIGIBLE: f64 = 2e-4;
/// Cost of a fan's cell: below everything that a twist could weigh.
const FAN_COST: f64 = 1e-9;
/// Share of mean-square twist against which straightness is weighed.
const STRAIGHTNESS: f64 = 1e-6;

/// The best path, or `None` when the bounds leave none (contradicting pins).
pub(super) fn best_path(field: &TwistField, bounds: &Bounds) -> Option<GridPath> {
    let grid = Grid {
        field,
        bounds,
        cap: f64::INFINITY,
    };
    let bottleneck = grid
        .sweep(|_| 0.0, |before, _, twist| before.max(twist))?
        .value;
    let cap = bottleneck * SLACK + NEGLIGIBLE;
    // A fan is taken only where nothing else decides.
    let fan_cost = |cells: usize| FAN_COST * cells as f64;
    let smooth = Grid { field, bounds, cap }.sweep(fan_cost, |before, step, twist| {
        let cells = (step.0 + step.1) as f64;
        let lead = step.0 as f64 - step.1 as f64;
        // The start is a step over no cells.
        before + cells * twist * twist + STRAIGHTNESS * lead * lead / cells.max(1.0)
    })?;
    Some(GridPath {
        nodes: smooth.nodes,
        bottleneck,
    })
}

/// The bottleneck alone, for the certificate on a finer grid. Nodes above
/// `known`, the largest twist of rulings already found, are left out: they
/// cannot lie on a better path.
pub(super) fn bottleneck(field: &TwistField, bounds: &Bounds, known: f64) -> Option<f64> {
    let grid = Grid {
        field,
        bounds,
        cap: known,
    };
    grid.sweep(|_| 0.0, |before, _, twist| before.max(twist))
        .map(|s| s.value)
}

struct Grid<'a> {
    field: &'a TwistField,
    bounds: &'a Bounds,
    /// Twist that no step may exceed.
    cap: f64,
}

struct Sweep {
    value: f64,
    nodes: Vec<(f64, f64)>,
}

const UNREACHED: u8 = u8::MAX;
const START: u8 = u8::MAX - 1;

impl Grid<'_> {
    /// Dynamic programming over all nodes; `join(value so far, step, largest
    /// twist of the step)` gives the value behind the step, `fan_cost` that of
    /// the cells left to a fan.
    fn sweep(
        &self,
        fan_cost: impl Fn(usize) -> f64,
        join: impl Fn(f64, (usize, usize), f64) -> f64,
    ) -> Option<Sweep> {
        let (rows, columns) = (self.field.rows(), self.field.columns());
        let mut values = vec![f64::INFINITY; rows * columns];
        let mut steps = vec![UNREACHED; rows * columns];
        let mut best: Option<(f64, usize, usize)> = None;
        for i in 0..rows {
            for j in 0..columns {
                if !self.is_open(i, j) {
                    continue;
                }
                let here = i * columns + j;
                if self.is_start(i, j) {
                    values[here] = join(fan_cost(i + j), (0, 0), self.field.at(i, j).abs());
                    steps[here] = START;
                } else {
                    self.relax(i, j, &mut values, &mut steps, &join);
                }
                let left = rows - 1 - i + columns - 1 - j;
                let value = values[here] + fan_cost(left);
                if self.is_end(i, j) && best.is_none_or(|(b, _, _)| value < b) && value.is_finite()
                {
                    best = Some((value, i, j));
                }
            }
        }
        let (value, i, j) = best?;
        Some(Sweep {
            value,
            nodes: self.trace(&steps, i, j),
        })
    }

    fn relax(
        &self,
        i: usize,
        j: usize,
        values: &mut [f64],
        steps: &mut [u8],
        join: &impl Fn(f64, (usize, usize), f64) -> f64,
    ) {
        let columns = self.field.columns();
        let here = i * columns + j;
        for (k, &(a, b)) in STEPS.iter().enumerate() {
            if a > i || b > j {
                continue;
            }
            let from = values[(i - a) * columns + j - b];
            if from >= values[here] || self.is_end(i - a, j - b) || !self.speeds_allow(i, j, (a, b))
            {
                continue;
            }
            let twist = self.largest_twist(i, j, (a, b));
            if twist > self.cap {
                continue;
            }
            let value = join(from, (a, b), twist);
            if value < values[here] {
                values[here] = value;
                steps[here] = k as u8;
            }
        }
    }

    /// Whether a step's slope keeps the regression curve outside at its end.
    fn speeds_allow(&self, i: usize, j: usize, (a, b): (usize, usize)) -> bool {
        let across = match self.bounds.speeds {
            EndSpeeds::AcrossTheRuling => self.field.ratio(i, j),
            EndSpeeds::AlongTheCurves => 1.0,
        };
        let ratio = across * a as f64 / b as f64;
        // A hair of room, so that a slope exactly at the bound is allowed.
        let limit = self.bounds.speed_ratio * (1.0 + 1e-9);
        ratio <= limit && ratio * limit >= 1.0
    }

    /// Largest |θ| at the step's end and between its nodes.
    fn largest_twist(&self, i: usize, j: usize, (a, b): (usize, usize)) -> f64 {
        let pieces = a.max(b);
        let mut largest = self.field.at(i, j).abs();
        for k in 1..pieces {
            let back = k as f64 / pieces as f64;
            let row = i as f64 - back * a as f64;
            largest = largest.max(self.field.between(row, j as f64 - back * b as f64));
        }
        largest
    }

    fn is_start(&self, i: usize, j: usize) -> bool {
        let fan = self.bounds.fans[0];
        (i == 0 && j <= fan) || (j == 0 && i <= fan)
    }

    fn is_end(&self, i: usize, j: usize) -> bool {
        let fan = self.bounds.fans[1];
        let (last_i, last_j) = (self.field.rows() - 1, self.field.columns() - 1);
        (i == last_i && j + fan >= last_j) || (j == last_j && i + fan >= last_i)
    }

    /// Whether a node may carry a ruling: below the cap and not across a pin.
    fn is_open(&self, i: usize, j: usize) -> bool {
        let (s, t) = (i as f64, j as f64);
        let crosses = |&(ps, pt): &(f64, f64)| {
            (s < ps - 1.0 && t > pt + 1.0) || (s > ps + 1.0 && t < pt - 1.0)
        };
        self.field.at(i, j).abs() <= self.cap && !self.bounds.pins.iter().any(crosses)
    }

    fn trace(&self, steps: &[u8], mut i: usize, mut j: usize) -> Vec<(f64, f64)> {
        let mut nodes = vec![(i as f64, j as f64)];
        while let Some(&(a, b)) = STEPS.get(steps[i * self.field.columns() + j] as usize) {
            i -= a;
            j -= b;
            nodes.push((i as f64, j as f64));
        }
        nodes.reverse();
        nodes
    }
}
