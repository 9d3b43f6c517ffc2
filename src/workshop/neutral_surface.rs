//! The middle of a plate, of which the pattern is cut: bending shortens one face
//! of a plate and lengthens the other, and leaves the middle as it is.
//!
//! With the unit normals `nᵢ` at the two ends of a ruling the boundaries go to
//! `Dᵢ + s nᵢ`. On a developable surface both normals are one, the ruling moves
//! parallel, and the result is the offset at distance s exactly; where the plate
//! twists it is ruled between the offsets of its boundaries.
//!
//! Where a fan meets a part that twists, the normals jump by some degrees. Steel
//! bends there as everywhere: the jump is spread evenly over a little of the
//! plate on either side, so that the middle is as much longer or shorter as the
//! whole bend makes it.

use super::development::breaks;
use crate::geometry::{RuledSurface, RulingJet, interpolate_at};
use nalgebra::{Point3, Vector3};

/// Intervals through which the boundaries are interpolated, at least: with the
/// cube of a thousandth what is left is below rounding of a drawing, the more so
/// as only the way by half a thickness is not a spline already.
const INTERVALS: usize = 1024;
/// Normals on two sides of a knot that differ by more are those of a knuckle,
/// radians: that is no bend but a joint.
const KNUCKLE: f64 = 0.25;
/// Over so much of the plate on either side a jump is spread.
const SPREAD: f64 = 0.02;

/// The surface at the distance `shift` along the normals `Su × Sv`. `None` where
/// it has knuckles, at which an offset gapes or overlaps, or no normals.
pub(super) fn offset(plate: &RuledSurface, shift: f64) -> Option<RuledSurface> {
    let knots = breaks(plate);
    let per_span = INTERVALS.div_ceil(knots.len().max(2) - 1);
    let mut places = Vec::new();
    for span in knots.windows(2) {
        let step = (span[1] - span[0]) / per_span as f64;
        places.extend((0..per_span).map(|i| span[0] + step * i as f64));
    }
    places.extend(knots.last());
    let side = |end: usize| {
        let jumps = jumps(plate, &knots, end)?;
        let points: Option<Vec<Point3<f64>>> = (places.iter())
            .map(|u| {
                let ruling = plate.ruling(*u);
                let spread: Vector3<f64> = jumps.iter().map(|j| j.correction(*u)).sum();
                let normal = normal(&ruling, END[end])? + spread;
                Some(ruling.surface(END[end]).point + normal.try_normalize(0.0)? * shift)
            })
            .collect();
        interpolate_at(&places, &points?, 3).ok()
    };
    RuledSurface::new(side(0)?, side(1)?).ok()
}

/// v at the ends of a ruling.
const END: [f64; 2] = [0.0, 1.0];

fn normal(ruling: &RulingJet, v: f64) -> Option<Vector3<f64>> {
    let at = |v: f64| {
        let jet = ruling.surface(v);
        jet.du.cross(&jet.dv)
    };
    // At the tip of a fan one end of the ruling stands still: the other has the
    // normal of all of it.
    let own = at(v).try_normalize(0.0);
    own.or_else(|| at(1.0 - v).try_normalize(0.0))
}

/// A place at which the normals jump.
struct Jump {
    at: f64,
    /// From the normals before and behind to the one between them.
    corrections: [Vector3<f64>; 2],
    /// How far before and behind they are felt.
    reach: [f64; 2],
}

impl Jump {
    /// What is added to the normal at u.
    fn correction(&self, u: f64) -> Vector3<f64> {
        let side = usize::from(u >= self.at);
        let share = 1.0 - (u - self.at).abs() / self.reach[side];
        self.corrections[side] * share.max(0.0)
    }
}

/// The jumps along one boundary; `None` where one is a knuckle.
fn jumps(plate: &RuledSurface, knots: &[f64], end: usize) -> Option<Vec<Jump>> {
    let spread = SPREAD * (knots.last()? - knots.first()?);
    let mut jumps = Vec::new();
    for around in knots.windows(3) {
        let at = around[1];
        let before = normal(&plate.ruling_left(at), END[end])?;
        let behind = normal(&plate.ruling(at), END[end])?;
        if before.cross(&behind).norm().atan2(before.dot(&behind)) > KNUCKLE {
            return None;
        }
        let between = (before + behind).try_normalize(0.0)?;
        jumps.push(Jump {
            at,
            corrections: [between - before, between - behind],
            reach: [spread.min(at - around[0]), spread.min(around[2] - at)],
        });
    }
    Some(jumps)
}
