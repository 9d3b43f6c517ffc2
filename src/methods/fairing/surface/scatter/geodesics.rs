//! Distances along a sheet, between the nodes of its coarse picture, and the
//! flat map that keeps them best.
//!
//! Shortest paths over neighbours and their neighbours (24 directions on a
//! regular sheet: at most 3 % too long) from a few landmarks; landmark
//! multidimensional scaling (de Silva & Tenenbaum 2004) makes the map: exact
//! for developable sheets but for the paths' own error, and smooth for all.

use super::rigid::relaxed;
use super::voxels::Nodes;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Landmarks: farthest-point sampling makes them cover the sheet.
const LANDMARKS: usize = 32;
/// Fixed-point unit of path lengths in the heap: whole numbers have a total
/// order. Lengths are of order 1, sums below 10⁴.
const TICKS: f64 = 1e12;
/// Nodes this near in the map, in voxels, ...
const NEAR: f64 = 0.8;
/// ... must not be this far along the sheet, in voxels.
const FAR: f64 = 4.0;
/// Share of nodes that may break that.
const FOLDED: f64 = 0.05;

type Links = Vec<Vec<(usize, f64)>>;

/// A flat map of the nodes, isometric as far as the sheet allows; `None` where
/// the sheet would lie on itself (closed all round, or branching).
pub(super) fn flat_map(nodes: &Nodes) -> Option<Vec<[f64; 2]>> {
    let links = links(nodes);
    let (landmarks, paths) = landmarks(&links);
    let map = scale(&landmarks, &paths)?;
    (folded(nodes, &map, &paths) <= FOLDED).then(|| turned(relaxed(nodes, map)))
}

/// Neighbours and their neighbours; pieces that do not touch are linked by
/// their nearest nodes.
fn links(nodes: &Nodes) -> Links {
    let n = nodes.place.len();
    let length = |i: usize, j: usize| (nodes.place[i] - nodes.place[j]).norm();
    let mut links: Links = (0..n)
        .map(|i| {
            let mut all: Vec<usize> = nodes.near[i]
                .iter()
                .flat_map(|j| nodes.near[*j].iter().chain([j]))
                .copied()
                .filter(|j| *j != i)
                .collect();
            all.sort_unstable();
            all.dedup();
            all.into_iter().map(|j| (j, length(i, j))).collect()
        })
        .collect();
    join_pieces(&mut links, length);
    links
}

fn join_pieces(links: &mut Links, length: impl Fn(usize, usize) -> f64) {
    let n = links.len();
    loop {
        let reached: Vec<bool> = shortest(links, 0).iter().map(|d| d.is_finite()).collect();
        let mut best: Option<(f64, usize, usize)> = None;
        for i in (0..n).filter(|i| reached[*i]) {
            for j in (0..n).filter(|j| !reached[*j]) {
                let d = length(i, j);
                if best.is_none_or(|(b, _, _)| d < b) {
                    best = Some((d, i, j));
                }
            }
        }
        let Some((d, i, j)) = best else { return };
        links[i].push((j, d));
        links[j].push((i, d));
    }
}

/// Dijkstra.
fn shortest(links: &Links, from: usize) -> Vec<f64> {
    let mut length = vec![f64::INFINITY; links.len()];
    let mut heap = BinaryHeap::new();
    length[from] = 0.0;
    heap.push(Reverse((0u64, from)));
    while let Some(Reverse((ticks, i))) = heap.pop() {
        if ticks as f64 > length[i] * TICKS + 1.0 {
            continue;
        }
        for (j, d) in &links[i] {
            let through = length[i] + d;
            if through < length[*j] {
                length[*j] = through;
                heap.push(Reverse(((through * TICKS) as u64, *j)));
            }
        }
    }
    length
}

/// Landmarks and the paths from each.
fn landmarks(links: &Links) -> (Vec<usize>, Vec<Vec<f64>>) {
    let first = farthest(&shortest(links, 0));
    let mut chosen = vec![first];
    let mut paths = vec![shortest(links, first)];
    let mut nearest = paths[0].clone();
    while chosen.len() < LANDMARKS.min(links.len()) {
        let next = farthest(&nearest);
        let path = shortest(links, next);
        for (n, d) in nearest.iter_mut().zip(&path) {
            *n = n.min(*d);
        }
        chosen.push(next);
        paths.push(path);
    }
    (chosen, paths)
}

fn farthest(lengths: &[f64]) -> usize {
    let mut best = 0;
    for (i, d) in lengths.iter().enumerate() {
        if *d > lengths[best] {
            best = i;
        }
    }
    best
}

/// Landmark scaling to two dimensions.
fn scale(landmarks: &[usize], paths: &[Vec<f64>]) -> Option<Vec<[f64; 2]>> {
    let m = landmarks.len();
    let square = DMatrix::from_fn(m, m, |a, b| paths[a][landmarks[b]].powi(2));
    let means = DVector::from_fn(m, |a, _| square.row(a).mean());
    let total = means.mean();
    let gram = DMatrix::from_fn(m, m, |a, b| {
        -0.5 * (0.5 * (square[(a, b)] + square[(b, a)]) - means[a] - means[b] + total)
    });
    let eigen = gram.symmetric_eigen();
    let mut order: Vec<usize> = (0..m).collect();
    order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
    let axes: Vec<DVector<f64>> = order
        .iter()
        .take(2)
        .filter(|k| eigen.eigenvalues[**k] > 0.0)
        .map(|k| eigen.eigenvectors.column(*k) / eigen.eigenvalues[*k].sqrt())
        .collect();
    let [first, second] = axes.as_slice() else {
        return None;
    };
    let place = |i: usize| {
        let from = DVector::from_fn(m, |a, _| means[a] - paths[a][i].powi(2));
        [0.5 * first.dot(&from), 0.5 * second.dot(&from)]
    };
    Some((0..paths[0].len()).map(place).collect())
}

/// Share of nodes that lie in the map where a far one lies too. How far two
/// nodes are along the sheet is bounded below by the landmarks.
fn folded(nodes: &Nodes, map: &[[f64; 2]], paths: &[Vec<f64>]) -> f64 {
    let (near, far) = (NEAR * nodes.side(), FAR * nodes.side());
    let count = (0..map.len())
        .into_par_iter()
        .filter(|i| {
            (0..map.len()).any(|j| {
                let d = (map[*i][0] - map[j][0]).hypot(map[*i][1] - map[j][1]);
                d < near && paths.iter().any(|p| (p[*i] - p[j]).abs() > far)
            })
        })
        .count();
    count as f64 / map.len().max(1) as f64
}

/// The map turned so that its rectangle is smallest, longer side along u.
fn turned(map: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    let turn = |degrees: f64| -> Vec<[f64; 2]> {
        let (s, c) = degrees.to_radians().sin_cos();
        map.iter()
            .map(|p| [c * p[0] + s * p[1], c * p[1] - s * p[0]])
            .collect()
    };
    let sides = |map: &[[f64; 2]]| {
        [0, 1].map(|k| {
            let low = map.iter().map(|p| p[k]).fold(f64::INFINITY, f64::min);
            let high = map.iter().map(|p| p[k]).fold(f64::NEG_INFINITY, f64::max);
            high - low
        })
    };
    let mut best = (f64::INFINITY, 0.0);
    for degrees in 0..90 {
        let [a, b] = sides(&turn(f64::from(degrees)));
        if a * b < best.0 {
            best = (a * b, f64::from(degrees));
        }
    }
    let map = turn(best.1);
    let [a, b] = sides(&map);
    if a >= b {
        map
    } else {
        map.iter().map(|p| [p[1], -p[0]]).collect()
    }
}
