//! Where the data are, in (u, v): a mask over a grid of nodes and the
//! polylines about it.
//!
//! Scattered points are counted in cells small enough to follow the border
//! and large enough that an evenly filled sheet leaves hardly any empty;
//! single gaps are closed (one dilation, one erosion). Grids use their own
//! cells. The polylines are the mask's contour (marching squares, saddles
//! joined).

use super::outcome::Outline;
use std::collections::BTreeMap;

/// Points that an evenly filled cell should have: e⁻⁸ of the cells are then
/// empty by chance.
const POINTS_A_CELL: f64 = 8.0;
/// Fewest and most cells along the longer side.
const CELLS: [f64; 2] = [3.0, 96.0];
/// Below so many points the region is their whole rectangle.
const FEWEST: usize = 60;

/// A mask over lines of constant u and v.
#[derive(Debug, Clone)]
pub(in super::super) struct Region {
    lines: [Vec<f64>; 2],
    inside: Vec<bool>,
    /// How far from an inside node towards an outside one the border is.
    border: f64,
    domain: [[f64; 2]; 2],
}

impl Region {
    /// Of a grid's lines; `present` by row, column fastest.
    pub(in super::super) fn of_grid(lines: &[Vec<f64>; 2], present: Vec<bool>) -> Self {
        let domain = [0, 1].map(|k| [lines[k][0], lines[k][lines[k].len() - 1]]);
        Region {
            lines: lines.clone(),
            inside: present,
            border: 0.0,
            domain,
        }
    }

    /// Of scattered places within a domain.
    pub(in super::super) fn of_points(at: &[[f64; 2]], domain: [[f64; 2]; 2]) -> Self {
        let domain = tight(at, domain);
        let length = domain.map(|[a, b]| (b - a).max(f64::MIN_POSITIVE));
        let longer = length[0].max(length[1]);
        let shape = length[0] * length[1] / (longer * longer);
        let wanted = (at.len() as f64 / (POINTS_A_CELL * shape)).sqrt();
        let whole = at.len() < FEWEST;
        let cells = if whole {
            1.0
        } else {
            wanted.clamp(CELLS[0], CELLS[1]).floor()
        };
        let size = length.map(|l| ((cells * l / longer).ceil() as usize).max(1));
        let mut inside = vec![whole; size[0] * size[1]];
        for p in at {
            let c = [0, 1].map(|k| cell(p[k], domain[k], size[k]));
            inside[c[0] * size[1] + c[1]] = true;
        }
        let inside = closed(&inside, size);
        let lines = [0, 1].map(|k| {
            let step = length[k] / size[k] as f64;
            (0..size[k])
                .map(|i| domain[k][0] + (i as f64 + 0.5) * step)
                .collect()
        });
        Region {
            lines,
            inside,
            border: 0.5,
            domain,
        }
    }

    /// The rectangle that holds it.
    pub(in super::super) fn domain(&self) -> [[f64; 2]; 2] {
        self.domain
    }

    /// Whether the node nearest to (u, v) is inside.
    pub(in super::super) fn contains(&self, at: [f64; 2]) -> bool {
        let nearest = |k: usize| {
            let lines = &self.lines[k];
            let i = lines.partition_point(|l| *l < at[k]);
            if i == 0 || (i < lines.len() && lines[i] - at[k] < at[k] - lines[i - 1]) {
                i
            } else {
                i - 1
            }
        };
        self.inside[nearest(0) * self.lines[1].len() + nearest(1)]
    }

    /// The largest piece with its holes, and how many pieces there are.
    pub(in super::super) fn outline(&self) -> (Outline, usize) {
        let mut loops = self.loops();
        loops.sort_by(|a, b| area(b).total_cmp(&area(a)));
        let pieces = loops.iter().filter(|l| area(l) > 0.0).count();
        let mut loops = loops.into_iter();
        let outer = loops.next().unwrap_or_default();
        let holes = loops.filter(|l| area(l) < 0.0).collect();
        (Outline { outer, holes }, pieces)
    }

    fn value(&self, i: i64, j: i64) -> bool {
        let [nu, nv] = [0, 1].map(|k| self.lines[k].len() as i64);
        (0..nu).contains(&i) && (0..nv).contains(&j) && self.inside[(i * nv + j) as usize]
    }

    fn line(&self, k: usize, i: i64) -> f64 {
        let lines = &self.lines[k];
        let last = lines.len() as i64 - 1;
        // One line more on each side, beyond which nothing is.
        let step = if last > 0 {
            lines[1] - lines[0]
        } else {
            self.domain[k][1] - self.domain[k][0]
        };
        if i < 0 {
            lines[0] - step
        } else if i > last {
            lines[last as usize] + step
        } else {
            lines[i as usize]
        }
    }

    /// Contours of the mask, the inside on their left.
    fn loops(&self) -> Vec<Vec<[f64; 2]>> {
        let mut next: BTreeMap<Edge, Edge> = BTreeMap::new();
        let [nu, nv] = [0, 1].map(|k| self.lines[k].len() as i64);
        for i in -1..nu {
            for j in -1..nv {
                self.square(i, j, &mut next);
            }
        }
        let mut loops = Vec::new();
        while let Some((start, _)) = next.first_key_value() {
            let start = *start;
            let (mut edge, mut points) = (start, Vec::new());
            while let Some(to) = next.remove(&edge) {
                points.push(self.crossing(edge));
                edge = to;
            }
            loops.push(points);
        }
        loops
    }

    /// Segments of the square with its low corner at (i, j).
    fn square(&self, i: i64, j: i64, next: &mut BTreeMap<Edge, Edge>) {
        let corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)];
        let edges = [(i, j, 0), (i + 1, j, 1), (i, j + 1, 0), (i, j, 1)];
        let inside = corners.map(|(a, b)| self.value(a, b));
        // Anticlockwise about the square: the contour enters where an edge
        // goes from inside to outside, and leaves at the next that goes back.
        for from in 0..4 {
            if inside[from] && !inside[(from + 1) % 4] {
                let back = (1..4).map(|k| (from + k) % 4);
                let to = back
                    .into_iter()
                    .find(|k| !inside[*k] && inside[(k + 1) % 4]);
                if let Some(to) = to {
                    next.insert(edges[from], edges[to]);
                }
            }
        }
    }

    /// Where the border crosses an edge.
    fn crossing(&self, (i, j, k): Edge) -> [f64; 2] {
        let a = [self.line(0, i), self.line(1, j)];
        let b = if k == 0 {
            [self.line(0, i + 1), a[1]]
        } else {
            [a[0], self.line(1, j + 1)]
        };
        let t = if self.value(i, j) {
            self.border
        } else {
            1.0 - self.border
        };
        let domain = self.domain;
        [0, 1].map(|k| (a[k] + t * (b[k] - a[k])).clamp(domain[k][0], domain[k][1]))
    }
}

/// Low end and direction (0: u, 1: v) of an edge between nodes.
type Edge = (i64, i64, u8);

fn cell(x: f64, [a, b]: [f64; 2], count: usize) -> usize {
    let t = (x - a) / (b - a).max(f64::MIN_POSITIVE);
    ((t * count as f64) as usize).min(count - 1)
}

/// The rectangle of the places, within the domain.
fn tight(at: &[[f64; 2]], domain: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
    [0, 1].map(|k| {
        let low = at.iter().map(|p| p[k]).fold(f64::INFINITY, f64::min);
        let high = at.iter().map(|p| p[k]).fold(f64::NEG_INFINITY, f64::max);
        [low.max(domain[k][0]), high.min(domain[k][1])]
    })
}

/// One dilation and one erosion.
fn closed(mask: &[bool], [nu, nv]: [usize; 2]) -> Vec<bool> {
    let at = |m: &[bool], i: i64, j: i64| {
        let ok = (0..nu as i64).contains(&i) && (0..nv as i64).contains(&j);
        ok.then(|| m[(i as usize) * nv + j as usize])
    };
    let around = |m: &[bool], k: usize| {
        let (i, j) = ((k / nv) as i64, (k % nv) as i64);
        [(0, 0), (1, 0), (-1, 0), (0, 1), (0, -1)].map(|(a, b)| at(m, i + a, j + b))
    };
    let grown: Vec<bool> = (0..mask.len())
        .map(|k| around(mask, k).contains(&Some(true)))
        .collect();
    (0..mask.len())
        .map(|k| !around(&grown, k).contains(&Some(false)))
        .collect()
}

/// Twice the signed area.
fn area(polyline: &[[f64; 2]]) -> f64 {
    let n = polyline.len();
    (0..n)
        .map(|i| {
            let (a, b) = (polyline[i], polyline[(i + 1) % n]);
            a[0] * b[1] - a[1] * b[0]
        })
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ring_has_an_outline_and_a_hole() {
        let mut at = Vec::new();
        for i in 0..200 {
            for j in 0..200 {
                let p = [i as f64 / 199.0, j as f64 / 199.0];
                if (p[0] - 0.5).hypot(p[1] - 0.5) > 0.2 {
                    at.push(p);
                }
            }
        }
        let region = Region::of_points(&at, [[-1.0, 2.0], [-1.0, 2.0]]);
        let (outline, pieces) = region.outline();
        assert_eq!((pieces, outline.holes.len()), (1, 1));
        assert!((area(&outline.outer) / 2.0 - 1.0).abs() < 0.03);
        let hole = -area(&outline.holes[0]) / 2.0;
        let want = std::f64::consts::PI * 0.04;
        assert!((hole - want).abs() < 0.25 * want, "{hole} for {want}");
        assert!(!region.contains([0.5, 0.5]) && region.contains([0.1, 0.1]));
    }

    #[test]
    fn a_full_grid_is_its_rectangle() {
        let lines = [vec![0.0, 1.0, 3.0], vec![0.0, 2.0]];
        let (outline, pieces) = Region::of_grid(&lines, vec![true; 6]).outline();
        assert_eq!(pieces, 1);
        assert!((area(&outline.outer) - 12.0).abs() < 1e-12);
        assert!(outline.holes.is_empty());
    }
}
