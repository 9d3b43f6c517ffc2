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
//! whole bend makes it. The tip of a fan stays one point and goes where its
//! neighbours go; that of a plate that is all fan goes where the planes of its
//! rulings meet once they have moved.

use super::development::breaks;
use crate::geometry::{BSplineCurve, Knots, RuledSurface, RulingJet, interpolate_at, join_c0};
use nalgebra::{Matrix3, Point3, Vector3};

/// Intervals through which a boundary is interpolated: with the cube of a
/// thousandth what is left is below rounding of a drawing, the more so as only
/// the way by half a thickness is not a spline already …
const INTERVALS: usize = 1024;
/// … and at least so many of a piece.
const FEWEST: usize = 8;
/// Normals on two sides of a knot that differ by more are those of a knuckle,
/// radians: that is no bend but a joint.
const KNUCKLE: f64 = 0.25;
/// Over so much of the plate on either side a jump is spread.
const SPREAD: f64 = 0.02;
/// What moves over a span less than this share of the plate stands still:
/// rounding would say where to.
const STILL: f64 = 1e-9;
/// v at the ends of a ruling.
const END: [f64; 2] = [0.0, 1.0];

/// The surface at the distance `shift` along the normals `Su × Sv`. `None` where
/// it has knuckles, at which an offset gapes or overlaps, or no normals.
pub(super) fn offset(plate: &RuledSurface, shift: f64) -> Option<RuledSurface> {
    if shift == 0.0 {
        return Some(plate.clone());
    }
    let boundary = |end: usize| Boundary::new(plate, end)?.moved(shift);
    RuledSurface::new(boundary(0)?, boundary(1)?).ok()
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

/// One boundary of a plate with what is needed of its normals.
struct Boundary<'a> {
    plate: &'a RuledSurface,
    /// Which: 0 or 1.
    end: usize,
    /// Runs of spans along which the boundary moves or stands still, in turn.
    runs: Vec<Run>,
    ramps: Vec<Ramp>,
}

/// Spans of one kind that follow on one another.
struct Run {
    knots: Vec<f64>,
    /// Of the tip of a fan, how it moves; else it is no tip.
    tip: Option<Vector3<f64>>,
}

/// What is added to normals near a place, so that those on both sides agree.
struct Ramp {
    at: f64,
    /// Felt before it (0) or behind it (1), so far.
    side: usize,
    reach: f64,
    correction: Vector3<f64>,
}

impl Ramp {
    /// What is added to the normal at u, or to its limit from the left.
    fn correction(&self, u: f64, left: bool) -> Vector3<f64> {
        let side = usize::from(u > self.at || (u == self.at && !left));
        if side != self.side {
            return Vector3::zeros();
        }
        let share = 1.0 - (u - self.at).abs() / self.reach;
        self.correction * share.max(0.0)
    }
}

impl<'a> Boundary<'a> {
    fn new(plate: &'a RuledSurface, end: usize) -> Option<Self> {
        let mut boundary = Boundary {
            plate,
            end,
            runs: Vec::new(),
            ramps: Vec::new(),
        };
        for span in breaks(plate).windows(2) {
            boundary.add_span(span);
        }
        boundary.smooth_out()?;
        Some(boundary)
    }

    fn add_span(&mut self, span: &[f64]) {
        let sides = [self.plate.first(), self.plate.second()];
        let size = sides.map(|c| c.bounding_box().diagonal());
        let at = |share: f64| sides[self.end].point(span[0] + (span[1] - span[0]) * share);
        let first = at(0.0);
        let way = |share: f64| (at(share) - first).norm();
        let is_still = [0.3, 0.7, 1.0].into_iter().map(way).fold(0.0, f64::max)
            <= STILL * f64::max(size[0], size[1]);
        match self.runs.last_mut() {
            Some(run) if run.tip.is_some() == is_still => run.knots.push(span[1]),
            _ => self.runs.push(Run {
                knots: span.to_vec(),
                tip: is_still.then(Vector3::zeros),
            }),
        }
    }

    /// Finds the ramps and how tips move.
    fn smooth_out(&mut self) -> Option<()> {
        for i in 0..self.runs.len() {
            let knots = self.runs[i].knots.clone();
            let [first, last] = [knots[0], knots[knots.len() - 1]];
            if self.runs[i].tip.is_some() {
                let before = match i.checked_sub(1) {
                    Some(_) => Some(self.normal(first, true)?),
                    None => None,
                };
                let behind = match self.runs.get(i + 1) {
                    Some(_) => Some(self.normal(last, false)?),
                    None => None,
                };
                let between = match (before, behind) {
                    (Some(a), Some(b)) => (a + b).try_normalize(0.0)?,
                    (Some(one), None) | (None, Some(one)) => one,
                    (None, None) => self.apex(&[first, last])?,
                };
                self.runs[i].tip = Some(between);
                if let Some(own) = before {
                    self.add_ramp(i - 1, first, 0, between - own);
                }
                if let Some(own) = behind {
                    self.add_ramp(i + 1, last, 1, between - own);
                }
                continue;
            }
            for at in knots[1..knots.len() - 1].iter().copied() {
                let [a, b] = [self.normal(at, true)?, self.normal(at, false)?];
                if a.cross(&b).norm().atan2(a.dot(&b)) > KNUCKLE {
                    return None;
                }
                let between = (a + b).try_normalize(0.0)?;
                self.add_ramp(i, at, 0, between - a);
                self.add_ramp(i, at, 1, between - b);
            }
        }
        Some(())
    }

    fn add_ramp(&mut self, run: usize, at: f64, side: usize, correction: Vector3<f64>) {
        let [first, last] = self.plate.domain();
        let knots = &self.runs[run].knots;
        let here = knots.partition_point(|k| *k < at);
        let room = match side {
            0 => at - knots[here - 1],
            _ => knots[here + 1] - at,
        };
        self.ramps.push(Ramp {
            at,
            side,
            reach: room.min(SPREAD * (last - first)),
            correction,
        });
    }

    /// The normal at u, or its limit from the left.
    fn normal(&self, u: f64, left: bool) -> Option<Vector3<f64>> {
        normal(&self.ruling(u, left), END[self.end])
    }

    fn ruling(&self, u: f64, left: bool) -> RulingJet {
        match left {
            true => self.plate.ruling_left(u),
            false => self.plate.ruling(u),
        }
    }

    /// How the apex of a cone moves when its planes move by 1 along their
    /// normals n: the m with n · m = 1 for all, nearly, and no longer than that
    /// takes.
    fn apex(&self, [first, last]: &[f64; 2]) -> Option<Vector3<f64>> {
        /// Planes that are looked at.
        const PLANES: u32 = 64;
        /// Weight of the length of m.
        const SHORT: f64 = 1e-9;
        let mut matrix = Matrix3::identity() * SHORT;
        let mut sum = Vector3::zeros();
        for k in 0..PLANES {
            let share = (f64::from(k) + 0.5) / f64::from(PLANES);
            let n = self.normal(first + (last - first) * share, false)?;
            matrix += n * n.transpose() / f64::from(PLANES);
            sum += n / f64::from(PLANES);
        }
        Some(matrix.cholesky()?.solve(&sum))
    }

    /// The boundary moved along the normals, smooth piece by smooth piece.
    fn moved(&self, shift: f64) -> Option<BSplineCurve> {
        let mut pieces: Vec<BSplineCurve> = Vec::new();
        for run in &self.runs {
            for span in run.knots.windows(2) {
                let span = [span[0], span[1]];
                match run.tip {
                    Some(tip) => pieces.push(self.still(span, tip * shift)?),
                    None => self.add_moving(span, shift, &mut pieces)?,
                }
            }
        }
        for i in 1..pieces.len() {
            // The same place from two sides, but for rounding.
            let before = pieces[i - 1].end();
            let mut points = pieces[i].control_points().to_vec();
            points[0] = before;
            let knots = pieces[i].knot_vector().clone();
            pieces[i] = BSplineCurve::from_knots(knots, points, None).ok()?;
        }
        join_c0(&pieces).ok()
    }

    /// The tip of a fan: one point to the bit.
    fn still(&self, span: [f64; 2], by: Vector3<f64>) -> Option<BSplineCurve> {
        let tip = self.ruling(span[0], false).surface(END[self.end]).point + by;
        let knots = Knots::clamped(3, span, &[]).ok()?;
        BSplineCurve::from_knots(knots, vec![tip; 4], None).ok()
    }

    /// A span along which the boundary moves, cut where a ramp ends.
    fn add_moving(&self, span: [f64; 2], shift: f64, pieces: &mut Vec<BSplineCurve>) -> Option<()> {
        let [first, last] = self.plate.domain();
        let near = 1e-9 * (last - first);
        let ends = self.ramps.iter().map(|r| match r.side {
            0 => r.at - r.reach,
            _ => r.at + r.reach,
        });
        let inside = |u: &f64| span[0] + near < *u && *u < span[1] - near;
        let mut cuts: Vec<f64> = ends.filter(inside).chain(span).collect();
        cuts.sort_by(f64::total_cmp);
        cuts.dedup_by(|b, a| *b - *a <= near);
        for part in cuts.windows(2) {
            let share = (part[1] - part[0]) / (last - first);
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // ≤ INTERVALS.
            let count = ((share * INTERVALS as f64).ceil() as usize).max(FEWEST);
            let at = |k: usize| match k {
                k if k == count => part[1],
                k => part[0] + (part[1] - part[0]) * k as f64 / count as f64,
            };
            let places: Vec<f64> = (0..=count).map(at).collect();
            let point = |(k, u): (usize, &f64)| self.point(*u, k == count, shift);
            let points: Option<Vec<_>> = places.iter().enumerate().map(point).collect();
            pieces.push(interpolate_at(&places, &points?, 3).ok()?);
        }
        Some(())
    }

    /// A place, moved; at the end of a piece as a limit from the left.
    fn point(&self, u: f64, left: bool, shift: f64) -> Option<Point3<f64>> {
        let ruling = self.ruling(u, left);
        let spread: Vector3<f64> = self.ramps.iter().map(|r| r.correction(u, left)).sum();
        let normal = normal(&ruling, END[self.end])? + spread;
        Some(ruling.surface(END[self.end]).point + normal.try_normalize(0.0)? * shift)
    }
}
