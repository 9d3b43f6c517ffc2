//! The exact cones of the regions and their rigid motions into one smooth
//! spline (sec. 2.3).
//!
//! A region's cone is cut at the rulings nearest to those of its joints. The
//! motions (bring a point together, turn the rulings together, turn the
//! normals together) are those by which [`Chain::link`] links patches. The
//! paper goes from the first cone to the last, each carrying all errors before
//! it; here the middle one stays, which halves them.

use super::super::chain::{Chain, Part};
use super::cone::Cone;
use super::ruled::Ruled;
use crate::geometry::cone::{Frame, Strain};
use nalgebra::{Point3, Vector3, center};

/// Steps by which a region's rulings are followed around the axis.
const STEPS: usize = 64;

/// The cones as a chain; `None` where a region does not turn about its axis,
/// or lies on it.
pub(super) fn stitched(surface: &Ruled, cones: &[Cone], breaks: &[f64]) -> Option<Chain> {
    let regions = breaks.windows(2).zip(cones);
    let parts: Option<Vec<Part>> = regions
        .map(|(w, c)| part(surface, c, [w[0], w[1]]))
        .collect();
    Some(Chain::link(&parts?))
}

/// The part of a cone between two rulings of the surface.
fn part(surface: &Ruled, cone: &Cone, [from, to]: [f64; 2]) -> Option<Part> {
    let axis = cone.along.try_normalize(0.0)?;
    // (θ, d) and (−θ, −d) are one cone.
    let (angle, distance) = (cone.angle * cone.distance.signum(), cone.distance.abs());
    let middle = |u: f64| {
        let [a, b] = surface.ruling(u);
        center(&a, &b)
    };
    let out = |u: f64| {
        let way: Vector3<f64> = middle(u) - cone.point;
        (way - axis * way.dot(&axis)).try_normalize(0.0)
    };
    let at = |i: usize| from + (to - from) * i as f64 / STEPS as f64;
    let first = out(from)?;
    let (mut last, mut turn) = (first, 0.0);
    for i in 1..=STEPS {
        let next = out(at(i))?;
        turn += last.cross(&next).dot(&axis).atan2(last.dot(&next));
        last = next;
    }
    // +1 where the strip runs right-handed about V.
    let side = 1.0_f64.copysign(turn);
    let (sin, cos) = angle.sin_cos();
    let outwards = |e: &Vector3<f64>| sin * axis + cos * e;
    let ruling = |e: &Vector3<f64>| sin * e - cos * axis;
    let on = |e: &Vector3<f64>| cone.point + distance * outwards(e);
    let frame = Frame::new(on(&first), ruling(&first), side * outwards(&first))?;
    // Around the axis at the radius d cos θ with the normal curvature 1/d.
    let strain = Strain {
        g: sin / (distance * cos),
        k: -side / distance,
    };
    let along = |e: &Vector3<f64>, point: Point3<f64>| (point - on(e)).dot(&ruling(e));
    let shared = [along(&first, middle(from)), along(&last, middle(to))];
    let part = Part {
        frame,
        strain,
        arc: [0.0, turn.abs() * distance * cos],
        base: 0.5 * (shared[0] + shared[1]),
        shared,
    };
    let sound = part.arc[1] > 0.0 && cos > 0.0 && strain.speed(part.base) > 0.0;
    sound.then_some(part)
}
