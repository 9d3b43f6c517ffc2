//! Short pieces of a curve with bounds on their derivatives, and the tree of
//! their boxes.

use crate::geometry::{BSplineCurve, BoundingBox};
use nalgebra::{Point3, Vector3};

/// Leaves bulge over their chords by at most this share of their length: they
/// turn by some 10 degrees. Finer leaves bound better and are more to build.
const BULGE: f64 = 0.02;

/// Most leaves per polynomial piece; what needs more (a cusp) is halved in the
/// search instead.
const MAX_PARTS: f64 = 16.0;

/// A piece of a curve inside one knot span.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::geometry) struct Leaf {
    /// The knot span it lies in.
    pub span: usize,
    /// Its parameters.
    pub u: [f64; 2],
    /// Its end points.
    pub ends: [Point3<f64>; 2],
    /// Bound on the speed `|C′|`.
    pub speed: f64,
    /// Bound on `|C″|`.
    pub second: f64,
    /// Bound on `|C‴|`.
    pub third: f64,
    /// `|C′|`'s jump, as a vector difference, at the leaf's start.
    pub jump: f64,
}

impl Leaf {
    /// How far the curve can be from its chord on a part of width `h`.
    pub fn bulge(&self, h: f64) -> f64 {
        0.125 * self.second * h * h
    }

    fn bounding_box(&self) -> BoundingBox {
        let [a, b] = self.ends;
        let margin = Vector3::repeat(self.bulge(self.u[1] - self.u[0]));
        let tight = BoundingBox { min: a, max: a }.with(&b);
        BoundingBox {
            min: tight.min - margin,
            max: tight.max + margin,
        }
    }
}

/// Cuts a curve into leaves.
pub(super) fn leaves_of(curve: &BSplineCurve) -> Vec<Leaf> {
    let borders: Vec<f64> = bezier_bounds(curve, &[])
        .iter()
        .flat_map(|piece| piece.inner_borders())
        .collect();
    let mut leaves: Vec<Leaf> = bezier_bounds(curve, &borders)
        .into_iter()
        .map(|piece| Leaf {
            span: curve.knot_vector().span(piece.u[0]),
            u: piece.u,
            ends: piece.ends,
            speed: piece.speed,
            second: piece.second,
            third: piece.third,
            jump: 0.0,
        })
        .collect();
    for k in 1..leaves.len() {
        let u = leaves[k].u[0];
        let before = curve.derivatives_in_span(leaves[k - 1].span, u).d1;
        leaves[k].jump = (curve.derivatives_in_span(leaves[k].span, u).d1 - before).norm();
    }
    leaves
}

/// What the control points of a Bézier piece say about it.
struct Piece {
    u: [f64; 2],
    ends: [Point3<f64>; 2],
    polygon: f64,
    speed: f64,
    second: f64,
    third: f64,
}

impl Piece {
    /// Where to cut so that the parts bulge little.
    fn inner_borders(&self) -> Vec<f64> {
        let h = self.u[1] - self.u[0];
        let allowed = BULGE * self.polygon;
        let bulge = 0.125 * self.second * h * h;
        // A part's length shrinks like 1/n, its bulge like 1/n².
        let parts = (bulge / allowed).ceil().clamp(1.0, MAX_PARTS);
        // NaN (a standing piece) becomes 0 parts, which is none to cut.
        (1..parts as usize)
            .map(|i| self.u[0] + h * i as f64 / parts)
            .collect()
    }
}

/// The Bézier pieces of a curve, cut at its knots and at the given borders.
fn bezier_bounds(curve: &BSplineCurve, borders: &[f64]) -> Vec<Piece> {
    let p = curve.degree();
    let knots = curve.knot_vector();
    let mut cuts: Vec<f64> = borders
        .iter()
        .flat_map(|t| std::iter::repeat_n(*t, p))
        .collect();
    for (t, m) in knots.distinct() {
        cuts.extend(std::iter::repeat_n(t, p.saturating_sub(m)));
    }
    // Borders lie strictly between knots, so that no insertion can fail; if
    // one did, the uncut control polygon would still bound, only loosely.
    let cut = curve.insert_knots(&cuts).unwrap_or_else(|_| curve.clone());
    let breakpoints = cut.knot_vector().breakpoints();
    breakpoints
        .windows(2)
        .enumerate()
        .map(|(k, u)| {
            let range = k * p..=k * p + p;
            let weights = cut.weights().map(|w| &w[range.clone()]);
            piece(p, [u[0], u[1]], &cut.control_points()[range], weights)
        })
        .collect()
}

/// Bounds for one Bézier piece: derivatives lie in the convex hull of their
/// own control points; of `C = O + A/w` follow those of the quotient.
fn piece(p: usize, u: [f64; 2], points: &[Point3<f64>], weights: Option<&[f64]>) -> Piece {
    let h = u[1] - u[0];
    let origin = points[0];
    let weight = |i: usize| weights.map_or(1.0, |w| w[i]);
    let lifted: Vec<Vector3<f64>> = points
        .iter()
        .enumerate()
        .map(|(i, p)| (p - origin) * weight(i))
        .collect();
    let [a1, a2, a3] = hodograph_bounds(lifted, h, |v| v.norm());
    let polygon = points.windows(2).map(|w| (w[1] - w[0]).norm()).sum();
    let ends = [points[0], points[p]];
    let Some(w) = weights else {
        return Piece {
            u,
            ends,
            polygon,
            speed: a1,
            second: a2,
            third: a3,
        };
    };
    let least = w.iter().copied().fold(f64::INFINITY, f64::min);
    let [w1, w2, w3] = hodograph_bounds(w.to_vec(), h, |v| v.abs());
    let reach = points
        .iter()
        .map(|p| (p - origin).norm())
        .fold(0.0, f64::max);
    let speed = (a1 + w1 * reach) / least;
    let second = (a2 + 2.0 * w1 * speed + w2 * reach) / least;
    let third = (a3 + 3.0 * w1 * second + 3.0 * w2 * speed + w3 * reach) / least;
    Piece {
        u,
        ends,
        polygon,
        speed,
        second,
        third,
    }
}

/// Largest size of the control values of the first three derivatives of a
/// Bézier polynomial on an interval of width `h`.
fn hodograph_bounds<T>(mut control: Vec<T>, h: f64, size: impl Fn(&T) -> f64) -> [f64; 3]
where
    T: Copy + std::ops::Sub<Output = T> + std::ops::Mul<f64, Output = T>,
{
    [(); 3].map(|()| {
        let degree = control.len().saturating_sub(1) as f64;
        control = control
            .windows(2)
            .map(|w| (w[1] - w[0]) * (degree / h))
            .collect();
        control.iter().map(&size).fold(0.0, f64::max)
    })
}

/// A complete binary tree of boxes over the leaves in order: node 1 is the
/// root, node `k` has the children `2k` and `2k + 1`.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::geometry) struct BoxTree {
    boxes: Vec<Option<BoundingBox>>,
    first_leaf: usize,
    count: usize,
}

/// Deeper than any tree that fits memory: two nodes wait a level.
const STACK: usize = 2 * usize::BITS as usize;

impl BoxTree {
    pub fn new(leaves: &[Leaf]) -> Self {
        let boxes: Vec<BoundingBox> = leaves.iter().map(Leaf::bounding_box).collect();
        Self::of(&boxes)
    }

    /// A tree over boxes; neighbours in the list should be neighbours in space.
    pub fn of(leaves: &[BoundingBox]) -> Self {
        let first_leaf = leaves.len().next_power_of_two();
        let mut boxes = vec![None; 2 * first_leaf];
        for (slot, leaf) in boxes[first_leaf..].iter_mut().zip(leaves) {
            *slot = Some(*leaf);
        }
        for k in (1..first_leaf).rev() {
            boxes[k] = match (boxes[2 * k], boxes[2 * k + 1]) {
                (Some(a), Some(b)) => Some(BoundingBox::union(a, &b)),
                (a, b) => a.or(b),
            };
        }
        BoxTree {
            boxes,
            first_leaf,
            count: leaves.len(),
        }
    }

    /// Walks the tree nearest box first. `enter` hears the leaf (`None` for an
    /// inner node) and a lower bound of its distance, and says whether to go
    /// on below.
    pub fn visit(&self, query: &Point3<f64>, mut enter: impl FnMut(Option<usize>, f64) -> bool) {
        let bound = |k: usize| self.boxes[k].map_or(f64::INFINITY, |b| b.distance(query));
        let mut stack = [(0, 0.0); STACK];
        stack[0] = (1, bound(1));
        let mut waiting = 1;
        while waiting > 0 {
            waiting -= 1;
            let (node, distance) = stack[waiting];
            if node >= self.first_leaf {
                let leaf = node - self.first_leaf;
                if leaf < self.count {
                    enter(Some(leaf), distance);
                }
            } else if enter(None, distance) {
                let (left, right) = (
                    (2 * node, bound(2 * node)),
                    (2 * node + 1, bound(2 * node + 1)),
                );
                let (near, far) = if left.1 <= right.1 {
                    (left, right)
                } else {
                    (right, left)
                };
                (stack[waiting], stack[waiting + 1]) = (far, near);
                waiting += 2;
            }
        }
    }
}
