//! A line of the net: its vertices in order and the arcs between them.

use crate::geometry::CircularArc;
use crate::methods::curvature_net::net::{Layout, Net};
use crate::methods::curvature_net::request::Direction;
use nalgebra::Vector3;

/// One line of the net.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Line {
    pub direction: Direction,
    /// Its number among the lines of its direction.
    pub number: usize,
}

/// An arc of a line, from vertex to vertex.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Link {
    /// Its number along the line.
    pub position: usize,
    /// The vertices.
    pub ends: [usize; 2],
    pub arc: CircularArc,
}

/// All lines of a direction.
pub(super) fn lines(layout: Layout, direction: Direction) -> impl Iterator<Item = Line> {
    let count = match direction {
        Direction::U => layout.columns,
        Direction::V => layout.rows,
    };
    (0..count).map(move |number| Line { direction, number })
}

impl Line {
    /// "u3": the fourth line along u.
    pub fn name(&self) -> String {
        let word = match self.direction {
            Direction::U => "u",
            Direction::V => "v",
        };
        format!("{word}{}", self.number)
    }

    /// Its arcs in order; two vertices in one place have none.
    pub fn links(self, net: &Net) -> impl Iterator<Item = Link> {
        let layout = net.layout();
        let axis = self.axis();
        (0..layout.patch_counts()[axis]).filter_map(move |position| {
            let at = |along: usize| match self.direction {
                Direction::U => layout.vertex(along, self.number),
                Direction::V => layout.vertex(self.number, along),
            };
            let ends = [at(position), at(position + 1)];
            let [from, to] = ends.map(|i| net.points[i]);
            let arc = CircularArc::new(from, net.tangents[ends[0]][axis], to)?;
            Some(Link {
                position,
                ends,
                arc,
            })
        })
    }

    /// Index of its tangent among those of a vertex.
    pub fn axis(&self) -> usize {
        match self.direction {
            Direction::U => 0,
            Direction::V => 1,
        }
    }

    /// The unit tangent plane vector to its left, seen from the tip of the
    /// normal.
    pub fn left(&self, net: &Net, vertex: usize) -> Vector3<f64> {
        let [u, v] = net.tangents[vertex];
        match self.direction {
            Direction::U => v,
            Direction::V => -u,
        }
    }
}
