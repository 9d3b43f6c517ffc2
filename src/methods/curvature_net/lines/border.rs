//! The torsion along a border, with its derivatives.

use nalgebra::Vector3;

/// What the torsion at one place of a border depends on: the derivative X
/// along the border, the derivative Y across it, and how both change along it.
#[derive(Debug, Clone, Copy)]
pub(in super::super) struct BorderJet {
    pub(super) along: Vector3<f64>,
    pub(super) across: Vector3<f64>,
    pub(super) along_change: Vector3<f64>,
    pub(super) across_change: Vector3<f64>,
}

/// A value with its derivatives by X, Y, X′, Y′.
#[derive(Debug, Clone, Copy)]
pub(in super::super) struct Torsion {
    pub(in super::super) value: f64,
    pub(super) by: [Vector3<f64>; 4],
}

impl BorderJet {
    /// det(X, N, N′) / (|N|² |X|) with N = X × Y: the geodesic torsion times
    /// |X|, a length where the border's parameter runs over [0, 1].
    ///
    /// The determinant is |X|² N·Y′ − (X·Y) N·X′, since N·X = N·Y = 0.
    pub(in super::super) fn torsion(&self) -> Torsion {
        let BorderJet {
            along: x,
            across: y,
            along_change: dx,
            across_change: dy,
        } = self;
        let n = x.cross(y);
        let (a, b) = (x.norm_squared(), x.dot(y));
        let (p, q) = (n.dot(dy), n.dot(dx));
        let (square, length) = (n.norm_squared(), a.sqrt());
        let scale = 1.0 / (square * length);
        let value = (a * p - b * q) * scale;
        let by_x = x * (2.0 * p) + y.cross(dy) * a - y * q - y.cross(dx) * b;
        let by_y = dy.cross(x) * a - x * q - dx.cross(x) * b;
        // Of the logarithm of |N|² |X|.
        let log_x = (x * y.norm_squared() - y * b) * (2.0 / square) + x / a;
        let log_y = (y * a - x * b) * (2.0 / square);
        Torsion {
            value,
            by: [
                by_x * scale - log_x * value,
                by_y * scale - log_y * value,
                n * (-b * scale),
                n * (a * scale),
            ],
        }
    }
}
