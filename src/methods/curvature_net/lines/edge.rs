//! The borders of the patches, and the unknowns that their shape depends on.

use super::border::{BorderJet, Torsion};
use crate::methods::curvature_net::surface::{Surface, UNKNOWNS, weights};
use nalgebra::Vector3;

/// A border: its ends, its direction, its width in the parameter along it and
/// the width across of the strip that it stands for.
#[derive(Debug, Clone, Copy)]
pub(in super::super) struct Edge {
    pub(in super::super) ends: [usize; 2],
    pub(in super::super) direction: usize,
    pub(super) width: f64,
    pub(super) strip: f64,
}

/// Places among a vertex's unknowns of value, slope along, slope across and
/// mixed derivative, for borders along u and along v.
const PLACES: [[usize; 4]; 2] = [[0, 3, 6, 9], [0, 6, 3, 9]];

/// What a border depends on: the four vectors of its two ends.
pub(super) const COLUMNS: usize = 2 * UNKNOWNS;

/// A vector among the unknowns.
pub(super) fn vector(x: &[f64], at: usize) -> Vector3<f64> {
    Vector3::new(x[at], x[at + 1], x[at + 2])
}

/// All borders, those along u first.
pub(in super::super) fn edges(surface: &Surface) -> Vec<Edge> {
    let layout = surface.layout();
    let along = |direction: usize| {
        layout.edges(direction).map(move |ends| {
            let at = [ends[0] / layout.columns, ends[0] % layout.columns];
            Edge {
                ends,
                direction,
                width: surface.widths()[direction][at[direction]],
                strip: strip(surface, 1 - direction, at[1 - direction]),
            }
        })
    };
    [0, 1].into_iter().flat_map(along).collect()
}

/// Half the widths of the patches on both sides of a line.
pub(super) fn strip(surface: &Surface, direction: usize, line: usize) -> f64 {
    let widths = &surface.widths()[direction];
    let closed = surface.layout().closed[direction];
    let before = match line.checked_sub(1) {
        Some(before) => widths[before],
        None if closed => widths[widths.len() - 1],
        None => 0.0,
    };
    0.5 * (before + widths.get(line).copied().unwrap_or(0.0))
}

impl Edge {
    /// Place among all unknowns of a part (value, slope along, slope across,
    /// mixed) of one end.
    pub(super) fn place(&self, end: usize, part: usize) -> usize {
        self.ends[end] * UNKNOWNS + PLACES[self.direction][part]
    }

    /// A part at both ends.
    pub(super) fn vectors(&self, x: &[f64], part: usize) -> [Vector3<f64>; 2] {
        [0, 1].map(|end| vector(x, self.place(end, part)))
    }

    /// Derivatives along and across at the share `t` of the border, and how
    /// they change along it.
    pub(in super::super) fn jet(&self, x: &[f64], t: f64) -> BorderJet {
        let h = self.width;
        let w = [0, 1, 2].map(|d| weights(t, h, d));
        let [value, along, across, mixed] = [0, 1, 2, 3].map(|part| self.vectors(x, part));
        let sum = |value: &[Vector3<f64>; 2], slope: &[Vector3<f64>; 2], w: &[f64; 4]| {
            value[0] * w[0] + value[1] * w[1] + slope[0] * w[2] + slope[1] * w[3]
        };
        BorderJet {
            along: sum(&value, &along, &w[1]) * h,
            across: sum(&across, &mixed, &w[0]),
            along_change: sum(&value, &along, &w[2]) * (h * h),
            across_change: sum(&across, &mixed, &w[1]) * h,
        }
    }

    /// The unknowns of both ends.
    pub(super) fn columns(&self) -> [usize; COLUMNS] {
        std::array::from_fn(|k| self.ends[k / UNKNOWNS] * UNKNOWNS + k % UNKNOWNS)
    }

    /// Derivatives by [`Self::columns`] of a torsion at the share `t`.
    pub(super) fn row(&self, t: f64, torsion: &Torsion, factor: f64) -> [f64; COLUMNS] {
        let h = self.width;
        let w = [0, 1, 2].map(|d| weights(t, h, d));
        let [x, y, dx, dy] = torsion.by.map(|by| by * factor);
        let mut row = [0.0; COLUMNS];
        for end in [0, 1] {
            let slope = 2 + end;
            let parts = [
                x * (w[1][end] * h) + dx * (w[2][end] * h * h),
                x * (w[1][slope] * h) + dx * (w[2][slope] * h * h),
                y * w[0][end] + dy * (w[1][end] * h),
                y * w[0][slope] + dy * (w[1][slope] * h),
            ];
            for (part, by) in parts.iter().enumerate() {
                let at = end * UNKNOWNS + PLACES[self.direction][part];
                row[at..at + 3].copy_from_slice(by.as_slice());
            }
        }
        row
    }
}
