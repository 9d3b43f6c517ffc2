//! Twist, clearance and bend radius of a ruled surface.

use crate::geometry::{Axis, BSplineSurface, RuledSurface, RulingJet};
use crate::numerics::GaussLegendre;
use nalgebra::Point3;

/// Nodes a knot span; its ends are looked at besides.
const NODES: usize = 5;
/// Rulings shorter than this share of the longest have no direction.
const SHORT: f64 = 1e-3;
/// An end that moves by less than this share of the other one's speed stands.
const STANDING: f64 = 1e-9;

/// Figures of a ruled surface; angles in radians.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ruled {
    /// Largest |twist|: the angle between the normals at a ruling's ends.
    pub twist_max: f64,
    /// Where: the ruling's parameter.
    pub twist_max_u: f64,
    /// Where: the ruling's middle.
    pub twist_max_at: Point3<f64>,
    /// Mean |twist| weighted by area.
    pub twist_mean: f64,
    /// Least distance of the edge of regression from a ruling, in its lengths,
    /// where both ends move; infinite for a cylinder.
    pub clearance: f64,
    /// Rulings whose ends move in opposite directions: the surface folds.
    pub folds: usize,
    /// Least bend radius across the rulings where both ends move.
    pub bend_radius: f64,
}

/// The surface as one ruled between two opposite edges, with the direction of
/// its rulings: it is linear in that direction. `None` for any other.
#[must_use]
pub fn as_ruled(surface: &BSplineSurface) -> Option<(Axis, RuledSurface)> {
    let (degrees, counts) = (surface.degrees(), surface.counts());
    let [v0, v1, u0, u1] = surface.boundary_curves();
    let linear = |axis: Axis| degrees[axis.index()] == 1 && counts[axis.index()] == 2;
    let (axis, edges) = if linear(Axis::V) {
        (Axis::V, [v0, v1])
    } else if linear(Axis::U) {
        (Axis::U, [u0, u1])
    } else {
        return None;
    };
    let [first, second] = edges;
    let ruled = RuledSurface::new(first, second).ok()?;
    Some((axis, ruled))
}

/// Measures a ruled surface.
#[must_use]
pub fn measure(surface: &RuledSurface) -> Ruled {
    let samples = samples(surface);
    let longest = samples.iter().map(|s| s.jet.direction().norm());
    let longest = longest.fold(0.0, f64::max);
    let [start, _] = surface.domain();
    let mut ruled = Ruled {
        twist_max: 0.0,
        twist_max_u: start,
        twist_max_at: surface.point(start, 0.5),
        twist_mean: 0.0,
        clearance: f64::INFINITY,
        folds: 0,
        bend_radius: f64::INFINITY,
    };
    let mut whole = 0.0;
    for Sample { u, jet, weight } in &samples {
        if jet.direction().norm() <= SHORT * longest {
            continue;
        }
        let [n1, n2] = jet.end_normals();
        let (h1, h2) = (n1.norm(), n2.norm());
        let twist = if h1.min(h2) <= STANDING * h1.max(h2) {
            0.0
        } else {
            ruled.clearance = ruled.clearance.min(jet.clearance());
            ruled.folds += usize::from(n1.dot(&n2) < 0.0);
            for v in [0.0, 0.5, 1.0] {
                let bend = jet.bend_curvature(v).map_or(0.0, f64::abs);
                ruled.bend_radius = ruled.bend_radius.min(bend.recip());
            }
            jet.twist().abs()
        };
        let area = (n1 + n2).norm() * weight;
        whole += area;
        ruled.twist_mean += twist * area;
        if twist > ruled.twist_max {
            (ruled.twist_max, ruled.twist_max_u) = (twist, *u);
            ruled.twist_max_at = jet.first.point + jet.direction() * 0.5;
        }
    }
    if whole > 0.0 {
        ruled.twist_mean /= whole;
    }
    ruled
}

struct Sample {
    u: f64,
    jet: RulingJet,
    /// 0 at the ends of spans, which count for no area.
    weight: f64,
}

fn samples(surface: &RuledSurface) -> Vec<Sample> {
    let mut knots = surface.first().knot_vector().breakpoints();
    knots.extend(surface.second().knot_vector().breakpoints());
    knots.sort_by(f64::total_cmp);
    knots.dedup();
    let rule = GaussLegendre::new(NODES);
    let mut samples = Vec::with_capacity(knots.len() * (NODES + 2));
    for span in knots.windows(2) {
        let at_end = |u: f64, jet: RulingJet| Sample {
            u,
            jet,
            weight: 0.0,
        };
        samples.push(at_end(span[0], surface.ruling(span[0])));
        samples.extend(rule.on(span[0], span[1]).map(|(u, weight)| Sample {
            u,
            jet: surface.ruling(u),
            weight,
        }));
        samples.push(at_end(span[1], surface.ruling_left(span[1])));
    }
    samples
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::BSplineCurve;
    use crate::geometry::conformance::samples::quarter_circle;
    use nalgebra::{Vector3, point};
    use std::f64::consts::FRAC_PI_4;

    #[test]
    fn a_hypar_twists_by_an_eighth_of_a_turn_at_its_edge() {
        let line = |a, b| BSplineCurve::line(a, b, 1).unwrap();
        let hypar = RuledSurface::new(
            line(point![0., 0., 0.], point![1., 0., 0.]),
            line(point![0., 1., 0.], point![1., 1., 1.]),
        );
        let (axis, again) = as_ruled(&hypar.unwrap().to_bspline().unwrap()).unwrap();
        let ruled = measure(&again);
        assert_eq!(axis, Axis::V);
        assert!((ruled.twist_max - FRAC_PI_4).abs() < 1e-12);
        assert_eq!(ruled.twist_max_u, 0.0);
        assert!(ruled.twist_mean > 0.5 && ruled.twist_mean < ruled.twist_max);
        assert_eq!(ruled.folds, 0);
    }

    #[test]
    fn a_cone_has_its_clearance_whatever_its_direction() {
        let arc = quarter_circle(1.0).translated(&Vector3::new(0., 0., -1.0));
        let cone = RuledSurface::new(arc, quarter_circle(2.0)).unwrap();
        let surface = cone.to_bspline().unwrap();
        for turned in [false, true] {
            let surface = if turned {
                transposed(&surface)
            } else {
                surface.clone()
            };
            let (axis, again) = as_ruled(&surface).unwrap();
            assert_eq!(axis == Axis::U, turned);
            let ruled = measure(&again);
            assert!(ruled.twist_max < 1e-12);
            assert!((ruled.clearance - 1.0).abs() < 1e-9);
            assert!((ruled.bend_radius - 2f64.sqrt()).abs() < 1e-9);
        }
    }

    fn transposed(s: &BSplineSurface) -> BSplineSurface {
        let [n, m] = s.counts();
        let order: Vec<usize> = (0..m)
            .flat_map(|j| (0..n).map(move |i| i * m + j))
            .collect();
        let points = order.iter().map(|k| s.control_points()[*k]).collect();
        let weights = s.weights().map(|w| order.iter().map(|k| w[*k]).collect());
        let [p, q] = s.degrees();
        let [a, b] = s.knots().clone();
        BSplineSurface::new([q, p], [b, a], points, weights).unwrap()
    }

    #[test]
    fn a_curved_surface_is_not_ruled() {
        let arc = quarter_circle(1.0).translated(&Vector3::new(0., 0., -1.0));
        let cone = RuledSurface::new(arc, quarter_circle(2.0)).unwrap();
        let curved = cone.to_bspline().unwrap().elevated(Axis::V).unwrap();
        assert!(as_ruled(&curved).is_none());
    }
}
