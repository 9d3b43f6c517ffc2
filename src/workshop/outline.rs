//! Outlines: closed chains of straight lines and circular arcs.

use super::development::{Development, breaks};
use crate::geometry::ArcLength;
use crate::numerics::sinc;
use nalgebra::{Point2, Vector2};
use std::f64::consts::PI;

/// An arc leaves the developed edge by no more than this share of the size.
const CHORDAL: f64 = 1e-6;
/// Halvings of a knot span at the most.
const MAX_HALVINGS: usize = 10;
/// Tangents that differ by more, radians, make a corner.
const KINK: f64 = 1e-4;
/// Corners nearer than this share of the size are one.
const SAME: f64 = 1e-11;
/// An arc's length differs from its chord by at least this share of it.
const STRAIGHT: f64 = 1e-13;
/// Arcs are drawn by chords of at most this angle, radians.
const CHORD_ANGLE: f64 = PI / 36.0;

/// A corner of an outline.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OutlineCorner {
    /// Where it is.
    pub at: Point2<f64>,
    /// tan(α/4) of the arc of angle α to the next corner, positive to the left;
    /// 0 for a straight line. (What DXF calls a bulge.)
    pub bulge: f64,
}

/// One boundary of a development with what it takes to trace it.
#[derive(Debug)]
pub(super) struct Edge<'a> {
    development: &'a Development<'a>,
    /// 0 or 1: the value of v.
    v: f64,
    lengths: ArcLength,
    breaks: Vec<f64>,
    /// The corners of the boundary.
    kinks: Vec<f64>,
    size: f64,
}

/// A place on a boundary.
#[derive(Debug, Clone, Copy)]
struct Node {
    u: f64,
    at: Point2<f64>,
    /// Length of the boundary up to here.
    length: f64,
    is_kink: bool,
}

impl<'a> Edge<'a> {
    pub fn new(development: &'a Development<'a>, second: bool, size: f64) -> Self {
        let surface = development.surface();
        let curve = if second {
            surface.second()
        } else {
            surface.first()
        };
        Edge {
            development,
            v: f64::from(u8::from(second)),
            lengths: ArcLength::new(curve),
            breaks: breaks(surface),
            kinks: curve.kinks(KINK),
            size,
        }
    }

    /// Length of the whole boundary on the surface.
    pub fn length(&self) -> f64 {
        self.lengths.total()
    }

    /// The corners between two parameters, each arc as long as its piece of the
    /// boundary, and the end as a corner of its own. Kinks stay corners.
    pub fn trace(&self, range: [f64; 2]) -> Vec<OutlineCorner> {
        let nodes = self.nodes(range);
        let mut corners = Vec::new();
        let mut i = 0;
        while i + 1 < nodes.len() {
            let mut j = i + 1;
            let mut bulge = self.arc(&nodes[i..=j]).unwrap_or(0.0);
            while let Some(longer) = nodes.get(i..=j + 1)
                && !nodes[j].is_kink
                && let Some(wider) = self.arc(longer)
            {
                (bulge, j) = (wider, j + 1);
            }
            let at = nodes[i].at;
            corners.push(OutlineCorner { at, bulge });
            i = j;
        }
        corners.extend(nodes.last().map(|n| OutlineCorner {
            at: n.at,
            bulge: 0.0,
        }));
        corners
    }

    /// Places between any two of which one arc is near enough, or nearly.
    fn nodes(&self, [from, to]: [f64; 2]) -> Vec<Node> {
        let mut nodes = vec![self.node(from)];
        let inner = self.breaks.iter().copied();
        let inner = inner.filter(|u| from < *u && *u < to);
        for u in inner.chain([to]) {
            let last = nodes[nodes.len() - 1];
            self.add(&last, &self.node(u), MAX_HALVINGS, &mut nodes);
        }
        nodes
    }

    fn add(&self, a: &Node, b: &Node, halvings: usize, nodes: &mut Vec<Node>) {
        let middle = self.node(0.5 * (a.u + b.u));
        let standing = b.length - a.length <= SAME * self.size;
        let quarters = [0.25, 0.75].map(|s| self.node(a.u + (b.u - a.u) * s));
        let chain = [*a, quarters[0], middle, quarters[1], *b];
        if standing || halvings == 0 || self.arc(&chain).is_some() {
            nodes.push(middle);
            nodes.push(*b);
        } else {
            self.add(a, &middle, halvings - 1, nodes);
            self.add(&middle, b, halvings - 1, nodes);
        }
    }

    fn node(&self, u: f64) -> Node {
        Node {
            u,
            at: self.development.point(u, self.v),
            length: self.lengths.length_at(u),
            is_kink: self.kinks.contains(&u),
        }
    }

    /// The bulge of the arc through the ends of a chain, as long as its piece of
    /// the boundary; `None` where it does not pass near enough to the rest.
    fn arc(&self, chain: &[Node]) -> Option<f64> {
        let [first, inner @ .., last] = chain else {
            return None;
        };
        let middle = inner.get(inner.len() / 2).unwrap_or(first);
        let length = last.length - first.length;
        let bulge = bulge(&first.at, &last.at, length, &middle.at);
        let is_near = |n: &Node| off(&first.at, &last.at, bulge, &n.at) <= CHORDAL * self.size;
        inner.iter().all(is_near).then_some(bulge)
    }
}

/// The bulge of the arc of a length between two points, on the side of a third.
fn bulge(from: &Point2<f64>, to: &Point2<f64>, length: f64, by: &Point2<f64>) -> f64 {
    let chord = to - from;
    let short = 1.0 - chord.norm() / length;
    if short.is_nan() || short <= STRAIGHT {
        return 0.0;
    }
    // sin x / x = chord / length for half the arc's angle x, by Newton's method
    // from x² = 6 (1 − chord/length), below which the root does not lie.
    let mut x = (6.0 * short).sqrt().min(PI);
    for _ in 0..20 {
        let slope = (x.cos() - sinc(x)) / x;
        let step = (sinc(x) - (1.0 - short)) / slope;
        x = (x - step).clamp(0.0, PI);
        if step.abs() <= 1e-14 * x {
            break;
        }
    }
    let left = chord.perp(&(by - from)) > 0.0;
    if left {
        -(0.5 * x).tan()
    } else {
        (0.5 * x).tan()
    }
}

/// Distance of a point from an arc or line, the point lying beside it.
fn off(from: &Point2<f64>, to: &Point2<f64>, bulge: f64, p: &Point2<f64>) -> f64 {
    match center(from, to, bulge) {
        None => {
            let chord = to - from;
            let length = chord.norm();
            if length == 0.0 {
                (p - from).norm()
            } else {
                chord.perp(&(p - from)).abs() / length
            }
        }
        Some((center, radius)) => ((p - center).norm() - radius).abs(),
    }
}

/// Centre and radius of an arc; `None` for a line.
fn center(from: &Point2<f64>, to: &Point2<f64>, bulge: f64) -> Option<(Point2<f64>, f64)> {
    if bulge == 0.0 {
        return None;
    }
    let chord = to - from;
    let left = Vector2::new(-chord.y, chord.x);
    // Of the chord: distance of the centre to the left, and the radius.
    let distance = (1.0 - bulge * bulge) / (4.0 * bulge);
    let radius = (1.0 + bulge * bulge) / (4.0 * bulge.abs()) * chord.norm();
    let center = from + chord * 0.5 + left * distance;
    Some((center, radius))
}

/// Leaves out corners that stand where the next one does.
pub(super) fn without_repeats(corners: Vec<OutlineCorner>, size: f64) -> Vec<OutlineCorner> {
    let next = |i: usize| corners[(i + 1) % corners.len()].at;
    (0..corners.len())
        .filter(|i| (next(*i) - corners[*i].at).norm() > SAME * size)
        .map(|i| corners[i])
        .collect()
}

/// Area inside a closed outline.
#[must_use]
pub fn area(outline: &[OutlineCorner]) -> f64 {
    let next = outline.iter().cycle().skip(1);
    let twice: f64 = (outline.iter().zip(next))
        .map(|(a, b)| {
            let angle = 4.0 * a.bulge.atan();
            let chord = (b.at - a.at).norm_squared();
            // Twice the segment between arc and chord: r² (α − sin α).
            let segment = if a.bulge == 0.0 {
                0.0
            } else {
                let sine = (0.5 * angle).sin();
                chord / (4.0 * sine * sine) * (angle - angle.sin())
            };
            a.at.coords.perp(&b.at.coords) + segment
        })
        .sum();
    0.5 * twice.abs()
}

/// Length of all lines and arcs of an outline.
#[must_use]
pub fn perimeter(outline: &[OutlineCorner]) -> f64 {
    let next = outline.iter().cycle().skip(1);
    (outline.iter().zip(next))
        .map(|(a, b)| (b.at - a.at).norm() / sinc(2.0 * a.bulge.atan()))
        .sum()
}

/// The outline by straight lines, arcs by short chords.
#[must_use]
pub fn polygon(outline: &[OutlineCorner]) -> Vec<Point2<f64>> {
    let next = outline.iter().cycle().skip(1);
    let mut points = Vec::with_capacity(outline.len());
    for (a, b) in outline.iter().zip(next) {
        points.push(a.at);
        if let Some((center, _)) = center(&a.at, &b.at, a.bulge) {
            let angle = 4.0 * a.bulge.atan();
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
            let chords = (angle.abs() / CHORD_ANGLE).ceil() as u32;
            let arm = a.at - center;
            points.extend((1..chords).map(|i| {
                let turn = angle * f64::from(i) / f64::from(chords);
                center + nalgebra::Rotation2::new(turn) * arm
            }));
        }
    }
    points
}

/// Longer and shorter side of the least rectangle around points: one of its
/// sides lies along the hull of the points (Freeman & Shapira 1975).
#[must_use]
pub fn least_rectangle(points: &[Point2<f64>]) -> [f64; 2] {
    let hull = convex_hull(points);
    let next = hull.iter().cycle().skip(1);
    let mut best = ([0.0; 2], f64::INFINITY);
    for (a, b) in hull.iter().zip(next) {
        let Some(along) = (b - a).try_normalize(0.0) else {
            continue;
        };
        let across = Vector2::new(-along.y, along.x);
        let sides = [along, across].map(|d| {
            let [low, high] = hull
                .iter()
                .fold([f64::INFINITY, f64::NEG_INFINITY], |s, p| {
                    let x = d.dot(&p.coords);
                    [s[0].min(x), s[1].max(x)]
                });
            high - low
        });
        if sides[0] * sides[1] < best.1 {
            best = (sides, sides[0] * sides[1]);
        }
    }
    let [a, b] = best.0;
    [a.max(b), a.min(b)]
}

/// The convex hull, counter-clockwise (Andrew 1979).
fn convex_hull(points: &[Point2<f64>]) -> Vec<Point2<f64>> {
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    sorted.dedup();
    if sorted.len() < 3 {
        return sorted;
    }
    let half = |points: &mut dyn Iterator<Item = &Point2<f64>>| {
        let mut chain: Vec<Point2<f64>> = Vec::new();
        for p in points {
            while let [.., a, b] = chain[..]
                && (b - a).perp(&(p - a)) <= 0.0
            {
                chain.pop();
            }
            chain.push(*p);
        }
        chain.pop();
        chain
    };
    let mut hull = half(&mut sorted.iter());
    hull.extend(half(&mut sorted.iter().rev()));
    hull
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corner(x: f64, y: f64, bulge: f64) -> OutlineCorner {
        OutlineCorner {
            at: Point2::new(x, y),
            bulge,
        }
    }

    #[test]
    fn a_disc_of_two_arcs_has_the_area_and_girth_of_a_disc() {
        for turn in [1.0, -1.0] {
            let disc = [corner(-2.0, 0.0, turn), corner(2.0, 0.0, turn)];
            assert!((area(&disc) - 4.0 * PI).abs() < 1e-12);
            assert!((perimeter(&disc) - 4.0 * PI).abs() < 1e-12);
            let polygon = polygon(&disc);
            assert!(
                polygon
                    .iter()
                    .all(|p| (p.coords.norm() - 2.0).abs() < 1e-12)
            );
            assert_eq!(polygon.len(), 72);
        }
    }

    #[test]
    fn an_arc_has_the_length_that_is_asked_on_the_side_that_is_asked() {
        let (from, to) = (Point2::new(0.0, 0.0), Point2::new(1.0, 0.0));
        for (length, above) in [(PI / 2.0, true), (1.0 + 1e-9, false), (1.3, true)] {
            let by = Point2::new(0.5, if above { 0.1 } else { -0.1 });
            let bulge = bulge(&from, &to, length, &by);
            assert_eq!(bulge < 0.0, above);
            let there = [corner(0.0, 0.0, bulge), corner(1.0, 0.0, 0.0)];
            assert!((perimeter(&there) - 1.0 - length).abs() < 1e-12, "{length}");
        }
        assert_eq!(bulge(&from, &to, 1.0, &to), 0.0);
    }

    #[test]
    fn the_least_rectangle_lies_along_a_side() {
        let turned = |x: f64, y: f64| Point2::new(0.8 * x - 0.6 * y, 0.6 * x + 0.8 * y);
        let points = [[0.0, 0.0], [5.0, 0.0], [5.0, 2.0], [2.0, 2.0], [1.0, 1.0]];
        let points = points.map(|[x, y]| turned(x, y));
        let [length, width] = least_rectangle(&points);
        assert!((length - 5.0).abs() < 1e-12 && (width - 2.0).abs() < 1e-12);
    }
}
