use super::*;
use crate::geometry::mesh::{Face, Manifold, Mesh};
use nalgebra::Point3;

/// Quads of a net of `rows × columns` vertices; closed directions wrap round,
/// the last row of a closed one shifted by `shift` columns.
fn faces(rows: usize, columns: usize, closed: [bool; 2], shift: usize) -> Vec<[usize; 4]> {
    let n = rows - usize::from(!closed[0]);
    let m = columns - usize::from(!closed[1]);
    let vertex = |i: usize, j: usize| {
        let shift = if i == rows { shift } else { 0 };
        (i % rows) * columns + (j + shift) % columns
    };
    let quad = |i, j| {
        [
            vertex(i, j),
            vertex(i + 1, j),
            vertex(i + 1, j + 1),
            vertex(i, j + 1),
        ]
    };
    (0..n)
        .flat_map(|i| (0..m).map(move |j| quad(i, j)))
        .collect()
}

/// Only what meets where matters here: any places will do.
fn surface(faces: &[[usize; 4]]) -> Manifold {
    let count = faces.iter().flatten().max().map_or(0, |v| v + 1);
    let points = (0..count)
        .map(|k| Point3::new(k as f64, 0.0, 0.0))
        .collect();
    let faces = faces.iter().map(|f| Face::Quad(*f)).collect();
    Manifold::of(Mesh::new(points, faces).expect("a mesh")).expect("a surface")
}

fn grid(faces: &[[usize; 4]]) -> QuadGrid {
    QuadGrid::of(&surface(faces)).expect("a net")
}

fn fault(faces: &[[usize; 4]]) -> QuadGridFault {
    QuadGrid::of(&surface(faces)).expect_err("no net")
}

#[test]
fn nets_listed_row_by_row_keep_their_rows() {
    for closed in [[false, false], [true, false], [false, true], [true, true]] {
        let found = grid(&faces(4, 5, closed, 0));
        let expected = QuadGrid {
            rows: 4,
            columns: 5,
            closed,
            vertices: (0..20).collect(),
        };
        assert_eq!(found, expected);
    }
}

/// A permutation without pattern: multiplication by a unit of 53, cut to size.
fn renamed(count: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by_key(|k| (k * 17 + 5) % 53);
    order
}

#[test]
fn any_order_of_vertices_and_faces_gives_the_same_neighbours() {
    for closed in [[false, false], [false, true], [true, true]] {
        let plain = faces(5, 4, closed, 0);
        let names = renamed(20);
        let mut mixed: Vec<[usize; 4]> = plain.iter().map(|f| f.map(|v| names[v])).collect();
        for (k, face) in mixed.iter_mut().enumerate() {
            face.rotate_left(k % 4);
            if k % 3 == 1 {
                face.reverse();
            }
        }
        mixed.sort_by_key(|f| f[0]);
        let found = grid(&mixed);
        let mut sizes = [found.rows, found.columns];
        sizes.sort_unstable();
        assert_eq!(sizes, [4, 5]);
        let again = faces(found.rows, found.columns, found.closed, 0);
        let sorted = |faces: &[[usize; 4]], name: &dyn Fn(usize) -> usize| {
            let mut all: Vec<_> = faces
                .iter()
                .map(|f| {
                    let mut f = f.map(name);
                    f.sort_unstable();
                    f
                })
                .collect();
            all.sort_unstable();
            all
        };
        let walked = sorted(&again, &|v| found.vertices[v]);
        assert_eq!(walked, sorted(&plain, &|v| names[v]), "{closed:?}");
    }
}

#[test]
fn rows_run_so_that_the_faces_run_counterclockwise() {
    let mut clockwise = faces(3, 4, [false, false], 0);
    clockwise.iter_mut().for_each(|f| f.reverse());
    let found = grid(&clockwise);
    assert_eq!(found.vertices[..4], [8, 9, 10, 11]);
    assert_eq!((found.rows, found.columns), (3, 4));
}

#[test]
fn singular_vertices_are_named() {
    // Three quads round vertex 0.
    let cube = [[0, 1, 2, 3], [0, 3, 4, 5], [0, 5, 6, 1]];
    assert_eq!(
        fault(&cube),
        QuadGridFault::Singular {
            vertices: vec![(0, 3)]
        }
    );
}

#[test]
fn a_boundary_that_turns_inwards_is_named() {
    let mut ragged = faces(4, 4, [false, false], 0);
    ragged.retain(|f| f[0] != 0);
    assert_eq!(
        fault(&ragged),
        QuadGridFault::Ragged {
            vertices: vec![(5, 3)]
        }
    );
    assert!(fault(&ragged).to_string().contains("vertex 5 with 3 faces"));
}

#[test]
fn holes_parts_and_triangles_are_named() {
    let mut pierced = faces(6, 6, [false, false], 0);
    pierced.retain(|f| f[0] != 14);
    assert!(matches!(fault(&pierced), QuadGridFault::Ragged { .. }));
    let mut two = faces(3, 3, [false, false], 0);
    two.push([20, 21, 22, 23]);
    assert_eq!(fault(&two), QuadGridFault::Parts { parts: 2, face: 4 });
    let points = (0..4).map(|k| Point3::new(k as f64, 0.0, 0.0)).collect();
    let triangles = vec![Face::Triangle([0, 1, 2]), Face::Triangle([2, 1, 3])];
    let mesh = Mesh::new(points, triangles).expect("a mesh");
    let found = QuadGrid::of(&Manifold::of(mesh).expect("a surface"));
    assert_eq!(
        found,
        Err(QuadGridFault::NotAQuad {
            face: 0,
            corners: 3
        })
    );
}

#[test]
fn a_torus_closed_with_a_shift_has_no_rows() {
    let twisted = faces(4, 5, [true, true], 2);
    assert!(matches!(fault(&twisted), QuadGridFault::Spiral { .. }));
}
