//! A ruled B-spline surface as a strip: a mesh on it, in rows of rulings.

use super::{Strip, at, crease, issue};
use crate::geometry::{Axis, BSplineSurface, Face, Manifold, Mesh};
use crate::methods::Issue;
use nalgebra::{Point3, distance};

/// Where surfaces stand in the request.
const SURFACE: &str = "surface";
/// Rulings at least, and in every span.
const LEAST_RULINGS: usize = 120;
const IN_A_SPAN: usize = 6;
/// Rulings at most, for surfaces of very many spans.
const MOST_RULINGS: usize = 4000;
/// Points of a ruling.
const ACROSS: usize = 9;
/// A ruling shorter than this share of the longest is a point.
const POINT: f64 = 1e-9;

/// The strip of a surface whose v runs along straight rulings.
///
/// # Errors
/// The surface is not ruled so, or has a crease or a point inside.
pub(super) fn strip(surface: &BSplineSurface) -> Result<Strip, Vec<Issue>> {
    let [u, v] = surface.degrees();
    if v != 1 || surface.counts()[1] != 2 {
        let message = format!(
            "this surface is not ruled: it has degree [{u}, {v}] and {} rows of control points, not \
             degree [{u}, 1] and two rows",
            surface.counts()[1]
        );
        let hint = "write it so that v runs along the rulings, from one side to the other";
        return Err(vec![issue(SURFACE, "not-ruled", message, Some(hint))]);
    }
    let stations = stations(surface);
    let rows: Vec<[Point3<f64>; 2]> = (stations.iter())
        .map(|u| surface.domain(Axis::V).map(|v| surface.point(*u, v)))
        .collect();
    let (mesh, corners, warnings) = mesh(surface, &stations, &rows).map_err(|i| vec![i])?;
    let built = Manifold::of(mesh).map_err(|fault| {
        let message = format!("the surface cannot be meshed: {fault}");
        vec![issue(SURFACE, "degenerate", message, None)]
    })?;
    if let Some(crease) = crease::find(&built) {
        let mut found = crease.issue(&built);
        found.path.truncate(2);
        found.path[1] = SURFACE.to_owned();
        return Err(vec![found]);
    }
    let closed = [0, 1].iter().all(|i| {
        let (first, last) = (rows[0][*i], rows[rows.len() - 1][*i]);
        distance(&first, &last) <= POINT * longest(&rows)
    });
    Ok(Strip {
        surface: built,
        corners: Some(corners),
        warnings,
        closed,
        place: SURFACE,
    })
}

fn longest(rows: &[[Point3<f64>; 2]]) -> f64 {
    rows.iter().map(|[p, q]| distance(p, q)).fold(0.0, f64::max)
}

/// Parameters of the rulings: every knot, and more between.
fn stations(surface: &BSplineSurface) -> Vec<f64> {
    let breaks = surface.knot_vector(Axis::U).breakpoints();
    let spans = breaks.len().max(2) - 1;
    let each = IN_A_SPAN
        .max(LEAST_RULINGS.div_ceil(spans))
        .min((MOST_RULINGS / spans).max(1));
    let within = |w: &[f64]| {
        let (a, b) = (w[0], w[1]);
        (0..each).map(move |i| a + (b - a) * i as f64 / each as f64)
    };
    let mut stations: Vec<f64> = breaks.windows(2).flat_map(within).collect();
    stations.extend(breaks.last());
    stations
}

type Meshed = (Mesh, [usize; 4], Vec<String>);

/// Rows of triangles; an end that is a point is one vertex.
fn mesh(
    surface: &BSplineSurface,
    stations: &[f64],
    rows: &[[Point3<f64>; 2]],
) -> Result<Meshed, Issue> {
    let tolerance = POINT * longest(rows);
    let is_point = |i: usize| distance(&rows[i][0], &rows[i][1]) <= tolerance;
    let last = rows.len() - 1;
    if let Some(i) = (1..last).find(|i| is_point(*i)) {
        let message = format!(
            "the two sides meet inside, at u = {} and {}",
            stations[i],
            at(&rows[i][0])
        );
        return Err(issue(
            SURFACE,
            "sides-meet",
            message,
            Some("cut the plate there"),
        ));
    }
    let [v0, v1] = surface.domain(Axis::V);
    let mut vertices = Vec::new();
    let mut index = Vec::with_capacity(rows.len());
    let mut warnings = Vec::new();
    for (i, u) in stations.iter().enumerate() {
        if is_point(i) {
            warnings.push(format!(
                "The strip runs out in a point at {}.",
                at(&rows[i][0])
            ));
            index.push([vertices.len(); ACROSS]);
            vertices.push(rows[i][0]);
            continue;
        }
        let start = vertices.len();
        index.push(std::array::from_fn(|j| start + j));
        vertices.extend((0..ACROSS).map(|j| {
            let share = j as f64 / (ACROSS - 1) as f64;
            surface.point(*u, v0 + (v1 - v0) * share)
        }));
    }
    let mut faces = Vec::new();
    for pair in index.windows(2) {
        for j in 1..ACROSS {
            let ([a, b], [d, c]) = ([pair[0][j - 1], pair[1][j - 1]], [pair[0][j], pair[1][j]]);
            let triangles = [[a, b, c], [a, c, d]];
            let real = triangles
                .iter()
                .filter(|t| t[0] != t[1] && t[1] != t[2] && t[0] != t[2]);
            faces.extend(real.map(|t| Face::Triangle(*t)));
        }
    }
    let corners = corners(&index);
    let mesh = Mesh::new(vertices, faces)
        .map_err(|e| issue(SURFACE, "degenerate", e.to_string(), None))?;
    Ok((mesh, corners, warnings))
}

/// In the direction of the outline: along v = 0 forwards, over the finish,
/// back along v = 1, over the start. The first two bound the finish. An end
/// that is a point takes its neighbours.
fn corners(index: &[[usize; ACROSS]]) -> [usize; 4] {
    let last = index.len() - 1;
    let whole = |i: usize| index[i][0] != index[i][ACROSS - 1];
    let finish = if whole(last) { last } else { last - 1 };
    let start = usize::from(!whole(0));
    [
        index[finish][0],
        index[finish][ACROSS - 1],
        index[start][ACROSS - 1],
        index[start][0],
    ]
}
