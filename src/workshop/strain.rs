//! The flat pattern against the surface: lengths in a net of small fields, and
//! areas.

use super::development::Development;
use crate::geometry::RulingJet;
use crate::numerics::GaussLegendre;
use nalgebra::{Point2, Point3};

/// Steps along the rulings: quarters, and places between them.
const ACROSS: usize = 8;
/// Lengths below this share of the size are not compared: rounding.
const TOO_SHORT: f64 = 1e-9;
/// Nodes along and across each step of an area.
const NODES: usize = 4;

/// Largest differences of lengths between pattern and surface, as shares of
/// the length on the surface, without sign.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Strain {
    /// Along the two boundaries.
    pub edges: f64,
    /// Along the rulings.
    pub rulings: f64,
    /// In between, from ruling to ruling.
    pub middle: f64,
    /// Along both diagonals of the small fields.
    pub diagonals: f64,
}

/// Compares the lines between neighbouring places of a net, each with a place
/// between them: at fine steps along the boundaries and at quarters of the
/// rulings.
pub(super) fn measure(development: &Development<'_>, fields: &[f64], size: f64) -> Strain {
    let rows: Vec<Row> = (fields.windows(2))
        .flat_map(|w| [w[0], 0.5 * (w[0] + w[1])])
        .chain(fields.last().copied())
        .map(|u| row(development, u))
        .collect();
    let mut strain = Strain::default();
    for three in rows.windows(3).step_by(2) {
        let difference = |k: [usize; 3]| {
            let places = [0, 1, 2].map(|i| three[i][k[i]]);
            difference(&places, TOO_SHORT * size)
        };
        for k in (0..=ACROSS).step_by(2) {
            let along = difference([k; 3]);
            let place = if k == 0 || k == ACROSS {
                &mut strain.edges
            } else {
                &mut strain.middle
            };
            *place = place.max(along);
            if k < ACROSS {
                let both = difference([k, k + 1, k + 2]).max(difference([k + 2, k + 1, k]));
                strain.diagonals = strain.diagonals.max(both);
            }
        }
        let [from, middle, to] = [0, ACROSS / 2, ACROSS].map(|k| three[0][k]);
        let ruling = self::difference(&[from, middle, to], TOO_SHORT * size);
        strain.rulings = strain.rulings.max(ruling);
    }
    strain
}

/// Places on the plate and in the plane along one ruling.
type Row = [(Point3<f64>, Point2<f64>); ACROSS + 1];

fn row(development: &Development<'_>, u: f64) -> Row {
    let surface = development.surface();
    let line = development.ruling(u);
    let (a, b) = (surface.first().point(u), surface.second().point(u));
    std::array::from_fn(|k| {
        let v = k as f64 / ACROSS as f64;
        (a + (b - a) * v, line.from + (line.to - line.from) * v)
    })
}

/// Difference of a line's lengths in the plane and on the plate, as a share of
/// the latter; 0 for lines that are too short. From chords of two steps and of
/// one, so that the bend of the line cancels to the fourth order (Richardson).
fn difference(places: &[(Point3<f64>, Point2<f64>); 3], too_short: f64) -> f64 {
    let [(p, a), (q, b), (r, c)] = places;
    let length = |halves: f64, whole: f64| (4.0 * halves - whole) / 3.0;
    let plate = length((q - p).norm() + (r - q).norm(), (r - p).norm());
    let plane = length((b - a).norm() + (c - b).norm(), (c - a).norm());
    if plate <= too_short {
        0.0
    } else {
        (plane / plate - 1.0).abs()
    }
}

/// The share by which the middle of a ruling is shorter across than in the
/// pattern: `1 − |n₁ + n₂| / (|n₁| + |n₂|)`, θ²/8 for equal ends.
pub(super) fn across(jet: &RulingJet) -> f64 {
    let [n1, n2] = jet.end_normals();
    let flat = n1.norm() + n2.norm();
    if flat > 0.0 {
        1.0 - (n1 + n2).norm() / flat
    } else {
        0.0
    }
}

/// Area of the surface.
pub(super) fn surface_area(development: &Development<'_>, fields: &[f64]) -> f64 {
    let rule = GaussLegendre::new(NODES);
    let surface = development.surface();
    (fields.windows(2))
        .map(|w| {
            rule.integrate(w[0], w[1], |u| {
                let [n1, n2] = surface.ruling(u).end_normals();
                rule.integrate(0.0, 1.0, |v| n1.lerp(&n2, v).norm())
            })
        })
        .sum()
}
