//! Creases: edges where the surface is bent far more sharply than beside them.

use super::{at, issue};
use crate::geometry::{BoundingBox, Manifold};
use crate::methods::Issue;
use nalgebra::{Vector3, center};
use std::collections::BTreeMap;

/// An edge that is a crease.
#[derive(Debug, Clone, Copy)]
pub(super) struct Crease {
    edge: usize,
    /// Angle between the faces' normals, radians.
    angle: f64,
}

/// Least angle of a crease, radians: 30°. A coarse mesh bends so from face to
/// face.
const LEAST_ANGLE: f64 = 0.52;
/// A crease is sharper than all edges near it that do not touch it, by this
/// factor.
const SHARPER: f64 = 2.5;
/// A crease is at least so long, in mean widths of the strip: a few odd
/// vertices are noise.
const LEAST_LENGTH: f64 = 0.6;
/// An angle that is a fold, radians: 150°.
const FOLD: f64 = 2.6;

impl Crease {
    pub(super) fn issue(self, surface: &Manifold) -> Issue {
        let [a, b] = surface.topology().edges()[self.edge];
        let vertices = surface.mesh().vertices();
        let face = surface.topology().faces_at_edge(self.edge)[0];
        let folds = self.angle > FOLD;
        let message = format!(
            "the surface {} of {:.0}° at the edge between the vertices {a} and {b}, at {}",
            if folds {
                "folds back: a turn"
            } else {
                "has a crease"
            },
            self.angle.to_degrees(),
            at(&center(&vertices[a], &vertices[b]))
        );
        let hint = if folds {
            "mend the mesh there: its two sides cross"
        } else {
            "a rolled plate has none: send the plates on both sides of it one by one"
        };
        issue(&format!("mesh/faces/{face}"), "crease", message, Some(hint))
    }
}

/// The sharpest crease of a surface.
pub(super) fn find(surface: &Manifold) -> Option<Crease> {
    let mesh = surface.mesh();
    let normals: Vec<Vector3<f64>> = (0..mesh.faces().len())
        .map(|f| {
            let area = mesh.area_vector(f);
            area.try_normalize(0.0).unwrap_or_else(Vector3::zeros)
        })
        .collect();
    let angle = |edge: usize| match surface.topology().faces_at_edge(edge) {
        [f, g] => normals[*f].angle(&normals[*g]),
        _ => 0.0,
    };
    let creases: Vec<Crease> = (0..surface.topology().edges().len())
        .map(|edge| Crease {
            edge,
            angle: angle(edge),
        })
        .filter(|c| c.angle > LEAST_ANGLE)
        .filter(|c| c.angle > SHARPER * beside(surface, c.edge, &angle))
        .collect();
    let long = LEAST_LENGTH * mean_width(surface);
    let lines = lines(surface, &creases).into_iter();
    let sharpest = |line: Vec<Crease>| {
        let by_angle =
            |a: &Crease, b: &Crease| a.angle.total_cmp(&b.angle).then(b.edge.cmp(&a.edge));
        line.into_iter().max_by(by_angle)
    };
    let found = lines
        .filter(|line| extent(surface, line) >= long)
        .filter_map(sharpest);
    found.max_by(|a, b| a.angle.total_cmp(&b.angle).then(b.edge.cmp(&a.edge)))
}

/// Twice the area by the length of the boundary.
fn mean_width(surface: &Manifold) -> f64 {
    let area: f64 = surface.mesh().vertex_areas().iter().sum();
    let topology = surface.topology();
    let length = |e: usize| extent_of(surface, &topology.edges()[e]);
    2.0 * area / topology.boundary_edges().map(length).sum::<f64>()
}

/// Creases that hang together, each line by itself.
fn lines(surface: &Manifold, creases: &[Crease]) -> Vec<Vec<Crease>> {
    let mut at_vertex: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    let ends = |c: usize| surface.topology().edges()[creases[c].edge];
    for c in 0..creases.len() {
        for v in ends(c) {
            at_vertex.entry(v).or_default().push(c);
        }
    }
    let mut seen = vec![false; creases.len()];
    let mut lines = Vec::new();
    for first in 0..creases.len() {
        let mut open = vec![first];
        let mut line = Vec::new();
        while let Some(c) = open.pop() {
            if !std::mem::replace(&mut seen[c], true) {
                line.push(creases[c]);
                open.extend(ends(c).iter().flat_map(|v| &at_vertex[v]));
            }
        }
        lines.push(line);
    }
    lines
}

/// The diagonal of the box around a line.
fn extent(surface: &Manifold, line: &[Crease]) -> f64 {
    let edges = surface.topology().edges();
    let vertices: Vec<usize> = line.iter().flat_map(|c| edges[c.edge]).collect();
    extent_of(surface, &vertices)
}

fn extent_of(surface: &Manifold, vertices: &[usize]) -> f64 {
    let points = vertices.iter().map(|v| &surface.mesh().vertices()[*v]);
    BoundingBox::of(points).map_or(0.0, |b| b.diagonal())
}

/// The largest angle at the edges of the two faces and of their neighbours
/// that do not touch the edge: those across a crease do, those along a bend do
/// not.
fn beside(surface: &Manifold, edge: usize, angle: &impl Fn(usize) -> f64) -> f64 {
    let (mesh, topology) = (surface.mesh(), surface.topology());
    let ends = topology.edges()[edge];
    let edges_of = |face: usize| {
        let sides = mesh.faces()[face].sides();
        sides.filter_map(|(a, b)| topology.edge_between(a, b))
    };
    let touches = |e: usize| topology.edges()[e].iter().any(|v| ends.contains(v));
    let mut largest = 0.0_f64;
    for face in topology.faces_at_edge(edge) {
        for own in edges_of(*face).filter(|e| *e != edge) {
            if !touches(own) {
                largest = largest.max(angle(own));
            }
            for other in topology.faces_at_edge(own).iter().filter(|f| *f != face) {
                let far = edges_of(*other).filter(|e| !touches(*e));
                largest = far.map(angle).fold(largest, f64::max);
            }
        }
    }
    largest
}
