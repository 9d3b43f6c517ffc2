//! Putting a mesh together, part by part.

use super::{LineGroup, MeshDrawing, MeshPart, Quantity};
use crate::formats::length_unit::LengthUnit;
use nalgebra::Point3;
use std::collections::BTreeMap;

/// What stands above a mesh.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Heading<'a> {
    /// The user's label of the job, or a name for it.
    pub title: &'a str,
    /// Unit of every length.
    pub units: LengthUnit,
    /// `within_limits` or `outside_limits`.
    pub verdict: &'a str,
}

impl Heading<'_> {
    /// A mesh without anything in it.
    pub fn begin(&self, quantity: Option<Quantity>) -> MeshDrawing {
        MeshDrawing {
            title: self.title.to_owned(),
            units: self.units,
            verdict: self.verdict.to_owned(),
            chordal_error: None,
            quantity,
            vertices: Vec::new(),
            normals: Vec::new(),
            parts: Vec::new(),
            lines: Vec::new(),
        }
    }
}

impl MeshDrawing {
    /// Adds a part by triangles of the mesh's vertices; `value` gives the
    /// number of a vertex on this part. A part with a number that is not
    /// finite gets none.
    pub(super) fn add_part(
        &mut self,
        name: &str,
        triangles: &[[usize; 3]],
        value: impl Fn(usize) -> Option<f64>,
    ) {
        let mut own = BTreeMap::new();
        let mut corners = Vec::new();
        let mut corner = |vertex: usize| {
            *own.entry(vertex).or_insert_with(|| {
                corners.push(vertex);
                corners.len() - 1
            })
        };
        let triangles = triangles.iter().map(|t| t.map(&mut corner)).collect();
        let values: Option<Vec<f64>> = (corners.iter())
            .map(|vertex| value(*vertex).filter(|v| v.is_finite()))
            .collect();
        self.parts.push(MeshPart {
            name: name.to_owned(),
            corners,
            values: values.unwrap_or_default(),
            triangles,
        });
    }

    /// Adds lines, if there are any.
    pub(super) fn add_lines(
        &mut self,
        name: &str,
        part: Option<usize>,
        lines: impl IntoIterator<Item = Vec<Point3<f64>>>,
    ) {
        let drawable = |line: &Vec<Point3<f64>>| {
            line.len() > 1 && line.iter().flat_map(|p| p.iter()).all(|c| c.is_finite())
        };
        let lines: Vec<_> = lines.into_iter().filter(drawable).collect();
        if !lines.is_empty() {
            self.lines.push(LineGroup {
                name: name.to_owned(),
                part,
                lines,
            });
        }
    }
}
