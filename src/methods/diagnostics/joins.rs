//! Where edges of surfaces meet: gap and angle.

use crate::geometry::{
    ArcLength, Axis, BSplineSurface, BoundingBox, CurveIndex, SurfaceJet, Tolerance,
    directed_distance_between,
};
use nalgebra::{Point3, Vector3};
use std::f64::consts::PI;

/// Places along a join at which its angle is taken.
const PLACES: usize = 33;
/// Places between possible ends of a join at which it is tried.
const TRIED: usize = 5;
/// What is shorter than so many tolerances is a touch, no join.
const TOUCH: f64 = 10.0;
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

/// Two edges that meet, or parts of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Join {
    /// The edges: places in the list.
    pub edges: [usize; 2],
    /// From where to where along each, as lengths from its start.
    pub stretches: [[f64; 2]; 2],
    /// Length along the first.
    pub length: f64,
    /// Largest distance of either from the other.
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

/// The joins among edges: stretches no point of which lies further from the
/// other edge than `tolerance`. They end where one of the two edges ends.
#[must_use]
pub fn joins(edges: &[Edge<'_>], tolerance: Tolerance) -> Vec<Join> {
    let mut joins = Vec::new();
    for (i, a) in edges.iter().enumerate() {
        for (j, b) in edges.iter().enumerate().skip(i + 1) {
            if !a.may_meet(b, tolerance.length()) {
                continue;
            }
            for stretch in stretches(a, b, tolerance) {
                joins.extend(measured([(i, a), (j, b)], stretch, tolerance));
            }
        }
    }
    joins
}

/// Edges that are not joined along some of their length.
#[must_use]
pub fn open(edges: &[Edge<'_>], joins: &[Join], tolerance: Tolerance) -> Vec<usize> {
    let is_open = |k: &usize| {
        let mut covered: Vec<[f64; 2]> = (joins.iter())
            .flat_map(|j| j.edges.into_iter().zip(j.stretches))
            .filter(|(edge, _)| edge == k)
            .map(|(_, stretch)| stretch)
            .collect();
        covered.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let end = [edges[*k].lengths.total(); 2];
        let mut reached = 0.0;
        covered.into_iter().chain([end]).any(|[from, to]| {
            let gap = from - reached;
            reached = f64::max(reached, to);
            gap > TOUCH * tolerance.length()
        })
    };
    (0..edges.len()).filter(is_open).collect()
}

/// Stretches of an edge that lie along another, as lengths from its start.
fn stretches(a: &Edge<'_>, b: &Edge<'_>, tolerance: Tolerance) -> Vec<[f64; 2]> {
    let near = |p: &Point3<f64>, edge: &Edge<'_>| {
        let foot = edge.curve.closest(p);
        (foot.distance <= tolerance.length()).then_some(foot.parameter)
    };
    let total = a.lengths.total();
    let [from, to] = [b.curve.curve().start(), b.curve.curve().end()];
    let feet = [from, to].into_iter().filter_map(|p| near(&p, a));
    let mut ends = vec![0.0, total];
    ends.extend(feet.map(|u| a.lengths.length_at(u)));
    ends.sort_by(f64::total_cmp);
    let mut found: Vec<[f64; 2]> = Vec::new();
    for pair in ends.windows(2) {
        let inside = |k: usize| {
            let share = (k as f64 + 0.5) / TRIED as f64;
            a.point_at(pair[0] + (pair[1] - pair[0]) * share)
        };
        if pair[0] == pair[1] || !(0..TRIED).all(|k| near(&inside(k), b).is_some()) {
            continue;
        }
        match found.last_mut() {
            Some(last) if last[1] == pair[0] => last[1] = pair[1],
            _ => found.push([pair[0], pair[1]]),
        }
    }
    found.retain(|[from, to]| to - from > TOUCH * tolerance.length());
    found
}

/// A stretch of the first of two edges against the second; `None` if they part
/// somewhere between.
fn measured(
    [(i, a), (j, b)]: [(usize, &Edge<'_>); 2],
    stretch: [f64; 2],
    tolerance: Tolerance,
) -> Option<Join> {
    let resolution = tolerance.scaled(RESOLUTION);
    let length = stretch[1] - stretch[0];
    let feet = stretch.map(|s| {
        let foot = b.curve.closest(&a.point_at(s));
        b.lengths.length_at(foot.parameter)
    });
    let mut other = [feet[0].min(feet[1]), feet[0].max(feet[1])];
    // Round a closed edge the feet of both ends may be one.
    if other[1] - other[0] < 0.5 * length {
        other = [0.0, b.lengths.total()];
    }
    let [first, second] = [(a, stretch), (b, other)].map(|(edge, s)| edge.part(s, resolution));
    let (first, second) = (first?, second?);
    let there = directed_distance_between(&first, &second, resolution);
    let back = directed_distance_between(&second, &first, resolution);
    let gap = there.max.max(back.max);
    if gap > tolerance.length() {
        return None;
    }
    let (knuckle_max, knuckle_mean) = knuckle(a, b, stretch);
    Some(Join {
        edges: [i, j],
        stretches: [stretch, other],
        length,
        gap,
        knuckle_max,
        knuckle_mean,
    })
}

/// Largest and mean angle along the first of two edges that meet.
fn knuckle(a: &Edge<'_>, b: &Edge<'_>, [from, to]: [f64; 2]) -> (f64, f64) {
    let (mut largest, mut sum, mut count) = (0.0, 0.0, 0.0);
    for k in 0..PLACES {
        let share = (k as f64 + 0.5) / PLACES as f64;
        let u = a.lengths.parameter_at(from + (to - from) * share);
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

    /// The place at a length from its start.
    fn point_at(&self, length: f64) -> Point3<f64> {
        self.curve.curve().point(self.lengths.parameter_at(length))
    }

    /// The part between two lengths from its start.
    fn part(&self, [from, to]: [f64; 2], resolution: Tolerance) -> Option<CurveIndex> {
        if from <= 0.0 && to >= self.lengths.total() {
            return Some(self.curve.clone());
        }
        let [from, to] = [from, to].map(|s| self.lengths.parameter_at(s));
        let part = self.curve.curve().restricted(from, to).ok()?;
        Some(CurveIndex::with_resolution(&part, resolution))
    }

    /// Whether boxes allow these two to meet.
    fn may_meet(&self, other: &Edge<'_>, tolerance: f64) -> bool {
        let near = |k: usize| {
            self.bounds.min[k] <= other.bounds.max[k] + tolerance
                && other.bounds.min[k] <= self.bounds.max[k] + tolerance
        };
        (0..3).all(near)
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

    /// Two short plates along the side of a long one that is bent, with a place
    /// between them; a third that only touches it with a corner.
    #[test]
    fn parts_of_edges_meet() {
        let arc = |from: f64, to: f64, height: f64| {
            let at = |k: u32| from + (to - from) * f64::from(k) / 40.0;
            let places: Vec<Point3<f64>> = (0..=40)
                .map(|k| point![at(k), 0.1 * at(k) * at(k), height])
                .collect();
            let parameters: Vec<f64> = (0..=40).map(|k| f64::from(k) / 40.0).collect();
            crate::geometry::interpolate_at(&parameters, &places, 3).unwrap()
        };
        let strip = |from: f64, to: f64, z: [f64; 2]| {
            let sides = z.map(|z| arc(from, to, z));
            let [low, high] = sides;
            RuledSurface::new(low, high).unwrap().to_bspline().unwrap()
        };
        let surfaces = vec![
            strip(0.0, 4.0, [0.0, 1.0]),
            strip(0.0, 1.5, [1.0, 2.0]),
            strip(3.5, 2.0, [2.0, 1.0]),
            strip(4.0, 6.0, [1.0, 2.0]),
        ];
        let edges = edges(&surfaces, tolerance());
        let found = joins(&edges, tolerance());
        let pairs: Vec<[usize; 2]> = (found.iter())
            .map(|j| j.edges.map(|e| edges[e].surface))
            .collect();
        assert_eq!(pairs, [[0, 1], [0, 2]]);
        let long = &edges[found[0].edges[0]].lengths;
        for (join, [from, to]) in found.iter().zip([[0.0, 1.5], [2.0, 3.5]]) {
            let [from, to] = [from, to].map(|x| long.length_at(x / 4.0));
            assert!((join.stretches[0][0] - from).abs() < 1e-4, "{join:?}");
            assert!((join.stretches[0][1] - to).abs() < 1e-4);
            assert!((join.length - (to - from)).abs() < 2e-4);
            assert!(join.gap < 1e-4 && join.knuckle_max < 1e-3, "{join:?}");
            let [start, end] = join.stretches[1];
            assert!(start.abs() < 1e-4 && (end - join.length).abs() < 2e-4);
        }
        // The long one is open between and behind, so are all that are free.
        let open = open(&edges, &found, tolerance());
        assert_eq!(open.len(), edges.len() - 2);
        assert!(open.contains(&found[0].edges[0]));
    }

    #[test]
    fn plates_that_stand_apart_do_not_meet() {
        let surfaces = pair(0.3, 2e-3);
        assert!(joins(&edges(&surfaces, tolerance()), tolerance()).is_empty());
    }
}
