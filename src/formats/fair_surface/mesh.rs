//! Triangles of a trimmed surface: a lattice inside, the outline as edges.
//!
//! The outline is divided as finely as the lattice; both together are joined
//! by a Delaunay triangulation, and edges of the outline that it lacks are
//! halved until all are there ("conforming"). So the border is as smooth as the
//! outline, no triangle is cut, and there are no slits.

use super::FairSurfaceDrawing;
use super::delaunay::{Delaunay, RANGE, Site};
use super::outline::{Outline, distance_to_segment};
use crate::geometry::{Axis, BSplineSurface};
use nalgebra::{Point3, Vector3};

/// Chordal error aimed at, as a share of the model's diagonal: a tenth of a
/// millimetre on a metre.
const CHORDAL_SHARE: f64 = 1e-4;
/// Fewest and most cells of the lattice in one direction.
const CELLS: [f64; 2] = [6.0, 160.0];
/// A cell's longer side over its shorter one at most.
const ASPECT: f64 = 4.0;
/// Places per direction where the bend is measured.
const PROBES: usize = 24;
/// Lattice points nearer to the outline than this share of a cell are left
/// out: they would make slivers.
const CLEARANCE: f64 = 0.45;
/// Rounds of halving edges of the outline. Each halves the shortest; after so
/// many an edge is below the resolution of the sites.
const ROUNDS: usize = 22;

/// A triangulated surface; the winding is that of ∂S/∂u × ∂S/∂v throughout.
pub(in crate::formats) struct Mesh {
    pub vertices: Vec<Point3<f64>>,
    pub normals: Vec<Vector3<f64>>,
    /// (u, v) of the vertices.
    pub places: Vec<[f64; 2]>,
    pub triangles: Vec<[usize; 3]>,
    /// The largest distance between a triangle and the surface at the middles
    /// of its edges and its own.
    pub chordal_error: f64,
}

/// The lattice: cells in u and v over the domain.
struct Lattice {
    low: [f64; 2],
    high: [f64; 2],
    cells: [f64; 2],
}

impl Lattice {
    /// (u, v) in cells from the lower corner.
    fn in_cells(&self, uv: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|i| (uv[i] - self.low[i]) / (self.high[i] - self.low[i]) * self.cells[i])
    }

    fn site(&self, uv: [f64; 2]) -> Site {
        let unit = RANGE as f64 / self.cells[0].max(self.cells[1]);
        self.in_cells(uv).map(|c| (c * unit).round() as i64)
    }

    /// The place at the given cells.
    fn place(&self, cells: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|i| self.low[i] + (self.high[i] - self.low[i]) * (cells[i] / self.cells[i]))
    }
}

/// Triangulates the surface within its outline.
pub(in crate::formats) fn build(drawing: &FairSurfaceDrawing) -> Mesh {
    let surface = &drawing.surface;
    let outline = Outline::of(drawing);
    let lattice = lattice(surface);
    let mut sites = Sites {
        lattice: &lattice,
        delaunay: Delaunay::new(),
        places: Vec::new(),
    };
    let mut border = Vec::new();
    for [a, b] in outline.edges() {
        sites.add_edge(a, b, &mut border);
    }
    for place in inner_places(&lattice, &outline) {
        sites.add(place);
    }
    sites.complete(border);
    let inside = |t: &[usize; 3]| {
        let [a, b, c] = t.map(|i| sites.places[i]);
        outline.contains([0, 1].map(|i| (a[i] + b[i] + c[i]) / 3.0))
    };
    let triangles = sites
        .delaunay
        .triangles()
        .into_iter()
        .filter(inside)
        .collect();
    lift(surface, &sites.places, triangles)
}

/// A lattice fine enough for the chordal error, within its bounds.
fn lattice(surface: &BSplineSurface) -> Lattice {
    let domains = [Axis::U, Axis::V].map(|axis| surface.domain(axis));
    let [low, high] = [0, 1].map(|end| domains.map(|d| d[end]));
    let tolerance = CHORDAL_SHARE * surface.bounding_box().diagonal();
    let step = |i: usize, k: usize| low[i] + (high[i] - low[i]) * (k as f64 / PROBES as f64);
    let (mut lengths, mut bends) = ([0.0_f64; 2], [0.0_f64; 2]);
    for i in 0..=PROBES {
        for j in 0..=PROBES {
            let jet = surface.derivatives(step(0, i), step(1, j));
            let along = [jet.du.norm(), jet.dv.norm()];
            let across = [jet.duu.norm(), jet.dvv.norm()];
            for axis in 0..2 {
                let width = high[axis] - low[axis];
                lengths[axis] = lengths[axis].max(along[axis] * width);
                bends[axis] = bends[axis].max(across[axis] * width * width);
            }
        }
    }
    // A chord over a piece of length h in the parameter leaves its arc by
    // |S''| h² / 8; half of the error for either direction.
    let needed = bends.map(|b| (b / (4.0 * tolerance)).sqrt());
    let usable = |n: f64| {
        if n.is_finite() {
            n.clamp(CELLS[0], CELLS[1])
        } else {
            CELLS[0]
        }
    };
    let cells = needed.map(usable);
    // Cells in one direction so many that they are not longer than the aspect
    // allows.
    let side = [0, 1].map(|i| lengths[i] / cells[i]);
    let cells = [0, 1].map(|i| usable(cells[i].max(lengths[i] / (ASPECT * side[1 - i])).ceil()));
    Lattice { low, high, cells }
}

/// Lattice points inside the outline and clear of it.
fn inner_places(lattice: &Lattice, outline: &Outline) -> Vec<[f64; 2]> {
    let edges: Vec<[[f64; 2]; 2]> = outline
        .edges()
        .map(|e| e.map(|end| lattice.in_cells(end)))
        .collect();
    let mut places = Vec::new();
    for i in 1..lattice.cells[0] as usize {
        for k in 1..lattice.cells[1] as usize {
            // To and fro, so that each site is near the one before.
            let j = if i % 2 == 0 {
                k
            } else {
                lattice.cells[1] as usize - k
            };
            let at = [i as f64, j as f64];
            let place = lattice.place(at);
            let is_clear = |e: &[[f64; 2]; 2]| distance_to_segment(at, *e) > CLEARANCE;
            if edges.iter().all(is_clear) && outline.contains(place) {
                places.push(place);
            }
        }
    }
    places
}

/// Sites of the triangulation and their places in (u, v).
struct Sites<'a> {
    lattice: &'a Lattice,
    delaunay: Delaunay,
    places: Vec<[f64; 2]>,
}

impl Sites<'_> {
    fn add(&mut self, place: [f64; 2]) -> usize {
        let number = self.delaunay.insert(self.lattice.site(place));
        if number == self.places.len() {
            self.places.push(place);
        }
        number
    }

    /// An edge of the outline in pieces of about a cell.
    fn add_edge(&mut self, a: [f64; 2], b: [f64; 2], border: &mut Vec<[usize; 2]>) {
        let [p, q] = [a, b].map(|end| self.lattice.in_cells(end));
        let pieces = (q[0] - p[0]).hypot(q[1] - p[1]).ceil().max(1.0);
        let mut last = self.add(a);
        for k in 1..=pieces as usize {
            let t = k as f64 / pieces;
            let next = self.add(if t < 1.0 { between(a, b, t) } else { b });
            if next != last {
                border.push([last, next]);
            }
            last = next;
        }
    }

    /// Halves the edges of the border that the triangulation lacks until it
    /// has them all.
    fn complete(&mut self, mut border: Vec<[usize; 2]>) {
        for _ in 0..ROUNDS {
            let mut present: Vec<[usize; 2]> = Vec::new();
            for [a, b, c] in self.delaunay.triangles() {
                present.extend([[a, b], [b, c], [c, a]].map(|[p, q]| [p.min(q), p.max(q)]));
            }
            present.sort_unstable();
            let (had, lacking): (Vec<_>, Vec<_>) = border
                .into_iter()
                .partition(|[a, b]| present.binary_search(&[*a.min(b), *a.max(b)]).is_ok());
            if lacking.is_empty() {
                return;
            }
            border = had;
            for [a, b] in lacking {
                let middle = self.add(between(self.places[a], self.places[b], 0.5));
                let halves = [[a, middle], [middle, b]];
                border.extend(halves.into_iter().filter(|[p, q]| p != q));
            }
        }
    }
}

fn between(a: [f64; 2], b: [f64; 2], t: f64) -> [f64; 2] {
    [0, 1].map(|i| a[i] + (b[i] - a[i]) * t)
}

/// Brings the triangles onto the surface; places that no triangle uses go.
fn lift(surface: &BSplineSurface, places: &[[f64; 2]], triangles: Vec<[usize; 3]>) -> Mesh {
    let points: Vec<Point3<f64>> = places.iter().map(|[u, v]| surface.point(*u, *v)).collect();
    let mut flat = vec![Vector3::zeros(); places.len()];
    let mut chordal_error = 0.0_f64;
    for t in &triangles {
        let [a, b, c] = t.map(|i| points[i]);
        let face = (b - a).cross(&(c - a));
        t.iter().for_each(|i| flat[*i] += face);
        chordal_error = chordal_error.max(leaves(surface, t.map(|i| places[i]), [a, b, c]));
    }
    let mut numbers = vec![usize::MAX; places.len()];
    let mut mesh = Mesh {
        vertices: Vec::new(),
        normals: Vec::new(),
        places: Vec::new(),
        triangles,
        chordal_error,
    };
    for t in &mut mesh.triangles {
        for corner in t {
            let [u, v] = places[*corner];
            if numbers[*corner] == usize::MAX {
                numbers[*corner] = mesh.vertices.len();
                mesh.vertices.push(points[*corner]);
                mesh.places.push([u, v]);
                // In a pole the triangles about it tell the normal.
                let about = || flat[*corner].try_normalize(0.0).unwrap_or_else(Vector3::z);
                mesh.normals
                    .push(surface.normal(u, v).unwrap_or_else(about));
            }
            *corner = numbers[*corner];
        }
    }
    mesh
}

/// How far the surface leaves a triangle at four places.
fn leaves(surface: &BSplineSurface, places: [[f64; 2]; 3], corners: [Point3<f64>; 3]) -> f64 {
    const THIRD: f64 = 1.0 / 3.0;
    let shares = [
        [0.5, 0.5, 0.0],
        [0.0, 0.5, 0.5],
        [0.5, 0.0, 0.5],
        [THIRD, THIRD, THIRD],
    ];
    let at = |share: [f64; 3]| {
        let [u, v] = [0, 1].map(|i| (0..3).map(|k| share[k] * places[k][i]).sum::<f64>());
        let flat: Vector3<f64> = (0..3).map(|k| corners[k].coords * share[k]).sum();
        (surface.point(u, v).coords - flat).norm()
    };
    shares.into_iter().map(at).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests;
