//! Where a curve's direction jumps.

use super::BSplineCurve;
use nalgebra::Vector3;

/// A derivative this much smaller than the curve's own size over its domain
/// is rounding, not a direction: some thousand units in the last place.
const NO_DIRECTION: f64 = 1e-12;

impl BSplineCurve {
    /// Inner parameters where the direction of travel jumps by more than
    /// `angle_tol` radians, increasing.
    ///
    /// Looks at knots alone: a polynomial piece can reverse only where its
    /// speed vanishes, which a designed curve does at most at its ends. Where
    /// the first derivative vanishes at a knot, the next one that does not
    /// gives the direction. A standing piece (equal control points) has none;
    /// a jump across it is reported at its end.
    #[must_use]
    pub fn kinks(&self, angle_tol: f64) -> Vec<f64> {
        let mut kinks = Vec::new();
        let mut before: Option<Vector3<f64>> = None;
        for piece in self.knot_vector().breakpoints().windows(2) {
            if let (Some(a), Some(b)) = (before, self.direction_after(piece[0]))
                && a.cross(&b).norm().atan2(a.dot(&b)) > angle_tol
            {
                kinks.push(piece[0]);
            }
            before = self.direction_before(piece[1]).or(before);
        }
        kinks
    }

    /// The unit direction of travel just after `u`.
    #[must_use]
    pub fn direction_after(&self, u: f64) -> Option<Vector3<f64>> {
        let jet = self.derivatives(u);
        self.first_direction([jet.d1, jet.d2, self.derivative3(u)])
    }

    /// The unit direction of travel just before `u`.
    #[must_use]
    pub fn direction_before(&self, u: f64) -> Option<Vector3<f64>> {
        let jet = self.derivatives_left(u);
        self.first_direction([jet.d1, -jet.d2, self.derivative3_left(u)])
    }

    /// The first of the derivatives that is more than rounding, as a unit
    /// vector.
    fn first_direction(&self, derivatives: [Vector3<f64>; 3]) -> Option<Vector3<f64>> {
        let [a, b] = self.domain();
        let size = self.bounding_box().diagonal();
        let mut least = NO_DIRECTION * size;
        for d in derivatives {
            least /= b - a;
            if d.norm() > least {
                return Some(d.normalize());
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Point3, point};

    fn curve(degree: usize, knots: &[f64], points: Vec<Point3<f64>>) -> BSplineCurve {
        BSplineCurve::new(degree, knots.to_vec(), points, None).expect("valid")
    }

    const ONE_DEGREE: f64 = std::f64::consts::PI / 180.0;

    #[test]
    fn a_polyline_has_a_kink_at_each_corner_and_none_where_it_is_straight() {
        let points = vec![
            point![0., 0., 0.],
            point![1., 0., 0.],
            point![2., 0., 0.],
            point![2., 1., 0.],
        ];
        let c = curve(1, &[0., 0., 1., 2., 3., 3.], points);
        assert_eq!(c.kinks(ONE_DEGREE), [2.0]);
        assert_eq!(c.kinks(100.0 * ONE_DEGREE), Vec::<f64>::new());
    }

    #[test]
    fn vanishing_speed_at_a_smooth_joint_is_no_kink() {
        // Control points doubled on both sides of the joint: d1 is zero there.
        let p = |x: f64| point![x, 0.0, 0.0];
        let straight = vec![p(0.), p(1.), p(2.), p(2.), p(2.), p(3.), p(4.)];
        let knots = [0., 0., 0., 0., 1., 1., 1., 2., 2., 2., 2.];
        assert!(
            curve(3, &knots, straight.clone())
                .kinks(ONE_DEGREE)
                .is_empty()
        );
        let mut bent = straight;
        (bent[5].y, bent[6].y) = (1.0, 2.0);
        assert_eq!(curve(3, &knots, bent).kinks(ONE_DEGREE), [1.0]);
    }

    #[test]
    fn a_jump_across_a_standing_piece_is_found_at_its_end() {
        let points = vec![
            point![0., 0., 0.],
            point![1., 0., 0.],
            point![1., 0., 0.],
            point![1., 1., 0.],
        ];
        let c = curve(1, &[0., 0., 1., 2., 3., 3.], points);
        assert_eq!(c.kinks(ONE_DEGREE), [2.0]);
        assert_eq!(c.direction_after(1.5), None);
    }
}
