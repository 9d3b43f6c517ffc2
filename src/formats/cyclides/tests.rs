//! The files of a small net.

use super::{MemberLine, NetDrawing, PatchSheet};
use crate::formats::length_unit::LengthUnit;
use crate::formats::mesh_out::{MeshDrawing, Reference};
use crate::geometry::{CyclideCorner, CyclidePatch};
use nalgebra::{Point3, Vector3};
use std::collections::HashMap;

/// A ring of a torus, n patches round and two across.
fn ring(n: usize) -> PatchSheet {
    let corner = |i: usize, j: usize| {
        let (su, cu) = (std::f64::consts::TAU * i as f64 / n as f64).sin_cos();
        let (sv, cv) = (0.2 + 0.7 * j as f64).sin_cos();
        CyclideCorner {
            point: Point3::new((3.0 + cv) * cu, (3.0 + cv) * su, sv),
            tangents: [
                Vector3::new(-su, cu, 0.0),
                Vector3::new(-sv * cu, -sv * su, cv),
            ],
        }
    };
    let patch = |(i, j)| {
        let corners = [(i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)];
        let patch = CyclidePatch::new(corners.map(|(i, j)| corner(i, j)));
        patch.and_then(|p| p.surface()).ok()
    };
    PatchSheet {
        name: "cyclide spline".into(),
        prefix: "patch ".into(),
        counts: [n, 2],
        closed: [true, false],
        patches: (0..n).flat_map(|i| [(i, 0), (i, 1)]).map(patch).collect(),
    }
}

fn drawing() -> NetDrawing {
    NetDrawing {
        title: "ring".into(),
        units: "m".into(),
        sheets: vec![ring(7)],
        members: vec![MemberLine {
            line: "u0".into(),
            nodes: [[0, 0], [1, 0]],
            radius: f64::INFINITY,
            length: 2.5,
            angle_deg: 0.0,
            torsion_deg: 0.0,
        }],
        verdict: "within_limits".into(),
    }
}

fn mesh_of(sheet: PatchSheet) -> MeshDrawing {
    let drawing = NetDrawing {
        sheets: vec![sheet],
        ..drawing()
    };
    MeshDrawing::of_net(&drawing, LengthUnit::Metre, Reference::Itself)
}

#[test]
fn the_mesh_closes_and_has_no_slits() {
    let mesh = mesh_of(ring(7));
    let mut edges: HashMap<[usize; 2], usize> = HashMap::new();
    for part in &mesh.parts {
        for triangle in &part.triangles {
            let f = triangle.map(|i| part.corners[i]);
            for [a, b] in [[f[0], f[1]], [f[1], f[2]], [f[2], f[0]]] {
                *edges.entry([a, b]).or_default() += 1;
            }
        }
    }
    for p in &mesh.vertices {
        assert!(((p.x.hypot(p.y) - 3.0).hypot(p.z) - 1.0).abs() < 1e-12);
    }
    assert_eq!(mesh.vertices.len(), 28 * 9);
    let open = edges.keys().filter(|[a, b]| !edges.contains_key(&[*b, *a]));
    // The two rims, each in one way only.
    assert_eq!(open.count(), 2 * 28);
    assert!(edges.values().all(|n| *n == 1));
}

#[test]
fn patches_are_parts_and_their_lines_do_not_turn() {
    let mesh = mesh_of(ring(7));
    assert_eq!(mesh.parts.len(), 14);
    assert_eq!(mesh.parts[3].name, "patch 1,1");
    // Lines of curvature, to rounding.
    let turns = mesh.parts.iter().flat_map(|p| &p.values);
    assert!(turns.fold(0.0, |most: f64, t| most.max(*t)) < 1e-9);
    // 7 arcs on each of 3 rings, 2 on each of 7 lines across.
    assert_eq!(mesh.lines[0].lines.len(), 3 * 7 + 2 * 7);
}

#[test]
fn samples_of_neighbours_agree_on_their_border() {
    let whole = ring(5);
    let gap = |keep: usize| PatchSheet {
        counts: [1, 2],
        closed: [false; 2],
        patches: whole.patches[..2]
            .iter()
            .enumerate()
            .map(|(i, p)| p.clone().filter(|_| i == keep))
            .collect(),
        ..whole.clone()
    };
    let [first, second] = [gap(0), gap(1)].map(|sheet| mesh_of(sheet).vertices);
    let near = |a: &Point3<f64>, b: &Point3<f64>| (a - b).amax() < 1e-12;
    let common = first.iter().filter(|a| second.iter().any(|b| near(a, b)));
    assert_eq!(common.count(), 5);
}

#[test]
fn the_bill_has_a_row_an_arc() {
    let expected = "line,from_row,from_column,to_row,to_column,radius (m),length (m),\
        angle (deg),node_torsion (deg)\r\nu0,0,0,1,0,,2.5,0,0\r\n";
    assert_eq!(super::bill_of_quantities(&drawing()), expected);
}
