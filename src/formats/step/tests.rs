use super::super::brep::{Sheet, WireGroup};
use super::super::length_unit::LengthUnit;
use super::*;
use crate::geometry::BSplineSurface;
use nalgebra::Point3;

fn model(units: LengthUnit) -> SheetModel {
    let knots = vec![0.0, 0.0, 1.0, 1.0];
    let points = [[0.0, 0.0], [0.0, 1.0], [2.0, 0.0], [2.0, 1.0]]
        .map(|[x, y]| Point3::new(x, y, 0.0))
        .to_vec();
    let surface = BSplineSurface::new([1, 1], [knots.clone(), knots], points, None).unwrap();
    SheetModel {
        title: "a plate".into(),
        description: "within_limits".into(),
        units,
        sheets: vec![Sheet {
            name: "deck – chine".into(),
            outline: None,
            surface,
        }],
        wires: vec![WireGroup {
            name: "rulings".into(),
            wires: vec![Wire {
                name: "1".into(),
                path: Path::Line([Point3::origin(), Point3::new(0.0, 1.0, 0.0)]),
            }],
        }],
    }
}

/// Every reference is to an entity that stands before it.
#[test]
fn references_look_back() {
    let text = write(&model(LengthUnit::Foot));
    for line in text.lines().filter(|l| l.starts_with('#')) {
        let (id, rest) = line[1..].split_once('=').unwrap();
        let id: usize = id.parse().unwrap();
        for reference in rest.split('#').skip(1) {
            let digits: String = reference.chars().take_while(char::is_ascii_digit).collect();
            assert!(digits.parse::<usize>().unwrap() < id, "{line}");
        }
    }
}

#[test]
fn a_square_has_one_face_of_four_edges() {
    let text = write(&model(LengthUnit::Millimetre));
    let count = |word: &str| text.matches(word).count();
    assert_eq!(count("ADVANCED_FACE('deck \\X2\\2013\\X0\\ chine'"), 1);
    assert_eq!(count("EDGE_CURVE("), 4);
    assert_eq!(count("=VERTEX_POINT("), 4);
    assert_eq!(count("GEOMETRIC_CURVE_SET('rulings'"), 1);
    assert!(text.starts_with("ISO-10303-21;\n"));
    assert!(text.ends_with("ENDSEC;\nEND-ISO-10303-21;\n"));
}

#[test]
fn units_are_said() {
    for (units, word) in [
        (LengthUnit::Millimetre, "SI_UNIT(.MILLI.,.METRE.)"),
        (LengthUnit::Centimetre, "SI_UNIT(.CENTI.,.METRE.)"),
        (LengthUnit::Metre, "SI_UNIT($,.METRE.)"),
        (LengthUnit::Inch, "LENGTH_MEASURE(0.0254)"),
        (LengthUnit::Foot, "LENGTH_MEASURE(0.3048)"),
    ] {
        assert!(write(&model(units)).contains(word), "{units:?}");
    }
}

#[test]
fn an_outline_is_told_in_space_and_in_parameters() {
    let knots = vec![0.0, 0.0, 1.0, 1.0];
    let points = [
        [0.0, 0.0, 0.0],
        [0.0, 1.0, 1.0],
        [2.0, 0.0, 1.0],
        [2.0, 1.0, 0.0],
    ];
    let points = points.map(|[x, y, z]| Point3::new(x, y, z)).to_vec();
    let outline = [[0.0, 0.0], [1.0, 0.1], [1.0, 0.5], [0.5, 0.6], [0.0, 1.0]];
    let model = SheetModel {
        title: "part".into(),
        description: String::new(),
        units: LengthUnit::Metre,
        sheets: vec![Sheet {
            name: "part".into(),
            outline: Some(outline.iter().map(|p| (*p).into()).collect()),
            surface: BSplineSurface::new([1, 1], [knots.clone(), knots], points, None).unwrap(),
        }],
        wires: Vec::new(),
    };
    let text = write(&model);
    let count = |word: &str| text.matches(word).count();
    assert_eq!(count("=ADVANCED_FACE("), 1);
    assert_eq!(count("=EDGE_CURVE("), 4);
    // Two rulings are straight; the two other sides are not.
    assert_eq!((count("=SURFACE_CURVE("), count("=PCURVE(")), (2, 2));
    assert_eq!(count("PARAMETRIC_REPRESENTATION_CONTEXT()"), 1);
    // The surface is read back whole.
    let read = crate::formats::step_in::read(text.as_bytes()).unwrap();
    assert_eq!(read.surfaces[0].surface, model.sheets[0].surface);
    assert!(read.surfaces[0].is_trimmed);
}
