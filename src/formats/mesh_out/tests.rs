//! What all writers of meshes rest on.

use super::*;
use crate::formats::plates::{HullDrawing, PlateDrawing, ProfileLine, RulingLine};

/// Two squares of one name side by side, the second with a raised corner, with
/// twists that agree at vertex 1 and differ at vertex 4.
pub(in crate::formats) fn two_squares() -> MeshDrawing {
    let vertices = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [2.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [1.0, 1.0, 0.0],
        [2.0, 1.0, 0.5],
    ];
    let part = |corners: [usize; 4], values: [f64; 4]| MeshPart {
        name: "deck – keel".into(),
        corners: corners.to_vec(),
        values: values.to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
    };
    MeshDrawing {
        title: "squares".into(),
        units: LengthUnit::Metre,
        verdict: "within_limits".into(),
        chordal_error: None,
        quantity: Some(Quantity {
            name: "twist".into(),
            kind: QuantityKind::Degrees,
            limit: Some(2.0),
        }),
        vertices: vertices.map(Point3::from).to_vec(),
        normals: Vec::new(),
        parts: vec![
            part([0, 1, 4, 3], [0.0, -1.0, 1.5, 0.5]),
            part([1, 2, 5, 4], [-1.0, 2.5, 0.25, 1.0]),
        ],
        lines: vec![LineGroup {
            name: "rulings".into(),
            part: Some(0),
            lines: vec![vec![Point3::from(vertices[0]), Point3::from(vertices[3])]],
        }],
    }
}

#[test]
fn names_are_made_different() {
    let mut mesh = two_squares();
    assert_eq!(mesh.part_names(), ["deck – keel", "deck – keel (2)"]);
    mesh.parts[0].name = "deck – keel (2)".into();
    mesh.parts.push(mesh.parts[1].clone());
    assert_eq!(
        mesh.part_names(),
        ["deck – keel (2)", "deck – keel", "deck – keel (3)"]
    );
}

#[test]
fn a_part_alone_keeps_its_shape_and_its_lines() {
    let mesh = two_squares();
    let second = mesh.only(1).unwrap();
    assert_eq!(second.vertices[3], Point3::new(1.0, 1.0, 0.0));
    assert_eq!(second.parts[0].corners, [0, 1, 2, 3]);
    assert!(second.lines.is_empty());
    assert_eq!(mesh.only(0).unwrap().lines.len(), 1);
    assert!(mesh.only(2).is_none());
}

#[test]
fn colours_tell_what_is_above_the_limit() {
    let mesh = two_squares();
    let colours = Colours::of(&mesh);
    let red = colours.at(Some(-2.5)).encoded;
    assert_eq!(red, [0xd0, 0x02, 0x1b]);
    assert_ne!(colours.at(Some(2.0)).encoded, red);
    assert_eq!(colours.at(Some(1.0)), colours.at(Some(-1.0)));
    assert_ne!(colours.at(None), colours.at(Some(0.0)));
    let mut free = mesh;
    free.quantity.as_mut().unwrap().limit = None;
    assert_eq!(free.full_scale(), 2.5);
    assert_ne!(Colours::of(&free).at(Some(2.5)).encoded, red);
}

#[test]
fn a_hull_is_meshed_plate_by_plate() {
    let ruling = |x: f64, twist: f64, z: f64| RulingLine {
        u: x,
        from: Point3::new(x, 0.0, z + 1.0),
        to: Point3::new(x, 0.0, z),
        twist_deg: twist,
        bend_radius_from: f64::INFINITY,
        bend_radius_to: f64::INFINITY,
    };
    let plate = |name: &str, z: f64, twist: f64| PlateDrawing {
        name: name.into(),
        rulings: vec![ruling(0.0, twist, z), ruling(1.0, -twist, z)],
        rolls: Vec::new(),
        within_limits: true,
    };
    let hull = HullDrawing {
        title: "t".into(),
        units: "ft".into(),
        twist_limit_deg: 6.0,
        plates: vec![plate("a", 1.0, 2.0), plate("b", 0.0, 3.0)],
        profiles: vec![ProfileLine {
            name: "p".into(),
            points: vec![Point3::origin(), Point3::new(1.0, 0.0, 0.0)],
        }],
        verdict: "within_limits".into(),
        summary: Vec::new(),
    };
    let mesh = MeshDrawing::of_hull(&hull, LengthUnit::Foot);
    assert_eq!(mesh.vertices.len(), 6, "the chine is shared");
    let chine = mesh.parts[0]
        .corners
        .iter()
        .position(|v| mesh.vertices[*v] == Point3::new(0.0, 0.0, 1.0));
    assert_eq!(mesh.parts[0].values[chine.unwrap()], 2.0);
    assert_eq!(
        mesh.parts[1].values.iter().copied().fold(0.0, f64::max),
        3.0
    );
    let names: Vec<_> = mesh.lines.iter().map(|g| g.name.as_str()).collect();
    assert_eq!(names, ["rulings of a", "rulings of b", "profiles"]);
}
