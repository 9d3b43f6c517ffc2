//! Edges, and the faces that meet at edges and vertices: facts about any mesh.

use super::Mesh;

/// Which faces meet where.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Topology {
    /// Vertices of each edge, the smaller first; ascending.
    edges: Vec<[usize; 2]>,
    at_edge: Groups,
    at_vertex: Groups,
}

/// Lists of indices, one after the other.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Groups {
    /// Where each list begins, and the end of the last.
    starts: Vec<usize>,
    items: Vec<usize>,
}

impl Groups {
    fn get(&self, group: usize) -> &[usize] {
        &self.items[self.starts[group]..self.starts[group + 1]]
    }

    /// Groups `(group, item)` pairs; the items of a group keep their order.
    fn new(count: usize, pairs: impl Iterator<Item = (usize, usize)> + Clone) -> Groups {
        let mut starts = vec![0; count + 1];
        for (group, _) in pairs.clone() {
            starts[group + 1] += 1;
        }
        for group in 0..count {
            starts[group + 1] += starts[group];
        }
        let mut next = starts.clone();
        let mut items = vec![0; starts[count]];
        for (group, item) in pairs {
            items[next[group]] = item;
            next[group] += 1;
        }
        Groups { starts, items }
    }
}

impl Topology {
    /// The topology of a mesh.
    #[must_use]
    pub fn of(mesh: &Mesh) -> Topology {
        let faces = mesh.faces();
        let mut sides: Vec<([usize; 2], usize)> = faces
            .iter()
            .enumerate()
            .flat_map(|(f, face)| face.sides().map(move |(a, b)| ([a.min(b), a.max(b)], f)))
            .collect();
        sides.sort_unstable();
        let mut edges = Vec::with_capacity(sides.len() / 2 + 1);
        let mut starts = Vec::with_capacity(sides.len() / 2 + 1);
        for (at, (edge, _)) in sides.iter().enumerate() {
            if edges.last() != Some(edge) {
                edges.push(*edge);
                starts.push(at);
            }
        }
        starts.push(sides.len());
        let corners = faces
            .iter()
            .enumerate()
            .flat_map(|(f, face)| face.corners().iter().map(move |v| (*v, f)));
        Topology {
            edges,
            at_edge: Groups {
                starts,
                items: sides.into_iter().map(|(_, face)| face).collect(),
            },
            at_vertex: Groups::new(mesh.vertices().len(), corners),
        }
    }

    /// All edges: their vertices, the smaller first, in ascending order.
    #[must_use]
    pub fn edges(&self) -> &[[usize; 2]] {
        &self.edges
    }

    /// The edge between two vertices, if there is one.
    #[must_use]
    pub fn edge_between(&self, a: usize, b: usize) -> Option<usize> {
        self.edges.binary_search(&[a.min(b), a.max(b)]).ok()
    }

    /// The faces that meet at an edge, ascending.
    #[must_use]
    pub fn faces_at_edge(&self, edge: usize) -> &[usize] {
        self.at_edge.get(edge)
    }

    /// The faces that meet at a vertex, ascending.
    #[must_use]
    pub fn faces_at_vertex(&self, vertex: usize) -> &[usize] {
        self.at_vertex.get(vertex)
    }

    /// Edges with one face.
    pub fn boundary_edges(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.edges.len()).filter(|e| self.faces_at_edge(*e).len() == 1)
    }

    /// The parts that hang together over edges: the part of each face, counted
    /// from 0 in the order of their first faces.
    #[must_use]
    pub fn components(&self, mesh: &Mesh) -> Vec<usize> {
        const NONE: usize = usize::MAX;
        let mut part = vec![NONE; mesh.faces().len()];
        let mut parts = 0;
        let mut open = Vec::new();
        for first in 0..part.len() {
            if part[first] != NONE {
                continue;
            }
            part[first] = parts;
            open.push(first);
            while let Some(face) = open.pop() {
                for other in self.neighbours(mesh, face) {
                    if part[other] == NONE {
                        part[other] = parts;
                        open.push(other);
                    }
                }
            }
            parts += 1;
        }
        part
    }

    /// The faces that share an edge with a face.
    fn neighbours<'a>(&'a self, mesh: &'a Mesh, face: usize) -> impl Iterator<Item = usize> + 'a {
        let edges = mesh.faces()[face].sides();
        let edges = edges.filter_map(|(a, b)| self.edge_between(a, b));
        edges
            .flat_map(|e| self.faces_at_edge(e).iter().copied())
            .filter(move |other| *other != face)
    }
}
