//! The job of `fairing` on the wire. Bounds of single values are written here,
//! as the schema that is published and checked; its way into the method's
//! request is [`to_request`].

mod diagnostics;
mod drawing;
mod points;
mod result;
mod table;
mod to_request;

pub use diagnostics::FairingDiagnostics;
pub use points::MeasuredPoint;
pub use result::FairingResult;
pub use to_request::to_request;

use super::curves::Point;
use super::index::{Index, IndexPair};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// What `fairing` takes: exactly one of `points`, `grid` and `offsets`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct FairingInput {
    /// Your name for the curve or the surface.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(min_length = 1, max_length = 100, examples("waterline 4"))]
    pub name: Option<String>,
    /// Measured points, all with two coordinates or all with three: of a
    /// curve, or with `kind` `surface` of a sheet, in any order.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(min_items = 2, max_items = 1_000_000)]
    pub points: Option<Vec<MeasuredPoint>>,
    /// Whether `points` are of a curve or of a surface.
    #[serde(default)]
    pub kind: PointsKind,
    /// Whether the points of a curve come in their order along it; otherwise
    /// the order is found.
    #[serde(default = "yes")]
    pub ordered: bool,
    /// Whether a curve is closed. Without it ordered points are open unless
    /// the last repeats the first, and points without order are looked at.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub closed: Option<bool>,
    /// Rows of points, neighbours in the table neighbours on the sheet; null
    /// where a cell was not measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(min_items = 2, max_items = 100_000)]
    pub grid: Option<Vec<Vec<Option<Point>>>>,
    /// A table of offsets.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub offsets: Option<OffsetTable>,
    /// How a table of offsets is written as a file; one that came as a file is
    /// written as it came.
    #[serde(default, skip_serializing_if = "TableLayout::is_usual")]
    pub table_layout: TableLayout,
    /// Only in a form that comes with a file: what the file holds, `points`
    /// when nothing is said.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub file: Option<FileHolds>,
    /// Only with a file of offsets whose stations or waterlines have names in
    /// place of places ("AP", "9 1/2", "WL 3"): where they are.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub file_places: Option<FilePlaces>,
}

/// Places of the stations and waterlines of a file that names them. Of each a
/// list or a spacing.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields, default)]
pub struct FilePlaces {
    /// x of the stations, in the order of the file.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(min_items = 2, max_items = 10_000)]
    pub stations: Option<Vec<f64>>,
    /// z of the waterlines, in the order of the file.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(min_items = 2, max_items = 10_000)]
    pub waterlines: Option<Vec<f64>>,
    /// Distance from one station number to the next; a perpendicular at the
    /// end of a table has the next whole number beyond its neighbour.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(exclusive_minimum = 0)]
    pub station_spacing: Option<f64>,
    /// Distance from one waterline number to the next.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(exclusive_minimum = 0)]
    pub waterline_spacing: Option<f64>,
}

fn yes() -> bool {
    true
}

/// What an uploaded file holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum FileHolds {
    /// One point a line.
    Points,
    /// A table with one station a line: heights of the waterlines in the first
    /// row, places of the stations in the first column.
    Offsets,
    /// A table with one waterline a line: places of the stations in the first
    /// row, heights of the waterlines in the first column.
    OffsetsTransposed,
}

/// What loose points are of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum PointsKind {
    /// A curve.
    #[default]
    Curve,
    /// A sheet.
    Surface,
}

/// Half-breadths on stations and waterlines.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct OffsetTable {
    /// x of the stations, increasing.
    #[schema(min_items = 2, max_items = 10_000)]
    pub stations: Vec<f64>,
    /// z of the waterlines, increasing.
    #[schema(min_items = 2, max_items = 10_000)]
    pub waterlines: Vec<f64>,
    /// Half-breadths, not negative: one row a station, one cell a waterline;
    /// null where nothing was measured.
    #[schema(min_items = 2, max_items = 10_000)]
    pub y: Vec<Vec<Option<f64>>>,
    /// Your names of the stations, which are given back.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(min_items = 2, max_items = 10_000)]
    pub station_names: Option<Vec<String>>,
    /// Your names of the waterlines.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(min_items = 2, max_items = 10_000)]
    pub waterline_names: Option<Vec<String>>,
}

/// How a table of offsets lies on paper.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields, default)]
#[schema(default)]
pub struct TableLayout {
    /// What its rows are.
    pub rows: TableRows,
    /// Whether it begins with the station of the greatest x.
    pub stations_falling: bool,
    /// Whether it begins with the highest waterline.
    pub waterlines_falling: bool,
}

impl TableLayout {
    /// Whether it is the one that nothing need be said of.
    #[must_use]
    pub fn is_usual(&self) -> bool {
        *self == TableLayout::default()
    }
}

/// What the rows of a table of offsets are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum TableRows {
    /// One station a row.
    #[default]
    Stations,
    /// One waterline a row.
    Waterlines,
}

/// What is asked of the fair shape. Lengths in the job's unit. An option that
/// does not go with the input is refused.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields, default)]
#[schema(default)]
pub struct FairingOptions {
    /// The most that any point may move; 0 lets a curve pass through its
    /// points. Without it the noise is estimated from the points, and the
    /// shape follows them as nearly as that allows.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(minimum = 0)]
    pub tolerance: Option<f64>,
    /// A tolerance for each point, in place of the common one.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(max_items = 1_000_000)]
    pub tolerances: Option<Vec<f64>>,
    /// Tolerances of single cells of a table of offsets; the others have the
    /// common one.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[schema(max_items = 100_000)]
    pub cell_tolerances: Vec<CellTolerance>,
    /// How much each point counts against the others, greater than 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(max_items = 1_000_000)]
    pub stiffness: Option<Vec<f64>>,
    /// Indices of points that stay where they are.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[schema(max_items = 100_000)]
    pub locked: Vec<Index>,
    /// Cells of a table of offsets that stay as they are: station, waterline.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[schema(max_items = 100_000)]
    pub locked_cells: Vec<IndexPair>,
    /// The axes along which points may move.
    pub freedom: Freedom,
    /// Tangents at the start and the end of a curve, of any length; null for a
    /// free end.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(min_items = 2, max_items = 2)]
    pub end_tangents: Option<Vec<Option<Point>>>,
    /// Curvatures at the start and the end of a curve, 1/length; in the plane
    /// positive to the left; null for a free end.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(min_items = 2, max_items = 2)]
    pub end_curvatures: Option<Vec<Option<f64>>>,
    /// Points at which a curve may have a corner.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[schema(max_items = 10_000)]
    pub knuckles: Vec<Index>,
    /// Stations of a table of offsets, by index, across which the waterlines
    /// may have a corner.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[schema(max_items = 10_000)]
    pub knuckle_stations: Vec<Index>,
    /// Waterlines of a table of offsets, by index, across which the stations
    /// may have a corner: chines and knuckles of the side.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[schema(max_items = 10_000)]
    pub knuckle_waterlines: Vec<Index>,
    /// Rows of a grid, by index, across which the surface may have a corner.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[schema(max_items = 10_000)]
    pub knuckle_rows: Vec<Index>,
    /// Columns of a grid, by index, across which the surface may have a corner.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[schema(max_items = 10_000)]
    pub knuckle_columns: Vec<Index>,
    /// Stretches of a curve that must be straight, from point to point.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[schema(max_items = 10_000)]
    pub straight: Vec<IndexPair>,
    /// The paper's energy of a curve in place of the change of curvature.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub energy: Option<CurveEnergy>,
    /// The paper's energy of a surface in place of the change of curvature.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub surface_energy: Option<SurfaceEnergy>,
    /// Springs of points on a grid's border are stiffer by this factor. Without
    /// it 1, or 100 for the paper's solver.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(exclusive_minimum = 0)]
    pub boundary_factor: Option<f64>,
    /// Degree of a curve; without it 5, or 3 for the paper's solver.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(minimum = 3, maximum = 7)]
    pub degree: Option<Index>,
    /// Number of a curve's control points; without it chosen from the points.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(minimum = 4, maximum = 20_000)]
    pub control_points: Option<Index>,
    /// Numbers of a surface's control points in u and v; without it chosen
    /// from the points.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub control_net: Option<IndexPair>,
    /// A place near which a surface's points that close all round (a tube) are
    /// cut along their axis; without it a tube is refused.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cut: Option<Point>,
    /// Whether points that look like slips lose their hold on the shape.
    pub robust: bool,
    /// Which algorithm fits.
    pub solver: FairingSolver,
    /// y of the buttocks of a table of offsets; without any ¼, ½ and ¾ of the
    /// greatest half-breadth.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[schema(max_items = 1000)]
    pub buttocks: Vec<f64>,
    /// Direction of the light for isophotes, of any length.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub light: Option<Point>,
}

/// The tolerance of one cell of a table of offsets.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct CellTolerance {
    /// Which station, counted from 0.
    pub station: Index,
    /// Which waterline, counted from 0.
    pub waterline: Index,
    /// The most that this half-breadth may change.
    #[schema(exclusive_minimum = 0)]
    pub tolerance: f64,
}

/// Along which axes points may move: `y` alone for half-breadths. Of points in
/// a plane the first coordinate is x and the second y.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum Freedom {
    /// Along x only.
    X,
    /// Along y only.
    Y,
    /// Along z only.
    Z,
    /// In planes z = const.
    Xy,
    /// In planes y = const.
    Xz,
    /// In planes x = const.
    Yz,
    /// Anywhere.
    #[default]
    Xyz,
}

impl Freedom {
    /// x, y, z.
    #[must_use]
    pub fn axes(self) -> [bool; 3] {
        match self {
            Freedom::X => [true, false, false],
            Freedom::Y => [false, true, false],
            Freedom::Z => [false, false, true],
            Freedom::Xy => [true, true, false],
            Freedom::Xz => [true, false, true],
            Freedom::Yz => [false, true, true],
            Freedom::Xyz => [true, true, true],
        }
    }
}

/// Weights of ∫ α|r′|² + β|r″|² + γ|r‴|² du, the curve scaled to unit size.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct CurveEnergy {
    /// α: resistance to stretching.
    #[schema(minimum = 0)]
    pub tension: f64,
    /// β: resistance to bending.
    #[schema(minimum = 0)]
    pub bending: f64,
    /// γ: resistance to change of bending.
    #[schema(minimum = 0)]
    pub jerk: f64,
}

/// Weights of ∬ α₁₁|r_u|² + α₂₂|r_v|² + β₁₁|r_uu|² + β₁₂|r_uv|² + β₂₂|r_vv|²,
/// parameters from 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct SurfaceEnergy {
    /// α₁₁: resistance to stretching along u.
    #[schema(minimum = 0)]
    pub alpha11: f64,
    /// α₂₂: resistance to stretching along v.
    #[schema(minimum = 0)]
    pub alpha22: f64,
    /// β₁₁: resistance to bending along u.
    #[schema(minimum = 0)]
    pub beta11: f64,
    /// β₁₂: resistance to twisting.
    #[schema(minimum = 0)]
    pub beta12: f64,
    /// β₂₂: resistance to bending along v.
    #[schema(minimum = 0)]
    pub beta22: f64,
}

/// Which algorithm fits: `own`, this service's, or `paper`, the formulation of
/// Jing, Xi & Tang 1998: cubic, one spring stiffness for all points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum FairingSolver {
    /// This service's own.
    #[default]
    Own,
    /// The paper's.
    Paper,
}
