use super::*;
use crate::geometry::Tolerance;

fn mesh(points: &[[f64; 3]], faces: &[&[usize]]) -> Mesh {
    let faces = faces.iter().map(|f| Face::of(f).unwrap()).collect();
    Mesh::new(points.iter().map(|p| Point3::from(*p)).collect(), faces).unwrap()
}

/// `n` quads in a ring of radius 1 about z, closed with `turns` half turns.
fn band(n: usize, half_turns: usize) -> Mesh {
    let mut points = Vec::new();
    for i in 0..n {
        let a = std::f64::consts::TAU * i as f64 / n as f64;
        let t = 0.5 * a * half_turns as f64;
        for s in [-0.2, 0.2] {
            let r = 1.0 + s * t.sin();
            points.push(Point3::new(r * a.cos(), r * a.sin(), s * t.cos()));
        }
    }
    let twisted = half_turns % 2 == 1;
    let face = |i: usize| {
        let (a, b) = (2 * i, 2 * i + 1);
        let (mut c, mut d) = ((2 * i + 2) % (2 * n), (2 * i + 3) % (2 * n));
        if twisted && i == n - 1 {
            (c, d) = (d, c);
        }
        Face::Quad([a, c, d, b])
    };
    Mesh::new(points, (0..n).map(face).collect()).unwrap()
}

/// Three unit squares in a row, the middle one turned over.
fn row() -> Mesh {
    let points: Vec<[f64; 3]> = (0..8)
        .map(|i| [f64::from(i / 2), f64::from(i % 2), 0.0])
        .collect();
    mesh(&points, &[&[0, 2, 3, 1], &[2, 3, 5, 4], &[4, 6, 7, 5]])
}

#[test]
fn indices_and_coordinates_are_checked() {
    let p = vec![
        Point3::origin(),
        Point3::new(1.0, 0.0, 0.0),
        Point3::new(0.0, 1.0, 0.0),
    ];
    let new = |face: [usize; 3]| Mesh::new(p.clone(), vec![Face::Triangle(face)]);
    assert!(new([0, 1, 2]).is_ok());
    assert_eq!(
        new([0, 1, 3]).unwrap_err(),
        MeshError::OutOfRange {
            face: 0,
            corner: 2,
            vertex: 3,
            vertices: 3
        }
    );
    assert_eq!(
        new([0, 1, 0]).unwrap_err(),
        MeshError::RepeatedCorner { face: 0, vertex: 0 }
    );
    let odd = vec![Point3::new(0.0, f64::NAN, 0.0)];
    assert_eq!(
        Mesh::new(odd, vec![]).unwrap_err(),
        MeshError::NotFinite { vertex: 0 }
    );
    assert_eq!(Face::of(&[0, 1]), None);
}

#[test]
fn faces_are_turned_like_the_first_and_the_boundary_runs_round_them() {
    let surface = Manifold::of(row()).unwrap();
    assert_eq!(surface.mesh().faces()[1], Face::Quad([2, 4, 5, 3]));
    assert_eq!(surface.boundary_loops(), [vec![0, 2, 4, 6, 7, 5, 3, 1]]);
    assert_eq!(surface.component_count(), 1);
    for f in 0..3 {
        assert!((surface.mesh().area_vector(f).z - 1.0).abs() < 1e-15);
    }
    let topology = surface.topology();
    let inner = topology.edge_between(3, 2).unwrap();
    assert_eq!(topology.faces_at_edge(inner), [0, 1]);
    assert_eq!(topology.faces_at_vertex(4), [1, 2]);
    assert_eq!(topology.edge_between(0, 7), None);
}

#[test]
fn rings_have_two_loops_and_moebius_bands_are_named() {
    let ring = Manifold::of(band(12, 0)).unwrap();
    assert_eq!(ring.boundary_loops().len(), 2);
    let full_turn = Manifold::of(band(12, 2)).unwrap();
    assert_eq!(full_turn.boundary_loops().len(), 2);
    for n in [3, 4, 12, 61] {
        let fault = Manifold::of(band(n, 1)).unwrap_err();
        let MeshFault::NotOrientable { face, other, edge } = fault else {
            panic!("{fault}");
        };
        let topology = Topology::of(&band(n, 1));
        let shared = topology.edge_between(edge[0], edge[1]).unwrap();
        let mut pair = [face, other];
        pair.sort_unstable();
        assert_eq!(topology.faces_at_edge(shared), pair);
    }
}

#[test]
fn places_where_a_mesh_is_no_surface_are_named() {
    let points = [
        [0., 0., 0.],
        [1., 0., 0.],
        [0., 1., 0.],
        [0., -1., 0.],
        [0., 0., 1.],
    ];
    let book = mesh(&points, &[&[0, 1, 2], &[0, 1, 3], &[0, 1, 4]]);
    assert_eq!(
        Manifold::of(book).unwrap_err(),
        MeshFault::NonManifoldEdge {
            edge: [0, 1],
            faces: 3,
            face: 0
        }
    );
    let bow_tie = [
        [0., 0., 0.],
        [1., 0., 0.],
        [1., 1., 0.],
        [-1., 0., 0.],
        [-1., -1., 0.],
    ];
    assert_eq!(
        Manifold::of(mesh(&bow_tie, &[&[0, 1, 2], &[0, 3, 4]])).unwrap_err(),
        MeshFault::NonManifoldVertex { vertex: 0, fans: 2 }
    );
    assert_eq!(
        Manifold::of(Mesh::default()).unwrap_err(),
        MeshFault::NoFaces
    );
    let two = mesh(
        &[
            [0., 0., 0.],
            [1., 0., 0.],
            [1., 1., 0.],
            [3., 0., 0.],
            [4., 0., 0.],
            [4., 1., 0.],
        ],
        &[&[0, 1, 2], &[3, 4, 5]],
    );
    assert_eq!(Manifold::of(two).unwrap().components(), [0, 1]);
}

#[test]
fn closed_surfaces_have_no_boundary_and_inner_vertices_one_ring() {
    let points = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]];
    let faces: [&[usize]; 4] = [&[0, 2, 1], &[0, 1, 3], &[1, 2, 3], &[0, 2, 3]];
    let solid = Manifold::of(mesh(&points, &faces)).unwrap();
    assert!(solid.boundary_loops().is_empty());
}

#[test]
fn quads_are_cut_along_the_shorter_diagonal_and_areas_add_up() {
    let kite = mesh(
        &[[0., 0., 0.], [1., -1., 0.], [4., 0., 0.], [1., 1., 0.]],
        &[&[0, 1, 2, 3]],
    );
    assert_eq!(kite.triangles(), [([0, 1, 3], 0), ([1, 2, 3], 0)]);
    let total: f64 = kite.vertex_areas().iter().sum();
    assert!((total - 4.0).abs() < 1e-15);
    assert!((kite.area_vector(0).norm() - 4.0).abs() < 1e-15);
    assert!((kite.vertex_normals()[2].z - 1.0).abs() < 1e-15);
}

#[test]
fn slivers_strays_and_doubles_are_reported() {
    let points = [
        [0., 0., 0.],
        [1., 0., 0.],
        [2., 0., 1e-9],
        [0., 1., 0.],
        [7., 7., 7.],
        [-0.0, 0., 0.],
    ];
    let odd = mesh(&points, &[&[0, 1, 2], &[5, 1, 3]]);
    let tolerance = Tolerance::absolute(1e-6).unwrap();
    assert_eq!(
        odd.degenerate_faces(tolerance),
        [MeshFault::DegenerateFace { face: 0 }]
    );
    assert_eq!(
        odd.unused_vertices(),
        [MeshFault::UnusedVertex { vertex: 4 }]
    );
    assert_eq!(
        odd.duplicate_vertices(),
        [MeshFault::DuplicateVertices {
            first: 0,
            second: 5
        }]
    );
}
