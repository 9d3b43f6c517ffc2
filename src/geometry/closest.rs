//! The closest point of a curve, with certainty.
//!
//! The curve is cut into leaves that turn little ([`leaves`]), each with a
//! bound `M` on `|C″|`, and the leaves into a tree of boxes. A query walks the
//! tree nearest first and drops what cannot hold a closer point. On an
//! interval of width `h`
//!
//! * the curve stays within `M h²/8` of its chord, which bounds the distance
//!   from below;
//! * if `(|chord|/h − M h/2)² > d M` for the largest distance `d`, then
//!   `|C − q|²` is convex, so that Newton's method finds its one minimum;
//! * the same holds if `(|chord|/h − M h/2)²` plus `(C − q)·C″` in the middle
//!   exceeds what a bound on `|C‴|` lets that product change;
//! * otherwise the interval is halved.
//!
//! So nothing is left to a lucky start: either the answer is proven to the
//! index's resolution, or it says that it is not (`certain: false`, with the
//! lower bound that was reached), as for the centre of a circle, to which all
//! points are closest.

mod leaves;
mod search;

use super::{BSplineCurve, Tolerance};
use leaves::leaves_of;
pub(super) use leaves::{BoxTree, Leaf};
use nalgebra::Point3;
use search::Search;

/// The resolution of [`CurveIndex::new`] relative to the largest coordinate
/// involved: what rounding leaves of a distance.
const ROUNDING: f64 = 1e-13;

/// A closest point and how sure it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Closest {
    /// Its parameter.
    pub parameter: f64,
    /// The point.
    pub point: Point3<f64>,
    /// Its distance from the query.
    pub distance: f64,
    /// No point of the curve is nearer than this.
    pub lower_bound: f64,
    /// Whether `distance − lower_bound` is within the resolution.
    pub certain: bool,
}

/// A curve prepared for many closest-point queries.
#[derive(Debug, Clone, PartialEq)]
pub struct CurveIndex {
    curve: BSplineCurve,
    leaves: Vec<Leaf>,
    tree: BoxTree,
    resolution: f64,
}

impl CurveIndex {
    /// Prepares a curve, with a resolution at the rounding of its coordinates.
    #[must_use]
    pub fn new(curve: &BSplineCurve) -> Self {
        let largest = curve.control_points().iter().map(|p| p.coords.amax());
        let size = largest.fold(f64::MIN_POSITIVE / ROUNDING, f64::max);
        Self::build(curve, ROUNDING * size)
    }

    /// Prepares a curve for answers proven to `resolution` only: cheaper where
    /// many places are almost equally near.
    #[must_use]
    pub fn with_resolution(curve: &BSplineCurve, resolution: Tolerance) -> Self {
        Self::build(curve, resolution.length())
    }

    fn build(curve: &BSplineCurve, resolution: f64) -> Self {
        let leaves = leaves_of(curve);
        let tree = BoxTree::new(&leaves);
        CurveIndex {
            curve: curve.clone(),
            leaves,
            tree,
            resolution,
        }
    }

    /// The curve.
    #[must_use]
    pub fn curve(&self) -> &BSplineCurve {
        &self.curve
    }

    /// The point closest to `query`.
    #[must_use]
    pub fn closest(&self, query: &Point3<f64>) -> Closest {
        self.search(query, None)
    }

    /// The same, sooner if `hint` is a parameter near the answer. The answer
    /// is as certain as without.
    #[must_use]
    pub fn closest_near(&self, query: &Point3<f64>, hint: f64) -> Closest {
        self.search(query, Some(hint))
    }

    fn search(&self, query: &Point3<f64>, hint: Option<f64>) -> Closest {
        let mut search = Search::new(&self.curve, *query, self.resolution);
        let first = hint.map(|u| self.leaf_at(u));
        if let Some(leaf) = first {
            search.leaf(&self.leaves[leaf], hint);
        }
        self.tree.visit(query, |leaf, bound| {
            if search.rules_out(bound) {
                false
            } else {
                if let Some(leaf) = leaf.filter(|leaf| first != Some(*leaf)) {
                    search.leaf(&self.leaves[leaf], None);
                }
                true
            }
        });
        search.finish()
    }

    /// The leaf that holds parameter `u`.
    pub(super) fn leaf_at(&self, u: f64) -> usize {
        self.leaves.partition_point(|leaf| leaf.u[0] <= u).max(1) - 1
    }

    /// All leaves, in order of the parameter.
    pub(super) fn leaves(&self) -> &[Leaf] {
        &self.leaves
    }
}

#[cfg(test)]
mod tests;
