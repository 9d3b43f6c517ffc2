//! The sums of one cell through its moments.
//!
//! In a cell the basis functions are polynomials of the local places s and t,
//! and all that their products need of the points are the moments
//! `Σ w sᵃtᵇ`, a, b ≤ 2p: (2p+1)² multiply-adds a point (121 for biquintics)
//! in place of ((p+1)(p+2)/2)² (441).

use super::net::{MOST_ACTING, Net};
use super::springs::{Block, Springs};

/// Sums one chunk, which lies in one cell: `N` acting functions in each
/// direction, `K = 2N − 1` powers of their products, `T` pairs.
pub(super) fn by_moments<const D: usize, const N: usize, const K: usize, const T: usize>(
    net: &Net,
    springs: &Springs<D>,
    points: &[u32],
) -> Block<D> {
    let mut moments = [[0.0; K]; K];
    let mut values = [[[0.0; D]; N]; N];
    let (mut cell, mut square, mut counted) = ([0; 2], 0.0, 0);
    for group in points.chunks(GROUP) {
        // What a last, smaller group lacks has no weight.
        let (mut ps, mut pt) = ([[0.0; K]; GROUP], [[0.0; K]; GROUP]);
        let mut q = [[0.0; D]; GROUP];
        for (k, &i) in group.iter().enumerate() {
            let i = i as usize;
            let w = springs.weight[i];
            q[k] = springs.value[i];
            let [u, v] = springs.at[i];
            let ((i, s), (j, t)) = (net.spans[0].local(u), net.spans[1].local(v));
            cell = [i, j];
            (ps[k], pt[k]) = (powers::<K>(w, s), powers::<K>(1.0, t));
            square += w * q[k].iter().map(|x| x * x).sum::<f64>();
            counted += usize::from(w > 0.0);
        }
        add_moments(&ps, &pt, &mut moments);
        for d in 0..D {
            add_values(&ps, &pt, (&q, d), &mut values);
        }
    }
    let [(first_u, cu), (first_v, cv)] = [0, 1].map(|k| net.spans[k].polynomials(cell[k]));
    Block {
        first: [first_u, first_v],
        products: products::<N, K, T>(&moments, (cu, cv)),
        rhs: right_side::<D, N>(&values, (cu, cv)),
        square,
        points: counted,
    }
}

/// Points whose products are added at once: one load and one store of a sum
/// for all of them.
const GROUP: usize = 4;

#[inline]
fn add_moments<const K: usize>(
    [a, b, c, d]: &[[f64; K]; GROUP],
    [e, f, g, h]: &[[f64; K]; GROUP],
    moments: &mut [[f64; K]; K],
) {
    for (i, row) in moments.iter_mut().enumerate() {
        let (a, b, c, d) = (a[i], b[i], c[i], d[i]);
        for (j, slot) in row.iter_mut().enumerate() {
            *slot += (a * e[j] + b * f[j]) + (c * g[j] + d * h[j]);
        }
    }
}

#[inline]
fn add_values<const D: usize, const N: usize, const K: usize>(
    [a, b, c, d]: &[[f64; K]; GROUP],
    [e, f, g, h]: &[[f64; K]; GROUP],
    (q, field): (&[[f64; D]; GROUP], usize),
    values: &mut [[[f64; D]; N]; N],
) {
    let [qa, qb, qc, qd] = q.map(|q| q[field]);
    for (i, row) in values.iter_mut().enumerate() {
        let (a, b, c, d) = (a[i] * qa, b[i] * qb, c[i] * qc, d[i] * qd);
        for (j, slot) in row.iter_mut().enumerate() {
            slot[field] += (a * e[j] + b * f[j]) + (c * g[j] + d * h[j]);
        }
    }
}

/// `w, w t, w t², …`
#[inline]
fn powers<const K: usize>(w: f64, t: f64) -> [f64; K] {
    let mut powers = [0.0; K];
    let mut power = w;
    for slot in &mut powers {
        *slot = power;
        power *= t;
    }
    powers
}

type Polynomials = [[f64; MOST_ACTING]; MOST_ACTING];

/// Sums of products of pairs in u with pairs in v.
fn products<const N: usize, const K: usize, const T: usize>(
    moments: &[[f64; K]; K],
    (cu, cv): (&Polynomials, &Polynomials),
) -> Vec<f64> {
    let (pairs_u, pairs_v) = (pairs::<N, K, T>(cu), pairs::<N, K, T>(cv));
    let mut all = Vec::with_capacity(T * T);
    for p in &pairs_u {
        let mut along = [0.0; K];
        for (factor, row) in p.iter().zip(moments) {
            for (slot, m) in along.iter_mut().zip(row) {
                *slot += factor * m;
            }
        }
        all.extend(pairs_v.iter().map(|q| {
            let terms = q.iter().zip(&along).map(|(q, a)| q * a);
            terms.sum::<f64>()
        }));
    }
    all
}

/// Coefficients of the products of two functions, i ≤ j.
fn pairs<const N: usize, const K: usize, const T: usize>(c: &Polynomials) -> [[f64; K]; T] {
    let mut all = [[0.0; K]; T];
    let mut pair = 0;
    for i in 0..N {
        for j in i..N {
            for a in 0..N {
                for b in 0..N {
                    all[pair][a + b] += c[a][i] * c[b][j];
                }
            }
            pair += 1;
        }
    }
    all
}

/// Sums of functions with values.
fn right_side<const D: usize, const N: usize>(
    values: &[[[f64; D]; N]; N],
    (cu, cv): (&Polynomials, &Polynomials),
) -> [[f64; D]; MOST_ACTING * MOST_ACTING] {
    let mut rhs = [[0.0; D]; MOST_ACTING * MOST_ACTING];
    for a in 0..N {
        for b in 0..N {
            for i in 0..N {
                for j in 0..N {
                    let factor = cu[a][i] * cv[b][j];
                    for (slot, v) in rhs[i * N + j].iter_mut().zip(&values[a][b]) {
                        *slot += factor * v;
                    }
                }
            }
        }
    }
    rhs
}

#[cfg(test)]
mod tests {
    use super::super::springs::block;
    use super::*;
    use crate::geometry::Knots;

    /// Against the sums of the rows themselves, to rounding.
    #[test]
    fn moments_give_what_rows_give() {
        let knots = || Knots::uniform(5, [0.0, 3.0], 3).expect("valid");
        let net = Net::new([knots(), knots()]);
        let place = |i: u32, k: f64| 1.0 + 0.999 * (f64::from(i) * k).sin().abs();
        let n = 200;
        let springs = Springs::<2> {
            at: (0..n).map(|i| [place(i, 1.7), place(i, 2.3)]).collect(),
            value: (0..n).map(|i| [place(i, 0.9), place(i, 3.1)]).collect(),
            weight: (0..n).map(|i| place(i, 0.3)).collect(),
        };
        let points: Vec<u32> = (0..n).collect();
        let by_rows = block::<2, 6, 21>(&net, &springs, &points);
        let by_moments = by_moments::<2, 6, 11, 21>(&net, &springs, &points);
        assert_eq!(by_rows.first, by_moments.first);
        for (a, b) in by_rows.products.iter().zip(&by_moments.products) {
            assert!((a - b).abs() < 1e-11, "{a} {b}");
        }
        for (a, b) in by_rows.rhs.iter().zip(&by_moments.rhs) {
            assert!((a[0] - b[0]).abs() < 1e-11 && (a[1] - b[1]).abs() < 1e-11);
        }
    }
}
