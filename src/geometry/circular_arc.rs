//! Circular arcs in space, straight ones included.
//!
//! An arc is held by its first point, the unit tangent there and its last
//! point: unlike centre and radius these stay finite as the arc becomes
//! straight, and nothing that is computed from them loses digits there.

use crate::numerics::sinc;
use nalgebra::{Point3, Vector3};

/// A circular arc, or a straight segment, of less than a full turn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CircularArc {
    start: Point3<f64>,
    tangent: Vector3<f64>,
    end: Point3<f64>,
}

impl CircularArc {
    /// The arc that leaves `start` along `tangent` and ends in `end`; `None`
    /// unless the points differ and the tangent has a direction.
    #[must_use]
    pub fn new(start: Point3<f64>, tangent: Vector3<f64>, end: Point3<f64>) -> Option<Self> {
        let tangent = tangent.try_normalize(0.0)?;
        let usable = tangent.iter().all(|x| x.is_finite()) && (end - start).norm() > 0.0;
        usable.then_some(CircularArc {
            start,
            tangent,
            end,
        })
    }

    /// The arc from `start` through `middle` to `end`; `None` where two of the
    /// points are one, or `middle` lies on the line of the others but not
    /// between them.
    #[must_use]
    pub fn through(start: Point3<f64>, middle: Point3<f64>, end: Point3<f64>) -> Option<Self> {
        let (first, chord, last) = (middle - start, end - start, end - middle);
        // Inscribed angles: the tangent makes the same angle with the first
        // chord as the whole chord makes with the last.
        let tangent = first / first.norm_squared() - chord / chord.norm_squared();
        if first.dot(&last) <= 0.0 && first.cross(&last).norm() == 0.0 {
            return None;
        }
        CircularArc::new(start, tangent, end)
    }

    /// Its first point.
    #[must_use]
    pub fn start(&self) -> Point3<f64> {
        self.start
    }

    /// Its last point.
    #[must_use]
    pub fn end(&self) -> Point3<f64> {
        self.end
    }

    /// The unit tangent at its start.
    #[must_use]
    pub fn tangent(&self) -> Vector3<f64> {
        self.tangent
    }

    /// The unit tangent at its end: mirrored in the bisecting plane of the
    /// chord and reversed.
    #[must_use]
    pub fn end_tangent(&self) -> Vector3<f64> {
        let e = (self.end - self.start).normalize();
        e * (2.0 * e.dot(&self.tangent)) - self.tangent
    }

    /// The curvature vector at its start: towards the centre, of length
    /// 1 / radius; zero for a straight one.
    #[must_use]
    pub fn curvature_vector(&self) -> Vector3<f64> {
        let chord = self.end - self.start;
        self.across(&chord) * (2.0 / chord.norm_squared())
    }

    /// Its radius; infinite for a straight one.
    #[must_use]
    pub fn radius(&self) -> f64 {
        1.0 / self.curvature_vector().norm()
    }

    /// Its centre; `None` for a straight one.
    #[must_use]
    pub fn centre(&self) -> Option<Point3<f64>> {
        let k = self.curvature_vector();
        let centre = self.start + k / k.norm_squared();
        centre.iter().all(|x| x.is_finite()).then_some(centre)
    }

    /// The unit normal of its plane, about which it turns to the left; `None`
    /// for a straight one.
    #[must_use]
    pub fn axis(&self) -> Option<Vector3<f64>> {
        self.tangent
            .cross(&self.curvature_vector())
            .try_normalize(0.0)
    }

    /// The angle that it turns by, radians, in [0, 2π).
    #[must_use]
    pub fn angle(&self) -> f64 {
        let chord = self.end - self.start;
        2.0 * self.across(&chord).norm().atan2(chord.dot(&self.tangent))
    }

    /// Its length.
    #[must_use]
    pub fn length(&self) -> f64 {
        (self.end - self.start).norm() / sinc(0.5 * self.angle())
    }

    /// The point at a share of its length in [0, 1].
    #[must_use]
    pub fn point(&self, share: f64) -> Point3<f64> {
        let chord = self.end - self.start;
        let half = 0.5 * self.angle();
        let turned = share * half;
        let reach = chord.norm() * share * sinc(turned) / sinc(half);
        let side = self.across(&chord).try_normalize(0.0);
        let side = side.unwrap_or_else(Vector3::zeros);
        self.start + (self.tangent * turned.cos() + side * turned.sin()) * reach
    }

    /// Where the tangents at its two ends meet; `None` for half a turn and
    /// more. With the two ends and the weight cos(angle / 2) it is the control
    /// point of the arc as a rational quadratic.
    #[must_use]
    pub fn control_point(&self) -> Option<Point3<f64>> {
        let chord = self.end - self.start;
        let along = chord.dot(&self.tangent);
        let reach = chord.norm_squared() / (2.0 * along);
        (along > 0.0 && reach.is_finite()).then(|| self.start + self.tangent * reach)
    }

    /// The part of a vector that is square to the first tangent.
    fn across(&self, vector: &Vector3<f64>) -> Vector3<f64> {
        vector - self.tangent * vector.dot(&self.tangent)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// An arc of the given radius and angle about a slanted axis.
    fn arc(radius: f64, angle: f64) -> (CircularArc, Point3<f64>) {
        let x = Vector3::new(1.0, 2.0, -1.0).normalize();
        let y = x.cross(&Vector3::new(0.3, -1.0, 2.0)).normalize();
        let centre = Point3::new(4.0, -7.0, 3.0);
        let at = |t: f64| centre + (x * t.cos() + y * t.sin()) * radius;
        let arc = CircularArc::through(at(0.0), at(0.4 * angle), at(angle));
        (arc.expect("three places"), centre)
    }

    #[test]
    fn three_points_give_back_the_circle() {
        for angle in [1e-3, 0.3, 2.0, PI, 5.0, 6.2] {
            let (arc, centre) = arc(2.5, angle);
            let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-8 * b, "{angle}: {a} ≠ {b}");
            close(arc.radius(), 2.5);
            close(arc.angle(), angle);
            close(arc.length(), 2.5 * angle);
            assert!((arc.centre().expect("curved") - centre).norm() < 1e-7);
            for share in [0.0, 0.25, 0.9, 1.0] {
                close((arc.point(share) - centre).norm(), 2.5);
            }
            assert!((arc.point(1.0) - arc.end()).norm() < 1e-12);
            let back = CircularArc::new(arc.end(), -arc.end_tangent(), arc.start());
            let middle = back.expect("an arc").point(0.5);
            assert!((middle - arc.point(0.5)).norm() < 1e-8, "{angle}");
        }
    }

    #[test]
    fn a_straight_arc_has_no_centre_but_a_length() {
        let (a, b) = (Point3::new(1.0, 1.0, 1.0), Point3::new(1.0, 4.0, 5.0));
        let arc = CircularArc::through(a, a + (b - a) * 0.25, b).expect("a segment");
        assert_eq!(
            (arc.angle(), arc.length(), arc.radius()),
            (0.0, 5.0, f64::INFINITY)
        );
        assert_eq!((arc.centre(), arc.axis()), (None, None));
        assert_eq!(arc.point(0.5), Point3::new(1.0, 2.5, 3.0));
        assert_eq!(arc.control_point(), Some(Point3::new(1.0, 2.5, 3.0)));
    }

    #[test]
    fn the_control_point_is_where_the_tangents_meet() {
        let (arc, _) = arc(2.0, 1.2);
        let meet = arc.control_point().expect("less than half a turn");
        for (from, tangent) in [(arc.start(), arc.tangent()), (arc.end(), arc.end_tangent())] {
            assert!((meet - from).cross(&tangent).norm() < 1e-12);
        }
        assert_eq!(self::arc(2.0, 3.5).0.control_point(), None);
    }

    #[test]
    fn no_arc_runs_through_one_point_twice() {
        let (a, b) = (Point3::origin(), Point3::new(1.0, 0.0, 0.0));
        assert_eq!(CircularArc::through(a, a, b), None);
        assert_eq!(CircularArc::through(a, Point3::new(2.0, 0.0, 0.0), b), None);
        assert_eq!(CircularArc::new(a, Vector3::zeros(), b), None);
    }
}
