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
