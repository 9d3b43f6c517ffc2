//! The space of a fit: a tensor product of two knot vectors, its numbering of
//! the unknowns, and the sheets that live in it.

use super::spans::{Acting, Spans};
use crate::geometry::Knots;
use nalgebra::{Point3, Vector3};

/// Most basis functions that act in one direction: degree 5 and one.
pub(in super::super) const MOST_ACTING: usize = 6;

/// A tensor-product spline space with equal degrees (3, 4 or 5) in u and v.
#[derive(Debug, Clone, PartialEq)]
pub(in super::super) struct Net {
    /// Knots in u and in v.
    pub(in super::super) knots: [Knots; 2],
    /// Their spans.
    pub(in super::super) spans: [Spans; 2],
    counts: [usize; 2],
}

impl Net {
    pub(in super::super) fn new(knots: [Knots; 2]) -> Self {
        debug_assert_eq!(knots[0].degree(), knots[1].degree());
        debug_assert!(knots[0].degree() < MOST_ACTING);
        let spans = [Spans::new(&knots[0]), Spans::new(&knots[1])];
        let counts = [knots[0].control_count(), knots[1].control_count()];
        Net {
            knots,
            spans,
            counts,
        }
    }

    /// Control points in u and v.
    #[inline]
    pub(in super::super) fn counts(&self) -> [usize; 2] {
        self.counts
    }

    /// Number of control points.
    pub(in super::super) fn len(&self) -> usize {
        self.counts[0] * self.counts[1]
    }

    pub(in super::super) fn degree(&self) -> usize {
        self.knots[0].degree()
    }

    /// Lines in u and in v across which sheets of this net may have a knuckle.
    pub(in super::super) fn knuckles(&self) -> [usize; 2] {
        [0, 1].map(|k| {
            let [low, high] = self.knots[k].domain();
            let inner = |(u, times): &(f64, usize)| {
                *u > low && *u < high && *times >= self.knots[k].degree()
            };
            self.knots[k].distinct().iter().filter(|d| inner(d)).count()
        })
    }

    /// The number of control point (i, j): the shorter direction runs
    /// fastest, so that the band is as narrow as it can be.
    pub(in super::super) fn index(&self, i: usize, j: usize) -> usize {
        let [nu, nv] = self.counts();
        if nv <= nu { i * nv + j } else { j * nu + i }
    }

    /// Diagonals below the main one of the matrices of this net.
    pub(in super::super) fn half_bandwidth(&self) -> usize {
        let [nu, nv] = self.counts();
        self.degree() * (nu.min(nv) + 1)
    }

    /// Basis functions in u and v with `R − 1` derivatives.
    pub(in super::super) fn jets<const R: usize>(&self, [u, v]: [f64; 2]) -> [Acting<R>; 2] {
        [self.spans[0].acting(u), self.spans[1].acting(v)]
    }

    /// First and last parameter of each direction.
    pub(in super::super) fn domain(&self) -> [[f64; 2]; 2] {
        [self.knots[0].domain(), self.knots[1].domain()]
    }

    /// (u, v) moved into the domain.
    pub(in super::super) fn clamp(&self, at: [f64; 2]) -> [f64; 2] {
        let domain = self.domain();
        [0, 1].map(|k| at[k].clamp(domain[k][0], domain[k][1]))
    }
}

/// A sheet in space over a net; control points numbered by [`Net::index`].
#[derive(Debug, Clone)]
pub(in super::super) struct Sheet {
    pub(in super::super) net: Net,
    pub(in super::super) control: Vec<Vector3<f64>>,
    /// Whether x and y are the parameters themselves, so that only heights
    /// need be summed.
    pub(in super::super) plane: bool,
}

/// Place and first derivatives on a sheet.
#[derive(Debug, Clone, Copy)]
pub(in super::super) struct Tangents {
    pub(in super::super) point: Vector3<f64>,
    pub(in super::super) du: Vector3<f64>,
    pub(in super::super) dv: Vector3<f64>,
}

/// Place, first and second derivatives on a sheet.
#[derive(Debug, Clone, Copy)]
pub(in super::super) struct Bends {
    pub(in super::super) first: Tangents,
    pub(in super::super) duu: Vector3<f64>,
    pub(in super::super) duv: Vector3<f64>,
    pub(in super::super) dvv: Vector3<f64>,
}

impl Tangents {
    /// The unit normal; `None` where the sheet is singular.
    pub(in super::super) fn normal(&self) -> Option<Vector3<f64>> {
        self.du.cross(&self.dv).try_normalize(f64::MIN_POSITIVE)
    }
}

impl Bends {
    /// Gaussian and mean curvature (do Carmo §3.3); `None` where singular.
    pub(in super::super) fn curvatures(&self) -> Option<[f64; 2]> {
        let n = self.first.normal()?;
        let (du, dv) = (&self.first.du, &self.first.dv);
        let (e, f, g) = (du.dot(du), du.dot(dv), dv.dot(dv));
        let (l, m, k) = (self.duu.dot(&n), self.duv.dot(&n), self.dvv.dot(&n));
        let area = e * g - f * f;
        (area > 0.0).then(|| {
            [
                (l * k - m * m) / area,
                (e * k - 2.0 * f * m + g * l) / (2.0 * area),
            ]
        })
    }
}

impl Sheet {
    /// The sheet (u, v, h) over its own parameter plane from the control
    /// heights of a field h(u, v): Greville abscissae reproduce u and v.
    pub(in super::super) fn of_heights(net: &Net, heights: &[[f64; 1]]) -> Self {
        let [nu, nv] = net.counts();
        let mut control = vec![Vector3::zeros(); net.len()];
        for i in 0..nu {
            for j in 0..nv {
                let k = net.index(i, j);
                control[k] = Vector3::new(
                    net.knots[0].greville(i),
                    net.knots[1].greville(j),
                    heights[k][0],
                );
            }
        }
        Sheet {
            net: net.clone(),
            control,
            plane: true,
        }
    }

    /// The sheet of the three coordinate fields.
    pub(in super::super) fn of_points(net: &Net, control: &[[f64; 3]]) -> Self {
        Sheet {
            net: net.clone(),
            control: control.iter().map(|c| Vector3::from(*c)).collect(),
            plane: false,
        }
    }

    /// Sums `Σ N_i⁽ᵃ⁾(u) N_j⁽ᵇ⁾(v) P_ij` for the wanted pairs (a, b).
    #[inline]
    fn sums<const R: usize, const S: usize>(
        &self,
        at: [f64; 2],
        orders: [[usize; 2]; S],
    ) -> [Vector3<f64>; S] {
        if !self.plane {
            return self.coordinates::<3, R, S>(at, orders).map(Vector3::from);
        }
        let [u, v] = self.net.clamp(at);
        let heights = self.coordinates::<1, R, S>(at, orders);
        let mut sums = [Vector3::zeros(); S];
        for ((sum, [z]), order) in sums.iter_mut().zip(heights).zip(orders) {
            *sum = match order {
                [0, 0] => Vector3::new(u, v, z),
                [1, 0] => Vector3::new(1.0, 0.0, z),
                [0, 1] => Vector3::new(0.0, 1.0, z),
                _ => Vector3::new(0.0, 0.0, z),
            };
        }
        sums
    }

    /// The last `D` coordinates of [`Self::sums`], row by row of the direction
    /// that runs fastest in memory.
    #[inline]
    fn coordinates<const D: usize, const R: usize, const S: usize>(
        &self,
        at: [f64; 2],
        orders: [[usize; 2]; S],
    ) -> [[f64; D]; S] {
        let jets = self.net.jets::<R>(at);
        let [nu, nv] = self.net.counts();
        let fast = usize::from(nv <= nu);
        let (slow_jet, fast_jet) = (&jets[1 - fast], &jets[fast]);
        let width = [nu, nv][fast];
        let mut sums = [[0.0; D]; S];
        for a in 0..slow_jet.count {
            let start = (slow_jet.first + a) * width + fast_jet.first;
            let points = &self.control[start..start + fast_jet.count];
            let mut rows = [[0.0; D]; R];
            for (order, row) in rows.iter_mut().enumerate() {
                for (p, n) in points.iter().zip(fast_jet.derivative(order)) {
                    for (d, sum) in row.iter_mut().enumerate() {
                        *sum += p[3 - D + d] * n;
                    }
                }
            }
            for (sum, order) in sums.iter_mut().zip(orders) {
                let weight = slow_jet.derivative(order[1 - fast])[a];
                for (s, r) in sum.iter_mut().zip(rows[order[fast]]) {
                    *s += r * weight;
                }
            }
        }
        sums
    }

    /// The point at (u, v).
    pub(in super::super) fn point(&self, at: [f64; 2]) -> Vector3<f64> {
        self.sums::<1, 1>(at, [[0, 0]])[0]
    }

    /// Point and first derivatives at (u, v).
    pub(in super::super) fn tangents(&self, at: [f64; 2]) -> Tangents {
        let [point, du, dv] = self.sums::<2, 3>(at, [[0, 0], [1, 0], [0, 1]]);
        Tangents { point, du, dv }
    }

    /// Point, first and second derivatives at (u, v).
    pub(in super::super) fn bends(&self, at: [f64; 2]) -> Bends {
        let orders = [[0, 0], [1, 0], [0, 1], [2, 0], [1, 1], [0, 2]];
        let [point, du, dv, duu, duv, dvv] = self.sums::<3, 6>(at, orders);
        Bends {
            first: Tangents { point, du, dv },
            duu,
            duv,
            dvv,
        }
    }

    /// Control points with `v` fastest, as surfaces want them.
    pub(in super::super) fn points_v_fastest(&self) -> Vec<Point3<f64>> {
        let [nu, nv] = self.net.counts();
        (0..nu * nv)
            .map(|k| Point3::from(self.control[self.net.index(k / nv, k % nv)]))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All derivatives against differences of the values below them, in both
    /// numberings.
    #[test]
    fn derivatives_agree_with_differences() {
        for (nu, nv) in [(4, 9), (9, 4)] {
            let knots = |n| Knots::uniform(4, [0.0, 1.0], n).expect("valid");
            let net = Net::new([knots(nu), knots(nv)]);
            let place = |k: usize| {
                let x = k as f64;
                Vector3::new((1.3 * x).sin(), (0.7 * x).cos(), (2.1 * x).sin())
            };
            let sheet = Sheet {
                control: (0..net.len()).map(place).collect(),
                net,
                plane: false,
            };
            let h = 1e-6;
            for at in [[0.11, 0.87], [0.52, 0.31], [0.93, 0.05]] {
                let b = sheet.bends(at);
                let (ahead, behind) = ([at[0] + h, at[1]], [at[0] - h, at[1]]);
                let (above, below) = ([at[0], at[1] + h], [at[0], at[1] - h]);
                let slope = |f: &dyn Fn([f64; 2]) -> Vector3<f64>, a, b| (f(a) - f(b)) / (2.0 * h);
                let point = |at| sheet.point(at);
                let du = |at| sheet.tangents(at).du;
                let dv = |at| sheet.tangents(at).dv;
                for (have, want) in [
                    (b.first.du, slope(&point, ahead, behind)),
                    (b.first.dv, slope(&point, above, below)),
                    (b.duu, slope(&du, ahead, behind)),
                    (b.duv, slope(&du, above, below)),
                    (b.dvv, slope(&dv, above, below)),
                ] {
                    assert!(
                        (have - want).norm() < 1e-6 * (1.0 + have.norm()),
                        "{have} {want}"
                    );
                }
            }
        }
    }
}
