//! Stations: where planes square to the hull's length cross a plate.

use crate::geometry::RuledSurface;
use nalgebra::{Point2, Vector2};
use std::collections::BTreeMap;

/// Steps along the rulings; a ruling within a station is crossed this often.
const ACROSS: usize = 8;
/// A bound on the list of stations, whatever the numbers.
const MOST_STATIONS: u32 = 200;
/// Steps to a place at the most; a handful is enough where u runs evenly.
const STEPS: usize = 40;

/// A place on the plate: its parameters.
type Place = Vector2<f64>;
/// An edge of the net: along `u` from node (j, k), or along `v` (`true`).
type NetEdge = (usize, usize, bool);

/// A plate to be crossed by stations.
pub(super) struct Net<'a> {
    surface: &'a RuledSurface,
    fields: &'a [f64],
    axis: usize,
    /// The coordinate at both ends of the ruling at each of `fields`.
    ends: Vec<[f64; 2]>,
}

/// One station.
struct Station<'a> {
    net: &'a Net<'a>,
    at: f64,
}

impl<'a> Net<'a> {
    /// A net of rulings at `fields`, for stations of coordinate `axis`.
    pub fn new(surface: &'a RuledSurface, fields: &'a [f64], axis: usize) -> Self {
        let mut net = Net {
            surface,
            fields,
            axis,
            ends: Vec::new(),
        };
        net.ends = fields.iter().map(|u| net.ends_at(*u)).collect();
        net
    }

    fn ends_at(&self, u: f64) -> [f64; 2] {
        [self.surface.first(), self.surface.second()].map(|c| c.point(u)[self.axis])
    }

    /// The chains of places (u, v) at which the coordinate is `at`, each from
    /// border to border of the plate: contours of the net (marching squares)
    /// whose places are then found on the surface itself.
    pub fn crossing(&self, at: f64) -> Vec<Vec<Place>> {
        let station = Station { net: self, at };
        let links = station.links();
        (chains(links).iter())
            .map(|chain| chain.iter().map(|e| station.place(e)).collect())
            .collect()
    }
}

impl Station<'_> {
    /// Which edges of the net are joined by the station across a field.
    fn links(&self) -> BTreeMap<NetEdge, Vec<NetEdge>> {
        let signs: Vec<_> = (0..self.net.fields.len()).map(|j| self.signs(j)).collect();
        let mut links: BTreeMap<NetEdge, Vec<NetEdge>> = BTreeMap::new();
        for (j, pair) in signs.windows(2).enumerate() {
            for k in 0..ACROSS {
                let corners = [pair[0][k], pair[1][k], pair[1][k + 1], pair[0][k + 1]];
                let sides = [
                    (j, k, false),
                    (j + 1, k, true),
                    (j, k + 1, false),
                    (j, k, true),
                ];
                let mut cut: Vec<NetEdge> = (0..4)
                    .filter(|i| corners[*i] != corners[(i + 1) % 4])
                    .map(|i| sides[i])
                    .collect();
                if cut.len() == 4 && corners[0] != self.is_above_middle(j, k) {
                    // Two lines: those that cut off the corners which differ from
                    // the middle.
                    cut.rotate_left(1);
                }
                for two in cut.chunks_exact(2) {
                    links.entry(two[0]).or_default().push(two[1]);
                    links.entry(two[1]).or_default().push(two[0]);
                }
            }
        }
        links
    }

    /// How far (u, v) lies before or behind the station.
    fn ahead(&self, [a, b]: [f64; 2], v: f64) -> f64 {
        (a - self.at) + (b - a) * v
    }

    fn signs(&self, j: usize) -> [bool; ACROSS + 1] {
        let ends = self.net.ends[j];
        std::array::from_fn(|k| self.ahead(ends, k as f64 / ACROSS as f64) >= 0.0)
    }

    fn is_above_middle(&self, j: usize, k: usize) -> bool {
        let u = 0.5 * (self.net.fields[j] + self.net.fields[j + 1]);
        let v = (k as f64 + 0.5) / ACROSS as f64;
        self.ahead(self.net.ends_at(u), v) >= 0.0
    }

    /// Where the station crosses an edge of the net: on a ruling by proportion,
    /// along u by the false position of Illinois (Dowell & Jarratt 1971).
    fn place(&self, &(j, k, along_ruling): &NetEdge) -> Place {
        let v = k as f64 / ACROSS as f64;
        if along_ruling {
            let [a, b] = self.net.ends[j].map(|x| x - self.at);
            return Place::new(self.net.fields[j], (a / (a - b)).clamp(0.0, 1.0));
        }
        let mut low = (self.net.fields[j], self.ahead(self.net.ends[j], v));
        let mut high = (self.net.fields[j + 1], self.ahead(self.net.ends[j + 1], v));
        let mut nearest = if low.1.abs() < high.1.abs() {
            low
        } else {
            high
        };
        // Which end the last step moved: one that stays twice counts half.
        let mut moved_high = None;
        for _ in 0..STEPS {
            let next = high.0 - high.1 * (high.0 - low.0) / (high.1 - low.1);
            if nearest.1 == 0.0 || !(next > low.0 && next < high.0) {
                break;
            }
            nearest = (next, self.ahead(self.net.ends_at(next), v));
            let moves_high = (nearest.1 >= 0.0) == (high.1 >= 0.0);
            let again = moved_high == Some(moves_high);
            let (moved, stays) = if moves_high {
                (&mut high, &mut low)
            } else {
                (&mut low, &mut high)
            };
            *moved = nearest;
            if again {
                stays.1 *= 0.5;
            }
            moved_high = Some(moves_high);
        }
        Place::new(nearest.0, v)
    }
}

/// Links gathered into chains, open ones first, in the order of their ends.
fn chains(mut links: BTreeMap<NetEdge, Vec<NetEdge>>) -> Vec<Vec<NetEdge>> {
    let mut chains = Vec::new();
    while let Some(start) = (links.iter())
        .find(|(_, to)| to.len() == 1)
        .or_else(|| links.iter().next())
        .map(|(edge, _)| *edge)
    {
        let mut chain = vec![start];
        let mut here = start;
        while let Some(next) = links.get_mut(&here).and_then(Vec::pop) {
            if let Some(back) = links.get_mut(&next)
                && let Some(i) = back.iter().position(|e| *e == here)
            {
                back.swap_remove(i);
            }
            if links.get(&here).is_some_and(Vec::is_empty) {
                links.remove(&here);
            }
            chain.push(next);
            here = next;
        }
        links.remove(&here);
        chains.push(chain);
    }
    chains
}

/// Round values for stations within a range: about `count` steps of 1, 2 or 5
/// times a power of ten.
#[must_use]
pub fn round_stations([low, high]: [f64; 2], count: f64) -> Vec<f64> {
    let rough = (high - low) / count;
    if !(rough.is_finite() && rough > 0.0) {
        return Vec::new();
    }
    let decade = 10f64.powf(rough.log10().floor());
    let steps = [1.0, 2.0, 5.0, 10.0].map(|s| s * decade);
    // A hair of slack: the decade itself is rounded.
    let step = steps.into_iter().find(|s| *s >= rough * (1.0 - 1e-9));
    let step = step.unwrap_or(10.0 * decade);
    let first = (low / step).ceil();
    (0..MOST_STATIONS)
        .map(|i| (first + f64::from(i)) * step)
        // Through their decimals, so that 0.3 is 0.3.
        .map(|at| format!("{at:.12e}").parse().unwrap_or(at))
        .take_while(|at| *at <= high)
        .collect()
}

/// A polyline without the points that lie within `tolerance` of what remains
/// (Douglas & Peucker 1973).
pub(super) fn simplified(points: &[Point2<f64>], tolerance: f64) -> Vec<Point2<f64>> {
    let [first, .., last] = points else {
        return points.to_vec();
    };
    let chord = last - first;
    let distance = |p: &Point2<f64>| {
        let along = (p - first).dot(&chord) / chord.norm_squared();
        let along = if along.is_finite() {
            along.clamp(0.0, 1.0)
        } else {
            0.0
        };
        (p - (first + chord * along)).norm()
    };
    let inner = points.iter().enumerate().skip(1).take(points.len() - 2);
    let worst = inner.fold((0, tolerance), |worst, (i, p)| {
        if distance(p) > worst.1 {
            (i, distance(p))
        } else {
            worst
        }
    });
    if worst.0 == 0 {
        return vec![*first, *last];
    }
    let mut kept = simplified(&points[..=worst.0], tolerance);
    kept.pop();
    kept.extend(simplified(&points[worst.0..], tolerance));
    kept
}
