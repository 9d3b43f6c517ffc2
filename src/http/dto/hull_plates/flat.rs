//! The flat patterns of `hull_plates` on the wire.

use super::super::flat::FlatPoint;
use super::HullPlatesOptions;
use crate::geometry::RuledSurface;
use crate::methods::hull_plates::outcome::{Outcome, Plate};
use crate::methods::{Control, FitError};
use crate::workshop::{
    FlatFigures, FlatPiece, FlatPlate, FlatRuling, HullFrame, OutlineCorner, Side, StationMark,
    flatten, flatten_thick,
};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// A plate as it is cut and rolled: the pattern of the surface that is
/// delivered, true to size. Boundaries and rulings keep their lengths; where the
/// plate twists, what lies between them is strained, and the figures say by how
/// much. With a thickness it is the pattern of the plate's middle, which bending
/// neither stretches nor shortens.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct PlateFlatResult {
    /// Which side of the plate lies up.
    pub side: SideWord,
    /// Which surface the pattern is of.
    pub developed: DevelopedWord,
    /// The coordinate of the stations, along the hull.
    pub station_axis: AxisWord,
    /// One piece, or several where the pattern would lie on itself; it is then
    /// cut along a ruling, which both pieces have.
    #[schema(min_items = 1)]
    pub pieces: Vec<FlatPieceResult>,
    /// Area of the plate.
    pub surface_area: f64,
    /// Area of the pattern.
    pub flat_area: f64,
    /// Lengths of the plate's two boundaries; the pattern has the same.
    #[schema(min_items = 2, max_items = 2, value_type = Vec<f64>)]
    pub boundary_lengths: [f64; 2],
    /// Strains between plate and pattern.
    pub strain: FlatStrainResult,
    /// All bends from ruling to ruling together, degrees, up or down.
    pub bend_deg: f64,
    /// The pattern bent along its rulings and in no other way, laid on the plate
    /// as well as it fits: first along the rulings that are listed, then along
    /// twice and four times as many. What does not fall is twist to be worked in.
    pub refolds: Vec<RefoldResult>,
}

/// `inside`: the side towards the hull's middle. `first_below`: the plate stands
/// edge on to the middle; with the first profile below, running to the right.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum SideWord {
    /// Towards the hull's middle.
    Inside,
    /// With the first profile below.
    FirstBelow,
}

/// `given`: the surface that is delivered, no thickness being given. `middle`:
/// half the thickness from it, or where `surface_side` has it. `creased`: the
/// surface that is delivered, though a thickness is given: at its knuckles the
/// middle gapes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum DevelopedWord {
    /// The surface as delivered.
    Given,
    /// The middle of the plate.
    Middle,
    /// The surface as delivered, because of its knuckles.
    Creased,
}

/// A coordinate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum AxisWord {
    /// The first.
    X,
    /// The second.
    Y,
    /// The third.
    Z,
}

/// A piece of a flat pattern. Its base line is the x axis of its points.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct FlatPieceResult {
    /// Corners of the closed outline: along the first profile, the last ruling,
    /// back along the second profile, the first ruling.
    pub outline: Vec<FlatPoint>,
    /// For each corner tan(α/4) of the arc of angle α to the next one, positive
    /// to the left; 0 for a straight line.
    pub bulges: Vec<f64>,
    /// A straight line to measure from, corner to corner along a profile.
    #[schema(min_items = 2, max_items = 2, value_type = Vec<FlatPoint>)]
    pub base_line: [FlatPoint; 2],
    /// That profile: 0 for the plate's first, 1 for its second.
    #[schema(minimum = 0, maximum = 1)]
    pub base_profile: usize,
    /// The roll table.
    pub rulings: Vec<FlatRulingResult>,
    /// Where stations cross.
    pub stations: Vec<StationResult>,
    /// Area.
    pub area: f64,
    /// Longer and shorter side of the least rectangle around it.
    #[schema(min_items = 2, max_items = 2, value_type = Vec<f64>)]
    pub sheet: [f64; 2],
}

/// A ruling in a flat pattern.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct FlatRulingResult {
    /// Its index in the plate's `rulings`.
    pub ruling: usize,
    /// End on the first profile.
    pub from: FlatPoint,
    /// End on the second profile.
    pub to: FlatPoint,
    /// Length.
    pub length: f64,
    /// Angle from the base line, degrees.
    pub angle_deg: f64,
    /// Bend from here to the next ruling, degrees; positive: up.
    pub bend_deg: f64,
    /// Strain that its twist θ leaves in its middle, θ²/8 where both ends are
    /// equally fast, percent.
    pub strain_percent: f64,
}

/// Where a station crosses a flat pattern.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct StationResult {
    /// Its coordinate.
    pub at: f64,
    /// From place to place.
    pub line: Vec<FlatPoint>,
}

/// Largest strains, without sign but for `area_percent`, percent of the length
/// on the plate. But for `twist_percent` they are measured: lengths of small
/// fields of the pattern against those of the same fields on the plate.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct FlatStrainResult {
    /// Along the two boundaries.
    pub boundary_percent: f64,
    /// Along the rulings.
    pub ruling_percent: f64,
    /// From ruling to ruling between their ends.
    pub middle_percent: f64,
    /// Along the fields' diagonals.
    pub diagonal_percent: f64,
    /// Of the areas: of the pattern beyond that of the plate.
    pub area_percent: f64,
    /// Largest of the rulings' `strain_percent`.
    pub twist_percent: f64,
}

/// A pattern that was bent along its rulings.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct RefoldResult {
    /// How many rulings.
    pub rulings: usize,
    /// Largest distance of their ends from where they are on the plate.
    pub deviation: f64,
}

/// The flat patterns of all plates; `None` for one that has no area.
///
/// # Errors
/// [`FitError::Stopped`] when `control` says so.
pub fn flat_patterns(
    outcome: &Outcome,
    options: &HullPlatesOptions,
    control: &dyn Control,
) -> Result<Vec<Option<PlateFlatResult>>, FitError> {
    let ruled = |plate: &Plate| {
        let [first, second, ..] = plate.surface.boundary_curves();
        RuledSurface::new(first, second).map_err(|e| FitError::Numerical(e.to_string()))
    };
    let surfaces = (outcome.plates.iter().map(ruled)).collect::<Result<Vec<_>, _>>()?;
    let Some(hull) = HullFrame::around(&surfaces) else {
        return Ok(Vec::new());
    };
    let axis = [AxisWord::X, AxisWord::Y, AxisWord::Z][hull.axis()];
    (surfaces.par_iter().zip(&outcome.plates))
        .map(|(surface, plate)| {
            control.check()?;
            let rulings: Vec<f64> = plate.rulings.iter().map(|r| r.u).collect();
            let face = options.surface_side.into();
            let thick = options
                .thickness
                .and_then(|t| flatten_thick(surface, &rulings, &hull, t, face));
            let developed = match (&thick, options.thickness) {
                (Some(_), _) => DevelopedWord::Middle,
                (None, Some(_)) => DevelopedWord::Creased,
                (None, None) => DevelopedWord::Given,
            };
            let flat = thick.or_else(|| flatten(surface, &rulings, &hull));
            Ok(flat.map(|flat| PlateFlatResult::new(&flat, developed, axis)))
        })
        .collect()
}

impl PlateFlatResult {
    fn new(flat: &FlatPlate, developed: DevelopedWord, station_axis: AxisWord) -> Self {
        let f = &flat.figures;
        PlateFlatResult {
            side: match flat.side {
                Side::Inside => SideWord::Inside,
                Side::FirstBelow => SideWord::FirstBelow,
            },
            developed,
            station_axis,
            pieces: flat.pieces.iter().map(Into::into).collect(),
            surface_area: f.surface_area,
            flat_area: f.flat_area,
            boundary_lengths: f.boundary_lengths,
            strain: f.into(),
            bend_deg: f.bend_deg,
            refolds: f.refolds.iter().map(Into::into).collect(),
        }
    }

    /// The distance from the plate that more rulings do not take away.
    pub(super) fn refold_deviation(&self) -> f64 {
        self.refolds.last().map_or(0.0, |r| r.deviation)
    }
}

impl From<&FlatFigures> for FlatStrainResult {
    fn from(f: &FlatFigures) -> Self {
        FlatStrainResult {
            boundary_percent: f.boundary_strain_percent,
            ruling_percent: f.ruling_strain_percent,
            middle_percent: f.middle_strain_percent,
            diagonal_percent: f.diagonal_strain_percent,
            area_percent: 100.0 * (f.flat_area / f.surface_area - 1.0),
            twist_percent: f.twist_strain_percent,
        }
    }
}

impl From<&(usize, f64)> for RefoldResult {
    fn from((rulings, deviation): &(usize, f64)) -> Self {
        RefoldResult {
            rulings: *rulings,
            deviation: *deviation,
        }
    }
}

impl From<&FlatPiece> for FlatPieceResult {
    fn from(piece: &FlatPiece) -> Self {
        FlatPieceResult {
            outline: piece.outline.iter().map(|c| c.at.into()).collect(),
            bulges: piece.outline.iter().map(|c| c.bulge).collect(),
            base_line: piece.base_line.map(Into::into),
            base_profile: piece.base_boundary,
            rulings: piece.rulings.iter().map(Into::into).collect(),
            stations: piece.stations.iter().map(Into::into).collect(),
            area: piece.area,
            sheet: piece.sheet,
        }
    }
}

impl From<&FlatRuling> for FlatRulingResult {
    fn from(r: &FlatRuling) -> Self {
        FlatRulingResult {
            ruling: r.index,
            from: r.from.into(),
            to: r.to.into(),
            length: r.length,
            angle_deg: r.angle_deg,
            bend_deg: r.bend_deg,
            strain_percent: r.strain_percent,
        }
    }
}

impl From<&StationMark> for StationResult {
    fn from(mark: &StationMark) -> Self {
        StationResult {
            at: mark.at,
            line: mark.line.iter().map(|p| (*p).into()).collect(),
        }
    }
}

impl FlatPieceResult {
    /// The outline with its arcs.
    pub(super) fn corners(&self) -> Vec<OutlineCorner> {
        (self.outline.iter().zip(&self.bulges))
            .map(|(at, bulge)| OutlineCorner {
                at: (*at).into(),
                bulge: *bulge,
            })
            .collect()
    }
}

impl SideWord {
    /// In the words of a drawing.
    pub(super) fn words(self) -> &'static str {
        match self {
            SideWord::Inside => "inside",
            SideWord::FirstBelow => "side with the first profile below",
        }
    }
}

impl AxisWord {
    /// Its letter.
    pub(super) fn letter(self) -> char {
        match self {
            AxisWord::X => 'x',
            AxisWord::Y => 'y',
            AxisWord::Z => 'z',
        }
    }
}
