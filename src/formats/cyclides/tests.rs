//! The files of a small net.

use super::{MemberLine, NetDrawing, PatchSheet};
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

#[test]
fn the_mesh_closes_and_has_no_slits() {
    let text = super::mesh(&drawing());
    let mut vertices = Vec::new();
    let mut edges: HashMap<[usize; 2], usize> = HashMap::new();
    for line in text.lines() {
        let words: Vec<&str> = line.split(' ').collect();
        match words[0] {
            "v" => vertices.push([1, 2, 3].map(|i| words[i].parse::<f64>().unwrap())),
            "f" => {
                let f = [1, 2, 3].map(|i| words[i].split('/').next().unwrap().parse().unwrap());
                for [a, b] in [[f[0], f[1]], [f[1], f[2]], [f[2], f[0]]] {
                    *edges.entry([a, b]).or_default() += 1;
                }
            }
            _ => {}
        }
    }
    for [x, y, z] in &vertices {
        assert!(((x.hypot(*y) - 3.0).hypot(*z) - 1.0).abs() < 1e-12);
    }
    assert_eq!(vertices.len(), 28 * 9);
    let open = edges.keys().filter(|[a, b]| !edges.contains_key(&[*b, *a]));
    // The two rims, each in one way only.
    assert_eq!(open.count(), 2 * 28);
    assert!(edges.values().all(|n| *n == 1));
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
    let text = |keep| {
        let drawing = NetDrawing {
            sheets: vec![gap(keep)],
            ..drawing()
        };
        super::mesh(&drawing)
    };
    let vertices = |text: &str| -> Vec<[f64; 3]> {
        let lines = text.lines().filter_map(|l| l.strip_prefix("v "));
        lines
            .map(|l| {
                let n: Vec<f64> = l.split(' ').map(|n| n.parse().unwrap()).collect();
                [n[0], n[1], n[2]]
            })
            .collect()
    };
    let (first, second) = (vertices(&text(0)), vertices(&text(1)));
    let near = |a: &[f64; 3], b: &[f64; 3]| (0..3).all(|i| (a[i] - b[i]).abs() < 1e-12);
    let common = first.iter().filter(|a| second.iter().any(|b| near(a, b)));
    assert_eq!(common.count(), 5);
}

#[test]
fn the_bill_has_a_row_an_arc() {
    let expected = "line,from_row,from_column,to_row,to_column,radius (m),length (m),\
        angle (deg),node_torsion (deg)\r\nu0,0,0,1,0,,2.5,0,0\r\n";
    assert_eq!(super::bill_of_quantities(&drawing()), expected);
}
