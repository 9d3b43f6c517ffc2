//! The least-squares problem of a chain: distances of points, weighted.
//!
//! With a foot's normal n (as a force through the point x) a motion (v, ω) of a
//! patch changes the distance at the rate −(n·v + (x × n)·ω). All points of one
//! patch therefore have Jacobian rows that are linear in eight numbers, (n, x ×
//! n, ∂d/∂g, ∂d/∂k), and their JᵀJ and Jᵀr follow from the 9 × 9 moments of these
//! and d. The Cholesky factor of the moments is handed to the solver as nine
//! residuals a patch: the same cost, gradient and normal matrix as one residual
//! a point, at a cost that is linear in the points and independent of the
//! number of patches.

use super::chain::{Chain, Placed};
use crate::geometry::cone::{FootDerivatives, Frame, Strain, Twist};
use crate::solver::{Blocks, LeastSquares};
use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

/// Numbers that the distances of one patch are linear in, and the distance.
const MOMENTS: usize = 9;
/// Unknowns of the root: its move along the normal, its turns about r, t, n.
/// Moves along r and t do not change the surface.
const ROOT: usize = 4;
/// Points are summed up in runs of so many, so that sums do not depend on the
/// number of threads.
const RUN: usize = 4096;
/// Least 1 + gλ at the ends of rulings: so much nearer to the apex than the
/// middle may an end be.
const SLOWEST: f64 = 0.02;
/// Share of their weight that distances within the allowed one keep, so that
/// every patch stays held.
const WITHIN: f64 = 1e-6;
/// Patches may not become shorter than this share of the unit length.
pub(super) const SHORTEST: f64 = 1e-6;

/// A patch may stay as short as it was, but not become so.
fn is_too_short([low, high]: &[f64; 2], before: &[f64; 2]) -> bool {
    high - low < SHORTEST.min(0.5 * (before[1] - before[0]))
}

/// Points to be fitted, with the patch where the search for each begins.
#[derive(Debug, Clone, Copy)]
pub(super) struct Points<'a> {
    pub(super) points: &'a [Point3<f64>],
    pub(super) weights: &'a [f64],
    pub(super) homes: &'a [u32],
}

/// Which unknowns a fit may change.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Freedom {
    /// g and k of each patch.
    pub(super) strains: Vec<[bool; 2]>,
    /// Whether joints may move.
    pub(super) joints: bool,
}

impl Freedom {
    /// Everything may change.
    pub(super) fn full(patches: usize) -> Self {
        Freedom {
            strains: vec![[true; 2]; patches],
            joints: true,
        }
    }
}

/// The problem; unknowns are changes against `base`.
pub(super) struct Problem<'a> {
    pub(super) base: &'a Chain,
    pub(super) points: Points<'a>,
    /// λ of the points of each patch, from its base line.
    pub(super) lambda: &'a [[f64; 2]],
    /// Weight of the squared differences of neighbouring strains.
    pub(super) smoothing: f64,
    /// Distances up to this hardly count, and of larger ones what is beyond:
    /// least squares are then an end when all are within.
    pub(super) allowed: f64,
    /// Sums of powers p > 2 of the distances instead of squares, distances in
    /// this unit: (p, unit).
    pub(super) power: Option<(f64, f64)>,
    /// Least 1 + gλ at the ends of a patch's rulings.
    pub(super) slowest: f64,
    columns: Columns,
}

/// Where each unknown stands among those that are free.
struct Columns {
    root: [usize; ROOT],
    strains: Vec<[Option<usize>; 2]>,
    joints: Vec<Option<usize>>,
    count: usize,
}

impl Columns {
    fn new(freedom: &Freedom) -> Self {
        let mut count = ROOT;
        let mut next = |free: bool| {
            free.then(|| {
                count += 1;
                count - 1
            })
        };
        let strains: Vec<_> = freedom.strains.iter().map(|f| f.map(&mut next)).collect();
        let joints = (1..strains.len()).map(|_| next(freedom.joints)).collect();
        Columns {
            root: [0, 1, 2, 3],
            strains,
            joints,
            count,
        }
    }
}

/// A motion of a patch per unit of an unknown.
type Moved = (usize, Twist);

impl<'a> Problem<'a> {
    pub(super) fn new(
        base: &'a Chain,
        points: Points<'a>,
        lambda: &'a [[f64; 2]],
        freedom: &Freedom,
    ) -> Self {
        Problem {
            base,
            points,
            lambda,
            smoothing: 0.0,
            allowed: 0.0,
            power: None,
            slowest: SLOWEST,
            columns: Columns::new(freedom),
        }
    }

    /// The chain that given unknowns stand for.
    pub(super) fn chain(&self, x: &[f64]) -> Chain {
        let mut chain = self.base.clone();
        let turn = Vector3::new(x[1], x[2], x[3]);
        chain.root = Frame {
            point: self.base.root.point + x[0] * self.base.root.normal,
            ..self.base.root.turned(&turn)
        };
        let at = |column: Option<usize>| column.map_or(0.0, |c| x[c]);
        for (strain, columns) in chain.strains.iter_mut().zip(&self.columns.strains) {
            strain.g += at(columns[0]);
            strain.k += at(columns[1]);
        }
        for (j, column) in self.columns.joints.iter().enumerate() {
            if j >= chain.middle {
                chain.reach[j][1] += at(*column);
            } else {
                chain.reach[j + 1][0] -= at(*column);
            }
        }
        chain
    }

    /// Motions of every patch by the unknowns upstream of it.
    fn motions(&self, x: &[f64], chain: &Chain, frames: &[Frame]) -> Vec<Vec<Moved>> {
        let mut motions = vec![self.root_motions(x, chain); chain.len()];
        for i in chain.middle + 1..chain.len() {
            let mut list = motions[i - 1].clone();
            self.add_carried(&mut list, (chain, frames), i - 1, 1);
            motions[i] = list;
        }
        for i in (0..chain.middle).rev() {
            let mut list = motions[i + 1].clone();
            self.add_carried(&mut list, (chain, frames), i + 1, 0);
            motions[i] = list;
        }
        motions
    }

    fn root_motions(&self, x: &[f64], chain: &Chain) -> Vec<Moved> {
        let base = &self.base.root;
        let lift = Twist {
            linear: base.normal,
            angular: Vector3::zeros(),
        };
        let spins = base.turning(&Vector3::new(x[1], x[2], x[3]));
        let turns = spins.map(|spin| Twist::at(&chain.root.point, Vector3::zeros(), spin));
        let all = [lift, turns[0], turns[1], turns[2]];
        self.columns.root.into_iter().zip(all).collect()
    }

    /// What the strains and the length of a patch do to everything beyond its
    /// first (`end` 0) or last (1) ruling.
    fn add_carried(
        &self,
        list: &mut Vec<Moved>,
        (chain, frames): (&Chain, &[Frame]),
        patch: usize,
        end: usize,
    ) {
        let arc = chain.reach[patch][end];
        let [by_g, by_k, by_s] = frames[patch].carried_twists(chain.strains[patch], arc);
        let [g, k] = self.columns.strains[patch];
        list.extend(g.map(|c| (c, by_g)));
        list.extend(k.map(|c| (c, by_k)));
        let (joint, sign) = if end == 1 {
            (patch, 1.0)
        } else {
            (patch - 1, -1.0)
        };
        let outward = Twist {
            linear: sign * by_s.linear,
            angular: sign * by_s.angular,
        };
        list.extend(self.columns.joints[joint].map(|c| (c, outward)));
    }

    /// Moments of each patch's points.
    fn moments(&self, placed: &Placed, derivatives: bool) -> Vec<Moments> {
        let Points {
            points,
            weights,
            homes,
        } = self.points;
        let run = |(index, chunk): (usize, &[Point3<f64>])| {
            let mut moments = vec![Moments::default(); placed.frames.len()];
            for (i, point) in (index * RUN..).zip(chunk) {
                let (patch, foot) = placed.foot(point, homes[i] as usize);
                let counts = self.counting(foot.distance);
                if derivatives {
                    let mut row = placed.row(point, patch);
                    for (distance, share) in counts {
                        let [value, slope] = self.powered(distance);
                        row[MOMENTS - 1] = value / slope;
                        moments[patch].add(share * weights[i] * slope * slope, &row);
                    }
                } else {
                    for (distance, share) in counts {
                        let [value, _] = self.powered(distance);
                        moments[patch].add_distance(share * weights[i], value);
                    }
                }
            }
            moments
        };
        if points.len() <= RUN {
            return run((0, points));
        }
        let runs: Vec<Vec<Moments>> = points.par_chunks(RUN).enumerate().map(run).collect();
        let mut sum = vec![Moments::default(); placed.frames.len()];
        for run in &runs {
            sum.iter_mut().zip(run).for_each(|(s, m)| s.add_all(m));
        }
        sum
    }

    /// What stands for a distance, and its slope: of |d|^p the square root of
    /// it, with the slope that gives p |d|^(p−1) as gradient, and, times a
    /// constant, p (p − 1) |d|^(p−2) as curvature: Newton's steps.
    fn powered(&self, distance: f64) -> [f64; 2] {
        /// Least slope, of that at the unit: every patch stays held.
        const HELD: f64 = 1e-4;
        let Some((power, unit)) = self.power else {
            return [distance, 1.0];
        };
        let half = (distance.abs() / unit).powf(0.5 * power - 1.0);
        let value = distance * half * (0.5 * power / (power - 1.0)).sqrt();
        let slope = half * (2.0 * (power - 1.0) / power).sqrt() * (0.5 * power);
        [value, slope.max(HELD)]
    }

    /// What of a distance counts, and with which share of its weight.
    fn counting(&self, distance: f64) -> impl Iterator<Item = (f64, f64)> + use<> {
        let beyond = distance - distance.clamp(-self.allowed, self.allowed);
        let within = (self.allowed > 0.0).then_some((distance, WITHIN));
        let counts = (beyond != 0.0 || self.allowed == 0.0).then_some((beyond, 1.0));
        within.into_iter().chain(counts)
    }

    /// How near the apex may come to the points.
    fn push_apex_limits(&self, chain: &Chain, blocks: &mut Blocks) {
        /// Weight against distances of the unit strip.
        const HARD: f64 = 10.0;
        for (patch, lambda) in self.lambda.iter().enumerate() {
            let strain = chain.strains[patch];
            let residuals = lambda.map(|l| HARD * (self.slowest - strain.speed(l)));
            match self.columns.strains[patch][0] {
                Some(c) => {
                    blocks.push_mixed(&residuals, 0, &[c], &lambda.map(|l| -HARD * l));
                }
                None => blocks.push_mixed(&residuals, 0, &[], &[]),
            }
        }
    }

    fn push_smoothing(&self, chain: &Chain, blocks: &mut Blocks) {
        if self.smoothing == 0.0 {
            return;
        }
        let root = self.smoothing.sqrt();
        for i in 1..chain.len() {
            let values = |s: Strain| [s.g, s.k];
            let (a, b) = (values(chain.strains[i - 1]), values(chain.strains[i]));
            for e in 0..2 {
                let residual = root * (b[e] - a[e]);
                let ends = [self.columns.strains[i - 1][e], self.columns.strains[i][e]];
                let columns: Vec<usize> = ends.iter().flatten().copied().collect();
                let signs = [(ends[0], -root), (ends[1], root)];
                let row: Vec<f64> = signs.iter().filter_map(|(c, v)| c.map(|_| *v)).collect();
                blocks.push(&[residual], &columns, &row);
            }
        }
    }
}

impl LeastSquares for Problem<'_> {
    fn dimension(&self) -> usize {
        self.columns.count
    }

    fn evaluate(&self, x: &[f64], blocks: &mut Blocks) {
        let chain = self.chain(x);
        let lengths = chain.reach.iter().zip(&self.base.reach);
        if lengths
            .into_iter()
            .any(|(now, before)| is_too_short(now, before))
        {
            blocks.push(&[f64::NAN], &[], &[]);
            return;
        }
        let placed = Placed::new(&chain);
        let derivatives = blocks.wants_jacobian();
        let moments = self.moments(&placed, derivatives);
        let motions = if derivatives {
            self.motions(x, &chain, &placed.frames)
        } else {
            vec![Vec::new(); chain.len()]
        };
        for (patch, (moments, motions)) in moments.iter().zip(&motions).enumerate() {
            moments.push(motions, &self.columns.strains[patch], blocks);
        }
        self.push_apex_limits(&chain, blocks);
        self.push_smoothing(&chain, blocks);
    }
}

impl Placed {
    /// The nine numbers of a point.
    fn row(&self, point: &Point3<f64>, patch: usize) -> [f64; MOMENTS] {
        let d = FootDerivatives::of(point, &self.frames[patch], self.strains[patch]);
        let (n, m) = (d.normal, point.coords.cross(&d.normal));
        [n.x, n.y, n.z, m.x, m.y, m.z, d.by_g, d.by_k, d.distance]
    }
}

/// Lower triangle of Σ w a aᵀ.
#[derive(Debug, Clone)]
struct Moments([[f64; MOMENTS]; MOMENTS]);

impl Default for Moments {
    fn default() -> Self {
        Moments([[0.0; MOMENTS]; MOMENTS])
    }
}

impl Moments {
    fn add(&mut self, weight: f64, row: &[f64; MOMENTS]) {
        for (i, sums) in self.0.iter_mut().enumerate() {
            let weighted = weight * row[i];
            for (sum, value) in sums[..=i].iter_mut().zip(row) {
                *sum += weighted * value;
            }
        }
    }

    fn add_distance(&mut self, weight: f64, distance: f64) {
        self.0[MOMENTS - 1][MOMENTS - 1] += weight * distance * distance;
    }

    fn add_all(&mut self, other: &Moments) {
        for (a, b) in self.0.iter_mut().flatten().zip(other.0.iter().flatten()) {
            *a += b;
        }
    }

    /// L with L Lᵀ = the moments, columns without a pivot left out.
    fn factor(&self) -> [[f64; MOMENTS]; MOMENTS] {
        /// A pivot below this share of its diagonal is rounding.
        const LOST: f64 = 1e-15;
        let mut l = [[0.0; MOMENTS]; MOMENTS];
        for j in 0..MOMENTS {
            let pivot = self.0[j][j] - l[j][..j].iter().map(|v| v * v).sum::<f64>();
            if pivot <= LOST * self.0[j][j] {
                continue;
            }
            l[j][j] = pivot.sqrt();
            for i in j + 1..MOMENTS {
                let inner: f64 = (0..j).map(|c| l[i][c] * l[j][c]).sum();
                l[i][j] = (self.0[i][j] - inner) / l[j][j];
            }
        }
        l
    }

    /// Pushes nine residuals that stand for all points.
    fn push(&self, motions: &[Moved], own: &[Option<usize>; 2], blocks: &mut Blocks) {
        if !blocks.wants_jacobian() {
            let mut residuals = [0.0; MOMENTS];
            residuals[0] = self.0[MOMENTS - 1][MOMENTS - 1].sqrt();
            blocks.push(&residuals, &[], &[]);
            return;
        }
        let l = self.factor();
        let mut columns: Vec<usize> = motions.iter().map(|(c, _)| *c).collect();
        columns.extend(own.iter().flatten());
        let mut jacobian = Vec::with_capacity(MOMENTS * columns.len());
        // Row r of the Jacobian is column r of L.
        for column in (0..MOMENTS).map(|r| l.map(|row| row[r])) {
            let force = Vector3::new(column[0], column[1], column[2]);
            let moment = Vector3::new(column[3], column[4], column[5]);
            let by = |t: &Twist| -(force.dot(&t.linear) + moment.dot(&t.angular));
            jacobian.extend(motions.iter().map(|(_, twist)| by(twist)));
            let strains = own.iter().zip([column[6], column[7]]);
            jacobian.extend(strains.filter_map(|(c, v)| c.map(|_| v)));
        }
        blocks.push(&l[MOMENTS - 1], &columns, &jacobian);
    }
}

#[cfg(test)]
mod tests {
    use super::super::chain::tests::chain;
    use super::*;

    /// Points near a chain, on all of its patches.
    fn points(chain: &Chain) -> (Vec<Point3<f64>>, Vec<u32>) {
        let frames = chain.frames();
        let (mut points, mut homes) = (Vec::new(), Vec::new());
        for (i, frame) in frames.iter().enumerate() {
            let [low, high] = chain.reach[i];
            for n in 0..24 {
                let [u, v, w] = [0.17, 0.41, 0.73].map(|f| (f * f64::from(n)).fract());
                let there = frame.carried(chain.strains[i], low + (0.1 + 0.8 * u) * (high - low));
                points.push(there.at(0.4 * (v - 0.5)) + 0.02 * (w - 0.5) * there.normal);
                homes.push(i as u32);
            }
        }
        (points, homes)
    }

    /// The nine residuals of a patch are not the distances, so that only the
    /// cost can be compared with differences.
    #[test]
    fn the_gradient_agrees_with_differences() {
        let chain = chain();
        let (points, homes) = points(&chain);
        let weights: Vec<f64> = (0..points.len()).map(|i| 1.0 + 0.01 * i as f64).collect();
        let all = Points {
            points: &points,
            weights: &weights,
            homes: &homes,
        };
        let lambda = vec![[-0.2, 0.2]; 4];
        let mut freedom = Freedom::full(4);
        freedom.strains[2] = [false, true];
        let mut problem = Problem::new(&chain, all, &lambda, &freedom);
        problem.smoothing = 1e-3;
        for allowed in [0.0, 3e-3] {
            problem.allowed = allowed;
            gradient_agrees(&problem);
        }
    }

    fn gradient_agrees(problem: &Problem) {
        let cost = |x: &[f64]| {
            let mut blocks = Blocks::default();
            problem.evaluate(x, &mut blocks);
            blocks.cost(0.0)
        };
        let at: Vec<f64> = (0..problem.dimension())
            .map(|i| 1e-3 * (i as f64).sin())
            .collect();
        let mut blocks = Blocks::default();
        blocks.reset(true);
        problem.evaluate(&at, &mut blocks);
        assert!((blocks.cost(0.0) - cost(&at)).abs() < 1e-14);
        let mut gradient = vec![0.0; at.len()];
        let counts = |(i, r): (usize, &f64)| {
            if blocks.is_one_sided(i) {
                r.max(0.0)
            } else {
                *r
            }
        };
        let residuals: Vec<f64> = blocks.residuals().iter().enumerate().map(counts).collect();
        blocks.add_gradient(&residuals, &mut gradient);
        let h = 1e-6;
        for (i, g) in gradient.iter().enumerate() {
            let shifted = |s: f64| {
                let mut x = at.clone();
                x[i] += s;
                cost(&x)
            };
            let difference = (shifted(h) - shifted(-h)) / (2.0 * h);
            assert!((difference - g).abs() < 1e-7, "{i}: {g} {difference}");
        }
    }
}
