//! A coarse picture of a cloud: means of the points in cubic voxels, their
//! neighbours and their normals. About a thousand nodes whatever the number
//! of points.

use nalgebra::{Matrix3, Vector3};

/// Points that are looked at: evenly spaced in the given order.
const SAMPLE: usize = 20_000;
/// Nodes that are wanted.
const NODES: usize = 1000;
/// Fewest points a voxel should have for its mean to be quieter than they.
const POINTS_A_NODE: usize = 4;
/// Corrections of the voxel's side.
const ROUNDS: usize = 6;

/// A coarse picture of a cloud.
#[derive(Debug, Clone)]
pub(in super::super) struct Nodes {
    /// Means of points.
    pub(in super::super) place: Vec<Vector3<f64>>,
    /// Points behind each.
    pub(in super::super) count: Vec<usize>,
    /// Indices of nodes in the 26 voxels around each.
    pub(in super::super) near: Vec<Vec<usize>>,
    /// Unit normals, consistently turned as far as neighbours go.
    pub(in super::super) normal: Vec<Vector3<f64>>,
    keys: Vec<Key>,
    side: f64,
}

/// Three whole numbers in one, compared by the first, then the second, then
/// the third.
type Key = u64;

/// Bits of each number, and what makes it positive.
const BITS: u32 = 21;
/// See [`BITS`].
const MIDDLE: i64 = 1 << (BITS - 1);

impl Nodes {
    /// Side of the voxels.
    pub(in super::super) fn side(&self) -> f64 {
        self.side
    }

    /// The nearest node of all.
    pub(in super::super) fn nearest(&self, p: &Vector3<f64>) -> usize {
        let mut best = (f64::INFINITY, 0);
        for (i, q) in self.place.iter().enumerate() {
            let d = (q - p).norm_squared();
            if d < best.0 {
                best = (d, i);
            }
        }
        best.1
    }

    /// The node of the voxel of a place, or of one of the 26 around it.
    pub(in super::super) fn at(&self, p: &Vector3<f64>) -> Option<usize> {
        let k = key(p, self.side);
        if let Ok(i) = self.keys.binary_search(&k) {
            return Some(i);
        }
        let mut best: Option<(f64, usize)> = None;
        for j in around(&self.keys, k, 1) {
            let d = (self.place[j] - p).norm_squared();
            if best.is_none_or(|(b, _)| d < b) {
                best = Some((d, j));
            }
        }
        best.map(|(_, j)| j)
    }
}

fn key(p: &Vector3<f64>, side: f64) -> Key {
    let part = |k: usize| {
        let cell = (p[k] / side).floor() as i64;
        (cell + MIDDLE).clamp(0, 2 * MIDDLE - 1) as Key
    };
    (part(0) << (2 * BITS)) | (part(1) << BITS) | part(2)
}

/// Places in the sorted keys of the voxels within `reach` of one.
fn around(keys: &[Key], k: Key, reach: u64) -> impl Iterator<Item = usize> {
    let one = |shift: u32| move |n: i64| (n << shift) as Key;
    let (slow, middle) = (one(2 * BITS), one(BITS));
    let span = -(reach as i64)..=reach as i64;
    span.clone().flat_map(move |a| {
        span.clone().flat_map(move |b| {
            let column = k.wrapping_add(slow(a)).wrapping_add(middle(b));
            let start = keys.partition_point(|q| *q < column - reach);
            let within = move |j: &usize| keys[*j] <= column + reach;
            (start..keys.len()).take_while(within)
        })
    })
}

/// The picture of a cloud in the unit frame.
pub(in super::super) fn nodes(points: &[Vector3<f64>]) -> Nodes {
    let stride = points.len().div_ceil(SAMPLE).max(1);
    let sample: Vec<Vector3<f64>> = points.iter().step_by(stride).copied().collect();
    let wanted = (sample.len() / POINTS_A_NODE).clamp(8, NODES) as f64;
    // A sheet of unit size in voxels of side 1/k fills about k² of them.
    let mut side = 1.0 / wanted.sqrt();
    let occupied = |side: f64| {
        let mut keys: Vec<Key> = sample.iter().map(|p| key(p, side)).collect();
        keys.sort_unstable();
        keys.dedup();
        keys
    };
    let mut keys = occupied(side);
    for _ in 0..ROUNDS {
        let ratio = keys.len() as f64 / wanted;
        if (0.8..1.25).contains(&ratio) {
            break;
        }
        side *= ratio.sqrt();
        keys = occupied(side);
    }
    let mut place = vec![Vector3::zeros(); keys.len()];
    let mut count = vec![0; keys.len()];
    for p in &sample {
        if let Ok(i) = keys.binary_search(&key(p, side)) {
            place[i] += p;
            count[i] += 1;
        }
    }
    for (p, n) in place.iter_mut().zip(&count) {
        *p /= (*n).max(1) as f64;
    }
    let neighbours = |(i, k): (usize, &Key)| around(&keys, *k, 1).filter(|j| *j != i).collect();
    let near = keys.iter().enumerate().map(neighbours).collect();
    let mut nodes = Nodes {
        place,
        count,
        near,
        normal: Vec::new(),
        keys,
        side,
    };
    nodes.normal = (0..nodes.place.len()).map(|i| normal(&nodes, i)).collect();
    orient(&mut nodes);
    nodes
}

/// Normal of the plane through a node and the nodes within two voxels.
fn normal(nodes: &Nodes, i: usize) -> Vector3<f64> {
    let all: Vec<usize> = around(&nodes.keys, nodes.keys[i], 2).collect();
    let weight: f64 = all.iter().map(|j| nodes.count[*j] as f64).sum();
    let mean = all
        .iter()
        .map(|j| nodes.place[*j] * nodes.count[*j] as f64)
        .sum::<Vector3<f64>>()
        / weight;
    let mut moments = Matrix3::zeros();
    for j in &all {
        let d = nodes.place[*j] - mean;
        moments += d * d.transpose() * nodes.count[*j] as f64;
    }
    least_direction(moments)
}

/// Eigenvector of the least eigenvalue.
pub(in super::super) fn least_direction(moments: Matrix3<f64>) -> Vector3<f64> {
    let eigen = moments.symmetric_eigen();
    let k = eigen.eigenvalues.imin();
    eigen.eigenvectors.column(k).into_owned()
}

/// Turns normals to agree with their neighbours, along the tree of best
/// agreement (Hoppe et al. 1992).
fn orient(nodes: &mut Nodes) {
    let n = nodes.place.len();
    let mut done = vec![false; n];
    let mut heap = std::collections::BinaryHeap::new();
    for root in 0..n {
        if done[root] {
            continue;
        }
        heap.push((u64::MAX, root, root));
        while let Some((_, i, from)) = heap.pop() {
            if done[i] {
                continue;
            }
            done[i] = true;
            if nodes.normal[i].dot(&nodes.normal[from]) < 0.0 {
                nodes.normal[i] = -nodes.normal[i];
            }
            for j in &nodes.near[i] {
                if !done[*j] {
                    let agreement = nodes.normal[i].dot(&nodes.normal[*j]).abs();
                    // Whole numbers have a total order.
                    heap.push(((agreement * 1e9) as u64, *j, i));
                }
            }
        }
    }
}
