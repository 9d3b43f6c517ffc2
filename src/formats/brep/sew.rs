//! Faces out of surfaces, sewn along shared boundaries.
//!
//! 0. A part of a surface is a face whose sides are its outline.
//! 1. A whole surface is cut where it has a knot as multiple as its degree: there it
//!    may have a crease, and a fan begins, whose side on the apex is a point.
//! 2. Corners within [`WELD`] of the model's size become one vertex.
//! 3. A side is cut at every vertex that lies on it, so that the joins of one
//!    plate divide the chine for its neighbour too.
//! 4. Two pieces of sides with the same end vertices are one edge if they run
//!    within the same distance of each other.
//! 5. Faces that share edges are turned until every edge is run through once
//!    in each direction, and gathered into shells.
//!
//! A fit may leave a fan of no width: what is narrower than that distance has
//! no face, and its two sides are one edge of the neighbours.
//!
//! Limits: an edge joins two faces; a third brings an edge of its own.

use super::{Bound, Sheet, bounds};
use crate::geometry::{Axis, BSplineCurve, BSplineSurface, BoundingBox, CurveIndex};
use nalgebra::Point3;
use std::collections::{BTreeMap, VecDeque};

/// Places nearer than this share of the model's longest side are one: far
/// above what a fit leaves between neighbours (1e-8), far below what a yard or
/// a CAD kernel (1e-6) tells apart.
pub(in crate::formats) const WELD: f64 = 1e-7;

/// Places at which two sides are compared.
const COMPARED: usize = 9;

/// An edge: a curve between two vertices.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::formats) struct Edge {
    /// Start and end, as indices of vertices.
    pub ends: [usize; 2],
    /// The curve from start to end.
    pub curve: BSplineCurve,
    /// The same in the parameters of the face that it is an outline of, as x and
    /// y; none along the sides of a surface, nor along a straight line.
    pub under: Option<BSplineCurve>,
}

/// How a loop runs through an edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::formats) struct EdgeUse {
    /// Index of the edge.
    pub edge: usize,
    /// Whether from its start to its end.
    pub forward: bool,
}

/// A face: a surface, or a part of it, with its outer loop.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::formats) struct Face {
    /// Name of the surface that it is cut from.
    pub name: String,
    /// The surface.
    pub surface: BSplineSurface,
    /// The loop, counter-clockwise round the face's normal.
    pub bound: Vec<EdgeUse>,
    /// Whether the face's normal is that of the surface, `du × dv`.
    pub same_sense: bool,
}

/// Faces, edges and vertices of a model.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::formats) struct Sewn {
    /// Vertices.
    pub vertices: Vec<Point3<f64>>,
    /// Edges.
    pub edges: Vec<Edge>,
    /// Faces.
    pub faces: Vec<Face>,
    /// Faces that hang together, as indices.
    pub shells: Vec<Vec<usize>>,
    /// The distance within which places are one, in the model's unit.
    pub weld: f64,
}

/// Sews sheets. A side that is a point has no edge; a surface of which nothing
/// but points is left has no face.
pub(in crate::formats) fn sew(sheets: &[Sheet]) -> Sewn {
    let points = sheets.iter().flat_map(|s| s.surface.control_points());
    let size = BoundingBox::of(points).map_or(0.0, |b| b.longest_side());
    let weld = WELD * size;
    let parts: Vec<Part> = sheets.iter().flat_map(|s| parts(s, weld)).collect();
    let mut corners = Vertices::new(weld);
    for side in parts.iter().flat_map(|p| &p.sides) {
        corners.index_of(&side.curve.start());
        corners.index_of(&side.curve.end());
    }
    let mut edges = Edges::default();
    let mut faces = Vec::new();
    for part in parts {
        let pieces = part.sides.iter().flat_map(|s| corners.pieces(s));
        let bound: Vec<EdgeUse> = pieces.map(|piece| edges.take(piece, weld)).collect();
        if !bound.is_empty() {
            faces.push(Face {
                name: part.name.to_owned(),
                surface: part.surface,
                bound,
                same_sense: true,
            });
        }
    }
    let shells = orient(&mut faces, edges.list.len());
    Sewn {
        vertices: corners.points,
        edges: edges.list,
        faces,
        shells,
        weld,
    }
}

/// What becomes one face.
struct Part<'a> {
    name: &'a str,
    surface: BSplineSurface,
    /// In the order and direction of the loop round `du × dv`.
    sides: Vec<Side>,
}

/// A side of a face: in space and, of an outline, in the surface's parameters.
struct Side {
    curve: BSplineCurve,
    under: Option<BSplineCurve>,
}

/// The part of a surface that is meant, or the whole, cut where it has creases.
fn parts(sheet: &Sheet, weld: f64) -> Vec<Part<'_>> {
    let name = sheet.name.as_str();
    let bounds = bounds(sheet);
    if !bounds.is_empty() {
        let seen = |b: &Bound| b.curve.bounding_box().diagonal() > weld;
        let side = |b: Bound| Side {
            under: (b.curve.degree() > 1).then_some(b.under),
            curve: b.curve,
        };
        return vec![Part {
            name,
            surface: sheet.surface.clone(),
            sides: bounds.into_iter().filter(seen).map(side).collect(),
        }];
    }
    let whole = |surface: BSplineSurface| Part {
        name,
        sides: (sides(&surface, weld).into_iter())
            .map(|curve| Side { curve, under: None })
            .collect(),
        surface,
    };
    patches(&sheet.surface).into_iter().map(whole).collect()
}

/// A surface cut at the knots where it may have a crease, along u, then v.
fn patches(surface: &BSplineSurface) -> Vec<BSplineSurface> {
    let along_u = cut(surface.clone(), Axis::U);
    along_u.into_iter().flat_map(|s| cut(s, Axis::V)).collect()
}

fn cut(surface: BSplineSurface, axis: Axis) -> Vec<BSplineSurface> {
    let knots = surface.knot_vector(axis);
    let [first, last] = knots.domain();
    let inner = (knots.distinct().into_iter())
        .filter(|(u, count)| *count >= knots.degree() && first < *u && *u < last);
    let mut rest = surface;
    let mut patches = Vec::new();
    for (u, _) in inner {
        // A knot inside the domain splits; were it refused, the crease would
        // merely stay inside its face.
        if let Ok((before, after)) = rest.split(axis, u) {
            patches.push(before);
            rest = after;
        }
    }
    patches.push(rest);
    patches
}

/// The four sides in the order and direction of the loop round `du × dv`,
/// without those that are points; none of a sliver between two sides that run
/// back along each other.
fn sides(surface: &BSplineSurface, weld: f64) -> Vec<BSplineCurve> {
    let [v_first, v_last, u_first, u_last] = surface.boundary_curves();
    let sides: Vec<BSplineCurve> = [v_first, u_last, v_last.reversed(), u_first.reversed()]
        .into_iter()
        .filter(|side| side.bounding_box().diagonal() > weld)
        .collect();
    match &sides[..] {
        [there, back] if is_run_back(there, back, weld) => Vec::new(),
        _ => sides,
    }
}

fn is_run_back(there: &BSplineCurve, back: &BSplineCurve, weld: f64) -> bool {
    let at = |curve: &BSplineCurve, share: f64| {
        let [first, last] = curve.domain();
        curve.point(first + (last - first) * share)
    };
    (0..COMPARED).all(|k| {
        let share = k as f64 / (COMPARED - 1) as f64;
        (at(there, share) - at(back, 1.0 - share)).norm() <= weld
    })
}

/// Vertices, found by the cell in which they lie.
struct Vertices {
    points: Vec<Point3<f64>>,
    cells: BTreeMap<[i64; 3], Vec<usize>>,
    /// By the first coordinate, for the search along a side.
    by_x: BTreeMap<(i64, usize), ()>,
    weld: f64,
}

impl Vertices {
    fn new(weld: f64) -> Self {
        Vertices {
            points: Vec::new(),
            cells: BTreeMap::new(),
            by_x: BTreeMap::new(),
            // A model that is one point has one cell.
            weld: weld.max(f64::MIN_POSITIVE),
        }
    }

    #[allow(clippy::cast_possible_truncation)] // Saturates, as a cell may.
    fn cell(&self, point: &Point3<f64>) -> [i64; 3] {
        [0, 1, 2].map(|i| (point[i] / self.weld).floor() as i64)
    }

    /// The vertex at a place, a new one if there is none.
    fn index_of(&mut self, point: &Point3<f64>) -> usize {
        let cell = self.cell(point);
        if let Some(known) = self.known(point, cell) {
            return known;
        }
        let index = self.points.len();
        self.points.push(*point);
        self.cells.entry(cell).or_default().push(index);
        self.by_x.insert((cell[0], index), ());
        index
    }

    fn known(&self, point: &Point3<f64>, cell: [i64; 3]) -> Option<usize> {
        let near = (0..27).map(|k| [k % 3, k / 3 % 3, k / 9].map(|d| d - 1));
        let cells = near.map(|d: [i64; 3]| [0, 1, 2].map(|i| cell[i].saturating_add(d[i])));
        cells
            .filter_map(|cell| self.cells.get(&cell))
            .flatten()
            .copied()
            .filter(|i| (self.points[*i] - point).norm() <= self.weld)
            .min()
    }

    /// A side cut at the vertices on it, with the vertices of each piece.
    fn pieces(&mut self, side: &Side) -> Vec<Edge> {
        let start = self.index_of(&side.curve.start());
        let end = self.index_of(&side.curve.end());
        let mut rest = side.curve.clone();
        let mut under = side.under.clone();
        let mut from = start;
        let mut pieces = Vec::new();
        for (u, vertex) in self.on_side(&side.curve, [start, end]) {
            let below = under.as_ref().map(|curve| curve.split(u)).transpose();
            if let (Ok((before, after)), Ok(below)) = (rest.split(u), below) {
                let (first, second) = below.unzip();
                pieces.push(Edge {
                    ends: [from, vertex],
                    curve: before,
                    under: first,
                });
                (rest, under, from) = (after, second, vertex);
            }
        }
        pieces.push(Edge {
            ends: [from, end],
            curve: rest,
            under,
        });
        pieces
    }

    /// Vertices strictly inside a side, with their parameters, in order.
    fn on_side(&self, side: &BSplineCurve, ends: [usize; 2]) -> Vec<(f64, usize)> {
        let bounds = side.bounding_box();
        let low = self.cell(&bounds.min)[0].saturating_sub(1);
        let high = self.cell(&bounds.max)[0].saturating_add(1);
        let inside = |i: usize| {
            let point = &self.points[i];
            !ends.contains(&i)
                && (0..3).all(|k| {
                    bounds.min[k] - self.weld <= point[k] && point[k] <= bounds.max[k] + self.weld
                })
        };
        let near: Vec<usize> = (self.by_x.range((low, 0)..=(high, usize::MAX)))
            .map(|((_, i), ())| *i)
            .filter(|i| inside(*i))
            .collect();
        if near.is_empty() {
            return Vec::new();
        }
        let index = CurveIndex::new(side);
        let mut found: Vec<(f64, usize)> = near
            .into_iter()
            .map(|i| (index.closest(&self.points[i]), i))
            .filter(|(foot, _)| foot.distance <= self.weld)
            .map(|(foot, i)| (foot.parameter, i))
            .collect();
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        found
    }
}

/// Edges, found by their end vertices.
#[derive(Default)]
struct Edges {
    list: Vec<Edge>,
    uses: Vec<usize>,
    by_ends: BTreeMap<[usize; 2], Vec<usize>>,
}

impl Edges {
    /// The edge of a piece of a side: one that is there already, or a new one.
    fn take(&mut self, piece: Edge, weld: f64) -> EdgeUse {
        let key = [
            piece.ends[0].min(piece.ends[1]),
            piece.ends[0].max(piece.ends[1]),
        ];
        let candidates = self.by_ends.entry(key).or_default();
        for edge in candidates.iter().copied() {
            if self.uses[edge] < 2
                && let Some(forward) = runs_along(&self.list[edge], &piece, weld)
            {
                self.uses[edge] += 1;
                return EdgeUse { edge, forward };
            }
        }
        let edge = self.list.len();
        candidates.push(edge);
        self.list.push(piece);
        self.uses.push(1);
        EdgeUse {
            edge,
            forward: true,
        }
    }
}

/// Whether a piece runs along an edge, and then, whether forward.
fn runs_along(edge: &Edge, piece: &Edge, weld: f64) -> Option<bool> {
    let index = CurveIndex::new(&edge.curve);
    let [first, last] = piece.curve.domain();
    let mut feet = Vec::with_capacity(COMPARED);
    for k in 1..=COMPARED {
        #[allow(clippy::cast_precision_loss)] // A handful.
        let share = k as f64 / (COMPARED + 1) as f64;
        let foot = index.closest(&piece.curve.point(first + share * (last - first)));
        if foot.distance > weld {
            return None;
        }
        feet.push(foot.parameter);
    }
    Some(if edge.ends[0] == edge.ends[1] {
        // A closed edge: its ends do not tell.
        feet[COMPARED - 1] > feet[0]
    } else {
        edge.ends == piece.ends
    })
}

/// Turns faces until neighbours agree, and gathers them into shells. Where
/// they cannot agree (a Möbius band) some edge is run through twice in one
/// direction, which is the truth.
fn orient(faces: &mut [Face], edges: usize) -> Vec<Vec<usize>> {
    let mut users: Vec<Vec<usize>> = vec![Vec::new(); edges];
    for (i, face) in faces.iter().enumerate() {
        for user in &face.bound {
            users[user.edge].push(i);
        }
    }
    let mut shell_of = vec![usize::MAX; faces.len()];
    let mut shells: Vec<Vec<usize>> = Vec::new();
    for seed in 0..faces.len() {
        if shell_of[seed] != usize::MAX {
            continue;
        }
        shell_of[seed] = shells.len();
        let mut shell = Vec::new();
        let mut waiting = VecDeque::from([seed]);
        while let Some(i) = waiting.pop_front() {
            shell.push(i);
            for user in faces[i].bound.clone() {
                for j in users[user.edge].iter().copied() {
                    if shell_of[j] == usize::MAX {
                        shell_of[j] = shells.len();
                        let same = |u: &EdgeUse| u.edge == user.edge && u.forward == user.forward;
                        if faces[j].bound.iter().any(same) {
                            turn(&mut faces[j]);
                        }
                        waiting.push_back(j);
                    }
                }
            }
        }
        shell.sort_unstable();
        shells.push(shell);
    }
    shells
}

/// Turns a face over.
fn turn(face: &mut Face) {
    face.same_sense = !face.same_sense;
    face.bound.reverse();
    for user in &mut face.bound {
        user.forward = !user.forward;
    }
}

#[cfg(test)]
mod tests;
