//! What can be said about a surface and its net, by itself and against the
//! start.

use super::bend::Bend;
use super::lines::edge::{Edge, edges};
use super::surface::Surface;
use super::target::Target;
use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

/// A value and where it stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct At {
    /// The value.
    pub value: f64,
    /// The place in space.
    pub point: Point3<f64>,
    /// Row and column, fractions between vertices: the parameters in patches.
    pub place: [f64; 2],
}

/// How far the borders are from lines of curvature.
#[derive(Debug, Clone, PartialEq)]
pub struct BorderFigures {
    /// Mean of |torsion·length| over [`PLACES`] of every border, radians.
    pub mean_torsion: f64,
    /// The largest.
    pub max_torsion: At,
    /// Largest deviation of the lines from a right angle at a vertex, radians.
    pub max_skew: At,
    /// Angle between a border and the nearest line of curvature, radians, mean
    /// and largest, where the two curvatures differ enough to have any.
    pub mean_off_principal: f64,
    /// The largest.
    pub max_off_principal: At,
    /// Largest angle between the normals of two patches along their border,
    /// radians.
    pub max_normal_jump: f64,
    /// The largest |torsion·length| of each border, those along u first, in
    /// the order of [`super::net::Layout::edges`].
    pub torsions: Vec<f64>,
}

/// Where the two principal curvatures come near each other.
#[derive(Debug, Clone, PartialEq)]
pub struct UmbilicFigures {
    /// Least |κ₁ − κ₂|, relative to its mean over the net, and where.
    pub least_difference: At,
    /// Mean |κ₁ − κ₂|, 1/length.
    pub mean_difference: f64,
    /// Patches that have an umbilic: the line that is bent more changes within
    /// them, or the least difference is below [`UMBILIC`]. A flat patch has
    /// none: in a plane every direction is one of curvature.
    pub patches: Vec<[usize; 2]>,
    /// How many patches are flat.
    pub flat: usize,
    /// Curvatures along u and v at every vertex, 1/length.
    pub curvatures: Vec<[f64; 2]>,
}

/// How far the net went from the start.
#[derive(Debug, Clone, PartialEq)]
pub struct ShapeFigures {
    /// Mean way of a vertex, in mean edges of the result.
    pub mean_move: f64,
    /// The largest.
    pub max_move: At,
    /// Mean turn of a normal, degrees.
    pub mean_turn_deg: f64,
    /// The largest.
    pub max_turn_deg: At,
    /// The way of every vertex, in mean edges of the result.
    pub moves: Vec<f64>,
    /// The turn of every normal, degrees.
    pub turns_deg: Vec<f64>,
}

/// How far the points of a net were smoothed before it was laid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Smoothed {
    /// Mean way of a vertex, a length.
    pub mean: f64,
    /// The largest.
    pub max: At,
}

/// How far the vertices are from a target.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TargetFigures {
    /// Mean distance, a length.
    pub mean_distance: f64,
    /// The largest.
    pub max_distance: At,
}

/// Shares of a border where its torsion is looked at: other places than those
/// of the fit, but for the ends.
pub const PLACES: [f64; 10] = [
    0.0, 0.0625, 0.1875, 0.3125, 0.4375, 0.5625, 0.6875, 0.8125, 0.9375, 1.0,
];
/// Differences of the curvatures below this share of their mean are umbilics.
pub const UMBILIC: f64 = 1e-3;
/// Curvatures that bend an edge of the net by less than this, radians, are none.
const FLAT: f64 = 3e-5;
/// A line of curvature is looked for where the curvatures differ by this share
/// of their mean difference at least.
const DEFINED: f64 = 0.05;

fn at(value: f64, surface: &Surface, patch: [usize; 2], share: [f64; 2]) -> At {
    At {
        value,
        point: surface.jet(patch, share).point,
        place: [0, 1].map(|d| patch[d] as f64 + share[d]),
    }
}

fn at_vertex(value: f64, surface: &Surface, vertex: usize) -> At {
    let columns = surface.layout().columns;
    At {
        value,
        point: Point3::from(surface.vertices()[vertex].point),
        place: [(vertex / columns) as f64, (vertex % columns) as f64],
    }
}

/// Index of the largest value; the first of equals.
fn top(values: impl Iterator<Item = f64>) -> (usize, f64) {
    values.enumerate().fold(
        (0, 0.0),
        |best, (k, value)| {
            if value > best.1 { (k, value) } else { best }
        },
    )
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// The patch and shares of a place on a border.
fn on_patch(surface: &Surface, edge: &Edge, t: f64) -> ([usize; 2], [f64; 2]) {
    let layout = surface.layout();
    let mut patch = [edge.ends[0] / layout.columns, edge.ends[0] % layout.columns];
    let mut share = [0.0, 0.0];
    share[edge.direction] = t;
    let across = 1 - edge.direction;
    if patch[across] == layout.patch_counts()[across] {
        patch[across] -= 1;
        share[across] = 1.0;
    }
    (patch, share)
}

/// |torsion·length| at [`PLACES`] of every border.
fn torsions(surface: &Surface, edges: &[Edge]) -> Vec<[f64; PLACES.len()]> {
    let x = surface.unknowns();
    let looks = edges
        .par_iter()
        .map(|edge| PLACES.map(|t| edge.jet(&x, t).torsion().value.abs()));
    looks.collect()
}

impl BorderFigures {
    /// Mean and largest |torsion·length| of a surface.
    pub(super) fn torsion(surface: &Surface) -> [f64; 2] {
        let looks = torsions(surface, &edges(surface));
        let all = looks.as_flattened();
        [mean(all), top(all.iter().copied()).1]
    }

    /// Of a surface.
    #[must_use]
    pub fn of(surface: &Surface, mean_difference: f64) -> BorderFigures {
        let edges = edges(surface);
        let looks = torsions(surface, &edges);
        let all = looks.as_flattened();
        let (worst, value) = top(all.iter().copied());
        let place =
            |k: usize| on_patch(surface, &edges[k / PLACES.len()], PLACES[k % PLACES.len()]);
        let (patch, share) = place(worst);
        let skews = surface.vertices().iter().map(|k| {
            (k.du.dot(&k.dv) / (k.du.norm() * k.dv.norm()))
                .clamp(-1.0, 1.0)
                .asin()
                .abs()
        });
        let (skew_vertex, skew) = top(skews);
        let defined = DEFINED * mean_difference;
        let off: Vec<Option<f64>> = (0..all.len())
            .into_par_iter()
            .map(|k| {
                let (patch, share) = place(k);
                let bend = Bend::of(&surface.jet(patch, share))?;
                (bend.difference() > defined).then(|| bend.off_principal())
            })
            .collect();
        let (worst_off, off_value) = top(off.iter().map(|o| o.unwrap_or(0.0)));
        let off_place = place(worst_off);
        let told: Vec<f64> = off.into_iter().flatten().collect();
        BorderFigures {
            mean_torsion: mean(all),
            max_torsion: at(value, surface, patch, share),
            max_skew: at_vertex(skew, surface, skew_vertex),
            mean_off_principal: mean(&told),
            max_off_principal: at(off_value, surface, off_place.0, off_place.1),
            max_normal_jump: edges
                .iter()
                .map(|e| normal_jump(surface, e))
                .fold(0.0, f64::max),
            torsions: looks
                .iter()
                .map(|l| l.iter().copied().fold(0.0, f64::max))
                .collect(),
        }
    }
}

/// The angle between the normals of the patches on both sides of a border, in
/// its middle.
fn normal_jump(surface: &Surface, edge: &Edge) -> f64 {
    let layout = surface.layout();
    let (patch, share) = on_patch(surface, edge, 0.5);
    let across = 1 - edge.direction;
    let count = layout.patch_counts()[across];
    let before = match patch[across].checked_sub(1) {
        _ if share[across] > 0.0 => return 0.0,
        Some(before) => before,
        None if layout.closed[across] => count - 1,
        None => return 0.0,
    };
    let (mut other, mut at) = (patch, share);
    other[across] = before;
    at[across] = 1.0;
    let normals = [surface.jet(patch, share), surface.jet(other, at)].map(|jet| jet.normal());
    match normals {
        [Some(a), Some(b)] => angle(&a, &b),
        _ => f64::NAN,
    }
}

/// Between two unit vectors, right down to rounding.
fn angle(a: &Vector3<f64>, b: &Vector3<f64>) -> f64 {
    a.cross(b).norm().atan2(a.dot(b))
}

/// Places of a patch in each direction where its curvatures are compared.
const LOOKS: usize = 4;

impl UmbilicFigures {
    /// Of a surface.
    #[must_use]
    pub fn of(surface: &Surface) -> UmbilicFigures {
        let patches: Vec<[usize; 2]> = surface.layout().patches().map(|(i, j)| [i, j]).collect();
        let looks: Vec<Vec<([f64; 2], Bend)>> = patches
            .par_iter()
            .map(|patch| looks(surface, *patch))
            .collect();
        let differences = || looks.iter().flatten().map(|(_, b)| b.difference());
        let count = differences().count().max(1) as f64;
        let mean_difference = differences().sum::<f64>() / count;
        let scale = mean_difference.max(f64::MIN_POSITIVE);
        let flattest = FLAT / surface.net().mean_edge();
        let is_flat = |looks: &[([f64; 2], Bend)]| {
            let most = looks.iter().map(|(_, b)| b.along.abs().max(b.across.abs()));
            most.fold(0.0, f64::max) <= flattest
        };
        let has_umbilic = |looks: &[([f64; 2], Bend)]| {
            let leads = |sign: f64| looks.iter().any(|(_, b)| sign * (b.along - b.across) > 0.0);
            let least = looks
                .iter()
                .map(|(_, b)| b.difference())
                .fold(f64::INFINITY, f64::min);
            (leads(1.0) && leads(-1.0)) || least < UMBILIC * scale
        };
        let bent = patches.iter().zip(&looks).filter(|(_, l)| !is_flat(l));
        let found = bent.filter(|(_, l)| has_umbilic(l));
        let nearest = patches
            .iter()
            .zip(&looks)
            .flat_map(|(p, l)| l.iter().map(move |l| (p, l)));
        let nearest = nearest.min_by(|a, b| a.1.1.difference().total_cmp(&b.1.1.difference()));
        let least_difference = match nearest {
            Some((patch, (share, bend))) => at(bend.difference() / scale, surface, *patch, *share),
            None => at(0.0, surface, [0, 0], [0.0, 0.0]),
        };
        UmbilicFigures {
            least_difference,
            mean_difference,
            patches: found.map(|(patch, _)| *patch).collect(),
            flat: looks.iter().filter(|l| is_flat(l)).count(),
            curvatures: (0..surface.vertices().len())
                .map(|v| curvatures(surface, v))
                .collect(),
        }
    }
}

fn looks(surface: &Surface, patch: [usize; 2]) -> Vec<([f64; 2], Bend)> {
    let share = |k: usize| (k as f64 + 0.5) / LOOKS as f64;
    let shares = (0..LOOKS * LOOKS).map(|k| [share(k / LOOKS), share(k % LOOKS)]);
    let bends = shares.map(|s| Some((s, Bend::of(&surface.jet(patch, s))?)));
    bends.flatten().collect()
}

/// Curvatures along both lines at a vertex, means of the patches around it.
fn curvatures(surface: &Surface, vertex: usize) -> [f64; 2] {
    let layout = surface.layout();
    let place = [vertex / layout.columns, vertex % layout.columns];
    let counts = layout.patch_counts();
    let sides = [0, 1].map(|d| {
        let before = match place[d].checked_sub(1) {
            Some(before) => Some((before, 1.0)),
            None => layout.closed[d].then(|| (counts[d] - 1, 1.0)),
        };
        let after = (place[d] < counts[d]).then_some((place[d], 0.0));
        [before, after].into_iter().flatten().collect::<Vec<_>>()
    });
    let (mut sum, mut count) = ([0.0; 2], 0.0_f64);
    for (i, s) in &sides[0] {
        for (j, t) in &sides[1] {
            if let Some(bend) = Bend::of(&surface.jet([*i, *j], [*s, *t])) {
                sum[0] += bend.along;
                sum[1] += bend.across;
                count += 1.0;
            }
        }
    }
    sum.map(|s| s / count.max(1.0))
}

impl ShapeFigures {
    /// Of a surface against the start, which is split like it.
    #[must_use]
    pub fn of(surface: &Surface, start: &Surface) -> ShapeFigures {
        let edge = surface.net().mean_edge();
        let pairs = || surface.vertices().iter().zip(start.vertices());
        let moves: Vec<f64> = pairs()
            .map(|(a, b)| (a.point - b.point).norm() / edge)
            .collect();
        let normal =
            |v: &super::surface::Vertex| v.du.cross(&v.dv).try_normalize(0.0).unwrap_or_default();
        let turns: Vec<f64> = pairs()
            .map(|(a, b)| angle(&normal(a), &normal(b)).to_degrees())
            .collect();
        let (moved, way) = top(moves.iter().copied());
        let (turned, turn) = top(turns.iter().copied());
        ShapeFigures {
            mean_move: mean(&moves),
            max_move: at_vertex(way, surface, moved),
            mean_turn_deg: mean(&turns),
            max_turn_deg: at_vertex(turn, surface, turned),
            moves,
            turns_deg: turns,
        }
    }
}

impl Smoothed {
    /// Of the start after and before.
    pub(super) fn of(held: &Surface, start: &Surface) -> Smoothed {
        let pairs = held.vertices().iter().zip(start.vertices());
        let ways: Vec<f64> = pairs.map(|(a, b)| (a.point - b.point).norm()).collect();
        let (furthest, way) = top(ways.iter().copied());
        Smoothed {
            mean: mean(&ways),
            max: at_vertex(way, start, furthest),
        }
    }
}

impl TargetFigures {
    /// Of a surface.
    pub(super) fn of(surface: &Surface, target: &Target) -> TargetFigures {
        let distances: Vec<f64> = surface
            .vertices()
            .par_iter()
            .map(|k| (target.foot(&Point3::from(k.point)).point.coords - k.point).norm())
            .collect();
        let (furthest, distance) = top(distances.iter().copied());
        TargetFigures {
            mean_distance: mean(&distances),
            max_distance: at_vertex(distance, surface, furthest),
        }
    }
}
