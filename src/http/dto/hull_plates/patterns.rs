//! From stored flat patterns to the cutting table, the roll table and words.

use super::flat::{DevelopedWord, FlatPieceResult, FlatRulingResult, PlateFlatResult};
use super::result::{HullPlatesResult, PlateResult};
use crate::formats::patterns::{Corner, Mark, Pattern, PatternSheet};
use crate::formats::plates::RollRow;
use crate::http::dto::job::Units;
use crate::workshop::outline::polygon;
use nalgebra::Point2;

/// Every so many rulings have their number on the pattern.
const NUMBERED: usize = 10;

impl HullPlatesResult {
    /// The flat patterns of all plates.
    #[must_use]
    pub fn pattern_sheet(&self) -> PatternSheet {
        let plates = self.method_specific.plates.iter();
        PatternSheet {
            title: self.title(),
            unit_name: self.units.to_string(),
            units: self.units.into(),
            patterns: (plates.enumerate())
                .flat_map(|(k, plate)| self.patterns(k, plate))
                .collect(),
            none: "There is no flat pattern.",
            verdict: self.verdict.to_string(),
            summary: self.summary.clone(),
        }
    }

    /// One pattern a piece of plate `k`.
    fn patterns(&self, k: usize, plate: &PlateResult) -> Vec<Pattern> {
        let Some(flat) = &plate.flat else {
            return Vec::new();
        };
        let sentence = self.diagnostics.plates.get(k);
        let sentence = sentence.map_or("", |p| p.sentence.as_str());
        let notes = |piece: &FlatPieceResult| {
            let profile = self.curves.get(k + piece.base_profile);
            let profile = profile.map_or("a profile", |c| c.name.as_str());
            let mut notes = vec![verdict(plate, sentence)];
            notes.extend(remarks(flat, piece, self.units, profile));
            notes.extend(extension(plate, self.units));
            notes
        };
        let count = flat.pieces.len();
        (flat.pieces.iter().enumerate())
            .map(|(i, piece)| Pattern {
                name: match count {
                    1 => plate.name.clone(),
                    _ => format!("{}, piece {} of {count}", plate.name, i + 1),
                },
                notes: notes(piece),
                twist_shares: self.twist_shares(plate, piece),
                within_limits: plate.within_limits,
                ..pattern(flat, piece, self.units)
            })
            .collect()
    }

    /// Twist of the rulings of a piece, of the limit.
    fn twist_shares(&self, plate: &PlateResult, piece: &FlatPieceResult) -> Vec<f64> {
        let limit = self.method_specific.options.max_twist_deg;
        let twist = |r: &FlatRulingResult| {
            let ruling = plate.rulings.get(r.ruling);
            ruling.map_or(0.0, |r| r.twist_deg.abs() / limit)
        };
        piece.rulings.iter().map(twist).collect()
    }
}

impl PlateResult {
    /// The rows of the roll table.
    pub(super) fn roll_rows(&self) -> Vec<RollRow> {
        let pieces = self.flat.iter().flat_map(|flat| &flat.pieces);
        let rows = pieces.enumerate().flat_map(|(i, piece)| {
            let row = move |r: &FlatRulingResult| RollRow {
                piece: i + 1,
                ruling: r.ruling,
                flat: [r.from.into(), r.to.into()],
                angle_deg: r.angle_deg,
                bend_deg: r.bend_deg,
                strain_percent: r.strain_percent,
            };
            piece.rulings.iter().map(row)
        });
        rows.collect()
    }
}

fn pattern(flat: &PlateFlatResult, piece: &FlatPieceResult, units: Units) -> Pattern {
    let corners = piece.corners();
    let ends = |r: &FlatRulingResult| -> [Point2<f64>; 2] { [r.from.into(), r.to.into()] };
    let numbered = piece.rulings.iter().filter(|r| r.ruling % NUMBERED == 0);
    let number = |r: &FlatRulingResult| {
        let [from, to] = ends(r);
        (nalgebra::center(&from, &to), (r.ruling + 1).to_string())
    };
    Pattern {
        kind: format!("Flat patterns, {} up", flat.side.words()),
        outline: polygon(&corners),
        cut: (corners.iter())
            .map(|c| Corner {
                at: c.at,
                bulge: c.bulge,
            })
            .collect(),
        line: piece.base_line.map(Into::into).to_vec(),
        rulings: piece.rulings.iter().map(ends).collect(),
        labels: numbered.map(number).collect(),
        marks: (piece.stations.iter())
            .map(|s| Mark {
                // With its unit: the drawing may be in another.
                name: format!("{} = {} {units}", flat.station_axis.letter(), s.at),
                line: s.line.iter().map(|p| (*p).into()).collect(),
            })
            .collect(),
        side: flat.side.words(),
        ..Pattern::default()
    }
}

fn verdict(plate: &PlateResult, sentence: &str) -> String {
    let word = if plate.within_limits {
        "LIMITS MET"
    } else {
        "OUTSIDE LIMITS"
    };
    format!("{word}. {sentence}")
}

/// What stands below a pattern, so that it does not get lost between office and
/// shop.
fn remarks(
    flat: &PlateFlatResult,
    piece: &FlatPieceResult,
    units: Units,
    profile: &str,
) -> Vec<String> {
    let [length, width] = piece.sheet;
    let developed = match flat.developed {
        DevelopedWord::Given => {
            "the surface through the profiles; no thickness is given, so none is allowed for."
        }
        DevelopedWord::Middle => "the middle of the plate: its thickness is allowed for.",
        DevelopedWord::Creased => {
            "the surface through the profiles: the plate has knuckles, at which its thickness is \
             not allowed for."
        }
    };
    let count = flat.pieces.len();
    let mut remarks = vec![
        format!(
            "Sheet {length:.3} x {width:.3} {units}, area {:.4}. Base line: corner to corner \
             along {profile}. Bend lines are numbered as in the roll table (result.csv).",
            piece.area
        ),
        format!(
            "Pattern of {} Bends {:.2} degrees in all.",
            developed, flat.bend_deg
        ),
        format!(
            "Flattening strains the plate by at most {:.4} % (twist, in the middle of a ruling), \
             not along edges and rulings. Bent along the rulings alone it stays {:.4} {units} off \
             at most; the rest is twist to be worked in.",
            flat.strain.twist_percent,
            flat.refold_deviation()
        ),
    ];
    if count > 1 {
        remarks.push(format!(
            "Cut into {count} pieces along rulings: in one piece it would lie on itself."
        ));
    }
    remarks
}

/// What is to be trimmed.
fn extension(plate: &PlateResult, units: Units) -> Option<String> {
    let longest = plate.extensions.into_iter().fold(0.0, f64::max);
    (longest > 0.0).then(|| {
        format!("Runs on past the profiles' ends by up to {longest:.4} {units}, to be trimmed.")
    })
}

/// What the summary says of the flat patterns; nothing where there is none.
pub(super) fn sentence(flats: &[Option<PlateFlatResult>], units: Units) -> Option<String> {
    let most = |figure: fn(&PlateFlatResult) -> f64| {
        let figures = flats.iter().flatten().map(figure);
        figures.fold(0.0, f64::max)
    };
    let pieces = flats.iter().flatten().flat_map(|f| &f.pieces);
    let sheet = pieces
        .map(|p| p.sheet)
        .reduce(|a, b| [a[0].max(b[0]), a[1].max(b[1])])?;
    let mut text = format!(
        "The flat patterns need sheets of up to {:.3} × {:.3} {units}; flattening strains the \
         plates by at most {:.4} %; bent along the rulings alone they stay {:.4} {units} off at \
         most, the rest is twist to be worked in",
        sheet[0],
        sheet[1],
        most(|f| f.strain.twist_percent),
        most(PlateFlatResult::refold_deviation),
    );
    for (k, flat) in flats.iter().enumerate() {
        let pieces = flat.as_ref().map_or(0, |f| f.pieces.len());
        let plate = k + 1;
        match pieces {
            0 => text.push_str(&format!("; plate {plate} has no area to be flattened")),
            1 => {}
            _ => text.push_str(&format!(
                "; plate {plate} is cut into {pieces} pieces, as it would lie on itself"
            )),
        }
    }
    text.push('.');
    Some(text)
}
