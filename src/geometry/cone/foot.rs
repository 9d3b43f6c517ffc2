//! The foot of a point on the surface that a frame sweeps, in closed form.
//!
//! With (X, Y, Z) the point in the frame, D = 1 + gX − kZ, S = √(D² + W²Y²) and
//! Q = Y²/(S + D): the distance is Z − kQ, the foot has λ = X + gQ and the arc
//! atan2(WY, D)/W.

use super::{Frame, Strain};
use nalgebra::{Point3, Vector3};
use std::f64::consts::TAU;

/// The nearest place on a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Foot {
    /// Signed distance, positive on the side of the frame's normal.
    pub distance: f64,
    /// Place along the ruling.
    pub lambda: f64,
    /// Arc length along the base line to the ruling, from the frame.
    pub arc: f64,
}

/// What a distance depends on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FootDerivatives {
    /// The signed distance.
    pub distance: f64,
    /// The surface's normal at the foot: a motion of the surface with the
    /// velocity v at the point changes the distance at the rate −n·v.
    pub normal: Vector3<f64>,
    /// By g, with the frame held.
    pub by_g: f64,
    /// By k, with the frame held.
    pub by_k: f64,
}

/// D, S and Q of a point, and W.
struct Parts {
    d: f64,
    s: f64,
    q: f64,
    rate: f64,
}

impl Parts {
    fn new(strain: Strain, local: &Vector3<f64>) -> Self {
        let rate = strain.rate();
        let d = 1.0 + strain.g * local.x - strain.k * local.z;
        let s = d.hypot(rate * local.y);
        let q = if d > 0.0 {
            local.y * local.y / (s + d)
        } else {
            (s - d) / (rate * rate)
        };
        Parts { d, s, q, rate }
    }

    /// Arc of the foot, the one of the turns nearest to `near`.
    fn arc(&self, y: f64, near: f64) -> f64 {
        /// Below this share the series of the arc tangent is exact to rounding.
        const SMALL: f64 = 1e-3;
        let across = self.rate * y;
        if self.d > 0.0 && across.abs() < SMALL * self.d {
            let share = (across / self.d).powi(2);
            let first = y / self.d * (1.0 - share / 3.0 + share * share / 5.0);
            return self.wrapped(first, near);
        }
        self.wrapped(across.atan2(self.d) / self.rate, near)
    }

    fn wrapped(&self, arc: f64, near: f64) -> f64 {
        let turns = ((near - arc) * self.rate / TAU).round();
        if turns == 0.0 {
            arc
        } else {
            arc + turns * TAU / self.rate
        }
    }
}

impl Foot {
    /// The foot of a point; among several turns of a long surface the one
    /// whose arc is nearest to `near`.
    #[must_use]
    pub fn of(point: &Point3<f64>, frame: &Frame, strain: Strain, near: f64) -> Self {
        let local = frame.local(point);
        let parts = Parts::new(strain, &local);
        Foot {
            distance: local.z - strain.k * parts.q,
            lambda: local.x + strain.g * parts.q,
            arc: parts.arc(local.y, near),
        }
    }
}

impl FootDerivatives {
    /// The distance of a point with its derivatives.
    #[must_use]
    pub fn of(point: &Point3<f64>, frame: &Frame, strain: Strain) -> Self {
        let local = frame.local(point);
        let Strain { g, k } = strain;
        let Parts { d, s, q, .. } = Parts::new(strain, &local);
        let (x, y, z) = (local.x, local.y, local.z);
        let normal = Vector3::new(k * g * q, -k * y, d + g * g * q) / s;
        let factor = -q / (s + d);
        let q_by_g = factor * ((d * x + g * y * y) / s + x);
        let q_by_k = factor * ((k * y * y - d * z) / s - z);
        FootDerivatives {
            distance: z - k * q,
            normal: frame.vector(&normal),
            by_g: -k * q_by_g,
            by_k: -q - k * q_by_k,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame() -> Frame {
        let f = Frame::new(
            Point3::new(0.3, -0.2, 0.5),
            Vector3::new(0.2, 1.0, 0.4),
            Vector3::new(-0.7, 0.1, 0.9),
        );
        f.expect("not parallel")
    }

    const STRAINS: [(f64, f64); 6] = [
        (0.5, 1.5),
        (0.0, 0.0),
        (0.0, 1.4),
        (-0.6, 0.0),
        (1e-9, -1e-9),
        (0.4, -2.6),
    ];

    /// A point with a known foot.
    fn beside(strain: Strain, [arc, lambda, distance]: [f64; 3]) -> Point3<f64> {
        let there = frame().carried(strain, arc);
        there.at(lambda) + distance * there.normal
    }

    const FEET: [[f64; 3]; 4] = [
        [0.4, 0.2, 0.1],
        [-0.9, -0.3, -0.05],
        [0.0, 0.1, 0.02],
        [1e-9, 0.0, 1e-9],
    ];

    #[test]
    fn a_point_finds_the_foot_that_it_was_built_from() {
        for (g, k) in STRAINS {
            for [arc, lambda, distance] in FEET {
                let strain = Strain { g, k };
                let x = beside(strain, [arc, lambda, distance]);
                let foot = Foot::of(&x, &frame(), strain, 0.0);
                assert!((foot.distance - distance).abs() < 1e-14, "{foot:?}");
                assert!((foot.lambda - lambda).abs() < 1e-14, "{foot:?}");
                assert!((foot.arc - arc).abs() < 1e-14, "{foot:?}");
            }
        }
    }

    #[test]
    fn the_turn_is_the_one_that_is_near() {
        let strain = Strain { g: 0.4, k: -2.6 };
        let arc = 1.3 * TAU / strain.rate();
        let x = beside(strain, [arc, 0.1, 0.02]);
        let foot = Foot::of(&x, &frame(), strain, arc + 0.2);
        assert!((foot.arc - arc).abs() < 1e-13, "{foot:?}");
    }

    #[test]
    fn derivatives_agree_with_differences() {
        let h = 1e-6;
        for (g, k) in STRAINS {
            for place in FEET {
                let x = beside(Strain { g, k }, place);
                let d = FootDerivatives::of(&x, &frame(), Strain { g, k });
                let at = |g, k| Foot::of(&x, &frame(), Strain { g, k }, 0.0).distance;
                let by_g = (at(g + h, k) - at(g - h, k)) / (2.0 * h);
                let by_k = (at(g, k + h) - at(g, k - h)) / (2.0 * h);
                assert!((d.by_g - by_g).abs() < 1e-9, "{d:?} {by_g}");
                assert!((d.by_k - by_k).abs() < 1e-9, "{d:?} {by_k}");
                let there = frame().carried(Strain { g, k }, place[0]);
                assert!((d.normal - there.normal).norm() < 1e-13);
            }
        }
    }
}
