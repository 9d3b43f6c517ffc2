//! Which point of one long side is joined to which of the other: the shortest
//! monotone path over pairs of stations.

use super::outline::Outline;
use nalgebra::{Point3, Vector3};

/// Sides, ends and rulings of a strip.
#[derive(Debug)]
pub(super) struct Paired {
    pub(super) sides: [Vec<Point3<f64>>; 2],
    pub(super) ends: [Vec<Point3<f64>>; 2],
    pub(super) rulings: Vec<[Point3<f64>; 2]>,
}

/// Stations of each side.
const STATIONS: usize = 96;
/// Rulings that are handed on.
const RULINGS: usize = 41;
/// Length of a ruling, squared, against the shortest from its station: decides
/// where the surface is flat. Little, since rulings may run far from square
/// across a strip, as those of a tangent developable do; a twist of 1° weighs
/// as much as twice the length.
const LENGTH_WEIGHT: f64 = 1e-4;
/// What the mesh's normals say, against what the sides say. Of several ruled
/// surfaces between two sides it picks that of the mesh; more would let bumps
/// of the mesh turn the rulings.
const MESH_WEIGHT: f64 = 0.01;
/// For each station at an end that no ruling reaches: a twist of 8° is worse.
const UNREACHED: f64 = 0.02;
/// At most this share of a side stays unreached at each end.
const MOST_UNREACHED: f64 = 0.25;
/// Normals and tangents are averaged over so many stations to either side.
const SMOOTHING: usize = 3;
/// The short way across counts unless the rulings of the long one are nearer
/// to the mesh by this factor.
const LONGWISE: f64 = 0.7;
/// Points along a ruling, and vertices of the mesh, by which that is measured.
const ALONG: usize = 12;
const MEASURED: usize = 4000;

/// The better of two ways to name the corners; the first two of each bound
/// the finish, in the direction of the outline.
pub(super) fn best(outline: &Outline, ways: [[usize; 4]; 2], points: &[Point3<f64>]) -> Paired {
    let ends = |way: &[usize; 4]| outline.between(way[0], way[1]) + outline.between(way[2], way[3]);
    let [mut across, mut longwise] = ways;
    if ends(&longwise) < ends(&across) {
        std::mem::swap(&mut across, &mut longwise);
    }
    let [across, longwise] = [across, longwise].map(|way| pair(outline, way));
    if longwise.distance(points) < LONGWISE * across.distance(points) {
        longwise
    } else {
        across
    }
}

/// A side at its stations.
struct Side {
    points: Vec<Point3<f64>>,
    /// Unit normals of the surface.
    normals: Vec<Vector3<f64>>,
    /// Unit tangents of the side.
    tangents: Vec<Vector3<f64>>,
}

impl Side {
    fn new(outline: &Outline, indices: &[usize]) -> Self {
        let mut lengths = vec![0.0];
        for pair in indices.windows(2) {
            let step = (outline.points[pair[1]] - outline.points[pair[0]]).norm();
            lengths.push(lengths[lengths.len() - 1] + step);
        }
        let whole = lengths[lengths.len() - 1];
        let (mut points, mut normals) = (Vec::new(), Vec::new());
        for station in 0..=STATIONS {
            let arc = whole * station as f64 / STATIONS as f64;
            let last = lengths.len() - 1;
            let after = lengths.partition_point(|l| *l <= arc).clamp(1, last.max(1));
            let (i, j) = (after - 1, after.min(last));
            let span = lengths[j] - lengths[i];
            let share = if span > 0.0 {
                (arc - lengths[i]) / span
            } else {
                0.0
            };
            let [a, b] = [indices[i], indices[j]];
            points.push(outline.points[a].lerp(&outline.points[b], share));
            normals.push(outline.normals[a].lerp(&outline.normals[b], share));
        }
        Side {
            normals: smoothed(&normals),
            tangents: tangents(&points),
            points,
        }
    }
}

fn tangents(points: &[Point3<f64>]) -> Vec<Vector3<f64>> {
    let chord = |i: usize| {
        let (a, b) = (
            i.saturating_sub(SMOOTHING),
            (i + SMOOTHING).min(points.len() - 1),
        );
        let d = points[b] - points[a];
        d.try_normalize(0.0).unwrap_or_else(Vector3::zeros)
    };
    (0..points.len()).map(chord).collect()
}

fn smoothed(normals: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
    let around = |i: usize| {
        let reach = SMOOTHING.min(i).min(normals.len() - 1 - i);
        let sum: Vector3<f64> = normals[i - reach..=i + reach].iter().sum();
        sum.try_normalize(0.0).unwrap_or(normals[i])
    };
    (0..normals.len()).map(around).collect()
}

/// Sides, ends and rulings with corners a, b at the finish and c, d at the
/// start. The outline has the surface to its left, so that from d to a it runs
/// along side 1 from the start to the finish.
pub(super) fn pair(outline: &Outline, [a, b, c, d]: [usize; 4]) -> Paired {
    let reversed = |mut indices: Vec<usize>| {
        indices.reverse();
        indices
    };
    let sides = [reversed(outline.stretch(b, c)), outline.stretch(d, a)];
    let ends = [outline.stretch(c, d), reversed(outline.stretch(a, b))];
    let [first, second] = [0, 1].map(|i| Side::new(outline, &sides[i]));
    let costs = costs(&first, &second);
    let path = shortest(&costs);
    let rulings = spread(&path)
        .into_iter()
        .map(|[s, t]| [along(&first.points, s), along(&second.points, t)])
        .collect();
    let points = |indices: &Vec<usize>| indices.iter().map(|i| outline.points[*i]).collect();
    let paired = Paired {
        sides: [points(&sides[0]), points(&sides[1])],
        ends: [points(&ends[0]), points(&ends[1])],
        rulings,
    };
    canonical(paired)
}

/// The longer end first; ends of one length by their places.
fn canonical(paired: Paired) -> Paired {
    let length = |p: &[Point3<f64>]| p.windows(2).map(|w| (w[1] - w[0]).norm()).sum::<f64>();
    let [start, finish] = [0, 1].map(|i| length(&paired.ends[i]));
    let equal = (start - finish).abs() <= SAME_LENGTH * (start + finish);
    let place = |p: &[Point3<f64>]| p.iter().map(|p| p.coords.sum()).sum::<f64>() / p.len() as f64;
    let turned = if equal {
        place(&paired.ends[0]) > place(&paired.ends[1])
    } else {
        start < finish
    };
    if turned { paired.turned() } else { paired }
}

/// Ends whose lengths differ by less of their sum are taken as equal.
const SAME_LENGTH: f64 = 1e-9;

impl Paired {
    /// Root mean square distance of vertices of the mesh from the rulings.
    fn distance(&self, points: &[Point3<f64>]) -> f64 {
        let on = |[p, q]: &[Point3<f64>; 2]| {
            let (p, q) = (*p, *q);
            (0..=ALONG).map(move |k| p.lerp(&q, k as f64 / ALONG as f64))
        };
        let samples: Vec<Point3<f64>> = self.rulings.iter().flat_map(on).collect();
        let nearest = |p: &Point3<f64>| {
            let squares = samples.iter().map(|q| (q - p).norm_squared());
            squares.fold(f64::INFINITY, f64::min)
        };
        let some = points
            .iter()
            .step_by(points.len().div_ceil(MEASURED).max(1));
        let (sum, count) = some.fold((0.0, 0.0), |(s, n), p| (s + nearest(p), n + 1.0));
        (sum / f64::max(count, 1.0)).sqrt()
    }

    /// The strip turned about its normal: start and finish, and the sides,
    /// change places.
    fn turned(self) -> Self {
        let back = |mut p: Vec<Point3<f64>>| {
            p.reverse();
            p
        };
        let [first, second] = self.sides;
        let [start, finish] = self.ends;
        Paired {
            sides: [back(second), back(first)],
            ends: [back(finish), back(start)],
            rulings: self
                .rulings
                .into_iter()
                .rev()
                .map(|[p, q]| [q, p])
                .collect(),
        }
    }
}

/// The point at a station, fractions between them.
fn along(points: &[Point3<f64>], station: f64) -> Point3<f64> {
    let last = points.len() - 1;
    let at = station.clamp(0.0, last as f64);
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let i = (at.floor() as usize).min(last.saturating_sub(1));
    points[i].lerp(&points[(i + 1).min(last)], at - i as f64)
}

/// Cost of the ruling from each station of the first side to each of the
/// second.
fn costs(first: &Side, second: &Side) -> Vec<Vec<f64>> {
    let squares = |p: &Point3<f64>, side: &Side| {
        let d = side.points.iter().map(|q| (q - p).norm_squared());
        d.fold(f64::INFINITY, f64::min)
    };
    let shortest: Vec<f64> = second.points.iter().map(|q| squares(q, first)).collect();
    let row = |i: usize| {
        let own = squares(&first.points[i], second);
        let cell = |j: usize| {
            let length = (second.points[j] - first.points[i]).norm_squared();
            let short = 0.5 * (own + shortest[j]);
            let longer = if short > 0.0 {
                length / short - 1.0
            } else {
                0.0
            };
            twist(first, i, second, j) + LENGTH_WEIGHT * longer
        };
        (0..second.points.len()).map(cell).collect()
    };
    (0..first.points.len()).map(row).collect()
}

/// How far the surface is from having a ruling there: the twist between the
/// sides, and how the mesh lies to it.
fn twist(first: &Side, i: usize, second: &Side, j: usize) -> f64 {
    let l = second.points[j] - first.points[i];
    let Some(r) = l.try_normalize(0.0) else {
        return 0.0;
    };
    let across = |t: &Vector3<f64>| r.cross(t).try_normalize(0.0).unwrap_or(r);
    let between = across(&first.tangents[i]) - across(&second.tangents[j]);
    let (n, m) = (&first.normals[i], &second.normals[j]);
    let mesh = (n - m).norm_squared() + r.dot(n).powi(2) + r.dot(m).powi(2);
    between.norm_squared() + MESH_WEIGHT * mesh
}

/// The cheapest monotone path. It may begin and end a little
/// way from the corners. Where one side stands still, the ruling's cost counts
/// once, where both go on, twice: every path has the same number of counts.
fn shortest(costs: &[Vec<f64>]) -> Vec<[usize; 2]> {
    let (rows, columns) = (costs.len(), costs[0].len());
    let free = (MOST_UNREACHED * STATIONS as f64) as usize;
    let mut best = vec![vec![f64::INFINITY; columns]; rows];
    let mut from = vec![vec![[usize::MAX; 2]; columns]; rows];
    for i in 0..rows {
        for j in 0..columns {
            if i.min(j) == 0 && i.max(j) <= free {
                best[i][j] = UNREACHED * i.max(j) as f64;
            }
            let mut offer = |p: usize, q: usize, steps: f64| {
                let mean = 0.5 * (costs[p][q] + costs[i][j]);
                let total = best[p][q] + steps * mean;
                if total < best[i][j] {
                    best[i][j] = total;
                    from[i][j] = [p, q];
                }
            };
            if i > 0 && j > 0 {
                offer(i - 1, j - 1, 2.0);
            }
            if i > 0 {
                offer(i - 1, j, 1.0);
            }
            if j > 0 {
                offer(i, j - 1, 1.0);
            }
        }
    }
    let left = |i: usize, j: usize| (rows - 1 - i).max(columns - 1 - j);
    let ends = (0..rows)
        .map(|i| [i, columns - 1])
        .chain((0..columns).map(|j| [rows - 1, j]))
        .filter(|[i, j]| left(*i, *j) <= free);
    let cost = |[i, j]: &[usize; 2]| best[*i][*j] + UNREACHED * left(*i, *j) as f64;
    let last = ends
        .min_by(|a, b| cost(a).total_cmp(&cost(b)))
        .unwrap_or([rows - 1, columns - 1]);
    let mut path = vec![last];
    let mut at = from[last[0]][last[1]];
    while at[0] != usize::MAX {
        path.push(at);
        at = from[at[0]][at[1]];
    }
    path.reverse();
    path
}

/// Rulings at equal progress i + j along a path, its steps smoothed. Averaging
/// the lead j − i keeps it monotone: its slope stays within ±1.
fn spread(path: &[[usize; 2]]) -> Vec<[f64; 2]> {
    let progress: Vec<f64> = path.iter().map(|[i, j]| (i + j) as f64).collect();
    let lead = |at: f64| {
        let k = progress
            .partition_point(|p| *p <= at)
            .clamp(1, path.len().max(2) - 1);
        let (a, b) = (path[k - 1], path[k.min(path.len() - 1)]);
        let of = |[i, j]: [usize; 2]| j as f64 - i as f64;
        let span = progress[k.min(path.len() - 1)] - progress[k - 1];
        let share = if span > 0.0 {
            (at - progress[k - 1]) / span
        } else {
            0.0
        };
        of(a) + share.clamp(0.0, 1.0) * (of(b) - of(a))
    };
    let (first, last) = (progress[0], progress[progress.len() - 1]);
    let step = (last - first) / (RULINGS - 1) as f64;
    let mean = |at: f64| {
        let reach = (1.5 * step).min(at - first).min(last - at);
        let samples = 8;
        let sum: f64 = (0..=2 * samples)
            .map(|k| lead(at + reach * (f64::from(k) / f64::from(samples) - 1.0)))
            .sum();
        sum / f64::from(2 * samples + 1)
    };
    let mut before = [0.0_f64; 2];
    let ruling = |k: usize| {
        let at = first + step * k as f64;
        let q = mean(at.min(last));
        let here = [0.5 * (at - q), 0.5 * (at + q)];
        before = [0, 1].map(|e| here[e].max(before[e]).min(STATIONS as f64));
        before
    };
    (0..RULINGS).map(ruling).collect()
}
