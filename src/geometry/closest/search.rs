//! One query: the best point so far and what has been ruled out.

use super::{Closest, Leaf};
use crate::geometry::BSplineCurve;
use nalgebra::Point3;

/// Most halvings of intervals in one query. A regular query needs none; a
/// hundred settle a near tie; a centre of curvature would take all there are.
const MAX_HALVINGS: usize = 2000;

/// Newton steps on a convex interval; quadratic convergence takes about four,
/// the bracket bounds the rest.
const MAX_STEPS: usize = 50;

/// The state of one query.
pub(super) struct Search<'a> {
    curve: &'a BSplineCurve,
    query: Point3<f64>,
    resolution: f64,
    parameter: f64,
    point: Point3<f64>,
    distance: f64,
    /// Least lower bound of all that was ruled out.
    floor: f64,
    halvings_left: usize,
}

/// A part of a leaf.
#[derive(Debug, Clone, Copy)]
struct Part {
    u: [f64; 2],
    ends: [Point3<f64>; 2],
}

impl<'a> Search<'a> {
    pub fn new(curve: &'a BSplineCurve, query: Point3<f64>, resolution: f64) -> Self {
        Search {
            curve,
            query,
            resolution,
            parameter: curve.domain()[0],
            point: curve.start(),
            distance: (curve.start() - query).norm(),
            floor: f64::INFINITY,
            halvings_left: MAX_HALVINGS,
        }
    }

    /// Whether something at least `bound` away need not be looked at; it is
    /// then counted as ruled out.
    pub fn rules_out(&mut self, bound: f64) -> bool {
        let out = bound >= self.distance - self.resolution;
        if out {
            self.floor = self.floor.min(bound);
        }
        out
    }

    /// Searches one leaf, halving it as far as needed; `near`: a parameter from
    /// which Newton's method may begin, if it lies in the leaf.
    pub fn leaf(&mut self, leaf: &Leaf, near: Option<f64>) {
        // Grows only where halving is needed, which is rare.
        let mut waiting: Vec<Part> = Vec::new();
        let mut next = Some(Part {
            u: leaf.u,
            ends: leaf.ends,
        });
        while let Some(part) = next {
            match self.halve(leaf, part, near) {
                Some([a, b]) => {
                    waiting.push(b);
                    next = Some(a);
                }
                None => next = waiting.pop(),
            }
        }
    }

    /// Settles a part, or gives its halves, nearer first.
    fn halve(&mut self, leaf: &Leaf, part: Part, near: Option<f64>) -> Option<[Part; 2]> {
        let [a, b] = part.ends;
        let h = part.u[1] - part.u[0];
        let bulge = leaf.bulge(h);
        let far = self.offer_ends(&part) + bulge;
        let chord = b - a;
        let share = ((self.query - a).dot(&chord) / chord.norm_squared()).clamp(0.0, 1.0);
        let share = if share.is_nan() { 0.0 } else { share };
        let bound = (a + chord * share - self.query).norm() - bulge;
        if self.rules_out(bound.max(0.0)) {
            return None;
        }
        let slowest = (chord.norm() / h - 0.5 * leaf.second * h).max(0.0);
        let inside = near.filter(|u| *u >= part.u[0] && *u <= part.u[1]);
        let start = inside.unwrap_or(part.u[0] + share * h);
        if slowest * slowest > far * leaf.second {
            self.newton(leaf, part.u, start);
            return None;
        }
        let middle = part.u[0] + 0.5 * h;
        let jet = self.curve.derivatives_in_span(leaf.span, middle);
        self.offer(middle, jet.point);
        // The same with (C − q)·C″ taken in the middle and its change bounded.
        let change = 0.5 * h * (far * leaf.third + leaf.speed * leaf.second);
        if slowest * slowest + (jet.point - self.query).dot(&jet.d2) > change {
            self.newton(leaf, part.u, start);
            return None;
        }
        if self.halvings_left == 0 || middle <= part.u[0] || middle >= part.u[1] {
            self.floor = self.floor.min(bound.max(0.0));
            return None;
        }
        self.halvings_left -= 1;
        let left = Part {
            u: [part.u[0], middle],
            ends: [a, jet.point],
        };
        let right = Part {
            u: [middle, part.u[1]],
            ends: [jet.point, b],
        };
        Some(if share <= 0.5 {
            [left, right]
        } else {
            [right, left]
        })
    }

    /// Offers both ends; gives the larger of their distances.
    fn offer_ends(&mut self, part: &Part) -> f64 {
        let start = self.offer(part.u[0], part.ends[0]);
        let end = self.offer(part.u[1], part.ends[1]);
        start.max(end)
    }

    /// A point of the curve; gives its distance.
    fn offer(&mut self, parameter: f64, point: Point3<f64>) -> f64 {
        let distance = (point - self.query).norm();
        if distance < self.distance {
            (self.parameter, self.point, self.distance) = (parameter, point, distance);
        }
        distance
    }

    /// Newton's method for `(C − q)·C′ = 0` inside an interval on which that
    /// function increases. Ends of the bracket may be stepped onto once, for
    /// minima at the ends; after that such steps become bisection.
    fn newton(&mut self, leaf: &Leaf, [mut low, mut high]: [f64; 2], start: f64) {
        let (mut low_seen, mut high_seen) = (false, false);
        let mut u = start;
        for _ in 0..MAX_STEPS {
            let jet = self.curve.derivatives_in_span(leaf.span, u);
            self.offer(u, jet.point);
            let offset = jet.point - self.query;
            let slope = offset.dot(&jet.d1);
            if slope > 0.0 {
                (high, high_seen) = (u, true);
            } else {
                (low, low_seen) = (u, true);
            }
            let step = slope / (jet.d1.norm_squared() + offset.dot(&jet.d2));
            if high <= low || step.abs() <= f64::EPSILON * u.abs().max(high - low) {
                break;
            }
            let newton = u - step;
            u = match newton {
                x if x > low && x < high => x,
                x if x <= low && !low_seen => low,
                x if x >= high && !high_seen => high,
                _ => 0.5 * (low + high),
            };
        }
    }

    /// The answer.
    pub fn finish(self) -> Closest {
        let lower_bound = self.floor.min(self.distance);
        Closest {
            parameter: self.parameter,
            point: self.point,
            distance: self.distance,
            lower_bound,
            certain: self.distance - lower_bound <= self.resolution,
        }
    }
}
