//! The four corners of a strip.

use super::outline::Outline;
use super::{at, issue};
use crate::geometry::Manifold;
use crate::methods::Issue;
use nalgebra::Point3;

/// The corners of an outline, in its direction.
#[derive(Debug)]
pub(super) struct Corners {
    /// Indices in the outline.
    pub(super) corners: [usize; 4],
    pub(super) warnings: Vec<String>,
}

/// Why there are none.
#[derive(Debug)]
pub(super) struct NoCorners {
    found: usize,
    nearby: Option<Point3<f64>>,
}

/// A place where the outline turns.
#[derive(Debug, Clone, Copy)]
struct Candidate {
    index: usize,
    turn: f64,
}

/// Four candidates and how good a strip they make.
#[derive(Debug)]
struct Chosen {
    corners: [usize; 4],
    merit: f64,
}

/// Over so much of the strip's mean width a turn is seen: noise of a tenth of
/// it is no turn yet, and an end a third as wide still has two corners.
const REACH: f64 = 0.3;
/// Corners nearer than so many reaches are one.
const APART: f64 = 0.8;
/// The least turn that may be a corner, radians: 30°.
const LEAST_TURN: f64 = 0.52;
/// A turn above which a strip runs out in a point, radians: 115°.
const POINTED: f64 = 2.0;
/// A turn above which a fifth corner is worth a word, radians: 50°.
const REMARKABLE: f64 = 0.87;
/// The sharpest of so many are looked at.
const MOST: usize = 14;
/// More than so many remarkable corners outside the four: not a strip.
const MOST_SPARE: usize = 3;

impl NoCorners {
    pub(super) fn issue(&self, place: &str) -> Issue {
        let near = self
            .nearby
            .map_or(String::new(), |p| format!(", one near {}", at(&p)));
        let message = match self.found {
            0 => "this is not a strip: its outline turns nowhere as a corner does".to_owned(),
            1 => format!("this is not a strip: its outline has only one corner{near}"),
            n => format!("this is not a strip: its outline has {n} corners{near}"),
        };
        let hint = "a strip has four corners, or runs out in a point; cut the plate so";
        issue(place, "not-a-strip", message, Some(hint))
    }
}

/// Finds the corners.
///
/// # Errors
/// The outline has less than two corners, or far too many.
pub(super) fn find(outline: &Outline, surface: &Manifold) -> Result<Corners, NoCorners> {
    let width = mean_width(outline, surface);
    let reach = REACH * width;
    let mut candidates = sharpest(outline, reach);
    let whole = choose(outline, &candidates, width);
    let split = split_points(outline, reach, &candidates);
    let divided = choose(outline, &split, width);
    let merit = |c: &Option<Chosen>| c.as_ref().map_or(f64::NEG_INFINITY, |c| c.merit);
    let best = if merit(&whole) >= merit(&divided) {
        whole
    } else {
        candidates = split;
        divided
    };
    let refusal = |nearby: Option<&Candidate>| NoCorners {
        found: candidates.len(),
        nearby: nearby.map(|c| outline.points[c.index]),
    };
    let best = best.ok_or_else(|| refusal(candidates.first()))?.corners;
    let spare: Vec<&Candidate> = (candidates.iter())
        .filter(|c| c.turn > REMARKABLE && !best.contains(&c.index))
        .collect();
    if spare.len() > MOST_SPARE {
        return Err(refusal(spare.first().copied()));
    }
    let warn = |c: &&Candidate| {
        format!(
            "The outline turns by {:.0}° at {}; this was taken as part of a side, not as a corner.",
            c.turn.to_degrees(),
            at(&outline.points[c.index])
        )
    };
    Ok(Corners {
        corners: best,
        warnings: spare.iter().map(warn).collect(),
    })
}

/// Of the rectangle with the same area A and outline P: `w² − P w/2 + A = 0`.
pub(super) fn mean_width(outline: &Outline, surface: &Manifold) -> f64 {
    let area: f64 = surface.mesh().vertex_areas().iter().sum();
    let half = 0.5 * outline.length();
    // Noise and round ends make the outline longer or shorter than a
    // rectangle's; a square is the limit.
    let root = (half * half - 4.0 * area).max(0.0).sqrt();
    0.5 * (half - root)
}

/// The sharpest turns that are apart, in the order of the outline.
fn sharpest(outline: &Outline, reach: f64) -> Vec<Candidate> {
    let turns = outline.turns(reach);
    let mut order: Vec<usize> = (0..turns.len())
        .filter(|i| turns[*i] > LEAST_TURN)
        .collect();
    order.sort_by(|a, b| turns[*b].total_cmp(&turns[*a]).then(a.cmp(b)));
    let mut found: Vec<Candidate> = Vec::new();
    for index in order {
        let near = |c: &Candidate| {
            let d = outline.between(c.index, index);
            d.min(outline.length() - d) < APART * reach
        };
        if found.len() < MOST && !found.iter().any(near) {
            found.push(Candidate {
                index,
                turn: turns[index],
            });
        }
    }
    found.sort_by_key(|c| c.index);
    found
}

/// Where the strip runs out in a point, or in an end narrower than the reach,
/// one sharp turn becomes two corners: those of the narrow end, or the
/// neighbours of the point.
fn split_points(outline: &Outline, reach: f64, found: &[Candidate]) -> Vec<Candidate> {
    let mut candidates = found.to_vec();
    let fine = outline.turns(0.2 * reach);
    for tip in found.iter().filter(|c| c.turn > POINTED) {
        let near = |i: &usize| {
            let d = outline.between(tip.index, *i);
            d.min(outline.length() - d) < APART * reach && fine[*i] > LEAST_TURN
        };
        let mut around: Vec<usize> = (0..outline.len()).filter(near).collect();
        around.sort_by(|a, b| fine[*b].total_cmp(&fine[*a]).then(a.cmp(b)));
        let first = around.first().copied().unwrap_or(tip.index);
        let apart = |i: &&usize| {
            let d = outline.between(first, **i);
            d.min(outline.length() - d) > 0.2 * reach
        };
        let n = outline.len();
        let pair = match around.iter().find(apart) {
            Some(second) if fine[first] < POINTED => [first, *second],
            // A true point: the end is the corner with a neighbour either side.
            _ => [(first + n - 1) % n, (first + 1) % n],
        };
        candidates.retain(|c| c.index != tip.index);
        candidates.extend(pair.map(|index| Candidate {
            index,
            turn: 0.5 * tip.turn,
        }));
    }
    candidates.sort_by_key(|c| c.index);
    candidates.dedup_by_key(|c| c.index);
    candidates
}

/// The four that make the best strip: sharp corners, straight ends as long as
/// the strip is wide.
fn choose(outline: &Outline, candidates: &[Candidate], width: f64) -> Option<Chosen> {
    let mut best: Option<Chosen> = None;
    let n = candidates.len();
    for a in 0..n {
        for b in a + 1..n {
            for c in b + 1..n {
                for d in c + 1..n {
                    let four = [a, b, c, d].map(|i| candidates[i]);
                    let merit = merit(outline, four, width);
                    if best.as_ref().is_none_or(|b| merit > b.merit) {
                        let corners = four.map(|c| c.index);
                        best = Some(Chosen { corners, merit });
                    }
                }
            }
        }
    }
    best
}

fn merit(outline: &Outline, four: [Candidate; 4], width: f64) -> f64 {
    let right = std::f64::consts::FRAC_PI_2;
    let sharp: f64 = four.iter().map(|c| c.turn.min(right) / right).sum();
    let end = |i: usize, j: usize| {
        let arc = outline.between(four[i].index, four[j].index);
        let chord = (outline.points[four[i].index] - outline.points[four[j].index]).norm();
        let straight = if arc > 0.0 { chord / arc } else { 1.0 };
        2.0 * straight - 0.2 * (arc / width).max(1e-3).ln().abs()
    };
    let ends = (end(0, 1) + end(2, 3)).max(end(1, 2) + end(3, 0));
    sharp + ends
}
