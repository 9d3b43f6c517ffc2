//! Rows and columns of a quad mesh, found from what meets where.
//!
//! A surface of quads is a regular net if every inner vertex has four faces
//! and its boundary is straight: a disc with four corners, a tube with none, or
//! a torus. Crossing a face from side to opposite side then leads along a row
//! or a column; numbering is following them.
//!
//! The numbering is fixed by the order of the vertices alone: it starts at the
//! smallest index of a corner (of the boundary of a tube, of all vertices of a
//! torus), and rows run to the smaller of its neighbours. So a mesh that is
//! listed row by row keeps its rows and columns. Rows follow each other to the
//! side that makes u × v the side from which the faces run counterclockwise;
//! where that is against the start, the rows are numbered backwards.

mod fault;
#[cfg(test)]
mod tests;

use super::Manifold;
pub use fault::QuadGridFault;

/// Where the vertices of a mesh stand in its net.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct QuadGrid {
    /// Number of rows of vertices; u runs from row to row.
    pub rows: usize,
    /// Number of vertices in a row; v runs along a row.
    pub columns: usize,
    /// Whether the last row is followed by the first, the last vertex of a row
    /// by its first.
    pub closed: [bool; 2],
    /// Index of the vertex in each place of the net, row after row.
    pub vertices: Vec<usize>,
}

/// A face seen in the net: its corners at (0, 0), (1, 0), (1, 1), (0, 1) in
/// (u, v).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Frame {
    face: usize,
    corners: [usize; 4],
}

impl QuadGrid {
    /// Finds rows and columns.
    ///
    /// # Errors
    /// The first [`QuadGridFault`] in the order of its variants.
    pub fn of(surface: &Manifold) -> Result<QuadGrid, QuadGridFault> {
        faces_are_quads(surface)?;
        let corners = regular_corners(surface)?;
        let walker = Walker { surface };
        let Some(start) = walker.start(&corners) else {
            return Err(QuadGridFault::Corners { corners, wanted: 4 });
        };
        let grid = walker.number(start)?;
        Ok(if walker.is_backwards(start) {
            grid.with_rows_backwards()
        } else {
            grid
        })
    }

    /// The same net, its rows in the opposite order; the first row stays first
    /// where rows close.
    fn with_rows_backwards(self) -> QuadGrid {
        let row = |i: usize| match (self.closed[0], i) {
            (true, 0) => 0,
            (true, i) => self.rows - i,
            (false, i) => self.rows - 1 - i,
        };
        let columns = self.columns;
        let place = |k: usize| self.vertices[row(k / columns) * columns + k % columns];
        QuadGrid {
            vertices: (0..self.vertices.len()).map(place).collect(),
            ..self
        }
    }
}

fn faces_are_quads(surface: &Manifold) -> Result<(), QuadGridFault> {
    for (face, f) in surface.mesh().faces().iter().enumerate() {
        let corners = f.corners().len();
        if corners != 4 {
            return Err(QuadGridFault::NotAQuad { face, corners });
        }
    }
    let parts = surface.component_count();
    match surface.components().iter().position(|part| *part == 1) {
        Some(face) => Err(QuadGridFault::Parts { parts, face }),
        None => Ok(()),
    }
}

/// The corners of a surface whose vertices are all as in a net.
fn regular_corners(surface: &Manifold) -> Result<Vec<usize>, QuadGridFault> {
    let loops = surface.boundary_loops();
    let mut on_boundary = vec![false; surface.mesh().vertices().len()];
    for vertex in loops.iter().flatten() {
        on_boundary[*vertex] = true;
    }
    let (mut singular, mut ragged, mut corners) = (Vec::new(), Vec::new(), Vec::new());
    for (vertex, on_boundary) in on_boundary.iter().enumerate() {
        match (
            surface.topology().faces_at_vertex(vertex).len(),
            on_boundary,
        ) {
            (0 | 4, false) | (2, true) => {}
            (faces, false) => singular.push((vertex, faces)),
            (1, true) => corners.push(vertex),
            (faces, true) => ragged.push((vertex, faces)),
        }
    }
    if !singular.is_empty() {
        return Err(QuadGridFault::Singular { vertices: singular });
    }
    if !ragged.is_empty() {
        return Err(QuadGridFault::Ragged { vertices: ragged });
    }
    if loops.len() > 2 {
        let starts = loops.iter().map(|ring| ring[0]).collect();
        return Err(QuadGridFault::Loops { starts });
    }
    let wanted = if loops.len() == 1 { 4 } else { 0 };
    if corners.len() != wanted {
        return Err(QuadGridFault::Corners { corners, wanted });
    }
    Ok(corners)
}

struct Walker<'a> {
    surface: &'a Manifold,
}

impl Walker<'_> {
    /// The first face as it stands in the net.
    fn start(&self, corners: &[usize]) -> Option<Frame> {
        let border = self.surface.boundary_loops().iter().flatten().min();
        let mut all = self.surface.mesh().faces().iter().flat_map(|f| f.corners());
        let first = match corners.first().or(border) {
            Some(first) => *first,
            None => all.by_ref().copied().min()?,
        };
        let faces = self.surface.topology().faces_at_vertex(first);
        let seen = faces.iter().flat_map(|face| {
            let corners = self.surface.mesh().faces()[*face].corners();
            let at = corners.iter().position(|c| *c == first).unwrap_or(0);
            let [a, b, c, d] = [0, 1, 2, 3].map(|k| corners[(at + k) % 4]);
            [[a, b, c, d], [a, d, c, b]].map(|corners| Frame {
                face: *face,
                corners,
            })
        });
        seen.min_by_key(|f| (f.corners[3], f.corners[1]))
    }

    /// Whether the faces run clockwise as seen from u × v.
    fn is_backwards(&self, frame: Frame) -> bool {
        let mut sides = self.surface.mesh().faces()[frame.face].sides();
        !sides.any(|side| side == (frame.corners[0], frame.corners[1]))
    }

    /// Rows of faces one after the other, each followed along v.
    fn number(&self, start: Frame) -> Result<QuadGrid, QuadGridFault> {
        let mut vertices = Vec::new();
        let (mut rows, mut frame) = (0, start);
        let mut shape: Option<(usize, bool)> = None;
        let closes = loop {
            let row = self.row(frame)?;
            let row_shape = (row.lower.len(), row.closed);
            if *shape.get_or_insert(row_shape) != row_shape {
                return Err(QuadGridFault::Spiral {
                    vertex: frame.corners[0],
                });
            }
            vertices.extend(row.lower);
            rows += 1;
            let [_, b, c, _] = frame.corners;
            match self.across(frame, [b, c]) {
                None => {
                    vertices.extend(row.upper);
                    rows += 1;
                    break false;
                }
                Some((face, _)) if face == start.face && b == start.corners[0] => break true,
                Some((face, [b_on, c_on])) => {
                    frame = Frame {
                        face,
                        corners: [b, b_on, c_on, c],
                    };
                }
            }
            if vertices.len() > self.surface.mesh().vertices().len() {
                return Err(QuadGridFault::Spiral {
                    vertex: start.corners[0],
                });
            }
        };
        let (columns, row_closes) = shape.unwrap_or_default();
        let grid = QuadGrid {
            rows,
            columns,
            closed: [closes, row_closes],
            vertices,
        };
        grid.with_long_rounds()
    }

    /// The faces of a row from a first one on, to the end of the row or once
    /// round.
    fn row(&self, first: Frame) -> Result<Row, QuadGridFault> {
        let [a, b, ..] = first.corners;
        let (mut lower, mut upper) = (vec![a], vec![b]);
        let mut frame = first;
        loop {
            let [_, _, c, d] = frame.corners;
            if d == a && c == b {
                return Ok(Row {
                    lower,
                    upper,
                    closed: true,
                });
            }
            lower.push(d);
            upper.push(c);
            if lower.len() > self.surface.mesh().faces().len() + 1 {
                return Err(QuadGridFault::Spiral { vertex: a });
            }
            let Some((face, [d_on, c_on])) = self.across(frame, [d, c]) else {
                return Ok(Row {
                    lower,
                    upper,
                    closed: false,
                });
            };
            frame = Frame {
                face,
                corners: [d, c, c_on, d_on],
            };
        }
    }

    /// The face beyond a side of a face, and the corners that follow the ends
    /// of that side in it.
    fn across(&self, frame: Frame, [p, q]: [usize; 2]) -> Option<(usize, [usize; 2])> {
        let topology = self.surface.topology();
        let faces = topology.faces_at_edge(topology.edge_between(p, q)?);
        let face = faces.iter().copied().find(|f| *f != frame.face)?;
        let corners = self.surface.mesh().faces()[face].corners();
        let beside = |v: usize, not: usize| {
            let at = corners.iter().position(|c| *c == v)?;
            let sides = [corners[(at + 1) % 4], corners[(at + 3) % 4]];
            sides.into_iter().find(|c| *c != not)
        };
        Some((face, [beside(p, q)?, beside(q, p)?]))
    }
}

/// The vertices on both sides of a row of faces.
struct Row {
    lower: Vec<usize>,
    upper: Vec<usize>,
    closed: bool,
}

/// With fewer faces a closed row folds onto itself.
const SHORTEST_ROUND: usize = 3;

impl QuadGrid {
    fn with_long_rounds(self) -> Result<QuadGrid, QuadGridFault> {
        for (closed, count) in self.closed.into_iter().zip([self.rows, self.columns]) {
            if closed && count < SHORTEST_ROUND {
                let vertex = self.vertices[0];
                return Err(QuadGridFault::Short { vertex, count });
            }
        }
        Ok(self)
    }
}
