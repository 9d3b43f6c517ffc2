use super::*;
use crate::geometry::{BSplineCurve, Knots};

fn bilinear(corners: [[f64; 3]; 4]) -> BSplineSurface {
    let knots = vec![0.0, 0.0, 1.0, 1.0];
    let points = corners.map(|[x, y, z]| Point3::new(x, y, z)).to_vec();
    BSplineSurface::new([1, 1], [knots.clone(), knots], points, None).unwrap()
}

fn sheet(surface: BSplineSurface) -> Sheet {
    Sheet {
        name: "sheet".into(),
        surface,
        outline: None,
    }
}

/// Every edge of a shell is run through once in each direction, or once.
fn assert_oriented(sewn: &Sewn) {
    for edge in 0..sewn.edges.len() {
        let uses: Vec<bool> = (sewn.faces.iter())
            .flat_map(|f| &f.bound)
            .filter(|u| u.edge == edge)
            .map(|u| u.forward)
            .collect();
        assert!(
            matches!(uses[..], [_] | [true, false] | [false, true]),
            "{edge}: {uses:?}"
        );
    }
}

/// Every loop is closed.
fn assert_closed(sewn: &Sewn) {
    for face in &sewn.faces {
        let ends: Vec<[usize; 2]> = (face.bound.iter())
            .map(|u| {
                let [a, b] = sewn.edges[u.edge].ends;
                if u.forward { [a, b] } else { [b, a] }
            })
            .collect();
        for (i, [_, end]) in ends.iter().enumerate() {
            assert_eq!(*end, ends[(i + 1) % ends.len()][0]);
        }
    }
}

#[test]
fn two_squares_share_an_edge_whatever_their_directions() {
    let left = bilinear([
        [0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
    ]);
    let right = bilinear([
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [2.0, 0.0, 1.0],
        [2.0, 1.0, 1.0],
    ]);
    for turned in [
        right.clone(),
        right.reversed(Axis::U).unwrap(),
        right.reversed(Axis::V).unwrap(),
    ] {
        let sewn = sew(&[sheet(left.clone()), sheet(turned)]);
        assert_eq!((sewn.vertices.len(), sewn.edges.len()), (6, 7));
        assert_eq!(sewn.shells, [[0, 1]]);
        assert_oriented(&sewn);
        assert_closed(&sewn);
    }
}

#[test]
fn a_long_side_is_divided_by_its_neighbours() {
    let long = bilinear([
        [0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [2.0, 0.0, 0.0],
        [2.0, 1.0, 0.0],
    ]);
    let short = |x: f64| {
        bilinear([
            [x, 1.0, 0.0],
            [x, 2.0, 0.0],
            [x + 1.0, 1.0, 0.0],
            [x + 1.0, 2.0, 0.0],
        ])
    };
    let sewn = sew(&[sheet(long), sheet(short(0.0)), sheet(short(1.0))]);
    assert_eq!(sewn.faces[0].bound.len(), 5);
    assert_eq!(sewn.shells, [[0, 1, 2]]);
    assert_eq!((sewn.vertices.len(), sewn.edges.len()), (8, 10));
    assert_oriented(&sewn);
    assert_closed(&sewn);
}

#[test]
fn a_fan_is_a_face_of_its_own_with_three_edges() {
    // Quadratic in u; the first span stays in a corner at v = 0.
    let knots = Knots::new(2, vec![0.0, 0.0, 0.0, 1.0, 1.0, 2.0, 2.0, 2.0]).unwrap();
    let along = |points: [[f64; 2]; 5], z: f64| {
        let points = points.map(|[x, y]| Point3::new(x, y, z)).to_vec();
        BSplineCurve::from_knots(knots.clone(), points, None).unwrap()
    };
    let tip = along(
        [[0.0, 0.0], [0.0, 0.0], [0.0, 0.0], [1.0, 0.1], [2.0, 0.0]],
        0.0,
    );
    let swept = along(
        [[-1.0, 0.5], [-0.8, 0.2], [0.0, 0.1], [1.0, 0.1], [2.0, 0.0]],
        1.0,
    );
    let surface = crate::geometry::RuledSurface::new(tip, swept).unwrap();
    let sewn = sew(&[sheet(surface.to_bspline().unwrap())]);
    let counts: Vec<usize> = sewn.faces.iter().map(|f| f.bound.len()).collect();
    assert_eq!(counts, [3, 4]);
    assert_eq!(sewn.shells, [[0, 1]]);
    assert_oriented(&sewn);
    assert_closed(&sewn);
}

#[test]
fn sheets_apart_are_shells_apart() {
    let square = |z: f64| {
        sheet(bilinear([
            [0.0, 0.0, z],
            [0.0, 1.0, z],
            [1.0, 0.0, z],
            [1.0, 1.0, z],
        ]))
    };
    let sewn = sew(&[square(0.0), square(1.0)]);
    assert_eq!(sewn.shells, [[0], [1]]);
    assert_eq!(sewn.edges.len(), 8);
}

#[test]
fn nothing_gives_nothing() {
    let point = bilinear([[1.0, 1.0, 1.0]; 4]);
    assert!(sew(&[sheet(point)]).faces.is_empty());
    assert!(sew(&[]).shells.is_empty());
}

#[test]
fn a_fan_of_no_width_has_no_face() {
    // Three columns of points, the first two 1e-10 apart.
    let points = [0.0, 1e-10, 1.0].map(|x| [0.0, 1.0].map(|y| Point3::new(x, y, 0.0)));
    let surface = BSplineSurface::new(
        [1, 1],
        [vec![0.0, 0.0, 1e-10, 1.0, 1.0], vec![0.0, 0.0, 1.0, 1.0]],
        points.concat(),
        None,
    )
    .unwrap();
    let neighbour = bilinear([
        [-1.0, 0.0, 0.0],
        [-1.0, 1.0, 0.0],
        [0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
    ]);
    let sewn = sew(&[sheet(surface), sheet(neighbour)]);
    assert_eq!((sewn.faces.len(), sewn.shells.len()), (2, 1));
    assert_eq!((sewn.edges.len(), sewn.vertices.len()), (7, 6));
    assert_oriented(&sewn);
    assert_closed(&sewn);
}

/// Two halves of a quarter of a cylinder, of which only a part with a bent side
/// is meant.
fn trimmed_pair() -> Vec<Sheet> {
    let h = std::f64::consts::FRAC_PI_8;
    let half = |from: f64| {
        let at = |k: f64, far: f64, z: f64| {
            let turn = from + k * h;
            Point3::new(far * turn.cos(), far * turn.sin(), z)
        };
        let far = 1.0 / h.cos();
        let rows = [(0.0, 1.0), (1.0, far), (2.0, 1.0)];
        let points = rows
            .iter()
            .flat_map(|(k, far)| [0.0, 1.0].map(|z| at(*k, *far, z)));
        let weights = [1.0, 1.0, h.cos(), h.cos(), 1.0, 1.0].to_vec();
        let knots = [vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0], vec![0.0, 0.0, 1.0, 1.0]];
        BSplineSurface::new([2, 1], knots, points.collect(), Some(weights)).unwrap()
    };
    let outline = |list: &[[f64; 2]]| Some(list.iter().map(|p| (*p).into()).collect());
    let first = [[0.0, 0.0], [0.4, 0.1], [1.0, 0.2], [1.0, 0.9], [0.0, 1.0]];
    let second = [[0.0, 0.2], [1.0, 0.0], [1.0, 1.0], [0.5, 0.95], [0.0, 0.9]];
    vec![
        Sheet {
            outline: outline(&first),
            ..sheet(half(0.0))
        },
        Sheet {
            outline: outline(&second),
            ..sheet(half(2.0 * h))
        },
    ]
}

#[test]
fn parts_of_surfaces_are_faces_with_their_outlines() {
    let sheets = trimmed_pair();
    let sewn = sew(&sheets);
    assert_eq!((sewn.faces.len(), sewn.shells.len()), (2, 1));
    // Four sides each, the ruling between them once.
    assert_eq!((sewn.edges.len(), sewn.vertices.len()), (7, 6));
    assert_oriented(&sewn);
    assert_closed(&sewn);
    let bent = sewn.edges.iter().filter(|e| e.under.is_some());
    assert_eq!(bent.clone().count(), 4);
    for (face, sheet) in sewn.faces.iter().zip(&sheets) {
        assert_eq!(face.surface, sheet.surface);
        for user in &face.bound {
            let edge = &sewn.edges[user.edge];
            let Some(under) = &edge.under else { continue };
            let [from, to] = edge.curve.domain();
            assert_eq!(under.domain(), [from, to]);
            for k in 0..=10 {
                let t = from + (to - from) * f64::from(k) / 10.0;
                let place = under.point(t);
                let off = face.surface.point(place.x, place.y) - edge.curve.point(t);
                assert!(off.norm() < 1e-14, "{off}");
            }
        }
    }
}
