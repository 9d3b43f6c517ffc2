//! Curvatures of the surface as seen from the lines of the net.

use crate::geometry::SurfaceJet;

/// The second fundamental form in the frame of the line along u, its normal in
/// the tangent plane, and N along S_u × S_v.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Bend {
    /// Normal curvature along the line in u.
    pub(super) along: f64,
    /// Normal curvature square to it.
    pub(super) across: f64,
    /// Its geodesic torsion.
    pub(super) twist: f64,
}

impl Bend {
    /// At a place of a surface; `None` where the lines are parallel there.
    pub(super) fn of(jet: &SurfaceJet) -> Option<Bend> {
        let normal = jet.normal()?;
        let along = jet.du.norm();
        let [e, f] = [
            jet.du.dot(&jet.dv) / along,
            jet.du.cross(&jet.dv).norm() / along,
        ];
        let second = [jet.duu, jet.duv, jet.dvv].map(|d| d.dot(&normal));
        // S_v = e T + f B in the orthonormal frame T, B.
        let tt = second[0] / (along * along);
        let tb = (second[1] / along - e * tt) / f;
        let bb = (second[2] - e * e * tt - 2.0 * e * f * tb) / (f * f);
        Some(Bend {
            along: tt,
            across: bb,
            twist: tb,
        })
    }

    /// |κ₁ − κ₂|.
    pub(super) fn difference(&self) -> f64 {
        (self.along - self.across).hypot(2.0 * self.twist)
    }

    /// Angle between the line and the nearest line of curvature, radians, in
    /// [0, π/4].
    pub(super) fn off_principal(&self) -> f64 {
        0.5 * (2.0 * self.twist)
            .abs()
            .atan2((self.along - self.across).abs())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Point3, Vector3};

    /// z = ½ (a x² + 2 b x y + c y²) seen along skew lines.
    #[test]
    fn curvatures_do_not_depend_on_the_lines() {
        let (a, b, c) = (0.7, 0.2, -0.4);
        let seen = |u: [f64; 2], v: [f64; 2]| {
            let height = |p: [f64; 2], q: [f64; 2]| {
                Vector3::z() * (a * p[0] * q[0] + b * (p[0] * q[1] + p[1] * q[0]) + c * p[1] * q[1])
            };
            Bend::of(&SurfaceJet {
                point: Point3::origin(),
                du: Vector3::new(u[0], u[1], 0.0),
                dv: Vector3::new(v[0], v[1], 0.0),
                duu: height(u, u),
                duv: height(u, v),
                dvv: height(v, v),
            })
        };
        let straight = seen([1.0, 0.0], [0.0, 1.0]).expect("a frame");
        assert!((straight.twist - b).abs() < 1e-15);
        let skew = seen([2.0, 1.0], [-0.3, 1.5]).expect("a frame");
        assert!((skew.difference() - straight.difference()).abs() < 1e-12);
        assert!((skew.along + skew.across - a - c).abs() < 1e-12);
        // Turned onto the line of curvature, the line has no torsion.
        let angle = 0.5 * (2.0 * b).atan2(a - c);
        let (sin, cos) = angle.sin_cos();
        let principal = seen([cos, sin], [-sin, cos]).expect("a frame");
        assert!(principal.off_principal() < 1e-12);
        assert!((straight.off_principal() - angle).abs() < 1e-12);
    }
}
