//! Drawings in other units.

use super::*;
use crate::formats::brep::{Wire, WireGroup};
use crate::formats::mesh_out::tests::two_squares;
use crate::formats::mesh_out::{Quantity, QuantityKind};
use crate::formats::offsets::{Cell, Orientation};
use crate::formats::patterns::{Corner, Mark, Pattern};
use crate::formats::plates::{PlateDrawing, ProfileLine, RulingLine};

const MM: LengthUnit = LengthUnit::Millimetre;
const FT: LengthUnit = LengthUnit::Foot;

#[test]
fn the_same_unit_changes_not_a_bit() {
    let mesh = two_squares();
    assert_eq!(in_unit(mesh.clone(), FT, FT), mesh);
}

#[test]
fn meshes_scale_with_what_they_are_coloured_by() {
    let with = |kind| {
        let mut mesh = two_squares();
        mesh.units = FT;
        mesh.quantity = Some(Quantity {
            name: "q".into(),
            kind,
            limit: Some(2.0),
        });
        in_unit(mesh, FT, MM)
    };
    for (kind, factor) in [
        (QuantityKind::Degrees, 1.0),
        (QuantityKind::Length, 304.8),
        (QuantityKind::PerLength, 1.0 / 304.8),
    ] {
        let mesh = with(kind);
        assert_eq!(mesh.units, MM);
        assert_eq!(mesh.vertices[1].x, 304.8);
        assert_eq!(mesh.lines[0].lines[0][1].y, 304.8);
        let limit = mesh.quantity.unwrap().limit.unwrap();
        assert!((limit - 2.0 * factor).abs() < 1e-12);
        assert!((mesh.parts[0].values[2] - 1.5 * factor).abs() < 1e-12);
    }
}

#[test]
fn rulings_keep_their_twist_and_scale_their_radii() {
    let hull = HullDrawing {
        title: "t".into(),
        units: "ft".into(),
        twist_limit_deg: 6.0,
        plates: vec![PlateDrawing {
            name: "p".into(),
            rulings: vec![RulingLine {
                u: 0.5,
                from: Point3::new(1.0, 2.0, 3.0),
                to: Point3::origin(),
                twist_deg: 4.0,
                bend_radius_from: f64::INFINITY,
                bend_radius_to: -2.0,
            }],
            rolls: Vec::new(),
            within_limits: true,
        }],
        profiles: vec![ProfileLine {
            name: "l".into(),
            points: vec![Point3::new(0.0, 0.0, 1.0)],
        }],
        verdict: "within_limits".into(),
        summary: Vec::new(),
    };
    let hull = in_unit(hull, FT, LengthUnit::Inch);
    let ruling = hull.plates[0].rulings[0];
    assert_eq!(hull.units, "in");
    assert_eq!(ruling.from, Point3::new(12.0, 24.0, 36.0));
    assert_eq!((ruling.u, ruling.twist_deg), (0.5, 4.0));
    assert_eq!(ruling.bend_radius_from, f64::INFINITY);
    assert_eq!(ruling.bend_radius_to, -24.0);
    assert_eq!(hull.profiles[0].points[0].z, 12.0);
}

#[test]
fn tables_patterns_and_models_name_their_new_unit() {
    let line = |x: f64| BSplineCurve::line(Point3::origin(), Point3::new(x, 0.0, 0.0), 1).unwrap();
    let table = OffsetsDrawing {
        title: "t".into(),
        units: "ft".into(),
        orientation: Orientation::WaterlinesAcross,
        stations: vec![1.0],
        waterlines: vec![2.0],
        names: [None, None],
        cells: vec![vec![Cell {
            old: Some(3.0),
            new: None,
            ..Cell::default()
        }]],
        station_curves: vec![(1.0, line(1.0))],
        waterline_curves: Vec::new(),
        buttock_curves: Vec::new(),
        verdict: "within_limits".into(),
        summary: Vec::new(),
    };
    let table = in_unit(table, FT, MM);
    assert_eq!((table.units.as_str(), table.stations[0]), ("mm", 304.8));
    assert_eq!(table.cells[0][0].old, Some(3.0 * 304.8));
    assert_eq!(table.station_curves[0].0, 304.8);
    assert_eq!(table.station_curves[0].1.end().x, 304.8);

    let sheet = PatternSheet {
        title: "t".into(),
        unit_name: "ft".into(),
        units: FT,
        patterns: vec![Pattern {
            name: "p".into(),
            kind: "k".into(),
            outline: vec![Point2::new(1.0, 0.0)],
            rulings: vec![[Point2::origin(), Point2::new(0.0, 1.0)]],
            labels: vec![(Point2::new(2.0, 0.0), "A".into())],
            cut: vec![Corner {
                at: Point2::new(0.0, 3.0),
                bulge: 0.5,
            }],
            marks: vec![Mark {
                name: "x = 1 ft".into(),
                line: vec![Point2::new(4.0, 0.0)],
            }],
            ..Pattern::default()
        }],
        none: "",
        verdict: "within_limits".into(),
        summary: Vec::new(),
    };
    let sheet = in_unit(sheet, FT, MM);
    assert_eq!((sheet.units, sheet.unit_name.as_str()), (MM, "mm"));
    assert_eq!(sheet.patterns[0].outline[0].x, 304.8);
    assert_eq!(sheet.patterns[0].rulings[0][1].y, 304.8);
    assert_eq!(sheet.patterns[0].labels[0].0.x, 609.6);
    let corner = sheet.patterns[0].cut[0];
    assert!((corner.at.y - 914.4).abs() < 1e-9 && corner.bulge == 0.5);
    assert_eq!(sheet.patterns[0].marks[0].line[0].x, 1219.2);

    let model = SheetModel {
        title: "t".into(),
        description: String::new(),
        units: FT,
        sheets: Vec::new(),
        wires: vec![WireGroup {
            name: "g".into(),
            wires: vec![Wire {
                name: "w".into(),
                path: Path::Spline(line(1.0)),
            }],
        }],
    };
    let model = in_unit(model, FT, MM);
    assert_eq!(model.units, MM);
    assert!(matches!(&model.wires[0].wires[0].path, Path::Spline(c) if c.end().x == 304.8));
}
