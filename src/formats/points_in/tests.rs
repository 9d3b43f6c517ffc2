//! Files as yards write them, and every way to be wrong.

use super::*;

fn points(text: &str) -> (PointList, HowRead) {
    match read(text.as_bytes(), Expected::Points) {
        Ok(Reading {
            contents: Contents::Points(list),
            how,
        }) => (list, how),
        other => panic!("{text:?}: {other:?}"),
    }
}

fn offsets(text: &str, orientation: Orientation) -> (OffsetTable, HowRead) {
    match read(text.as_bytes(), Expected::Offsets(orientation)) {
        Ok(Reading {
            contents: Contents::Offsets(table),
            how,
        }) => (table, how),
        other => panic!("{text:?}: {other:?}"),
    }
}

fn fault(text: &str, expected: Expected) -> ReadError {
    match read(text.as_bytes(), expected) {
        Err(error) => {
            assert!(!error.hint().is_empty() && error.sentence().ends_with('.'));
            error
        }
        Ok(reading) => panic!("{text:?} was read: {reading:?}"),
    }
}

fn xy(rows: &[[f64; 2]]) -> Vec<[Option<f64>; 3]> {
    rows.iter()
        .map(|[x, y]| [Some(*x), Some(*y), None])
        .collect()
}

const ACROSS: Expected = Expected::Offsets(Orientation::WaterlinesAcross);

#[test]
fn every_separator_with_every_mark() {
    let expected = xy(&[[1.5, -2.0], [3.25, 4e3]]);
    for (text, separator, mark) in [
        ("1.5,-2\n3.25,4e3\n", Separator::Comma, DecimalMark::Point),
        (
            "1.5, -2.0\r\n3.25, 4.0E+3\r\n",
            Separator::Comma,
            DecimalMark::Point,
        ),
        (
            "1,5;-2,0\n3,25;4e3",
            Separator::Semicolon,
            DecimalMark::Comma,
        ),
        (
            "1.5;-2;\n3.25;4000;\n",
            Separator::Semicolon,
            DecimalMark::Point,
        ),
        ("1,5\t-2\n3,25\t4e3\n", Separator::Tab, DecimalMark::Comma),
        (
            "  1.5   -2.0\n 3.25  +4000\n",
            Separator::Blanks,
            DecimalMark::Point,
        ),
        (
            "1,5 -2,0\n3,25 4e3\n",
            Separator::Blanks,
            DecimalMark::Comma,
        ),
        (
            "1.5 \t-2.0\n3.25\t 4000\n",
            Separator::Tab,
            DecimalMark::Point,
        ),
        (
            "\"1,5\",\"-2,0\"\n\"3,25\",\"4e3\"\n",
            Separator::Comma,
            DecimalMark::Comma,
        ),
        (
            "sep=;\r\n1,5;\u{2212}2\r\n3,25;4e3\r\n",
            Separator::Semicolon,
            DecimalMark::Comma,
        ),
        (
            "\u{feff}1.5 -2\r3.25 4e3\r",
            Separator::Blanks,
            DecimalMark::Point,
        ),
    ] {
        let (list, how) = points(text);
        assert_eq!(list.rows, expected, "{text:?}");
        assert_eq!(
            (how.separator, how.decimal_mark),
            (separator, Some(mark)),
            "{text:?}"
        );
    }
}

#[test]
fn a_spreadsheet_with_names_units_comments_and_remarks() {
    let text = "\u{feff}# lifted 12.03.1998\r\nFrame list of hull 42;;;;\r\n\
        No.;Height [mm];Half-breadth [mm];Station [mm];Remark\r\n\
        \r\n1;500;1250,5;0;\r\n2;1000;;0;\"knuckle; port\"\r\n;;;;\r\n// end\r\n";
    let (list, how) = points(text);
    assert_eq!(list.coordinates, BY_AXIS);
    assert_eq!(
        list.rows,
        [
            [Some(0.0), Some(1250.5), Some(500.0)],
            [Some(0.0), None, Some(1000.0)]
        ]
    );
    assert_eq!(list.lines, [5, 6]);
    assert_eq!(how.header_line, Some(3));
    assert_eq!(how.unit.as_deref(), Some("mm"));
    assert_eq!(
        (
            how.skipped.comments,
            how.skipped.empty,
            how.skipped.text.len()
        ),
        (2, 2, 1)
    );
    let told = how.sentence();
    for part in [
        "Read 2 points from columns 4 (“Station [mm]” as x), 3 (“Half-breadth [mm]” as y)",
        "separated by semicolon, decimal comma, names in line 3.",
        "2 comment lines, 2 empty lines, 1 line of text, 1 missing value",
        "Columns not used: 1 (“No.”), 5 (“Remark”).",
    ] {
        assert!(told.contains(part), "no {part:?} in {told:?}");
    }
}

const BY_AXIS: [Coordinate; 3] = [Coordinate::X, Coordinate::Y, Coordinate::Z];

#[test]
fn names_choose_and_order_columns() {
    let (list, _) = points("z,x\n3,1\n4,2\n");
    assert_eq!(list.coordinates, [Coordinate::X, Coordinate::Z]);
    assert_eq!(list.rows, xy(&[[1.0, 3.0], [2.0, 4.0]]));
    let (list, how) = points("x;y\n[m];[m]\n1;2\n");
    assert_eq!((list.rows.len(), how.unit.as_deref()), (1, Some("m")));
    let (list, how) = points("Länge;Breite\n1;2\n");
    assert_eq!(list.coordinates, [Coordinate::X, Coordinate::Y]);
    assert!(how.sentence().contains("not halved"));
    let (list, how) = points("a b c d\n1 2 3 4\n");
    assert_eq!(list.rows, [[Some(1.0), Some(2.0), Some(3.0)]]);
    assert!(how.sentence().contains("not known") && how.sentence().contains("not used: 4"));
}

#[test]
fn marks_of_missing_values() {
    let (list, how) = points("1;n/a\n-;2\nNaN;–\n-0;\n");
    assert_eq!(
        list.rows,
        [
            [Some(1.0), None, None],
            [None, Some(2.0), None],
            [None; 3],
            [Some(-0.0), None, None]
        ]
    );
    assert_eq!(how.missing, 5);
    assert!(list.rows[3][0].is_some_and(f64::is_sign_negative));
}

#[test]
fn commas_before_three_digits_are_told() {
    let (list, how) = points("1,250;2,500\n3,125;4,000\n");
    assert_eq!(list.rows, xy(&[[1.25, 2.5], [3.125, 4.0]]));
    assert!(how.sentence().contains("not between thousands"));
    assert!(points("0,250;2,500\n").1.notes.is_empty());
}

#[test]
fn a_table_either_way_round() {
    let text = "Offsets (m);;;\nSt \\ WL;0;0,5;1,0\n0;-;0,2;0,4\n1;0,1;;0,9\n2;n/a;0,8;1,1;\n";
    let (table, how) = offsets(text, Orientation::WaterlinesAcross);
    assert_eq!(table.stations, [0.0, 1.0, 2.0]);
    assert_eq!(table.waterlines, [0.0, 0.5, 1.0]);
    assert_eq!(table.half_breadths[1], [Some(0.1), None, Some(0.9)]);
    assert_eq!((how.missing, how.unit.as_deref()), (3, Some("m")));
    assert!(
        how.sentence()
            .starts_with("Read 3 stations × 3 waterlines, one station a row;")
    );
    let (turned, _) = offsets(text, Orientation::StationsAcross);
    assert_eq!(turned.stations, table.waterlines);
    assert_eq!(turned.half_breadths[2], [Some(0.4), Some(0.9), Some(1.1)]);
    assert_eq!(turned.lines, [3, 4, 5]);
}

#[test]
fn tables_with_other_separators() {
    let expected = [[Some(0.1), None], [Some(0.2), Some(0.3)]];
    for text in [
        "x 0 1.5\n0 0.1 -\n10 0.2 0.3\n",
        ",0,1.5\n0,.1,\n10,0.2,0.3\n",
        "\t0\t1.5\n0\t0.1\t\n10\t0.2\t0.3\n",
        "% a\nHeights\t0\t1.5\n[m]\t\t\n0\t0.1\tNaN\n10\t0.2\t0.3\n",
        "Name;WL1;WL2\nHeight;0;1,5\n0;0,1;\n10;0,2;0,3\n",
    ] {
        let (table, _) = offsets(text, Orientation::WaterlinesAcross);
        assert_eq!(table.half_breadths, expected, "{text:?}");
        assert_eq!(table.waterlines, [0.0, 1.5], "{text:?}");
    }
}

#[test]
fn errors_of_cells_name_line_and_column() {
    for (text, line, column, expected) in [
        ("x;y\n1;2\n3;abc\n", 3, 2, Fault::NotANumber),
        ("1;2\n3;1/2\n", 2, 2, Fault::Fraction),
        ("1;2\n3 1/2;2\n", 2, 1, Fault::Fraction),
        ("1;2\n10-3-6;2\n", 2, 1, Fault::Fraction),
        ("1;2\n1½;2\n", 2, 1, Fault::Fraction),
        ("1;2\n1.234,5;2\n", 2, 1, Fault::Thousands),
        ("1;2\n1 234;2\n", 2, 1, Fault::Thousands),
        ("1;2\n1'234.5;2\n", 2, 1, Fault::Thousands),
        ("1;2\n2;1,234,567\n", 2, 2, Fault::Thousands),
        ("1;2\n1.5 m;2\n", 2, 1, Fault::UnitInCell),
        ("1;2\n1e999;2\n", 2, 1, Fault::NotFinite),
        ("1;2\n-inf;2\n", 2, 1, Fault::NotFinite),
        (
            "1.5;2\n1,5;2\n",
            2,
            1,
            Fault::MixedDecimalMarks { other_line: 1 },
        ),
        ("1,5;2\n3;4;5\n", 2, 3, Fault::LongRow { expected: 2 }),
        ("1.5,2\n1,5,2,7\n", 2, 3, Fault::LongRow { expected: 2 }),
        ("x;y;x\n1;2;3\n", 1, 3, Fault::RepeatedName),
        ("x [mm];y [m]\n1;2\n", 1, 2, Fault::MixedUnits),
        ("1,2\n\"3,4\n", 2, 1, Fault::OpenQuote),
        ("1,2\n3,\"4\"5\n", 2, 2, Fault::OpenQuote),
        ("1 2\n0x10 2\n", 2, 1, Fault::NotANumber),
    ] {
        let error = fault(text, Expected::Points);
        assert_eq!(
            (error.line, error.column, error.fault),
            (line, Some(column), expected),
            "{text:?}"
        );
    }
}

#[test]
fn errors_of_lines() {
    for (text, line, expected) in [
        ("", 1, Fault::NoNumbers),
        ("# only\n\nx;y\n", 3, Fault::NoNumbers),
        ("1\n2\n", 1, Fault::OneColumn),
        ("1;2;3\n4;5\n", 2, Fault::ShortRow { expected: 3 }),
        ("1,5, 2,5\n", 1, Fault::AmbiguousComma),
        ("# a\r\n1,5,2,5\r\n3,5,4,5\r\n", 2, Fault::AmbiguousComma),
    ] {
        let error = fault(text, Expected::Points);
        assert_eq!(
            (error.line, error.column, error.fault),
            (line, None, expected),
            "{text:?}"
        );
    }
}

#[test]
fn errors_of_tables() {
    for (text, line, expected) in [
        (
            "St;WL1;WL2\n0;0,1;0,2\n1;0,3;0,4\n",
            2,
            Fault::NamesWithoutPlaces,
        ),
        ("St;0;WL2\n0;0,1;0,2\n", 1, Fault::NotANumber),
        ("St;0;;1\n0;1;2;3\n", 1, Fault::MissingPlace),
        ("St;0;1\n-;1;2\n1;2;3\n", 2, Fault::MissingPlace),
        ("St;0;1;0\n0;1;2;3\n", 1, Fault::RepeatedPlace),
        ("St;0;1\n0;1;2\n0;1;2\n", 3, Fault::RepeatedPlace),
        ("St;0;1\n0;1;2\n", 2, Fault::TooSmallTable),
        ("St;0\n0;1\n1;2\n", 1, Fault::TooSmallTable),
        ("St;0;1\n0;1\n1;2;3\n", 2, Fault::ShortRow { expected: 3 }),
        ("St;0;1\n0;1;2;3\n", 2, Fault::LongRow { expected: 3 }),
        ("St;0;1\nAP;1;2\n", 2, Fault::NotANumber),
        ("a;b\n", 1, Fault::NoNumbers),
    ] {
        let error = fault(text, ACROSS);
        assert_eq!((error.line, error.fault), (line, expected), "{text:?}");
    }
}

/// A table as `read_table` has it: stations, waterlines, the first and the
/// last cell of the first station.
fn named(text: &str, orientation: Orientation, places: &Places) -> OffsetTable {
    match read_table(text.as_bytes(), orientation, places).map(|r| r.contents) {
        Ok(Contents::Offsets(table)) => table,
        other => panic!("{text:?}: {other:?}"),
    }
}

#[test]
fn tables_as_yards_write_them() {
    let across = Orientation::WaterlinesAcross;
    let spaced = Places {
        stations: Ruler::Spaced(2.5),
        waterlines: Ruler::Spaced(0.5),
    };
    let stations = Places {
        stations: Ruler::Listed(vec![-1.2, 0.0, 5.0, 10.0]),
        waterlines: Ruler::Written,
    };
    // Stations, waterlines, half-breadths of the first station.
    let written = Places::default();
    for (text, orientation, places, x, z, first) in [
        // Decimal commas, semicolons, units in the corner, "-" and empty cells.
        (
            "Aufmaße MS Anna (m);;;\nSpt [m];0,0;0,5;1,0\n0,00;-;0,25;0,5\n2,50;0,1;;0,9\n",
            across,
            &written,
            vec![0.0, 2.5],
            vec![0.0, 0.5, 1.0],
            vec![None, Some(0.25), Some(0.5)],
        ),
        // Tabs, a comment, names above the heights.
        (
            "# lofted 1998\nWL\tBL\tWL1\tWL2\nz (m)\t0\t0.5\t1.5\n0\t0\t1\t2\n4\t0.5\t1.5\t2.5\n",
            across,
            &written,
            vec![0.0, 4.0],
            vec![0.0, 0.5, 1.5],
            vec![Some(0.0), Some(1.0), Some(2.0)],
        ),
        // Names and places side by side, both ways.
        (
            "Station,x,WL 0,WL 1\nz,,0,0.6\nTr,-0.5,0.1,0.2\nAP,0,0.3,0.4\n½,1.25,0.5,0.6\n",
            across,
            &written,
            vec![-0.5, 0.0, 1.25],
            vec![0.0, 0.6],
            vec![Some(0.1), Some(0.2)],
        ),
        // Station numbers with fractions and perpendiculars, a spacing.
        (
            "St.;WL 1;WL 2;WL 3\nAP;;0,1;0,2\n1/2;0,1;0,2;0,3\n1;0,2;0,3;0,4\n9 1/2;0,1;0,2;0,3\nFP;-;-;0,1\n",
            across,
            &spaced,
            vec![0.0, 1.25, 2.5, 23.75, 25.0],
            vec![0.5, 1.0, 1.5],
            vec![None, Some(0.1), Some(0.2)],
        ),
        // Stations along the first row, forward perpendicular first.
        (
            "WL,FP,1,2,3,AP\n2,0.1,0.2,0.3,0.2,0.1\n1,0,0.1,0.2,0.1,0\n",
            Orientation::StationsAcross,
            &spaced,
            vec![0.0, 2.5, 5.0, 7.5, 10.0],
            vec![1.0, 0.5],
            vec![Some(0.1), Some(0.0)],
        ),
        // A list of places for names that mean nothing to us.
        (
            "Frame;0;1\nTransom;1;2\nAP;1;2\nMidship;3;4\nStem;0;1\n",
            across,
            &stations,
            vec![-1.2, 0.0, 5.0, 10.0],
            vec![0.0, 1.0],
            vec![Some(1.0), Some(2.0)],
        ),
        // Blanks, a row of units below the heights.
        (
            "Stn   0.0  0.5  1.0\n(-)   (m)  (m)  (m)\n0 0.1 0.2 0.3\n\n1 0.2 0.3 0.4\n",
            across,
            &written,
            vec![0.0, 1.0],
            vec![0.0, 0.5, 1.0],
            vec![Some(0.1), Some(0.2), Some(0.3)],
        ),
        // Quoted decimal commas between commas; a byte order mark.
        (
            "\u{feff}st,\"0,5\",\"1,0\"\r\n0,\"1,25\",\"1,5\"\r\n1,\"1,75\",\"2,5\"\r\n",
            across,
            &written,
            vec![0.0, 1.0],
            vec![0.5, 1.0],
            vec![Some(1.25), Some(1.5)],
        ),
    ] {
        let table = named(text, orientation, places);
        assert_eq!(table.stations, x, "{text:?}");
        assert_eq!(table.waterlines, z, "{text:?}");
        assert_eq!(table.half_breadths[0], first, "{text:?}");
    }
    let text = "Station,x,WL 0,WL 1\nz,,0,0.6\nTr,-0.5,0.1,0.2\nAP,0,0.3,0.4\n";
    let table = named(text, across, &written);
    let names = |n: &[&str]| Some(n.iter().map(|s| (*s).to_owned()).collect::<Vec<_>>());
    assert_eq!(table.station_names, names(&["Tr", "AP"]));
    assert_eq!(table.waterline_names, names(&["WL 0", "WL 1"]));
    let plain = named("st;0;1\n0;1;2\n1;1;2\n", across, &written);
    assert_eq!((plain.station_names, plain.waterline_names), (None, None));
}

#[test]
fn names_that_cannot_be_placed_are_told() {
    let spaced = Places {
        stations: Ruler::Spaced(2.5),
        waterlines: Ruler::Written,
    };
    let listed = Places {
        stations: Ruler::Listed(vec![0.0, 1.0]),
        waterlines: Ruler::Written,
    };
    for (text, places, line, expected) in [
        (
            "st;0;1\nTr;1;2\n1;1;2\n2;1;2\n",
            &spaced,
            2,
            Fault::NameWithoutPlace,
        ),
        (
            "st;0;1\n1;1;2\nAP;1;2\n2;1;2\n",
            &spaced,
            3,
            Fault::NameWithoutPlace,
        ),
        (
            "st;0;1\n1;1;2\n2/2;1;2\n2;1;2\n",
            &spaced,
            3,
            Fault::RepeatedPlace,
        ),
        (
            "st;0;1\nTr;1;2\n1;1;2\n2;1;2\n",
            &listed,
            2,
            Fault::PlaceCount {
                given: 2,
                needed: 3,
            },
        ),
    ] {
        let error = read_table(text.as_bytes(), Orientation::WaterlinesAcross, places);
        let error = error.expect_err("no place");
        assert_eq!((error.line, error.fault), (line, expected), "{text:?}");
    }
}

#[test]
fn other_encodings_are_refused() {
    let error = read(b"x;y\nL\xe4nge;2\n", Expected::Points).expect_err("Latin-1");
    assert_eq!((error.line, error.fault), (2, Fault::NotUtf8 { offset: 5 }));
    assert!(error.sentence().contains("byte 0xE4"));
    let error = read(b"\xff\xfe1\0;\0", Expected::Points).expect_err("UTF-16");
    assert_eq!(error.fault, Fault::Utf16);
}

#[test]
fn errors_quote_briefly_and_speak() {
    let long = format!("1;2\n{};2\n", "x".repeat(5000));
    let error = fault(&long, Expected::Points);
    assert!(error.found.chars().count() <= 41 && error.found.ends_with('…'));
    assert_eq!(
        fault("1;2\n3;1/2\n", Expected::Points).to_string(),
        "Line 2, column 2: fractions are not read: “1/2”."
    );
}

#[test]
fn a_line_without_end_is_refused() {
    let expected = Fault::LongRow {
        expected: cells::MOST_CELLS,
    };
    for piece in ["1;", "1 ", "\"1\","] {
        let error = fault(&piece.repeat(cells::MOST_CELLS + 5), ACROSS);
        assert_eq!((error.line, error.fault), (1, expected));
    }
}

#[test]
fn any_bytes_are_read_or_refused() {
    // Every text of length 5 over an alphabet of trouble.
    let alphabet: Vec<&str> = vec![
        "1", ",", ";", "\t", " ", "\"", "\n", "-", ".", "x", "½", "/",
    ];
    let n = alphabet.len();
    for code in 0..n.pow(5) {
        let mut rest = code;
        let text: String = (0..5)
            .map(|_| {
                let letter = alphabet[rest % n];
                rest /= n;
                letter
            })
            .collect();
        for expected in [Expected::Points, ACROSS] {
            if let Err(error) = read(text.as_bytes(), expected) {
                assert!(error.line >= 1 && error.line <= 6, "{text:?}: {error}");
            }
        }
    }
}
