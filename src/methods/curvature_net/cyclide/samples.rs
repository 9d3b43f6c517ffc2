//! Nets of curvature lines known in closed form.

use crate::methods::curvature_net::net::Net;
use nalgebra::Point3;

/// The net of a parametrisation by lines of curvature, frames by differences.
pub(crate) fn net_of(
    counts: [usize; 2],
    closed: [bool; 2],
    at: impl Fn(f64, f64) -> Point3<f64>,
) -> Net {
    let mut net = Net {
        rows: counts[0],
        columns: counts[1],
        closed,
        ..Net::default()
    };
    let share = |i: usize, k: usize| {
        let last = counts[k] - usize::from(!closed[k]);
        i as f64 / last as f64
    };
    const H: f64 = 1e-5;
    for (i, j) in (0..counts[0]).flat_map(|i| (0..counts[1]).map(move |j| (i, j))) {
        let (u, v) = (share(i, 0), share(j, 1));
        let tu = (at(u + H, v) - at(u - H, v)).normalize();
        let tv = (at(u, v + H) - at(u, v - H)).normalize();
        net.points.push(at(u, v));
        net.tangents.push([tu, tv]);
        net.normals.push(tu.cross(&tv).normalize());
    }
    net
}

/// A piece of an ellipsoid with half axes 3, 2, 1 in elliptic coordinates.
pub(crate) fn ellipsoid(u: f64, v: f64) -> Point3<f64> {
    let [a, b, c]: [f64; 3] = [9.0, 4.0, 1.0];
    let (s, t) = (1.5 + 2.0 * u, 5.0 + 3.0 * v);
    let coordinate = |x: f64, y: f64, z: f64| (x * (x - s) * (x - t) / ((x - y) * (x - z))).sqrt();
    Point3::new(
        coordinate(a, b, c),
        coordinate(b, a, c),
        coordinate(c, a, b),
    )
}

/// Enneper's surface.
pub(crate) fn enneper(u: f64, v: f64) -> Point3<f64> {
    let (u, v) = (0.3 + 0.8 * u, -0.5 + 0.9 * v);
    Point3::new(
        u - u.powi(3) / 3.0 + u * v * v,
        v - v.powi(3) / 3.0 + v * u * u,
        u * u - v * v,
    )
}

/// A vase; u closes.
pub(crate) fn vase(u: f64, v: f64) -> Point3<f64> {
    let turn = std::f64::consts::TAU * u;
    let radius = 1.0 + 0.3 * (4.0 * v).sin();
    Point3::new(radius * turn.cos(), radius * turn.sin(), 2.0 * v)
}

/// A torus; both close.
pub(crate) fn torus(u: f64, v: f64) -> Point3<f64> {
    let [u, v] = [u, v].map(|t| std::f64::consts::TAU * t);
    let out = 3.0 + v.cos();
    Point3::new(out * u.cos(), out * u.sin(), v.sin())
}
