//! glTF 2.0 in its binary form: a scene with a node for every part and every
//! group of lines.
//!
//! glTF is in metres with y up; a ship's lines are in the yard's unit with z
//! up. So vertices stand in the drawing's unit about the middle of the box, where
//! single precision holds them to a hundred-millionth of its size, and the matrix
//! of the root node brings them to metres, y up. Its `extras` say what the colours
//! mean: `quantity`, `unit`, `limit` (null without one), `largest`, `verdict`,
//! and `units` and `centre` of the vertices.
//!
//! Parts have `COLOR_0` (linear, as the format asks) and `_VALUE`, the number
//! itself. Lines have none of both.
//!
//! Source: Khronos, glTF 2.0 specification (ISO/IEC 12113:2022).

use super::mesh_out::{Colours, LineGroup, MeshDrawing, MeshPart};
use super::obj::push;
use nalgebra::Point3;

/// A float, and an unsigned int, in an accessor.
const FLOAT: u32 = 5126;
/// See [`FLOAT`].
const UNSIGNED: u32 = 5125;
/// What a buffer view holds: vertices, indices.
const VERTICES: u32 = 34962;
/// See [`VERTICES`].
const INDICES: u32 = 34963;
/// Modes of a primitive.
const LINES: u32 = 1;
/// See [`LINES`].
const TRIANGLES: u32 = 4;
/// Types of the two chunks.
const JSON_CHUNK: u32 = 0x4E4F_534A;
/// See [`JSON_CHUNK`].
const BINARY_CHUNK: u32 = 0x004E_4942;

/// The mesh as bytes.
#[must_use]
pub fn write(mesh: &MeshDrawing) -> Vec<u8> {
    let mut scene = Scene {
        centre: centre(mesh),
        ..Scene::default()
    };
    let scale = Colours::of(mesh);
    for (name, part) in mesh.part_names().iter().zip(&mesh.parts) {
        if !part.triangles.is_empty() {
            scene.add_part(mesh, (name, part), scale);
        }
    }
    for group in &mesh.lines {
        scene.add_lines(group);
    }
    scene.finish(mesh)
}

/// A scene under construction.
#[derive(Default)]
struct Scene {
    binary: Vec<u8>,
    views: Vec<String>,
    accessors: Vec<String>,
    meshes: Vec<String>,
    nodes: Vec<String>,
    centre: Point3<f64>,
}

impl Scene {
    fn add_part(&mut self, mesh: &MeshDrawing, (name, part): (&str, &MeshPart), scale: Colours) {
        let places = part.corners.iter().map(|v| mesh.vertices[*v]);
        let mut attributes = format!("\"POSITION\":{}", self.positions(places));
        let normals: Vec<[f32; 3]> = (part.corners.iter())
            .filter_map(|v| mesh.normals.get(*v))
            .map(|n| [n.x, n.y, n.z].map(|c| c as f32))
            .collect();
        if normals.len() == part.corners.len() {
            let number = self.floats(&normals, "");
            push(&mut attributes, format_args!(",\"NORMAL\":{number}"));
        }
        let value = |i: usize| part.values.get(i).copied();
        let colours: Vec<[f32; 3]> = (0..part.corners.len())
            .map(|i| scale.at(value(i)).linear.map(|c| c as f32))
            .collect();
        let number = self.floats(&colours, "");
        push(&mut attributes, format_args!(",\"COLOR_0\":{number}"));
        if !part.values.is_empty() {
            let values: Vec<[f32; 1]> = part.values.iter().map(|v| [*v as f32]).collect();
            let number = self.floats(&values, "");
            push(&mut attributes, format_args!(",\"_VALUE\":{number}"));
        }
        let indices = self.indices(part.triangles.iter().flatten().copied());
        self.add_mesh(name, &attributes, indices, TRIANGLES);
    }

    fn add_lines(&mut self, group: &LineGroup) {
        let points = group.lines.iter().flatten().copied();
        let attributes = format!("\"POSITION\":{}", self.positions(points));
        let mut pairs = Vec::new();
        let mut first = 0;
        for line in &group.lines {
            pairs.extend((first..first + line.len() - 1).flat_map(|i| [i, i + 1]));
            first += line.len();
        }
        let indices = self.indices(pairs.into_iter());
        self.add_mesh(&group.name, &attributes, indices, LINES);
    }

    fn add_mesh(&mut self, name: &str, attributes: &str, indices: usize, mode: u32) {
        let name = text(name);
        let material = usize::from(mode == LINES);
        let number = self.meshes.len();
        self.nodes
            .push(format!("{{\"name\":{name},\"mesh\":{number}}}"));
        self.meshes.push(format!(
            "{{\"name\":{name},\"primitives\":[{{\"attributes\":{{{attributes}}},\
             \"indices\":{indices},\"material\":{material},\"mode\":{mode}}}]}}"
        ));
    }

    /// An accessor with the bounds that the format asks of positions.
    fn positions(&mut self, points: impl Iterator<Item = Point3<f64>>) -> usize {
        let local: Vec<[f32; 3]> = points
            .map(|p| {
                let from = p - self.centre;
                [from.x, from.y, from.z].map(|c| c as f32)
            })
            .collect();
        let mut bounds = [[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]];
        for point in &local {
            for (k, c) in point.iter().enumerate() {
                bounds[0][k] = bounds[0][k].min(*c);
                bounds[1][k] = bounds[1][k].max(*c);
            }
        }
        let [least, most] = bounds.map(|b| numbers(&b.map(f64::from)));
        self.floats(&local, &format!(",\"min\":{least},\"max\":{most}"))
    }

    fn floats<const N: usize>(&mut self, rows: &[[f32; N]], more: &str) -> usize {
        let view = self.view(
            rows.iter().flatten().flat_map(|x| x.to_le_bytes()),
            VERTICES,
        );
        let kind = if N == 1 { "SCALAR" } else { "VEC3" };
        self.accessor(view, FLOAT, rows.len(), kind, more)
    }

    fn indices(&mut self, indices: impl Iterator<Item = usize>) -> usize {
        // More than 2³² vertices do not come of a fit.
        let indices: Vec<u32> = indices
            .map(|i| u32::try_from(i).unwrap_or(u32::MAX))
            .collect();
        let view = self.view(indices.iter().flat_map(|i| i.to_le_bytes()), INDICES);
        self.accessor(view, UNSIGNED, indices.len(), "SCALAR", "")
    }

    /// All numbers have four bytes, so every view begins where it may.
    fn view(&mut self, bytes: impl Iterator<Item = u8>, target: u32) -> usize {
        let offset = self.binary.len();
        self.binary.extend(bytes);
        let length = self.binary.len() - offset;
        self.views.push(format!(
            "{{\"buffer\":0,\"byteOffset\":{offset},\"byteLength\":{length},\"target\":{target}}}"
        ));
        self.views.len() - 1
    }

    fn accessor(&mut self, view: usize, of: u32, count: usize, kind: &str, more: &str) -> usize {
        self.accessors.push(format!(
            "{{\"bufferView\":{view},\"componentType\":{of},\"count\":{count},\
             \"type\":\"{kind}\"{more}}}"
        ));
        self.accessors.len() - 1
    }

    fn finish(self, mesh: &MeshDrawing) -> Vec<u8> {
        let mut json = self.json(mesh).into_bytes();
        json.resize(json.len().next_multiple_of(4), b' ');
        // Every view's length is a multiple of four.
        let has_binary = !self.binary.is_empty();
        let chunks = 8 + json.len() + if has_binary { 8 + self.binary.len() } else { 0 };
        let mut bytes = Vec::with_capacity(12 + chunks);
        // More than 4 GB do not come of a fit.
        let word = |bytes: &mut Vec<u8>, n: usize| {
            bytes.extend(u32::try_from(n).unwrap_or(u32::MAX).to_le_bytes());
        };
        bytes.extend(b"glTF");
        word(&mut bytes, 2);
        word(&mut bytes, 12 + chunks);
        word(&mut bytes, json.len());
        bytes.extend(JSON_CHUNK.to_le_bytes());
        bytes.extend(json);
        if has_binary {
            word(&mut bytes, self.binary.len());
            bytes.extend(BINARY_CHUNK.to_le_bytes());
            bytes.extend(self.binary);
        }
        bytes
    }

    fn json(&self, mesh: &MeshDrawing) -> String {
        let title = text(&mesh.title);
        let mut json = format!(
            "{{\"asset\":{{\"version\":\"2.0\",\"generator\":\"mouldloft {}\"}},\"scene\":0,\
             \"scenes\":[{{\"name\":{title},\"nodes\":[0]}}],\"nodes\":[{{\"name\":{title},\
             \"matrix\":{},\"extras\":{}",
            env!("CARGO_PKG_VERSION"),
            numbers(&self.matrix(mesh)),
            self.extras(mesh)
        );
        if self.nodes.is_empty() {
            json.push_str("}]}");
            return json;
        }
        let children: Vec<String> = (1..=self.nodes.len()).map(|n| n.to_string()).collect();
        push(
            &mut json,
            format_args!(
                ",\"children\":[{}]}},{}],\"materials\":[{}],\"meshes\":[{}],\"accessors\":[{}],\
                 \"bufferViews\":[{}],\"buffers\":[{{\"byteLength\":{}}}]}}",
                children.join(","),
                self.nodes.join(","),
                MATERIALS,
                self.meshes.join(","),
                self.accessors.join(","),
                self.views.join(","),
                self.binary.len()
            ),
        );
        json
    }

    /// (x, y, z) ↦ s (x, z, −y) with s metres in the unit, column by column.
    fn matrix(&self, mesh: &MeshDrawing) -> [f64; 16] {
        let s = mesh.units.metres();
        let c = self.centre;
        [
            [s, 0.0, 0.0, 0.0],
            [0.0, 0.0, -s, 0.0],
            [0.0, s, 0.0, 0.0],
            // Adding zero makes −0 plain.
            [s * c.x, s * c.z, 0.0 - s * c.y, 1.0],
        ]
        .concat()
        .try_into()
        .unwrap_or([0.0; 16])
    }

    fn extras(&self, mesh: &MeshDrawing) -> String {
        let values = mesh.parts.iter().flat_map(|p| &p.values);
        let largest = values.fold(0.0, |most: f64, v| most.max(v.abs()));
        let (quantity, unit, limit) = match &mesh.quantity {
            Some(q) => (
                text(&q.name),
                text(&q.kind.unit(mesh.units)),
                q.limit.map_or("null".to_owned(), |l| format!("{l:?}")),
            ),
            None => ("null".to_owned(), "null".to_owned(), "null".to_owned()),
        };
        format!(
            "{{\"quantity\":{quantity},\"unit\":{unit},\"limit\":{limit},\"largest\":{largest:?},\
             \"verdict\":{},\"units\":{},\"centre\":{}}}",
            text(&mesh.verdict),
            text(mesh.units.symbol()),
            numbers(self.centre.coords.as_slice())
        )
    }
}

/// Of faces, seen from both sides and coloured by their vertices; of lines.
const MATERIALS: &str = "{\"name\":\"plate\",\"doubleSided\":true,\"pbrMetallicRoughness\":\
    {\"metallicFactor\":0,\"roughnessFactor\":0.9}},{\"name\":\"line\",\"pbrMetallicRoughness\":\
    {\"baseColorFactor\":[0.01,0.012,0.02,1],\"metallicFactor\":0,\"roughnessFactor\":1}}";

/// The middle of the box of everything.
fn centre(mesh: &MeshDrawing) -> Point3<f64> {
    let lines = mesh.lines.iter().flat_map(|g| g.lines.iter().flatten());
    let all = mesh.vertices.iter().chain(lines);
    let corners = all.fold(None, |corners: Option<[Point3<f64>; 2]>, p| {
        let [low, high] = corners.unwrap_or([*p, *p]);
        Some([low.inf(p), high.sup(p)])
    });
    corners.map_or_else(Point3::origin, |[low, high]| nalgebra::center(&low, &high))
}

/// A JSON array.
fn numbers(all: &[f64]) -> String {
    let all: Vec<String> = all.iter().map(|x| format!("{x:?}")).collect();
    format!("[{}]", all.join(","))
}

/// A JSON string.
fn text(plain: &str) -> String {
    let mut json = String::from("\"");
    for c in plain.chars() {
        match c {
            '"' | '\\' => json.extend(['\\', c]),
            c if c.is_control() => push(&mut json, format_args!("\\u{:04x}", u32::from(c))),
            c => json.push(c),
        }
    }
    json.push('"');
    json
}

#[cfg(test)]
mod tests {
    use super::super::length_unit::LengthUnit;
    use super::super::mesh_out::tests::two_squares;
    use super::*;
    use serde_json::Value;

    /// The two chunks.
    fn read(bytes: &[u8]) -> (Value, Vec<u8>) {
        let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
        assert_eq!(&bytes[..4], b"glTF");
        assert_eq!((word(4), word(8) as usize), (2, bytes.len()));
        let length = word(12) as usize;
        assert_eq!(word(16), JSON_CHUNK);
        let json = serde_json::from_slice(&bytes[20..20 + length]).unwrap();
        let binary = bytes.get(20 + length..).filter(|b| !b.is_empty());
        if let Some(binary) = binary {
            assert_eq!(binary.len() % 4, 0);
            assert_eq!(word(20 + length + 4), BINARY_CHUNK);
        }
        (json, binary.map_or(Vec::new(), |b| b[8..].to_vec()))
    }

    fn floats(json: &Value, binary: &[u8], accessor: &Value) -> Vec<f32> {
        let accessor = &json["accessors"][accessor.as_u64().unwrap() as usize];
        let view = &json["bufferViews"][accessor["bufferView"].as_u64().unwrap() as usize];
        let from = view["byteOffset"].as_u64().unwrap() as usize;
        let length = view["byteLength"].as_u64().unwrap() as usize;
        let words = binary[from..from + length].chunks_exact(4);
        words
            .map(|w| f32::from_le_bytes(w.try_into().unwrap()))
            .collect()
    }

    #[test]
    fn parts_are_named_nodes_with_their_numbers() {
        let (json, binary) = read(&write(&two_squares()));
        let names: Vec<_> = (json["nodes"].as_array().unwrap().iter())
            .map(|n| n["name"].as_str().unwrap())
            .collect();
        assert_eq!(
            names,
            ["squares", "deck – keel", "deck – keel (2)", "rulings"]
        );
        assert_eq!(json["buffers"][0]["byteLength"], binary.len());
        let second = &json["meshes"][1]["primitives"][0];
        let values = floats(&json, &binary, &second["attributes"]["_VALUE"]);
        assert_eq!(values, [-1.0, 2.5, 0.25, 1.0]);
        let colours = floats(&json, &binary, &second["attributes"]["COLOR_0"]);
        assert!(colours[3] > 0.6 && colours[4] < 0.01, "red above the limit");
        assert_eq!(json["meshes"][2]["primitives"][0]["mode"], LINES);
    }

    #[test]
    fn the_root_brings_every_vertex_to_metres_with_y_up() {
        let mut mesh = two_squares();
        mesh.units = LengthUnit::Foot;
        let far = nalgebra::Vector3::new(1e5, 2e5, 3e5);
        mesh.vertices.iter_mut().for_each(|v| *v += far);
        mesh.lines.clear();
        let (json, binary) = read(&write(&mesh));
        let matrix: Vec<f64> = serde_json::from_value(json["nodes"][0]["matrix"].clone()).unwrap();
        let first = &json["meshes"][1]["primitives"][0]["attributes"]["POSITION"];
        let local = &floats(&json, &binary, first)[6..9];
        let at = |row: usize| {
            let column = |k: usize| matrix[4 * k + row];
            (0..3).map(|k| column(k) * f64::from(local[k])).sum::<f64>() + column(3)
        };
        let expected = [2.0 + 1e5, 0.5 + 3e5, -(1.0 + 2e5)].map(|x| x * 0.3048);
        for (row, expected) in expected.iter().enumerate() {
            assert!((at(row) - expected).abs() < 1e-7, "{row}");
        }
    }

    #[test]
    fn the_extras_say_what_the_colours_mean() {
        let mut mesh = two_squares();
        let extras = |mesh: &MeshDrawing| read(&write(mesh)).0["nodes"][0]["extras"].clone();
        let told = extras(&mesh);
        assert_eq!(told["quantity"], "twist");
        assert_eq!(told["unit"], "deg");
        assert_eq!(told["limit"], 2.0);
        assert_eq!(told["largest"], 2.5);
        assert_eq!(told["verdict"], "within_limits");
        assert_eq!(told["units"], "m");
        mesh.title = "a \"b\"\n\\".into();
        mesh.quantity = None;
        assert_eq!(extras(&mesh)["quantity"], Value::Null);
        assert_eq!(read(&write(&mesh)).0["scenes"][0]["name"], "a \"b\"\n\\");
    }

    #[test]
    fn nothing_is_a_scene_without_a_mesh() {
        let mut mesh = two_squares();
        mesh.parts.clear();
        mesh.lines.clear();
        let (json, binary) = read(&write(&mesh));
        assert!(binary.is_empty());
        assert_eq!(json["meshes"], Value::Null);
    }
}
