//! Points gathered in the cells of a cubic lattice.

use super::space::Vector;

/// A cell with points in it.
#[derive(Debug, Clone)]
pub(super) struct Cell<const D: usize> {
    /// Mean of its points.
    pub(super) mean: Vector<D>,
    /// Its points.
    pub(super) points: Vec<usize>,
}

/// Cells per side at most, so that three indices fit in one key.
const MOST_PER_SIDE: f64 = 1e6;

/// The occupied cells of side `side`, in a fixed order, points in theirs.
pub(super) fn cells<const D: usize>(points: &[Vector<D>], side: f64) -> Vec<Cell<D>> {
    let key = |p: &Vector<D>| {
        p.iter().fold(0_u64, |key, c| {
            let index = (c / side).floor().clamp(-MOST_PER_SIDE, MOST_PER_SIDE) + MOST_PER_SIDE;
            (key << 21) | index as u64
        })
    };
    let mut order: Vec<(u64, usize)> = points.iter().map(key).zip(0..).collect();
    order.sort_unstable();
    order
        .chunk_by(|a, b| a.0 == b.0)
        .map(|group| {
            let members: Vec<usize> = group.iter().map(|g| g.1).collect();
            let sum: Vector<D> = members.iter().map(|i| points[*i]).sum();
            Cell {
                mean: sum / members.len() as f64,
                points: members,
            }
        })
        .collect()
}
