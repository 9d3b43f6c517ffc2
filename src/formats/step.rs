//! STEP (ISO 10303-21, application protocol 214): surfaces as faces of sewn
//! shells, curves beside them.
//!
//! | what | entity |
//! |---|---|
//! | surface | `B_SPLINE_SURFACE_WITH_KNOTS`, rational where it has weights |
//! | edge | `EDGE_CURVE` over a B-spline curve, one for both neighbours |
//! | outline of a part | the same over a `SURFACE_CURVE`, in space and in (u, v) |
//! | shell | `OPEN_SHELL`s of a `SHELL_BASED_SURFACE_MODEL` |
//! | curves | a `GEOMETRIC_CURVE_SET` a group, in a representation of their own |
//! | unit | that of the model; foot and inch as `CONVERSION_BASED_UNIT` |
//!
//! The file holds no time and no host, so that the same model gives the same
//! bytes. Names beyond ASCII are escaped as the standard asks.

mod entities;
mod text;

use super::brep::{Path, SheetModel, Wire, sew};
use entities::Entities;
use text::string;

/// The model as a STEP file.
#[must_use]
pub fn write(model: &SheetModel) -> String {
    let mut file = Entities::default();
    let product = file.product(&model.title, &model.description);
    let sewn = sew(&model.sheets);
    let context = file.context(model.units, sewn.weld);
    let axes = file.axes();
    let mut shape = None;
    if !sewn.faces.is_empty() {
        let shells = file.shells(&sewn);
        let body = file.add(format_args!("SHELL_BASED_SURFACE_MODEL('',{shells})"));
        shape = Some(file.add(format_args!(
            "MANIFOLD_SURFACE_SHAPE_REPRESENTATION({},(#{axes},#{body}),#{context})",
            string(&model.title)
        )));
    }
    if let Some(sets) = curve_sets(&mut file, model) {
        let wires = file.add(format_args!(
            "GEOMETRICALLY_BOUNDED_WIREFRAME_SHAPE_REPRESENTATION('curves',(#{axes},{sets}),#{context})"
        ));
        match shape {
            Some(shape) => {
                file.add(format_args!(
                    "SHAPE_REPRESENTATION_RELATIONSHIP('','',#{shape},#{wires})"
                ));
            }
            None => shape = Some(wires),
        }
    }
    if let Some(shape) = shape {
        file.add(format_args!(
            "SHAPE_DEFINITION_REPRESENTATION(#{product},#{shape})"
        ));
    }
    header(model) + file.text() + "ENDSEC;\nEND-ISO-10303-21;\n"
}

fn header(model: &SheetModel) -> String {
    format!(
        "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION(({}),'2;1');\n\
         FILE_NAME({},'',(''),(''),'mouldloft {}','mouldloft','');\n\
         FILE_SCHEMA(('AUTOMOTIVE_DESIGN {{ 1 0 10303 214 1 1 1 1 }}'));\nENDSEC;\nDATA;\n",
        string(&model.description),
        string(&model.title),
        env!("CARGO_PKG_VERSION"),
    )
}

/// The groups of curves as a list of references, if there are any.
fn curve_sets(file: &mut Entities, model: &SheetModel) -> Option<String> {
    let mut sets = Vec::new();
    for group in model.wires.iter().filter(|g| !g.wires.is_empty()) {
        let curves: Vec<String> = group.wires.iter().map(|w| wire(file, w)).collect();
        let set = file.add(format_args!(
            "GEOMETRIC_CURVE_SET({},({}))",
            string(&group.name),
            curves.join(",")
        ));
        sets.push(format!("#{set}"));
    }
    (!sets.is_empty()).then(|| sets.join(","))
}

fn wire(file: &mut Entities, wire: &Wire) -> String {
    let id = match &wire.path {
        Path::Spline(curve) => file.curve(&wire.name, curve),
        Path::Line(ends) => {
            let [a, b] = ends.map(|p| file.point(&p));
            file.add(format_args!("POLYLINE({},(#{a},#{b}))", string(&wire.name)))
        }
    };
    format!("#{id}")
}

#[cfg(test)]
mod tests;
