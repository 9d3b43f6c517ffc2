//! From a net to its patches, offsets of both.

use crate::geometry::{CyclideCorner, CyclideError, CyclidePatch};
use crate::methods::curvature_net::net::Net;

/// One patch a quad, row after row; the error where a quad has none.
#[must_use]
pub fn patches(net: &Net) -> Vec<Result<CyclidePatch, CyclideError>> {
    let layout = net.layout();
    let patch = |(i, j)| {
        let patch = CyclidePatch::new(layout.corners(i, j).map(|k| corner(net, k)))?;
        // A side of half a turn has no rational form.
        patch.surface().map(|_| patch)
    };
    layout.patches().map(patch).collect()
}

/// The offset of a net: its vertices moved along their normals. The frames
/// stay, so that an offset of a cyclide spline is one.
#[must_use]
pub fn offset(net: &Net, distance: f64) -> Net {
    let mut moved = net.clone();
    for (point, normal) in moved.points.iter_mut().zip(&net.normals) {
        *point += normal * distance;
    }
    moved
}

fn corner(net: &Net, index: usize) -> CyclideCorner {
    CyclideCorner {
        point: net.points[index],
        tangents: net.tangents[index],
    }
}
