//! Binary STL: triangles with their normals, nothing else.
//!
//! The format knows no units and no parts; the unit and the verdict stand in
//! the 80 bytes at the top. Coordinates have single precision.

use super::mesh_out::MeshDrawing;
use super::obj::one_line;
use nalgebra::{Point3, Vector3};

/// Bytes before the count.
const HEADER: usize = 80;
/// Bytes of a triangle.
const RECORD: usize = 50;

/// The mesh as bytes. Triangles that single precision makes degenerate are
/// left out.
#[must_use]
pub fn write(mesh: &MeshDrawing) -> Vec<u8> {
    let triangles: Vec<_> = facets(mesh).collect();
    let mut bytes = header(mesh);
    bytes.reserve(4 + RECORD * triangles.len());
    // More than 2³² triangles do not come of a fit.
    bytes.extend(
        u32::try_from(triangles.len())
            .unwrap_or(u32::MAX)
            .to_le_bytes(),
    );
    for (normal, corners) in triangles {
        let numbers = normal.iter().chain(corners.iter().flat_map(|p| p.iter()));
        bytes.extend(numbers.flat_map(|x| x.to_le_bytes()));
        bytes.extend([0, 0]);
    }
    bytes
}

fn facets(mesh: &MeshDrawing) -> impl Iterator<Item = (Vector3<f32>, [Point3<f32>; 3])> + '_ {
    let single = |v: usize| mesh.vertices[v].map(|c| c as f32);
    (mesh.parts.iter())
        .flat_map(|part| part.triangles.iter().map(|t| t.map(|i| part.corners[i])))
        .filter_map(move |t| {
            let corners = t.map(single);
            let [a, b, c] = corners.map(|p| p.cast::<f64>());
            let normal = (b - a).cross(&(c - a)).try_normalize(0.0)?;
            Some((normal.cast::<f32>(), corners))
        })
}

/// ASCII, never beginning with the word `solid`, which would announce a text.
fn header(mesh: &MeshDrawing) -> Vec<u8> {
    let text = format!(
        "lengths in {}; {}; {}",
        mesh.units, mesh.verdict, mesh.title
    );
    let ascii = one_line(&text)
        .chars()
        .map(|c| if c.is_ascii() { c } else { '?' })
        .collect::<String>();
    let mut bytes = ascii.into_bytes();
    bytes.resize(HEADER, b' ');
    bytes
}

#[cfg(test)]
mod tests {
    use super::super::mesh_in;
    use super::super::mesh_out::tests::two_squares;
    use super::*;

    #[test]
    fn our_own_reader_finds_the_triangles() {
        let bytes = write(&two_squares());
        assert_eq!(bytes.len(), HEADER + 4 + 4 * RECORD);
        assert!(bytes.starts_with(b"lengths in m; within_limits; squares"));
        let read = mesh_in::read(&bytes).unwrap();
        assert_eq!(read.mesh.faces().len(), 4);
        assert_eq!(read.mesh.vertices().len(), 6);
    }

    #[test]
    fn normals_are_unit_and_by_the_winding() {
        let bytes = write(&two_squares());
        let number = |at: usize| f32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
        assert_eq!([84, 88, 92].map(number), [0.0, 0.0, 1.0]);
    }

    #[test]
    fn degenerate_triangles_are_left_out() {
        let mut mesh = two_squares();
        mesh.vertices[4] = mesh.vertices[0];
        assert_eq!(write(&mesh)[HEADER..HEADER + 4], 2u32.to_le_bytes());
    }
}
