//! Fairing: the fairest curve or surface within a tolerance of measured points.
//!
//! Offsets that are measured, or lifted from a drawing, carry errors. This
//! method gives the B-spline that is as fair as possible while no point moves
//! farther than a tolerance, or, without one, as the noise of the points
//! allows; it lists every move and names the points that look like slips.
//!
//! The model is that of Jing, Xi & Tang 1998: an energy of the shape and a
//! spring from every point pᵢ to its nearest place on it,
//!
//! ```text
//! E(r) = U(r) + Σ Kᵢ ‖pᵢ − r(uᵢ)‖²                                (eq. 4)
//! U(r) = ∫ α|r′|² + β|r″|² + γ|r‴|² du                            (eq. 1)
//! U(r) = ∬ α₁₁|r_u|² + α₂₂|r_v|² + β₁₁|r_uu|² + β₁₂|r_uv|² + β₂₂|r_vv|² (eq. 2)
//! ```
//!
//! with one K for all points, raised or lowered until the largest move is the
//! tolerance (`Solver::Paper`). What is different here: the energy is the
//! change of curvature, so that circles and straight lines are perfectly fair;
//! every point has a bound of its own, which is met, and most points use the
//! room it leaves; without a tolerance the noise is estimated from the points
//! and the stiffness follows from it.
//!
//! * [`curve`]: points along a curve, in order or not, plane or in space;
//! * [`surface`]: grids and clouds of points of a sheet;
//! * [`offsets`]: a table of half-breadths, as one surface.

pub mod curve;
pub mod offsets;
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
