//! From a path between two curves to a plate: D₁ = E₁∘s and D₂ = E₂∘t as
//! cubic B-splines in u = (s + t)/2, the mean of the arc-length fractions, with
//! the fans that reach the corners.
//!
//! A fan is the cone over the swept curve with its apex in the corner; as an
//! extension its apex lies `c` ruling lengths behind the corner, on the line
//! of the first ruling, and the standing curve runs on as the scaled copy
//! P + c/(1+c)·(E − P) of the swept one: exactly a cone, exactly a spline.

use super::FitError;
use super::cubic_fit::{Pieces, Rail, Side, fit_pair};
use super::path::PathShape;
use super::profile::Profile;
use crate::geometry::{ArcLength, BSplineCurve};
use nalgebra::Point3;

/// A boundary: the curve as it is now, and the arc-length fractions by which
/// its places are named (those of the profile before it was moved).
#[derive(Debug)]
pub(super) struct Boundary<'a> {
    pub(super) profile: &'a Profile,
    pub(super) curve: &'a BSplineCurve,
}

/// The uncovered triangle at one end of a path.
#[derive(Debug, Clone, Copy)]
pub(super) struct FanRange {
    pub(super) at_start: bool,
    pub(super) apex_on_first: bool,
    /// In u.
    pub(super) range: [f64; 2],
    /// Share of the swept curve.
    pub(super) swept: f64,
    /// Length by which the standing curve is extended, unit scale.
    pub(super) extension: f64,
}

/// A plate's two boundaries on one knot vector, unit scale.
#[derive(Debug, Clone)]
pub(super) struct Loft {
    pub(super) first: BSplineCurve,
    pub(super) second: BSplineCurve,
    pub(super) fans: Vec<FanRange>,
}

/// How the corners are reached.
#[derive(Debug, Clone, Copy)]
pub(super) enum Corners {
    Fans,
    /// Largest extension, unit scale.
    Extensions {
        longest: f64,
    },
}

/// Boundaries are met to this share of the model; a hundred times finer than
/// promised, so that what is derived from them is good to the promise.
const DISTANCE: f64 = 1e-8;
/// Tangents to this angle, radians: 1e-3 degrees of twist at most.
const ANGLE: f64 = 1e-5;
/// Fans that sweep less than this share of a curve are left out.
const SMALLEST_FAN: f64 = 1e-9;
/// Room for rounding below the longest extension.
const WITHIN: f64 = 1.0 - 1e-9;
/// An extended cone's apex is this far behind at the most, as c/(1+c).
const LARGEST_SCALE: f64 = 0.5;

impl Boundary<'_> {
    fn rail(&self, fraction: f64, speed: f64, side: Side) -> Rail {
        let parameter = self.profile.parameter_of(fraction);
        let (base, jet) = match side {
            Side::Right => (
                self.profile.curve.derivatives(parameter),
                self.curve.derivatives(parameter),
            ),
            Side::Left => (
                self.profile.curve.derivatives_left(parameter),
                self.curve.derivatives_left(parameter),
            ),
        };
        let rate = self.profile.rate(&base.d1);
        Rail {
            point: jet.point,
            d1: jet.d1 * (rate * speed),
        }
    }

    /// Fractions at which the curve has a kink, and at its simple knots.
    fn places(&self) -> (Vec<f64>, Vec<f64>) {
        let kinks = self
            .curve
            .kinks(KINK)
            .iter()
            .map(|u| self.profile.fraction_of(*u))
            .collect();
        let [a, b] = self.curve.domain();
        let inner = self
            .curve
            .knot_vector()
            .breakpoints()
            .into_iter()
            .filter(|u| *u > a && *u < b);
        (kinks, inner.map(|u| self.profile.fraction_of(u)).collect())
    }
}

/// Tangents that differ by more, radians, make a kink.
const KINK: f64 = 1e-6;

/// The plate along a path.
pub(super) fn loft(
    boundaries: [&Boundary<'_>; 2],
    shape: &PathShape,
    y: &[f64],
    corners: Corners,
) -> Result<Loft, FitError> {
    let shape = shape.clone().rounded(0.0);
    let [q0, q1] = shape.end_leads(y);
    let (u0, u1) = (0.5 * q0.abs(), 1.0 - 0.5 * q1.abs());
    let body = |u: f64| ((u - u0) / (u1 - u0)).clamp(0.0, 1.0);
    // ds/du and dt/du: dw/du times the path's own speeds.
    let rails = |u: f64, side: Side| {
        let fan = (u < u0 || (u == u0 && side == Side::Left && u0 > 0.0), q0);
        let end = (u > u1 || (u == u1 && side == Side::Right && u1 < 1.0), q1);
        let (fractions, speeds) = if fan.0 {
            swept(2.0 * u, fan.1 > 0.0, 0.0)
        } else if end.0 {
            swept(2.0 * u - 1.0, end.1 < 0.0, 1.0)
        } else {
            let p = shape.at(y, body(u));
            let rate = 1.0 / (u1 - u0);
            ([p.s, p.t], [p.ds * rate, p.dt * rate])
        };
        [0, 1].map(|k| boundaries[k].rail(fractions[k], speeds[k], side))
    };
    let (breaks, seeds) = places(boundaries, (&shape, y), [u0, u1]);
    let pieces = Pieces {
        breaks: &breaks,
        seeds: &seeds,
        distance: DISTANCE,
        angle: ANGLE,
        rails: &rails,
    };
    let [first, second] = fit_pair(&pieces)?;
    let mut fans = Vec::new();
    if q0.abs() > SMALLEST_FAN {
        fans.push(FanRange::new(true, q0 > 0.0, [0.0, u0], q0.abs()));
    }
    if q1.abs() > SMALLEST_FAN {
        fans.push(FanRange::new(false, q1 < 0.0, [u1, 1.0], q1.abs()));
    }
    let mut loft = Loft {
        first,
        second,
        fans,
    };
    match corners {
        // The standing control points are then the corner bit for bit, and
        // the derivative along them exactly zero.
        Corners::Fans => loft.cone(|_| 0.0, false)?,
        Corners::Extensions { longest } => {
            loft.cone(
                |length| (longest / length * WITHIN).min(LARGEST_SCALE),
                true,
            )?;
        }
    }
    Ok(loft)
}

impl FanRange {
    fn new(at_start: bool, apex_on_first: bool, range: [f64; 2], swept: f64) -> Self {
        FanRange {
            at_start,
            apex_on_first,
            range,
            swept,
            extension: 0.0,
        }
    }
}

/// Fractions and speeds in a fan whose swept end is at `swept`; the other end
/// stands at `standing`.
fn swept(swept: f64, apex_on_first: bool, standing: f64) -> ([f64; 2], [f64; 2]) {
    if apex_on_first {
        ([standing, swept], [0.0, 2.0])
    } else {
        ([swept, standing], [2.0, 0.0])
    }
}

/// Breaks and seeds in u: joins of fans and kinks; knots of both curves.
fn places(
    boundaries: [&Boundary<'_>; 2],
    (shape, y): (&PathShape, &[f64]),
    [u0, u1]: [f64; 2],
) -> (Vec<f64>, Vec<f64>) {
    let [q0, q1] = shape.end_leads(y);
    let (mut breaks, mut seeds) = (vec![0.0, 1.0], Vec::new());
    breaks.extend(
        [(q0, u0), (q1, u1)]
            .iter()
            .filter(|(q, _)| q.abs() > SMALLEST_FAN)
            .map(|e| e.1),
    );
    for (k, boundary) in boundaries.into_iter().enumerate() {
        let place = |fraction: &f64| parameter_of(shape, y, [u0, u1], (k, *fraction));
        let (kinks, knots) = boundary.places();
        breaks.extend(kinks.iter().map(place));
        seeds.extend(knots.iter().map(place));
    }
    breaks.sort_by(f64::total_cmp);
    breaks.dedup_by(|b, a| *b - *a < 1e-9);
    (breaks, seeds)
}

/// The u at which curve `k` is at `fraction`.
fn parameter_of(
    shape: &PathShape,
    y: &[f64],
    [u0, u1]: [f64; 2],
    (k, fraction): (usize, f64),
) -> f64 {
    let at = |w: f64| {
        let p = shape.at(y, w);
        if k == 0 { p.s } else { p.t }
    };
    if fraction < at(0.0) {
        return 0.5 * fraction;
    }
    if fraction > at(1.0) {
        return 0.5 * (1.0 + fraction);
    }
    u0 + (u1 - u0) * shape.place_of(y, k, fraction)
}

impl Loft {
    /// Makes the standing curve of every fan the copy of the swept one, scaled
    /// by `scale(length of the swept piece)` from the cone's apex.
    fn cone(&mut self, scale: impl Fn(f64) -> f64, extends: bool) -> Result<(), FitError> {
        for (k, fan) in self.fans.clone().into_iter().enumerate() {
            let (standing, swept) = self.sides(&fan);
            let join = fan.range[usize::from(fan.at_start)];
            let (corner, far) = (standing.point(join), swept.point(join));
            let piece = swept
                .restricted(fan.range[0], fan.range[1])
                .map_err(numerical)?;
            let length = ArcLength::new(&piece).total();
            let scale = scale(length);
            let apex = corner + (corner - far) * (scale / (1.0 - scale));
            let controls: Vec<Point3<f64>> = swept.control_points().to_vec();
            self.replace(&fan, |i| apex + (controls[i] - apex) * scale)?;
            if extends {
                self.fans[k].extension = scale * length;
            }
        }
        Ok(())
    }

    fn sides(&self, fan: &FanRange) -> (&BSplineCurve, &BSplineCurve) {
        if fan.apex_on_first {
            (&self.first, &self.second)
        } else {
            (&self.second, &self.first)
        }
    }

    /// Replaces the control points that shape the standing curve over a fan,
    /// that of the join with the plate beside it included.
    fn replace(
        &mut self,
        fan: &FanRange,
        point: impl Fn(usize) -> Point3<f64>,
    ) -> Result<(), FitError> {
        let curve = self.sides(fan).0;
        let mut controls = curve.control_points().to_vec();
        let knots = curve.knots();
        let degree = curve.degree();
        for (i, control) in controls.iter_mut().enumerate() {
            // The support of basis function i, within the fan?
            let (from, to) = (knots[i], knots[i + degree + 1]);
            let join = fan.range[usize::from(fan.at_start)];
            let is_join = knots[i + 1..=i + degree].iter().all(|u| *u == join);
            if is_join || (from >= fan.range[0] && to <= fan.range[1]) {
                *control = point(i);
            }
        }
        let changed =
            BSplineCurve::new(degree, knots.to_vec(), controls, None).map_err(numerical)?;
        if fan.apex_on_first {
            self.first = changed
        } else {
            self.second = changed
        }
        Ok(())
    }
}

fn numerical(e: crate::geometry::SplineError) -> FitError {
    FitError::Numerical(e.to_string())
}
