//! The best places of the joints for every number of patches at once: a cone
//! fitted to every run of stations along the best developable, then dynamic
//! programming over the runs (Bellman 1961).
//!
//! Neighbours need not meet here, so the sums bound from below what a chain
//! with joints at stations can reach, and say where its joints should begin.

use super::chain::{Chain, Part};
use super::engine::Fitted;
use super::problem::{Freedom, Points, Problem};
use crate::geometry::cone::{Foot, Frame, Strain};
use crate::methods::Control;
use crate::solver::levenberg_marquardt::{Settings, minimize};
use crate::solver::{LeastSquares, Stop};
use nalgebra::Point3;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Points across each station, with the weights of Simpson's rule.
const ACROSS: [(f64, f64); 3] = [(0.0, 1.0 / 6.0), (0.5, 4.0 / 6.0), (1.0, 1.0 / 6.0)];
/// Steps of the fit of a run, which starts from the run shorter by one.
const STEPS: usize = 5;
/// End of such a fit: only the order of the costs matters.
const REDUCTION: f64 = 3e-2;
/// Costs below this square of the unit length are rounding; without it ties
/// between exact runs would be broken by noise.
const ROUNDING: f64 = 1e-26;

/// The best developable, sampled along itself. Cell i lies between station i
/// and i + 1; two cells to a patch.
#[derive(Debug, Clone)]
pub(super) struct Stations {
    /// On the base line.
    frames: Vec<Frame>,
    /// From each station to the next, with the arc.
    strains: Vec<Strain>,
    lengths: Vec<f64>,
    /// Across, three to a station.
    points: Vec<Point3<f64>>,
    /// Areas that the points stand for.
    weights: Vec<f64>,
}

/// A run of stations with its cone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Run {
    /// The cone.
    part: Part,
    /// Weighted sum of squared distances.
    sum: f64,
    /// Largest distance.
    max: f64,
}

/// What the dynamic programme makes small.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Aim {
    /// The sum of squares.
    Sum,
    /// The largest distance.
    Max,
}

/// Where the joints lie: station indices, the ends included.
pub(super) type Joints = Vec<usize>;

/// The fits of all runs, and the best division into any number of them.
#[derive(Debug, Clone)]
pub(super) struct Segments {
    stations: Stations,
    /// `runs[i][j − i − 1]`: from station i to j.
    runs: Vec<Vec<Run>>,
    /// Cell of each point of the sample.
    cells: Vec<u32>,
    /// Divisions by aim, then by number of patches − 1.
    best: [Vec<(f64, Joints)>; 2],
}

impl Stations {
    /// Stations at the joints and in the middle of the patches of a chain.
    pub(super) fn along(floor: &Fitted) -> Self {
        let chain = &floor.chain;
        let frames = chain.frames();
        let width = mean_width(&floor.lambda);
        let mut stations = Stations {
            frames: Vec::new(),
            strains: Vec::new(),
            lengths: Vec::new(),
            points: Vec::new(),
            weights: Vec::new(),
        };
        for (i, frame) in frames.iter().enumerate() {
            let (strain, [low, high]) = (chain.strains[i], chain.reach[i]);
            let mut lambda = floor.lambda[i];
            if lambda[1] - lambda[0] < 0.1 * width {
                lambda = [-0.5 * width, 0.5 * width];
            }
            let half = 0.5 * (high - low);
            let last = i + 1 == frames.len();
            for step in 0..2 + usize::from(last) {
                let at = frame.carried(strain, low + half * step as f64);
                stations.add(at, strain, lambda, half);
            }
        }
        stations
    }

    fn add(&mut self, frame: Frame, strain: Strain, [low, high]: [f64; 2], length: f64) {
        self.frames.push(frame);
        self.strains.push(strain);
        self.lengths.push(length);
        for (share, weight) in ACROSS {
            let lambda = low + share * (high - low);
            self.points.push(frame.at(lambda));
            let area = weight * length * (high - low) * strain.speed(lambda).max(0.1);
            self.weights.push(area);
        }
    }

    /// The patch between two stations that turns and bends by as much as the
    /// developable does there. Its rulings at both ends then fit those of the
    /// neighbours, which a cone fitted by itself does not.
    fn averaged(&self, [i, j]: [usize; 2]) -> Part {
        let (mut turn, mut bend, mut length, mut offset) = (0.0, 0.0, 0.0, 0.0);
        for c in i..j {
            let (strain, cell) = (self.strains[c], self.lengths[c]);
            let end = self.frames[c].carried(strain, cell);
            turn += strain.g * cell;
            bend += strain.k * cell;
            // On the base line of the first station.
            length += cell * strain.speed(-offset).max(0.1);
            let next = &self.frames[c + 1];
            offset += (next.point - end.point).dot(&end.ruling);
        }
        Part {
            frame: self.frames[i],
            strain: Strain {
                g: turn / length,
                k: bend / length,
            },
            arc: [0.0, length],
            base: 0.5 * offset,
            shared: [0.0, offset],
        }
    }

    /// Number of cells.
    fn cells(&self) -> usize {
        self.frames.len() - 1
    }

    /// Fits a cone to the stations from i to j, starting from another.
    fn fit(&self, [i, j]: [usize; 2], start: (Frame, Strain)) -> Run {
        let range = ACROSS.len() * i..ACROSS.len() * (j + 1);
        let points = &self.points[range.clone()];
        let part = self.part([i, j], start);
        let chain = Chain::link(&[part]);
        let lambda = lambda_range(&chain, points);
        let homes = vec![0; points.len()];
        let sample = Points {
            points,
            weights: &self.weights[range],
            homes: &homes,
        };
        let freedom = Freedom::full(1);
        let problem = Problem::new(&chain, sample, &lambda, &freedom);
        let mut x = vec![0.0; problem.dimension()];
        let settings = Settings {
            iterations: STEPS,
            gradient: 1e-32,
            step: 1e-12,
            reduction: REDUCTION,
            damping: 1e-4,
            least_scale: super::engine::LEAST_SCALE,
            ..Settings::default()
        };
        // Short: the caller asks the control between runs.
        let _ = minimize(&problem, &mut x, &settings, &crate::solver::Unwatched);
        let fitted = problem.chain(&x);
        let part = self.part([i, j], (fitted.root, fitted.strains[0]));
        self.judged(part, &sample)
    }

    /// A part with its arcs, base line and shared points from its stations.
    fn part(&self, [i, j]: [usize; 2], (frame, strain): (Frame, Strain)) -> Part {
        let foot = |station: usize| {
            let point = &self.frames[station].point;
            Foot::of(point, &frame, strain, 0.0)
        };
        let (a, b) = (foot(i), foot(j));
        // A run of more than half a turn: the arc grows along the run.
        let turn = TAU / strain.rate();
        let end = if b.arc < a.arc { b.arc + turn } else { b.arc };
        Part {
            frame,
            strain,
            arc: [a.arc, end],
            base: 0.5 * (a.lambda + b.lambda),
            shared: [a.lambda, b.lambda],
        }
    }

    fn judged(&self, part: Part, sample: &Points) -> Run {
        let (mut sum, mut max) = (ROUNDING, 0.0_f64);
        for (point, weight) in sample.points.iter().zip(sample.weights) {
            let d = Foot::of(point, &part.frame, part.strain, 0.0).distance;
            sum += weight * d * d;
            max = max.max(d.abs());
        }
        Run { part, sum, max }
    }

    /// All runs that begin at a station.
    fn runs_from(&self, i: usize, control: &dyn Control) -> Result<Vec<Run>, Stop> {
        control.check()?;
        let first = self.frames[i];
        let (a, b) = (&self.frames[i], &self.frames[i + 1]);
        let mut start = (first, super::floor::between(a, b).strain);
        let mut runs = Vec::with_capacity(self.cells() - i);
        for j in i + 1..=self.cells() {
            let run = self.fit([i, j], start);
            let middle = 0.5 * (run.part.arc[0] + run.part.arc[1]);
            start = (
                run.part.frame.carried(run.part.strain, middle),
                run.part.strain,
            );
            runs.push(run);
        }
        Ok(runs)
    }
}

/// Mean of the widths of the patches that hold points.
fn mean_width(lambda: &[[f64; 2]]) -> f64 {
    let widths: Vec<f64> = lambda
        .iter()
        .map(|[a, b]| b - a)
        .filter(|w| *w > 0.0)
        .collect();
    widths.iter().sum::<f64>() / widths.len().max(1) as f64
}

fn lambda_range(chain: &Chain, points: &[Point3<f64>]) -> Vec<[f64; 2]> {
    let wide = |[low, high]: [f64; 2], p: &Point3<f64>| {
        let lambda = Foot::of(p, &chain.root, chain.strains[0], 0.0).lambda;
        [low.min(lambda), high.max(lambda)]
    };
    vec![points.iter().fold([f64::INFINITY, f64::NEG_INFINITY], wide)]
}

impl Segments {
    /// Fits all runs and divides into 1, 2, … `most` patches.
    ///
    /// # Errors
    /// When the control says so.
    pub(super) fn new(floor: &Fitted, most: usize, control: &dyn Control) -> Result<Self, Stop> {
        let stations = Stations::along(floor);
        let runs = (0..stations.cells())
            .into_par_iter()
            .map(|i| stations.runs_from(i, control))
            .collect::<Result<Vec<_>, Stop>>()?;
        let most = most.min(stations.cells());
        let cells = floor.cells.clone();
        let best = [Aim::Sum, Aim::Max].map(|aim| divisions(&runs, aim, most));
        Ok(Segments {
            stations,
            runs,
            cells,
            best,
        })
    }

    /// The most patches that stations allow.
    pub(super) fn most(&self) -> usize {
        self.best[0].len()
    }

    /// The value of the best division into so many patches.
    pub(super) fn value(&self, aim: Aim, patches: usize) -> f64 {
        self.best[aim as usize][patches - 1].0
    }

    /// The chain that the best division begins from, and the patch of each
    /// point.
    pub(super) fn chain(&self, aim: Aim, patches: usize, averaged: bool) -> (Chain, Vec<u32>) {
        let joints = &self.best[aim as usize][patches - 1].1;
        let part = |pair: &[usize]| {
            if averaged {
                self.stations.averaged([pair[0], pair[1]])
            } else {
                self.runs[pair[0]][pair[1] - pair[0] - 1].part
            }
        };
        let parts: Vec<Part> = joints.windows(2).map(part).collect();
        let home = |cell: &u32| joints[1..patches].partition_point(|j| *j <= *cell as usize) as u32;
        (Chain::link(&parts), self.cells.iter().map(home).collect())
    }
}

/// Best divisions of all stations into 1, 2, … `most` runs.
fn divisions(runs: &[Vec<Run>], aim: Aim, most: usize) -> Vec<(f64, Joints)> {
    let cells = runs.len();
    let cost = |i: usize, j: usize| {
        let run = &runs[i][j - i - 1];
        match aim {
            Aim::Sum => run.sum,
            Aim::Max => run.max,
        }
    };
    let join = |a: f64, b: f64| match aim {
        Aim::Sum => a + b,
        Aim::Max => a.max(b),
    };
    // Per number of runs: the value up to station j, and the last joint.
    let mut table: Vec<Vec<(f64, usize)>> = Vec::with_capacity(most);
    let first = |j: usize| {
        if j == 0 {
            (f64::INFINITY, 0)
        } else {
            (cost(0, j), 0)
        }
    };
    table.push((0..=cells).map(first).collect());
    for count in 1..most {
        let before = &table[count - 1];
        let best = |j: usize| {
            (count..j)
                .map(|i| (join(before[i].0, cost(i, j)), i))
                .min_by(|a, b| a.0.total_cmp(&b.0))
                .unwrap_or((f64::INFINITY, 0))
        };
        table.push((0..=cells).map(best).collect());
    }
    let trace = |count: usize| {
        let mut joints = vec![cells];
        let mut at = cells;
        for row in table[..=count].iter().rev() {
            at = row[at].1;
            joints.push(at);
        }
        joints.reverse();
        (table[count][cells].0, joints)
    };
    (0..most).map(trace).collect()
}
