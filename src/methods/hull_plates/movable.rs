//! A profile that may leave its place by at most a tolerance.
//!
//! The moved curve is E = C + Σ Bⱼ(a) dⱼ in the curve's own parameter a, with
//! cubic basis functions and coefficients dⱼ across the curve. By the convex
//! hull property |E(a) − C(a)| ≤ max |dⱼ|, so the bound holds **everywhere**
//! when it holds for the coefficients. It holds for those by their make,
//!
//! ```text
//! dⱼ = δ·z/√(1 + |z|²),   z ∈ ℝ²,   |dⱼ| < δ,
//! ```
//!
//! so the fit has nothing to keep and no step can leave the tolerance δ. E is
//! exactly a B-spline wherever C is one.

use super::profile::{Jet, Profile, even_shares, turning};
use crate::geometry::bspline::basis_jet;
use crate::geometry::{BSplineCurve, Knots, SplineError};
use nalgebra::{Point3, Vector3};

/// Degree of the displacement.
const DEGREE: usize = 3;

/// How a coefficient may move.
#[derive(Debug, Clone)]
struct Freedom {
    /// Orthogonal directions of length δ, one unknown each (0 to 2 of them).
    directions: Vec<Vector3<f64>>,
    /// Index of the first unknown among this profile's unknowns.
    offset: usize,
}

impl Freedom {
    /// δ·z/√(1 + |z|²) with its derivatives.
    fn displaced(&self, x: &[f64]) -> (Vector3<f64>, Vec<(usize, Vector3<f64>)>) {
        let z = &x[self.offset..self.offset + self.directions.len()];
        let root = z.iter().fold(1.0, |sum, v| sum + v * v).sqrt();
        let d: Vector3<f64> = self
            .directions
            .iter()
            .zip(z)
            .map(|(e, v)| e * (v / root))
            .sum();
        let derivatives = self
            .directions
            .iter()
            .zip(z)
            .enumerate()
            .map(|(k, (e, v))| {
                let derivative = (e - d * (v / root)) / root;
                (self.offset + k, derivative)
            });
        (d, derivatives.collect())
    }
}

/// The freedom of one profile.
#[derive(Debug, Clone)]
pub(super) struct Movable {
    knots: Knots,
    freedoms: Vec<Freedom>,
    unknowns: usize,
    /// Arc-length fraction of each unknown's coefficient.
    stations: Vec<f64>,
}

/// The displacement coefficients of a profile at some unknowns.
#[derive(Debug, Clone)]
pub(super) struct Displacement {
    /// dⱼ.
    pub(super) coefficients: Vec<Vector3<f64>>,
    /// Every coefficient's unknowns (their index among the profile's) with the
    /// derivatives ∂dⱼ/∂z.
    derivatives: Vec<Vec<(usize, Vector3<f64>)>>,
}

impl Displacement {
    /// The unknowns of coefficient `j` with their derivatives ∂dⱼ/∂z.
    pub(super) fn derivatives(&self, j: usize) -> &[(usize, Vector3<f64>)] {
        &self.derivatives[j]
    }
}

/// A point of a moved profile and how it depends on the displacement: the
/// point moves by `values[k]·δd`, its derivative by s by `slopes[k]·δd`, for
/// the coefficient `first + k`.
#[derive(Debug, Clone, Copy)]
pub(super) struct MovedJet {
    pub(super) jet: Jet,
    pub(super) first: usize,
    pub(super) values: [f64; DEGREE + 1],
    pub(super) slopes: [f64; DEGREE + 1],
}

impl MovedJet {
    /// A point of a profile that does not move.
    pub(super) fn fixed(jet: Jet) -> Self {
        MovedJet {
            jet,
            first: 0,
            values: [0.0; DEGREE + 1],
            slopes: [0.0; DEGREE + 1],
        }
    }
}

/// Steps along a profile in which its turning is measured.
const PROBES: usize = 512;
/// Points nearer than this to the plane y = 0 (unit scale) lie on it.
const ON_CENTRELINE: f64 = 1e-9;

impl Movable {
    /// A profile free to move by `tolerance` (unit scale) on `spans` knot
    /// spans, half of them even and half where it turns. `centreline` is the plane of symmetry's y in
    /// unit scale: a profile that lies in it stays in it, and an end on it
    /// keeps its place, or the two halves of the hull would not meet; so does an end that
    /// `meets` a neighbour's.
    pub(super) fn new(
        profile: &Profile,
        spans: usize,
        tolerance: f64,
        (centreline, meets): (f64, [bool; 2]),
    ) -> Result<Self, SplineError> {
        let [start, end] = profile.curve.domain();
        let inner: Vec<f64> = even_shares(&turning(PROBES, |s| [profile.at(s).d1]), spans)
            [1..spans]
            .iter()
            .map(|s| profile.parameter_of(*s))
            .collect();
        let knots = Knots::clamped(DEGREE, [start, end], &inner)?;
        let greville = knots.greville_abscissae();
        let on_centreline = |p: &Point3<f64>| (p.y - centreline).abs() < ON_CENTRELINE;
        let flat = profile.curve.control_points().iter().all(on_centreline);
        let last = greville.len() - 1;
        let mut movable = Movable {
            knots,
            freedoms: Vec::new(),
            unknowns: 0,
            stations: Vec::new(),
        };
        for (j, parameter) in greville.into_iter().enumerate() {
            let jet = profile.curve.derivatives(parameter);
            let end = if j == 0 {
                Some(0)
            } else {
                (j == last).then_some(1)
            };
            let held = end.is_some_and(|e| meets[e] || (on_centreline(&jet.point) && !flat));
            let mut directions = if held {
                Vec::new()
            } else {
                across(&jet.d1, flat)
            };
            directions.iter_mut().for_each(|e| *e *= tolerance);
            let station = profile.fraction_of(parameter);
            movable.stations.extend(directions.iter().map(|_| station));
            let offset = movable.unknowns;
            movable.unknowns += directions.len();
            movable.freedoms.push(Freedom { directions, offset });
        }
        Ok(movable)
    }

    /// Number of unknowns.
    pub(super) fn unknowns(&self) -> usize {
        self.unknowns
    }

    /// Arc-length fraction of each unknown.
    pub(super) fn stations(&self) -> &[f64] {
        &self.stations
    }

    /// Number of displacement coefficients.
    pub(super) fn count(&self) -> usize {
        self.freedoms.len()
    }

    /// Displacement coefficients and their derivatives.
    pub(super) fn displacement(&self, x: &[f64]) -> Displacement {
        let (coefficients, derivatives) = self.freedoms.iter().map(|f| f.displaced(x)).unzip();
        Displacement {
            coefficients,
            derivatives,
        }
    }

    /// The moved profile at arc-length fraction `s` of the unmoved one.
    pub(super) fn at(&self, profile: &Profile, d: &Displacement, s: f64) -> MovedJet {
        let mut jet = profile.at(s);
        let basis = basis_jet::<3>(&self.knots, jet.parameter);
        let (b0, b1, b2) = (basis.values(), basis.derivative(1), basis.derivative(2));
        let (mut values, mut slopes) = ([0.0; DEGREE + 1], [0.0; DEGREE + 1]);
        for k in 0..=DEGREE {
            let d = d.coefficients[basis.first + k];
            values[k] = b0[k];
            slopes[k] = b1[k] * jet.speed;
            jet.point += d * values[k];
            jet.d1 += d * slopes[k];
            jet.d2 += d * (b2[k] * jet.speed * jet.speed + b1[k] * jet.acceleration);
        }
        MovedJet {
            jet,
            first: basis.first,
            values,
            slopes,
        }
    }

    /// The moved profile as a B-spline of the unmoved one's parameter.
    ///
    /// # Errors
    /// If the two knot vectors cannot be united (the profile is not cubic).
    pub(super) fn moved_curve(
        &self,
        profile: &Profile,
        d: &Displacement,
    ) -> Result<BSplineCurve, SplineError> {
        let points = d.coefficients.iter().map(|v| Point3::from(*v)).collect();
        let displacement = BSplineCurve::new(DEGREE, self.knots.values().to_vec(), points, None)?;
        let united = profile.curve.knot_vector().union(&self.knots)?;
        let base = profile
            .curve
            .insert_knots(&profile.curve.knot_vector().missing_from(&united))?;
        let shift = displacement.insert_knots(&self.knots.missing_from(&united))?;
        let points = base
            .control_points()
            .iter()
            .zip(shift.control_points())
            .map(|(c, d)| c + d.coords)
            .collect();
        BSplineCurve::new(DEGREE, united.into_values(), points, None)
    }
}

/// Directions across a tangent; in the plane of symmetry only, if `flat`.
fn across(tangent: &Vector3<f64>, flat: bool) -> Vec<Vector3<f64>> {
    let t = tangent.try_normalize(0.0).unwrap_or_else(Vector3::x);
    if flat {
        return t
            .cross(&Vector3::y())
            .try_normalize(0.0)
            .into_iter()
            .collect();
    }
    // The axis least along the tangent makes the best conditioned frame.
    let axis = [Vector3::x(), Vector3::y(), Vector3::z()]
        .into_iter()
        .min_by(|a, b| a.dot(&t).abs().total_cmp(&b.dot(&t).abs()))
        .unwrap_or_else(Vector3::z);
    let first = t.cross(&axis).normalize();
    vec![first, t.cross(&first)]
}
