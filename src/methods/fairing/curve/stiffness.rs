//! How stiff the curve should be against its springs: the noise of the points
//! and the roughness of the shape, estimated together.
//!
//! About the present curve the shape moves by offsets h(u) across the curve,
//! each component a scalar spline. To first order the change of curvature
//! becomes (κ′n)(s) + h‴ + κ² h′, and the fit at stiffness λ minimises
//!
//! Q(h) = Σ wᵢ (yᵢ − h(uᵢ))² + λ ∫ ω |κ′ + h‴ + κ² h′|² ds.
//!
//! Read as a Gaussian model (noise σ², shape variance σ²/λ), λ maximises the
//! restricted likelihood (Wahba 1985, *A comparison of GCV and GML*;
//! Patterson & Thompson 1971). With m = 3 undetermined directions per offset
//! (the circles, on which the energy is 0), f offsets, n coefficients and N
//! scalar observations, −2 log L is up to constants
//!
//! (N − f m) ln Q + f (ln det(G + λH) − (n − m) ln λ),   σ̂² = Q/(N − f m).
//!
//! A prior of one parameter fits the roughness of the shape's curvature and
//! the signal at once; on smooth shapes the likeliest λ then leaves waves in κ.
//! So the likeliest gives the noise, and the curve becomes **the stiffest that
//! the points do not refute**: λ is raised while the sum of squares grows by
//! no more than noise in the parameters given up explains,
//! ΔS ≤ σ̂² (Δdf + 2 √Δdf).
//!
//! Likelihood and not cross-validation, because GCV has a flat minimum that on
//! a few dozen points is at interpolation too often. Every λ costs one banded
//! factorisation of order n, whatever the number of points.

use super::energy::{
    Energy, Node, Quadratic, add_outer, curvature, derivatives, nodes, variation_value,
};
use super::space::{Space, Vector};
use super::springs::{Gram, across};
use crate::geometry::bspline::MAX_DEGREE;
use crate::numerics::{EnvelopeFactor, EnvelopeMatrix};

/// Directions per offset that the energy does not feel.
const UNDETERMINED: f64 = 3.0;
/// Noise that is always there, unit scale: rounding of given coordinates. It
/// keeps exact data from asking for infinite precision.
const LEAST_NOISE: f64 = 1e-10;
/// What rounding leaves of Q where the curve comes much nearer to the points
/// than it was: a share of Q at rest.
const ROUNDING: f64 = 1e-11;
/// Step of the first scan in ln λ: a factor 1.28 in wavelength.
const SCAN_STEP: f64 = 1.5;
/// Steps of the golden section that follows: ln λ to 0.1.
const GOLDEN_STEPS: usize = 7;
/// How far from an earlier choice of ln λ a new one is sought.
const NEAR: f64 = 3.0;
/// A stiffness whose −2 log L lies this much above the least is refuted:
/// 95 % of χ² with one degree of freedom.
const REFUTED: f64 = 3.84;
/// Standard deviations above its mean that a χ² of pure noise may reach. At 2
/// curves of few points lie up to a tenth farther from their truth, at 1 the
/// curvature of many is a third less exact.
const DEVIATES: f64 = std::f64::consts::SQRT_2;
/// 1 − 1/φ, the golden section.
const GOLDEN: f64 = 0.381_966_011_250_105_1;

/// The quadratic model about a curve.
pub(super) struct Offsets<'a, const D: usize> {
    /// G.
    gram: &'a EnvelopeMatrix,
    space: &'a Space,
    /// H, of one offset.
    energy: EnvelopeMatrix,
    /// The same as rows, for sums of squares that rounding keeps positive.
    rows: Vec<Row<D>>,
    /// Pull of the springs across the curve.
    pull: Vec<Vector<D>>,
    /// Half the slope of the energy at h = 0.
    slope: Vec<Vector<D>>,
    /// Springs' part of Q at h = 0.
    at_rest: f64,
    /// Number of scalar observations N and of offsets f.
    observations: f64,
    offsets: f64,
}

/// One weighted square of the energy: weight · ‖value + row·h‖².
struct Row<const D: usize> {
    first: usize,
    weight: f64,
    value: Vector<D>,
    row: [f64; MAX_DEGREE + 1],
    count: usize,
}

/// A stiffness and what it means.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Choice {
    /// λ: stiffness of the curve against springs of weight 1.
    pub(super) stiffness: f64,
    /// σ̂ of one coordinate of one point, unit scale.
    pub(super) noise: f64,
    /// Effective number of parameters that the points determine.
    pub(super) degrees_of_freedom: f64,
    /// −2 log likelihood, for comparing spaces on the same points.
    pub(super) score: f64,
    /// ln λ of the greatest likelihood.
    pub(super) likeliest: f64,
    /// Whether the points tell noise from shape: interpolation is refuted.
    pub(super) evident: bool,
}

impl Choice {
    /// A stiffness that was found otherwise; nothing is known of the noise.
    pub(super) fn given(stiffness: f64) -> Self {
        Choice {
            stiffness,
            noise: 0.0,
            degrees_of_freedom: 0.0,
            score: 0.0,
            likeliest: stiffness.ln(),
            evident: false,
        }
    }
}

impl<'a, const D: usize> Offsets<'a, D> {
    /// The model about the curve with coefficients `x`, where the springs are
    /// summed.
    pub(super) fn about(
        space: &'a Space,
        energy: &Energy,
        gram: &'a Gram<D>,
        x: &[Vector<D>],
    ) -> Self {
        let mut rows = Vec::new();
        for (node, relief) in energy.nodes.iter().zip(&energy.relief) {
            let d = derivatives(space, node, x);
            let first = node.basis.first;
            match &energy.quadratic {
                None => rows.push(variation_row(node, &d, *relief)),
                Some(weights) => {
                    for (order, weight) in weights.iter().enumerate() {
                        let value = across(&d[order], &d[0]);
                        let row = node.basis.derivative(order + 1);
                        rows.push(Row::new(first, node.weight * weight, value, row));
                    }
                }
            }
        }
        let (energy, slope) = assemble(space, &rows);
        Offsets {
            gram: &gram.matrix,
            space,
            energy,
            rows,
            pull: gram.offsets.clone(),
            slope,
            at_rest: gram.offset_square,
            observations: (gram.count * (D - 1)) as f64,
            offsets: (D - 1) as f64,
        }
    }

    /// The model of a curve with the quadratic energy, about nothing: every
    /// coordinate is one offset.
    pub(super) fn linear(space: &'a Space, weights: &Quadratic, gram: &'a Gram<D>) -> Self {
        let mut rows = Vec::new();
        for node in nodes(space) {
            for (order, weight) in weights.iter().enumerate() {
                let row = node.basis.derivative(order + 1);
                let weight = node.weight * weight;
                rows.push(Row::new(node.basis.first, weight, Vector::zeros(), row));
            }
        }
        let (energy, slope) = assemble(space, &rows);
        let nothing = vec![Vector::zeros(); space.unknowns()];
        Offsets {
            gram: &gram.matrix,
            space,
            energy,
            rows,
            pull: gram.pull(&nothing),
            slope,
            at_rest: gram.cost(&nothing),
            observations: (gram.count * D) as f64,
            offsets: D as f64,
        }
    }

    /// The factor of G + λH, and its logarithmic determinant.
    fn factor(&self, stiffness: f64) -> Option<(EnvelopeFactor, f64)> {
        let mut matrix = self.gram.clone();
        matrix.add_scaled(&self.energy, stiffness);
        let factor = matrix.factor().ok()?;
        let log = factor.pivots().map(f64::ln).sum();
        Some((factor, log))
    }

    /// The offsets that minimise Q at a stiffness, and Q.
    pub(super) fn solve(&self, stiffness: f64) -> Option<(Vec<Vector<D>>, f64, f64)> {
        let (factor, log) = self.factor(stiffness)?;
        let mut h = vec![Vector::zeros(); self.pull.len()];
        for c in 0..D {
            let force = self.pull.iter().zip(&self.slope);
            let mut column: Vec<f64> = force.map(|(p, s)| p[c] - stiffness * s[c]).collect();
            factor.solve_in_place(&mut column);
            h.iter_mut().zip(&column).for_each(|(h, v)| h[c] = *v);
        }
        // From the definition, not from the optimality condition: an inexact h
        // then makes Q a little too large instead of anything.
        let least = ROUNDING * self.at_rest;
        let q = self.springs_of(&h).max(least) + stiffness * self.energy_of(&h);
        Some((h, q, log))
    }

    /// The energy of offsets.
    fn energy_of(&self, h: &[Vector<D>]) -> f64 {
        let square = |r: &Row<D>| {
            let change = self.space.combine(r.first, &r.row[..r.count], h);
            r.weight * (r.value + change).norm_squared()
        };
        self.rows.iter().map(square).sum()
    }

    /// Σ w (y − h)².
    fn springs_of(&self, h: &[Vector<D>]) -> f64 {
        let mut sum = self.at_rest;
        for c in 0..D {
            let column: Vec<f64> = h.iter().map(|v| v[c]).collect();
            let image = self.gram.multiply(&column);
            for ((h, image), pull) in column.iter().zip(&image).zip(&self.pull) {
                sum += h * (image - 2.0 * pull[c]);
            }
        }
        sum
    }

    /// The factor of G + λH.
    pub(super) fn factored(&self, stiffness: f64) -> Option<EnvelopeFactor> {
        self.factor(stiffness).map(|f| f.0)
    }

    /// The part of −2 log L that does not depend on the residuals.
    pub(super) fn log_prior(&self, log_determinant: f64, log_stiffness: f64) -> f64 {
        let rank = self.pull.len() as f64 - UNDETERMINED;
        self.offsets * (log_determinant - rank * log_stiffness)
    }

    /// Q of the noise that is always there.
    pub(super) fn least_sum(&self) -> f64 {
        self.observations * LEAST_NOISE * LEAST_NOISE
    }

    /// N − f m.
    pub(super) fn freedom(&self) -> f64 {
        (self.observations - self.offsets * UNDETERMINED).max(1.0)
    }

    /// −2 log likelihood and σ̂² at ln λ; infinite where the factor fails.
    fn score(&self, log_stiffness: f64) -> (f64, f64) {
        let Some((_, q, log)) = self.solve(log_stiffness.exp()) else {
            return (f64::INFINITY, 0.0);
        };
        let q = q + self.least_sum();
        let score = self.freedom() * q.ln() + self.log_prior(log, log_stiffness);
        (score, q / self.freedom())
    }

    /// The stiffest curve that the points do not refute; see the head of the
    /// file. `near`: ln λ of an earlier choice on almost the same curve.
    pub(super) fn choose(&self, near: Option<f64>) -> Choice {
        let (low, high) = self.range();
        let likeliest = match near {
            Some(t) => self.scan((t - NEAR).max(low), (t + NEAR).min(high)),
            None => self.scan(low, high),
        };
        let least = self.score(likeliest).0;
        // Where interpolation is as likely, the points say nothing of noise:
        // the stiffest likelihood within reach, and no test on top of it.
        let evident = self.score(low).0 - least > REFUTED;
        let base = if evident {
            likeliest
        } else {
            last_true(likeliest, high, |t| self.score(t).0 <= least + REFUTED)
        };
        let noise2 = self.score(base).1;
        let free = self.free_parameters(base);
        let springs = self.springs(base);
        let explained_by_noise = |t: f64| {
            let dropped = (free - self.free_parameters(t)).max(0.0) * self.offsets;
            let allowed = dropped + DEVIATES * (2.0 * dropped).sqrt();
            self.springs(t) - springs <= noise2 * allowed
        };
        let t = if evident {
            last_true(base, high, explained_by_noise)
        } else {
            base
        };
        Choice {
            noise: noise2.sqrt(),
            likeliest,
            evident,
            ..self.at(t.exp())
        }
    }

    /// A stiffness so small that springs of weight 1 win: for points that are
    /// all held otherwise.
    pub(super) fn soft(&self) -> Choice {
        /// Above the softest that is ever looked at.
        const ABOVE: f64 = 8.0;
        let t = self.range().0 + ABOVE;
        Choice {
            noise: 0.0,
            ..self.at(t.exp())
        }
    }

    /// What a given stiffness means.
    pub(super) fn at(&self, stiffness: f64) -> Choice {
        let t = stiffness.ln();
        let (score, noise2) = self.score(t);
        Choice {
            stiffness,
            noise: noise2.sqrt(),
            degrees_of_freedom: self.offsets * self.free_parameters(t),
            score,
            likeliest: t,
            evident: true,
        }
    }

    /// Parameters of one offset that the points determine at ln λ:
    /// n − d ln det(G + λH)/d ln λ = tr((G + λH)⁻¹ G).
    fn free_parameters(&self, t: f64) -> f64 {
        /// Half a difference of ln λ for the derivative of the determinant.
        const H: f64 = 0.05;
        let log_at = |t: f64| self.factor(t.exp()).map_or(f64::NAN, |f| f.1);
        let free = self.pull.len() as f64 - (log_at(t + H) - log_at(t - H)) / (2.0 * H);
        if free.is_finite() {
            free.max(0.0)
        } else {
            self.observations / self.offsets
        }
    }

    /// Σ w (y − h)² at ln λ.
    fn springs(&self, t: f64) -> f64 {
        self.solve(t.exp())
            .map_or(f64::INFINITY, |(h, ..)| self.springs_of(&h))
    }

    /// Stiffness of each coefficient at λ = 1.
    pub(super) fn stiffnesses(&self) -> Vec<f64> {
        self.energy.diagonal().collect()
    }

    /// ln λ from interpolation to the stiffest wave: H grows as the sixth
    /// power of the number of waves.
    fn range(&self) -> (f64, f64) {
        let n = self.pull.len() as f64;
        let trace = |m: &EnvelopeMatrix| m.diagonal().sum::<f64>().max(f64::MIN_POSITIVE);
        let gram = trace(self.gram);
        let gram = if gram > 1e-12 { gram } else { n };
        let even = (gram / trace(&self.energy)).ln();
        (even - 20.0, even + 6.0 * n.ln() + 5.0)
    }

    /// ln λ of the least score between two bounds: a scan, then golden section.
    fn scan(&self, low: f64, high: f64) -> f64 {
        let steps = ((high - low) / SCAN_STEP).ceil() as usize;
        let mut best = (f64::INFINITY, low);
        for k in 0..=steps {
            let t = low + k as f64 * SCAN_STEP;
            let value = self.score(t).0;
            if value < best.0 {
                best = (value, t);
            }
        }
        let (mut a, mut b) = (best.1 - SCAN_STEP, best.1 + SCAN_STEP);
        let (mut c, mut d) = (a + GOLDEN * (b - a), b - GOLDEN * (b - a));
        let (mut fc, mut fd) = (self.score(c).0, self.score(d).0);
        for _ in 0..GOLDEN_STEPS {
            if fc <= fd {
                (b, d, fd) = (d, c, fc);
                c = a + GOLDEN * (b - a);
                fc = self.score(c).0;
            } else {
                (a, c, fc) = (c, d, fd);
                d = b - GOLDEN * (b - a);
                fd = self.score(d).0;
            }
        }
        0.5 * (a + b)
    }
}

impl<const D: usize> Row<D> {
    fn new(first: usize, weight: f64, value: Vector<D>, functions: &[f64]) -> Self {
        let mut row = [0.0; MAX_DEGREE + 1];
        row[..functions.len()].copy_from_slice(functions);
        Row {
            first,
            weight,
            value,
            row,
            count: functions.len(),
        }
    }
}

/// √(ω v du) (κ′ + h‴/v³ + κ² h′/v) at a node.
fn variation_row<const D: usize>(node: &Node, d: &[Vector<D>; 3], relief: f64) -> Row<D> {
    let v2 = d[0].norm_squared();
    let (v, k) = (v2.sqrt(), curvature(d));
    let value = across(&(variation_value(d) / v.sqrt()), &d[0]);
    let (d1, d3) = (node.basis.derivative(1), node.basis.derivative(3));
    let row: Vec<f64> = d1
        .iter()
        .zip(d3)
        .map(|(d1, d3)| d3 / (v * v2) + k * k * d1 / v)
        .collect();
    Row::new(node.basis.first, node.weight * relief * v, value, &row)
}

/// H and half the slope at h = 0.
fn assemble<const D: usize>(space: &Space, rows: &[Row<D>]) -> (EnvelopeMatrix, Vec<Vector<D>>) {
    let mut matrix = space.matrix(1);
    let mut slope = vec![Vector::zeros(); space.unknowns()];
    for r in rows {
        let row = &r.row[..r.count];
        add_outer(space, &mut matrix, r.first, row, r.weight);
        for (j, l) in row.iter().enumerate() {
            slope[space.unknown(r.first + j)] += r.value * (r.weight * l);
        }
    }
    (matrix, slope)
}

/// The largest t in [from, to] up to which `holds` stays true, by steps and
/// bisection; `from` where it fails at once.
fn last_true(from: f64, to: f64, holds: impl Fn(f64) -> bool) -> f64 {
    const STEP: f64 = 1.0;
    const HALVINGS: usize = 5;
    let mut good = from;
    while good < to && holds(good + STEP) {
        good += STEP;
    }
    if good >= to {
        return to;
    }
    let mut bad = good + STEP;
    for _ in 0..HALVINGS {
        let middle = 0.5 * (good + bad);
        if holds(middle) {
            good = middle;
        } else {
            bad = middle;
        }
    }
    good
}
