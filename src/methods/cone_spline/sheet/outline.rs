//! The strip's outline in the running coordinates (σ, Λ) of the chain.

use super::super::chain::{Chain, Placed};
use super::super::target::Target;
use nalgebra::{Point2, Point3};

/// The outline of a strip, laid on its chain.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Outline {
    /// The two long sides, σ increasing.
    sides: [Vec<Point2<f64>>; 2],
    /// The short sides, from side 0 to side 1.
    ends: [Vec<Point2<f64>>; 2],
}

impl Outline {
    /// Projects the outline of a strip onto its chain.
    pub fn project(chain: &Chain, target: &Target) -> Outline {
        let ground = Ground::new(chain);
        let last = chain.len() - 1;
        Outline {
            sides: [0, 1].map(|k| forward(ground.polyline(&target.sides[k], 0))),
            ends: [0, 1].map(|k| ground.polyline(&target.ends[k], k * last)),
        }
    }

    /// Least and largest σ.
    pub fn range(&self) -> [f64; 2] {
        let all = self.sides.iter().chain(&self.ends).flatten();
        all.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], p| {
            [low.min(p.x), high.max(p.x)]
        })
    }

    /// Λ of side 0 and side 1 at σ: linear between vertices; beyond the last
    /// vertex as there.
    pub fn sides_at(&self, sigma: f64) -> [Point2<f64>; 2] {
        [0, 1].map(|k| Point2::new(sigma, at(&self.sides[k], sigma)))
    }

    /// A side between two values of σ, with places at both that lie on it.
    pub fn side(&self, side: usize, [from, to]: [f64; 2]) -> Vec<Point2<f64>> {
        let all = &self.sides[side];
        let ends = |p: &&Point2<f64>| from < p.x && p.x < to;
        let reached = |sigma: f64| {
            let inside = all.first().is_some_and(|p| p.x <= sigma)
                && all.last().is_some_and(|p| sigma <= p.x);
            inside.then(|| Point2::new(sigma, at(all, sigma)))
        };
        let mut points: Vec<_> = reached(from).into_iter().collect();
        points.extend(all.iter().filter(ends));
        points.extend(reached(to));
        points
    }

    /// Whether a place lies between the short sides; to rounding.
    pub fn is_between_ends(&self, place: &Point2<f64>, size: f64) -> bool {
        /// Of the size: what rounding moves a place by.
        const ROUNDING: f64 = 1e-12;
        let sigma = |end: &[Point2<f64>]| {
            let across: Vec<_> = end.iter().map(|p| Point2::new(p.y, p.x)).collect();
            at(&forward(across), place.y)
        };
        let margin = ROUNDING * size;
        sigma(&self.ends[0]) - margin <= place.x && place.x <= sigma(&self.ends[1]) + margin
    }

    /// The part of the outline's inside between two values of σ, as a closed
    /// polygon that runs along side 0 first.
    pub fn between(&self, [from, to]: [f64; 2]) -> Vec<Point2<f64>> {
        let after = clipped(&self.polygon(), |p| p.x - from);
        clipped(&after, |p| to - p.x)
    }

    /// Side 0 forward, the finish, side 1 backward, the start.
    fn polygon(&self) -> Vec<Point2<f64>> {
        let [first, second] = &self.sides;
        let [start, finish] = &self.ends;
        let inner = |end: &[Point2<f64>]| -> Vec<Point2<f64>> {
            let inside = 1..end.len().saturating_sub(1).max(1);
            end.get(inside).unwrap_or_default().to_vec()
        };
        let mut polygon = first.clone();
        polygon.extend(inner(finish));
        polygon.extend(second.iter().rev());
        polygon.extend(inner(start).into_iter().rev());
        polygon
    }
}

/// A chain to project on, with where its patches stand in σ and Λ.
struct Ground {
    placed: Placed,
    /// σ − arc and Λ − λ of each patch.
    shifts: Vec<[f64; 2]>,
}

impl Ground {
    fn new(chain: &Chain) -> Self {
        let placed = Placed::new(chain);
        let mut shifts: Vec<[f64; 2]> = Vec::with_capacity(chain.len());
        for i in 0..chain.len() {
            let shift = match i.checked_sub(1) {
                None => [-chain.reach[0][0], 0.0],
                Some(before) => {
                    let [sigma, offset] = shifts[before];
                    let end = placed.frames[before]
                        .carried(placed.strains[before], placed.reach[before][1]);
                    let start = placed.frames[i].carried(placed.strains[i], placed.reach[i][0]);
                    let slide = (start.point - end.point).dot(&end.ruling);
                    let here = sigma + placed.reach[before][1] - placed.reach[i][0];
                    [here, offset + slide]
                }
            };
            shifts.push(shift);
        }
        Ground { placed, shifts }
    }

    fn polyline(&self, points: &[Point3<f64>], first: usize) -> Vec<Point2<f64>> {
        let mut patch = first;
        (points.iter())
            .map(|point| {
                let (home, foot) = self.placed.foot(point, patch);
                patch = home;
                let [sigma, offset] = self.shifts[home];
                Point2::new(foot.arc + sigma, foot.lambda + offset)
            })
            .collect()
    }
}

/// Leaves out what runs backwards: noise along a side must not turn it round.
fn forward(points: Vec<Point2<f64>>) -> Vec<Point2<f64>> {
    let mut kept: Vec<Point2<f64>> = Vec::with_capacity(points.len());
    for point in points {
        if kept.last().is_none_or(|last| last.x < point.x) {
            kept.push(point);
        }
    }
    kept
}

/// The ordinate of a polyline with increasing abscissae.
fn at(line: &[Point2<f64>], x: f64) -> f64 {
    let after = line.partition_point(|p| p.x < x);
    match (after.checked_sub(1).map(|i| line[i]), line.get(after)) {
        (Some(a), Some(b)) => a.y + (b.y - a.y) * (x - a.x) / (b.x - a.x),
        (Some(p), None) => p.y,
        (None, Some(p)) => p.y,
        (None, None) => 0.0,
    }
}

/// The part of a polygon where a linear function is not negative (Sutherland &
/// Hodgman 1974).
fn clipped(polygon: &[Point2<f64>], inside: impl Fn(&Point2<f64>) -> f64) -> Vec<Point2<f64>> {
    let mut kept = Vec::with_capacity(polygon.len() + 2);
    for (i, point) in polygon.iter().enumerate() {
        let before = &polygon[(i + polygon.len() - 1) % polygon.len()];
        let [a, b] = [inside(before), inside(point)];
        if (a < 0.0) != (b < 0.0) {
            kept.push(before + (point - before) * (a / (a - b)));
        }
        if b >= 0.0 {
            kept.push(*point);
        }
    }
    kept
}
