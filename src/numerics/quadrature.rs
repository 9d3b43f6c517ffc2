//! Gauss–Legendre quadrature of any order.
//!
//! Nodes are the roots of the Legendre polynomial, found by Newton's method
//! from the estimate `cos(π (i + 3/4)/(n + 1/2))` (Abramowitz & Stegun
//! 22.16.6), weights `2/((1 − x²) P′(x)²)` (25.4.29). Accurate to a few units
//! in the last place for the orders used here (below 100).

/// Nodes and weights on [−1, 1]; exact for polynomials of degree `2n − 1`.
#[derive(Debug, Clone, PartialEq)]
pub struct GaussLegendre {
    nodes: Vec<f64>,
    weights: Vec<f64>,
}

/// Newton steps on a node: the start is good to 1e-3 or better, convergence
/// is quadratic, so that four suffice; the rest is reserve.
const NEWTON_STEPS: usize = 8;

impl GaussLegendre {
    /// The rule with `n` nodes (at least 1 is used).
    #[must_use]
    pub fn new(n: usize) -> Self {
        let n = n.max(1);
        let (mut nodes, mut weights) = (vec![0.0; n], vec![0.0; n]);
        for i in 0..n.div_ceil(2) {
            let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
            if 2 * i + 1 == n {
                x = 0.0;
            }
            for _ in 0..NEWTON_STEPS {
                let (p, dp) = legendre(n, x);
                x -= p / dp;
            }
            let (_, dp) = legendre(n, x);
            let w = 2.0 / ((1.0 - x * x) * dp * dp);
            (nodes[i], nodes[n - 1 - i]) = (-x, x);
            (weights[i], weights[n - 1 - i]) = (w, w);
        }
        GaussLegendre { nodes, weights }
    }

    /// Nodes on [−1, 1], increasing.
    #[must_use]
    pub fn nodes(&self) -> &[f64] {
        &self.nodes
    }

    /// Weights; they sum to 2.
    #[must_use]
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// Nodes and weights moved to the interval `[a, b]`.
    pub fn on(&self, a: f64, b: f64) -> impl Iterator<Item = (f64, f64)> + '_ {
        let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
        self.nodes
            .iter()
            .zip(&self.weights)
            .map(move |(x, w)| (middle + half * x, half * w))
    }

    /// `∫ f` over `[a, b]`.
    pub fn integrate(&self, a: f64, b: f64, mut f: impl FnMut(f64) -> f64) -> f64 {
        self.on(a, b).map(|(x, w)| w * f(x)).sum()
    }
}

/// `Pₙ(x)` and its derivative, by the three-term recurrence.
fn legendre(n: usize, x: f64) -> (f64, f64) {
    let (mut before, mut p) = (1.0, x);
    for k in 2..=n {
        let k = k as f64;
        (before, p) = (p, ((2.0 * k - 1.0) * x * p - (k - 1.0) * before) / k);
    }
    (p, n as f64 * (x * p - before) / (x * x - 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_up_to_its_degree_and_not_beyond() {
        for n in 1..=30 {
            let rule = GaussLegendre::new(n);
            for degree in 0..2 * n {
                let want = if degree % 2 == 0 {
                    2.0 / (degree as f64 + 1.0)
                } else {
                    0.0
                };
                let got = rule.integrate(-1.0, 1.0, |x| x.powi(degree as i32));
                assert!(
                    (got - want).abs() < 4e-15,
                    "n {n}, x^{degree}: {got} for {want}"
                );
            }
            assert!(rule.nodes().is_sorted());
        }
        let beyond = GaussLegendre::new(2).integrate(-1.0, 1.0, |x| x.powi(4));
        assert!((beyond - 0.4).abs() > 0.1);
    }

    /// Abramowitz & Stegun, table 25.4.
    #[test]
    fn table_of_five_points() {
        let rule = GaussLegendre::new(5);
        let nodes = [-0.906179845938664, -0.538469310105683, 0.0];
        let weights = [0.236926885056189, 0.478628670499366, 0.568888888888889];
        for i in 0..3 {
            assert!((rule.nodes()[i] - nodes[i]).abs() < 1e-15);
            assert!((rule.weights()[i] - weights[i]).abs() < 1e-15);
        }
    }
}
