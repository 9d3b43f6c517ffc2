//! Knot vectors: sorted, finite, clamped; the one place that checks it.

use super::SplineError;
use std::ops::Deref;

/// Largest degree of a spline. High enough for every curve that design systems
/// exchange (they stop at 9 or earlier in practice), low enough for all
/// evaluation to live on the stack.
pub const MAX_DEGREE: usize = 9;

/// A knot vector with its degree. Invariants: all knots finite and sorted; the
/// first and the last value occur exactly `degree + 1` times, inner values at
/// most `degree` times; the domain has positive length.
#[derive(Debug, Clone, PartialEq)]
pub struct Knots {
    degree: usize,
    values: Vec<f64>,
}

impl Deref for Knots {
    type Target = [f64];
    fn deref(&self) -> &[f64] {
        &self.values
    }
}

impl Knots {
    /// Checks and wraps a knot vector with multiplicities written out.
    ///
    /// # Errors
    /// The first broken invariant, as a [`SplineError`].
    ///
    /// ```
    /// use mouldloft::geometry::{Knots, SplineError};
    /// assert!(Knots::new(1, vec![0.0, 0.0, 0.5, 1.0, 1.0]).is_ok());
    /// assert_eq!(
    ///     Knots::new(1, vec![0.0, 0.0, 0.5, 0.5, 1.0, 1.0]),
    ///     Err(SplineError::Multiplicity { value: 0.5, multiplicity: 2, degree: 1 })
    /// );
    /// ```
    pub fn new(degree: usize, values: Vec<f64>) -> Result<Self, SplineError> {
        if degree == 0 || degree > MAX_DEGREE {
            return Err(SplineError::Degree { degree });
        }
        if values.len() < 2 * (degree + 1) {
            return Err(SplineError::TooFewKnots {
                knots: values.len(),
                degree,
            });
        }
        if let Some(index) = values.iter().position(|t| !t.is_finite()) {
            return Err(SplineError::KnotNotFinite {
                index,
                value: values[index],
            });
        }
        if let Some(k) = values.windows(2).position(|w| w[1] < w[0]) {
            let (before, value) = (values[k], values[k + 1]);
            return Err(SplineError::KnotsDecrease {
                index: k + 1,
                value,
                before,
            });
        }
        let knots = Knots { degree, values };
        knots.check_multiplicities()?;
        Ok(knots)
    }

    fn check_multiplicities(&self) -> Result<(), SplineError> {
        let degree = self.degree;
        let distinct = self.distinct();
        let last = distinct.len() - 1;
        for (i, &(value, multiplicity)) in distinct.iter().enumerate() {
            let end = i == 0 || i == last;
            // A single distinct value is both ends at once, with too many.
            if end && multiplicity != degree + 1 {
                return Err(SplineError::NotClamped {
                    start: i == 0,
                    value,
                    multiplicity,
                    degree,
                });
            }
            if !end && multiplicity > degree {
                return Err(SplineError::Multiplicity {
                    value,
                    multiplicity,
                    degree,
                });
            }
        }
        Ok(())
    }

    /// Wraps values that satisfy the invariants by construction.
    pub(super) fn trusted(degree: usize, values: Vec<f64>) -> Self {
        let knots = Knots { degree, values };
        debug_assert_eq!(
            Knots::new(degree, knots.values.clone()).as_ref(),
            Ok(&knots)
        );
        knots
    }

    /// Clamped knots with the given inner knots (multiplicities written out).
    ///
    /// # Errors
    /// As [`Knots::new`].
    pub fn clamped(degree: usize, domain: [f64; 2], inner: &[f64]) -> Result<Self, SplineError> {
        let mut values = vec![domain[0]; degree + 1];
        values.extend_from_slice(inner);
        values.resize(inner.len() + 2 * (degree + 1), domain[1]);
        Self::new(degree, values)
    }

    /// `spans` equal spans on `domain` (at least one is used).
    ///
    /// # Errors
    /// As [`Knots::new`], for example an empty domain.
    pub fn uniform(degree: usize, domain: [f64; 2], spans: usize) -> Result<Self, SplineError> {
        let step = (domain[1] - domain[0]) / spans.max(1) as f64;
        let inner: Vec<f64> = (1..spans).map(|i| domain[0] + i as f64 * step).collect();
        Self::clamped(degree, domain, &inner)
    }

    /// The knots for interpolation at increasing `parameters`, each inner knot
    /// the mean of `degree` consecutive parameters (de Boor's averaging; Piegl
    /// & Tiller eq. 9.8; Zheng & Bo 2018 eq. 1). As many control points as
    /// parameters, and the collocation matrix is regular (Schoenberg–Whitney).
    ///
    /// # Errors
    /// Too few parameters or parameters that do not increase.
    pub fn averaged(degree: usize, parameters: &[f64]) -> Result<Self, SplineError> {
        let n = parameters.len();
        if n < degree + 1 {
            return Err(SplineError::TooFewPoints {
                given: n,
                needed: degree + 1,
            });
        }
        check_increasing(parameters)?;
        let inner: Vec<f64> = parameters[1..n - 1]
            .windows(degree.max(1))
            .map(|w| w.iter().sum::<f64>() / degree as f64)
            .collect();
        Self::clamped(degree, [parameters[0], parameters[n - 1]], &inner)
    }

    /// The degree.
    #[must_use]
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// All knots, multiplicities written out.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The bare knot vector.
    #[must_use]
    pub fn into_values(self) -> Vec<f64> {
        self.values
    }

    /// Number of control points that go with these knots.
    #[must_use]
    pub fn control_count(&self) -> usize {
        self.values.len() - self.degree - 1
    }

    /// First and last parameter.
    #[must_use]
    pub fn domain(&self) -> [f64; 2] {
        [self.values[0], self.values[self.values.len() - 1]]
    }

    /// The span `k` with `t[k] ≤ u < t[k+1]`; the last nonempty span at and
    /// beyond the end, the first before the start.
    #[must_use]
    pub fn span(&self, u: f64) -> usize {
        span(self.degree, &self.values, u)
    }

    /// The span `k` with `t[k] < u ≤ t[k+1]`: for limits from the left.
    #[must_use]
    pub fn span_left(&self, u: f64) -> usize {
        span_left(self.degree, &self.values, u)
    }

    /// Distinct values with their multiplicities, increasing.
    #[must_use]
    pub fn distinct(&self) -> Vec<(f64, usize)> {
        self.values
            .chunk_by(|a, b| a == b)
            .map(|run| (run[0], run.len()))
            .collect()
    }

    /// Distinct values, ends included: the borders of the polynomial pieces.
    #[must_use]
    pub fn breakpoints(&self) -> Vec<f64> {
        self.values
            .chunk_by(|a, b| a == b)
            .map(|run| run[0])
            .collect()
    }

    /// How often `u` occurs (0 where it is no knot).
    #[must_use]
    pub fn multiplicity(&self, u: f64) -> usize {
        let from = self.values.partition_point(|t| *t < u);
        self.values[from..].iter().take_while(|t| **t == u).count()
    }

    /// The Greville abscissa of control point `i`: the mean of the knots
    /// `t[i+1..=i+degree]`, where a control point acts most.
    #[must_use]
    pub fn greville(&self, i: usize) -> f64 {
        let inside = &self.values[i + 1..=i + self.degree];
        let first = inside[0];
        first + inside.iter().map(|t| t - first).sum::<f64>() / self.degree as f64
    }

    /// All Greville abscissae, increasing.
    #[must_use]
    pub fn greville_abscissae(&self) -> Vec<f64> {
        (0..self.control_count())
            .map(|i| self.greville(i))
            .collect()
    }

    /// Every knot of either vector with its larger multiplicity. Only equal
    /// numbers are merged; nearly equal knots stay two.
    ///
    /// # Errors
    /// [`SplineError::DegreesDiffer`], [`SplineError::DomainsDiffer`].
    pub fn union(&self, other: &Knots) -> Result<Knots, SplineError> {
        if self.degree != other.degree {
            return Err(SplineError::DegreesDiffer {
                first: self.degree,
                second: other.degree,
            });
        }
        if self.domain() != other.domain() {
            let (first, second) = (self.domain(), other.domain());
            return Err(SplineError::DomainsDiffer { first, second });
        }
        let missing = self.missing_from(other);
        let mut values = self.values.clone();
        values.extend(missing);
        values.sort_by(f64::total_cmp);
        Ok(Knots::trusted(self.degree, values))
    }

    /// The knots of `other`, with multiplicity, that these lack.
    #[must_use]
    pub fn missing_from(&self, other: &Knots) -> Vec<f64> {
        let mut missing = Vec::new();
        for (t, m) in other.distinct() {
            let lacking = m.saturating_sub(self.multiplicity(t));
            missing.extend(std::iter::repeat_n(t, lacking));
        }
        missing
    }

    /// The knots of the reversed curve: `a + b − t` in the same domain.
    /// Distinct knots stay distinct, by a unit in the last place where
    /// rounding would merge them.
    #[must_use]
    pub fn reversed(&self) -> Knots {
        let [a, b] = self.domain();
        let runs = self.distinct();
        let mut mirrored: Vec<f64> = runs.iter().rev().map(|(t, _)| a + (b - t)).collect();
        let last = mirrored.len() - 1;
        (mirrored[0], mirrored[last]) = (a, b);
        for k in 1..last {
            mirrored[k] = mirrored[k].max(mirrored[k - 1].next_up());
        }
        for k in (1..last).rev() {
            mirrored[k] = mirrored[k].min(mirrored[k + 1].next_down());
        }
        let counts = runs.iter().rev().map(|(_, m)| *m);
        let values = mirrored.into_iter().zip(counts);
        let values = values
            .flat_map(|(t, m)| std::iter::repeat_n(t, m))
            .collect();
        Knots::trusted(self.degree, values)
    }

    /// The knots moved by an increasing affine map onto `domain`.
    ///
    /// # Errors
    /// As [`Knots::new`], if the new domain is empty or too small to keep the
    /// knots apart.
    pub fn on_domain(&self, domain: [f64; 2]) -> Result<Knots, SplineError> {
        let [a, b] = self.domain();
        let map = |t: &f64| match *t {
            t if t == a => domain[0],
            t if t == b => domain[1],
            t => domain[0] + (t - a) / (b - a) * (domain[1] - domain[0]),
        };
        Knots::new(self.degree, self.values.iter().map(map).collect())
    }
}

/// Refuses parameters that are not finite and strictly increasing.
pub(super) fn check_increasing(parameters: &[f64]) -> Result<(), SplineError> {
    match parameters
        .windows(2)
        .position(|w| !(w[1] > w[0] && (w[1] - w[0]).is_finite()))
    {
        Some(k) => Err(SplineError::ParametersNotIncreasing { index: k + 1 }),
        None => Ok(()),
    }
}

/// [`Knots::span`] on a bare (checked) knot vector.
pub(super) fn span(degree: usize, knots: &[f64], u: f64) -> usize {
    let inner = &knots[degree + 1..knots.len() - degree - 1];
    degree + inner.partition_point(|t| *t <= u)
}

/// [`Knots::span_left`] on a bare (checked) knot vector.
pub(super) fn span_left(degree: usize, knots: &[f64], u: f64) -> usize {
    let inner = &knots[degree + 1..knots.len() - degree - 1];
    degree + inner.partition_point(|t| *t < u)
}

#[cfg(test)]
mod tests;
