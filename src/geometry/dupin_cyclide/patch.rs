//! The quaternionic bilinear patch and its real form.

use crate::geometry::{Axis, BSplineSurface, CircularArc};
use nalgebra::{Point3, Quaternion, Vector3};
use thiserror::Error;

/// A corner of a patch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CyclideCorner {
    /// Where it is.
    pub point: Point3<f64>,
    /// Unit tangents along u and v, at right angles.
    pub tangents: [Vector3<f64>; 2],
}

/// Why four corners have no patch.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum CyclideError {
    /// Two corners are one point, or a number is not finite.
    #[error("two corners of the patch are one point")]
    Degenerate,
    /// A side turns by half a turn or more.
    #[error("a side of the patch turns by half a turn or more")]
    HalfTurn,
}

/// A patch of a Dupin cyclide between four lines of curvature, over [0, 1]².
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CyclidePatch {
    corners: [CyclideCorner; 4],
    /// pᵢ wᵢ, the first corner as the origin.
    numerators: [Quaternion<f64>; 4],
    /// wᵢ.
    denominators: [Quaternion<f64>; 4],
}

/// Which corners make which side: along u at v = 0 and 1, along v at u = 0
/// and 1.
const SIDES: [[usize; 2]; 4] = [[0, 1], [2, 3], [0, 2], [1, 3]];

impl CyclidePatch {
    /// The patch with its corners at (u, v) = (0, 0), (1, 0), (0, 1), (1, 1).
    /// What is given beyond need (the frames of the last two corners, the last
    /// corner's place on the circle of the others) is taken to agree; see
    /// [`Self::defect`].
    ///
    /// # Errors
    /// Corners that are one point, sides of half a turn or more.
    pub fn new(corners: [CyclideCorner; 4]) -> Result<Self, CyclideError> {
        let place = corners.map(|c| c.point - corners[0].point);
        let [along_u, along_v] = corners[0].tangents;
        let one = Quaternion::identity();
        let w10 = unit(inverse(place[1])? * pure(along_u))?;
        let w01 = unit(inverse(place[2])? * pure(along_v))?;
        let w11 = inverse(place[3] - place[1])? * pure(corners[1].tangents[1]) * w10;
        let diagonals = (place[2] - place[1]).norm() / place[3].norm();
        let w11 = unit(w11)? * diagonals;
        if !(diagonals.is_finite() && diagonals > 0.0) {
            return Err(CyclideError::Degenerate);
        }
        // w₁₀ and w₀₁ of one length, w₀₀ and w₁₁ of another, so that no corner
        // is preferred.
        let even = diagonals.sqrt();
        let denominators = [one * even, w10, w01, w11 / even];
        let numerators = [0, 1, 2, 3].map(|i| pure(place[i]) * denominators[i]);
        Ok(CyclidePatch {
            corners,
            numerators,
            denominators,
        })
    }

    /// The corners it was made from.
    #[must_use]
    pub fn corners(&self) -> &[CyclideCorner; 4] {
        &self.corners
    }

    /// Its sides as arcs: along u at v = 0 and 1, along v at u = 0 and 1.
    /// `None` for a side without length.
    #[must_use]
    pub fn sides(&self) -> [Option<CircularArc>; 4] {
        let [a, b, c, d] = SIDES;
        [(a, 0), (b, 0), (c, 1), (d, 1)].map(|([from, to], direction)| {
            let start = &self.corners[from];
            CircularArc::new(
                start.point,
                start.tangents[direction],
                self.corners[to].point,
            )
        })
    }

    /// The point at (u, v).
    #[must_use]
    pub fn point(&self, u: f64, v: f64) -> Point3<f64> {
        let basis = [(1.0 - u) * (1.0 - v), u * (1.0 - v), (1.0 - u) * v, u * v];
        let sum = |terms: &[Quaternion<f64>; 4]| {
            terms
                .iter()
                .zip(basis)
                .fold(Quaternion::from_real(0.0), |sum, (q, b)| sum + *q * b)
        };
        let (over, under) = (sum(&self.numerators), sum(&self.denominators));
        let quotient = over * under.conjugate() / under.norm_squared();
        self.corners[0].point + quotient.imag()
    }

    /// (u, v) on a side (numbered as in [`Self::sides`]) for a parameter in
    /// [0, 1] that is the same for the patch on the other side of it: that of
    /// the arc as a rational quadratic with end weights 1.
    #[must_use]
    pub fn on_side(&self, side: usize, parameter: f64) -> [f64; 2] {
        let [from, to] = SIDES[side].map(|i| self.denominators[i].norm());
        let own = from * parameter / (to * (1.0 - parameter) + from * parameter);
        match side {
            0 => [own, 0.0],
            1 => [own, 1.0],
            2 => [0.0, own],
            _ => [1.0, own],
        }
    }

    /// Where the tangents at the two ends of a parameter line meet: of the
    /// line across `along` at the parameter `at`. Those of all lines are a
    /// conic, in which the two cones meet that touch the patch along its two
    /// sides in the direction `along`.
    #[must_use]
    pub fn tangents_meet(&self, along: Axis, at: f64) -> Point3<f64> {
        let terms = self.terms();
        let middle = match along {
            Axis::U => [1, 4, 7],
            Axis::V => [3, 4, 5],
        };
        let basis = [(1.0 - at) * (1.0 - at), 2.0 * at * (1.0 - at), at * at];
        let (place, weight) = (middle.into_iter().zip(basis))
            .fold((Vector3::zeros(), 0.0), |(place, weight), (i, b)| {
                (place + terms[i].1 * b, weight + terms[i].2 * b)
            });
        self.corners[0].point + place / weight
    }

    /// The largest real part of the biquadratic form over the patch's size:
    /// zero, to rounding, if and only if the corners and frames belong to a
    /// cyclide.
    #[must_use]
    pub fn defect(&self) -> f64 {
        let largest = self
            .terms()
            .iter()
            .fold(0.0, |m: f64, (real, _, _)| m.max(real.abs()));
        let size = [1, 2, 3].map(|i| self.numerators[i].norm());
        largest / size.into_iter().fold(0.0, f64::max)
    }

    /// The same patch as a rational biquadratic B-spline surface with positive
    /// weights; its corners are the given ones to the bit.
    ///
    /// # Errors
    /// [`CyclideError::HalfTurn`] where a weight is not positive.
    pub fn surface(&self) -> Result<BSplineSurface, CyclideError> {
        // Below this a control point is so far away that evaluation near it
        // loses the digits that the patch is asked to have.
        const LEAST_WEIGHT: f64 = 1e-3;
        let terms = self.terms();
        if !terms.iter().all(|(_, _, weight)| *weight > LEAST_WEIGHT) {
            return Err(CyclideError::HalfTurn);
        }
        let mut points = terms.map(|(_, place, weight)| self.corners[0].point + place / weight);
        // u is the slow index here; corners are given with u the fast one.
        for (place, corner) in [(0, 0), (6, 1), (2, 2), (8, 3)] {
            points[place] = self.corners[corner].point;
        }
        let knots = vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
        let weights = terms.map(|(_, _, weight)| weight).to_vec();
        BSplineSurface::new(
            [2, 2],
            [knots.clone(), knots],
            points.to_vec(),
            Some(weights),
        )
        .map_err(|_| CyclideError::Degenerate)
    }

    /// Real part, vector and weight of the nine biquadratic Bernstein
    /// coefficients, v fastest.
    fn terms(&self) -> [(f64, Vector3<f64>, f64); 9] {
        let mut sums = [(0.0, Vector3::zeros(), 0.0); 9];
        for (a, over) in self.numerators.iter().enumerate() {
            for (b, under) in self.denominators.iter().enumerate() {
                let [k, l] = [(a & 1) + (b & 1), (a >> 1) + (b >> 1)];
                // Of the four ordered pairs one, two or one fall on 0, 1, 2.
                let share = [1.0, 0.5, 1.0][k] * [1.0, 0.5, 1.0][l];
                let product = *over * under.conjugate();
                let weight = self.denominators[a] * under.conjugate();
                let (real, place, sum) = &mut sums[3 * k + l];
                *real += share * product.scalar();
                *place += product.imag() * share;
                *sum += share * weight.scalar();
            }
        }
        sums
    }
}

fn pure(v: Vector3<f64>) -> Quaternion<f64> {
    Quaternion::from_imag(v)
}

/// The inverse of a vector as an imaginary quaternion.
fn inverse(v: Vector3<f64>) -> Result<Quaternion<f64>, CyclideError> {
    let square = v.norm_squared();
    if square > 0.0 && square.is_finite() {
        Ok(pure(-v / square))
    } else {
        Err(CyclideError::Degenerate)
    }
}

fn unit(q: Quaternion<f64>) -> Result<Quaternion<f64>, CyclideError> {
    let norm = q.norm();
    if norm > 0.0 && norm.is_finite() {
        Ok(q / norm)
    } else {
        Err(CyclideError::Degenerate)
    }
}
