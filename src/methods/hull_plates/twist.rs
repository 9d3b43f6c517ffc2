//! Twist and clearance of one ruling, with their derivatives.
//!
//! The twist θ is the angle between the surface normals L×D₁′ and L×D₂′ at
//! the two ends of a ruling L = D₂ − D₁ (Zheng & Bo 2018, eq. 3), here in a
//! signed and smooth form:
//!
//! ```text
//! θ = atan2(a, b),  a = |L| det(L, D₁′, D₂′),  b = (L×D₁′)·(L×D₂′)
//! dθ = (b da − a db) / (a² + b²)
//! ```
//!
//! The distance of the regression curve follows from the speeds of the two
//! ruling ends across the ruling, h₁ = |L×D₁′| and h₂ = |L×D₂′|: along the
//! ruling the speed is (1−v) h₁ + v h₂, so it vanishes at v = h₁ / (h₁ − h₂),
//! which lies `c` ruling lengths outside [0, 1] when h₂ / h₁ = 1 + 1/c or its
//! inverse.

use nalgebra::Vector3;

/// Gradient of a figure of a ruling with respect to L, D₁′ and D₂′.
#[derive(Debug, Clone, Copy)]
pub(super) struct RulingGradient {
    pub(super) by_ruling: Vector3<f64>,
    pub(super) by_first: Vector3<f64>,
    pub(super) by_second: Vector3<f64>,
}

impl RulingGradient {
    pub(super) fn zero() -> Self {
        let zero = Vector3::zeros();
        RulingGradient {
            by_ruling: zero,
            by_first: zero,
            by_second: zero,
        }
    }

    pub(super) fn scaled(&self, factor: f64) -> Self {
        RulingGradient {
            by_ruling: self.by_ruling * factor,
            by_first: self.by_first * factor,
            by_second: self.by_second * factor,
        }
    }
}

/// θ and its gradient.
#[derive(Debug, Clone, Copy)]
pub(super) struct Twist {
    pub(super) angle: f64,
    pub(super) gradient: RulingGradient,
}

/// Signed twist of a ruling, radians.
pub(super) fn twist_angle(l: &Vector3<f64>, t1: &Vector3<f64>, t2: &Vector3<f64>) -> f64 {
    let a = l.norm() * l.dot(&t1.cross(t2));
    let b = l.norm_squared() * t1.dot(t2) - l.dot(t1) * l.dot(t2);
    a.atan2(b)
}

/// Signed twist with its gradient; zero gradient where θ is not defined (a
/// ruling without length, or along both curves).
pub(super) fn twist(l: &Vector3<f64>, t1: &Vector3<f64>, t2: &Vector3<f64>) -> Twist {
    let (length2, lt1, lt2) = (l.norm_squared(), l.dot(t1), l.dot(t2));
    let length = length2.sqrt();
    let t12 = t1.cross(t2);
    let det = l.dot(&t12);
    let a = length * det;
    let b = length2 * t1.dot(t2) - lt1 * lt2;
    let square = a * a + b * b;
    if square <= f64::MIN_POSITIVE {
        return Twist {
            angle: 0.0,
            gradient: RulingGradient::zero(),
        };
    }
    let (wa, wb) = (b / square, -a / square);
    let da_ruling = t12 * length + l * (det / length);
    let db_ruling = l * (2.0 * t1.dot(t2)) - t2 * lt1 - t1 * lt2;
    let gradient = RulingGradient {
        by_ruling: da_ruling * wa + db_ruling * wb,
        by_first: t2.cross(l) * (length * wa) + (t2 * length2 - l * lt2) * wb,
        by_second: l.cross(t1) * (length * wa) + (t1 * length2 - l * lt1) * wb,
    };
    Twist {
        angle: a.atan2(b),
        gradient,
    }
}

/// ln(|L×D₁′| / |L×D₂′|) with its gradient; bounded where a ruling runs along
/// a curve.
pub(super) fn log_speed_ratio(
    l: &Vector3<f64>,
    t1: &Vector3<f64>,
    t2: &Vector3<f64>,
) -> (f64, RulingGradient) {
    let (n1, n2) = (l.cross(t1), l.cross(t2));
    let floor = |n: &Vector3<f64>, t: &Vector3<f64>| {
        n.norm_squared()
            .max(ALONG * ALONG * l.norm_squared() * t.norm_squared())
    };
    let (s1, s2) = (floor(&n1, t1), floor(&n2, t2));
    let gradient = RulingGradient {
        by_ruling: t1.cross(&n1) / s1 - t2.cross(&n2) / s2,
        by_first: n1.cross(l) / s1,
        by_second: -n2.cross(l) / s2,
    };
    (0.5 * (s1 / s2).ln(), gradient)
}

/// Sine of the angle between ruling and curve below which the ruling counts
/// as running along the curve.
const ALONG: f64 = 1e-9;

/// The ratio of speeds at which the regression curve lies `clearance` ruling
/// lengths outside.
pub(super) fn ratio_of_clearance(clearance: f64) -> f64 {
    1.0 + 1.0 / clearance
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_dual::{DualNum, gradient};

    fn vectors(x: &[f64]) -> [Vector3<f64>; 3] {
        [0, 3, 6].map(|i| Vector3::new(x[i], x[i + 1], x[i + 2]))
    }

    fn generic<D: DualNum<Primitive = f64> + Copy>(x: &[D]) -> D {
        let cross = |a: [D; 3], b: [D; 3]| {
            [
                a[1] * b[2] - a[2] * b[1],
                a[2] * b[0] - a[0] * b[2],
                a[0] * b[1] - a[1] * b[0],
            ]
        };
        let dot = |a: [D; 3], b: [D; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let (l, t1, t2) = ([x[0], x[1], x[2]], [x[3], x[4], x[5]], [x[6], x[7], x[8]]);
        let a = dot(l, l).sqrt() * dot(l, cross(t1, t2));
        a.atan2(dot(cross(l, t1), cross(l, t2)))
    }

    #[test]
    fn gradient_agrees_with_dual_numbers() {
        let mut state = 7_u64;
        let mut random = || {
            state = state
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        for _ in 0..200 {
            let x: Vec<f64> = (0..9).map(|_| random()).collect();
            let [l, t1, t2] = vectors(&x);
            let ours = twist(&l, &t1, &t2);
            let (angle, exact) = gradient(
                |v| generic(v.as_slice()),
                &nalgebra::SVector::<f64, 9>::from_column_slice(&x),
            );
            assert!((ours.angle - angle).abs() < 1e-12);
            assert!((ours.angle - twist_angle(&l, &t1, &t2)).abs() < 1e-12);
            for (k, ours) in [
                ours.gradient.by_ruling,
                ours.gradient.by_first,
                ours.gradient.by_second,
            ]
            .iter()
            .enumerate()
            {
                for c in 0..3 {
                    let exact = exact[3 * k + c];
                    assert!((ours[c] - exact).abs() < 1e-8 * (1.0 + exact.abs()));
                }
            }
        }
    }

    #[test]
    fn a_hypar_ruling_turns_its_normal_by_the_known_angle() {
        // z = xy over the unit square: at x = 0 the normals at y = 0 and y = 1
        // are (0,0,1) and (-1,0,1)/√2.
        let l = Vector3::new(0.0, 1.0, 0.0);
        let angle = twist_angle(
            &l,
            &Vector3::new(1.0, 0.0, 0.0),
            &Vector3::new(1.0, 0.0, 1.0),
        );
        assert!((angle.abs() - std::f64::consts::FRAC_PI_4).abs() < 1e-15);
    }

    #[test]
    fn a_clearance_of_a_seventh_allows_a_ratio_of_eight() {
        assert!((ratio_of_clearance(1.0 / 7.0) - 8.0).abs() < 1e-12);
    }
}
