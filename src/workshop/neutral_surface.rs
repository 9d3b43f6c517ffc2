//! The middle of a plate, of which the pattern is cut: bending shortens one face
//! of a plate and lengthens the other, and leaves the middle as it is.
//!
//! With the unit normals `nᵢ` at the two ends of a ruling the boundaries go to
//! `Dᵢ + s nᵢ`. On a developable surface both normals are one, the ruling moves
//! parallel, and the result is the offset at distance s exactly; where the plate
//! twists it is ruled between the offsets of its boundaries.

use super::development::breaks;
use crate::geometry::{RuledSurface, RulingJet, interpolate_at};
use nalgebra::{Point3, Vector3};

/// Intervals through which the boundaries are interpolated, at least: with the
/// cube of a thousandth what is left is below rounding of a drawing, the more so
/// as only the way by half a thickness is not a spline already.
const INTERVALS: usize = 1024;
/// Normals on two sides of a knot that differ by more are those of a crease,
/// radians.
const CREASE: f64 = 1e-6;

/// The surface at the distance `shift` along the normals `Su × Sv`. `None` where
/// it has creases, at which an offset gapes or overlaps, or no normals.
pub(super) fn offset(plate: &RuledSurface, shift: f64) -> Option<RuledSurface> {
    let knots = breaks(plate);
    let per_span = INTERVALS.div_ceil(knots.len().max(2) - 1);
    let mut places = Vec::new();
    for span in knots.windows(2) {
        let step = (span[1] - span[0]) / per_span as f64;
        places.extend((0..per_span).map(|i| span[0] + step * i as f64));
    }
    places.extend(knots.last());
    if has_crease(plate, &knots)? {
        return None;
    }
    let side = |v: f64| {
        let points: Option<Vec<Point3<f64>>> = (places.iter())
            .map(|u| {
                let ruling = plate.ruling(*u);
                Some(ruling.surface(v).point + normal(&ruling, v)? * shift)
            })
            .collect();
        interpolate_at(&places, &points?, 3).ok()
    };
    RuledSurface::new(side(0.0)?, side(1.0)?).ok()
}

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

/// Whether normals jump at an inner knot.
fn has_crease(plate: &RuledSurface, knots: &[f64]) -> Option<bool> {
    let inner = knots.get(1..knots.len().max(2) - 1)?;
    for u in inner {
        for v in [0.0, 1.0] {
            let left = normal(&plate.ruling_left(*u), v)?;
            let right = normal(&plate.ruling(*u), v)?;
            if left.cross(&right).norm().atan2(left.dot(&right)) > CREASE {
                return Some(true);
            }
        }
    }
    Some(false)
}
