//! The constraints of a hard tolerance: every point has a strip about it in
//! which the sheet must pass.
//!
//! Control point k moves by `c_k` along its own direction `n_k` (normal of
//! the sheet, or the one axis that is free); point i looks along `m_i`. Row i
//! is then `a_ik = N_k(uᵢ, vᵢ) (n_k·m_i)/εᵢ` and the strip `|a_i c − rᵢ| ≤ 1`:
//! one unknown a control point, since moves within the sheet only change its
//! parameters.

use super::net::{MOST_ACTING, Net};
use super::springs::Cells;
use crate::numerics::EnvelopeMatrix;
use nalgebra::Vector3;
use rayon::prelude::*;

/// Most entries of a row.
const MOST: usize = MOST_ACTING * MOST_ACTING;

/// All strips.
#[derive(Debug)]
pub(super) struct Strips<'a> {
    pub(super) net: &'a Net,
    /// n_k, one a control point.
    pub(super) directions: &'a [Vector3<f64>],
    /// Places of the points.
    pub(super) at: Vec<[f64; 2]>,
    /// m_i/εᵢ, one a point.
    pub(super) looks: Vec<Vector3<f64>>,
    /// rᵢ: offset of the point from the sheet along m_i, in ε.
    pub(super) offset: Vec<f64>,
    /// The points by cell.
    pub(super) cells: Cells,
}

/// One row: its entries, u slowest.
struct Row {
    first: [usize; 2],
    entries: [f64; MOST],
}

impl Strips<'_> {
    fn row(&self, i: usize) -> Row {
        let [ju, jv] = self.net.jets::<1>(self.at[i]);
        let mut entries = [0.0; MOST];
        let n = ju.count;
        for (a, x) in ju.values().iter().enumerate() {
            for (b, y) in jv.values().iter().enumerate() {
                let k = self.net.index(ju.first + a, jv.first + b);
                entries[a * n + b] = x * y * self.directions[k].dot(&self.looks[i]);
            }
        }
        Row {
            first: [ju.first, jv.first],
            entries,
        }
    }

    fn places(&self, first: [usize; 2]) -> Vec<usize> {
        let n = self.net.degree() + 1;
        (0..n * n)
            .map(|l| self.net.index(first[0] + l / n, first[1] + l % n))
            .collect()
    }

    /// `A c`.
    pub(super) fn apply(&self, c: &[f64]) -> Vec<f64> {
        (0..self.at.len())
            .into_par_iter()
            .with_min_len(512)
            .map(|i| {
                let row = self.row(i);
                let places = self.places(row.first);
                places.iter().zip(row.entries).map(|(k, a)| a * c[*k]).sum()
            })
            .collect()
    }

    /// `Aᵀ y`.
    pub(super) fn transpose(&self, y: &[f64]) -> Vec<f64> {
        let sum = |points: &[u32]| {
            let mut first = [0; 2];
            let mut sums = [0.0; MOST];
            for i in points {
                let row = self.row(*i as usize);
                first = row.first;
                for (s, a) in sums.iter_mut().zip(row.entries) {
                    *s += a * y[*i as usize];
                }
            }
            (first, sums)
        };
        let blocks: Vec<_> = self.cells.chunks().map(sum).collect();
        let mut out = vec![0.0; self.net.len()];
        for (first, sums) in &blocks {
            for (k, s) in self.places(*first).into_iter().zip(sums) {
                out[k] += s;
            }
        }
        out
    }

    /// Adds `Aᵀ diag(w) A`.
    pub(super) fn add_weighted(&self, w: &[f64], matrix: &mut EnvelopeMatrix) {
        let count = (self.net.degree() + 1) * (self.net.degree() + 1);
        let sum = |points: &[u32]| {
            let mut first = [0; 2];
            let mut sums = vec![0.0; count * (count + 1) / 2];
            for i in points {
                let row = self.row(*i as usize);
                first = row.first;
                let mut k = 0;
                for l in 0..count {
                    let scaled = w[*i as usize] * row.entries[l];
                    let target = &mut sums[k..=k + l];
                    for (slot, a) in target.iter_mut().zip(&row.entries) {
                        *slot += scaled * a;
                    }
                    k += l + 1;
                }
            }
            (first, sums)
        };
        let blocks: Vec<_> = self.cells.chunks().map(sum).collect();
        for (first, sums) in &blocks {
            let places = self.places(*first);
            let mut k = 0;
            for l in 0..count {
                for m in 0..=l {
                    matrix.add(places[l], places[m], sums[k]);
                    k += 1;
                }
            }
        }
    }
}
