//! Wavefront OBJ: one object a part over one shared list of vertices, so that
//! neighbours are watertight along the border that they share.
//!
//! The format knows no units; they stand in a comment at the top.

use super::mesh_out::MeshDrawing;
use std::fmt::Write as _;

/// The mesh as text. Coordinates carry as many digits as it takes to read
/// the same bits back; lines end in a line feed.
#[must_use]
pub fn write(mesh: &MeshDrawing) -> String {
    let mut text = heading(mesh);
    for v in &mesh.vertices {
        push(&mut text, format_args!("v {} {} {}\n", v.x, v.y, v.z));
    }
    for n in &mesh.normals {
        // A unit vector to seven digits is exact to a hundred-thousandth of a degree.
        push(
            &mut text,
            format_args!("vn {:.7} {:.7} {:.7}\n", n.x, n.y, n.z),
        );
    }
    for (name, part) in mesh.part_names().iter().zip(&mesh.parts) {
        push(&mut text, format_args!("o {}\n", object_name(name)));
        for triangle in &part.triangles {
            // OBJ counts from 1.
            let [a, b, c] = triangle.map(|i| part.corners[i] + 1);
            if mesh.normals.is_empty() {
                push(&mut text, format_args!("f {a} {b} {c}\n"));
            } else {
                push(&mut text, format_args!("f {a}//{a} {b}//{b} {c}//{c}\n"));
            }
        }
    }
    text
}

fn heading(mesh: &MeshDrawing) -> String {
    let mut text = format!(
        "# {}\n# lengths in {}; {}\n",
        one_line(&mesh.title),
        mesh.units,
        one_line(&mesh.verdict)
    );
    if let Some(error) = mesh.chordal_error {
        let triangles: usize = mesh.parts.iter().map(|p| p.triangles.len()).sum();
        push(
            &mut text,
            format_args!(
                "# {triangles} triangles, within {error:.2e} {} of the surface\n",
                mesh.units
            ),
        );
    }
    text
}

/// Appends formatted text; writing to a `String` cannot fail.
pub(super) fn push(text: &mut String, what: std::fmt::Arguments<'_>) {
    let _ = text.write_fmt(what);
}

/// A comment must stay on its line.
pub(super) fn one_line(text: &str) -> String {
    text.chars()
        .map(|c| if c.is_control() { ' ' } else { c })
        .collect()
}

/// Many readers end a name at the first space, so spaces become underscores.
fn object_name(name: &str) -> String {
    let visible = |c: char| {
        if c.is_whitespace() || c.is_control() {
            '_'
        } else {
            c
        }
    };
    name.chars().map(visible).collect()
}

#[cfg(test)]
mod tests {
    use super::super::mesh_out::tests::two_squares;
    use super::*;

    #[test]
    fn parts_share_their_vertices() {
        let mut mesh = two_squares();
        mesh.title = "two\nlines".into();
        let expected = "# two lines\n# lengths in m; within_limits\n\
            v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nv 1 1 0\nv 2 1 0.5\n\
            o deck_–_keel\nf 1 2 5\nf 1 5 4\no deck_–_keel_(2)\nf 2 3 6\nf 2 6 5\n";
        assert_eq!(write(&mesh), expected);
    }

    #[test]
    fn a_name_cannot_break_out_of_its_line() {
        let mut mesh = two_squares();
        mesh.parts[0].name = "x\nf 1 1 1".into();
        assert!(write(&mesh).contains("o x_f_1_1_1\n"));
    }

    #[test]
    fn normals_and_the_chordal_error_are_told() {
        let mut mesh = two_squares();
        mesh.normals = vec![nalgebra::Vector3::z(); mesh.vertices.len()];
        mesh.chordal_error = Some(1.25e-3);
        let text = write(&mesh);
        assert!(text.contains("# 4 triangles, within 1.25e-3 m of the surface\n"));
        assert!(text.contains("vn 0.0000000 0.0000000 1.0000000\n"));
        assert!(text.contains("f 1//1 2//2 5//5\n"));
    }
}
