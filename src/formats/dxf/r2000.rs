//! AC1015: every object has a handle and an owner.

use super::groups::Groups;
use super::{Drawing, Entity, Layer, extents};
use crate::formats::length_unit::LengthUnit;

/// Handles that other objects refer to.
struct Owners {
    model: String,
    paper: String,
    root: String,
    groups: String,
}

/// Writes all sections.
pub(super) fn write(drawing: &Drawing, out: &mut Groups) {
    let owners = Owners {
        model: out.new_handle(),
        paper: out.new_handle(),
        root: out.new_handle(),
        groups: out.new_handle(),
    };
    header(drawing, out);
    out.section("CLASSES");
    out.end_section();
    tables(&owners, out);
    blocks(&owners, out);
    out.section("ENTITIES");
    for entity in &drawing.entities {
        write_entity(entity, &owners, out);
    }
    out.end_section();
    objects(&owners, out);
}

fn header(drawing: &Drawing, out: &mut Groups) {
    let (unit, metric) = match drawing.units {
        LengthUnit::Inch => (1, 0),
        LengthUnit::Foot => (2, 0),
        LengthUnit::Millimetre => (4, 1),
        LengthUnit::Centimetre => (5, 1),
        LengthUnit::Metre => (6, 1),
    };
    out.section("HEADER");
    out.text(9, "$ACADVER");
    out.text(1, "AC1015");
    // Above any handle of the file: five a drawn thing is more than there are.
    out.text(9, "$HANDSEED");
    out.text(5, &format!("{:X}", 0x100 + 5 * drawing.entities.len()));
    out.text(9, "$DWGCODEPAGE");
    out.text(3, "ANSI_1252");
    out.text(9, "$INSUNITS");
    out.integer(70, unit);
    out.text(9, "$MEASUREMENT");
    out.integer(70, metric);
    let [low, high] = extents(drawing);
    for (name, corner) in [("$EXTMIN", low), ("$EXTMAX", high)] {
        out.text(9, name);
        out.point(10, &corner, Some(0.0));
    }
    out.end_section();
}

/// One table with its rows.
fn table(out: &mut Groups, name: &str, rows: i64, write_rows: impl FnOnce(&mut Groups, &str)) {
    let handle = out.new_handle();
    out.text(0, "TABLE");
    out.text(2, name);
    out.text(5, &handle);
    out.text(330, "0");
    out.class("AcDbSymbolTable");
    out.integer(70, rows);
    if name == "DIMSTYLE" {
        out.class("AcDbDimStyleTable");
    }
    write_rows(out, &handle);
    out.text(0, "ENDTAB");
}

/// The head of a row.
fn row(out: &mut Groups, kind: &str, owner: &str, name: &str) {
    let handle = out.new_handle();
    out.text(0, kind);
    out.text(if kind == "DIMSTYLE" { 105 } else { 5 }, &handle);
    out.text(330, owner);
    out.class("AcDbSymbolTableRecord");
    out.class(match kind {
        "LTYPE" => "AcDbLinetypeTableRecord",
        "LAYER" => "AcDbLayerTableRecord",
        "STYLE" => "AcDbTextStyleTableRecord",
        "DIMSTYLE" => "AcDbDimStyleTableRecord",
        "VPORT" => "AcDbViewportTableRecord",
        _ => "AcDbRegAppTableRecord",
    });
    out.text(2, name);
    out.integer(70, 0);
}

fn tables(owners: &Owners, out: &mut Groups) {
    out.section("TABLES");
    table(out, "VPORT", 1, |out, own| {
        row(out, "VPORT", own, "*ACTIVE")
    });
    table(out, "LTYPE", 3, |out, own| {
        for name in ["ByBlock", "ByLayer", "Continuous"] {
            row(out, "LTYPE", own, name);
            out.text(3, "");
            out.integer(72, 65);
            out.integer(73, 0);
            out.real(40, 0.0);
        }
    });
    let all = Layer::ALL.map(|l| (l.name(), l.colour()));
    table(out, "LAYER", 5, |out, own| {
        for (name, colour) in [("0", 7)].into_iter().chain(all) {
            row(out, "LAYER", own, name);
            out.integer(62, colour);
            out.text(6, "Continuous");
        }
    });
    table(out, "STYLE", 1, |out, own| {
        row(out, "STYLE", own, "Standard");
        out.real(40, 0.0);
        out.real(41, 1.0);
        out.real(50, 0.0);
        out.integer(71, 0);
        out.real(42, 1.0);
        out.text(3, "txt");
        out.text(4, "");
    });
    table(out, "VIEW", 0, |_, _| ());
    table(out, "UCS", 0, |_, _| ());
    table(out, "APPID", 1, |out, own| row(out, "APPID", own, "ACAD"));
    table(out, "DIMSTYLE", 1, |out, own| {
        row(out, "DIMSTYLE", own, "Standard")
    });
    block_records(owners, out);
    out.end_section();
}

const SPACES: [&str; 2] = ["*Model_Space", "*Paper_Space"];

fn block_records(owners: &Owners, out: &mut Groups) {
    table(out, "BLOCK_RECORD", 2, |out, own| {
        for (name, handle) in SPACES.into_iter().zip([&owners.model, &owners.paper]) {
            out.text(0, "BLOCK_RECORD");
            out.text(5, handle);
            out.text(330, own);
            out.class("AcDbSymbolTableRecord");
            out.class("AcDbBlockTableRecord");
            out.text(2, name);
        }
    });
}

fn blocks(owners: &Owners, out: &mut Groups) {
    out.section("BLOCKS");
    for (name, owner) in SPACES.into_iter().zip([&owners.model, &owners.paper]) {
        object(out, "BLOCK", owner, "0");
        out.class("AcDbBlockBegin");
        out.text(2, name);
        out.integer(70, 0);
        out.point(10, &nalgebra::Point2::origin(), Some(0.0));
        out.text(3, name);
        out.text(1, "");
        object(out, "ENDBLK", owner, "0");
        out.class("AcDbBlockEnd");
    }
    out.end_section();
}

/// The head of an entity.
fn object(out: &mut Groups, kind: &str, owner: &str, layer: &str) {
    let handle = out.new_handle();
    out.text(0, kind);
    out.text(5, &handle);
    out.text(330, owner);
    out.class("AcDbEntity");
    out.text(8, layer);
}

fn write_entity(entity: &Entity, owners: &Owners, out: &mut Groups) {
    let head = |out: &mut Groups, kind: &str, layer: &Layer, class: &str| {
        object(out, kind, &owners.model, layer.name());
        out.class(class);
    };
    match entity {
        Entity::Polyline {
            layer,
            corners,
            closed,
        } => {
            head(out, "LWPOLYLINE", layer, "AcDbPolyline");
            #[allow(clippy::cast_possible_wrap)] // No list is that long.
            out.integer(90, corners.len() as i64);
            out.integer(70, i64::from(*closed));
            for corner in corners {
                out.point(10, &corner.at, None);
                if corner.bulge != 0.0 {
                    out.real(42, corner.bulge);
                }
            }
        }
        Entity::Line { layer, ends } => {
            head(out, "LINE", layer, "AcDbLine");
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
            head(out, "TEXT", layer, "AcDbText");
            out.point(10, at, Some(0.0));
            out.real(40, *height);
            out.text(1, text);
            out.real(50, *angle_deg);
            out.class("AcDbText");
        }
    }
}

fn objects(owners: &Owners, out: &mut Groups) {
    out.section("OBJECTS");
    for (handle, owner, entry) in [
        (&owners.root, "0", Some(("ACAD_GROUP", &owners.groups))),
        (&owners.groups, owners.root.as_str(), None),
    ] {
        out.text(0, "DICTIONARY");
        out.text(5, handle);
        out.text(330, owner);
        out.class("AcDbDictionary");
        out.integer(281, 1);
        if let Some((name, handle)) = entry {
            out.text(3, name);
            out.text(350, handle);
        }
    }
    out.end_section();
}
