//! Meshes on the wire: vertices, and faces by their indices.

use super::curves::{Point, check_points};
use super::index::index;
use super::job::Units;
use crate::geometry::{Face, Mesh, MeshError};
use crate::http::problem::FieldError;
use serde::de::{Error, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::fmt;
use utoipa::openapi::RefOr;
use utoipa::openapi::schema::{ArrayBuilder, Schema};
use utoipa::{PartialSchema, ToSchema};

/// A mesh of triangles and quads. In a form with a file it is the file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct MeshInput {
    /// The vertices.
    #[schema(min_items = 3, max_items = 1_000_000)]
    pub vertices: Vec<Point>,
    /// The faces: three or four vertices each, counted from 0, in order around
    /// the face.
    #[schema(min_items = 1, max_items = 1_000_000)]
    pub faces: Vec<MeshFace>,
}

impl MeshInput {
    /// The mesh; none where something is wrong with it, which is told with
    /// its JSON pointer below `at`.
    pub fn to_mesh(&self, at: &str, units: Units, faults: &mut Vec<FieldError>) -> Option<Mesh> {
        let before = faults.len();
        check_points(&self.vertices, &format!("{at}/vertices"), units, faults);
        let vertices = self.vertices.iter().map(|p| (*p).into()).collect();
        let faces = self.faces.iter().map(|f| f.0).collect();
        match Mesh::new(vertices, faces) {
            Ok(mesh) => (faults.len() == before).then_some(mesh),
            Err(error) => {
                faults.push(fault(error, at));
                None
            }
        }
    }
}

fn fault(error: MeshError, at: &str) -> FieldError {
    let message = error.to_string();
    match error {
        MeshError::NotFinite { vertex } => {
            FieldError::new(format!("{at}/vertices/{vertex}"), "out-of-range", message)
        }
        MeshError::OutOfRange {
            face,
            corner,
            vertex,
            ..
        } => FieldError::new(
            format!("{at}/faces/{face}/{corner}"),
            "out-of-range",
            message,
        )
        .value(vertex.to_string())
        .hint("vertices are counted from 0; files of OBJ count from 1"),
        MeshError::RepeatedCorner { face, vertex } => {
            FieldError::new(format!("{at}/faces/{face}"), "repeated-corner", message)
                .value(vertex.to_string())
                .hint("leave the face out, or write it as a triangle")
        }
    }
}

/// Three or four indices.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MeshFace(pub Face);

impl Serialize for MeshFace {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.0.corners().serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for MeshFace {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_seq(Corners)
    }
}

struct Corners;

impl<'de> Visitor<'de> for Corners {
    type Value = MeshFace;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("three or four indices")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<MeshFace, A::Error> {
        let (mut corners, mut count) = ([0; 4], 0);
        while let Some(super::index::Index(corner)) = list.next_element()? {
            let slot = corners.get_mut(count);
            *slot.ok_or_else(|| A::Error::invalid_length(5, &self))? = corner;
            count += 1;
        }
        Face::of(&corners[..count])
            .map(MeshFace)
            .ok_or_else(|| A::Error::invalid_length(count, &self))
    }
}

impl PartialSchema for MeshFace {
    fn schema() -> RefOr<Schema> {
        ArrayBuilder::new()
            .items(index())
            .min_items(Some(3))
            .max_items(Some(4))
            .description(Some("Three or four indices of vertices"))
            .examples([serde_json::json!([0, 1, 2, 3])])
            .into()
    }
}

impl ToSchema for MeshFace {}

#[cfg(test)]
mod tests {
    use super::*;

    fn faults(text: &str) -> Vec<(String, String)> {
        let mesh: MeshInput = serde_json::from_str(text).unwrap();
        let mut faults = Vec::new();
        let read = mesh.to_mesh("/input/mesh", Units::M, &mut faults);
        assert_eq!(read.is_some(), faults.is_empty());
        faults.into_iter().map(|f| (f.pointer, f.code)).collect()
    }

    #[test]
    fn a_mesh_comes_back_as_it_went() {
        let text = r#"{"vertices":[[0.0,0.0,0.0],[1.0,0.0,0.0],[1.0,1.0,0.0],[0.0,1.0,0.5]],"faces":[[0,1,2,3],[0,2,1]]}"#;
        let mesh: MeshInput = serde_json::from_str(text).unwrap();
        assert_eq!(serde_json::to_string(&mesh).unwrap(), text);
        assert!(faults(text).is_empty());
        for bad in ["[0,1]", "[0,1,2,3,0]", "[0,1,2.5]", "[0,1,-1]"] {
            let text = text.replace("[0,2,1]", bad);
            assert!(serde_json::from_str::<MeshInput>(&text).is_err(), "{bad}");
        }
    }

    #[test]
    fn every_fault_points_to_its_place() {
        let with = |vertex: &str, face: &str| {
            format!(r#"{{"vertices":[[0,0,0],[1,0,0],{vertex}],"faces":[[0,1,2],{face}]}}"#)
        };
        let cases = [
            (with("[1,1,0]", "[0,1,3]"), "/faces/1/2", "out-of-range"),
            (with("[1,1,0]", "[0,1,0]"), "/faces/1", "repeated-corner"),
            (
                with("[1,2e6,0]", "[0,2,1]"),
                "/vertices/2/1",
                "out-of-range",
            ),
        ];
        for (text, place, code) in cases {
            let place = format!("/input/mesh{place}");
            assert_eq!(faults(&text), [(place, code.to_owned())], "{text}");
        }
    }
}
