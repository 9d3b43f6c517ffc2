//! The B-spline ruled surface S(u, v) = (1−v) a(u) + v b(u) (eq. 1), a and b
//! cubic on one knot vector over [0, 1].

use crate::geometry::bspline::{basis_jet, interpolate_at};
use crate::geometry::{BSplineCurve, Knots, SplineError};
use nalgebra::{DMatrix, Point3, Vector3, center};

/// Degree of the boundaries.
const DEGREE: usize = 3;
/// Joints are double knots, for there the curvature of a cone spline jumps.
/// (The paper says "a knot"; simple ones do as well on most strips like its
/// own, and a wavy one in 8 regions ends four times as far off.)
const AT_JOINTS: usize = 2;
/// Simple knots inside a region: with the double ones 4 control points belong
/// to each region (the paper's table 1 finds that more do not help).
const INSIDE: usize = 2;
/// Places a control point at which a surface is taken over.
const PLACES: usize = 8;

/// The two boundaries: on side 0 and side 1 of the strip.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Ruled {
    pub(super) sides: [BSplineCurve; 2],
}

/// Point and derivatives at (u, v).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Jet {
    pub(super) point: Point3<f64>,
    pub(super) u: Vector3<f64>,
    pub(super) v: Vector3<f64>,
    pub(super) uu: Vector3<f64>,
    pub(super) uv: Vector3<f64>,
}

impl Ruled {
    /// Through given rulings, at parameters in proportion to the way of their
    /// middles.
    ///
    /// # Errors
    /// Rulings that do not follow each other.
    pub(super) fn through(rulings: &[[Point3<f64>; 2]]) -> Result<Ruled, SplineError> {
        let mut parameters = vec![0.0];
        for pair in rulings.windows(2) {
            let [a, b] = [
                center(&pair[0][0], &pair[0][1]),
                center(&pair[1][0], &pair[1][1]),
            ];
            parameters.push(parameters[parameters.len() - 1] + (b - a).norm());
        }
        let length = parameters[parameters.len() - 1];
        parameters.iter_mut().for_each(|u| *u /= length);
        let side = |k: usize| {
            let ends: Vec<_> = rulings.iter().map(|r| r[k]).collect();
            interpolate_at(&parameters, &ends, DEGREE)
        };
        Ok(Ruled {
            sides: [side(0)?, side(1)?],
        })
    }

    /// The nearest surface (by least squares at even parameters) with a
    /// region between each two neighbouring breaks, 0 and 1 among them.
    ///
    /// # Errors
    /// Breaks that do not increase.
    pub(super) fn with_regions(&self, breaks: &[f64]) -> Result<Ruled, SplineError> {
        let mut inner = Vec::new();
        for pair in breaks.windows(2) {
            if pair[0] > breaks[0] {
                inner.extend([pair[0]; AT_JOINTS]);
            }
            let share = |i: usize| i as f64 / (INSIDE + 1) as f64;
            inner.extend((1..=INSIDE).map(|i| pair[0] + share(i) * (pair[1] - pair[0])));
        }
        let knots = Knots::clamped(DEGREE, [0.0, 1.0], &inner)?;
        let places: Vec<f64> = (breaks.windows(2))
            .flat_map(|w| {
                let count = PLACES * (INSIDE + AT_JOINTS);
                let share = move |i: usize| (i as f64 + 0.5) / count as f64;
                (0..count).map(move |i| w[0] + share(i) * (w[1] - w[0]))
            })
            .collect();
        let side = |k: usize| nearest_curve(&self.sides[k], &knots, &places);
        Ok(Ruled {
            sides: [side(0)?, side(1)?],
        })
    }

    /// Both ends of the ruling at u.
    pub(super) fn ruling(&self, u: f64) -> [Point3<f64>; 2] {
        [self.sides[0].point(u), self.sides[1].point(u)]
    }

    /// Point and derivatives.
    pub(super) fn jet(&self, u: f64, v: f64) -> Jet {
        let [a, b] = [0, 1].map(|k| self.sides[k].derivatives(u));
        let mix = |a: Vector3<f64>, b: Vector3<f64>| a * (1.0 - v) + b * v;
        Jet {
            point: a.point + (b.point - a.point) * v,
            u: mix(a.d1, b.d1),
            v: b.point - a.point,
            uu: mix(a.d2, b.d2),
            uv: b.d1 - a.d1,
        }
    }
}

/// The curve of given knots nearest to another one at some places, with its
/// ends.
fn nearest_curve(
    curve: &BSplineCurve,
    knots: &Knots,
    places: &[f64],
) -> Result<BSplineCurve, SplineError> {
    let n = knots.control_count();
    let mut normal = DMatrix::<f64>::zeros(n, n);
    let mut right = DMatrix::<f64>::zeros(n, 3);
    /// The ends count so much: they are kept.
    const END: f64 = 1e6;
    let weighted = places
        .iter()
        .map(|u| (*u, 1.0))
        .chain([(0.0, END), (1.0, END)]);
    for (u, weight) in weighted {
        let basis = basis_jet::<1>(knots, u);
        let point = curve.point(u);
        for (i, a) in basis.values().iter().enumerate() {
            let row = basis.first + i;
            for (j, b) in basis.values().iter().enumerate() {
                normal[(row, basis.first + j)] += weight * a * b;
            }
            for c in 0..3 {
                right[(row, c)] += weight * a * point[c];
            }
        }
    }
    let control = match normal.cholesky() {
        Some(factor) => factor.solve(&right),
        None => DMatrix::from_element(n, 3, f64::NAN),
    };
    let points = (0..n)
        .map(|i| Point3::new(control[(i, 0)], control[(i, 1)], control[(i, 2)]))
        .collect();
    BSplineCurve::from_knots(knots.clone(), points, None)
}
