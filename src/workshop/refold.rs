//! Rolling a flat pattern back up: bent by a table of angles along its rulings
//! and by nothing else, how near does it come to the plate?

use super::development::FlatLine;
use crate::geometry::RuledSurface;
use nalgebra::{Matrix3, Point3, Rotation3, Unit, Vector3};

/// A ruling on the surface, with the surface's normal in its middle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bend {
    /// Ends on the first and second boundary.
    pub ends: [Point3<f64>; 2],
    /// Unit normals as limits from before and behind; they differ where the
    /// surface has a crease.
    normals: [Option<Vector3<f64>>; 2],
}

impl Bend {
    pub fn at(surface: &RuledSurface, u: f64) -> Self {
        let behind = surface.ruling(u);
        let before = surface.ruling_left(u);
        let normals = [before, behind].map(|jet| jet.surface(0.5).normal());
        Bend {
            ends: [behind.first.point, behind.second.point],
            normals,
        }
    }

    fn direction(&self) -> Vector3<f64> {
        self.ends[1] - self.ends[0]
    }
}

/// The turn of the normal about the rulings from one ruling to the next,
/// radians; positive to the right-hand side about the rulings' direction.
pub(super) fn turn(from: &Bend, to: &Bend) -> f64 {
    let about = from.direction() + to.direction();
    angle(from.normals[1], to.normals[0], about)
}

/// The turn of the normal at a ruling: 0 where there is no crease.
pub(super) fn crease(bend: &Bend) -> f64 {
    angle(bend.normals[0], bend.normals[1], bend.direction())
}

fn angle(a: Option<Vector3<f64>>, b: Option<Vector3<f64>>, about: Vector3<f64>) -> f64 {
    let (Some(a), Some(b), Some(axis)) = (a, b, about.try_normalize(0.0)) else {
        return 0.0;
    };
    let sine = a.cross(&b).dot(&axis);
    let cosine = a.dot(&b) - a.dot(&axis) * b.dot(&axis);
    sine.atan2(cosine)
}

/// Largest distance of a ruling's end from where it is on the plate, after
/// bending the pattern along its rulings and laying it on the plate as well as
/// a rigid body can be (least squares, Kabsch 1976).
pub(super) fn deviation(flat: &[FlatLine], plate: &[Bend]) -> f64 {
    let rolled: Vec<Point3<f64>> = roll(flat, plate).into_iter().flatten().collect();
    let target: Vec<Point3<f64>> = plate.iter().flat_map(|b| b.ends).collect();
    let weights = weights(&target);
    largest_distance(&rolled, &target, &weights)
}

/// The ends of the pattern's rulings after bending.
fn roll(flat: &[FlatLine], plate: &[Bend]) -> Vec<[Point3<f64>; 2]> {
    let mut turned: Rotation3<f64> = Rotation3::identity();
    let mut moved = Vector3::zeros();
    let lifted = |p: &nalgebra::Point2<f64>| Vector3::new(p.x, p.y, 0.0);
    let steps: Vec<f64> = plate.windows(2).map(|w| turn(&w[0], &w[1])).collect();
    let mut rolled = Vec::with_capacity(flat.len());
    for (i, line) in flat.iter().enumerate() {
        let place = |p: &nalgebra::Point2<f64>| Point3::from(turned * lifted(p) + moved);
        let ends = [place(&line.from), place(&line.to)];
        rolled.push(ends);
        // Half of the bend on either side of the ruling, and its crease.
        let half = |k: Option<usize>| k.and_then(|k| steps.get(k)).map_or(0.0, |s| 0.5 * s);
        let fold = half(i.checked_sub(1)) + crease(&plate[i]) + half(Some(i));
        let along = turned * Vector3::new(line.direction.x, line.direction.y, 0.0);
        let fold = Rotation3::from_axis_angle(&Unit::new_normalize(along), fold);
        let pivot = ends[0].coords;
        moved = pivot + fold * (moved - pivot);
        turned = fold * turned;
    }
    rolled
}

/// Each end counts by the length of boundary that it stands for.
fn weights(points: &[Point3<f64>]) -> Vec<f64> {
    let step = |i: usize, j: Option<usize>| {
        let other = j.and_then(|j| points.get(j));
        other.map_or(0.0, |p| (p - points[i]).norm())
    };
    (0..points.len())
        .map(|i| step(i, i.checked_sub(2)) + step(i, Some(i + 2)))
        .collect()
}

fn largest_distance(rolled: &[Point3<f64>], target: &[Point3<f64>], weights: &[f64]) -> f64 {
    let total: f64 = weights.iter().sum();
    let mean = |points: &[Point3<f64>]| -> Vector3<f64> {
        let sum: Vector3<f64> = (points.iter().zip(weights))
            .map(|(p, w)| p.coords * *w)
            .sum();
        sum / total
    };
    let (a, b) = (mean(rolled), mean(target));
    let covariance: Matrix3<f64> = (rolled.iter().zip(target).zip(weights))
        .map(|((p, q), w)| (q.coords - b) * (p.coords - a).transpose() * *w)
        .sum();
    let svd = covariance.svd(true, true);
    let (Some(u), Some(v_t)) = (svd.u, svd.v_t) else {
        return f64::NAN;
    };
    // No mirror image.
    let handed = (u * v_t).determinant().signum();
    let rotation = u * Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, handed)) * v_t;
    (rolled.iter().zip(target))
        .map(|(p, q)| (rotation * (p.coords - a) - (q.coords - b)).norm())
        .fold(0.0, f64::max)
}
