//! The points that decide: of many within their tolerances few hold the curve.
//!
//! In a stretch much shorter than the curve's waves all points see the curve
//! move alike, so that those whose bounds reach in furthest, to either side,
//! stop it before the others do. The programme begins with these; points that
//! its solution overruns join, until there are none. The end is that of all
//! points: with the bounds of the others added nothing changes.

use super::space::{Space, Vector};
use super::springs::{Springs, across};
use super::within::Fairest;
use crate::solver::Stop;

/// Up to so many points all are members from the start.
const FEW: usize = 400;
/// Stretches a span.
const STRETCHES: usize = 2;
/// Members of a stretch for each side.
const EACH: usize = 2;
/// Rounds of points that join; each takes in all that were overrun.
const JOININGS: usize = 12;
/// Largest move of a foot when the others are looked at, share of the domain.
const REACH: f64 = 0.02;

/// A programme for some points: it moves the coefficients, and the feet of
/// the springs that it is given, with their tolerances.
pub(super) trait Programme<const D: usize> {
    /// Whether a new round begins where the last one ended, or, as it must
    /// begin within all bounds, where the first one did.
    const GOES_ON: bool;

    /// Solves it.
    fn solve(
        &self,
        springs: &mut Springs<D>,
        tolerances: &[f64],
        x: &mut Vec<Vector<D>>,
    ) -> Result<Fairest, Stop>;
}

/// Solves a programme for all points by way of its members.
///
/// # Errors
/// When the control says stop.
pub(super) fn solve<const D: usize, P: Programme<D>>(
    programme: &P,
    space: &Space,
    (springs, tolerances): (&mut Springs<D>, &[f64]),
    x: &mut Vec<Vector<D>>,
) -> Result<Fairest, Stop> {
    if tolerances.iter().filter(|t| t.is_finite()).count() <= FEW {
        return programme.solve(springs, tolerances, x);
    }
    let mut members = first_members(space, (springs, tolerances), x);
    let first = x.clone();
    for _ in 0..JOININGS {
        let chosen: Vec<usize> = (0..members.len()).filter(|i| members[*i]).collect();
        if 2 * chosen.len() > members.len() {
            break;
        }
        let mut few = springs.some(&chosen);
        let bounds: Vec<f64> = chosen.iter().map(|i| tolerances[*i]).collect();
        let mut found = programme.solve(&mut few, &bounds, x)?;
        let mut all = springs.clone();
        for (i, u) in chosen.iter().zip(&few.feet) {
            all.feet[*i] = *u;
        }
        let [a, b] = space.domain();
        all.refresh(space, x, REACH * (b - a));
        // Too little room for some is too little for all.
        let hopeless = found.slack > 0.0;
        if hopeless || join(space, (&all, tolerances), x, &mut members) == 0 {
            let mut duals = vec![0.0; members.len()];
            for (i, z) in chosen.iter().zip(&found.duals) {
                duals[*i] = *z;
            }
            found.duals = duals;
            *springs = all;
            return Ok(found);
        }
        if P::GOES_ON {
            *springs = all;
        } else {
            x.clone_from(&first);
        }
    }
    programme.solve(springs, tolerances, x)
}

/// Directions in which bounds reach in: the normals of the plane; in space
/// those of an octahedron.
fn directions<const D: usize>() -> Vec<Vector<D>> {
    // Offsets of the plane have their one component first.
    let axes = if D == 2 { 1 } else { D };
    let axis = |k: usize, sign: f64| {
        let mut v = Vector::zeros();
        v[k] = sign;
        v
    };
    (0..axes)
        .flat_map(|k| [axis(k, 1.0), axis(k, -1.0)])
        .collect()
}

/// For each stretch and direction the points whose bounds reach in furthest.
fn first_members<const D: usize>(
    space: &Space,
    (springs, tolerances): (&Springs<D>, &[f64]),
    x: &[Vector<D>],
) -> Vec<bool> {
    let [a, b] = space.domain();
    let stretches = STRETCHES * space.spans().len();
    let directions = directions::<D>();
    let nobody = [(f64::NEG_INFINITY, usize::MAX); EACH];
    let mut best = vec![nobody; stretches * directions.len()];
    let curve = space.pieces(x);
    for (i, t) in tolerances.iter().enumerate().filter(|(_, t)| t.is_finite()) {
        let u = springs.feet[i];
        let [point, along] = curve.jet::<2>(u);
        let offset = across(&(springs.points[i] - point), &along);
        let stretch = ((u - a) / (b - a) * stretches as f64) as usize;
        let stretch = stretch.min(stretches - 1);
        for (k, direction) in directions.iter().enumerate() {
            let row = &mut best[stretch * directions.len() + k];
            let mut own = (direction.dot(&offset) - t, i);
            for slot in row.iter_mut() {
                if own.0 > slot.0 {
                    std::mem::swap(slot, &mut own);
                }
            }
        }
    }
    let mut members = vec![false; tolerances.len()];
    for (_, i) in best.iter().flatten() {
        if let Some(member) = members.get_mut(*i) {
            *member = true;
        }
    }
    members
}

/// Takes in the points beyond their tolerances; returns their number.
fn join<const D: usize>(
    space: &Space,
    (springs, tolerances): (&Springs<D>, &[f64]),
    x: &[Vector<D>],
    members: &mut [bool],
) -> usize {
    let residuals = springs.residuals(space, x);
    let mut joined = 0;
    for ((e, t), member) in residuals.iter().zip(tolerances).zip(members) {
        if !*member && e.norm() >= *t {
            *member = true;
            joined += 1;
        }
    }
    joined
}
