//! Cuts a ring open along edges of its mesh.

use super::{Strip, at, issue};
use crate::geometry::{Face, Manifold, Mesh};
use crate::methods::Issue;
use nalgebra::{Point3, distance};
use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet, BinaryHeap};

/// Cuts a ring: the shortest way across, or the shortest through the vertex
/// nearest to a place.
///
/// # Errors
/// The mesh is so coarse that a cut would part it otherwise.
pub(super) fn ring(surface: &Manifold, place: Option<&Point3<f64>>) -> Result<Strip, Issue> {
    let path = path(surface, place).ok_or_else(too_coarse)?;
    let (first, last) = (path[0], path[path.len() - 1]);
    let vertices = surface.mesh().vertices();
    let warning = format!(
        "This is a closed ring; it was cut along {} edges from {} to {}{}.",
        path.len() - 1,
        at(&vertices[first]),
        at(&vertices[last]),
        match place {
            Some(_) => "",
            None => ", the shortest way across; \"cut\" moves it",
        }
    );
    let (mesh, twins) = opened(surface, &path);
    let opened = Manifold::of(mesh).map_err(|_| too_coarse())?;
    if opened.boundary_loops().len() != 1 || opened.component_count() != 1 {
        return Err(too_coarse());
    }
    // The faces left of the path have its twins: on the outline the path runs
    // backwards beside them, and forwards beside the others.
    let corners = [twins[&last], twins[&first], first, last];
    let corners = in_order(&opened, corners);
    Ok(Strip {
        surface: opened,
        corners: Some(corners),
        warnings: vec![warning],
        closed: true,
        place: "mesh",
    })
}

fn too_coarse() -> Issue {
    let message = "this is a closed ring, but its mesh is too coarse to be cut across".to_owned();
    let hint = "send a finer mesh, or one that is open at a ruling";
    issue("mesh", "ring", message, Some(hint))
}

/// The corners so that the first two bound an end in the outline's direction.
fn in_order(surface: &Manifold, corners: [usize; 4]) -> [usize; 4] {
    let ring = &surface.boundary_loops()[0];
    let index = |v: usize| ring.iter().position(|w| *w == v).unwrap_or(0);
    let [a, b, c, d] = corners;
    let length = ring.len();
    // Going on from a, its end's other corner b comes before c and d.
    let after = |v: usize| (index(v) + length - index(a)) % length;
    if after(b) < after(c) && after(b) < after(d) {
        [a, b, c, d]
    } else {
        [b, a, d, c]
    }
}

/// A simple path across the ring, touching the boundary at its ends alone.
fn path(surface: &Manifold, place: Option<&Point3<f64>>) -> Option<Vec<usize>> {
    let [first, second] = surface.boundary_loops() else {
        return None;
    };
    let [first, second] = [first, second].map(|l| l.iter().copied().collect::<BTreeSet<_>>());
    let Some(place) = place else {
        let starts: Vec<usize> = first.iter().copied().collect();
        return way(surface, &starts, &second).map(|w| shortened(w, [&first, &second]));
    };
    let vertices = surface.mesh().vertices();
    let nearest = (0..vertices.len())
        .min_by(|a, b| distance(&vertices[*a], place).total_cmp(&distance(&vertices[*b], place)))?;
    let back = way(surface, &[nearest], &first)?;
    let on = way(surface, &[nearest], &second)?;
    let shared = back.iter().zip(&on).take_while(|(a, b)| a == b).count();
    let mut whole: Vec<usize> = back[shared - 1..].iter().rev().copied().collect();
    whole.extend(&on[shared..]);
    Some(shortened(whole, [&first, &second]))
}

/// The part of a way between the last vertex on the first loop and the next on
/// the second.
fn shortened(way: Vec<usize>, [first, second]: [&BTreeSet<usize>; 2]) -> Vec<usize> {
    let from = way.iter().rposition(|v| first.contains(v)).unwrap_or(0);
    let to = way[from..].iter().position(|v| second.contains(v));
    let to = to.map_or(way.len() - 1, |t| from + t);
    way[from..=to].to_vec()
}

/// A vertex with the length of the way to it; the shortest first, then the
/// smallest index.
#[derive(PartialEq)]
struct Reached(f64, usize);

impl Eq for Reached {}
impl Ord for Reached {
    fn cmp(&self, other: &Self) -> Ordering {
        other.0.total_cmp(&self.0).then(other.1.cmp(&self.1))
    }
}
impl PartialOrd for Reached {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// The shortest way along edges from one of some vertices to one of others.
fn way(surface: &Manifold, starts: &[usize], goals: &BTreeSet<usize>) -> Option<Vec<usize>> {
    let (mesh, topology) = (surface.mesh(), surface.topology());
    let vertices = mesh.vertices();
    let mut lengths = vec![f64::INFINITY; vertices.len()];
    let mut before = vec![usize::MAX; vertices.len()];
    let mut open = BinaryHeap::new();
    for start in starts {
        lengths[*start] = 0.0;
        open.push(Reached(0.0, *start));
    }
    while let Some(Reached(length, at)) = open.pop() {
        if length > lengths[at] {
            continue;
        }
        if goals.contains(&at) {
            let mut way = vec![at];
            while before[way[way.len() - 1]] != usize::MAX {
                way.push(before[way[way.len() - 1]]);
            }
            way.reverse();
            return Some(way);
        }
        let sides = topology
            .faces_at_vertex(at)
            .iter()
            .flat_map(|f| mesh.faces()[*f].sides());
        for (a, b) in sides.filter(|(a, b)| *a == at || *b == at) {
            let next = if a == at { b } else { a };
            let there = length + distance(&vertices[at], &vertices[next]);
            if there < lengths[next] {
                lengths[next] = there;
                before[next] = at;
                open.push(Reached(there, next));
            }
        }
    }
    None
}

/// The mesh with the vertices of a path doubled; the twins belong to the faces
/// on the left of the path.
fn opened(surface: &Manifold, path: &[usize]) -> (Mesh, BTreeMap<usize, usize>) {
    let mesh = surface.mesh();
    let mut vertices = mesh.vertices().to_vec();
    let mut twins = BTreeMap::new();
    for v in path {
        twins.insert(*v, vertices.len());
        vertices.push(mesh.vertices()[*v]);
    }
    let cuts: BTreeSet<[usize; 2]> = path
        .windows(2)
        .map(|w| [w[0].min(w[1]), w[0].max(w[1])])
        .collect();
    let mut faces = mesh.faces().to_vec();
    for v in path {
        for face in left_of(surface, path, *v, &cuts) {
            faces[face] = with_twin(faces[face], *v, twins[v]);
        }
    }
    (Mesh::new(vertices, faces).unwrap_or_default(), twins)
}

fn with_twin(face: Face, vertex: usize, twin: usize) -> Face {
    let changed: Vec<usize> = (face.corners().iter())
        .map(|c| if *c == vertex { twin } else { *c })
        .collect();
    Face::of(&changed).unwrap_or(face)
}

/// The faces round a vertex of the path that lie to the left of the path: those
/// that a side of the path belongs to, and on from them without crossing it.
fn left_of(
    surface: &Manifold,
    path: &[usize],
    vertex: usize,
    cuts: &BTreeSet<[usize; 2]>,
) -> Vec<usize> {
    let (mesh, topology) = (surface.mesh(), surface.topology());
    let around = topology.faces_at_vertex(vertex);
    let forwards = |side: (usize, usize)| path.windows(2).any(|w| (w[0], w[1]) == side);
    let is_left = |f: &usize| {
        let mut sides = mesh.faces()[*f].sides();
        sides.any(|side| (side.0 == vertex || side.1 == vertex) && forwards(side))
    };
    let mut left: Vec<usize> = around.iter().copied().filter(is_left).collect();
    let mut at = 0;
    while at < left.len() {
        for (a, b) in mesh.faces()[left[at]].sides() {
            let key = [a.min(b), a.max(b)];
            if (a != vertex && b != vertex) || cuts.contains(&key) {
                continue;
            }
            let Some(edge) = topology.edge_between(a, b) else {
                continue;
            };
            for other in topology.faces_at_edge(edge) {
                if !left.contains(other) {
                    left.push(*other);
                }
            }
        }
        at += 1;
    }
    left
}
