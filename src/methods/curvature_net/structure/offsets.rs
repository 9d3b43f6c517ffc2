//! Offsets of a cyclide spline.

use crate::geometry::CyclidePatch;
use crate::methods::curvature_net::cyclide;
use crate::methods::curvature_net::net::Net;
use nalgebra::Vector3;

/// The surface at a distance.
#[derive(Debug, Clone, PartialEq)]
pub struct Offset {
    /// The distance along the normals.
    pub distance: f64,
    /// The vertices moved along their normals; the same frames.
    pub net: Net,
    /// Its patches, row after row; none where it runs through a focal surface.
    pub patches: Vec<Option<CyclidePatch>>,
    /// Patches, by row and column, that reach a focal point within the
    /// distance, with their least radius of curvature on that side.
    pub focal: Vec<([usize; 2], f64)>,
}

/// The offset of a net; `patches` are those of the net.
#[must_use]
pub fn offset(net: &Net, patches: &[Option<CyclidePatch>], distance: f64) -> Offset {
    let moved = cyclide::offset(net, distance);
    let mut focal = Vec::new();
    let mut offsets = cyclide::patches(&moved);
    let places = net.layout().patches().zip(patches);
    for (((i, j), patch), offset) in places.zip(&mut offsets) {
        let Some(patch) = patch else { continue };
        let bend = largest_bend(patch, distance.signum());
        if bend * distance.abs() >= 1.0 {
            focal.push(([i, j], 1.0 / bend));
            *offset = Err(crate::geometry::CyclideError::HalfTurn);
        }
    }
    Offset {
        distance,
        net: moved,
        patches: offsets.into_iter().map(Result::ok).collect(),
        focal,
    }
}

/// Places a direction where a patch's curvatures are looked up: along its own
/// lines each is constant, so that this is a search along the other lines.
const PLACES: usize = 5;

/// The largest principal curvature towards the given side of a patch.
fn largest_bend(patch: &CyclidePatch, side: f64) -> f64 {
    let Ok(surface) = patch.surface() else {
        return 0.0;
    };
    let share = |k: usize| k as f64 / (PLACES - 1) as f64;
    let bends = (0..PLACES).flat_map(|k| {
        // κ₁ changes along v only, κ₂ along u only: the diagonal sees both.
        let jet = surface.derivatives_left(share(k), share(k));
        let normal = jet.normal().unwrap_or_else(Vector3::zeros) * side;
        [(jet.duu, jet.du), (jet.dvv, jet.dv)]
            .map(|(bend, along)| bend.dot(&normal) / along.norm_squared())
    });
    bends.fold(0.0, f64::max)
}
