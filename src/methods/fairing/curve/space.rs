//! The splines among which the fair curve is sought: open with clamped ends
//! or closed without a seam.
//!
//! A closed spline with n spans is a clamped one on a longer knot vector,
//! the period's knots carried on by degree + 1 spans at both ends, whose
//! coefficients repeat: function j has the unknown (j − offset) mod n. The
//! functions that act within the period never see the clamped ends, so that
//! all evaluation stays with [`crate::geometry`].

use crate::geometry::bspline::{BasisJet, BasisTable, Pieces};
use crate::geometry::{BSplineCurve, Knots, SplineError};
use crate::numerics::EnvelopeMatrix;
use nalgebra::{Point3, SVector};
use std::sync::Arc;

/// A point or vector of the plane (D = 2) or of space (D = 3).
pub(super) type Vector<const D: usize> = SVector<f64, D>;

/// A spline space with its numbering of unknowns.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Space {
    knots: Knots,
    table: Arc<BasisTable>,
    domain: [f64; 2],
    unknowns: usize,
    /// Index of the function that has unknown 0.
    offset: usize,
    closed: bool,
}

impl Space {
    /// Clamped splines on `domain` with the given inner knots, multiplicities
    /// written out.
    ///
    /// # Errors
    /// As [`Knots::new`].
    pub(super) fn open(
        degree: usize,
        domain: [f64; 2],
        inner: &[f64],
    ) -> Result<Self, SplineError> {
        let knots = Knots::clamped(degree, domain, inner)?;
        Ok(Space {
            unknowns: knots.control_count(),
            table: Arc::new(BasisTable::new(&knots)),
            knots,
            domain,
            offset: 0,
            closed: false,
        })
    }

    /// Closed splines with period `domain[1] − domain[0]`; `inner` are the
    /// knots strictly within it, one more lies at the seam.
    ///
    /// # Errors
    /// As [`Knots::new`].
    pub(super) fn closed(
        degree: usize,
        domain: [f64; 2],
        inner: &[f64],
    ) -> Result<Self, SplineError> {
        let period = domain[1] - domain[0];
        let mut turn = vec![domain[0]];
        turn.extend_from_slice(inner);
        let n = turn.len();
        let knot = |i: isize| {
            let lap = i.div_euclid(n as isize);
            turn[i.rem_euclid(n as isize) as usize] + lap as f64 * period
        };
        let p = degree as isize;
        let long: Vec<f64> = (-p..=n as isize + p).map(knot).collect();
        let beyond = period / n as f64;
        let ends = [long[0] - beyond, long[long.len() - 1] + beyond];
        let knots = Knots::clamped(degree, ends, &long)?;
        Ok(Space {
            table: Arc::new(BasisTable::new(&knots)),
            knots,
            domain,
            unknowns: n,
            offset: degree + 1,
            closed: true,
        })
    }

    /// Degree.
    pub(super) fn degree(&self) -> usize {
        self.knots.degree()
    }

    /// Number of free coefficients (control points of the closed polygon, or
    /// of the clamped curve).
    pub(super) fn unknowns(&self) -> usize {
        self.unknowns
    }

    /// Whether the splines are closed.
    pub(super) fn is_closed(&self) -> bool {
        self.closed
    }

    /// Inner knots of the domain, multiplicities written out.
    pub(super) fn inner_knots(&self) -> Vec<f64> {
        let [a, b] = self.domain;
        let inside = |t: &&f64| **t > a && **t < b;
        self.knots.iter().filter(inside).copied().collect()
    }

    /// First and last parameter; the same place if closed.
    pub(super) fn domain(&self) -> [f64; 2] {
        self.domain
    }

    /// Number of spline functions, those of the padding included: the bound
    /// of [`BasisJet::first`].
    pub(super) fn functions(&self) -> usize {
        self.knots.control_count()
    }

    /// The unknown of a function.
    pub(super) fn unknown(&self, function: usize) -> usize {
        if self.closed {
            (function + self.unknowns - self.offset % self.unknowns) % self.unknowns
        } else {
            function
        }
    }

    /// A parameter brought into the domain: around if closed, else clamped.
    pub(super) fn wrap(&self, u: f64) -> f64 {
        let [a, b] = self.domain;
        if !self.closed || (u >= a && u < b) {
            return u.clamp(a, b);
        }
        let turned = a + (u - a).rem_euclid(b - a);
        if turned < b { turned } else { a }
    }

    /// Functions and their derivatives at a parameter of the domain.
    #[inline]
    pub(super) fn basis<const ROWS: usize>(&self, u: f64) -> BasisJet<ROWS> {
        self.table.jet(u)
    }

    /// The spans of the domain.
    pub(super) fn spans(&self) -> Vec<[f64; 2]> {
        let [a, b] = self.domain;
        let breaks = self.knots.breakpoints();
        breaks
            .windows(2)
            .filter(|w| w[0] >= a && w[1] <= b)
            .map(|w| [w[0], w[1]])
            .collect()
    }

    /// A zero matrix for quadratic forms in the coefficients of `components`
    /// coordinates, numbered coordinate by coordinate within each unknown.
    pub(super) fn matrix(&self, components: usize) -> EnvelopeMatrix {
        let (n, p) = (self.unknowns, self.degree());
        let first = |i: usize| {
            let near = i.saturating_sub(p);
            if self.closed && i + p >= n { 0 } else { near }
        };
        let rows = (0..n * components).map(|r| first(r / components) * components);
        EnvelopeMatrix::new(rows.collect())
    }

    /// The combination of coefficients with one row of a basis jet.
    #[inline]
    pub(super) fn combine<const D: usize>(
        &self,
        first: usize,
        row: &[f64],
        x: &[Vector<D>],
    ) -> Vector<D> {
        let mut sum = Vector::zeros();
        if self.closed {
            for (k, b) in row.iter().enumerate() {
                sum += x[self.unknown(first + k)] * *b;
            }
        } else {
            for (c, b) in x[first..].iter().zip(row) {
                sum += c * *b;
            }
        }
        sum
    }

    /// The spline with coefficients `x`, prepared for very many parameters.
    pub(super) fn pieces<const D: usize>(&self, x: &[Vector<D>]) -> Pieces<'_, D> {
        self.table.pieces(|function| x[self.unknown(function)])
    }

    /// The point of the spline with coefficients `x`.
    pub(super) fn point<const D: usize>(&self, x: &[Vector<D>], u: f64) -> Vector<D> {
        let b = self.basis::<1>(u);
        self.combine(b.first, b.values(), x)
    }

    /// The spline as a curve of the geometry kernel, with clamped ends.
    ///
    /// # Errors
    /// Coefficients that are not finite.
    pub(super) fn curve<const D: usize>(
        &self,
        x: &[Vector<D>],
    ) -> Result<BSplineCurve, SplineError> {
        let points = (0..self.functions())
            .map(|j| in_space(&x[self.unknown(j)]))
            .collect();
        let curve = BSplineCurve::from_knots(self.knots.clone(), points, None)?;
        if self.closed {
            curve.restricted(self.domain[0], self.domain[1])
        } else {
            Ok(curve)
        }
    }
}

/// A vector of the plane or of space as a point of space, z = 0 in the plane.
pub(super) fn in_space<const D: usize>(v: &Vector<D>) -> Point3<f64> {
    let mut p = Point3::origin();
    for (slot, value) in p.iter_mut().zip(v.iter()) {
        *slot = *value;
    }
    p
}
