//! A cone of revolution as the paper writes it (sec. 2.2.3): M on the axis, V
//! along it, θ between rulings and axis, d from M to every ruling.
//!
//! θ itself is the unknown, not ω = cos θ: √(1 − ω²) of the paper's second
//! distance has no derivative at a cylinder. With V·L > 0 for the direction L
//! of the rulings (from side 1 to side 0), θ > 0 puts the apex ahead along V,
//! θ < 0 behind, θ = 0 is a cylinder; the distance of M + c V from the rulings
//! is d − c sin θ for all.

use super::axes::Axis;
use super::clusters::mean_axis;
use super::ruled::Ruled;
use nalgebra::{Point3, Unit, Vector3};

/// Numbers of a cone among the unknowns: M, V, θ, d.
pub(super) const NUMBERS: usize = 8;

/// M, V, θ, d.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Cone {
    pub(super) point: Point3<f64>,
    /// Not of unit length where it is an unknown.
    pub(super) along: Vector3<f64>,
    pub(super) angle: f64,
    pub(super) distance: f64,
}

impl Cone {
    /// From the axes of a region and its rulings: the mean axis, the point of
    /// it nearest to the middle of the region, mean angle and distance.
    pub(super) fn near(axes: &[Axis], surface: &Ruled) -> Cone {
        let [direction, moment] = mean_axis(axes);
        let size = direction.norm().max(f64::MIN_POSITIVE);
        let [direction, moment] = [direction / size, moment / size];
        let rulings: Vec<[Point3<f64>; 2]> = axes.iter().map(|a| surface.ruling(a.u)).collect();
        let count = rulings.len() as f64;
        let lines = || {
            rulings
                .iter()
                .map(|[a, b]| (*a, Unit::new_normalize(a - b).into_inner()))
        };
        let mean = lines().map(|(_, l)| l).sum::<Vector3<f64>>();
        let along = direction * 1.0_f64.copysign(direction.dot(&mean));
        let middle = rulings
            .iter()
            .map(|[a, b]| (a.coords + b.coords) * 0.5)
            .sum::<Vector3<f64>>()
            / count;
        let foot = direction.cross(&moment);
        let point = Point3::from(foot + along * (middle - foot).dot(&along));
        let distance = lines()
            .map(|(p, l)| (point - p).cross(&l).norm())
            .sum::<f64>()
            / count;
        // The rulings' slope against the axis, with the sign of the side on
        // which they come nearer to it.
        let slope = |(p, l): (Point3<f64>, Vector3<f64>)| {
            let from = p - point;
            let out = from - along * from.dot(&along);
            (-l.dot(&out.try_normalize(0.0).unwrap_or_else(Vector3::zeros))).atan2(l.dot(&along))
        };
        Cone {
            point,
            along,
            angle: lines().map(slope).sum::<f64>() / count,
            distance,
        }
    }

    /// Its numbers among the unknowns.
    pub(super) fn numbers(&self) -> [f64; NUMBERS] {
        let [m, v] = [&self.point.coords, &self.along];
        [m.x, m.y, m.z, v.x, v.y, v.z, self.angle, self.distance]
    }

    /// From its numbers.
    pub(super) fn of(x: &[f64]) -> Cone {
        Cone {
            point: Point3::new(x[0], x[1], x[2]),
            along: Vector3::new(x[3], x[4], x[5]),
            angle: x[6],
            distance: x[7],
        }
    }
}
