//! Data points of the profiles, and boundaries that interpolate them at the
//! parameters of their feet (sec. 2.3.4).

use super::super::profile::Profile;
use super::feet;
use crate::geometry::bspline::interpolate_at;
use crate::geometry::{BSplineCurve, CurveIndex, SplineError};
use nalgebra::Point3;

/// Data points of a profile that brings none, about: enough to keep the
/// curve's shape between them.
const EVEN_POINTS: usize = 25;
/// Samples of the profile between given points. The paper interpolates the
/// given points alone; with the trawler's 13 a profile the boundary then
/// strays by up to 0.4 % of the model between them, and twists more.
const BETWEEN: usize = 1;
/// Least distance of two data parameters; feet of a sharp bend may coincide,
/// and the interpolation needs increasing parameters.
const LEAST_STEP: f64 = 1e-3;

/// The points given with [`BETWEEN`] samples of the profile between
/// neighbours, or samples even in arc length.
pub(super) fn points_of(profile: &Profile, given: &[Point3<f64>]) -> Vec<Point3<f64>> {
    let mut places: Vec<f64> = if given.len() >= 2 {
        let index = CurveIndex::new(&profile.curve);
        given
            .iter()
            .map(|p| profile.fraction_of(index.closest(p).parameter))
            .collect()
    } else {
        let even = (EVEN_POINTS - 1) / (BETWEEN + 1);
        (0..=even).map(|i| i as f64 / even as f64).collect()
    };
    places.sort_by(f64::total_cmp);
    places.dedup();
    let share = |k: usize| k as f64 / (BETWEEN + 1) as f64;
    let spans = places.windows(2);
    let mut points: Vec<Point3<f64>> = spans
        .flat_map(|w| (0..=BETWEEN).map(move |k| w[0] + share(k) * (w[1] - w[0])))
        .map(|s| profile.at(s).point)
        .collect();
    points.extend(places.last().map(|s| profile.at(*s).point));
    points
}

/// The points, those further than `threshold` from the curve replaced by their
/// feet on it.
pub(super) fn moved(
    near: &BSplineCurve,
    given: &[Point3<f64>],
    threshold: f64,
) -> Vec<Point3<f64>> {
    let feet = feet::first(near, given).into_iter().map(|u| near.point(u));
    given
        .iter()
        .zip(feet)
        .map(|(x, f)| if (f - x).norm() > threshold { f } else { *x })
        .collect()
}

/// The curve through the points at the parameters of their feet on `near`,
/// and through the ends of `near` where these lie beyond the points.
pub(super) fn through(
    near: &BSplineCurve,
    points: &[Point3<f64>],
) -> Result<BSplineCurve, SplineError> {
    let mut parameters = feet::first(near, points);
    let mut points = points.to_vec();
    if parameters.first().is_some_and(|u| *u > LEAST_STEP) {
        parameters.insert(0, 0.0);
        points.insert(0, near.start());
    }
    if parameters.last().is_some_and(|u| *u < 1.0 - LEAST_STEP) {
        parameters.push(1.0);
        points.push(near.end());
    }
    separate(&mut parameters);
    interpolate_at(&parameters, &points, 3)
}

/// Moves parameters, as little as a forward and a backward pass do, until they
/// increase by [`LEAST_STEP`] from exactly 0 to exactly 1.
fn separate(parameters: &mut [f64]) {
    let last = parameters.len().saturating_sub(1);
    if last == 0 {
        return;
    }
    let step = LEAST_STEP.min(0.5 / last as f64);
    parameters[0] = 0.0;
    for i in 1..=last {
        parameters[i] = parameters[i].max(parameters[i - 1] + step);
    }
    parameters[last] = 1.0;
    for i in (1..last).rev() {
        parameters[i] = parameters[i].min(parameters[i + 1] - step);
    }
}

/// Both curves on the union of their knots.
pub(super) fn on_common_knots([a, b]: [BSplineCurve; 2]) -> Result<[BSplineCurve; 2], SplineError> {
    let union = a.knot_vector().union(b.knot_vector())?;
    let refined = |c: &BSplineCurve| c.insert_knots(&c.knot_vector().missing_from(&union));
    Ok([refined(&a)?, refined(&b)?])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn separated_parameters_increase_from_zero_to_one() {
        let mut feet = vec![0.0, 0.3, 0.2, 0.2, 0.9, 1.0, 1.0, 1.0];
        separate(&mut feet);
        assert_eq!((feet[0], feet[7]), (0.0, 1.0));
        assert!(
            feet.windows(2).all(|w| w[1] - w[0] > 0.9 * LEAST_STEP),
            "{feet:?}"
        );
    }
}
