//! Drawing exchange files for cutting tables: outlines, lines, text, each on
//! the layer that says what to do with it.
//!
//! Two versions: R2000 (AC1015), which states the unit (`$INSUNITS`) and has
//! light polylines, and R12 (AC1009) for old controllers, whose unit stands in
//! a text only. The file holds no time, so that the same drawing gives the same
//! bytes.
//!
//! Limits: a plane drawing; lines, arcs and text only.

mod groups;
mod r12;
mod r2000;

use super::length_unit::LengthUnit;
use groups::Groups;
use nalgebra::Point2;

/// A drawing, true to size; all lengths in `units`.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawing {
    /// Unit of every length.
    pub units: LengthUnit,
    /// What is drawn.
    pub entities: Vec<Entity>,
}

/// What to do with what is on it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Layer {
    /// Cut along it.
    Cut,
    /// Bend over it.
    Roll,
    /// Mark it: frames, stations, base line.
    Frame,
    /// Read it.
    Text,
}

impl Layer {
    /// All layers.
    pub const ALL: [Layer; 4] = [Layer::Cut, Layer::Roll, Layer::Frame, Layer::Text];

    /// Its name in the file.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Layer::Cut => "CUT",
            Layer::Roll => "ROLL",
            Layer::Frame => "FRAME",
            Layer::Text => "TEXT",
        }
    }

    /// Its colour, an index into the palette that all programmes share: black
    /// or white, blue, green, red.
    fn colour(self) -> u16 {
        match self {
            Layer::Cut => 7,
            Layer::Roll => 5,
            Layer::Frame => 3,
            Layer::Text => 1,
        }
    }
}

/// A corner of a polyline.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Corner {
    /// Where it is.
    pub at: Point2<f64>,
    /// tan(α/4) of the arc of angle α to the next corner, positive to the
    /// left; 0 for a straight line.
    pub bulge: f64,
}

/// Something drawn.
#[derive(Debug, Clone, PartialEq)]
pub enum Entity {
    /// Lines and arcs from corner to corner.
    Polyline {
        /// Its layer.
        layer: Layer,
        /// Its corners, the first not repeated.
        corners: Vec<Corner>,
        /// Whether it runs back to the first.
        closed: bool,
    },
    /// A straight line.
    Line {
        /// Its layer.
        layer: Layer,
        /// Its ends.
        ends: [Point2<f64>; 2],
    },
    /// A line of text.
    Text {
        /// Its layer.
        layer: Layer,
        /// Where its base line begins.
        at: Point2<f64>,
        /// Height of capitals.
        height: f64,
        /// Direction of its base line, degrees from x.
        angle_deg: f64,
        /// What it says.
        text: String,
    },
}

/// Which reader it is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Version {
    /// AC1015.
    R2000,
    /// AC1009.
    R12,
}

/// The drawing as a DXF file.
#[must_use]
pub fn write(drawing: &Drawing, version: Version) -> String {
    let mut groups = Groups::default();
    match version {
        Version::R2000 => r2000::write(drawing, &mut groups),
        Version::R12 => r12::write(drawing, &mut groups),
    }
    groups.text(0, "EOF");
    groups.finish()
}

impl Entity {
    /// Least and greatest corner; arcs by their ends only, which a header's
    /// extents may be.
    fn bounds(&self) -> Vec<Point2<f64>> {
        match self {
            Entity::Polyline { corners, .. } => corners.iter().map(|c| c.at).collect(),
            Entity::Line { ends, .. } => ends.to_vec(),
            Entity::Text { at, .. } => vec![*at],
        }
    }
}

/// Least and greatest corner of a drawing; the unit square of an empty one.
fn extents(drawing: &Drawing) -> [Point2<f64>; 2] {
    let points = drawing.entities.iter().flat_map(Entity::bounds);
    let corners = points.fold(None, |corners, p| {
        let [low, high] = corners.unwrap_or([p, p]);
        Some([low.inf(&p), high.sup(&p)])
    });
    corners.unwrap_or([Point2::origin(), Point2::new(1.0, 1.0)])
}

#[cfg(test)]
mod tests;
