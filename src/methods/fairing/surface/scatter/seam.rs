//! Tubes: a sheet that closes all round is cut along its axis, in the half
//! plane through the axis and a place that the user gives. The points beside
//! the cut count on both sides of it, so that the two borders agree.
//!
//! The axis is the direction that the normals avoid, through the middle of the
//! nodes; it must run inside the tube.

use super::voxels::{Nodes, least_direction};
use nalgebra::{Matrix3, Vector3};

/// Points this near the cut, in voxels, count on both of its sides.
pub(super) const SHARED: f64 = 3.0;

/// Where a tube is cut.
#[derive(Debug, Clone)]
pub(super) struct Seam {
    middle: Vector3<f64>,
    /// Axis; direction from it to the cut; across both.
    frame: [Vector3<f64>; 3],
    /// For nodes near the cut their side, and the nearest node on the other.
    opposite: Vec<Option<(bool, usize)>>,
}

impl Seam {
    /// The seam through `place`, and the nodes without links across it; `None`
    /// where the place lies on the axis.
    pub(super) fn cut(nodes: &Nodes, place: &Vector3<f64>) -> Option<(Self, Nodes)> {
        let count = nodes.place.len() as f64;
        let middle = nodes.place.iter().sum::<Vector3<f64>>() / count;
        let squares = nodes.normal.iter().map(|n| n * n.transpose());
        let axis = least_direction(squares.sum::<Matrix3<f64>>());
        let out = place - middle;
        let out = (out - axis * axis.dot(&out)).try_normalize(1e-9)?;
        let mut seam = Seam {
            middle,
            frame: [axis, out, axis.cross(&out)],
            opposite: Vec::new(),
        };
        let mut cut = nodes.clone();
        let side: Vec<Option<bool>> = nodes.place.iter().map(|p| seam.side(p)).collect();
        for (i, near) in cut.near.iter_mut().enumerate() {
            near.retain(|j| !crosses(side[i], side[*j]));
        }
        seam.opposite = seam.opposites(nodes, &side);
        Some((seam, cut))
    }

    /// The node from which a point is looked for, and the one on the other
    /// side of the cut where the point counts there too.
    pub(super) fn seats(&self, p: &Vector3<f64>, node: usize) -> (usize, Option<usize>) {
        let Some((own, other)) = self.opposite[node] else {
            return (node, None);
        };
        // A voxel may lie on both sides; its node is on one.
        match self.side(p) {
            Some(side) if side != own => (other, Some(node)),
            _ => (node, Some(other)),
        }
    }

    /// On which side of the cut a place lies; `None` far from it.
    fn side(&self, p: &Vector3<f64>) -> Option<bool> {
        let d = p - self.middle;
        let [along, across] = [self.frame[1].dot(&d), self.frame[2].dot(&d)];
        (along > 0.0 && across.abs() <= along).then_some(across > 0.0)
    }

    /// For each node within reach of the cut its own side, and the nearest
    /// node on the other.
    fn opposites(&self, nodes: &Nodes, side: &[Option<bool>]) -> Vec<Option<(bool, usize)>> {
        let across = |p: &Vector3<f64>| self.frame[2].dot(&(p - self.middle)).abs();
        let reach = SHARED * nodes.side();
        let close: Vec<usize> = (0..side.len())
            .filter(|i| side[*i].is_some() && across(&nodes.place[*i]) <= reach)
            .collect();
        let mut all = vec![None; side.len()];
        for i in &close {
            let far = |j: &&usize| (nodes.place[**j] - nodes.place[*i]).norm();
            let others = close.iter().filter(|j| crosses(side[*i], side[**j]));
            let nearest = others.min_by(|a, b| far(a).total_cmp(&far(b)));
            all[*i] = side[*i].zip(nearest.copied());
        }
        all
    }
}

/// Whether a link joins the two sides.
fn crosses(a: Option<bool>, b: Option<bool>) -> bool {
    a.zip(b).is_some_and(|(a, b)| a != b)
}
