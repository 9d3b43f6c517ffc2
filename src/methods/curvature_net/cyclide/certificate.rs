//! The proof that a patch is what it is said to be, in the paper's terms
//! (Zheng & Bo 2019, eqs. 3–7: reflection, orthogonality of tangents, G¹),
//! and in those of circular nets.

use super::patches::patches;
use crate::geometry::{BSplineSurface, CyclideError, CyclidePatch, SurfaceJet};
use crate::methods::curvature_net::net::Net;
use nalgebra::{Quaternion, Vector3};

/// Residuals of one patch. Angles in radians, the others without unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Certificate {
    /// Largest distance of a frame's vector from the mirror image of the frame
    /// at the other end of a side.
    pub mirror: f64,
    /// Largest |cosine| between the two tangents in a corner, on the rational
    /// patch.
    pub orthogonality: f64,
    /// Largest angle to a neighbour's tangent plane along the common side, on
    /// the rational patches; none without neighbours.
    pub tangency: f64,
    /// |Im(e₁e₂e₃e₄)| of the unit sides as quaternions: zero if and only if
    /// the corners lie on a circle.
    pub circularity: f64,
    /// [`CyclidePatch::defect`].
    pub reality: f64,
}

impl Certificate {
    /// The larger residual of each kind.
    #[must_use]
    pub fn or_worse(&self, other: &Certificate) -> Certificate {
        Certificate {
            mirror: self.mirror.max(other.mirror),
            orthogonality: self.orthogonality.max(other.orthogonality),
            tangency: self.tangency.max(other.tangency),
            circularity: self.circularity.max(other.circularity),
            reality: self.reality.max(other.reality),
        }
    }

    /// The largest of them.
    #[must_use]
    pub fn worst(&self) -> f64 {
        let Certificate {
            mirror,
            orthogonality,
            tangency,
            circularity,
            reality,
        } = *self;
        [mirror, orthogonality, tangency, circularity, reality]
            .into_iter()
            .fold(0.0, f64::max)
    }
}

/// Places along a side where neighbours are compared: both ends and between.
const PLACES: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];

/// A certificate for every patch, row after row; none for quads without one.
#[must_use]
pub fn certificates(net: &Net) -> Vec<Result<Certificate, CyclideError>> {
    let layout = net.layout();
    let [rows, columns] = layout.patch_counts();
    let patches: Vec<_> = patches(net)
        .into_iter()
        .map(|patch| {
            patch.and_then(|patch| {
                let surface = patch.surface()?;
                Ok(Proved { patch, surface })
            })
        })
        .collect();
    let at = |i: usize, j: usize| patches[i * columns + j].as_ref().ok();
    let next = |k: usize, count: usize, closed: bool| match k + 1 {
        next if next < count => Some(next),
        _ => closed.then_some(0),
    };
    // Across u = 1 and across v = 1 of each patch: each border once.
    let across: Vec<[f64; 2]> = layout
        .patches()
        .map(|(i, j)| {
            let beyond_u = next(i, rows, net.closed[0]).and_then(|i| at(i, j));
            let beyond_v = next(j, columns, net.closed[1]).and_then(|j| at(i, j));
            let bend = |sides, beyond| match (at(i, j), beyond) {
                (Some(own), Some(other)) => tangency(own, other, sides),
                _ => 0.0,
            };
            [bend([3, 2], beyond_u), bend([1, 0], beyond_v)]
        })
        .collect();
    let bends = |i: usize, j: usize| {
        let own = across[i * columns + j];
        let before_u = across[((i + rows - 1) % rows) * columns + j][0];
        let before_v = across[i * columns + (j + columns - 1) % columns][1];
        own[0].max(own[1]).max(before_u).max(before_v)
    };
    (layout.patches().zip(&patches))
        .map(|((i, j), patch)| {
            let proved = patch.as_ref().map_err(|e| *e)?;
            let corners = layout.corners(i, j);
            Ok(Certificate {
                mirror: mirror(net, corners),
                orthogonality: orthogonality(proved),
                tangency: bends(i, j),
                circularity: circularity(net, corners),
                reality: proved.patch.defect(),
            })
        })
        .collect()
}

fn mirror(net: &Net, [a, b, c, d]: [usize; 4]) -> f64 {
    let sides = [(a, b, 0), (c, d, 0), (a, c, 1), (b, d, 1)];
    sides
        .into_iter()
        .map(|(from, to, direction)| {
            let e = (net.points[to] - net.points[from]).normalize();
            let image = |v: &Vector3<f64>| v - e * (2.0 * e.dot(v));
            let off = |k: usize| {
                let sign = if k == direction { -1.0 } else { 1.0 };
                (image(&net.tangents[from][k]) * sign - net.tangents[to][k]).norm()
            };
            let normal = (image(&net.normals[from]) - net.normals[to]).norm();
            off(0).max(off(1)).max(normal)
        })
        .fold(0.0, f64::max)
}

fn circularity(net: &Net, [a, b, c, d]: [usize; 4]) -> f64 {
    let side = |from: usize, to: usize| {
        Quaternion::from_imag((net.points[to] - net.points[from]).normalize())
    };
    (side(a, b) * side(b, d) * side(d, c) * side(c, a))
        .imag()
        .norm()
}

/// A patch with its rational form.
struct Proved {
    patch: CyclidePatch,
    surface: BSplineSurface,
}

impl Proved {
    /// A jet on a side of the rational patch.
    fn on_side(&self, side: usize, parameter: f64) -> SurfaceJet {
        let [u, v] = self.patch.on_side(side, parameter);
        self.surface.derivatives_left(u, v)
    }
}

fn orthogonality(proved: &Proved) -> f64 {
    let corners = [(0, 0.0), (0, 1.0), (1, 0.0), (1, 1.0)];
    corners
        .into_iter()
        .map(|(side, parameter)| proved.on_side(side, parameter))
        .map(|jet| (jet.du.dot(&jet.dv) / (jet.du.norm() * jet.dv.norm())).abs())
        .fold(0.0, f64::max)
}

fn tangency(own: &Proved, other: &Proved, sides: [usize; 2]) -> f64 {
    PLACES
        .into_iter()
        .filter_map(|parameter| {
            let own = own.on_side(sides[0], parameter).normal()?;
            let other = other.on_side(sides[1], parameter).normal()?;
            // Unlike the arc cosine of their product this keeps small angles.
            Some(own.cross(&other).norm().atan2(own.dot(&other)))
        })
        .fold(0.0, f64::max)
}
