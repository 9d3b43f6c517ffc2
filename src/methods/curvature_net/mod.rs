//! Curvature nets: surfaces whose patch borders are lines of curvature.
//!
//! # Problem
//! A coarse regular net of quads says roughly where a skin runs and how its
//! seams lie. Wanted is a smooth surface near it whose seams are lines of
//! curvature: along them frames stand square to the skin without twist, strips
//! between them are developable, and offsets keep the net.
//!
//! # Unknowns
//! At every vertex of the net P, P_u, P_v, P_uv: the bicubic Hermite patches on
//! them are C¹ by construction.
//!
//! # Residuals
//! With S the surface, N = S_u × S_v, a line c of the net in direction u and
//! N_c its derivative along c:
//!
//! * torsion: det(S_u, N, N_u) / (|N|² |S_u|) at six places of every border,
//!   the geodesic torsion times the length of the border, radians; 0 ⇔ N_c ∥ c′
//!   ⇔ c is a line of curvature (do Carmo 1976, §3.3);
//! * squareness: S_u·S_v / (|S_u| |S_v|) at every vertex;
//! * closeness: the way D = S − S₀ of a vertex from the start S₀, along its
//!   normal and across it, or its distance from the tangent plane of a target
//!   at the nearest point;
//! * fairness: the bending D_uu, D_vv, D_uv, D_uuv, D_uvv of the way;
//! * lead: δ − σ (κ_u − κ_v) ≤ 0 at the corners of the patches, σ the sign in the
//!   start: else the torsion would go by making the surface a sphere in places.
//!
//! The torsion's weight rises ×1, ×10, ×100, ×1000 on every level, ×10⁴ on the
//! last; then each patch is split in four, which changes nothing of the shape,
//! until the net is as fine as asked. A net that is left with torsion or umbilics
//! is tried again: with more bending, with one curvature asked to lead all over,
//! from points that are smoothed before; the best of the tries is taken, and
//! split once more where torsion is left and the number of levels is free.
//!
//! # Sources
//! Zheng & Bo, *Design of smooth surfaces with regular network of curvature
//! curves*, Journal of Graphics 40(1), 2019, eqs. 1, 2 (in Chinese); Bobenko &
//! Huhnen-Venedey, arXiv 1101.5955; Bo, Liu, Tu, Zhang & Wang, *Surface fitting
//! with cyclide splines*, CAGD 43, 2016; Liu, Pottmann et al., *Geometric
//! modeling with conical meshes and developable surfaces*, 2006.
//!
//! # What was changed against the paper
//! * Hermite unknowns at the vertices instead of Bézier points: the paper's
//!   F_smooth is not needed, and there are 12 unknowns a patch instead of 48.
//! * The torsion is an angle, so that its weight does not depend on size.
//! * Fairness is asked of the way from the start instead of the vertices, so
//!   that a net that is laid right stays as it is.
//!
//! # Limits
//! Nets without singular vertices only; see [`request::Input`].

mod bend;
mod build;
pub mod cyclide;
mod deliver;
pub mod diagnose;
mod input;
pub mod lines;
pub mod net;
pub mod outcome;
mod paper;
pub mod reasons;
mod report;
pub mod request;
mod smooth;
pub mod structure;
pub mod surface;
mod target;
#[cfg(test)]
mod tests;

pub use input::MOST_PATCHES;
pub use net::Net;
pub use outcome::Outcome;
pub use request::Request;
pub use smooth::{Smooth, smooth};
pub use surface::Surface;

use super::{Control, FitError, Stop};
use crate::geometry::BoundingBox;

/// Fits a surface whose patch borders are lines of curvature, and what is
/// built from it.
///
/// # Errors
/// [`FitError::Invalid`] for unusable input, [`FitError::Stopped`] when the
/// control says so.
pub fn fit(request: &Request, control: &dyn Control) -> Result<Outcome, FitError> {
    let smooth = smooth(request, &Share::new(control, [0.0, SMOOTH]))?;
    let surface = deliver::spline(&smooth.surface)
        .map_err(|e| FitError::Numerical(format!("the surface is no spline: {e}")))?;
    let start = smooth.surface.net();
    let cyclides = if request.options.cyclide {
        let rest = Share::new(control, [SMOOTH, 100.0]);
        Some(build::build(&start, &request.options, &rest)?)
    } else {
        None
    };
    let net = cyclides.as_ref().map_or(start, |c| c.net.clone());
    let mut outcome = Outcome {
        within_limits: report::within_limits(&smooth, cyclides.as_ref()),
        summary: Vec::new(),
        warnings: Vec::new(),
        model_size: BoundingBox::of(&net.points).map_or(0.0, |b| b.longest_side()),
        surface,
        smooth,
        net,
        cyclides,
    };
    outcome.summary = report::summary(&outcome);
    control.progress("done", 100.0);
    Ok(outcome)
}

/// What the smooth surface takes of the whole, percent.
const SMOOTH: f64 = 60.0;

/// A control to which a part of the fit tells its own progress, 0 to 100.
struct Share<'a> {
    control: &'a dyn Control,
    range: [f64; 2],
}

impl<'a> Share<'a> {
    fn new(control: &'a dyn Control, range: [f64; 2]) -> Self {
        Share { control, range }
    }
}

impl Control for Share<'_> {
    fn check(&self) -> Result<(), Stop> {
        self.control.check()
    }

    fn progress(&self, phase: &'static str, percent: f64) {
        let [from, to] = self.range;
        self.control
            .progress(phase, from + (to - from) * percent / 100.0);
    }
}

/// Everything that can be said about a request without fitting it.
///
/// # Errors
/// [`FitError::Invalid`] with every issue found.
pub fn validate(request: &Request) -> Result<Vec<String>, FitError> {
    input::Task::new(request).map(|_| Vec::new())
}
