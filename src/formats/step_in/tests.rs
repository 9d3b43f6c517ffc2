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
#33=ORIENTED_EDGE('',*,*,#32,.T.);#36=VERTEX_POINT('',#15);#37=VERTEX_POINT('',#16);\r
#34=EDGE_LOOP('',(#33,#39));#38=EDGE_CURVE('',#36,#37,$,.T.);#39=ORIENTED_EDGE('',*,*,#38,.T.);\r
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
    // One that lies on a side, where the surface has its corner elsewhere.
    let short = FOREIGN.replace("#31=VERTEX_POINT('',#12)", "#31=VERTEX_POINT('',#17)");
    let short = short.replace(
        "#30=VERTEX",
        "#17=CARTESIAN_POINT('',(1.,0.,1.5));\r\n#30=VERTEX",
    );
    assert!(read(short.as_bytes()).expect("a reading").surfaces[0].is_trimmed);
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
            outline: None,
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

/// A closed cubic tube, its knots going on beyond its domain: a ring of six
/// rows of poles, the first three again, rational if asked.
fn tube(weighted: bool) -> (String, impl Fn(usize, usize) -> (Point3<f64>, f64)) {
    let pole = move |i: usize, j: usize| {
        let turn = std::f64::consts::FRAC_PI_3 * (i % 6) as f64;
        let weight = if weighted {
            1.0 + 0.1 * (i % 6) as f64
        } else {
            1.0
        };
        let radius = 1.0 + 0.25 * (i % 6) as f64;
        let place = Point3::new(radius * turn.cos(), radius * turn.sin(), j as f64);
        (place, weight)
    };
    let mut text = FOREIGN.split("#11=").next().unwrap_or_default().to_owned();
    let (mut rows, mut weights) = (Vec::new(), Vec::new());
    for i in 0..9 {
        let (mut row, mut line) = (Vec::new(), Vec::new());
        for j in 0..2 {
            let (p, w) = pole(i, j);
            let number = 100 + 2 * i + j;
            text += &format!(
                "#{number}=CARTESIAN_POINT('',({:?},{:?},{:?}));\n",
                p.x, p.y, p.z
            );
            row.push(format!("#{number}"));
            line.push(format!("{w:?}"));
        }
        rows.push(format!("({})", row.join(",")));
        weights.push(format!("({})", line.join(",")));
    }
    let ones = ["1"; 13].join(",");
    let knots: Vec<String> = (0..13).map(|k| format!("{k}.")).collect();
    let (rows, weights, knots) = (rows.join(","), weights.join(","), knots.join(","));
    let rational = match weighted {
        true => format!("RATIONAL_B_SPLINE_SURFACE(({weights}))"),
        false => String::new(),
    };
    text += &format!(
        "#20=(BOUNDED_SURFACE()B_SPLINE_SURFACE(3,1,({rows}),.UNSPECIFIED.,.T.,.F.,.U.)\
         B_SPLINE_SURFACE_WITH_KNOTS(({ones}),(2,2),({knots}),(0.,1.),.UNSPECIFIED.)\
         GEOMETRIC_REPRESENTATION_ITEM(){rational}REPRESENTATION_ITEM('tube')SURFACE());\n\
         ENDSEC;\nEND-ISO-10303-21;\n"
    );
    (text, pole)
}

#[test]
fn knots_that_go_on_are_clamped() {
    for weighted in [false, true] {
        let (text, pole) = tube(weighted);
        let read = read(text.as_bytes()).expect("a reading");
        let surface = &read.surfaces[0].surface;
        assert_eq!(surface.domain(Axis::U), [3.0, 9.0]);
        assert_eq!(surface.weights().is_some(), weighted);
        for k in 0..=6 {
            // At a knot of a uniform cubic the basis is 1/6, 4/6, 1/6.
            let three = [(k, 1.0), (k + 1, 4.0), (k + 2, 1.0)];
            let (mut sum, mut total) = (nalgebra::Vector3::zeros(), 0.0);
            for (i, share) in three {
                let (p, w) = pole(i, 1);
                sum += share * w * p.coords;
                total += share * w;
            }
            let here = surface.point(3.0 + k as f64, 1.0);
            assert!((here.coords - sum / total).norm() < 1e-14, "{weighted} {k}");
        }
        let seam = [3.0, 9.0].map(|u| surface.derivatives_left(u, 0.5));
        assert!((seam[0].point - seam[1].point).norm() < 1e-14);
        assert!((seam[0].du - seam[1].du).norm() < 1e-13);
        assert!((seam[0].duu - seam[1].duu).norm() < 1e-12);
    }
}
