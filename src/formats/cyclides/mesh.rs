//! Triangles of patches whose neighbours have borders in common, but not the
//! parameters on them.
//!
//! Two rational patches run through a common arc at different speeds. Sampled
//! at equal parameters they would leave slits; sampled at the parameters that
//! an arc with end weights 1 would have they agree. Every sample is one vertex
//! of the whole sheet, whichever patches it belongs to.

use super::{NetDrawing, PatchSheet};
use crate::formats::obj::{one_line, push};
use crate::geometry::{Axis, BSplineSurface};
use nalgebra::{Point3, Vector3};

/// Cells a patch in each direction: arcs of a net turn little.
const CELLS: usize = 4;

/// The mesh as text.
pub(super) fn write(drawing: &NetDrawing) -> String {
    let mut text = format!(
        "# {}\n# lengths in {}; {}\n",
        one_line(&drawing.title),
        one_line(&drawing.units),
        one_line(&drawing.verdict)
    );
    let mut first = 1;
    for sheet in &drawing.sheets {
        let lattice = Lattice::of(sheet);
        push(
            &mut text,
            format_args!("o {}\n", one_line(&sheet.name).replace(' ', "_")),
        );
        for (p, n) in &lattice.samples {
            push(&mut text, format_args!("v {} {} {}\n", p.x, p.y, p.z));
            // A unit vector to seven digits is exact to a hundred-thousandth of a degree.
            push(
                &mut text,
                format_args!("vn {:.7} {:.7} {:.7}\n", n.x, n.y, n.z),
            );
        }
        for triangle in &lattice.triangles {
            let [a, b, c] = triangle.map(|i| i + first);
            push(&mut text, format_args!("f {a}//{a} {b}//{b} {c}//{c}\n"));
        }
        first += lattice.samples.len();
    }
    text
}

/// The samples of a sheet, and the triangles between them.
struct Lattice {
    samples: Vec<(Point3<f64>, Vector3<f64>)>,
    triangles: Vec<[usize; 3]>,
}

impl Lattice {
    fn of(sheet: &PatchSheet) -> Self {
        let [rows, columns] =
            [0, 1].map(|k| CELLS * sheet.counts[k] + usize::from(!sheet.closed[k]));
        let mut places: Vec<Option<usize>> = vec![None; rows * columns];
        let mut lattice = Lattice {
            samples: Vec::new(),
            triangles: Vec::new(),
        };
        let patches = (0..sheet.counts[0]).flat_map(|i| (0..sheet.counts[1]).map(move |j| (i, j)));
        for ((i, j), patch) in patches.zip(&sheet.patches) {
            let Some(patch) = patch else { continue };
            let mut own = [[0; CELLS + 1]; CELLS + 1];
            for (k, row) in own.iter_mut().enumerate() {
                for (l, slot) in row.iter_mut().enumerate() {
                    let place = (CELLS * i + k) % rows * columns + (CELLS * j + l) % columns;
                    *slot = *places[place].get_or_insert_with(|| {
                        lattice.samples.push(sample(patch, k, l));
                        lattice.samples.len() - 1
                    });
                }
            }
            lattice.join(&own);
        }
        lattice
    }

    fn join(&mut self, own: &[[usize; CELLS + 1]; CELLS + 1]) {
        for (low, high) in own.iter().zip(&own[1..]) {
            for l in 0..CELLS {
                let [a, b, c, d] = [low[l], high[l], high[l + 1], low[l + 1]];
                let across = |p: usize, q: usize| (self.samples[p].0 - self.samples[q].0).norm();
                // Along the shorter diagonal.
                let pair = if across(a, c) <= across(b, d) {
                    [[a, b, c], [a, c, d]]
                } else {
                    [[a, b, d], [b, c, d]]
                };
                self.triangles.extend(pair);
            }
        }
    }
}

fn sample(patch: &BSplineSurface, k: usize, l: usize) -> (Point3<f64>, Vector3<f64>) {
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
    (jet.point, jet.normal().unwrap_or_else(Vector3::zeros))
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
