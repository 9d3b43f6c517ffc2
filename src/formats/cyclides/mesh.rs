//! Triangles of patches whose neighbours have borders in common, but not the
//! parameters on them.
//!
//! Two rational patches run through a common arc at different speeds. Sampled
//! at equal parameters they would leave slits; sampled at the parameters that
//! an arc with end weights 1 would have they agree. Every sample is one vertex
//! of the whole sheet, whichever patches it belongs to.

use super::PatchSheet;
use crate::geometry::{Axis, BSplineSurface, SurfaceJet};
use nalgebra::{Point3, Vector3};

/// Cells a patch in each direction: arcs of a net turn little.
const CELLS: usize = 4;

/// A place in a sheet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::formats) struct Place {
    /// Row and column of the patch.
    pub patch: [usize; 2],
    /// Shares of the way across it in u and v.
    pub share: [f64; 2],
}

/// A sample of a sheet.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::formats) struct Sample {
    /// Where in the sheet.
    pub place: Place,
    /// The point.
    pub point: Point3<f64>,
    /// The unit normal.
    pub normal: Vector3<f64>,
    /// The patch there.
    pub jet: SurfaceJet,
    /// Lengths of the patch's domain in u and v.
    pub extent: [f64; 2],
}

/// The samples of a sheet, and the triangles between them.
pub(in crate::formats) struct Lattice {
    /// All samples.
    pub samples: Vec<Sample>,
    /// Each patch's number, row after row, and its triangles.
    pub patches: Vec<(usize, Vec<[usize; 3]>)>,
    /// Each patch's four sides as samples.
    sides: Vec<[Vec<usize>; 4]>,
}

impl Lattice {
    /// Samples every patch.
    pub fn of(sheet: &PatchSheet) -> Self {
        let [rows, columns] =
            [0, 1].map(|k| CELLS * sheet.counts[k] + usize::from(!sheet.closed[k]));
        let mut places: Vec<Option<usize>> = vec![None; rows * columns];
        let mut lattice = Lattice {
            samples: Vec::new(),
            patches: Vec::new(),
            sides: Vec::new(),
        };
        let patches = (0..sheet.counts[0]).flat_map(|i| (0..sheet.counts[1]).map(move |j| [i, j]));
        for (number, ([i, j], patch)) in patches.zip(&sheet.patches).enumerate() {
            let Some(patch) = patch else { continue };
            let mut own = [[0; CELLS + 1]; CELLS + 1];
            for (k, row) in own.iter_mut().enumerate() {
                for (l, slot) in row.iter_mut().enumerate() {
                    let place = (CELLS * i + k) % rows * columns + (CELLS * j + l) % columns;
                    *slot = *places[place].get_or_insert_with(|| {
                        lattice.samples.push(sample(patch, [i, j], [k, l]));
                        lattice.samples.len() - 1
                    });
                }
            }
            lattice.join(number, &own);
        }
        lattice
    }

    /// The sides of all patches, those that two share once.
    pub fn borders(&self) -> Vec<Vec<usize>> {
        let mut known = std::collections::HashSet::new();
        let sides = self.sides.iter().flatten();
        sides
            .filter(|line| {
                let ends = [line[0], line[1], line[CELLS - 1], line[CELLS]];
                let turned = [ends[3], ends[2], ends[1], ends[0]];
                known.insert(ends.min(turned))
            })
            .cloned()
            .collect()
    }

    fn join(&mut self, number: usize, own: &[[usize; CELLS + 1]; CELLS + 1]) {
        let mut triangles = Vec::with_capacity(2 * CELLS * CELLS);
        for (low, high) in own.iter().zip(&own[1..]) {
            for l in 0..CELLS {
                let [a, b, c, d] = [low[l], high[l], high[l + 1], low[l + 1]];
                let across =
                    |p: usize, q: usize| (self.samples[p].point - self.samples[q].point).norm();
                // Along the shorter diagonal.
                triangles.extend(if across(a, c) <= across(b, d) {
                    [[a, b, c], [a, c, d]]
                } else {
                    [[a, b, d], [b, c, d]]
                });
            }
        }
        self.patches.push((number, triangles));
        let column = |l: usize| own.iter().map(|row| row[l]).collect();
        self.sides.push([
            own[0].to_vec(),
            own[CELLS].to_vec(),
            column(0),
            column(CELLS),
        ]);
    }
}

fn sample(patch: &BSplineSurface, of: [usize; 2], [k, l]: [usize; 2]) -> Sample {
    let shares = [k, l].map(|n| n as f64 / CELLS as f64);
    let [u, v] = [(Axis::U, 0, 1), (Axis::V, 1, 0)].map(|(along, own, other)| {
        let across = if along == Axis::U { Axis::V } else { Axis::U };
        let at = inside(patch.domain(across), shares[other]);
        inside(
            patch.domain(along),
            own_share(shares[own], patch, along, at),
        )
    });
    let jet = patch.derivatives_left(u, v);
    Sample {
        place: Place {
            patch: of,
            share: shares,
        },
        point: jet.point,
        normal: jet.normal().unwrap_or_else(Vector3::zeros),
        jet,
        extent: [Axis::U, Axis::V].map(|axis| {
            let [first, last] = patch.domain(axis);
            last - first
        }),
    }
}

fn inside([first, last]: [f64; 2], share: f64) -> f64 {
    first + (last - first) * share
}

/// The share of its parameters along `along` at which the line at `at` has the
/// place that it would have at `common` if its end weights were 1.
fn own_share(common: f64, patch: &BSplineSurface, along: Axis, at: f64) -> f64 {
    let Ok(line) = patch.iso_curve(along, at) else {
        return common;
    };
    let [from, to] = match line.weights() {
        Some([first, .., last]) => [first.sqrt(), last.sqrt()],
        _ => return common,
    };
    from * common / (to * (1.0 - common) + from * common)
}
