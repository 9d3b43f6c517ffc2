//! A faired table of offsets on the wire.

use super::{OffsetTable, TableLayout};
use crate::methods::fairing::offsets;
use crate::methods::fairing::offsets::outcome::CellKind;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// A faired table of offsets: rows are stations, cells are waterlines.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct OffsetsResult {
    /// x of the stations.
    pub stations: Vec<f64>,
    /// z of the waterlines.
    pub waterlines: Vec<f64>,
    /// Your names of the stations.
    pub station_names: Option<Vec<String>>,
    /// Your names of the waterlines.
    pub waterline_names: Option<Vec<String>>,
    /// How the table is written as a file.
    pub layout: TableLayout,
    /// Old, new and move of every cell.
    pub cells: Vec<Vec<CellResult>>,
}

/// A cell of a faired table.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CellResult {
    /// What it is.
    pub kind: CellWord,
    /// As given.
    pub old: Option<f64>,
    /// Faired; null outside the hull.
    pub new: Option<f64>,
    /// new − old.
    pub change: Option<f64>,
}

/// What a cell of a table is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum CellWord {
    /// Measured on the hull.
    Measured,
    /// A zero next to the hull that is its ending.
    Ending,
    /// Not measured, inside the hull: the fair surface's own value.
    Filled,
    /// Beyond the hull's outline.
    Outside,
}

impl OffsetsResult {
    /// The table of an outcome.
    #[must_use]
    pub fn new(outcome: &offsets::Outcome, table: &OffsetTable, layout: TableLayout) -> Self {
        let cell = |c: &offsets::outcome::Cell| CellResult {
            kind: match c.kind {
                CellKind::Measured => CellWord::Measured,
                CellKind::Ending => CellWord::Ending,
                CellKind::Filled => CellWord::Filled,
                CellKind::Outside => CellWord::Outside,
            },
            old: c.old,
            new: c.new,
            change: c.change,
        };
        OffsetsResult {
            stations: table.stations.clone(),
            waterlines: table.waterlines.clone(),
            station_names: table.station_names.clone(),
            waterline_names: table.waterline_names.clone(),
            layout,
            cells: (outcome.table.iter())
                .map(|row| row.iter().map(cell).collect())
                .collect(),
        }
    }
}
