//! Functions on an interval as Legendre series, through their values at Gauss
//! nodes: what it takes to integrate a rate to a function that can be evaluated
//! anywhere, to rounding.
//!
//! The coefficients are `cₖ = (2k+1)/2 Σ wᵢ Pₖ(xᵢ) f(xᵢ)`; the integral follows
//! from `∫ Pₖ = (Pₖ₊₁ − Pₖ₋₁)/(2k+1)` (Abramowitz & Stegun 8.6.19).

use super::quadrature::GaussLegendre;

/// Values of a function, and coefficients of its series.
pub const ORDER: usize = 12;

/// Nodes on [−1, 1] and the way from values there to coefficients.
#[derive(Debug, Clone)]
pub struct LegendreRule {
    nodes: [f64; ORDER],
    transform: [[f64; ORDER]; ORDER],
}

/// A series on [−1, 1].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LegendreSeries([f64; ORDER + 1]);

impl LegendreRule {
    /// The rule of [`ORDER`] nodes.
    #[must_use]
    pub fn new() -> Self {
        let rule = GaussLegendre::new(ORDER);
        let mut nodes = [0.0; ORDER];
        let mut transform = [[0.0; ORDER]; ORDER];
        for (i, (x, w)) in rule.nodes().iter().zip(rule.weights()).enumerate() {
            nodes[i] = *x;
            for (k, row) in transform.iter_mut().enumerate() {
                row[i] = (k as f64 + 0.5) * w * polynomials(*x)[k];
            }
        }
        LegendreRule { nodes, transform }
    }

    /// The nodes, increasing.
    #[must_use]
    pub fn nodes(&self) -> &[f64; ORDER] {
        &self.nodes
    }

    /// The series through values at the nodes.
    #[must_use]
    pub fn series(&self, values: &[f64; ORDER]) -> LegendreSeries {
        let mut series = [0.0; ORDER + 1];
        for (c, row) in series.iter_mut().zip(&self.transform) {
            *c = row.iter().zip(values).map(|(t, v)| t * v).sum();
        }
        LegendreSeries(series)
    }
}

impl Default for LegendreRule {
    fn default() -> Self {
        Self::new()
    }
}

impl LegendreSeries {
    /// The integral that is `start` at −1.
    #[must_use]
    pub fn integral(&self, start: f64) -> Self {
        let c = &self.0;
        let at = |k: usize| c.get(k).copied().unwrap_or(0.0);
        let mut integral = [0.0; ORDER + 1];
        integral[0] = start + c[0] - c[1] / 3.0;
        for (k, i) in integral.iter_mut().enumerate().skip(1) {
            let degree = k as f64;
            *i = c[k - 1] / (2.0 * degree - 1.0) - at(k + 1) / (2.0 * degree + 3.0);
        }
        LegendreSeries(integral)
    }

    /// The value at `x` in [−1, 1].
    #[must_use]
    pub fn at(&self, x: f64) -> f64 {
        let p = polynomials(x);
        self.0.iter().zip(&p).map(|(c, p)| c * p).sum()
    }

    /// The size of the last two coefficients of a series through values: what
    /// it leaves out is of the order of these.
    #[must_use]
    pub fn tail(&self) -> f64 {
        self.0[ORDER - 2].abs() + self.0[ORDER - 1].abs()
    }
}

/// P₀ … at x, by the three-term recurrence.
fn polynomials(x: f64) -> [f64; ORDER + 1] {
    let mut p = [1.0; ORDER + 1];
    p[1] = x;
    for k in 1..ORDER {
        let degree = k as f64;
        p[k + 1] = ((2.0 * degree + 1.0) * x * p[k] - degree * p[k - 1]) / (degree + 1.0);
    }
    p
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_series_and_its_integral_are_those_of_the_function() {
        let rule = LegendreRule::new();
        let series = rule.series(&rule.nodes().map(|x| (2.0 * x).cos()));
        let integral = series.integral(5.0);
        for x in [-1.0, -0.3, 0.0, 0.77, 1.0] {
            assert!((series.at(x) - (2.0 * x).cos()).abs() < 1e-7);
            let exact = 5.0 + 0.5 * ((2.0 * x).sin() + 2.0f64.sin());
            assert!((integral.at(x) - exact).abs() < 1e-8);
        }
        assert!(series.tail() < 1e-5 && series.tail() > 1e-14);
    }

    #[test]
    fn polynomials_below_the_order_are_exact() {
        let rule = LegendreRule::new();
        let series = rule.series(&rule.nodes().map(|x| x.powi(11) - 3.0 * x));
        for x in [-1.0, -0.4, 0.9] {
            assert!((series.at(x) - (x.powi(11) - 3.0 * x)).abs() < 1e-14);
            let exact = (x.powi(12) - 1.0) / 12.0 - 1.5 * (x * x - 1.0);
            assert!((series.integral(0.0).at(x) - exact).abs() < 1e-14);
        }
    }
}
