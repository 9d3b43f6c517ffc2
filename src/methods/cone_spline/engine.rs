//! Fits a chain to points: the loop around the solver.

use super::chain::{Chain, Placed};
use super::problem::{Freedom, Points, Problem, SHORTEST};
use crate::geometry::cone::Foot;
use crate::methods::Control;
use crate::solver::Stop;
use crate::solver::levenberg_marquardt::{Settings, minimize};
use nalgebra::Point3;
use rayon::prelude::*;

/// Points of a strip in unit scale, weights adding up to 1.
#[derive(Debug, Clone)]
pub(super) struct Sample {
    pub(super) points: Vec<Point3<f64>>,
    pub(super) weights: Vec<f64>,
}

/// A chain with the place of every point of a sample on it.
#[derive(Debug, Clone)]
pub(super) struct Fitted {
    pub(super) chain: Chain,
    /// The patch of each point.
    pub(super) homes: Vec<u32>,
    /// Twice the patch of each point, and one more in its second half.
    pub(super) cells: Vec<u32>,
    /// Least and largest λ of each patch's points.
    pub(super) lambda: Vec<[f64; 2]>,
    /// Signed distance of each point.
    pub(super) distances: Vec<f64>,
    /// Iterations so far.
    pub(super) iterations: usize,
    /// Why the last minimisation ended.
    pub(super) termination: &'static str,
}

/// How hard to try.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Effort {
    /// Most steps.
    pub(super) iterations: usize,
    /// End when the cost falls by less than this share.
    pub(super) reduction: f64,
    /// Weight of the squared differences of neighbouring strains.
    pub(super) smoothing: f64,
}

impl Effort {
    /// To a minimum.
    pub(super) const FULL: Effort = Effort {
        iterations: 60,
        reduction: 1e-7,
        smoothing: 0.0,
    };
    /// Between two changes of the weights.
    pub(super) const STEP: Effort = Effort {
        iterations: 3,
        reduction: 1e-2,
        smoothing: 0.0,
    };
}

/// Unknowns that the points hardly see: the g of a plane. See
/// [`Settings::least_scale`].
pub(super) const LEAST_SCALE: f64 = 1e-7;
/// Least 1 + gλ of a patch that can be rolled: so much nearer to the apex than
/// the middle is an end of a ruling.
const SLOWEST: f64 = 0.01;
/// Damping at the start: strains are known to a few percent.
const DAMPING: f64 = 1e-3;

impl Sample {
    /// Some of the points, weights adding up to 1 again.
    pub(super) fn only(&self, kept: &[usize]) -> Sample {
        let total: f64 = kept.iter().map(|i| self.weights[*i]).sum();
        Sample {
            points: kept.iter().map(|i| self.points[*i]).collect(),
            weights: kept.iter().map(|i| self.weights[*i] / total).collect(),
        }
    }

    /// Largest |distance|, mean and root mean square.
    pub(super) fn figures(&self, distances: &[f64]) -> [f64; 3] {
        let max = distances.iter().fold(0.0_f64, |m, d| m.max(d.abs()));
        let weighted = || self.weights.iter().zip(distances);
        let mean: f64 = weighted().map(|(w, d)| w * d.abs()).sum();
        let square: f64 = weighted().map(|(w, d)| w * d * d).sum();
        [max, mean, square.sqrt()]
    }
}

impl Fitted {
    /// Largest distance.
    pub(super) fn max(&self) -> f64 {
        self.distances.iter().fold(0.0_f64, |m, d| m.max(d.abs()))
    }

    /// Root mean square distance by the sample's weights.
    pub(super) fn rms(&self, sample: &Sample) -> f64 {
        sample.figures(&self.distances)[2]
    }

    /// The root mean square, or infinity for a chain that nobody can roll: a
    /// patch without points has run out of the strip, and one that holds its
    /// apex is no plate.
    pub(super) fn worth(&self, sample: &Sample) -> f64 {
        let is_empty = |[low, high]: &[f64; 2]| low >= high;
        let speeds = self.lambda.iter().zip(&self.chain.strains);
        let slowest = speeds
            .flat_map(|(range, strain)| range.map(|l| strain.speed(l)))
            .fold(f64::INFINITY, f64::min);
        let rms = self.rms(sample);
        if self.lambda.iter().any(is_empty) || slowest < SLOWEST || !rms.is_finite() {
            f64::INFINITY
        } else {
            rms
        }
    }

    /// The same surface with its worst patch cut in two: the one that adds
    /// most to the squares.
    pub(super) fn split_at_worst(&self, sample: &Sample) -> Fitted {
        let mut sums = vec![0.0; self.chain.len()];
        for ((home, w), d) in self.homes.iter().zip(&sample.weights).zip(&self.distances) {
            sums[*home as usize] += w * d * d;
        }
        let worst = (0..sums.len()).max_by(|a, b| sums[*a].total_cmp(&sums[*b]));
        let worst = worst.unwrap_or(0);
        let after = |home: &u32| home + u32::from(*home as usize > worst);
        let homes: Vec<u32> = self.homes.iter().map(after).collect();
        Fitted::settle(sample, &self.chain.split(worst), &homes)
    }

    /// Finds the points on a chain, each starting from a patch, and moves the
    /// base lines to their middle.
    pub(super) fn settle(sample: &Sample, chain: &Chain, homes: &[u32]) -> Self {
        let placed = Placed::new(chain);
        let place = |(point, home): (&Point3<f64>, &u32)| {
            let (patch, foot) = placed.foot(point, *home as usize);
            (patch as u32, foot)
        };
        let feet: Vec<_> = sample.points.par_iter().zip(homes).map(place).collect();
        let mut lambda = vec![[f64::INFINITY, f64::NEG_INFINITY]; chain.len()];
        let mut chain = chain.clone();
        let last = chain.len() - 1;
        let mut ends = [f64::INFINITY, f64::NEG_INFINITY];
        for (patch, foot) in &feet {
            let range = &mut lambda[*patch as usize];
            *range = [range[0].min(foot.lambda), range[1].max(foot.lambda)];
            if *patch == 0 {
                ends[0] = ends[0].min(foot.arc);
            }
            if *patch as usize == last {
                ends[1] = ends[1].max(foot.arc);
            }
        }
        // A patch without points keeps its base line and its ends.
        for range in lambda.iter_mut().filter(|r| r[0] > r[1]) {
            *range = [0.0; 2];
        }
        if ends[0] + SHORTEST < chain.reach[0][1] {
            chain.reach[0][0] = ends[0];
        }
        if ends[1] > chain.reach[last][0] + SHORTEST {
            chain.reach[last][1] = ends[1];
        }
        let cell = |(patch, foot): &(u32, Foot)| {
            let [low, high] = chain.reach[*patch as usize];
            2 * patch + u32::from(foot.arc > 0.5 * (low + high))
        };
        let cells = feet.iter().map(cell).collect();
        let centres: Vec<f64> = lambda.iter().map(|[a, b]| 0.5 * (a + b)).collect();
        for (i, range) in lambda.iter_mut().enumerate() {
            *range = range.map(|l| l - centres[i]);
        }
        Fitted {
            chain: chain.rebased(&centres),
            homes: feet.iter().map(|(patch, _)| *patch).collect(),
            lambda,
            cells,
            distances: feet.iter().map(|(_, foot)| foot.distance).collect(),
            iterations: 0,
            termination: "not-needed",
        }
    }

    /// The same without knowing where the points lie.
    pub(super) fn settle_anew(sample: &Sample, chain: &Chain) -> Self {
        let homes = super::distances::homes(chain, &sample.points);
        let homes: Vec<u32> = homes.iter().map(|h| h.patch as u32).collect();
        Fitted::settle(sample, chain, &homes)
    }

    /// Minimises Σ w d² from here, w the sample's weights.
    ///
    /// # Errors
    /// When the control says so.
    pub(super) fn relaxed(
        &self,
        sample: &Sample,
        freedom: &Freedom,
        effort: Effort,
        control: &dyn Control,
    ) -> Result<Fitted, Stop> {
        self.weighted(sample, &sample.weights, (freedom, effort), control)
    }

    /// The same with other weights.
    pub(super) fn weighted(
        &self,
        sample: &Sample,
        weights: &[f64],
        (freedom, effort): (&Freedom, Effort),
        control: &dyn Control,
    ) -> Result<Fitted, Stop> {
        let points = Points {
            points: &sample.points,
            weights,
            homes: &self.homes,
        };
        let mut problem = Problem::new(&self.chain, points, &self.lambda, freedom);
        problem.smoothing = effort.smoothing;
        let settings = Settings {
            iterations: effort.iterations,
            gradient: 1e-32,
            step: 1e-15,
            reduction: effort.reduction,
            damping: DAMPING,
            least_scale: LEAST_SCALE,
            ..Settings::default()
        };
        let mut x = vec![0.0; crate::solver::LeastSquares::dimension(&problem)];
        let report = minimize(&problem, &mut x, &settings, control)?;
        let mut fitted = Fitted::settle(sample, &problem.chain(&x), &self.homes);
        fitted.iterations = self.iterations + report.iterations;
        fitted.termination = report.termination.as_str();
        Ok(fitted)
    }
}
