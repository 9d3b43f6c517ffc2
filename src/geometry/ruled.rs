//! Ruled surfaces `S(u,v) = (1−v) D₁(u) + v D₂(u)` and the differential
//! geometry by which a plate is judged.
//!
//! With `L = D₂ − D₁`, the surface normal at the two ends of a ruling has the
//! directions `n₁ = L×D₁′` and `n₂ = L×D₂′`, and `(1−v) n₁ + v n₂` in between.
//! The surface is developable where they are parallel; the *twist* is the
//! angle between them. Where they are, the normal vanishes at one point of the
//! ruling's line, on the *regression curve*, beyond which the plate would fold
//! back on itself.
//!
//! Derivatives are right-sided in `u` at inner knots (left-sided at the end);
//! the `_left` variants of the curves give the other limit.

use super::bspline::{Axis, BSplineCurve, BSplineSurface, CurveJet, Knots, SplineError};
use super::bspline::{SurfaceJet, surface_from_rows};
use nalgebra::{Point3, Vector3};

/// A ruled surface between two curves of one domain; `v` runs from 0 on the
/// first to 1 on the second.
#[derive(Debug, Clone, PartialEq)]
pub struct RuledSurface {
    first: BSplineCurve,
    second: BSplineCurve,
}

/// Everything about one ruling that follows from the two curves' jets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RulingJet {
    /// The first curve.
    pub first: CurveJet,
    /// The second curve.
    pub second: CurveJet,
}

/// First and second fundamental form at a point: lengths squared and the
/// normal parts of the second derivatives (`g` of a ruling direction is 0).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FundamentalForms {
    /// `E, F, G` = Su·Su, Su·Sv, Sv·Sv.
    pub first: [f64; 3],
    /// `e, f, g` = N·Suu, N·Suv, N·Svv.
    pub second: [f64; 3],
}

impl RuledSurface {
    /// The surface between two curves.
    ///
    /// # Errors
    /// [`SplineError::DomainsDiffer`] unless both have one domain.
    pub fn new(first: BSplineCurve, second: BSplineCurve) -> Result<Self, SplineError> {
        if first.domain() != second.domain() {
            let (first, second) = (first.domain(), second.domain());
            return Err(SplineError::DomainsDiffer { first, second });
        }
        Ok(RuledSurface { first, second })
    }

    /// The curve at v = 0.
    #[must_use]
    pub fn first(&self) -> &BSplineCurve {
        &self.first
    }

    /// The curve at v = 1.
    #[must_use]
    pub fn second(&self) -> &BSplineCurve {
        &self.second
    }

    /// First and last `u`.
    #[must_use]
    pub fn domain(&self) -> [f64; 2] {
        self.first.domain()
    }

    /// The ruling at `u`.
    #[must_use]
    pub fn ruling(&self, u: f64) -> RulingJet {
        RulingJet {
            first: self.first.derivatives(u),
            second: self.second.derivatives(u),
        }
    }

    /// The ruling at `u` as a limit from the left.
    #[must_use]
    pub fn ruling_left(&self, u: f64) -> RulingJet {
        RulingJet {
            first: self.first.derivatives_left(u),
            second: self.second.derivatives_left(u),
        }
    }

    /// The point at (u, v).
    #[must_use]
    pub fn point(&self, u: f64, v: f64) -> Point3<f64> {
        let (a, b) = (self.first.point(u), self.second.point(u));
        a + (b - a) * v
    }

    /// Point and partial derivatives at (u, v).
    #[must_use]
    pub fn derivatives(&self, u: f64, v: f64) -> SurfaceJet {
        self.ruling(u).surface(v)
    }

    /// The tensor-product surface of degree `[p, 1]`, `v` from 0 on the first
    /// curve to 1 on the second, `p` the larger degree. Exact; where a curve is
    /// rational, `v` runs along its rulings at another pace (the rulings are
    /// the same).
    ///
    /// # Errors
    /// Those of raising the degree and inserting knots; none for valid curves.
    pub fn to_bspline(&self) -> Result<BSplineSurface, SplineError> {
        let degree = self.first.degree().max(self.second.degree());
        let (a, b) = (
            self.first.elevated_to(degree)?,
            self.second.elevated_to(degree)?,
        );
        let refined = |c: &BSplineCurve, other: &BSplineCurve| {
            c.insert_knots(&c.knot_vector().missing_from(other.knot_vector()))
        };
        let (mut a, mut b) = (refined(&a, &b)?, refined(&b, &a)?);
        if a.weights().is_some() != b.weights().is_some() {
            (a, b) = (a.as_rational(), b.as_rational());
        }
        surface_from_rows(Axis::U, &[a, b], Knots::clamped(1, [0.0, 1.0], &[])?)
    }

    /// First and second fundamental form at (u, v); `None` where the surface
    /// is singular.
    #[must_use]
    pub fn fundamental_forms(&self, u: f64, v: f64) -> Option<FundamentalForms> {
        self.ruling(u).fundamental_forms(v)
    }

    /// Gaussian curvature at (u, v), never positive; `None` where singular.
    #[must_use]
    pub fn gaussian_curvature(&self, u: f64, v: f64) -> Option<f64> {
        Some(self.fundamental_forms(u, v)?.gaussian_curvature())
    }

    /// Curvature of the bend across the ruling at (u, v), signed along
    /// `Su × Sv`; `None` where singular. Its inverse is the radius to roll.
    #[must_use]
    pub fn bend_curvature(&self, u: f64, v: f64) -> Option<f64> {
        self.ruling(u).bend_curvature(v)
    }

    /// Twist of the ruling at `u`, radians, signed. See [`RulingJet::twist`].
    #[must_use]
    pub fn twist(&self, u: f64) -> f64 {
        self.ruling(u).twist()
    }
}

impl RulingJet {
    /// From the first curve's point to the second's.
    #[must_use]
    pub fn direction(&self) -> Vector3<f64> {
        self.second.point - self.first.point
    }

    /// Normal directions at the ends: `L×D₁′`, `L×D₂′`, not normalised.
    #[must_use]
    pub fn end_normals(&self) -> [Vector3<f64>; 2] {
        let l = self.direction();
        [l.cross(&self.first.d1), l.cross(&self.second.d1)]
    }

    /// The signed angle between the normals at the two ends, radians in
    /// (−π, π]: `atan2(|L| det(L, D₁′, D₂′), n₁·n₂)`. Zero where an end stands
    /// still (a cone) or the ruling has no length.
    #[must_use]
    pub fn twist(&self) -> f64 {
        let l = self.direction();
        let [n1, n2] = self.end_normals();
        let det = n1.dot(&self.second.d1);
        (l.norm() * det).atan2(n1.dot(&n2))
    }

    /// Point and partial derivatives at `v` on the ruling.
    #[must_use]
    pub fn surface(&self, v: f64) -> SurfaceJet {
        let (a, b) = (&self.first, &self.second);
        SurfaceJet {
            point: a.point + (b.point - a.point) * v,
            du: a.d1.lerp(&b.d1, v),
            dv: b.point - a.point,
            duu: a.d2.lerp(&b.d2, v),
            duv: b.d1 - a.d1,
            dvv: Vector3::zeros(),
        }
    }

    /// Both fundamental forms at `v`; `None` where the surface is singular.
    #[must_use]
    pub fn fundamental_forms(&self, v: f64) -> Option<FundamentalForms> {
        let s = self.surface(v);
        let n = s.normal()?;
        Some(FundamentalForms {
            first: [s.du.norm_squared(), s.du.dot(&s.dv), s.dv.norm_squared()],
            second: [n.dot(&s.duu), n.dot(&s.duv), n.dot(&s.dvv)],
        })
    }

    /// See [`RuledSurface::bend_curvature`].
    #[must_use]
    pub fn bend_curvature(&self, v: f64) -> Option<f64> {
        Some(self.fundamental_forms(v)?.curvature_across_v())
    }

    /// Where on the ruling's line the regression curve passes: the `v` at
    /// which `(1−v) h₁ + v h₂ = 0`, with `h₁`, `h₂` the end normals measured
    /// along the longer of the two. Infinite where they are equal (a cylinder).
    #[must_use]
    pub fn regression(&self) -> f64 {
        let [n1, n2] = self.end_normals();
        let along = if n1.norm_squared() >= n2.norm_squared() {
            n1
        } else {
            n2
        };
        // Both scaled by |along|, which cancels.
        let (h1, h2) = (n1.dot(&along), n2.dot(&along));
        if h1 == h2 {
            f64::INFINITY
        } else {
            h1 / (h1 - h2)
        }
    }

    /// Distance of the regression curve from the ruling in ruling lengths: 0
    /// where it lies on the ruling (the plate folds), infinite for a cylinder.
    #[must_use]
    pub fn clearance(&self) -> f64 {
        let v = self.regression();
        (-v).max(v - 1.0).max(0.0)
    }
}

impl FundamentalForms {
    /// `(eg − f²)/(EG − F²)`.
    #[must_use]
    pub fn gaussian_curvature(&self) -> f64 {
        let [e1, f1, g1] = self.first;
        let [e, f, g] = self.second;
        (e * g - f * f) / (e1 * g1 - f1 * f1)
    }

    /// `½ (eG − 2fF + gE)/(EG − F²)`.
    #[must_use]
    pub fn mean_curvature(&self) -> f64 {
        let [e1, f1, g1] = self.first;
        let [e, f, g] = self.second;
        0.5 * (e * g1 - 2.0 * f * f1 + g * e1) / (e1 * g1 - f1 * f1)
    }

    /// The normal curvature perpendicular to the v direction:
    /// `(e − 2fF/G + gF²/G²)/(E − F²/G)`.
    #[must_use]
    pub fn curvature_across_v(&self) -> f64 {
        let [e1, f1, g1] = self.first;
        let [e, f, g] = self.second;
        let r = f1 / g1;
        (e - 2.0 * f * r + g * r * r) / (e1 - f1 * r)
    }
}

#[cfg(test)]
mod tests;
