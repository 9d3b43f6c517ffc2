//! Where a traced curve begins and ends, and its arc length.

use super::free::Shape;

/// Where the points begin and end. Dense points reach beyond the end by their
/// noise; but their number up to a place well inside, at their density, tells
/// how far outside the end is. Sparse ones end with the outermost.
pub(super) fn ends(parameters: &[f64], noise: f64) -> [f64; 2] {
    /// Points within the reach of the noise from which density tells more.
    const DENSE: usize = 40;
    /// Noise reaches this many deviations.
    const REACH: f64 = 5.0;
    let mut sorted = parameters.to_vec();
    sorted.sort_by(f64::total_cmp);
    let n = sorted.len();
    let length = sorted[n - 1] - sorted[0];
    let k = (REACH * noise / length * n as f64).ceil() as usize;
    if k < DENSE || 4 * k >= n / 4 {
        return [sorted[0], sorted[n - 1]];
    }
    let edge = |v: &dyn Fn(usize) -> f64| {
        let spacing = (v(4 * k) - v(k)) / (3 * k) as f64;
        v(k) - k as f64 * spacing
    };
    [edge(&|i| sorted[i]), edge(&|i| sorted[n - 1 - i])]
}

/// Arc length along a shape, from a table.
pub(super) struct Lengths {
    domain: [f64; 2],
    table: Vec<f64>,
}

impl Lengths {
    /// Steps of the table: the curve runs at nearly constant speed.
    const STEPS: usize = 4096;

    /// The table of a shape.
    pub(super) fn new<const D: usize>(shape: &Shape<D>) -> Self {
        let domain = shape.space.domain();
        let step = (domain[1] - domain[0]) / Self::STEPS as f64;
        let curve = shape.space.pieces(&shape.x);
        let mut table = vec![0.0];
        let mut sum = 0.0;
        for k in 0..Self::STEPS {
            // Midpoint rule: exact to 1e-6 and better, for parameters only.
            let u = domain[0] + (k as f64 + 0.5) * step;
            sum += step * curve.jet::<2>(u)[1].norm();
            table.push(sum);
        }
        Lengths { domain, table }
    }

    /// Length from the start to a parameter.
    pub(super) fn at(&self, u: f64) -> f64 {
        let place = (u - self.domain[0]) / (self.domain[1] - self.domain[0]) * Self::STEPS as f64;
        let k = (place.max(0.0) as usize).min(Self::STEPS - 1);
        self.table[k] + (place - k as f64) * (self.table[k + 1] - self.table[k])
    }

    /// Length of all.
    pub(super) fn total(&self) -> f64 {
        self.table[Self::STEPS]
    }
}
