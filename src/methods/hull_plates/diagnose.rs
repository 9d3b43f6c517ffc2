//! What a plate is worth, measured on the delivered surface alone.

use super::deliver::FanRange;
use super::outcome::Ruling;
use crate::geometry::{RuledSurface, RulingJet};
use nalgebra::Point3;

/// Figures of one plate that follow from its surface and its fans, in the
/// surface's own unit; angles in radians.
#[derive(Debug, Clone)]
pub(super) struct Measured {
    pub(super) twist_max: f64,
    pub(super) twist_max_u: f64,
    pub(super) twist_max_at: Point3<f64>,
    pub(super) twist_mean: f64,
    pub(super) twist_p95: f64,
    pub(super) clearance: f64,
    pub(super) crossing: usize,
    pub(super) bend_radius: f64,
    pub(super) bend_radius_u: f64,
    pub(super) gaussian_max: f64,
    pub(super) area: f64,
}

/// Rulings looked at in each knot span, both its ends included.
const PER_SPAN: usize = 7;
/// Rulings of the table, per unit of u.
const TABLE: usize = 120;
/// Table rulings nearer than this in u are one.
const APART: f64 = 1e-4;
/// Rulings shorter than this share of the longest have no direction.
const SHORT: f64 = 1e-3;

/// Measures a plate.
pub(super) fn measure(surface: &RuledSurface, fans: &[FanRange]) -> Measured {
    let samples = samples(surface, fans);
    let longest = samples
        .iter()
        .map(|s| s.jet.direction().norm())
        .fold(0.0, f64::max);
    let first = &samples[0];
    let mut m = Measured {
        twist_max: 0.0,
        twist_max_u: first.u,
        twist_max_at: first.middle(),
        twist_mean: 0.0,
        twist_p95: 0.0,
        clearance: f64::INFINITY,
        crossing: 0,
        bend_radius: f64::INFINITY,
        bend_radius_u: first.u,
        gaussian_max: 0.0,
        area: 0.0,
    };
    let mut by_area: Vec<(f64, f64)> = Vec::with_capacity(samples.len());
    for sample in &samples {
        let twist = if sample.in_fan {
            0.0
        } else {
            sample.jet.twist().abs()
        };
        if sample.jet.direction().norm() <= SHORT * longest {
            continue;
        }
        m.area += sample.area;
        by_area.push((twist, sample.area));
        if twist > m.twist_max {
            (m.twist_max, m.twist_max_u, m.twist_max_at) = (twist, sample.u, sample.middle());
        }
        if !sample.in_fan {
            m.look_at(sample);
        }
    }
    (m.twist_mean, m.twist_p95) = mean_and_p95(&mut by_area);
    m
}

/// Table rulings: even in u, with joins of fans.
pub(super) fn table(surface: &RuledSurface, fans: &[FanRange]) -> Vec<Ruling> {
    let mut places: Vec<f64> = (0..=TABLE).map(|i| i as f64 / TABLE as f64).collect();
    for join in fans.iter().flat_map(|f| f.range) {
        places.retain(|u| (u - join).abs() > APART || *u == 0.0 || *u == 1.0);
        places.push(join);
    }
    places.sort_by(f64::total_cmp);
    places.dedup();
    places
        .into_iter()
        .map(|u| ruling(surface, fans, u))
        .collect()
}

fn ruling(surface: &RuledSurface, fans: &[FanRange], u: f64) -> Ruling {
    // At a join the plate's side counts.
    let starts = fans.iter().any(|f| !f.at_start && u == f.range[0]);
    let jet = if starts {
        surface.ruling_left(u)
    } else {
        surface.ruling(u)
    };
    let fan = fans.iter().find(|f| u >= f.range[0] && u <= f.range[1]);
    let inside = fan.filter(|f| u != f.range[usize::from(f.at_start)]);
    // The apex of a cone has no radius, and none of its rulings a twist.
    let radius = |v: f64, apex: bool| match jet.bend_curvature(v) {
        Some(k) if k != 0.0 && !apex => 1.0 / k,
        Some(_) if !apex => f64::INFINITY,
        _ => 0.0,
    };
    let apex = |first: bool| inside.is_some_and(|f| f.apex_on_first == first && f.extension == 0.0);
    let (mut from, mut to) = (jet.first.point, jet.second.point);
    if let Some(f) = fan.filter(|f| f.extension == 0.0) {
        // The corner itself, free of the needle that makes the cone.
        let corner = surface.ruling(f.range[usize::from(f.at_start)]);
        if f.apex_on_first {
            from = corner.first.point
        } else {
            to = corner.second.point
        }
    }
    Ruling {
        u,
        from,
        to,
        twist_deg: if inside.is_some() {
            0.0
        } else {
            jet.twist().to_degrees()
        },
        bend_radius_from: radius(0.0, apex(true)),
        bend_radius_to: radius(1.0, apex(false)),
    }
}

struct Sample {
    u: f64,
    jet: RulingJet,
    area: f64,
    in_fan: bool,
}

impl Sample {
    fn middle(&self) -> Point3<f64> {
        self.jet.first.point + self.jet.direction() * 0.5
    }
}

/// Samples of every knot span with trapezoidal shares of the area.
fn samples(surface: &RuledSurface, fans: &[FanRange]) -> Vec<Sample> {
    let mut knots = surface.first().knot_vector().breakpoints();
    knots.extend(surface.second().knot_vector().breakpoints());
    knots.sort_by(f64::total_cmp);
    knots.dedup();
    let mut samples = Vec::with_capacity(knots.len() * PER_SPAN);
    for span in knots.windows(2) {
        let middle = 0.5 * (span[0] + span[1]);
        let in_fan = fans
            .iter()
            .any(|f| middle > f.range[0] && middle < f.range[1]);
        let step = (span[1] - span[0]) / (PER_SPAN - 1) as f64;
        for i in 0..PER_SPAN {
            let last = i + 1 == PER_SPAN;
            let u = if last {
                span[1]
            } else {
                span[0] + step * i as f64
            };
            let jet = if last {
                surface.ruling_left(u)
            } else {
                surface.ruling(u)
            };
            let [n1, n2] = jet.end_normals();
            let share = if i == 0 || last { 0.5 * step } else { step };
            // Simpson's rule along the ruling, the trapezoid's across.
            let middle = (n1 + n2) * 0.5;
            let area = (n1.norm() + 4.0 * middle.norm() + n2.norm()) / 6.0 * share;
            samples.push(Sample {
                u,
                jet,
                area,
                in_fan,
            });
        }
    }
    samples
}

impl Measured {
    /// Clearance, crossings, bending and curvature at a ruling outside fans.
    fn look_at(&mut self, sample: &Sample) {
        let jet = &sample.jet;
        let clearance = jet.clearance();
        self.clearance = self.clearance.min(clearance);
        let [n1, n2] = jet.end_normals();
        if n1.dot(&n2) < 0.0 {
            self.crossing += 1;
        }
        for v in [0.0, 0.5, 1.0] {
            let Some(forms) = jet.fundamental_forms(v) else {
                continue;
            };
            self.gaussian_max = self.gaussian_max.max(forms.gaussian_curvature().abs());
            let radius = forms.curvature_across_v().abs().recip();
            if radius < self.bend_radius {
                (self.bend_radius, self.bend_radius_u) = (radius, sample.u);
            }
        }
    }
}

fn mean_and_p95(by_area: &mut [(f64, f64)]) -> (f64, f64) {
    let total: f64 = by_area.iter().map(|e| e.1).sum();
    if total <= 0.0 {
        return (0.0, 0.0);
    }
    let mean = by_area.iter().map(|(t, a)| t * a).sum::<f64>() / total;
    by_area.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut seen = 0.0;
    let p95 = by_area.iter().find(|(_, a)| {
        seen += a;
        seen >= 0.95 * total
    });
    (mean, p95.map_or(0.0, |e| e.0))
}
