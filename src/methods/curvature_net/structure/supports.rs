//! Supports: strips along the normals of the lines.

use super::flat::{Piece, SAMPLES, Sheet, unroll};
use super::line::{Line, lines};
use crate::methods::curvature_net::net::Net;
use crate::methods::curvature_net::request::Direction;

/// The strip that stands on one line.
#[derive(Debug, Clone, PartialEq)]
pub struct Support {
    /// "u3": on the fourth line of direction u.
    pub name: String,
    /// Direction of the line.
    pub direction: Direction,
    /// Number of the line.
    pub line: usize,
    /// Its flat patterns; the line's left is the side of the normals.
    pub sheets: Vec<Sheet>,
    /// Arcs, by their number, whose centre of curvature lies within the
    /// height: there the strip folds over itself.
    pub folded: Vec<usize>,
}

/// Supports of a height along the normals (negative: against them) on all
/// lines of both directions.
#[must_use]
pub fn supports(net: &Net, height: f64) -> Vec<Support> {
    [Direction::U, Direction::V]
        .into_iter()
        .flat_map(|direction| lines(net.layout(), direction))
        .map(|line| support(net, line, height))
        .collect()
}

fn support(net: &Net, line: Line, height: f64) -> Support {
    let mut folded = Vec::new();
    let mut pieces = Vec::new();
    for link in line.links(net) {
        let bend = link.arc.curvature_vector().dot(&net.normals[link.ends[0]]);
        if bend * height >= 1.0 {
            folded.push(link.position);
        }
        pieces.push(Piece {
            length: link.arc.length(),
            bend,
            reach: [height.max(0.0), (-height).max(0.0)].map(|h| [h; SAMPLES + 1]),
        });
    }
    Support {
        name: line.name(),
        direction: line.direction,
        line: line.number,
        sheets: unroll(&pieces),
        folded,
    }
}
