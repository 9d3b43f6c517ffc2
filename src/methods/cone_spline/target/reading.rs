//! From the vertices and faces of a request to one piece of surface.

use super::outline::Outline;
use super::{Strip, at, crease, cut, issue};
use crate::geometry::{Face, Manifold, Mesh, MeshError, MeshFault, Tolerance};
use crate::methods::Issue;
use nalgebra::Point3;

/// Where meshes stand in the request.
const MESH: &str = "mesh";
/// Of a long list of faults the first that many are named.
const NAMED: usize = 20;
/// A face whose height is below this share of the model has no area.
const THINNEST: f64 = 1e-10;
/// A loop of the boundary whose total turn is above this is the outline of a
/// plate with a hole, not one side of a ring, radians. A ring about a cone of
/// half angle α turns by 2π sin α; this is α = 55°.
const RING_TURN: f64 = 5.15;

/// The strip of a mesh.
///
/// # Errors
/// All that keeps it from being one.
pub(super) fn strip(
    vertices: &[Point3<f64>],
    faces: &[Vec<usize>],
    place: Option<&Point3<f64>>,
) -> Result<Strip, Vec<Issue>> {
    let surface = surface(vertices, faces)?;
    match surface.boundary_loops() {
        [_] => {
            let warnings = place.map(|_| NOT_A_RING.to_owned()).into_iter().collect();
            Ok(Strip {
                surface,
                corners: None,
                warnings,
                closed: false,
                place: MESH,
            })
        }
        [first, second] if is_ring(&surface, [first, second]) => {
            cut::ring(&surface, place).map_err(|i| vec![i])
        }
        [] => Err(vec![closed()]),
        _ => Err(holes(&surface)),
    }
}

const NOT_A_RING: &str = "\"cut\" was not needed: the strip is no closed ring.";

/// One piece of clean surface, turned the way most of its area is.
pub(super) fn surface(
    vertices: &[Point3<f64>],
    faces: &[Vec<usize>],
) -> Result<Manifold, Vec<Issue>> {
    let mesh = mesh(vertices, faces).map_err(|i| vec![i])?;
    let unused = named(mesh.unused_vertices());
    if !unused.is_empty() {
        return Err(unused);
    }
    let size = mesh.bounding_box().map_or(0.0, |b| b.longest_side());
    let Some(tolerance) = Tolerance::relative(THINNEST, size) else {
        let message = "all vertices are in one place".to_owned();
        return Err(vec![issue("mesh/vertices", "degenerate", message, None)]);
    };
    let thin = named(mesh.degenerate_faces(tolerance));
    if !thin.is_empty() {
        return Err(thin);
    }
    let given = mesh.faces().to_vec();
    let surface = Manifold::of(mesh).map_err(|fault| vec![of_fault(&fault)])?;
    if surface.component_count() > 1 {
        return Err(vec![components(&surface)]);
    }
    let surface = as_most_are(surface, &given);
    match crease::find(&surface) {
        Some(crease) => Err(vec![crease.issue(&surface)]),
        None => Ok(surface),
    }
}

fn mesh(vertices: &[Point3<f64>], faces: &[Vec<usize>]) -> Result<Mesh, Issue> {
    let mut corners = Vec::with_capacity(faces.len());
    for (f, face) in faces.iter().enumerate() {
        let message = || format!("face {f} has {} corners, not three or four", face.len());
        let wrong = || issue(&format!("mesh/faces/{f}"), "not-a-face", message(), None);
        corners.push(Face::of(face).ok_or_else(wrong)?);
    }
    Mesh::new(vertices.to_vec(), corners).map_err(|error| {
        let message = error.to_string();
        match error {
            MeshError::NotFinite { vertex } => issue(
                &format!("mesh/vertices/{vertex}"),
                "not-finite",
                message,
                None,
            ),
            MeshError::OutOfRange { face, corner, .. } => {
                let place = format!("mesh/faces/{face}/{corner}");
                let hint = "vertices are counted from 0";
                issue(&place, "no-such-vertex", message, Some(hint))
            }
            MeshError::RepeatedCorner { face, .. } => issue(
                &format!("mesh/faces/{face}"),
                "repeated-corner",
                message,
                None,
            ),
        }
    })
}

fn named(faults: Vec<MeshFault>) -> Vec<Issue> {
    faults.iter().take(NAMED).map(of_fault).collect()
}

fn of_fault(fault: &MeshFault) -> Issue {
    let face = |f: &usize| format!("mesh/faces/{f}");
    let vertex = |v: &usize| format!("mesh/vertices/{v}");
    let (place, code, hint) = match fault {
        MeshFault::NoFaces => ("mesh/faces".to_owned(), "no-faces", None),
        MeshFault::NonManifoldEdge { face: f, .. } => (
            face(f),
            "non-manifold-edge",
            Some("a strip has two faces at an edge at most; send one plate at a time"),
        ),
        MeshFault::NonManifoldVertex { vertex: v, .. } => (
            vertex(v),
            "non-manifold-vertex",
            Some("send one plate at a time"),
        ),
        MeshFault::NotOrientable { face: f, .. } => (
            face(f),
            "moebius-band",
            Some("cut the band open along a ruling: give the vertices there twice"),
        ),
        MeshFault::DegenerateFace { face: f } => {
            (face(f), "degenerate-face", Some("leave the face out"))
        }
        MeshFault::UnusedVertex { vertex: v } => {
            (vertex(v), "unused-vertex", Some("leave the vertex out"))
        }
        MeshFault::DuplicateVertices { second, .. } => (
            vertex(second),
            "duplicate-vertex",
            Some("use one vertex for both"),
        ),
    };
    issue(&place, code, fault.to_string(), hint)
}

fn components(surface: &Manifold) -> Issue {
    let count = surface.component_count();
    let second = surface
        .components()
        .iter()
        .position(|c| *c == 1)
        .unwrap_or(0);
    let twins = surface.mesh().duplicate_vertices();
    let message =
        format!("the mesh has {count} separate pieces; face {second} is the first of the second");
    let hint = match twins.first() {
        Some(MeshFault::DuplicateVertices { first, second }) => format!(
            "the vertices {first} and {second} are in one place, as are {} more: where pieces belong \
             together, use one vertex for both",
            twins.len() - 1
        ),
        _ => "send one strip at a time".to_owned(),
    };
    issue(
        &format!("mesh/faces/{second}"),
        "several-pieces",
        message,
        Some(&hint),
    )
}

/// [`Manifold`] turns all faces like the first; here they are turned like
/// most of the area, so that the order of the faces does not matter.
fn as_most_are(surface: Manifold, given: &[Face]) -> Manifold {
    let mesh = surface.mesh();
    let signed = |(f, face): (usize, &Face)| {
        let area = mesh.area_vector(f).norm();
        if *face == given[f] { area } else { -area }
    };
    let kept: f64 = mesh.faces().iter().enumerate().map(signed).sum();
    if kept >= 0.0 {
        return surface;
    }
    let faces = mesh.faces().iter().map(|f| f.flipped()).collect();
    let flipped = Mesh::new(mesh.vertices().to_vec(), faces).ok();
    flipped
        .and_then(|m| Manifold::of(m).ok())
        .unwrap_or(surface)
}

/// Whether two loops are the sides of a ring, not an outline and a hole.
fn is_ring(surface: &Manifold, loops: [&Vec<usize>; 2]) -> bool {
    let [a, b] = loops.map(|l| Outline::along(surface, l.clone()));
    let area: f64 = surface.mesh().vertex_areas().iter().sum();
    let shorter = a.length().min(b.length());
    let width = 2.0 * area / (a.length() + b.length());
    // A hole is far from the ends of its plate.
    let narrow = width < shorter;
    narrow
        && [&a, &b]
            .iter()
            .all(|l| total_turn(surface, l).abs() < RING_TURN)
}

/// The sum of π − (inner angle) over a loop.
fn total_turn(surface: &Manifold, outline: &Outline) -> f64 {
    let mesh = surface.mesh();
    let angle = |vertex: usize| {
        let faces = surface.topology().faces_at_vertex(vertex).iter();
        faces.map(|f| corner_angle(mesh, *f, vertex)).sum::<f64>()
    };
    let turns = outline
        .vertices
        .iter()
        .map(|v| std::f64::consts::PI - angle(*v));
    turns.sum()
}

fn corner_angle(mesh: &Mesh, face: usize, vertex: usize) -> f64 {
    let corners = mesh.faces()[face].corners();
    let Some(i) = corners.iter().position(|c| *c == vertex) else {
        return 0.0;
    };
    let n = corners.len();
    let p = mesh.vertices()[vertex];
    let to = |k: usize| mesh.vertices()[corners[k % n]] - p;
    to(i + 1).angle(&to(i + n - 1))
}

fn closed() -> Issue {
    let message = "the mesh is closed: it has no boundary, so it is no strip".to_owned();
    issue(MESH, "not-a-strip", message, Some("cut a plate out of it"))
}

/// All loops but the longest, or all but two where it is a ring with holes.
fn holes(surface: &Manifold) -> Vec<Issue> {
    let mut loops: Vec<Outline> = (surface.boundary_loops().iter())
        .map(|l| Outline::along(surface, l.clone()))
        .collect();
    loops.sort_by(|a, b| b.length().total_cmp(&a.length()));
    let told = loops[1..].iter().take(NAMED).map(|hole| {
        let middle = hole
            .points
            .iter()
            .map(|p| p.coords)
            .sum::<nalgebra::Vector3<f64>>();
        let middle = Point3::from(middle / hole.len() as f64);
        let vertex = hole.vertices[0];
        let message = format!(
            "there is a hole of {} edges round {}, {:.6} around; vertex {vertex} is on its edge",
            hole.len(),
            at(&middle),
            hole.length()
        );
        let hint = "close it, fit, and cut it out of the flat pattern";
        issue(
            &format!("mesh/vertices/{vertex}"),
            "hole",
            message,
            Some(hint),
        )
    });
    told.collect()
}
