//! One curve from several that follow on one another.

use super::{BSplineCurve, SplineError};
use nalgebra::Point3;

/// Ends this close, relative to the largest coordinate or parameter, are one:
/// a few thousand units in the last place, the rounding of a construction.
const ROUNDING: f64 = 1e-12;

/// Concatenates curves of one degree whose domains abut and whose ends agree
/// (to rounding; the earlier curve's end counts). Inner joints become knots of
/// multiplicity `degree`. Control points are kept to the bit; the weights of a
/// later rational curve are scaled to agree at the joint.
///
/// # Errors
/// No curves, different degrees, domains that do not abut, or a gap.
pub fn join_c0(curves: &[BSplineCurve]) -> Result<BSplineCurve, SplineError> {
    let Some((first, rest)) = curves.split_first() else {
        return Err(SplineError::NoCurves);
    };
    let degree = first.degree();
    let rational = curves.iter().any(|c| c.weights().is_some());
    let mut knots = first.knots().to_vec();
    let mut points = first.control_points().to_vec();
    let mut weights = weights_of(first);
    for (k, next) in rest.iter().enumerate() {
        if next.degree() != degree {
            return Err(SplineError::DegreesDiffer {
                first: degree,
                second: next.degree(),
            });
        }
        check_joint(k + 1, &curves[k], next)?;
        let scale = weights[weights.len() - 1] / weights_of(next)[0];
        knots.pop();
        knots.extend_from_slice(&next.knots()[degree + 1..]);
        points.extend_from_slice(&next.control_points()[1..]);
        weights.extend(weights_of(next)[1..].iter().map(|w| w * scale));
    }
    BSplineCurve::new(degree, knots, points, rational.then_some(weights))
}

fn weights_of(curve: &BSplineCurve) -> Vec<f64> {
    curve
        .weights()
        .map_or_else(|| vec![1.0; curve.control_points().len()], <[f64]>::to_vec)
}

/// Whether `next` follows on `before`.
fn check_joint(
    index: usize,
    before: &BSplineCurve,
    next: &BSplineCurve,
) -> Result<(), SplineError> {
    let (first, second) = (before.domain(), next.domain());
    let parameter_size = first[1].abs().max(first[1] - first[0]);
    if (second[0] - first[1]).abs() > ROUNDING * parameter_size {
        return Err(SplineError::DomainsDiffer { first, second });
    }
    let largest = |p: &Point3<f64>| p.coords.amax();
    let gap = (next.start() - before.end()).norm();
    if gap > ROUNDING * largest(&before.end()).max(before.bounding_box().diagonal()) {
        return Err(SplineError::Gap { index, gap });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::point;

    fn piece(domain: [f64; 2], from: Point3<f64>, to: Point3<f64>) -> BSplineCurve {
        BSplineCurve::line(from, to, 3)
            .and_then(|l| l.on_domain(domain))
            .expect("valid")
    }

    #[test]
    fn joined_pieces_keep_their_control_points() {
        let (a, b, c) = (
            point![0., 0., 0.],
            point![0.1, 0.7, 0.],
            point![2., 0.3, 1.],
        );
        let (one, two) = (piece([0., 0.4], a, b), piece([0.4, 1.0], b, c));
        let joined = join_c0(&[one.clone(), two.clone()]).expect("they meet");
        assert_eq!(joined.control_points()[..4], *one.control_points());
        assert_eq!(joined.control_points()[3..], *two.control_points());
        assert_eq!(joined.knot_vector().multiplicity(0.4), 3);
        assert_eq!(joined.point(0.2), one.point(0.2));
        assert_eq!(joined.point(0.9), two.point(0.9));
        assert_eq!(joined.derivatives_left(0.4), one.derivatives(0.4));
        assert_eq!(
            join_c0(&joined.split(0.4).map(|(l, r)| [l, r]).expect("inside")),
            Ok(joined)
        );
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        let (a, b, c) = (point![0., 0., 0.], point![1., 0., 0.], point![2., 0., 0.]);
        assert_eq!(join_c0(&[]), Err(SplineError::NoCurves));
        let gap = join_c0(&[piece([0., 1.], a, b), piece([1., 2.], c, b)]);
        assert_eq!(gap, Err(SplineError::Gap { index: 1, gap: 1.0 }));
        let apart = join_c0(&[piece([0., 1.], a, b), piece([1.5, 2.], b, c)]);
        assert!(matches!(apart, Err(SplineError::DomainsDiffer { .. })));
        let line = BSplineCurve::line(b, c, 2)
            .and_then(|l| l.on_domain([1., 2.]))
            .expect("valid");
        let degrees = join_c0(&[piece([0., 1.], a, b), line]);
        assert_eq!(
            degrees,
            Err(SplineError::DegreesDiffer {
                first: 3,
                second: 2
            })
        );
    }
}
