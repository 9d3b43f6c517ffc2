use super::models::{request, saddle};
use crate::methods::curvature_net::request::{Input, QuadMesh, Request};
use crate::methods::curvature_net::{smooth, validate};
use crate::methods::{FitError, Issue};
use crate::solver::Unwatched;
use nalgebra::Point3;

/// The saddle as a mesh.
fn mesh() -> QuadMesh {
    let grid = saddle();
    let columns = grid.columns;
    let quad = |k: usize| vec![k, k + columns, k + columns + 1, k + 1];
    let faces = (0..grid.rows - 1).flat_map(|i| (0..columns - 1).map(move |j| i * columns + j));
    QuadMesh {
        faces: faces.map(quad).collect(),
        vertices: grid.points,
    }
}

fn issues(request: &Request) -> Vec<Issue> {
    match smooth(request, &Unwatched) {
        Err(FitError::Invalid(issues)) => issues,
        other => panic!("not refused: {:?}", other.map(|s| s.shape)),
    }
}

fn of_mesh(mesh: QuadMesh) -> Request {
    Request {
        input: Input::Mesh(mesh),
        ..request(saddle())
    }
}

/// Code and place of the first issue.
fn first(change: impl Fn(&mut QuadMesh)) -> (&'static str, String) {
    let mut changed = mesh();
    change(&mut changed);
    let issues = issues(&of_mesh(changed));
    (issues[0].code, issues[0].path.join("/"))
}

#[test]
fn a_mesh_gives_the_surface_of_its_grid() {
    let (a, b) = (
        smooth(&request(saddle()), &Unwatched).expect("a surface"),
        smooth(&of_mesh(mesh()), &Unwatched).expect("a surface"),
    );
    assert_eq!(a.surface, b.surface);
    assert_eq!(a.given, b.given);
}

/// What is done to a good mesh.
type Change = Box<dyn Fn(&mut QuadMesh)>;

#[test]
fn bad_meshes_are_refused_by_name() {
    let cases: Vec<(&str, &str, Change)> = vec![
        (
            "not-a-quad",
            "faces/1",
            Box::new(|m| m.faces[1].truncate(3)),
        ),
        (
            "degenerate-quad",
            "faces/2",
            Box::new(|m| m.faces[2][1] = m.faces[2][0]),
        ),
        (
            "no-such-vertex",
            "faces/0",
            Box::new(|m| m.faces[0][3] = 99),
        ),
        (
            "not-finite",
            "vertices/7",
            Box::new(|m| m.vertices[7].y = f64::NAN),
        ),
        (
            "unused-vertex",
            "vertices/20",
            Box::new(|m| m.vertices.push(Point3::origin())),
        ),
        (
            "not-a-surface",
            "faces/0",
            Box::new(|m| {
                m.vertices
                    .extend([Point3::new(0.0, 0.0, 9.0), Point3::new(1.0, 0.0, 9.0)]);
                m.faces.push(vec![1, 5, 20, 21]);
            }),
        ),
        (
            "ragged-boundary",
            "vertices/5",
            Box::new(|m| {
                // Without its corner quad and that quad's corner.
                m.faces.remove(0);
                m.vertices.swap(0, 19);
                m.vertices.pop();
                m.faces
                    .iter_mut()
                    .flatten()
                    .filter(|v| **v == 19)
                    .for_each(|v| *v = 0);
            }),
        ),
        (
            "degenerate-quad",
            "vertices/",
            Box::new(|m| m.vertices[6] = m.vertices[5]),
        ),
    ];
    for (code, place, change) in cases {
        let (found, path) = first(change);
        assert_eq!(found, code, "{path}");
        assert!(path.contains(place), "{code}: {path}");
    }
}

#[test]
fn singular_vertices_are_named() {
    let cube = QuadMesh {
        vertices: vec![
            Point3::new(1.0, 1.0, 1.0),
            Point3::new(1.0, 0.0, 1.0),
            Point3::new(0.0, 0.0, 1.0),
            Point3::new(0.0, 1.0, 1.0),
            Point3::new(0.0, 1.0, 0.0),
            Point3::new(1.0, 1.0, 0.0),
            Point3::new(1.0, 0.0, 0.0),
        ],
        faces: vec![vec![0, 3, 2, 1], vec![0, 5, 4, 3], vec![0, 1, 6, 5]],
    };
    let found = issues(&of_mesh(cube));
    assert_eq!(found[0].code, "singular-vertex");
    assert_eq!(found[0].path, ["input", "mesh", "vertices", "0"]);
    assert!(
        found[0].message.contains("vertex 0 has 3"),
        "{}",
        found[0].message
    );
}

#[test]
fn bad_grids_and_options_are_refused_together() {
    let mut bad = saddle();
    bad.rows = 1;
    let mut asked = request(bad);
    asked.options.closeness = 0.0;
    asked.options.offsets = vec![0.5, 0.0];
    let codes: Vec<_> = issues(&asked)
        .iter()
        .map(|i| (i.code, i.path.join("/")))
        .collect();
    let expected = [
        ("out-of-range", "options/closeness"),
        ("out-of-range", "options/offsets/1"),
        ("needs-cyclide", "options/offsets"),
        ("too-small", "input/grid/rows"),
        ("wrong-count", "input/grid/points"),
    ];
    assert_eq!(codes, expected.map(|(c, p)| (c, p.to_owned())));
}

#[test]
fn too_many_patches_are_refused() {
    let mut asked = request(saddle());
    asked.options.levels = Some(9);
    assert_eq!(issues(&asked)[0].code, "too-many-patches");
}

#[test]
fn a_closed_grid_that_repeats_its_first_row_is_told_so() {
    let mut tube = super::models::tube();
    // Its lines, each with the first point once more.
    let rows = tube.points.chunks(tube.columns);
    tube.points = rows
        .flat_map(|r| r.iter().chain(&r[..1]))
        .copied()
        .collect();
    tube.columns += 1;
    let found = issues(&request(tube));
    assert_eq!(found[0].code, "degenerate-quad");
    assert!(found[0].hint.as_ref().is_some_and(|h| h.contains("repeat")));
}

#[test]
fn lines_that_run_into_one_are_named() {
    // Both lines turn in the middle; for some height they turn together.
    let net = |y: f64| {
        let places = [
            [-2.0, 0.0],
            [-1.0, 0.7],
            [2.5, 2.0],
            [-1.0, -0.7],
            [0.0, 0.0],
            [1.0, y],
            [2.5, -2.0],
            [1.0, 0.5],
            [2.0, 0.0],
        ];
        crate::methods::curvature_net::request::Grid {
            rows: 3,
            columns: 3,
            closed: [false, false],
            points: places.map(|[x, y]| Point3::new(x, y, 0.0)).to_vec(),
        }
    };
    let found: Vec<Issue> = (0..400)
        .filter_map(
            |k| match validate(&request(net(-1.6 + 0.004 * f64::from(k)))) {
                Err(FitError::Invalid(issues)) => Some(issues),
                _ => None,
            },
        )
        .flatten()
        .filter(|i| i.code == "parallel-lines")
        .collect();
    assert!(!found.is_empty());
    assert_eq!(found[0].path, ["input", "grid", "points", "4"]);
}
