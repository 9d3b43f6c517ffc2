//! A sheet raised across a base: r = B + h n, n the normal of the base.
//!
//! A folded sheet is a height field across any coarse sheet that follows it to
//! within its radii of curvature: a point with its foot (u, v) on the base and
//! its signed distance h from it is `B(u, v) + h n(u, v)`, exactly. One field
//! is left to fit, with the noise across the sheet and without the base's own
//! roughness along it.

use super::super::feet::{Effort, Foot, feet, on_plane};
use super::super::net::{Net, Sheet, Tangents};
use super::super::springs::Springs;
use super::super::task::Task;
use super::seam::Seam;
use super::voxels::Nodes;
use crate::geometry::{Knots, basis_jet};
use crate::methods::FitError;
use crate::numerics::{BandedLu, BandedMatrix};
use crate::solver::Control;
use nalgebra::Vector3;
use rayon::prelude::*;

/// From the tangent plane of a node to the foot.
const FEET: Effort = Effort::listed(8);

/// The points as heights across a base, each sought from the place of its
/// node; behind them the shadows of points beside a seam, on its other side.
///
/// # Errors
/// [`FitError::Stopped`].
pub(super) fn heights(
    base: &Sheet,
    task: &Task,
    (nodes, map, seam): (&Nodes, &[[f64; 2]], Option<&Seam>),
    control: &dyn Control,
) -> Result<Springs<1>, FitError> {
    let seats: Vec<Tangents> = map.iter().map(|at| base.tangents(*at)).collect();
    let place = |p: &Vector3<f64>, node: usize| on_plane(&seats[node], map[node], p);
    let start = |p: &Vector3<f64>| {
        let node = nodes.at(p).unwrap_or_else(|| nodes.nearest(p));
        let (own, other) = seam.map_or((node, None), |s| s.seats(p, node));
        (place(p, own), other.map(|o| place(p, o)))
    };
    let points = task.points.par_iter().with_min_len(512);
    let (starts, others): (Vec<_>, Vec<_>) = points.map(start).unzip();
    let mut springs = Springs::default();
    let own = feet(base, (&task.points, &starts), FEET, control)?;
    add(&mut springs, own.iter().zip(task.weight.iter().copied()));
    let shadows: Vec<(usize, [f64; 2])> = (others.iter().enumerate())
        .filter_map(|(i, at)| at.map(|at| (i, at)))
        .collect();
    let points: Vec<Vector3<f64>> = shadows.iter().map(|(i, _)| task.points[*i]).collect();
    let starts: Vec<[f64; 2]> = shadows.iter().map(|(_, at)| *at).collect();
    let shades = feet(base, (&points, &starts), FEET, control)?;
    let inside = |at: [f64; 2]| {
        let domain = base.net.domain();
        (0..2).all(|k| at[k] > domain[k][0] && at[k] < domain[k][1])
    };
    let kept = shades
        .iter()
        .zip(shadows.iter().map(|(i, _)| task.weight[*i]));
    add(&mut springs, kept.filter(|(f, _)| inside(f.at)));
    Ok(springs)
}

fn add<'a>(springs: &mut Springs<1>, feet: impl Iterator<Item = (&'a Foot, f64)>) {
    for (foot, weight) in feet {
        springs.at.push(foot.at);
        springs.value.push([across(foot)]);
        springs.weight.push(weight);
    }
}

/// Distance along the normal; off the border of the base a foot is oblique.
fn across(foot: &Foot) -> f64 {
    let normal = foot.sheet.normal();
    normal.map_or_else(|| foot.distance(), |n| n.dot(&foot.offset))
}

/// The sheet B + h n on the net of h: interpolated where its control points
/// act most, far closer than any noise where h is small against the base's
/// radii.
///
/// # Errors
/// [`FitError::Numerical`] for a net without an interpolant (there is none).
pub(super) fn raised(base: &Sheet, net: &Net, heights: &[[f64; 1]]) -> Result<Sheet, FitError> {
    let [nu, nv] = net.counts();
    let field = Sheet::of_heights(net, heights);
    let mut grid = vec![[0.0; 3]; nu * nv];
    for i in 0..nu {
        for j in 0..nv {
            let at = [net.knots[0].greville(i), net.knots[1].greville(j)];
            let tangents = base.tangents(at);
            let normal = tangents.normal().unwrap_or_else(Vector3::zeros);
            let place = tangents.point + normal * field.point(at).z;
            grid[i * nv + j] = place.into();
        }
    }
    let [along_u, along_v] = [collocation(&net.knots[0])?, collocation(&net.knots[1])?];
    for row in grid.chunks_mut(nv) {
        along_v.solve_in_place(row);
    }
    let mut control = vec![Vector3::zeros(); nu * nv];
    for j in 0..nv {
        let mut column: Vec<[f64; 3]> = (0..nu).map(|i| grid[i * nv + j]).collect();
        along_u.solve_in_place(&mut column);
        for (i, p) in column.into_iter().enumerate() {
            control[net.index(i, j)] = Vector3::from(p);
        }
    }
    Ok(Sheet {
        net: net.clone(),
        control,
        plane: false,
    })
}

/// The basis at its Greville abscissae, factored.
fn collocation(knots: &Knots) -> Result<BandedLu, FitError> {
    let (n, degree) = (knots.control_count(), knots.degree());
    let mut matrix = BandedMatrix::new(n, degree, degree);
    for i in 0..n {
        let row = basis_jet::<1>(knots, knots.greville(i));
        for (k, b) in row.values().iter().enumerate().filter(|(_, b)| **b != 0.0) {
            matrix.add(i, row.first + k, *b);
        }
    }
    matrix
        .factor()
        .map_err(|e| FitError::Numerical(e.to_string()))
}
