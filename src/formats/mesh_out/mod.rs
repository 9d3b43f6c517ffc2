//! The tessellation of a result, one for all mesh files: named parts over one
//! list of vertices, one number a vertex to colour by, and lines.
//!
//! [`obj`](super::obj), [`stl`](super::stl), [`ply`](super::ply) and
//! [`glb`](super::glb) write it; the modules below make it out of the drawings
//! of the methods.
//!
//! A vertex on the border of two parts may have another number on either side
//! (the twist of two plates at their chine), so numbers belong to the corners of
//! a part and places to the mesh.

mod build;
mod colour;
mod cone;
mod fair;
mod hull;
mod nearest;
mod net;

pub use cone::ConeGrid;
pub use net::Reference;

pub(super) use colour::Colours;

use super::length_unit::LengthUnit;
use nalgebra::{Point3, Vector3};

/// A mesh to be written as a file; all lengths in [`MeshDrawing::units`].
#[derive(Debug, Clone, PartialEq)]
pub struct MeshDrawing {
    /// The user's label of the job, or a name for it.
    pub title: String,
    /// Unit of every length.
    pub units: LengthUnit,
    /// `within_limits` or `outside_limits`.
    pub verdict: String,
    /// How far the triangles leave the surface, where that was measured.
    pub chordal_error: Option<f64>,
    /// What the numbers are; `None` without numbers.
    pub quantity: Option<Quantity>,
    /// Places that the parts share.
    pub vertices: Vec<Point3<f64>>,
    /// Unit normals, one a vertex, or none at all.
    pub normals: Vec<Vector3<f64>>,
    /// Plates, patches.
    pub parts: Vec<MeshPart>,
    /// Rulings, profiles, borders.
    pub lines: Vec<LineGroup>,
}

/// A plate or patch of a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshPart {
    /// Its name.
    pub name: String,
    /// Its vertices as indices into those of the mesh, each once.
    pub corners: Vec<usize>,
    /// One number a corner, or none at all; all finite.
    pub values: Vec<f64>,
    /// Triangles as indices into `corners`; the winding is the same throughout
    /// a mesh.
    pub triangles: Vec<[usize; 3]>,
}

/// Lines that belong together.
#[derive(Debug, Clone, PartialEq)]
pub struct LineGroup {
    /// What they are.
    pub name: String,
    /// The part that they lie on; `None` if on several.
    pub part: Option<usize>,
    /// Polylines of two points or more.
    pub lines: Vec<Vec<Point3<f64>>>,
}

/// What the numbers of a mesh are.
#[derive(Debug, Clone, PartialEq)]
pub struct Quantity {
    /// Its name, for example `twist`.
    pub name: String,
    /// What kind of number it is.
    pub kind: QuantityKind,
    /// The largest allowed magnitude, where there is one.
    pub limit: Option<f64>,
}

/// Kinds of numbers, by their unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum QuantityKind {
    /// An angle in degrees.
    Degrees,
    /// A length in the mesh's unit.
    Length,
    /// One over such a length.
    PerLength,
}

impl QuantityKind {
    /// The power of the unit of length in it.
    #[must_use]
    pub fn power(self) -> i32 {
        match self {
            QuantityKind::Degrees => 0,
            QuantityKind::Length => 1,
            QuantityKind::PerLength => -1,
        }
    }

    /// Its unit in words.
    #[must_use]
    pub fn unit(self, lengths: LengthUnit) -> String {
        match self {
            QuantityKind::Degrees => "deg".to_owned(),
            QuantityKind::Length => lengths.to_string(),
            QuantityKind::PerLength => format!("1/{lengths}"),
        }
    }
}

impl MeshDrawing {
    /// The magnitude at which the colours end: the limit, or without one the
    /// largest magnitude that there is.
    #[must_use]
    pub fn full_scale(&self) -> f64 {
        let values = self.parts.iter().flat_map(|p| &p.values);
        let limit = self.quantity.as_ref().and_then(|q| q.limit);
        limit.unwrap_or_else(|| values.fold(0.0, |most, v| most.max(v.abs())))
    }

    /// One part alone, with the lines on it.
    #[must_use]
    pub fn only(&self, part: usize) -> Option<MeshDrawing> {
        let one = self.parts.get(part)?;
        let of_corners = |i: &usize| self.vertices[*i];
        let normals = one.corners.iter().filter_map(|i| self.normals.get(*i));
        let lines = self.lines.iter().filter(|g| g.part == Some(part));
        Some(MeshDrawing {
            vertices: one.corners.iter().map(of_corners).collect(),
            normals: normals.copied().collect(),
            parts: vec![MeshPart {
                corners: (0..one.corners.len()).collect(),
                ..one.clone()
            }],
            lines: lines
                .map(|g| LineGroup {
                    part: Some(0),
                    ..g.clone()
                })
                .collect(),
            ..self.clone()
        })
    }

    /// The names of the parts, each once: a second part of a name gets a
    /// number.
    pub(super) fn part_names(&self) -> Vec<String> {
        let mut names: Vec<String> = Vec::with_capacity(self.parts.len());
        let mut taken = std::collections::HashSet::new();
        for part in &self.parts {
            let mut name = part.name.clone();
            let mut number = 1;
            while !taken.insert(name.clone()) {
                number += 1;
                name = format!("{} ({number})", part.name);
            }
            names.push(name);
        }
        names
    }
}

#[cfg(test)]
pub(super) mod tests;
