//! The mesh of a hull: its plates with their twist, rulings, profiles.

use super::build::Heading;
use super::{MeshDrawing, Quantity, QuantityKind};
use crate::formats::length_unit::LengthUnit;
use crate::formats::plates::HullDrawing;
use crate::formats::strip;

impl MeshDrawing {
    /// A hull, whose lengths are in `units`: watertight along the chines,
    /// every ruling an edge.
    #[must_use]
    pub fn of_hull(hull: &HullDrawing, units: LengthUnit) -> Self {
        let heading = Heading {
            title: &hull.title,
            units,
            verdict: &hull.verdict,
        };
        let mut drawing = heading.begin(Some(Quantity {
            name: "twist".to_owned(),
            kind: QuantityKind::Degrees,
            limit: Some(hull.twist_limit_deg),
        }));
        let mesh = strip::mesh(hull);
        drawing.vertices = mesh.vertices;
        for (plate, cut) in hull.plates.iter().zip(&mesh.plates) {
            drawing.add_part(&plate.name, &cut.triangles, |vertex| {
                cut.twists.get(&vertex).copied()
            });
        }
        for (index, plate) in hull.plates.iter().enumerate() {
            let rulings = plate.rulings.iter().map(|r| vec![r.from, r.to]);
            let name = format!("rulings of {}", plate.name);
            drawing.add_lines(&name, Some(index), rulings);
        }
        let profiles = hull.profiles.iter().map(|p| p.points.clone());
        drawing.add_lines("profiles", None, profiles);
        drawing
    }
}
