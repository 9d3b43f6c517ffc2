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
    let [x, y] = [k, l].map(|n| n as f64 / CELLS as f64);
    let u = own_parameter(x, patch, Axis::U, y);
    let v = own_parameter(y, patch, Axis::V, x);
    let jet = patch.derivatives_left(u, v);
    (jet.point, jet.normal().unwrap_or_else(Vector3::zeros))
}

/// The parameter along `along` whose place the line at `across` would have at
/// `common` if its end weights were 1.
fn own_parameter(common: f64, patch: &BSplineSurface, along: Axis, across: f64) -> f64 {
    let Ok(line) = patch.iso_curve(along, across) else {
        return common;
    };
    let [from, to] = match line.weights() {
        Some([first, .., last]) => [first.sqrt(), last.sqrt()],
        _ => return common,
    };
    from * common / (to * (1.0 - common) + from * common)
}
