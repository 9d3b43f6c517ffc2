//! Which of the two curvatures leads, and that it keeps its lead.
//!
//! A surface can lose its torsion by becoming as much bent one way as the
//! other: on a sphere every line is a line of curvature. So at every corner of
//! a patch the difference d = κ_u − κ_v shall keep its sign and a share of its
//! size in the start: s = δ − σ d ≤ 0, as the smooth residual (s + √(s² + μ²))/2.
//!
//! Where the start hardly changes sign σ is that of the whole net, which then
//! has no umbilic. Where both signs are at home in the start, some line between
//! them has κ_u = κ_v: each side keeps its own, or, where the shape may go, one
//! sign is asked of all. Where the lines of the start run between its lines of curvature, as those of a
//! hyperbolic paraboloid along its rulings do, none is at home: the net takes
//! one sign, and the other where that ends in umbilics.

use super::edge::vector;
use crate::methods::curvature_net::bend::Bend;
use crate::methods::curvature_net::surface::{Surface, UNKNOWNS, weights};
use crate::solver::Blocks;
use nalgebra::Vector3;
use std::f64::consts::FRAC_PI_8;

/// A corner of a patch with its neighbours along u and v.
#[derive(Debug, Clone, Copy)]
struct Corner {
    /// Vertex, neighbour along u, neighbour along v.
    vertices: [usize; 3],
    /// Widths of the patch, negative where the neighbour lies before.
    widths: [f64; 2],
    /// Square root of the share of the parameters that it stands for.
    root_area: f64,
    sign: f64,
    least: f64,
}

/// The corners that are asked to keep their lead.
pub(super) struct Lead {
    corners: Vec<Corner>,
    weight: f64,
}

/// Weights of a lost lead, its curvature by the mean edge of the first net,
/// where all of the net shall lead alike and where each side keeps its own: the
/// first can be had everywhere, the second not on the way from side to side.
/// They need not grow with the torsion's.
const WEIGHTS: [f64; 2] = [30.0, 3.0];

/// A lead shall keep this share of its size in the start.
const KEPT: f64 = 0.3;
/// And at least this share of the usual one of the net.
const LEAST: f64 = 0.1;
/// With less than this share of the whole difference the other sign is taken
/// for an accident of the start.
const ACCIDENT: f64 = 0.1;
/// A start whose curvatures usually differ by less than this share of
/// themselves is round like a sphere: no sign is at home there.
const ROUND: f64 = 0.3;
/// Lines usually further than this from the lines of curvature, radians, follow
/// neither: half of the most that there is.
const BETWEEN: f64 = FRAC_PI_8;
/// Corners with this much more than they must have are not watched.
const SAFE: f64 = 2.0;
/// Softness of the bound, relative to it.
const SOFT: f64 = 0.1;

/// Whether the lines of a start run between its lines of curvature, so that
/// neither sign of d is at home there.
pub(super) fn has_no_side(start: &Surface) -> bool {
    Rule::of(corners(start).iter().map(|(.., bend)| *bend)).is_between
}

/// Whether one curvature leads all over a start, but for accidents.
pub(super) fn has_one_side(start: &Surface) -> bool {
    let rule = Rule::of(corners(start).iter().map(|(.., bend)| *bend));
    rule.common.is_some() && !rule.is_between
}

/// The curvatures at a corner of a patch; flat where it has no tangent plane.
fn bend_at(surface: &Surface, patch: [usize; 2], corner: [usize; 2]) -> Bend {
    let flat = Bend {
        along: 0.0,
        across: 0.0,
        twist: 0.0,
    };
    Bend::of(&surface.jet(patch, corner.map(|c| c as f64))).unwrap_or(flat)
}

/// Every corner of every patch: patch, place in [`CORNERS`], curvatures.
fn corners(surface: &Surface) -> Vec<([usize; 2], usize, Bend)> {
    let patches = surface.layout().patches();
    patches
        .flat_map(|(i, j)| (0..4).map(move |c| ([i, j], c)))
        .map(|(patch, c)| (patch, c, bend_at(surface, patch, CORNERS[c])))
        .collect()
}

const CORNERS: [[usize; 2]; 4] = [[0, 0], [1, 0], [0, 1], [1, 1]];

impl Lead {
    /// For a level; only corners that are near losing it now.
    pub(super) fn new(start: &Surface, now: &Surface, side: Side) -> Self {
        let all = corners(start);
        let Rule {
            common,
            majority,
            least,
            ..
        } = Rule::of(all.iter().map(|(.., bend)| *bend));
        let common = match side {
            Side::Own => common,
            Side::Majority => Some(majority),
            Side::Minority => Some(-majority),
        };
        let asked = all.iter().filter_map(|(patch, c, bend)| {
            let d = bend.along - bend.across;
            let sign = common.unwrap_or(d.signum());
            let bound = (KEPT * sign * d).max(least);
            // A corner that itself lies between the signs has nothing to keep.
            let at_home = common.is_some() || KEPT * d.abs() >= least;
            let now = bend_at(now, *patch, CORNERS[*c]);
            let at_risk = sign * (now.along - now.across) < SAFE * bound;
            (at_home && at_risk).then(|| corner(start, *patch, *c, (sign, bound)))
        });
        Lead {
            weight: WEIGHTS[usize::from(common.is_none())],
            corners: asked.collect(),
        }
    }

    /// How many corners are watched.
    #[cfg(test)]
    pub(super) fn count(&self) -> usize {
        self.corners.len()
    }

    /// A residual for every corner.
    pub(super) fn residuals(&self, x: &[f64], blocks: &mut Blocks) {
        for corner in &self.corners {
            corner.push(x, self.weight, blocks);
        }
    }
}

/// Which curvature shall lead.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Side {
    /// As in the start: one all over, or each where it leads there.
    Own,
    /// All over the one that leads on most of the start.
    Majority,
    /// All over the other.
    Minority,
}

/// What is asked of a net.
struct Rule {
    /// The sign of d that all corners shall have, if it is one.
    common: Option<f64>,
    /// The sign of d on most of the start.
    majority: f64,
    /// The least d of a corner.
    least: f64,
    /// Whether the lines of the start run between its lines of curvature.
    is_between: bool,
}

impl Rule {
    /// From the curvatures of the start.
    fn of(all: impl Iterator<Item = Bend>) -> Rule {
        let all: Vec<Bend> = all.collect();
        let (mut up, mut down) = (0.0, 0.0);
        for bend in &all {
            up += (bend.along - bend.across).max(0.0);
            down += (bend.across - bend.along).max(0.0);
        }
        // A few wild corners of a coarse start say nothing of its shape.
        let difference = median(all.iter().map(Bend::difference));
        let round = median(all.iter().map(|b| 0.5 * (b.along.abs() + b.across.abs())));
        let is_between = median(all.iter().map(Bend::off_principal)) > BETWEEN;
        let is_accident = up.min(down) <= ACCIDENT * (up + down) || difference <= ROUND * round;
        let majority = if up >= down { 1.0 } else { -1.0 };
        Rule {
            common: (is_accident || is_between).then_some(majority),
            majority,
            least: LEAST * difference.max(ROUND * round),
            is_between,
        }
    }
}

/// The middle one of some values; 0 of none.
fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

fn corner(surface: &Surface, patch: [usize; 2], c: usize, (sign, least): (f64, f64)) -> Corner {
    let layout = surface.layout();
    let here = CORNERS[c];
    let vertex = |at: [usize; 2]| layout.vertex(patch[0] + at[0], patch[1] + at[1]);
    let vertices = [
        vertex(here),
        vertex([1 - here[0], here[1]]),
        vertex([here[0], 1 - here[1]]),
    ];
    let sizes = [0, 1].map(|d| surface.widths()[d][patch[d]]);
    Corner {
        vertices,
        widths: [0, 1].map(|d| if here[d] == 0 { sizes[d] } else { -sizes[d] }),
        root_area: (0.25 * sizes[0] * sizes[1]).sqrt(),
        sign,
        least,
    }
}

/// Places of P, S_u, S_v among a vertex's unknowns.
const SLOPES: [usize; 2] = [3, 6];

impl Corner {
    /// Second derivative along u or v at the vertex, with its weights on the
    /// values of vertex and neighbour and on their slopes. A negative width
    /// looks backwards, where slopes turn their sign and second derivatives
    /// do not.
    fn second(&self, x: &[f64], d: usize) -> (Vector3<f64>, [f64; 4]) {
        let w = weights(0.0, self.widths[d], 2);
        let at = [self.vertices[0], self.vertices[1 + d]].map(|v| v * UNKNOWNS);
        let slope = SLOPES[d];
        let value = vector(x, at[0]) * w[0]
            + vector(x, at[1]) * w[1]
            + vector(x, at[0] + slope) * w[2]
            + vector(x, at[1] + slope) * w[3];
        (value, w)
    }

    fn push(&self, x: &[f64], weight: f64, blocks: &mut Blocks) {
        let at = self.vertices.map(|v| v * UNKNOWNS);
        let slopes = SLOPES.map(|s| vector(x, at[0] + s));
        let normal = slopes[0].cross(&slopes[1]);
        let area = normal.norm();
        let normal = normal / area;
        // The gradient of d by (S_u, S_v), (S_uu, S_vv).
        let mut by_slopes = [Vector3::zeros(); 2];
        let mut d = 0.0;
        let mut seconds = [([0.0; 4], Vector3::zeros()); 2];
        for (k, sign) in [(0, 1.0), (1, -1.0)] {
            let (second, w) = self.second(x, k);
            let square = slopes[k].norm_squared();
            let curvature = second.dot(&normal) / square;
            d += sign * curvature;
            by_slopes[k] -= slopes[k] * (sign * 2.0 * curvature / square);
            // The normal turns with both slopes.
            let tangential = (second - normal * second.dot(&normal)) * (sign / (square * area));
            by_slopes[0] += slopes[1].cross(&tangential);
            by_slopes[1] += tangential.cross(&slopes[0]);
            seconds[k] = (w, normal * (sign / square));
        }
        let lack = self.least - self.sign * d;
        let root = lack.hypot(SOFT * self.least);
        let f = weight * self.root_area;
        let slope = -0.5 * (1.0 + lack / root) * self.sign * f;
        let mut jacobian = [0.0; 21];
        let mut add = |place: usize, v: Vector3<f64>| {
            for k in 0..3 {
                jacobian[place + k] += slope * v[k];
            }
        };
        add(3, by_slopes[0]);
        add(6, by_slopes[1]);
        for (k, (w, by)) in seconds.iter().enumerate() {
            add(0, by * w[0]);
            add(3 + 3 * k, by * w[2]);
            add(9 + 6 * k, by * w[1]);
            add(12 + 6 * k, by * w[3]);
        }
        let columns: [usize; 21] = std::array::from_fn(|c| match c {
            0..9 => at[0] + c,
            9..12 => at[1] + c - 9,
            12..15 => at[1] + SLOPES[0] + c - 12,
            15..18 => at[2] + c - 15,
            _ => at[2] + SLOPES[1] + c - 18,
        });
        blocks.push(&[0.5 * f * (lack + root)], &columns, &jacobian);
    }
}
