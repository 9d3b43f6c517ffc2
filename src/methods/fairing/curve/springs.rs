//! Springs between the points and their feet on the curve.
//!
//! With the feet uᵢ held, Σ wᵢ ‖pᵢ − r(uᵢ)‖² is a quadratic form of the
//! coefficients, the same scalar matrix Σ wᵢ b(uᵢ) b(uᵢ)ᵀ for every
//! coordinate. It is summed span by span, so that after one pass over the
//! points ([`Springs::gram`]) nothing depends on their number. Then the feet
//! are projected anew ([`Springs::refresh`]). As the true distance is never
//! more than ‖pᵢ − r(uᵢ)‖, what holds for held feet holds for the curve.

use super::space::{Space, Vector};
use crate::geometry::bspline::Pieces;
use crate::numerics::EnvelopeMatrix;
use rayon::prelude::*;

/// Points handled by one task. Fixed, so that sums do not depend on the
/// number of threads.
const CHUNK: usize = 4096;
/// Newton steps a refresh may take; from the former foot two suffice.
const NEWTON_STEPS: usize = 8;
/// A step below this share of the domain is the last: convergence being
/// quadratic, it leaves about 1e-8, of which a distance feels the square. A foot
/// that must agree in some axes feels all of it, and takes a step more.
const SETTLED: f64 = 1e-4;
const SETTLED_IN_SOME_AXES: f64 = 1e-8;

/// The points with their feet.
#[derive(Debug, Clone)]
pub(super) struct Springs<const D: usize> {
    /// Points, unit scale.
    pub(super) points: Vec<Vector<D>>,
    /// Weight of each spring; 0 takes a point out.
    pub(super) weights: Vec<f64>,
    /// Parameter of each foot.
    pub(super) feet: Vec<f64>,
    /// Points whose foot stays where it is: ends and knuckles.
    pub(super) pinned: Vec<bool>,
    /// Points that a hold keeps in place, in their order; without a spring.
    pub(super) held: Vec<usize>,
    /// 1 for the axes along which the distance is measured when a foot is
    /// sought, 0 for those along which the points may move freely: then the
    /// foot is where the curve has the point's other coordinates.
    pub(super) metric: Vector<D>,
}

/// The quadratic form of the springs at held feet, about coefficients x₀:
/// Σ w ‖p − r‖² = (x − x₀)ᵀ G (x − x₀) − 2 (x − x₀)·m + c, summed over the
/// coordinates. About the present curve rather than about zero, so that
/// nothing cancels when the curve passes the points at 1e-9.
#[derive(Debug, Clone)]
pub(super) struct Gram<const D: usize> {
    /// G = Σ w b bᵀ, scalar.
    pub(super) matrix: EnvelopeMatrix,
    /// x₀.
    pub(super) about: Vec<Vector<D>>,
    /// m = Σ w b (p − r₀).
    pub(super) moments: Vec<Vector<D>>,
    /// c = Σ w ‖p − r₀‖².
    pub(super) square: f64,
    /// Σ w b y for the offsets y of the points across the curve ([`across`]).
    pub(super) offsets: Vec<Vector<D>>,
    /// Σ w ‖y‖².
    pub(super) offset_square: f64,
    /// Number of springs with weight.
    pub(super) count: usize,
}

/// Sums of one chunk, by span: upper triangles of b bᵀ, then b p.
struct Sums<const D: usize> {
    outer: Vec<f64>,
    moments: Vec<Vector<D>>,
    square: f64,
    offsets: Vec<Vector<D>>,
    offset_square: f64,
    count: usize,
}

/// A vector at the curve by its components across it: in the plane its first
/// component is the one along the left normal, the other 0; in space it stays
/// as it is, less its part along the tangent `d1`.
pub(super) fn across<const D: usize>(v: &Vector<D>, d1: &Vector<D>) -> Vector<D> {
    let q = d1.norm_squared().max(f64::MIN_POSITIVE);
    if D == 2 {
        let mut y = Vector::zeros();
        y[0] = (d1[0] * v[1] - d1[1] * v[0]) / q.sqrt();
        y
    } else {
        v - d1 * (d1.dot(v) / q)
    }
}

impl<const D: usize> Springs<D> {
    /// The quadratic form at the present feet and weights, about the curve
    /// with coefficients `x`.
    pub(super) fn gram(&self, space: &Space, x: &[Vector<D>]) -> Gram<D> {
        let order = space.degree() + 1;
        let triangle = order * (order + 1) / 2;
        let spans = space.functions();
        let curve = space.pieces(x);
        let chunks: Vec<Sums<D>> = (0..self.points.len().div_ceil(CHUNK))
            .into_par_iter()
            .map(|k| self.sum_chunk(space, &curve, k))
            .collect();
        let mut gram = Gram {
            matrix: space.matrix(1),
            about: x.to_vec(),
            moments: vec![Vector::zeros(); space.unknowns()],
            square: 0.0,
            offsets: vec![Vector::zeros(); space.unknowns()],
            offset_square: 0.0,
            count: 0,
        };
        let mut total = vec![0.0; spans * triangle];
        for sums in &chunks {
            total.iter_mut().zip(&sums.outer).for_each(|(t, s)| *t += s);
            for (function, m) in sums.moments.iter().enumerate() {
                gram.moments[space.unknown(function)] += m;
            }
            for (function, m) in sums.offsets.iter().enumerate() {
                gram.offsets[space.unknown(function)] += m;
            }
            gram.square += sums.square;
            gram.offset_square += sums.offset_square;
            gram.count += sums.count;
        }
        for (first, block) in total.chunks_exact(triangle).enumerate() {
            let mut values = block.iter();
            for a in 0..order {
                for b in 0..=a {
                    let value = values.next().copied().unwrap_or(0.0);
                    if value != 0.0 {
                        let (i, j) = (space.unknown(first + a), space.unknown(first + b));
                        gram.matrix.add(i, j, value);
                    }
                }
            }
        }
        gram
    }

    fn sum_chunk(&self, space: &Space, curve: &Pieces<D>, chunk: usize) -> Sums<D> {
        let order = space.degree() + 1;
        let triangle = order * (order + 1) / 2;
        let mut sums = Sums {
            outer: vec![0.0; space.functions() * triangle],
            moments: vec![Vector::zeros(); space.functions()],
            square: 0.0,
            offsets: vec![Vector::zeros(); space.functions()],
            offset_square: 0.0,
            count: 0,
        };
        let end = (chunk * CHUNK + CHUNK).min(self.points.len());
        for i in chunk * CHUNK..end {
            let w = self.weights[i];
            if w <= 0.0 {
                continue;
            }
            let basis = space.basis::<1>(self.feet[i]);
            let row = basis.values();
            let [point, along] = curve.jet::<2>(self.feet[i]);
            let away = self.points[i] - point;
            let offset = across(&away, &along);
            let block = &mut sums.outer[basis.first * triangle..][..triangle];
            let mut slots = block.iter_mut();
            for (a, ra) in row.iter().enumerate() {
                let share = w * ra;
                for (rb, slot) in row[..=a].iter().zip(slots.by_ref()) {
                    *slot += share * rb;
                }
                sums.moments[basis.first + a] += away * share;
                sums.offsets[basis.first + a] += offset * share;
            }
            sums.square += w * away.norm_squared();
            sums.offset_square += w * offset.norm_squared();
            sums.count += 1;
        }
        sums
    }

    /// Projects every foot anew on the curve with coefficients `x`, by
    /// Newton's method from where it was. Returns the largest change as a
    /// share of the domain.
    pub(super) fn refresh(&mut self, space: &Space, x: &[Vector<D>], reach: f64) -> f64 {
        let metric = self.metric;
        let [a, b] = space.domain();
        let curve = space.pieces(x);
        self.feet
            .par_chunks_mut(CHUNK)
            .zip(self.points.par_chunks(CHUNK))
            .zip(self.pinned.par_chunks(CHUNK))
            .map(|((feet, points), pinned)| {
                let mut most = 0.0_f64;
                for ((u, p), pinned) in feet.iter_mut().zip(points).zip(pinned) {
                    if !pinned {
                        let before = *u;
                        *u = foot((space, &curve), p, (before, reach), &metric);
                        most = most.max((*u - before).abs());
                    }
                }
                most
            })
            .reduce(|| 0.0, f64::max)
            / (b - a)
    }

    /// Springs of the points at the given parameters, none pinned.
    pub(super) fn new(
        points: Vec<Vector<D>>,
        weights: Vec<f64>,
        feet: Vec<f64>,
        metric: Vector<D>,
    ) -> Self {
        Springs {
            pinned: vec![false; points.len()],
            points,
            weights,
            feet,
            held: Vec::new(),
            metric,
        }
    }

    /// Every `every`-th of the springs, and those that are pinned.
    pub(super) fn thinned(&self, every: usize) -> Self {
        let kept = (0..self.points.len()).filter(|i| i % every == 0 || self.pinned[*i]);
        self.some(&kept.collect::<Vec<_>>())
    }

    /// The springs of some points; held ones are forgotten.
    pub(super) fn some(&self, kept: &[usize]) -> Self {
        Springs {
            points: kept.iter().map(|i| self.points[*i]).collect(),
            weights: kept.iter().map(|i| self.weights[*i]).collect(),
            feet: kept.iter().map(|i| self.feet[*i]).collect(),
            pinned: kept.iter().map(|i| self.pinned[*i]).collect(),
            held: Vec::new(),
            metric: self.metric,
        }
    }

    /// Whether points may move in all directions.
    pub(super) fn is_free(&self) -> bool {
        self.metric.iter().all(|m| *m == 1.0)
    }

    /// Parameters of the feet of held points.
    pub(super) fn held_feet(&self) -> impl Iterator<Item = f64> + '_ {
        self.held.iter().map(|i| self.feet[*i])
    }

    /// Keeps the feet of the given points where they are.
    pub(super) fn pin(&mut self, which: impl IntoIterator<Item = usize>) {
        for i in which {
            self.pinned[i] = true;
        }
    }

    /// pᵢ − r(uᵢ) for every point.
    pub(super) fn residuals(&self, space: &Space, x: &[Vector<D>]) -> Vec<Vector<D>> {
        let curve = space.pieces(x);
        let away = |i: usize| self.points[i] - curve.point(self.feet[i]);
        (0..self.points.len())
            .into_par_iter()
            .with_min_len(CHUNK)
            .map(away)
            .collect()
    }
}

/// The foot of `p` near `start`, by damped Newton steps of at most `reach`.
fn foot<const D: usize>(
    (space, curve): (&Space, &Pieces<D>),
    p: &Vector<D>,
    (start, reach): (f64, f64),
    metric: &Vector<D>,
) -> f64 {
    let [a, b] = space.domain();
    let free = metric.iter().all(|m| *m == 1.0);
    let settled = if free { SETTLED } else { SETTLED_IN_SOME_AXES };
    let mut u = start;
    let mut best = (f64::INFINITY, start);
    for _ in 0..NEWTON_STEPS {
        let [point, d1, d2] = curve.jet::<3>(u);
        let away = (p - point).component_mul(metric);
        let distance = away.norm_squared();
        if distance > best.0 {
            // Newton overshot: the foot before is the better one.
            break;
        }
        best = (distance, u);
        let slope = away.dot(&d1);
        let speed = d1.component_mul(metric).norm_squared();
        // Newton where the distance is convex, Gauss–Newton beyond the centre
        // of curvature, where Newton would run to the farthest point.
        let bend = speed - away.dot(&d2);
        let slant = if bend > 0.1 * speed { bend } else { speed };
        if slant <= 0.0 {
            break;
        }
        let step = (slope / slant).clamp(-reach, reach);
        let next = space.wrap(u + step);
        let moved = (next - u).abs();
        if moved <= settled * (b - a) {
            return next;
        }
        u = next;
    }
    best.1
}

impl<const D: usize> Gram<D> {
    /// Σ w ‖p − r‖² of the curve with coefficients `x`.
    pub(super) fn cost(&self, x: &[Vector<D>]) -> f64 {
        let h: Vec<Vector<D>> = x.iter().zip(&self.about).map(|(x, a)| x - a).collect();
        self.cost_of_change(&h)
    }

    /// The same at x₀ + h.
    pub(super) fn cost_of_change(&self, h: &[Vector<D>]) -> f64 {
        let gh = self.times(h);
        let mut sum = self.square;
        for ((h, gh), m) in h.iter().zip(&gh).zip(&self.moments) {
            sum += h.dot(&(gh - m * 2.0));
        }
        sum.max(0.0)
    }

    /// G h, coordinate by coordinate.
    fn times(&self, h: &[Vector<D>]) -> Vec<Vector<D>> {
        let mut out = vec![Vector::zeros(); h.len()];
        for c in 0..D {
            let column: Vec<f64> = h.iter().map(|v| v[c]).collect();
            for (slot, y) in out.iter_mut().zip(self.matrix.multiply(&column)) {
                slot[c] = y;
            }
        }
        out
    }

    /// Σ w b (p − r): the pull of the springs on each coefficient.
    pub(super) fn pull(&self, x: &[Vector<D>]) -> Vec<Vector<D>> {
        let h: Vec<Vector<D>> = x.iter().zip(&self.about).map(|(x, a)| x - a).collect();
        self.moments
            .iter()
            .zip(&self.times(&h))
            .map(|(m, g)| m - g)
            .collect()
    }
}
