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
    /// What all weights together stand for.
    pub(super) area: f64,
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
    /// Least and largest λ that must lie before a patch's apex: of its points
    /// and of its neighbours' points next to the joints, whose rulings are its
    /// own too.
    before_apex: Vec<[f64; 2]>,
    /// Area that the points of each patch take up on it.
    covered: Vec<f64>,
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
    /// What lies within this distance hardly counts.
    pub(super) allowed: f64,
    /// Powers of the distances, instead of their squares, are summed up.
    pub(super) power: Option<f64>,
    /// Least 1 + gλ, where it is to be more than a roll asks for.
    pub(super) slowest: Option<f64>,
}

impl Effort {
    /// To a minimum.
    pub(super) const FULL: Effort = Effort {
        iterations: 60,
        reduction: 1e-7,
        smoothing: 0.0,
        allowed: 0.0,
        power: None,
        slowest: None,
    };
}

/// Unknowns that the points hardly see: the g of a plane. See
/// [`Settings::least_scale`].
pub(super) const LEAST_SCALE: f64 = 1e-7;
/// Least 1 + gλ of a patch that can be rolled: so much nearer to the apex than
/// the middle is an end of a ruling.
const SLOWEST: f64 = 0.01;
/// The area of a patch's points and what they take up on it differ by less
/// than this factor …
const ASTRAY: f64 = 2.5;
/// … and this share of the strip, for patches of few points.
const LITTLE: f64 = 0.02;
/// Damping at the start: strains are known to a few percent.
const DAMPING: f64 = 1e-3;

impl Sample {
    /// Some of the points, weights adding up to 1 again.
    pub(super) fn only(&self, kept: &[usize]) -> Sample {
        let total: f64 = kept.iter().map(|i| self.weights[*i]).sum();
        Sample {
            points: kept.iter().map(|i| self.points[*i]).collect(),
            weights: kept.iter().map(|i| self.weights[*i] / total).collect(),
            area: self.area,
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

    /// Largest distance of the points that have a hold on the shape.
    pub(super) fn max_held(&self, sample: &Sample) -> f64 {
        let held = sample.weights.iter().zip(&self.distances);
        let held = held.filter(|(w, _)| **w > 0.0);
        held.fold(0.0_f64, |m, (_, d)| m.max(d.abs()))
    }

    /// Root mean square distance by the sample's weights.
    pub(super) fn rms(&self, sample: &Sample) -> f64 {
        sample.figures(&self.distances)[2]
    }

    /// The root mean square, or infinity for a chain that nobody can roll: a
    /// patch without points has run out of the strip, one that holds its apex
    /// is no plate, and one whose points take up much more or less of it than
    /// of the strip lies elsewhere, or holds the strip folded.
    pub(super) fn worth(&self, sample: &Sample) -> f64 {
        let is_empty = |[low, high]: &[f64; 2]| low >= high;
        if self.lambda.iter().any(is_empty) || self.holds_an_apex() || self.is_astray(sample) {
            return f64::INFINITY;
        }
        Some(self.rms(sample))
            .filter(|r| r.is_finite())
            .unwrap_or(f64::INFINITY)
    }

    /// Whether the rulings of a patch reach its apex.
    pub(super) fn holds_an_apex(&self) -> bool {
        let speeds = self.before_apex.iter().zip(&self.chain.strains);
        let mut all = speeds.flat_map(|(range, strain)| range.map(|l| strain.speed(l)));
        // Not a number is no speed.
        !all.all(|speed| speed >= SLOWEST)
    }

    /// Whether the area of a patch's points differs much from what they take
    /// up on it.
    fn is_astray(&self, sample: &Sample) -> bool {
        let mut areas = vec![0.0; self.chain.len()];
        for (home, weight) in self.homes.iter().zip(&sample.weights) {
            areas[*home as usize] += weight * sample.area;
        }
        let little = LITTLE * sample.area;
        let differ = |(a, b): (&f64, &f64)| a.max(*b) > ASTRAY * a.min(*b) + little;
        areas.iter().zip(&self.covered).any(differ)
    }

    /// Patches by what they add to the squares, most first.
    pub(super) fn worst(&self, sample: &Sample) -> Vec<usize> {
        let mut sums = vec![0.0; self.chain.len()];
        for ((home, w), d) in self.homes.iter().zip(&sample.weights).zip(&self.distances) {
            sums[*home as usize] += w * d * d;
        }
        let mut order: Vec<usize> = (0..sums.len()).collect();
        order.sort_by(|a, b| sums[*b].total_cmp(&sums[*a]));
        order
    }

    /// The same surface with a patch cut in two.
    pub(super) fn split(&self, sample: &Sample, patch: usize) -> Fitted {
        let after = |home: &u32| home + u32::from(*home as usize > patch);
        let homes: Vec<u32> = self.homes.iter().map(after).collect();
        Fitted::settle(sample, &self.chain.split(patch), &homes)
    }

    /// A patch and the next made one.
    pub(super) fn merged(&self, sample: &Sample, patch: usize) -> Fitted {
        let after = |home: &u32| home - u32::from(*home as usize > patch);
        let homes: Vec<u32> = self.homes.iter().map(after).collect();
        Fitted::settle(sample, &self.chain.merged(patch), &homes)
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
        let mut lambda = vec![NOTHING; chain.len()];
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
        let strips = Strips::new(&feet, &chain);
        let covered = strips.areas(&chain);
        let mut before_apex = strips.with_neighbours(&chain, &lambda);
        let centres: Vec<f64> = lambda.iter().map(|[a, b]| 0.5 * (a + b)).collect();
        for (i, range) in lambda.iter_mut().enumerate() {
            *range = range.map(|l| l - centres[i]);
            before_apex[i] = before_apex[i].map(|l| l - centres[i]);
        }
        Fitted {
            chain: chain.rebased(&centres),
            homes: feet.iter().map(|(patch, _)| *patch).collect(),
            lambda,
            cells,
            before_apex,
            covered,
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
        let mut problem = Problem::new(&self.chain, points, &self.before_apex, freedom);
        problem.smoothing = effort.smoothing;
        problem.allowed = effort.allowed;
        problem.power = effort.power.map(|p| (p, self.max_held(sample)));
        problem.slowest = effort.slowest.unwrap_or(problem.slowest);
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

/// No range yet.
const NOTHING: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];

fn is_something([low, high]: &[f64; 2]) -> bool {
    low <= high
}

/// The range of both.
fn union(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0].min(b[0]), a[1].max(b[1])]
}

/// Every patch cut across into strips, with the range of λ of the points in
/// each.
struct Strips(Vec<Vec<[f64; 2]>>);

impl Strips {
    fn new(feet: &[(u32, Foot)], chain: &Chain) -> Self {
        /// Strips of a patch at most.
        const MOST: usize = 8;
        /// Points that tell how wide a strip is.
        const ENOUGH: usize = 4;
        let mut counts = vec![0_usize; chain.len()];
        for (patch, _) in feet {
            counts[*patch as usize] += 1;
        }
        let strips = |count: &usize| vec![NOTHING; (count / ENOUGH).clamp(1, MOST)];
        let mut ranges: Vec<Vec<[f64; 2]>> = counts.iter().map(strips).collect();
        for (patch, foot) in feet {
            let [low, high] = chain.reach[*patch as usize];
            let strips = &mut ranges[*patch as usize];
            let at = (foot.arc - low) / (high - low) * strips.len() as f64;
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
            let strip = (at.max(0.0) as usize).min(strips.len() - 1);
            strips[strip] = union(strips[strip], [foot.lambda; 2]);
        }
        Strips(ranges)
    }

    /// Area that the points of each patch take up on it.
    fn areas(&self, chain: &Chain) -> Vec<f64> {
        let area = |(patch, strips): (usize, &Vec<[f64; 2]>)| {
            let [low, high] = chain.reach[patch];
            let filled = || strips.iter().filter(|r| is_something(r));
            let across = |[a, b]: &[f64; 2]| (b - a) * chain.strains[patch].speed(0.5 * (a + b));
            // A strip without points is as wide as the others.
            (high - low) * filled().map(across).sum::<f64>() / filled().count().max(1) as f64
        };
        self.0.iter().enumerate().map(area).collect()
    }

    /// Ranges of λ of the patches together with those of their neighbours next
    /// to the joints.
    fn with_neighbours(&self, chain: &Chain, own: &[[f64; 2]]) -> Vec<[f64; 2]> {
        let mut wide = own.to_vec();
        for joint in 0..chain.len() - 1 {
            let last = self.0[joint].iter().rfind(|r| is_something(r));
            let first = self.0[joint + 1].iter().find(|r| is_something(r));
            let offset = chain.offset(joint);
            if let Some(range) = last {
                wide[joint + 1] = union(wide[joint + 1], range.map(|l| l - offset));
            }
            if let Some(range) = first {
                wide[joint] = union(wide[joint], range.map(|l| l + offset));
            }
        }
        wide
    }
}
