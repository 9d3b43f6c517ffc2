//! Names of columns: which coordinate they mean, and their unit.

use super::Coordinate;
use super::cells::Cell;

/// Names for the three coordinates, small letters and digits only; what ships'
/// tables in English, German, Dutch, French, Spanish and Italian call them.
const NAMES: [(Coordinate, &[&str]); 3] = [
    (
        Coordinate::X,
        &[
            "x",
            "xcoordinate",
            "xcoord",
            "xm",
            "xmm",
            "station",
            "stations",
            "st",
            "stn",
            "sta",
            "abscissa",
            "lengthwise",
            "spant",
            "länge",
            "laenge",
            "couple",
            "longueur",
            "seccion",
            "sección",
            "ordinata",
        ],
    ),
    (
        Coordinate::Y,
        &[
            "y",
            "ycoordinate",
            "ycoord",
            "ym",
            "ymm",
            "halfbreadth",
            "halfbreadths",
            "halfbeam",
            "hb",
            "offset",
            "breadth",
            "beam",
            "halbbreite",
            "breite",
            "halvebreedte",
            "breedte",
            "demilargeur",
            "largeur",
            "semimanga",
            "manga",
            "semilarghezza",
        ],
    ),
    (
        Coordinate::Z,
        &[
            "z",
            "zcoordinate",
            "zcoord",
            "zm",
            "zmm",
            "height",
            "heightabovebaseline",
            "heightaboveproject",
            "hab",
            "waterline",
            "wl",
            "elevation",
            "höhe",
            "hoehe",
            "hoogte",
            "wasserlinie",
            "waterlijn",
            "hauteur",
            "altura",
            "altezza",
        ],
    ),
];

/// Names that mean a whole breadth where half of it is expected.
const WHOLE_BREADTHS: [&str; 5] = ["breadth", "beam", "breite", "largeur", "manga"];

/// Units of length as headers write them, with the short form.
const UNITS: [(&str, &[&str]); 5] = [
    (
        "mm",
        &[
            "mm",
            "millimetre",
            "millimetres",
            "millimeter",
            "millimeters",
        ],
    ),
    (
        "cm",
        &[
            "cm",
            "centimetre",
            "centimetres",
            "centimeter",
            "centimeters",
        ],
    ),
    ("m", &["m", "metre", "metres", "meter", "meters"]),
    ("in", &["in", "inch", "inches", "\""]),
    ("ft", &["ft", "foot", "feet", "'"]),
];

/// One name of a column.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Name {
    /// As written.
    pub text: String,
    /// What it means, if that is known.
    pub coordinate: Option<Coordinate>,
    /// The unit in brackets, in its short form.
    pub unit: Option<&'static str>,
    /// Whether it names a whole breadth.
    pub is_whole_breadth: bool,
}

/// The name in a cell of a header row.
pub(super) fn name(cell: &Cell<'_>) -> Name {
    let text = cell.text.as_ref();
    let (bare, bracket) = split_bracket(text);
    let key: String = bare
        .chars()
        .filter(|c| c.is_alphanumeric())
        .flat_map(char::to_lowercase)
        .collect();
    let known = NAMES
        .iter()
        .find(|(_, names)| names.contains(&key.as_str()));
    Name {
        text: text.to_owned(),
        coordinate: known.map(|(coordinate, _)| *coordinate),
        unit: bracket.and_then(unit),
        is_whole_breadth: WHOLE_BREADTHS.contains(&key.as_str()),
    }
}

/// A unit of length in its short form.
pub(super) fn unit(text: &str) -> Option<&'static str> {
    let bare = text.trim_matches(|c: char| c.is_whitespace() || "[]().".contains(c));
    let is_one = |names: &&[&str]| names.iter().any(|n| bare.eq_ignore_ascii_case(n));
    UNITS
        .iter()
        .find(|(_, names)| is_one(names))
        .map(|(short, _)| *short)
}

/// A name and what stands in brackets behind it.
fn split_bracket(text: &str) -> (&str, Option<&str>) {
    match text.find(['[', '(']) {
        Some(at) => (&text[..at], Some(&text[at..])),
        None => (text, None),
    }
}
