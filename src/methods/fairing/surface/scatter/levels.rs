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
/// A level that lowers the noise (a variance) by less than this has nothing
/// to add.
pub(in super::super) const GAIN: f64 = 0.01;
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
