//! The first surface: twice continuously differentiable lines through the
//! points of the coarse net.

use crate::methods::curvature_net::net::Layout;
use crate::methods::curvature_net::surface::{Surface, Vertex};
use nalgebra::{Point3, Vector3};

/// Gauss–Seidel sweeps for the slopes of a spline: each halves the error at
/// least, so that so many leave none.
const SWEEPS: usize = 60;

/// The surface through the points of a net.
pub(in super::super) fn through(layout: Layout, points: &[Point3<f64>]) -> Surface {
    let widths = [0, 1].map(|d| widths(layout, points, d));
    with_widths(layout, widths, points)
}

/// The surface through the points of a net whose patches have these widths in
/// the parameters.
pub(super) fn with_widths(
    layout: Layout,
    widths: [Vec<f64>; 2],
    points: &[Point3<f64>],
) -> Surface {
    let values: Vec<Vector3<f64>> = points.iter().map(|p| p.coords).collect();
    let mut du = slopes(layout, &values, &widths[0], 0);
    let mut dv = slopes(layout, &values, &widths[1], 1);
    open_corners(layout, &values, [&mut du, &mut dv], &widths);
    let duv = slopes(layout, &dv, &widths[0], 0);
    let vertices: Vec<Vertex> = (0..values.len())
        .map(|k| Vertex {
            point: values[k],
            du: du[k],
            dv: dv[k],
            duv: duv[k],
        })
        .collect();
    Surface::new(layout, widths, vertices)
}

/// The lines may close in on each other at an end vertex by this much of what
/// the sides of its quad leave open.
const LEAST_OPENING: f64 = 0.7;

/// Where the parabolas of the end pieces bend two lines of a sharp corner onto
/// each other, they leave it along the sides of the quad instead.
fn open_corners(
    layout: Layout,
    values: &[Vector3<f64>],
    [du, dv]: [&mut [Vector3<f64>]; 2],
    widths: &[Vec<f64>; 2],
) {
    let sine = |a: &Vector3<f64>, b: &Vector3<f64>| a.cross(b).norm() / (a.norm() * b.norm());
    for vertex in 0..values.len() {
        let at = [vertex / layout.columns, vertex % layout.columns];
        let side = |d: usize| -> Option<Vector3<f64>> {
            let last = layout.patch_counts()[d];
            if layout.closed[d] || (at[d] != 0 && at[d] != last) {
                return None;
            }
            let step = if d == 0 { layout.columns } else { 1 };
            let first = if at[d] == 0 { vertex } else { vertex - step };
            let width = widths[d][at[d].min(last - 1)];
            Some((values[first + step] - values[first]) / width)
        };
        let sides = [side(0), side(1)];
        let straight = [
            sides[0].unwrap_or(du[vertex]),
            sides[1].unwrap_or(dv[vertex]),
        ];
        let open = sine(&straight[0], &straight[1]);
        if sine(&du[vertex], &dv[vertex]) < LEAST_OPENING * open {
            [du[vertex], dv[vertex]] = straight;
        }
    }
}

/// The mean length of the edges of every row or column of patches.
fn widths(layout: Layout, points: &[Point3<f64>], direction: usize) -> Vec<f64> {
    let count = layout.patch_counts()[direction];
    let lines = if direction == 0 {
        layout.columns
    } else {
        layout.rows
    };
    let mut widths = vec![0.0; count];
    for [a, b] in layout.edges(direction) {
        let at = [a / layout.columns, a % layout.columns][direction];
        widths[at] += (points[b] - points[a]).norm() / lines as f64;
    }
    widths
}

/// The slopes at all vertices of cubic splines along one direction.
fn slopes(
    layout: Layout,
    values: &[Vector3<f64>],
    widths: &[f64],
    direction: usize,
) -> Vec<Vector3<f64>> {
    let mut slopes = vec![Vector3::zeros(); values.len()];
    let (count, lines) = if direction == 0 {
        (layout.rows, layout.columns)
    } else {
        (layout.columns, layout.rows)
    };
    for line in 0..lines {
        let place = |k: usize| match direction {
            0 => layout.vertex(k, line),
            _ => layout.vertex(line, k),
        };
        let along: Vec<_> = (0..count).map(|k| values[place(k)]).collect();
        let found = spline_slopes(&along, widths);
        found
            .iter()
            .enumerate()
            .for_each(|(k, s)| slopes[place(k)] = *s);
    }
    slopes
}

/// Slopes of the cubic spline through values; it closes where there are as
/// many intervals as values, and its end pieces are parabolas where not.
fn spline_slopes(values: &[Vector3<f64>], widths: &[f64]) -> Vec<Vector3<f64>> {
    let (n, m) = (values.len(), widths.len());
    let closed = n == m;
    let chord: Vec<Vector3<f64>> = (0..m)
        .map(|k| (values[(k + 1) % n] - values[k]) / widths[k])
        .collect();
    let mut slopes: Vec<_> = (0..n).map(|k| chord[k.min(m - 1)]).collect();
    if m == 1 {
        return slopes;
    }
    for _ in 0..SWEEPS {
        for k in 0..n {
            slopes[k] = if !closed && k == 0 {
                chord[0] * 2.0 - slopes[1]
            } else if !closed && k == n - 1 {
                chord[m - 1] * 2.0 - slopes[n - 2]
            } else {
                let before = (k + m - 1) % m;
                let (a, b) = (widths[before], widths[k]);
                let pull = (chord[before] * b + chord[k] * a) * 3.0;
                let sides = slopes[(k + n - 1) % n] * b + slopes[(k + 1) % n] * a;
                (pull - sides) / (2.0 * (a + b))
            };
        }
    }
    slopes
}
