//! Meshes that are surfaces.

use super::{Face, Mesh, MeshFault, Topology};
use std::collections::{BTreeMap, VecDeque};

/// A mesh that is a surface, all its faces turned the same way as the first
/// face of their part.
#[derive(Debug, Clone, PartialEq)]
pub struct Manifold {
    mesh: Mesh,
    topology: Topology,
    components: Vec<usize>,
    loops: Vec<Vec<usize>>,
}

impl Manifold {
    /// Turns the faces the same way and finds the boundary.
    ///
    /// # Errors
    /// The first of: no faces, an edge of three faces, a vertex where parts
    /// touch, a face that cannot be turned.
    pub fn of(mesh: Mesh) -> Result<Manifold, MeshFault> {
        if mesh.faces().is_empty() {
            return Err(MeshFault::NoFaces);
        }
        let topology = Topology::of(&mesh);
        edges_are_simple(&topology)?;
        let mesh = oriented(mesh, &topology)?;
        vertices_are_simple(&mesh, &topology)?;
        Ok(Manifold {
            components: topology.components(&mesh),
            loops: boundary_loops(&mesh, &topology),
            mesh,
            topology,
        })
    }

    /// The mesh, its faces turned.
    #[must_use]
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// Its edges and what meets there.
    #[must_use]
    pub fn topology(&self) -> &Topology {
        &self.topology
    }

    /// The part that each face belongs to, counted from 0.
    #[must_use]
    pub fn components(&self) -> &[usize] {
        &self.components
    }

    /// How many parts there are.
    #[must_use]
    pub fn component_count(&self) -> usize {
        self.components.iter().max().map_or(0, |last| last + 1)
    }

    /// The loops of the boundary: vertices in the direction of the faces, so
    /// that the surface lies to the left. Each begins at its smallest index;
    /// the loops are in the order of these.
    #[must_use]
    pub fn boundary_loops(&self) -> &[Vec<usize>] {
        &self.loops
    }
}

fn edges_are_simple(topology: &Topology) -> Result<(), MeshFault> {
    for (edge, ends) in topology.edges().iter().enumerate() {
        let faces = topology.faces_at_edge(edge);
        if faces.len() > 2 {
            return Err(MeshFault::NonManifoldEdge {
                edge: *ends,
                faces: faces.len(),
                face: faces[0],
            });
        }
    }
    Ok(())
}

/// Turns every face like the first one of its part. Breadth first, so that a
/// contradiction shows where the ways round meet, far from the start.
fn oriented(mesh: Mesh, topology: &Topology) -> Result<Mesh, MeshFault> {
    let Mesh {
        vertices,
        mut faces,
    } = mesh;
    let mut seen = vec![false; faces.len()];
    let mut open = VecDeque::new();
    for first in 0..faces.len() {
        if std::mem::replace(&mut seen[first], true) {
            continue;
        }
        open.push_back(first);
        while let Some(face) = open.pop_front() {
            for (a, b) in faces[face].sides().collect::<Vec<_>>() {
                let across = topology.edge_between(a, b).and_then(|edge| {
                    let faces = topology.faces_at_edge(edge);
                    faces.iter().copied().find(|f| *f != face)
                });
                let Some(other) = across else { continue };
                let agrees = faces[other].sides().any(|side| side == (b, a));
                if !std::mem::replace(&mut seen[other], true) {
                    if !agrees {
                        faces[other] = faces[other].flipped();
                    }
                    open.push_back(other);
                } else if !agrees {
                    return Err(MeshFault::NotOrientable {
                        face,
                        other,
                        edge: [a.min(b), a.max(b)],
                    });
                }
            }
        }
    }
    Ok(Mesh { vertices, faces })
}

/// Each vertex has one fan: following the faces round it from one of them
/// reaches all of them.
fn vertices_are_simple(mesh: &Mesh, topology: &Topology) -> Result<(), MeshFault> {
    for vertex in 0..mesh.vertices().len() {
        let faces = topology.faces_at_vertex(vertex);
        if faces.len() > 1 {
            let fans = fans(mesh.faces(), faces, vertex);
            if fans != 1 {
                return Err(MeshFault::NonManifoldVertex { vertex, fans });
            }
        }
    }
    Ok(())
}

/// How many fans the faces around a vertex make. Every face goes from the edge
/// that leaves the vertex to the one that comes back to it, so a fan is a
/// chain (with one edge that only leaves) or a ring.
fn fans(all: &[Face], faces: &[usize], vertex: usize) -> usize {
    let mut next = BTreeMap::new();
    let mut ends = BTreeMap::new();
    for face in faces {
        let (mut out, mut back) = (vertex, vertex);
        for (a, b) in all[*face].sides() {
            if a == vertex {
                out = b;
            } else if b == vertex {
                back = a;
            }
        }
        next.insert(out, back);
        ends.insert(back, out);
    }
    let chains: Vec<usize> = next
        .keys()
        .filter(|e| !ends.contains_key(e))
        .copied()
        .collect();
    let mut fans = chains.len();
    for start in chains {
        follow(&mut next, start);
    }
    while let Some(start) = next.keys().next().copied() {
        fans += 1;
        follow(&mut next, start);
    }
    fans
}

/// Takes a chain out of the map.
fn follow(next: &mut BTreeMap<usize, usize>, start: usize) {
    let mut at = start;
    while let Some(to) = next.remove(&at) {
        at = to;
    }
}

/// The boundary of an oriented surface; every boundary vertex has one edge
/// that leaves it.
fn boundary_loops(mesh: &Mesh, topology: &Topology) -> Vec<Vec<usize>> {
    let mut next = BTreeMap::new();
    for edge in topology.boundary_edges() {
        let [a, b] = topology.edges()[edge];
        let face = mesh.faces()[topology.faces_at_edge(edge)[0]];
        let forwards = face.sides().any(|side| side == (a, b));
        let (from, to) = if forwards { (a, b) } else { (b, a) };
        next.insert(from, to);
    }
    let mut loops = Vec::new();
    while let Some((start, _)) = next.first_key_value() {
        let mut at = *start;
        let mut ring = Vec::new();
        while let Some(to) = next.remove(&at) {
            ring.push(at);
            at = to;
        }
        loops.push(ring);
    }
    loops
}
