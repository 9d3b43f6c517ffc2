//! The torsion along a border, with its derivatives.

use nalgebra::Vector3;

/// What the torsion at one place of a border depends on: the derivative X
/// along the border, the derivative Y across it, and how both change along it.
#[derive(Debug, Clone, Copy)]
pub(in super::super) struct BorderJet {
    pub(in super::super) along: Vector3<f64>,
    pub(in super::super) across: Vector3<f64>,
    pub(in super::super) along_change: Vector3<f64>,
    pub(in super::super) across_change: Vector3<f64>,
}

/// A value with its derivatives by X, Y, X′, Y′.
#[derive(Debug, Clone, Copy)]
pub(in super::super) struct Torsion {
    pub(in super::super) value: f64,
    pub(in super::super) by: [Vector3<f64>; 4],
}

impl BorderJet {
    /// det(X, N, N′) with N = X × Y: it is |X|² N·Y′ − (X·Y) N·X′, since N·X =
    /// N·Y = 0.
    fn determinant(&self) -> Torsion {
        let BorderJet {
            along: x,
            across: y,
            along_change: dx,
            across_change: dy,
        } = self;
        let n = x.cross(y);
        let (a, b) = (x.norm_squared(), x.dot(y));
        let (p, q) = (n.dot(dy), n.dot(dx));
        Torsion {
            value: a * p - b * q,
            by: [
                x * (2.0 * p) + y.cross(dy) * a - y * q - y.cross(dx) * b,
                dy.cross(x) * a - x * q - dx.cross(x) * b,
                n * -b,
                n * a,
            ],
        }
    }

    /// det(X, N, N′) / (|N|² |X|): the geodesic torsion times |X|, a length
    /// where the border's parameter runs over [0, 1].
    pub(in super::super) fn torsion(&self) -> Torsion {
        let (x, y) = (self.along, self.across);
        let (a, b) = (x.norm_squared(), x.dot(&y));
        let square = x.cross(&y).norm_squared();
        let Torsion { value, by } = self.determinant();
        let scale = 1.0 / (square * a.sqrt());
        let value = value * scale;
        // Derivatives of the logarithm of |N|² |X|.
        let log_x = (x * y.norm_squared() - y * b) * (2.0 / square) + x / a;
        let log_y = (y * a - x * b) * (2.0 / square);
        let [by_x, by_y, by_dx, by_dy] = by.map(|by| by * scale);
        Torsion {
            value,
            by: [by_x - log_x * value, by_y - log_y * value, by_dx, by_dy],
        }
    }
}
