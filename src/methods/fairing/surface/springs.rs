//! Springs from points to their places on a net, gathered into normal
//! equations `A c = f` with `A = Σ w bᵢ bᵢᵀ`, `f = Σ w bᵢ qᵢ`.
//!
//! Points are sorted into the cells of the net. Within a cell the outer
//! product of a tensor row is the product of two small ones,
//! `(bᵤbᵤᵀ) ⊗ (bᵥbᵥᵀ)`; cells with many points go through their moments
//! (module `moments`). Cells are summed in parallel.
//! The chunks are the same whatever the thread count, and are added in the
//! same order.

use super::moments::by_moments;
use super::net::{MOST_ACTING, Net};
use crate::numerics::EnvelopeMatrix;
use rayon::prelude::*;

/// Points with their places on the net; `D` fields are fitted at once.
#[derive(Debug, Clone, Default)]
pub(in super::super) struct Springs<const D: usize> {
    /// Places (u, v).
    pub(in super::super) at: Vec<[f64; 2]>,
    /// Values of the fields.
    pub(in super::super) value: Vec<[f64; D]>,
    /// Stiffness, ≥ 0.
    pub(in super::super) weight: Vec<f64>,
}

/// Normal equations of springs alone.
#[derive(Debug, Clone)]
pub(in super::super) struct Normal<const D: usize> {
    pub(in super::super) matrix: EnvelopeMatrix,
    pub(in super::super) rhs: Vec<[f64; D]>,
    /// `Σ w |q|²` over all fields.
    pub(in super::super) square: f64,
    /// What of it cannot be told from zero.
    pub(in super::super) rounding: f64,
    /// Points that count.
    pub(in super::super) points: usize,
}

/// Share of the data's own square below which a residual is rounding.
const ROUNDING: f64 = 1e-15;

/// Points of one chunk: enough to be worth a task, few enough to share.
const CHUNK: usize = 4096;

/// Points of a chunk from which moments are cheaper: turning them into
/// products costs as much as some twenty points.
const FULL: usize = 32;

/// Points sorted by the cell of the net that they lie in.
#[derive(Debug)]
pub(in super::super) struct Cells {
    order: Vec<u32>,
    /// Ranges of `order`, each within one cell.
    chunks: Vec<[usize; 2]>,
}

impl Cells {
    /// Sorts places by cell, stably.
    pub(in super::super) fn new(net: &Net, at: &[[f64; 2]]) -> Self {
        let columns = net.spans[1].len();
        let key = |p: &[f64; 2]| {
            let [u, v] = net.clamp(*p);
            net.spans[0].span(u) * columns + net.spans[1].span(v)
        };
        let keys: Vec<usize> = at.par_iter().map(key).collect();
        let mut start = vec![0usize; net.spans[0].len() * columns + 1];
        for k in &keys {
            start[k + 1] += 1;
        }
        for k in 1..start.len() {
            start[k] += start[k - 1];
        }
        let mut chunks = Vec::new();
        for cell in start.windows(2) {
            let mut from = cell[0];
            while from < cell[1] {
                let to = (from + CHUNK).min(cell[1]);
                chunks.push([from, to]);
                from = to;
            }
        }
        let mut order = vec![0u32; at.len()];
        for (i, k) in keys.iter().enumerate() {
            order[start[*k]] = i as u32;
            start[*k] += 1;
        }
        Cells { order, chunks }
    }

    /// Chunks of point indices, each within one cell.
    pub(in super::super) fn chunks(&self) -> impl IndexedParallelIterator<Item = &[u32]> {
        self.chunks.par_iter().map(|[a, b]| &self.order[*a..*b])
    }
}

/// What one chunk adds.
pub(super) struct Block<const D: usize> {
    pub(super) first: [usize; 2],
    /// Products of u pairs times products of v pairs.
    pub(super) products: Vec<f64>,
    pub(super) rhs: [[f64; D]; MOST_ACTING * MOST_ACTING],
    pub(super) square: f64,
    pub(super) points: usize,
}

/// The normal equations of all springs.
pub(in super::super) fn gather<const D: usize>(net: &Net, springs: &Springs<D>) -> Normal<D> {
    gather_cells(net, springs, &Cells::new(net, &springs.at))
}

/// As [`gather`] with points that are already sorted.
pub(in super::super) fn gather_cells<const D: usize>(
    net: &Net,
    springs: &Springs<D>,
    cells: &Cells,
) -> Normal<D> {
    let sum = |points: &[u32]| match (net.degree(), points.len() >= FULL) {
        (5, false) => block::<D, 6, 21>(net, springs, points),
        (5, true) => by_moments::<D, 6, 11, 21>(net, springs, points),
        (4, false) => block::<D, 5, 15>(net, springs, points),
        (4, true) => by_moments::<D, 5, 9, 15>(net, springs, points),
        (_, false) => block::<D, 4, 10>(net, springs, points),
        (_, true) => by_moments::<D, 4, 7, 10>(net, springs, points),
    };
    let blocks: Vec<Block<D>> = cells.chunks().map(sum).collect();
    let mut normal = Normal {
        matrix: EnvelopeMatrix::banded(net.len(), net.half_bandwidth()),
        rhs: vec![[0.0; D]; net.len()],
        square: 0.0,
        rounding: 0.0,
        points: 0,
    };
    for b in &blocks {
        scatter(net, b, &mut normal);
    }
    normal.rounding = ROUNDING * normal.square;
    normal
}

/// Sums one chunk: `N` acting functions in each direction, `T` pairs.
pub(super) fn block<const D: usize, const N: usize, const T: usize>(
    net: &Net,
    springs: &Springs<D>,
    points: &[u32],
) -> Block<D> {
    let mut products = [[0.0; T]; T];
    let mut rhs = [[0.0; D]; MOST_ACTING * MOST_ACTING];
    let (mut first, mut square, mut counted) = ([0; 2], 0.0, 0);
    for &i in points {
        let i = i as usize;
        let (w, q) = (springs.weight[i], &springs.value[i]);
        let [ju, jv] = net.jets::<1>(springs.at[i]);
        first = [ju.first, jv.first];
        let (mut bu, mut bv) = ([0.0; N], [0.0; N]);
        bu.copy_from_slice(&ju.values()[..N]);
        bv.copy_from_slice(&jv.values()[..N]);
        let (su, sv) = (pairs::<N, T>(&bu, w), pairs::<N, T>(&bv, 1.0));
        for (row, s) in products.iter_mut().zip(su) {
            for (slot, t) in row.iter_mut().zip(sv) {
                *slot += s * t;
            }
        }
        for a in 0..N {
            for b in 0..N {
                let n = w * bu[a] * bv[b];
                for (slot, q) in rhs[a * N + b].iter_mut().zip(q) {
                    *slot += n * q;
                }
            }
        }
        square += w * q.iter().map(|x| x * x).sum::<f64>();
        counted += usize::from(w > 0.0);
    }
    Block {
        first,
        products: products.as_flattened().to_vec(),
        rhs,
        square,
        points: counted,
    }
}

/// `w bₐ b_b` for a ≤ b, in the order of [`pair`].
fn pairs<const N: usize, const T: usize>(b: &[f64; N], w: f64) -> [f64; T] {
    let mut products = [0.0; T];
    let mut k = 0;
    for i in 0..N {
        for j in i..N {
            products[k] = w * b[i] * b[j];
            k += 1;
        }
    }
    products
}

/// Where the pair (i, j) of `n` functions is kept.
fn pair(n: usize, i: usize, j: usize) -> usize {
    let (i, j) = (i.min(j), i.max(j));
    i * n - i * (i + 1) / 2 + j
}

/// Adds a chunk to the whole.
fn scatter<const D: usize>(net: &Net, block: &Block<D>, normal: &mut Normal<D>) {
    let n = net.degree() + 1;
    let t = n * (n + 1) / 2;
    let place = |l: usize| net.index(block.first[0] + l / n, block.first[1] + l % n);
    for l in 0..n * n {
        for m in 0..=l {
            let product = block.products[pair(n, l / n, m / n) * t + pair(n, l % n, m % n)];
            normal.matrix.add(place(l), place(m), product);
        }
        for (slot, value) in normal.rhs[place(l)].iter_mut().zip(block.rhs[l]) {
            *slot += value;
        }
    }
    normal.square += block.square;
    normal.points += block.points;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Knots;

    /// Against the sum written out row by row.
    #[test]
    fn gathers_what_the_rows_say() {
        for degree in [3, 4, 5] {
            let knots = |d: [f64; 2], n| Knots::uniform(degree, d, n).expect("valid");
            let net = Net::new([knots([0.0, 1.0], 5), knots([-1.0, 2.0], 7)]);
            let n = 200;
            let wobble = |i: usize, k: f64| (i as f64 * k).sin().mul_add(0.5, 0.5);
            let springs = Springs::<2> {
                at: (0..n)
                    .map(|i| [wobble(i, 1.7), 3.0 * wobble(i, 2.9) - 1.0])
                    .collect(),
                value: (0..n)
                    .map(|i| [wobble(i, 0.3), wobble(i, 0.7) - 4.0])
                    .collect(),
                weight: (0..n).map(|i| 0.1 + wobble(i, 5.1)).collect(),
            };
            let normal = gather(&net, &springs);
            let mut dense = vec![vec![0.0; net.len()]; net.len()];
            let mut rhs = vec![[0.0; 2]; net.len()];
            for i in 0..n {
                let [ju, jv] = net.jets::<1>(springs.at[i]);
                let mut row = vec![0.0; net.len()];
                for (a, x) in ju.values().iter().enumerate() {
                    for (b, y) in jv.values().iter().enumerate() {
                        row[net.index(ju.first + a, jv.first + b)] = x * y;
                    }
                }
                for (r, x) in row.iter().enumerate().filter(|(_, x)| **x != 0.0) {
                    for (c, y) in row.iter().enumerate() {
                        dense[r][c] += springs.weight[i] * x * y;
                    }
                    for (slot, value) in rhs[r].iter_mut().zip(springs.value[i]) {
                        *slot += springs.weight[i] * x * value;
                    }
                }
            }
            for r in 0..net.len() {
                for (c, want) in dense[r].iter().enumerate().take(r + 1) {
                    assert!((normal.matrix.get(r, c) - want).abs() < 1e-12);
                }
                assert!((normal.rhs[r][1] - rhs[r][1]).abs() < 1e-12);
            }
        }
    }
}
