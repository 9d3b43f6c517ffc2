//! The moving frame and the rigid motions that carry it.

use nalgebra::{Matrix3, Point3, Vector3};

/// A point on a surface, the ruling through it and the normal along it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// The point, λ = 0 on the ruling.
    pub point: Point3<f64>,
    /// Unit direction of the ruling.
    pub ruling: Vector3<f64>,
    /// Unit normal of the surface, perpendicular to the ruling.
    pub normal: Vector3<f64>,
}

/// How a frame moves on: by how much its ruling turns in the surface (g) and
/// the surface bends (k) per unit of length; 1/length.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Strain {
    /// r′·t.
    pub g: f64,
    /// t′·n.
    pub k: f64,
}

/// The velocity of a rigid motion: of the point that passes through the
/// origin, and its rotation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Twist {
    /// Velocity at the origin.
    pub linear: Vector3<f64>,
    /// Angular velocity.
    pub angular: Vector3<f64>,
}

/// sin θ/θ, (1 − cos θ)/θ², (θ − sin θ)/θ³ of θ².
fn sinc(square: f64) -> [f64; 3] {
    /// Below this the Taylor series are exact to rounding.
    const SMALL: f64 = 0.01;
    if square < SMALL {
        let s = square;
        let a = 1.0 - s / 6.0 * (1.0 - s / 20.0 * (1.0 - s / 42.0 * (1.0 - s / 72.0)));
        let b = 0.5 * (1.0 - s / 12.0 * (1.0 - s / 30.0 * (1.0 - s / 56.0 * (1.0 - s / 90.0))));
        let c = (1.0 - s / 20.0 * (1.0 - s / 42.0 * (1.0 - s / 72.0 * (1.0 - s / 110.0)))) / 6.0;
        [a, b, c]
    } else {
        let angle = square.sqrt();
        let (sin, cos) = angle.sin_cos();
        [
            sin / angle,
            (1.0 - cos) / square,
            (angle - sin) / (angle * square),
        ]
    }
}

impl Strain {
    /// W: the rate at which the frame turns about the axis.
    #[must_use]
    pub fn rate(self) -> f64 {
        self.g.hypot(self.k)
    }

    /// 1 + gλ: the speed of the point at λ when the frame's point has speed 1;
    /// zero at the apex.
    #[must_use]
    pub fn speed(self, lambda: f64) -> f64 {
        1.0 + self.g * lambda
    }

    /// The strain of the same surface with its base line at λ.
    #[must_use]
    pub fn slid(self, lambda: f64) -> Strain {
        let speed = self.speed(lambda);
        Strain {
            g: self.g / speed,
            k: self.k / speed,
        }
    }
}

impl Frame {
    /// A frame from a point, a direction and an approximate normal; `None`
    /// where the two are parallel or zero.
    #[must_use]
    pub fn new(point: Point3<f64>, ruling: Vector3<f64>, normal: Vector3<f64>) -> Option<Self> {
        let ruling = ruling.try_normalize(0.0)?;
        let across = normal.cross(&ruling).try_normalize(0.0)?;
        Some(Frame {
            point,
            ruling,
            normal: ruling.cross(&across),
        })
    }

    /// t = n × r: the way across the rulings.
    #[must_use]
    pub fn tangent(&self) -> Vector3<f64> {
        self.normal.cross(&self.ruling)
    }

    /// The point at λ on the ruling.
    #[must_use]
    pub fn at(&self, lambda: f64) -> Point3<f64> {
        self.point + self.ruling * lambda
    }

    /// The frame at λ on the same ruling.
    #[must_use]
    pub fn slid(&self, lambda: f64) -> Frame {
        Frame {
            point: self.at(lambda),
            ..*self
        }
    }

    /// The frame after the length s (of either sign) with constant strain.
    #[must_use]
    pub fn carried(&self, strain: Strain, s: f64) -> Frame {
        let way = self.way(strain, s);
        Frame {
            point: self.point + way,
            ruling: self.ruling + strain.g * way,
            normal: self.normal - strain.k * way,
        }
    }

    /// By how much p moves over the length s.
    fn way(&self, strain: Strain, s: f64) -> Vector3<f64> {
        let [a, b, _] = sinc((strain.rate() * s).powi(2));
        s * a * self.tangent() + s * s * b * self.pull(strain)
    }

    /// t′ = k n − g r.
    fn pull(&self, strain: Strain) -> Vector3<f64> {
        strain.k * self.normal - strain.g * self.ruling
    }

    /// How the frame at the end of the length s moves when g, k or s grow.
    #[must_use]
    pub fn carried_twists(&self, strain: Strain, s: f64) -> [Twist; 3] {
        let [_, b, c] = sinc((strain.rate() * s).powi(2));
        // ∫ (p(σ) − p(0)) dσ
        let sum = s * s * (b * self.tangent() + s * c * self.pull(strain));
        let by_g = Twist::at(
            &self.point,
            sum.cross(&self.normal),
            s * self.normal - strain.k * sum,
        );
        let by_k = Twist::at(
            &self.point,
            sum.cross(&self.ruling),
            s * self.ruling + strain.g * sum,
        );
        let end = self.carried(strain, s);
        let spin = strain.k * end.ruling + strain.g * end.normal;
        [by_g, by_k, Twist::at(&end.point, end.tangent(), spin)]
    }

    /// Coordinates of a point along r, t, n.
    #[must_use]
    pub fn local(&self, point: &Point3<f64>) -> Vector3<f64> {
        let from = point - self.point;
        Vector3::new(
            from.dot(&self.ruling),
            from.dot(&self.tangent()),
            from.dot(&self.normal),
        )
    }

    /// A vector with given coordinates along r, t, n.
    #[must_use]
    pub fn vector(&self, local: &Vector3<f64>) -> Vector3<f64> {
        local.x * self.ruling + local.y * self.tangent() + local.z * self.normal
    }

    /// The frame turned about its point by a rotation vector with coordinates
    /// along r, t, n.
    #[must_use]
    pub fn turned(&self, rotation: &Vector3<f64>) -> Frame {
        let [a, b, _] = sinc(rotation.norm_squared());
        let turn = |v: Vector3<f64>| {
            let once = rotation.cross(&v);
            self.vector(&(v + a * once + b * rotation.cross(&once)))
        };
        Frame {
            point: self.point,
            ruling: turn(Vector3::x()),
            normal: turn(Vector3::z()),
        }
    }

    /// The angular velocities of [`Frame::turned`] when a coordinate of the
    /// rotation grows: the left Jacobian of the rotation group, by columns.
    #[must_use]
    pub fn turning(&self, rotation: &Vector3<f64>) -> [Vector3<f64>; 3] {
        let [_, b, c] = sinc(rotation.norm_squared());
        let cross = rotation.cross_matrix();
        let left = Matrix3::identity() + b * cross + c * cross * cross;
        [0, 1, 2].map(|i| self.vector(&left.column(i).into_owned()))
    }
}

impl Twist {
    /// A motion with a given velocity at a point.
    #[must_use]
    pub fn at(point: &Point3<f64>, velocity: Vector3<f64>, angular: Vector3<f64>) -> Self {
        Twist {
            linear: velocity + point.coords.cross(&angular),
            angular,
        }
    }

    /// The velocity of the body at a point.
    #[must_use]
    pub fn velocity(&self, point: &Point3<f64>) -> Vector3<f64> {
        self.linear + self.angular.cross(&point.coords)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    pub(super) fn frame() -> Frame {
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

    fn difference(a: &Frame, b: &Frame) -> f64 {
        (a.point - b.point).norm() + (a.ruling - b.ruling).norm() + (a.normal - b.normal).norm()
    }

    #[test]
    fn the_frame_obeys_its_equations_and_stays_orthonormal() {
        for (g, k) in STRAINS {
            let strain = Strain { g, k };
            let (f, h) = (frame(), 1e-5);
            for s in [-0.9, 0.02, 0.7] {
                let [a, b] = [-h, h].map(|h| f.carried(strain, s + h));
                let here = f.carried(strain, s);
                let t = here.tangent();
                assert!(((b.point - a.point) / (2.0 * h) - t).norm() < 1e-9);
                assert!(((b.ruling - a.ruling) / (2.0 * h) - g * t).norm() < 1e-9);
                assert!(((b.normal - a.normal) / (2.0 * h) + k * t).norm() < 1e-9);
                assert!(here.ruling.dot(&here.normal).abs() < 1e-14);
                assert!((here.ruling.norm() - 1.0).abs() < 1e-14);
                assert!((here.normal.norm() - 1.0).abs() < 1e-14);
                let two = f.carried(strain, 0.3 * s).carried(strain, 0.7 * s);
                assert!(difference(&two, &here) < 1e-14);
            }
        }
    }

    #[test]
    fn apex_and_axis_stay_where_they_are() {
        let (f, strain) = (frame(), Strain { g: 0.5, k: 1.5 });
        let far = f.carried(strain, 0.8);
        let apex = |f: &Frame| f.at(-1.0 / strain.g);
        let axis = |f: &Frame| strain.k * f.ruling + strain.g * f.normal;
        assert!((apex(&f) - apex(&far)).norm() < 1e-14);
        assert!((axis(&f) - axis(&far)).norm() < 1e-14);
    }

    #[test]
    fn a_slid_base_line_gives_the_same_rulings() {
        let (f, strain, c) = (frame(), Strain { g: 0.5, k: 1.5 }, 0.3);
        let slid = f.slid(c).carried(strain.slid(c), 0.8 * strain.speed(c));
        assert!(difference(&slid, &f.carried(strain, 0.8).slid(c)) < 1e-14);
    }

    #[test]
    fn twists_are_the_derivatives_of_the_carried_frame() {
        let h = 1e-6;
        for (g, k) in STRAINS {
            for s in [-0.9, 0.7] {
                let carry = |d: [f64; 3]| {
                    let strain = Strain {
                        g: g + d[0],
                        k: k + d[1],
                    };
                    frame().carried(strain, s + d[2])
                };
                let twists = frame().carried_twists(Strain { g, k }, s);
                for (i, twist) in twists.iter().enumerate() {
                    let mut d = [0.0; 3];
                    d[i] = h;
                    let (up, down) = (carry(d), carry(d.map(|v| -v)));
                    let here = carry([0.0; 3]);
                    let velocity = (up.point - down.point) / (2.0 * h);
                    assert!((velocity - twist.velocity(&here.point)).norm() < 1e-9);
                    let spin = (up.ruling - down.ruling) / (2.0 * h);
                    assert!((spin - twist.angular.cross(&here.ruling)).norm() < 1e-9);
                    let spin = (up.normal - down.normal) / (2.0 * h);
                    assert!((spin - twist.angular.cross(&here.normal)).norm() < 1e-9);
                }
            }
        }
    }

    #[test]
    fn turning_is_the_derivative_of_turned() {
        let (f, h) = (frame(), 1e-6);
        for rotation in [Vector3::zeros(), Vector3::new(0.4, -0.9, 0.2)] {
            for (i, spin) in f.turning(&rotation).iter().enumerate() {
                let step = Vector3::ith(i, h);
                let (up, down) = (f.turned(&(rotation + step)), f.turned(&(rotation - step)));
                let here = f.turned(&rotation);
                let rate = (up.ruling - down.ruling) / (2.0 * h);
                assert!((rate - spin.cross(&here.ruling)).norm() < 1e-9);
                let rate = (up.normal - down.normal) / (2.0 * h);
                assert!((rate - spin.cross(&here.normal)).norm() < 1e-9);
            }
        }
    }
}
