//! Nets from coarse to fine over a rectangle, and how many points each level
//! looks at.

use super::super::net::Net;
use crate::geometry::Knots;
use crate::methods::FitError;

/// Degree of scattered fits: sixteen control points a place.
pub(in super::super) const DEGREE: usize = 3;
/// Spans along the longer side, level by level.
pub(in super::super) const LEVELS: [usize; 5] = [8, 16, 32, 64, 96];
/// Fewest spans along the shorter side.
const FEWEST_SPANS: usize = 3;
/// Points that coarse levels look at: enough for thirty a control point.
pub(in super::super) const SAMPLE: usize = 30_000;
/// Points a control point that make the next level worth a look.
const POINTS_A_CONTROL: f64 = 0.7;
/// A level is worth its cost when it lowers the variance of the noise by more
/// than this many points' worth of it (their likelihood ratio) ...
const WORTH: f64 = 20.0;
/// ... within these shares: below, the sample cannot tell; above, anybody can.
const SHARES: [f64; 2] = [3e-4, 1e-2];

/// Least gain, as share of the noise's variance, for which a finer level is
/// taken.
pub(in super::super) fn least_gain(points: usize) -> f64 {
    (WORTH / points.max(1) as f64).clamp(SHARES[0], SHARES[1])
}
/// The net goes past the outermost point by this share of the longer side.
const PAST: f64 = 0.005;

/// Order of the isotropic energy: change of curvature, or bending where there
/// are hardly more points than it leaves free.
pub(in super::super) fn order(points: usize) -> usize {
    if points >= 30 { 3 } else { 2 }
}

/// The rectangle of places with its margin.
pub(in super::super) fn domain(at: &[[f64; 2]]) -> [[f64; 2]; 2] {
    let mut domain = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
    for p in at {
        for k in 0..2 {
            domain[k][0] = domain[k][0].min(p[k]);
            domain[k][1] = domain[k][1].max(p[k]);
        }
    }
    let side = domain.iter().map(|d| d[1] - d[0]).fold(0.0, f64::max);
    domain.map(|[a, b]| [a - PAST * side, b + PAST * side])
}

/// The net of a level, cells as square as they can be.
///
/// # Errors
/// [`FitError::Numerical`] for a domain without extent.
pub(in super::super) fn net(
    domain: [[f64; 2]; 2],
    spans: usize,
    wanted: Option<[usize; 2]>,
) -> Result<Net, FitError> {
    let length = domain.map(|[a, b]| b - a);
    let longer = length[0].max(length[1]);
    let count = |k: usize| match wanted {
        Some(w) => w[k].saturating_sub(DEGREE).max(1),
        None => ((spans as f64 * length[k] / longer).round() as usize).max(FEWEST_SPANS),
    };
    let knots = |k: usize| {
        Knots::uniform(DEGREE, domain[k], count(k)).map_err(|e| FitError::Numerical(e.to_string()))
    };
    Ok(Net::new([knots(0)?, knots(1)?]))
}

/// Whether a net of a level is not too fine for so many points.
pub(in super::super) fn affordable(net: &Net, points: usize) -> bool {
    net.len() as f64 * POINTS_A_CONTROL <= points as f64
}
