//! Nets as they are given: rows and columns of a mesh, and quads that are none.

use super::faults::{
    FACES, POINTS, VERTICES, indexed, issue, of_grid_fault, of_mesh_error, of_mesh_fault,
};
use super::{Levels, Task};
use crate::geometry::mesh::{Face, Manifold, Mesh, QuadGrid};
use crate::methods::Issue;
use crate::methods::curvature_net::net::Layout;
use crate::methods::curvature_net::request::{Grid, QuadMesh};
use nalgebra::{Point3, Vector3};

/// Edges shorter than this share of the mean are mistakes.
pub(super) const SHORTEST_EDGE: f64 = 1e-6;

/// Least sine of the angle between two sides at a corner: below, two lines of
/// the net fall into one. About half a degree.
pub(super) const LEAST_SINE: f64 = 0.01;

/// Of a long list of faults the first that many are named.
pub(super) const NAMED: usize = 20;

/// A net in the user's scale.
pub(super) struct Read {
    pub(super) layout: Layout,
    pub(super) points: Vec<Point3<f64>>,
    pub(super) given: Vec<usize>,
    /// Where the vertices stand in the request.
    pub(super) path: [&'static str; 3],
}

/// Rows and columns of a mesh, or why it has none.
pub(super) fn from_mesh(mesh: &QuadMesh) -> Result<Read, Vec<Issue>> {
    let mut issues = Vec::new();
    let mut faces = Vec::with_capacity(mesh.faces.len());
    for (f, corners) in mesh.faces.iter().enumerate() {
        match Face::of(corners) {
            Some(face) if corners.len() == 4 => faces.push(face),
            _ => issues.push(indexed(
                FACES,
                f,
                "not-a-quad",
                format!(
                    "face {f} has {} corners: only quads make rows and columns",
                    corners.len()
                ),
            )),
        }
    }
    issues.truncate(NAMED);
    if !issues.is_empty() {
        return Err(issues);
    }
    let built = Mesh::new(mesh.vertices.clone(), faces).map_err(|e| vec![of_mesh_error(&e)])?;
    let unused = unused_vertices(&built);
    if !unused.is_empty() {
        return Err(unused);
    }
    let surface = Manifold::of(built).map_err(|e| vec![of_mesh_fault(&e)])?;
    let grid = QuadGrid::of(&surface).map_err(|e| of_grid_fault(&e))?;
    Ok(Read {
        layout: Layout {
            rows: grid.rows,
            columns: grid.columns,
            closed: grid.closed,
        },
        points: grid.vertices.iter().map(|v| mesh.vertices[*v]).collect(),
        given: grid.vertices,
        path: VERTICES,
    })
}

pub(super) fn unused_vertices(mesh: &Mesh) -> Vec<Issue> {
    let mut used = vec![false; mesh.vertices().len()];
    let corners = mesh.faces().iter().flat_map(|f| f.corners());
    corners.for_each(|v| used[*v] = true);
    let unused = used.iter().enumerate().filter(|(_, used)| !**used);
    let told = unused.take(NAMED).map(|(v, _)| {
        let message = format!("vertex {v} belongs to no face");
        indexed(VERTICES, v, "unused-vertex", message)
    });
    told.collect()
}

/// The rows of a grid, or what is wrong with them.
pub(super) fn from_grid(grid: &Grid) -> Result<Read, Vec<Issue>> {
    let mut issues = Vec::new();
    let sides = [("rows", grid.rows), ("columns", grid.columns)];
    for ((name, count), closed) in sides.into_iter().zip(grid.closed) {
        let least = if closed { 3 } else { 2 };
        if count < least {
            let message = format!("the grid has {count} {name}, but {least} are needed");
            issues.push(issue(&["input", "grid", name], "too-small", message, None));
        }
    }
    let wanted = grid.rows.checked_mul(grid.columns);
    if wanted != Some(grid.points.len()) {
        let message = format!(
            "{} rows of {} points are not {} points",
            grid.rows,
            grid.columns,
            grid.points.len()
        );
        issues.push(issue(&POINTS, "wrong-count", message, None));
    }
    for (k, p) in grid.points.iter().enumerate() {
        if p.iter().any(|x| !x.is_finite()) && issues.len() < NAMED {
            let message = format!("point {k} has a coordinate that is not a finite number");
            issues.push(indexed(POINTS, k, "not-finite", message));
        }
    }
    if !issues.is_empty() {
        return Err(issues);
    }
    Ok(Read {
        layout: Layout {
            rows: grid.rows,
            columns: grid.columns,
            closed: grid.closed,
        },
        points: grid.points.clone(),
        given: (0..grid.points.len()).collect(),
        path: POINTS,
    })
}

impl Read {
    pub(super) fn in_unit_scale(self, levels: Levels, issues: &mut Vec<Issue>) -> Option<Task> {
        let count = self.points.len() as f64;
        let middle = self
            .points
            .iter()
            .fold(Vector3::zeros(), |m, p| m + p.coords / count);
        let edges: Vec<f64> = [0, 1]
            .into_iter()
            .flat_map(|d| self.layout.edges(d))
            .map(|[a, b]| (self.points[b] - self.points[a]).norm())
            .collect();
        let size = edges.iter().map(|e| e / edges.len() as f64).sum::<f64>();
        if !(size > 0.0 && size.is_finite() && middle.iter().all(|x| x.is_finite())) {
            let message = format!("the mean length of an edge is {size}");
            issues.push(issue(&self.path[..2], "no-extent", message, None));
            return None;
        }
        issues.extend(self.degenerate_quads(size));
        let unit = |p: &Point3<f64>| Point3::from((p.coords - middle) / size);
        Some(Task {
            points: self.points.iter().map(unit).collect(),
            middle,
            size,
            layout: self.layout,
            given: self.given,
            levels,
            target: None,
        })
    }

    /// Quads with a side of no length or two sides on one another.
    pub(super) fn degenerate_quads(&self, size: f64) -> Vec<Issue> {
        let bad = self.layout.patches().filter_map(|(i, j)| {
            let [a, b, d, c] = self.layout.corners(i, j);
            self.fault_of_quad([a, b, c, d], size)
        });
        bad.take(NAMED).collect()
    }

    fn fault_of_quad(&self, ring: [usize; 4], size: f64) -> Option<Issue> {
        let name = ring.map(|k| self.given[k]);
        let quad = format!(
            "the quad of the vertices {}, {}, {}, {}",
            name[0], name[1], name[2], name[3]
        );
        let p = |at: usize| self.points[ring[at % 4]].coords / size;
        for here in 0..4 {
            if (p(here + 1) - p(here)).norm() > SHORTEST_EDGE {
                continue;
            }
            let message = format!(
                "{quad} has a side without length, between the vertices {} and {}",
                name[here],
                name[(here + 1) % 4]
            );
            let mut found = indexed(self.path, name[here], "degenerate-quad", message);
            if self.layout.closed.contains(&true) && self.path == POINTS {
                found.hint = Some("a closed grid does not repeat its first row".to_owned());
            }
            return Some(found);
        }
        for (here, vertex) in name.iter().enumerate() {
            let (on, back) = (p(here + 1) - p(here), p(here + 3) - p(here));
            let sine = on.cross(&back).norm() / (on.norm() * back.norm());
            if sine.is_nan() || sine < LEAST_SINE {
                let message =
                    format!("{quad} has collapsed: its sides at vertex {vertex} lie in one line");
                return Some(indexed(self.path, *vertex, "degenerate-quad", message));
            }
        }
        None
    }
}
