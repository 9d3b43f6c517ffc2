//! Coarse nets like the paper's: drawn roughly, 9 to 18 quads.

use crate::methods::curvature_net::request::{Grid, Input, Options, Request};
use nalgebra::Point3;

/// A net of points of a surface over [0, 1]².
pub(super) fn grid(
    [rows, columns]: [usize; 2],
    closed: [bool; 2],
    surface: impl Fn(f64, f64) -> [f64; 3],
) -> Grid {
    let share =
        |k: usize, count: usize, closed: bool| k as f64 / (count - usize::from(!closed)) as f64;
    let points = (0..rows * columns).map(|k| {
        let u = share(k / columns, rows, closed[0]);
        let v = share(k % columns, columns, closed[1]);
        Point3::from(surface(u, v))
    });
    Grid {
        rows,
        columns,
        closed,
        points: points.collect(),
    }
}

/// A barrel vault that sags along its ridge and widens to one end.
pub(super) fn vault() -> Grid {
    grid([4, 5], [false, false], |u, v| {
        let angle = std::f64::consts::PI * (0.15 + 0.7 * v);
        let radius = 4.0 + 0.6 * u;
        let sag = -0.8 * (2.0 * u - 1.0).powi(2);
        [10.0 * u, -radius * angle.cos(), radius * angle.sin() + sag]
    })
}

/// A saddle along its lines of curvature, one corner pulled up.
pub(super) fn saddle() -> Grid {
    grid([5, 4], [false, false], |u, v| {
        let (x, y) = (6.0 * u - 3.0, 5.0 * v - 2.5);
        [x, y, 0.12 * x * x - 0.15 * y * y + 0.2 * u * v]
    })
}

/// A waisted tube that leans and is not quite round.
pub(super) fn tube() -> Grid {
    grid([4, 6], [false, true], |u, v| {
        let angle = std::f64::consts::TAU * v;
        let radius = 2.0 + 1.2 * (2.0 * u - 1.0).powi(2);
        let (sin, cos) = angle.sin_cos();
        [radius * cos + 0.3 * u, 1.1 * radius * sin, 7.0 * u]
    })
}

/// A bilge: flat of bottom, turn and side of a hull that narrows forwards.
pub(super) fn bilge() -> Grid {
    grid([4, 4], [false, false], |u, v| {
        let angle = std::f64::consts::FRAC_PI_2 * (0.1 + 0.8 * v);
        let breadth = 5.0 - 0.8 * u * u;
        [
            9.0 * u,
            breadth * angle.sin(),
            4.0 - 3.6 * angle.cos() + 0.5 * u * u,
        ]
    })
}

/// A request for a grid, without the cyclides.
pub(super) fn request(grid: Grid) -> Request {
    Request {
        input: Input::Grid(grid),
        options: Options {
            cyclide: false,
            ..Options::default()
        },
    }
}
