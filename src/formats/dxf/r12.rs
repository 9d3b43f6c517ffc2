//! AC1009: no handles, no classes, polylines corner by corner.

use super::groups::Groups;
use super::{Drawing, Entity, Layer, extents};
use nalgebra::Point2;

/// Writes all sections.
pub(super) fn write(drawing: &Drawing, out: &mut Groups) {
    out.section("HEADER");
    out.text(9, "$ACADVER");
    out.text(1, "AC1009");
    let [low, high] = extents(drawing);
    for (name, corner) in [("$EXTMIN", low), ("$EXTMAX", high)] {
        out.text(9, name);
        out.point(10, &corner, Some(0.0));
    }
    out.end_section();
    tables(out);
    out.section("ENTITIES");
    for entity in &drawing.entities {
        write_entity(entity, out);
    }
    out.end_section();
}

fn tables(out: &mut Groups) {
    out.section("TABLES");
    table(out, "LTYPE", 1);
    out.text(0, "LTYPE");
    out.text(2, "CONTINUOUS");
    out.integer(70, 64);
    out.text(3, "Solid line");
    out.integer(72, 65);
    out.integer(73, 0);
    out.real(40, 0.0);
    out.text(0, "ENDTAB");
    table(out, "LAYER", 1 + Layer::ALL.len());
    layer(out, "0", 7);
    for l in Layer::ALL {
        layer(out, l.name(), l.colour());
    }
    out.text(0, "ENDTAB");
    table(out, "STYLE", 1);
    out.text(0, "STYLE");
    out.text(2, "STANDARD");
    out.integer(70, 0);
    out.real(40, 0.0);
    out.real(41, 1.0);
    out.real(50, 0.0);
    out.integer(71, 0);
    out.real(42, 1.0);
    out.text(3, "txt");
    out.text(4, "");
    out.text(0, "ENDTAB");
    out.end_section();
}

#[allow(clippy::cast_possible_wrap)] // A handful of rows.
fn table(out: &mut Groups, name: &str, rows: usize) {
    out.text(0, "TABLE");
    out.text(2, name);
    out.integer(70, rows as i64);
}

fn layer(out: &mut Groups, name: &str, colour: u16) {
    out.text(0, "LAYER");
    out.text(2, name);
    out.integer(70, 0);
    out.integer(62, colour);
    out.text(6, "CONTINUOUS");
}

fn write_entity(entity: &Entity, out: &mut Groups) {
    match entity {
        Entity::Polyline {
            layer,
            corners,
            closed,
        } => {
            out.text(0, "POLYLINE");
            out.text(8, layer.name());
            out.integer(66, 1);
            out.point(10, &Point2::origin(), Some(0.0));
            out.integer(70, i64::from(*closed));
            for corner in corners {
                out.text(0, "VERTEX");
                out.text(8, layer.name());
                out.point(10, &corner.at, Some(0.0));
                if corner.bulge != 0.0 {
                    out.real(42, corner.bulge);
                }
            }
            out.text(0, "SEQEND");
            out.text(8, layer.name());
        }
        Entity::Line { layer, ends } => {
            out.text(0, "LINE");
            out.text(8, layer.name());
            out.point(10, &ends[0], Some(0.0));
            out.point(11, &ends[1], Some(0.0));
        }
        Entity::Text {
            layer,
            at,
            height,
            angle_deg,
            text,
        } => {
            out.text(0, "TEXT");
            out.text(8, layer.name());
            out.point(10, at, Some(0.0));
            out.real(40, *height);
            out.text(1, text);
            out.real(50, *angle_deg);
        }
    }
}
