//! Fairing: the fairest curve or surface within a tolerance of measured points.
//!
//! * [`curve`]: points along a curve, in order or not, plane or in space;
//! * [`surface`]: grids and clouds of points of a sheet;
//! * [`offsets`]: a table of half-breadths, faired as one surface.
//!
//! # Problem
//! Offsets lifted from a drawing or measured on a hull are never exact. The
//! loftsman moves them, each by no more than he may, until the line is fair;
//! the numerical answer is the B-spline of least energy within those bounds,
//! the table of all moves, and the points that look like slips.
//!
//! # Formulas
//! The paper (Jing, Xi & Tang, *Fairing 3D curves and surfaces using deformable
//! models*, 1998; in Chinese) minimises
//!
//! E(r) = ∫ α|r′|² + β|r″|² + γ|r‴|² du + Σ Kᵢ ‖pᵢ − r(uᵢ)‖²
//!
//! (eqs. 1 and 4), uᵢ the foot of pᵢ on r, so that points need no order, and
//! raises or lowers one K for all points until max ‖pᵢ − r(uᵢ)‖ reaches ε. A
//! surface has U(r) = ∬ α₁₁|r_u|² + α₂₂|r_v|² + β₁₁|r_uu|² + β₁₂|r_uv|² +
//! β₂₂|r_vv|² (eq. 2).
//!
//! # What was changed, and why
//! * **A stiffness for each point.** One K for all wastes the room of all points
//!   but the worst. Here min F(r) subject to ‖pᵢ − r(uᵢ)‖ ≤ εᵢ is solved by an
//!   interior point method; the multipliers are the Kᵢ of the paper's springs,
//!   0 where a point has room.
//! * **The energy belongs to the shape.** The paper's depends on the parameter
//!   and is not 0 on an arc (r‴ = −ω² r′ there); F = ∫ κ′² ds is.
//! * **Without a tolerance** the noise is estimated with the shape by restricted
//!   likelihood, and the curve is the stiffest that the points do not refute.
//! * **Unordered points** get their order from a spanning tree of cell means,
//!   not from their boundary alone.
//!
//! The paper's own way is kept as [`curve::request::Solver::Paper`] and
//! [`surface::request::Solver::Paper`].
//!
//! # Sources
//! Jing, Xi & Tang 1998; Moreton & Séquin 1992 (minimum variation curves); Eck &
//! Hadenfeld 1995 (fairing within a tolerance); Wahba 1985, Patterson & Thompson
//! 1971 (likelihood); Nocedal & Wright, *Numerical Optimization*, ch. 19;
//! Hestenes 1969 (multipliers); Cook & Weisberg 1982 (deletion).

pub mod curve;
pub mod offsets;
mod student;
pub mod surface;

use super::{Control, FitError, Issue};

/// What the method takes.
#[derive(Debug, Clone, PartialEq)]
pub enum Request {
    /// A curve.
    Curve(curve::Request),
    /// A surface.
    Surface(surface::Request),
    /// A table of offsets.
    Offsets(offsets::Request),
}

/// What the method gives.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// A curve.
    Curve(Box<curve::Outcome>),
    /// A surface.
    Surface(Box<surface::Outcome>),
    /// A table of offsets.
    Offsets(Box<offsets::Outcome>),
}

/// Fairs.
///
/// # Errors
/// [`FitError::Invalid`] for unusable input, [`FitError::Stopped`] when the
/// control says so, [`FitError::Numerical`] where the points and wishes leave
/// no shape.
pub fn fit(request: &Request, control: &dyn Control) -> Result<Outcome, FitError> {
    Ok(match request {
        Request::Curve(r) => Outcome::Curve(Box::new(curve::fit(r, control)?)),
        Request::Surface(r) => Outcome::Surface(Box::new(surface::fit(r, control)?)),
        Request::Offsets(r) => Outcome::Offsets(Box::new(offsets::fit(r, control)?)),
    })
}

/// Every issue of a request; none: it can be fitted.
#[must_use]
pub fn validate(request: &Request) -> Vec<Issue> {
    match request {
        Request::Curve(r) => curve::validate(r),
        Request::Surface(r) => surface::validate(r),
        Request::Offsets(r) => offsets::validate(r),
    }
}
