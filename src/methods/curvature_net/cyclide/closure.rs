//! What carrying one frame through the whole net by mirrors would miss.

use crate::methods::curvature_net::net::Net;
use nalgebra::{Matrix3, Vector3};
use std::collections::VecDeque;

/// Carries the frame of the middle vertex to all others by mirrors, each on a
/// shortest way, and compares what arrives along every other edge: the largest
/// distance between two unit vectors that should be one. The delivered frames
/// are the least-squares solution, which drifts less; this says that the net
/// alone determines them, rings included.
#[must_use]
pub fn closure(net: &Net) -> f64 {
    let neighbours = neighbours(net);
    let start = net.layout().vertex(net.rows / 2, net.columns / 2);
    let mut frames: Vec<Option<Matrix3<f64>>> = vec![None; net.points.len()];
    let mut waiting = VecDeque::new();
    if let (Some(slot), Some([u, v])) = (frames.get_mut(start), net.tangents.get(start)) {
        *slot = Some(Matrix3::from_columns(&[*u, *v, net.normals[start]]));
        waiting.push_back(start);
    }
    let mut worst = 0.0f64;
    while let Some(from) = waiting.pop_front() {
        let Some(frame) = frames[from] else { continue };
        for (to, direction) in &neighbours[from] {
            let image = mirrored(net, &frame, [from, *to], *direction);
            match &frames[*to] {
                Some(there) => {
                    let off = there - image;
                    worst = off.column_iter().fold(worst, |m, c| m.max(c.norm()));
                }
                None => {
                    frames[*to] = Some(image);
                    waiting.push_back(*to);
                }
            }
        }
    }
    worst
}

/// The vertices at the other ends of each vertex's edges, with the edges'
/// directions.
fn neighbours(net: &Net) -> Vec<Vec<(usize, usize)>> {
    let mut neighbours = vec![Vec::new(); net.points.len()];
    for direction in [0, 1] {
        for [a, b] in net.layout().edges(direction) {
            neighbours[a].push((b, direction));
            neighbours[b].push((a, direction));
        }
    }
    neighbours
}

/// The frame's image in the bisecting plane of an edge, the tangent along the
/// edge reversed.
fn mirrored(
    net: &Net,
    frame: &Matrix3<f64>,
    [from, to]: [usize; 2],
    direction: usize,
) -> Matrix3<f64> {
    let e: Vector3<f64> = (net.points[to] - net.points[from]).normalize();
    let mut image = frame - e * (e.transpose() * frame) * 2.0;
    image.column_mut(direction).neg_mut();
    image
}
