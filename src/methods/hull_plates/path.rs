//! Which point of one profile is joined to which point of the other: a smooth
//! monotone path through the (s, t) square of arc-length fractions.
//!
//! With p = s + t (progress) and q = t − s (lead of the second end) a path is
//! one function q(p); it is monotone in both s and t exactly where |dq/dp| < 1.
//! Here q is a cubic B-spline with uniform knots over w ∈ [0, 1] and p is
//! linear in w. The ends follow from q alone:
//!
//! the path starts at (0, q₀) for q₀ > 0 or (−q₀, 0) for q₀ < 0, so p(0) = |q₀|,
//! and ends likewise at p(1) = 2 − |q₁|. What the path leaves uncovered at an
//! end is the triangle between a corner and the curve on the other side: a
//! cone with its apex in (or, as an extension, behind) that corner serves it.

use crate::geometry::bspline::{BasisJet, basis_jet};
use crate::geometry::{Knots, SplineError};

/// Degree of q(w).
const DEGREE: usize = 3;

/// The shape of a path: how ends are met and which samples are looked at.
#[derive(Debug, Clone)]
pub(super) struct PathShape {
    knots: Knots,
    /// |q| is rounded to √(q² + ε²) at the ends: without it a fit cannot pass
    /// from one side of a corner to the other.
    rounding: f64,
    /// Basis functions at the fixed samples.
    samples: Vec<BasisJet<3>>,
    stations: Vec<f64>,
}

/// A path evaluated at one sample, with derivatives along w.
#[derive(Debug, Clone, Copy)]
pub(super) struct PathPoint {
    pub(super) s: f64,
    pub(super) t: f64,
    /// ds/dw and dt/dw.
    pub(super) ds: f64,
    pub(super) dt: f64,
    /// d²q/dw².
    pub(super) bend: f64,
}

/// What the first and last coefficient of q do to p and to dp/dw, beside what
/// they do to q as every coefficient does.
#[derive(Debug, Clone, Copy)]
pub(super) struct EndEffect {
    pub(super) progress: [f64; 2],
    pub(super) speed: [f64; 2],
}

impl PathShape {
    /// q with knots at `breaks` (from 0 to 1, increasing) and `per_span`
    /// samples in each span, both ends included.
    pub(super) fn new(breaks: &[f64], per_span: usize) -> Result<Self, SplineError> {
        let inner = breaks
            .get(1..breaks.len().saturating_sub(1))
            .unwrap_or_default();
        let knots = Knots::clamped(DEGREE, [0.0, 1.0], inner)?;
        let within = |span: &[f64]| {
            let (a, b) = (span[0], span[1]);
            (0..per_span).map(move |i| a + (b - a) * i as f64 / per_span as f64)
        };
        let mut stations: Vec<f64> = breaks.windows(2).flat_map(within).collect();
        stations.push(1.0);
        let samples = stations.iter().map(|w| basis_jet(&knots, *w)).collect();
        Ok(PathShape {
            knots,
            rounding: 0.0,
            samples,
            stations,
        })
    }

    /// The same path looked at in more places.
    pub(super) fn with_more(&self, places: &[f64]) -> Self {
        let mut stations = self.stations.clone();
        stations.extend(places);
        stations.sort_by(f64::total_cmp);
        stations.dedup();
        let samples = stations
            .iter()
            .map(|w| basis_jet(&self.knots, *w))
            .collect();
        PathShape {
            stations,
            samples,
            ..self.clone()
        }
    }

    /// Number of unknowns: the coefficients of q.
    pub(super) fn unknowns(&self) -> usize {
        self.knots.control_count()
    }

    /// Samples along w.
    pub(super) fn stations(&self) -> &[f64] {
        &self.stations
    }

    /// Greville abscissae of the coefficients, along w.
    pub(super) fn greville(&self) -> Vec<f64> {
        self.knots.greville_abscissae()
    }

    /// Unknowns for the path with the given values of q at the Greville
    /// abscissae (Schoenberg's approximation: it cannot overshoot).
    pub(super) fn unknowns_from(&self, q: impl Fn(f64) -> f64) -> Vec<f64> {
        self.greville().into_iter().map(q).collect()
    }

    /// q at both ends.
    pub(super) fn end_leads(&self, y: &[f64]) -> [f64; 2] {
        [y[0], y[y.len() - 1]]
    }

    /// The same shape with corners rounded by `rounding` (0: sharp).
    pub(super) fn rounded(mut self, rounding: f64) -> Self {
        self.rounding = rounding;
        self
    }

    /// |q| as the ends see it, and its derivative.
    fn corner(&self, q: f64) -> (f64, f64) {
        if self.rounding == 0.0 {
            (q.abs(), q.signum())
        } else {
            let root = q.hypot(self.rounding);
            (root, q / root)
        }
    }

    fn progress_range(&self, leads: [f64; 2]) -> [f64; 2] {
        let [start, end] = leads.map(|q| self.corner(q).0);
        [start, 2.0 - end]
    }

    /// The path at sample `i`.
    pub(super) fn at_sample(&self, y: &[f64], i: usize) -> PathPoint {
        self.evaluate(y, self.stations[i], &self.samples[i])
    }

    /// The path anywhere.
    pub(super) fn at(&self, y: &[f64], w: f64) -> PathPoint {
        self.evaluate(y, w, &basis_jet(&self.knots, w))
    }

    fn evaluate(&self, y: &[f64], w: f64, basis: &BasisJet<3>) -> PathPoint {
        let [p0, p1] = self.progress_range(self.end_leads(y));
        let acting = &y[basis.first..];
        let q = [0, 1, 2].map(|order| {
            basis
                .derivative(order)
                .iter()
                .zip(acting)
                .map(|(b, c)| b * c)
                .sum::<f64>()
        });
        let (p, dp) = (p0 + (p1 - p0) * w, p1 - p0);
        PathPoint {
            s: 0.5 * (p - q[0]),
            t: 0.5 * (p + q[0]),
            ds: 0.5 * (dp - q[1]),
            dt: 0.5 * (dp + q[1]),
            bend: q[2],
        }
    }

    /// The w at which curve `k` (0 or 1) is at `fraction`, clamped to [0, 1].
    pub(super) fn place_of(&self, y: &[f64], k: usize, fraction: f64) -> f64 {
        /// Halvings that bring the unit interval below rounding.
        const HALVINGS: usize = 50;
        let at = |w: f64| {
            let here = self.at(y, w);
            if k == 0 { here.s } else { here.t }
        };
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if at(middle) < fraction {
                low = middle
            } else {
                high = middle
            }
        }
        0.5 * (low + high)
    }

    /// Basis functions behind sample `i`.
    pub(super) fn basis(&self, i: usize) -> &BasisJet<3> {
        &self.samples[i]
    }

    /// What the end unknowns do to p at sample `i`.
    pub(super) fn end_effect(&self, y: &[f64], i: usize) -> EndEffect {
        let w = self.stations[i];
        let [start, end] = self.end_leads(y).map(|q| self.corner(q).1);
        EndEffect {
            progress: [start * (1.0 - w), -end * w],
            speed: [-start, -end],
        }
    }

    /// How far the path passes from (s, t), as q − (t − s) at the same
    /// progress, with its derivatives by the unknowns.
    pub(super) fn miss(&self, y: &[f64], s: f64, t: f64) -> (f64, Vec<(usize, f64)>) {
        let leads = self.end_leads(y);
        let [p0, p1] = self.progress_range(leads);
        let w = ((s + t - p0) / (p1 - p0)).clamp(0.0, 1.0);
        let basis = basis_jet(&self.knots, w);
        let here = self.evaluate(y, w, &basis);
        let last = y.len() - 1;
        let values = basis.values().iter().enumerate();
        let mut gradient: Vec<(usize, f64)> = values.map(|(k, b)| (basis.first + k, *b)).collect();
        // w itself moves with the ends: dw = −((1−w) dp₀ + w dp₁) / (p₁ − p₀).
        let slope = (here.dt - here.ds) / (p1 - p0);
        gradient.push((0, -slope * (1.0 - w) * self.corner(leads[0]).1));
        gradient.push((last, slope * w * self.corner(leads[1]).1));
        (here.t - here.s - (t - s), gradient)
    }
}
