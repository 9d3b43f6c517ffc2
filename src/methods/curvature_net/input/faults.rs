//! Faults of the geometry as issues of the request.

use crate::geometry::mesh::{MeshError, MeshFault, QuadGridFault};
use crate::methods::Issue;
use crate::methods::curvature_net::target::Fault;

pub(super) fn issue(
    path: &[&str],
    code: &'static str,
    message: String,
    hint: Option<&str>,
) -> Issue {
    Issue {
        path: path.iter().map(|p| (*p).to_owned()).collect(),
        code,
        message,
        hint: hint.map(str::to_owned),
    }
}

pub(super) fn indexed(path: [&str; 3], index: usize, code: &'static str, message: String) -> Issue {
    let mut found = issue(&path, code, message, None);
    found.path.push(index.to_string());
    found
}

pub(super) const VERTICES: [&str; 3] = ["input", "mesh", "vertices"];

pub(super) const FACES: [&str; 3] = ["input", "mesh", "faces"];

pub(super) const POINTS: [&str; 3] = ["input", "grid", "points"];

pub(super) fn of_mesh_error(error: &MeshError) -> Issue {
    let message = error.to_string();
    match error {
        MeshError::NotFinite { vertex } => indexed(VERTICES, *vertex, "not-finite", message),
        MeshError::OutOfRange { face, .. } => indexed(FACES, *face, "no-such-vertex", message),
        MeshError::RepeatedCorner { face, .. } => indexed(FACES, *face, "degenerate-quad", message),
    }
}

pub(super) fn of_target_fault(path: [&str; 3], fault: &Fault) -> Issue {
    let in_list = |list: &str, index: usize, code, message: String| {
        let mut found = issue(&path, code, message, None);
        found.path.extend([list.to_owned(), index.to_string()]);
        found
    };
    match fault {
        Fault::Empty => issue(
            &path,
            "no-faces",
            "the target has no faces".to_owned(),
            None,
        ),
        Fault::Corners { face, corners } => {
            let message = format!("face {face} has {corners} corners, not three or four");
            in_list("faces", *face, "wrong-corners", message)
        }
        Fault::Mesh(error) => match error {
            MeshError::NotFinite { vertex } => {
                in_list("vertices", *vertex, "not-finite", error.to_string())
            }
            MeshError::OutOfRange { face, .. } => {
                in_list("faces", *face, "no-such-vertex", error.to_string())
            }
            MeshError::RepeatedCorner { face, .. } => {
                in_list("faces", *face, "repeated-corner", error.to_string())
            }
        },
    }
}

pub(super) fn of_mesh_fault(fault: &MeshFault) -> Issue {
    let message = fault.to_string();
    match fault {
        MeshFault::NonManifoldEdge { face, .. } => indexed(FACES, *face, "not-a-surface", message),
        MeshFault::NotOrientable { face, .. } => indexed(FACES, *face, "one-sided", message),
        MeshFault::NonManifoldVertex { vertex, .. } => {
            indexed(VERTICES, *vertex, "not-a-surface", message)
        }
        _ => issue(&FACES, "not-a-surface", message, None),
    }
}

pub(super) fn of_grid_fault(fault: &QuadGridFault) -> Vec<Issue> {
    let at = |v: usize, code| indexed(VERTICES, v, code, String::new());
    let (mut first, hint) = match fault {
        QuadGridFault::NotAQuad { face, .. } => {
            (indexed(FACES, *face, "not-a-quad", String::new()), None)
        }
        QuadGridFault::Parts { face, .. } => (
            indexed(FACES, *face, "several-parts", String::new()),
            Some("send each part as a job of its own"),
        ),
        QuadGridFault::Singular { vertices } => (
            at(vertices[0].0, "singular-vertex"),
            Some("cut the mesh along its lines through these vertices into regular parts"),
        ),
        QuadGridFault::Ragged { vertices } => (
            at(vertices[0].0, "ragged-boundary"),
            Some("end all rows, and all columns, on one line of the net"),
        ),
        QuadGridFault::Loops { starts } => (
            at(starts[0], "several-loops"),
            Some("cut the mesh along its lines into sheets or tubes"),
        ),
        QuadGridFault::Corners { corners, .. } => {
            let first = corners.first().copied();
            let unnamed = issue(&FACES, "wrong-corners", String::new(), None);
            (first.map_or(unnamed, |v| at(v, "wrong-corners")), None)
        }
        QuadGridFault::Spiral { vertex } => (
            at(*vertex, "spiral"),
            Some("cut the mesh along a line of the net"),
        ),
        QuadGridFault::Short { vertex, .. } => (at(*vertex, "short-round"), None),
    };
    first.message = fault.to_string();
    first.hint = hint.map(str::to_owned);
    vec![first]
}
