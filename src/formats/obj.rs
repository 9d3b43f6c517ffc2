//! Wavefront OBJ: one object a plate over one shared list of vertices,
//! watertight along the chines, every ruling an edge.
//!
//! The format knows no units; they stand in a comment at the top. How the
//! triangles come about is told in `strip.rs`.

use super::plates::HullDrawing;
use super::strip;
use std::fmt::Write as _;

/// The hull as triangles. Coordinates carry as many digits as it takes to read
/// the same bits back; lines end in a line feed.
pub fn write(hull: &HullDrawing) -> String {
    let mesh = strip::mesh(hull);
    let mut text = format!(
        "# {}\n# lengths in {}; {}\n",
        one_line(&hull.title),
        one_line(&hull.units),
        one_line(&hull.verdict)
    );
    for vertex in &mesh.vertices {
        push(
            &mut text,
            format_args!("v {} {} {}\n", vertex.x, vertex.y, vertex.z),
        );
    }
    for (index, (plate, triangles)) in hull.plates.iter().zip(&mesh.plates).enumerate() {
        push(
            &mut text,
            format_args!("o {}\n", object_name(index, &plate.name)),
        );
        for [a, b, c] in triangles {
            // OBJ counts from 1.
            push(&mut text, format_args!("f {} {} {}\n", a + 1, b + 1, c + 1));
        }
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

/// Many readers end a name at the first space and mix up objects of one name,
/// so spaces become underscores and the plate's number goes in front.
fn object_name(index: usize, name: &str) -> String {
    let visible = |c: char| {
        if c.is_whitespace() || c.is_control() {
            '_'
        } else {
            c
        }
    };
    let name: String = name.chars().map(visible).collect();
    format!("plate_{}_{name}", index + 1)
}

#[cfg(test)]
mod tests {
    use super::super::plates::{PlateDrawing, RulingLine};
    use super::*;
    use nalgebra::Point3;

    fn square(name: &str) -> HullDrawing {
        let ruling = |x: f64| RulingLine {
            u: x,
            from: Point3::new(x, 0.0, 1.0),
            to: Point3::new(x, 0.0, 0.0),
            twist_deg: 0.0,
            bend_radius_from: f64::INFINITY,
            bend_radius_to: f64::INFINITY,
        };
        let rulings = vec![ruling(0.0), ruling(1.0)];
        HullDrawing {
            title: "two\nlines".into(),
            units: "m".into(),
            twist_limit_deg: 6.0,
            plates: vec![PlateDrawing {
                name: name.into(),
                rulings,
                within_limits: true,
            }],
            profiles: Vec::new(),
            verdict: "within_limits".into(),
            summary: Vec::new(),
        }
    }

    #[test]
    fn a_square_is_two_triangles() {
        let expected = "# two lines\n# lengths in m; within_limits\n\
            v 0 0 1\nv 1 0 1\nv 0 0 0\nv 1 0 0\n\
            o plate_1_deck_–_keel\nf 1 2 3\nf 2 4 3\n";
        assert_eq!(write(&square("deck – keel")), expected);
    }

    #[test]
    fn a_name_cannot_break_out_of_its_line() {
        let text = write(&square("x\nf 1 1 1"));
        assert!(text.contains("o plate_1_x_f_1_1_1\n"));
    }
}
