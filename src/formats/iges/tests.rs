use super::super::brep::{Sheet, Wire, WireGroup};
use super::*;

fn model() -> SheetModel {
    let knots = vec![0.0, 0.0, 1.0, 1.0];
    let points = [[0.0, 0.0], [0.0, 1.0], [2.0, 0.0], [2.0, 1.0]]
        .map(|[x, y]| Point3::new(x, y, 0.0))
        .to_vec();
    let surface = BSplineSurface::new([1, 1], [knots.clone(), knots], points, None);
    SheetModel {
        title: "a plate".into(),
        description: "a description that is longer than one line of this old format is, by far"
            .into(),
        units: LengthUnit::Foot,
        sheets: vec![Sheet {
            name: "deck – chine".into(),
            surface: surface.unwrap(),
            outline: None,
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

#[test]
fn every_line_has_80_columns_and_its_number() {
    let text = write(&model());
    let mut last = (' ', 0);
    for line in text.lines() {
        assert_eq!(line.len(), 80, "{line}");
        let letter = line.as_bytes()[72] as char;
        let number: usize = line[73..].trim().parse().unwrap();
        assert_eq!(number, if letter == last.0 { last.1 + 1 } else { 1 });
        last = (letter, number);
    }
    assert_eq!(last, ('T', 1));
}

#[test]
fn a_surface_runs_through_u_first() {
    let fields = surface(&model().sheets[0].surface);
    let points: Vec<Field> = fields[9 + 8 + 4..][..12].to_vec();
    let expected = [0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 1.0, 0.0, 2.0, 1.0, 0.0];
    assert_eq!(points, expected.map(Field::Real));
}

#[test]
fn the_directory_points_to_the_parameters() {
    let text = write(&model());
    let lines: Vec<&str> = text.lines().collect();
    let of = |letter: char| {
        lines
            .iter()
            .filter(move |l| l.as_bytes()[72] as char == letter)
    };
    let parameters: Vec<&&str> = of('P').collect();
    let mut kinds = Vec::new();
    for entry in of('D').collect::<Vec<_>>().chunks(2) {
        let kind = entry[0][..8].trim();
        let first: usize = entry[0][8..16].trim().parse().unwrap();
        assert!(
            parameters[first - 1].starts_with(&format!("{kind},")),
            "{kind}"
        );
        let back = parameters[first - 1][64..72].trim();
        assert_eq!(back, entry[0][73..].trim());
        kinds.push(kind.to_owned());
    }
    assert_eq!(kinds, ["406", "128", "406", "110"]);
}

#[test]
fn a_part_of_a_surface_is_a_trimmed_one() {
    let mut part = model();
    let outline = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.5], [0.0, 1.0]];
    part.sheets[0].outline = Some(outline.iter().map(|p| (*p).into()).collect());
    let text = write(&part);
    let kinds: Vec<&str> = (text.lines())
        .filter(|l| l.as_bytes()[72] == b'P' && l.as_bytes()[0].is_ascii_digit())
        .filter_map(|l| l.split(',').next())
        .collect();
    let count = |kind: &str| kinds.iter().filter(|k| **k == kind).count();
    // Three sides lie on those of the surface, one does not: four curves twice.
    assert_eq!(count("128"), 1);
    assert_eq!(count("126"), 8);
    assert_eq!((count("102"), count("142"), count("144")), (2, 1, 1));
    // Parts are subordinate; the face alone has a name.
    let directory = |kind: &str, status: &str| {
        (text.lines())
            .filter(|l| l.as_bytes()[72] == b'D' && l[..8].trim() == kind)
            .filter(|l| &l[64..72] == status)
            .count()
    };
    assert_eq!(directory("126", "00010500"), 4);
    assert_eq!(directory("126", "00010000"), 4);
    assert_eq!(directory("128", "00010000"), 1);
    assert_eq!(directory("144", "00000000"), 1);
}
