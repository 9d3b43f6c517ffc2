//! Nets from coarse to fine over a rectangle: how fine, and of which degree.
//!
//! Springs of stiffness 1 at density ρ and an energy of order m with weight λ
//! pass waves of wave number k by 1/(1 + λk²ᵐ/ρ). Waves shorter than
//! 2π(λ/ρ)^(1/2m) are smoothed away, so that a net whose spans are half as
//! long carries all that is left: finer ones change nothing. Each level gives
//! a λ, which tells how fine the next has to be.

use super::super::net::Net;
use super::super::springs::Cells;
use crate::geometry::Knots;
use crate::methods::FitError;
use rayon::prelude::*;

/// Degree of the net and order of its energy.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in super::super) struct Space {
    pub(in super::super) degree: usize,
    pub(in super::super) order: usize,
}

/// For sheets that are smooth on the scale of the net: converges fastest.
pub(in super::super) const SMOOTH: Space = Space {
    degree: 5,
    order: 4,
};
/// For sheets with detail on the scale of the net (ground, knuckles).
pub(in super::super) const ROUGH: Space = Space {
    degree: 3,
    order: 3,
};
/// For a handful of points.
pub(in super::super) const SPARSE: Space = Space {
    degree: 3,
    order: 2,
};
/// Fewer points than this are a handful: fewer than thrice what the energy of
/// order 4 leaves free.
const HANDFUL: usize = 30;
/// A sheet that wants more spans than this is not smooth. Its detail lies in
/// all directions, and the net is what limits it: it is no longer stretched.
const SMOOTH_SPANS: f64 = 40.0;

/// Spans along the longer side of the first level.
pub(in super::super) const FIRST: usize = 10;
/// Most spans: the matrix of a square sheet is then factored in a tenth of a
/// second.
pub(in super::super) const MOST: usize = 96;
/// Growth from level to level, at least and at most.
const GROWTH: [f64; 2] = [1.5, 3.0];
/// Spans a half wave that passes.
const SPANS_A_HALF_WAVE: f64 = 0.7;
/// Correlation of residuals from which a finer net is tried.
const MISSED: f64 = 0.06;
/// Fewest pairs of neighbours that can tell.
const FEWEST_PAIRS: usize = 100;
/// Standard deviations that chance is allowed.
const CHANCE: f64 = 3.0;
/// Fewest spans along the shorter side.
const FEWEST_SPANS: usize = 3;
/// Points that coarse levels look at: enough for dozens a control point.
pub(in super::super) const SAMPLE: usize = 20_000;
/// Points a control point that make the next level worth a look.
const POINTS_A_CONTROL: f64 = 0.7;
/// The net goes past the outermost point by this share of the longer side.
const PAST: f64 = 0.005;

/// One step of the way from coarse to fine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in super::super) struct Step {
    pub(in super::super) space: Space,
    pub(in super::super) spans: usize,
    /// How much farther the sheet is alike along u than along v: its energy
    /// counts derivatives by v less by this factor an order, and its net is
    /// finer by it along v.
    pub(in super::super) stretch: f64,
    /// Fewest spans along u and v: those of a base, so that the sheet raised
    /// across it can follow it.
    pub(in super::super) least: [usize; 2],
}

/// The first level.
pub(in super::super) fn first(points: usize) -> Step {
    Step {
        space: if points < HANDFUL { SPARSE } else { SMOOTH },
        spans: FIRST,
        stretch: 1.0,
        least: [FEWEST_SPANS; 2],
    }
}

/// The level after `now`, which found λ for springs of the given density
/// (weight per unit of area) on a sheet of the given sides; `None` where `now`
/// is fine enough.
pub(in super::super) fn next(
    now: Step,
    lambda: f64,
    (density, lengths): (f64, [f64; 2]),
) -> Option<Step> {
    let wave = (density / lambda).powf(0.5 / now.space.order as f64);
    let wanted = SPANS_A_HALF_WAVE * longer(lengths, now.stretch) * wave / std::f64::consts::PI;
    if wanted <= now.spans as f64 || now.spans >= MOST {
        return None;
    }
    let low = GROWTH[0] * now.spans as f64;
    let spans = wanted.clamp(low, GROWTH[1] * now.spans as f64) as usize;
    let rough = now.space == SMOOTH && wanted > SMOOTH_SPANS && now.spans > FIRST;
    Some(Step {
        space: if rough { ROUGH } else { now.space },
        spans: spans.min(MOST),
        stretch: if rough { 1.0 } else { now.stretch },
        ..now
    })
}

/// The longer side where lengths along v count `stretch` times.
fn longer([a, b]: [f64; 2], stretch: f64) -> f64 {
    a.max(stretch * b)
}

/// Mean correlation of the residuals of neighbours in cells half as long as
/// the net's: nothing for noise, most of 1 for detail that the net misses.
pub(in super::super) fn leftover(
    (domain, step): ([[f64; 2]; 2], Step),
    at: &[[f64; 2]],
    residuals: &[f64],
) -> Result<f64, FitError> {
    let finer = Step {
        spans: 2 * step.spans,
        ..step
    };
    let cells = Cells::new(&net(domain, finer, None)?, at);
    let products = |points: &[u32]| -> f64 {
        let pair = |w: &[u32]| residuals[w[0] as usize] * residuals[w[1] as usize];
        points.windows(2).map(pair).sum()
    };
    let pairs: Vec<(f64, usize)> = cells
        .chunks()
        .map(|points| (products(points), points.len() - 1))
        .collect();
    let (sum, count) = pairs.iter().fold((0.0, 0), |(s, n), (p, m)| (s + p, n + m));
    let mean = residuals.iter().map(|r| r * r).sum::<f64>() / residuals.len().max(1) as f64;
    let share = sum / count.max(1) as f64 / mean.max(f64::MIN_POSITIVE);
    // Chance alone gives 1/√count.
    let chance = CHANCE / (count.max(1) as f64).sqrt();
    Ok(if count >= FEWEST_PAIRS && share > chance {
        share
    } else {
        0.0
    })
}

/// The level after a fine enough one whose residuals are not noise.
pub(in super::super) fn beyond(now: Step, leftover: f64) -> Option<Step> {
    (leftover > MISSED && now.spans < MOST && now.space != SPARSE).then(|| Step {
        space: ROUGH,
        spans: (2 * now.spans).min(MOST),
        stretch: 1.0,
        ..now
    })
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

/// The net of a level, cells as square as they can be but for the stretch.
///
/// # Errors
/// [`FitError::Numerical`] for a domain without extent.
pub(in super::super) fn net(
    domain: [[f64; 2]; 2],
    step: Step,
    wanted: Option<[usize; 2]>,
) -> Result<Net, FitError> {
    let degree = step.space.degree;
    let length = domain.map(|[a, b]| b - a);
    let longer = longer(length, step.stretch);
    let scaled = [length[0], step.stretch * length[1]];
    let count = |k: usize| match wanted {
        Some(w) => w[k].saturating_sub(degree).max(1),
        None => ((step.spans as f64 * scaled[k] / longer).round() as usize).max(step.least[k]),
    };
    let knots = |k: usize| {
        Knots::uniform(degree, domain[k], count(k)).map_err(|e| FitError::Numerical(e.to_string()))
    };
    Ok(Net::new([knots(0)?, knots(1)?]))
}

/// Whether a net is not too fine for so many points.
pub(in super::super) fn affordable(net: &Net, points: usize) -> bool {
    net.len() as f64 * POINTS_A_CONTROL <= points as f64
}
