//! Where edges of surfaces meet: gap and angle.

use crate::geometry::{
    ArcLength, Axis, BSplineSurface, BoundingBox, CurveIndex, SurfaceJet, Tolerance,
    directed_distance_between,
};
use nalgebra::{Point3, Vector3};
use std::f64::consts::PI;

/// Places along a join at which its angle is taken.
const PLACES: usize = 33;
/// Gaps are known to this share of the tolerance.
const RESOLUTION: f64 = 1e-2;

/// The four edges of a surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// v at its first value.
    V0,
    /// v at its last value.
    V1,
    /// u at its first value.
    U0,
    /// u at its last value.
    U1,
}

impl Side {
    /// In the order of the boundary curves of a surface.
    pub const ALL: [Side; 4] = [Side::V0, Side::V1, Side::U0, Side::U1];
}

/// An edge of a surface that has a length.
#[derive(Debug)]
pub struct Edge<'a> {
    /// The surface's place in the list.
    pub surface: usize,
    /// Which of its edges.
    pub side: Side,
    of: &'a BSplineSurface,
    curve: CurveIndex,
    lengths: ArcLength,
    bounds: BoundingBox,
}

/// Two edges that meet along all of their length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Join {
    /// The edges: places in the list.
    pub edges: [usize; 2],
    /// Length of the first.
    pub length: f64,
    /// Largest distance of either edge from the other.
    pub gap: f64,
    /// Largest angle between the surfaces along it, radians: 0 where one goes
    /// on into the other, however their normals point.
    pub knuckle_max: f64,
    /// Mean.
    pub knuckle_mean: f64,
}

/// All edges longer than `tolerance`.
#[must_use]
pub fn edges(surfaces: &[BSplineSurface], tolerance: Tolerance) -> Vec<Edge<'_>> {
    let mut edges = Vec::new();
    for (surface, of) in surfaces.iter().enumerate() {
        for (side, curve) in Side::ALL.into_iter().zip(of.boundary_curves()) {
            let lengths = ArcLength::new(&curve);
            if lengths.total() > tolerance.length() {
                edges.push(Edge {
                    surface,
                    side,
                    of,
                    bounds: curve.bounding_box(),
                    curve: CurveIndex::with_resolution(&curve, tolerance.scaled(RESOLUTION)),
                    lengths,
                });
            }
        }
    }
    edges
}

/// The joins among edges: pairs no point of which lies further from the other
/// than `tolerance`. Edges that share a part of their length only are none.
#[must_use]
pub fn joins(edges: &[Edge<'_>], tolerance: Tolerance) -> Vec<Join> {
    let resolution = tolerance.scaled(RESOLUTION);
    let mut joins = Vec::new();
    for (i, a) in edges.iter().enumerate() {
        for (j, b) in edges.iter().enumerate().skip(i + 1) {
            if !a.may_meet(b, tolerance.length()) {
                continue;
            }
            let there = directed_distance_between(&a.curve, &b.curve, resolution);
            let back = directed_distance_between(&b.curve, &a.curve, resolution);
            let gap = there.max.max(back.max);
            if gap <= tolerance.length() {
                let (knuckle_max, knuckle_mean) = knuckle(a, b);
                joins.push(Join {
                    edges: [i, j],
                    length: a.lengths.total(),
                    gap,
                    knuckle_max,
                    knuckle_mean,
                });
            }
        }
    }
    joins
}

/// Largest and mean angle along the first of two edges that meet.
fn knuckle(a: &Edge<'_>, b: &Edge<'_>) -> (f64, f64) {
    let (mut largest, mut sum, mut count) = (0.0, 0.0, 0.0);
    for k in 0..PLACES {
        let share = (k as f64 + 0.5) / PLACES as f64;
        let u = a.lengths.parameter_at(share * a.lengths.total());
        let foot = b.curve.closest(&a.curve.curve().point(u));
        let (Some(p), Some(q)) = (a.inward(u), b.inward(foot.parameter)) else {
            continue;
        };
        let angle: f64 = PI - p.angle(&q);
        largest = f64::max(largest, angle);
        sum += angle;
        count += 1.0;
    }
    (largest, if count > 0.0 { sum / count } else { 0.0 })
}

impl Edge<'_> {
    /// The edge as a curve.
    #[must_use]
    pub fn curve(&self) -> &CurveIndex {
        &self.curve
    }

    /// Whether boxes and ends allow these two to meet.
    fn may_meet(&self, other: &Edge<'_>, tolerance: f64) -> bool {
        let near = |k: usize| {
            self.bounds.min[k] <= other.bounds.max[k] + tolerance
                && other.bounds.min[k] <= self.bounds.max[k] + tolerance
        };
        let [a, b] = [self, other].map(|e| e.curve.curve());
        let apart = |p: Point3<f64>, q: Point3<f64>| (p - q).norm() > tolerance;
        let ends = |p, q| !apart(a.start(), p) && !apart(a.end(), q);
        (0..3).all(near) && (ends(b.start(), b.end()) || ends(b.end(), b.start()))
    }

    /// The direction into the surface, square to the edge; none where the
    /// surface is singular.
    fn inward(&self, at: f64) -> Option<Vector3<f64>> {
        let [u, v] = [Axis::U, Axis::V].map(|axis| self.of.domain(axis));
        let jet = |a: f64, b: f64| self.of.derivatives(a, b);
        let along_u = |s: SurfaceJet| (s.du, s.dv);
        let along_v = |s: SurfaceJet| (s.dv, s.du);
        let (along, across) = match self.side {
            Side::V0 => along_u(jet(at, v[0])),
            Side::V1 => along_u(jet(at, v[1])),
            Side::U0 => along_v(jet(u[0], at)),
            Side::U1 => along_v(jet(u[1], at)),
        };
        let across = match self.side {
            Side::V0 | Side::U0 => across,
            Side::V1 | Side::U1 => -across,
        };
        let along = along.try_normalize(0.0)?;
        (across - along * along.dot(&across)).try_normalize(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{BSplineCurve, RuledSurface};
    use nalgebra::point;

    fn tolerance() -> Tolerance {
        Tolerance::absolute(1e-3).unwrap()
    }

    fn plate(corners: [[Point3<f64>; 2]; 2]) -> BSplineSurface {
        let line = |[a, b]: [Point3<f64>; 2]| BSplineCurve::line(a, b, 1).unwrap();
        let ruled = RuledSurface::new(line(corners[0]), line(corners[1]));
        ruled.unwrap().to_bspline().unwrap()
    }

    /// Two plates along the x axis, the second rising by an angle and standing
    /// off by a gap, its shared edge run backwards.
    fn pair(angle: f64, gap: f64) -> Vec<BSplineSurface> {
        let (sin, cos) = angle.sin_cos();
        let flat = plate([
            [point![0., -1., 0.], point![4., -1., 0.]],
            [point![0., 0., 0.], point![4., 0., 0.]],
        ]);
        let risen = plate([
            [point![4., gap, 0.], point![0., gap, 0.]],
            [point![4., gap + cos, sin], point![0., gap + cos, sin]],
        ]);
        vec![flat, risen]
    }

    #[test]
    fn plates_meet_at_their_angle() {
        for angle in [0.0, 0.3, 1.5] {
            let surfaces = pair(angle, 1e-5);
            let edges = edges(&surfaces, tolerance());
            assert_eq!(edges.len(), 8);
            let joins = joins(&edges, tolerance());
            assert_eq!(joins.len(), 1);
            let join = &joins[0];
            assert_eq!(edges[join.edges[0]].side, Side::V1);
            assert_eq!(edges[join.edges[1]].side, Side::V0);
            assert!((join.knuckle_max - angle).abs() < 1e-7, "{join:?}");
            assert!((join.knuckle_mean - angle).abs() < 1e-7);
            assert!((join.gap - 1e-5).abs() < 1.1e-5 && (join.length - 4.0).abs() < 1e-12);
        }
    }

    #[test]
    fn plates_that_stand_apart_do_not_meet() {
        let surfaces = pair(0.3, 2e-3);
        assert!(joins(&edges(&surfaces, tolerance()), tolerance()).is_empty());
    }
}
