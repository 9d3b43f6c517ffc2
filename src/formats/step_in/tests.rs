use super::*;
use crate::geometry::Axis;
use nalgebra::Point3;

/// A file as another system might write it: comments, lines broken anywhere,
/// small letters, a rational surface as a complex entity, inches.
const FOREIGN: &str = "ISO-10303-21;\r
HEADER;\r
FILE_DESCRIPTION(('a;b','it''s'),'2;1');\r
FILE_NAME('x','',(''),(''),'','','');\r
FILE_SCHEMA(('AP242'));\r
ENDSEC;\r
DATA;\r
/* units */\r
#1=( LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.) );\r
#2=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),#1);\r
#3=(CONVERSION_BASED_UNIT('INCH',#2)LENGTH_UNIT()NAMED_UNIT(#4));\r
#4=DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.);\r
#5=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));\r
#6=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT((#5,#3))\r
REPRESENTATION_CONTEXT('',''));\r
#11=CARTESIAN_POINT('',(1.,0.,0.)); #12=CARTESIAN_POINT('',(1.,0.,\r
2.));\r
#13=CARTESIAN_POINT('',(1.,1.,0.));#14=CARTESIAN_POINT('',(1.,1.,2.));\r
#15=CARTESIAN_POINT('',(0.,1.E0,0.));#16=CARTESIAN_POINT('',(-0.,1.,+2.));\r
#20=(bounded_surface()B_SPLINE_SURFACE(2,1,((#11,#12),(#13,#14),(#15,#16)),.CYLINDRICAL_SURF.,\r
.F.,.F.,.U.)B_SPLINE_SURFACE_WITH_KNOTS((3,3),(2,2),(0.,1.),(0.,1.),.UNSPECIFIED.)\r
GEOMETRIC_REPRESENTATION_ITEM()RATIONAL_B_SPLINE_SURFACE(((1.,1.),(0.707106781186547524,\r
0.707106781186547524),(1.,1.)))REPRESENTATION_ITEM('k\\X\\F6rper \\X2\\2013\\X0\\ A')SURFACE());\r
#30=VERTEX_POINT('',#11);\r
#31=VERTEX_POINT('',#12);\r
#32=EDGE_CURVE('',#30,#31,$,.T.);\r
#33=ORIENTED_EDGE('',*,*,#32,.T.);\r
#34=EDGE_LOOP('',(#33));\r
#35=FACE_OUTER_BOUND('',#34,.T.);\r
#40=ADVANCED_FACE('',(#35),#20,.T.);\r
#41=PLANE('',$);\r
#42=ADVANCED_FACE('flat',(#35),#41,.T.);\r
ENDSEC;\r
END-ISO-10303-21;\r
";

#[test]
fn a_foreign_file_is_read() {
    let read = read(FOREIGN.as_bytes()).expect("a reading");
    assert!((read.metres - 0.0254).abs() < 1e-15);
    assert_eq!(read.left_out, [("PLANE".to_owned(), 1)]);
    assert!(!read.is_assembly);
    let [face] = &read.surfaces[..] else {
        panic!("{:?}", read.surfaces)
    };
    assert_eq!(face.name.as_deref(), Some("körper – A"));
    assert!(!face.is_trimmed);
    // A quarter of a cylinder of radius 1.
    let jet = face.surface.derivatives_left(0.5, 0.5);
    assert!((jet.point.x.hypot(jet.point.y) - 1.0).abs() < 1e-15);
    assert_eq!(face.surface.domain(Axis::U), [0.0, 1.0]);
}

#[test]
fn a_corner_within_the_surface_trims_it() {
    let inside = FOREIGN.replace("#31=VERTEX_POINT('',#12)", "#31=VERTEX_POINT('',#17)");
    let inside = inside.replace(
        "#30=VERTEX",
        "#17=CARTESIAN_POINT('',(0.7071067811865475,0.7071067811865475,1.));\r\n#30=VERTEX",
    );
    assert!(read(inside.as_bytes()).expect("a reading").surfaces[0].is_trimmed);
}

#[test]
fn our_own_files_come_back_to_the_bit() {
    use crate::formats::brep::{Sheet, SheetModel};
    use crate::formats::length_unit::LengthUnit;
    let knots = vec![0.0, 0.0, 0.0, 0.3, 1.0, 1.0, 1.0];
    let points = (0..8).map(|k| {
        let (i, j) = ((k / 2) as f64, (k % 2) as f64);
        Point3::new(i / 3.0, j * 1e-7 + 2.0, i * i * 0.1 - j)
    });
    let weights = (0..8).map(|k| 1.0 + 0.1 * k as f64).collect();
    let surface = BSplineSurface::new(
        [2, 1],
        [knots, vec![0.0, 0.0, 2.0, 2.0]],
        points.collect(),
        Some(weights),
    )
    .expect("a surface");
    let model = SheetModel {
        title: "a hull".into(),
        description: String::new(),
        units: LengthUnit::Foot,
        sheets: vec![Sheet {
            name: "deck – 1".into(),
            surface: surface.clone(),
        }],
        wires: Vec::new(),
    };
    let read = read(crate::formats::step::write(&model).as_bytes()).expect("a reading");
    assert!((read.metres - 0.3048).abs() < 1e-15);
    assert_eq!(read.surfaces.len(), 1);
    assert_eq!(read.surfaces[0].name.as_deref(), Some("deck – 1"));
    assert!(!read.surfaces[0].is_trimmed);
    assert_eq!(read.surfaces[0].surface, surface);
}

/// The line and fault of a file that is changed in one place.
fn fault(from: &str, to: &str) -> (usize, StepFault) {
    assert!(FOREIGN.contains(from), "{from}");
    let error = read(FOREIGN.replacen(from, to, 1).as_bytes()).expect_err("refused");
    assert!(!error.hint().is_empty() && error.to_string().starts_with("line "));
    (error.line, error.fault)
}

#[test]
fn faults_are_told_with_their_lines() {
    assert_eq!(fault("ISO-10303-21;", "solid x"), (1, StepFault::NotStep));
    assert_eq!(fault("#13=CART", "#12=CART"), (18, StepFault::Twice(12)));
    assert_eq!(
        fault("(#11,#12)", "(#11,#99)"),
        (20, StepFault::Missing(99))
    );
    assert_eq!(
        fault("(#11,#12)", "(#11,#30)"),
        (
            24,
            StepFault::Kind {
                entity: 30,
                wanted: "CARTESIAN_POINT"
            }
        )
    );
    assert!(matches!(
        fault("(3,3),(2,2)", "(3,2),(2,2)"),
        (20, StepFault::Spline(_))
    ));
    assert!(matches!(
        fault("(#13,#14)", "(#13)"),
        (20, StepFault::Parameter { entity: 20, .. })
    ));
    assert_eq!(fault("(#5,#3)", "(#5)"), (1, StepFault::NoUnit));
    assert_eq!(fault("(#5,#3)", "(#1,#3)"), (14, StepFault::TwoUnits));
    assert_eq!(fault("#20,.T.", "#41,.T."), (1, StepFault::NoSurfaces));
    assert_eq!(fault(",#20,.T.)", ",#20,.T."), (30, StepFault::Unexpected));
    let deep = format!("({}{})", "(".repeat(40), ")".repeat(40));
    assert_eq!(fault("(#35),#20", &deep), (30, StepFault::TooDeep));
    // Cut anywhere it is refused, and nothing panics.
    for end in 0..FOREIGN.len() - 20 {
        assert!(read(&FOREIGN.as_bytes()[..end]).is_err(), "{end}");
    }
}
