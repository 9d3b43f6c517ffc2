//! Stanford PLY, binary, little endian: vertices with colour and number,
//! triangles.
//!
//! The format knows no units; they stand in comments, as does what the number
//! is. A vertex on the border of two parts stands there once for each number
//! that it has.

use super::mesh_out::{Colours, MeshDrawing};
use super::obj::{one_line, push};
use std::collections::BTreeMap;

/// The mesh as bytes: double coordinates, single normals (where the mesh has
/// them), 8-bit colours, the number as a property of its own name.
#[must_use]
pub fn write(mesh: &MeshDrawing) -> Vec<u8> {
    let mut rows = Rows::default();
    let mut triangles: Vec<[u32; 3]> = Vec::new();
    for part in &mesh.parts {
        let numbers: Vec<u32> = (part.corners.iter().enumerate())
            .map(|(i, vertex)| rows.number(*vertex, part.values.get(i).copied()))
            .collect();
        triangles.extend(part.triangles.iter().map(|t| t.map(|i| numbers[i])));
    }
    let mut bytes = header(mesh, rows.rows.len(), triangles.len()).into_bytes();
    let colours = Colours::of(mesh);
    for (vertex, value) in &rows.rows {
        let place = mesh.vertices[*vertex];
        bytes.extend(place.iter().flat_map(|x| x.to_le_bytes()));
        if let Some(normal) = mesh.normals.get(*vertex) {
            bytes.extend(normal.iter().flat_map(|x| (*x as f32).to_le_bytes()));
        }
        bytes.extend(colours.at(*value).encoded);
        if mesh.quantity.is_some() {
            bytes.extend(value.unwrap_or(f64::NAN).to_le_bytes());
        }
    }
    for triangle in triangles {
        bytes.push(3);
        bytes.extend(triangle.iter().flat_map(|i| i.to_le_bytes()));
    }
    bytes
}

/// Vertices with one number each.
#[derive(Default)]
struct Rows {
    rows: Vec<(usize, Option<f64>)>,
    known: BTreeMap<(usize, Option<u64>), u32>,
}

impl Rows {
    fn number(&mut self, vertex: usize, value: Option<f64>) -> u32 {
        let rows = &mut self.rows;
        let key = (vertex, value.map(f64::to_bits));
        *self.known.entry(key).or_insert_with(|| {
            rows.push((vertex, value));
            // More than 2³² vertices do not come of a fit.
            u32::try_from(rows.len() - 1).unwrap_or(u32::MAX)
        })
    }
}

fn header(mesh: &MeshDrawing, vertices: usize, faces: usize) -> String {
    let mut text = "ply\nformat binary_little_endian 1.0\n".to_owned();
    let mut comment = |words: &str| {
        let ascii: String = one_line(words)
            .chars()
            .map(|c| if c.is_ascii() { c } else { '?' })
            .collect();
        push(&mut text, format_args!("comment {ascii}\n"));
    };
    comment(&mesh.title);
    comment(&format!("lengths in {}; {}", mesh.units, mesh.verdict));
    if let Some(quantity) = &mesh.quantity {
        let limit = quantity
            .limit
            .map_or(String::new(), |l| format!(", limit {l}"));
        let unit = quantity.kind.unit(mesh.units);
        comment(&format!("{} in {unit}{limit}", quantity.name));
    }
    push(&mut text, format_args!("element vertex {vertices}\n"));
    for axis in ["x", "y", "z"] {
        push(&mut text, format_args!("property double {axis}\n"));
    }
    if !mesh.normals.is_empty() {
        text.push_str("property float nx\nproperty float ny\nproperty float nz\n");
    }
    text.push_str("property uchar red\nproperty uchar green\nproperty uchar blue\n");
    if let Some(quantity) = &mesh.quantity {
        push(
            &mut text,
            format_args!("property double {}\n", quantity.name),
        );
    }
    push(&mut text, format_args!("element face {faces}\n"));
    text.push_str("property list uchar uint vertex_indices\nend_header\n");
    text
}

#[cfg(test)]
mod tests {
    use super::super::mesh_in;
    use super::super::mesh_out::tests::two_squares;
    use super::*;

    #[test]
    fn our_own_reader_finds_the_triangles() {
        let bytes = write(&two_squares());
        let text = String::from_utf8_lossy(&bytes);
        assert!(text.contains("comment lengths in m; within_limits\n"));
        assert!(text.contains("comment twist in deg, limit 2\n"));
        assert!(text.contains("property double twist\n"));
        let read = mesh_in::read(&bytes).unwrap();
        assert_eq!(read.mesh.faces().len(), 4);
    }

    #[test]
    fn a_vertex_stands_there_once_a_number() {
        // Vertices 1 and 4 are on both parts, with another number at 4 alone.
        let text = String::from_utf8_lossy(&write(&two_squares())).into_owned();
        assert!(text.contains("element vertex 7\n"), "{text}");
    }

    #[test]
    fn without_a_quantity_there_is_no_property() {
        let mut mesh = two_squares();
        mesh.quantity = None;
        mesh.parts.iter_mut().for_each(|p| p.values.clear());
        let text = String::from_utf8_lossy(&write(&mesh)).into_owned();
        assert!(!text.contains("twist") && text.contains("element vertex 6\n"));
    }
}
