//! Is the sheet a height field, and along which direction?

use super::super::task::Task;
use super::voxels::{Nodes, least_direction};
use nalgebra::{Matrix3, Vector3};

/// Fewest nodes whose normals mean anything.
const FEWEST_NODES: usize = 60;
/// Least cosine between normal and direction: steeper than 75° the field's
/// own energy no longer resembles the sheet's.
const STEEPEST: f64 = 0.26;
/// Share of the nodes that must keep it; the rest are edges and outliers.
const SHARE: f64 = 0.97;
/// A coordinate axis is taken where it keeps this share of the cosine that
/// the best direction has: users read fields along their own axes.
const AXIS_BONUS: f64 = 0.5;

/// The direction (user's axes) along which the sheet is a height field;
/// `None` where there is none.
pub(in super::super) fn heading(task: &Task, nodes: &Nodes) -> Option<Vector3<f64>> {
    if task.freedom.iter().filter(|f| **f).count() == 1 {
        let axis = Vector3::from_fn(|k, _| if task.freedom[k] { 1.0 } else { 0.0 });
        return Some(axis);
    }
    if nodes.place.len() < FEWEST_NODES {
        let flat = least_direction(moments(&task.points));
        let k = free_part(&flat, task).iamax();
        let axis = Vector3::from_fn(|i, _| if i == k { 1.0 } else { 0.0 });
        let is_axis = flat[k].abs() > 0.9 || !task.slides();
        return Some(if is_axis { axis } else { flat });
    }
    let mean = nodes.normal.iter().sum::<Vector3<f64>>();
    let mean = mean.try_normalize(1e-9)?;
    let worst = |d: &Vector3<f64>| {
        let mut cosines: Vec<f64> = nodes.normal.iter().map(|n| n.dot(d)).collect();
        cosines.sort_by(f64::total_cmp);
        cosines[((1.0 - SHARE) * cosines.len() as f64) as usize]
    };
    let k = free_part(&mean, task).iamax();
    let axis = Vector3::from_fn(|i, _| if i == k { mean[k].signum() } else { 0.0 });
    let (of_mean, of_axis) = (worst(&mean), worst(&axis));
    if of_axis >= STEEPEST && of_axis >= AXIS_BONUS * of_mean {
        return Some(axis.abs());
    }
    (of_mean >= STEEPEST && task.slides()).then_some(mean)
}

/// A direction without its parts along held axes.
fn free_part(v: &Vector3<f64>, task: &Task) -> Vector3<f64> {
    Vector3::from_fn(|k, _| if task.freedom[k] { v[k] } else { 0.0 })
}

/// The direction across `up` in which the points are longest: a coordinate
/// axis where `up` is one.
pub(in super::super) fn longest_across(points: &[Vector3<f64>], up: &Vector3<f64>) -> Vector3<f64> {
    if up.amax() > 1.0 - 1e-12 {
        let (mut low, mut high) = (points[0], points[0]);
        for p in points {
            low = low.inf(p);
            high = high.sup(p);
        }
        let extent = (high - low).component_mul(&up.map(|x| 1.0 - x.abs()));
        let k = extent.imax();
        return Vector3::from_fn(|i, _| if i == k { 1.0 } else { 0.0 });
    }
    let across = Matrix3::identity() - up * up.transpose();
    let eigen = (across * moments(points) * across).symmetric_eigen();
    let k = eigen.eigenvalues.imax();
    eigen.eigenvectors.column(k).into_owned()
}

fn moments(points: &[Vector3<f64>]) -> Matrix3<f64> {
    let mean = points.iter().sum::<Vector3<f64>>() / points.len() as f64;
    let mut moments = Matrix3::zeros();
    for p in points {
        let d = p - mean;
        moments += d * d.transpose();
    }
    moments
}
