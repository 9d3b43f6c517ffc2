//! The greedy first rulings (sec. 2.2).
//!
//! Both curves are sampled evenly, a little past their ends (straight on).
//! The first ruling joins an end of one curve with the sample near the other
//! curve's end that has the least twist (eq. 3); every next ruling is the one
//! of least twist among the samples just ahead.
//!
//! What the paper leaves open: the numbers of samples and candidates; and what
//! happens when one curve is used up before the other. Here a candidate must
//! leave enough of both curves that the last ruling still reaches both ends:
//! without that rule rulings pile up at one end and the interpolation of their
//! ends breaks down.
//!
//! Limits: greedy, so it follows the first valley of the twist that it meets.

use super::super::profile::Profile;
use super::super::twist::twist_angle;
use nalgebra::{Point3, Vector3};

/// Samples of a curve between its own ends. With [`AHEAD`] it makes about 30
/// rulings, so that D₁ and D₂ have 25 to 40 control points, enough for the
/// lower chine of the trawler.
const SAMPLES: usize = 120;
/// Candidates of the next ruling on each curve, in samples ahead.
const AHEAD: std::ops::RangeInclusive<usize> = 2..=6;
/// Candidates of the first ruling: this share of the other curve.
const FIRST_SHARE: f64 = 0.15;
/// A ruling shorter than this (unit scale) has no direction to rely on: a tip.
const TIP: f64 = 1e-3;
/// Weight of uneven progress (difference of fractions, squared) against the
/// squared twist: it only decides among candidates without twist.
const EVEN: f64 = 1e-4;

/// Ends of a ruling as arc-length fractions; outside [0, 1] on an extension.
pub(super) type Ruling = (f64, f64);

/// Point and derivative by fraction, straight on beyond the ends.
pub(super) fn extended(profile: &Profile, s: f64) -> (Point3<f64>, Vector3<f64>) {
    let jet = profile.at(s);
    (jet.point + jet.d1 * (s - s.clamp(0.0, 1.0)), jet.d1)
}

/// Samples of one curve; index 0 is the end of the start's extension.
struct Samples {
    fractions: Vec<f64>,
    rails: Vec<(Point3<f64>, Vector3<f64>)>,
    /// Index from which the curve's own end is reached.
    end: usize,
}

impl Samples {
    fn new(profile: &Profile, before: f64, after: f64) -> Self {
        let step = 1.0 / SAMPLES as f64;
        let (low, high) = (
            (before / step).round() as i64,
            (after / step).round() as i64,
        );
        let fractions: Vec<f64> = (-low..=SAMPLES as i64 + high)
            .map(|i| i as f64 * step)
            .collect();
        let rails = fractions.iter().map(|s| extended(profile, *s)).collect();
        Samples {
            fractions,
            rails,
            end: SAMPLES + low as usize,
        }
    }

    fn last(&self) -> usize {
        self.fractions.len() - 1
    }
}

/// A sequence of rulings from one end to the other, both fractions increasing;
/// at least two. `extension` is the share of a curve's length that it may be
/// extended by.
pub(super) fn first_rulings([a, b]: [&Profile; 2], extension: f64) -> Vec<Ruling> {
    // Beyond a tip the rulings would cross.
    let room = |s: f64| {
        if (a.at(s).point - b.at(s).point).norm() < TIP {
            0.0
        } else {
            extension
        }
    };
    let (before, after) = (room(0.0), room(1.0));
    let grid = [
        Samples::new(a, before, after),
        Samples::new(b, before, after),
    ];
    let mut rulings = vec![first(&grid)];
    while let Some(next) = next(&grid, rulings[rulings.len() - 1]) {
        rulings.push(next);
    }
    let fractions = |(i, j): &(usize, usize)| (grid[0].fractions[*i], grid[1].fractions[*j]);
    rulings.iter().map(fractions).collect()
}

/// θ² and what speaks for even progress; lower is better.
fn cost(grid: &[Samples; 2], (i, j): (usize, usize)) -> f64 {
    let ((p, t1), (q, t2)) = (grid[0].rails[i], grid[1].rails[j]);
    let l = q - p;
    let twist = if l.norm() < TIP {
        0.0
    } else {
        twist_angle(&l, &t1, &t2)
    };
    let uneven = grid[0].fractions[i] - grid[1].fractions[j];
    twist * twist + EVEN * uneven * uneven
}

fn best(
    grid: &[Samples; 2],
    candidates: impl Iterator<Item = (usize, usize)>,
) -> Option<(usize, usize)> {
    candidates
        .map(|c| (cost(grid, c), c))
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, c)| c)
}

/// An end of one (extended) curve with the best sample near the other's end.
fn first(grid: &[Samples; 2]) -> (usize, usize) {
    let near = (FIRST_SHARE * SAMPLES as f64) as usize;
    let candidates = (0..=near).flat_map(|k| [(0, k), (k, 0)]);
    best(grid, candidates.filter(|c| reaches(grid, *c))).unwrap_or((0, 0))
}

fn next(grid: &[Samples; 2], (i, j): (usize, usize)) -> Option<(usize, usize)> {
    if i >= grid[0].end && j >= grid[1].end {
        return None;
    }
    let (room_i, room_j) = (grid[0].last() - i, grid[1].last() - j);
    let ahead = |room: usize| AHEAD.filter(move |k| *k <= room);
    let all = ahead(room_i).flat_map(|k| ahead(room_j).map(move |m| (i + k, j + m)));
    best(grid, all.filter(|c| reaches(grid, *c))).or_else(|| {
        // Less than the smallest step is left of a curve.
        (room_i > 0 && room_j > 0).then(|| (grid[0].last(), grid[1].last()))
    })
}

/// Whether both curves' ends can still be reached with steps of [`AHEAD`].
fn reaches(grid: &[Samples; 2], (i, j): (usize, usize)) -> bool {
    let ratio = AHEAD.end() / AHEAD.start();
    let missing = |k: usize, at: usize| grid[k].end.saturating_sub(at);
    let room = |k: usize, at: usize| grid[k].last() - at;
    missing(0, i) <= ratio * room(1, j) && missing(1, j) <= ratio * room(0, i)
}
