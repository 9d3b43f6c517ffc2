//! The bill of quantities: every arc of the net.

use super::line::lines;
use crate::methods::curvature_net::net::Net;
use crate::methods::curvature_net::request::Direction;

/// An arc from node to node.
#[derive(Debug, Clone, PartialEq)]
pub struct Member {
    /// Name of its line.
    pub line: String,
    /// Row and column of its two nodes.
    pub nodes: [[usize; 2]; 2],
    /// Radius; infinite for a straight one.
    pub radius: f64,
    /// Length.
    pub length: f64,
    /// Angle, radians.
    pub angle: f64,
    /// Angle between the normals of its nodes seen along its chord, radians:
    /// how much a straight beam between them would have to be twisted.
    pub torsion: f64,
}

/// Every arc, line by line, those along u first.
#[must_use]
pub fn bill(net: &Net) -> Vec<Member> {
    let node = |vertex: usize| [vertex / net.columns, vertex % net.columns];
    [Direction::U, Direction::V]
        .into_iter()
        .flat_map(|direction| lines(net.layout(), direction))
        .flat_map(|line| line.links(net).map(move |link| (line, link)))
        .map(|(line, link)| Member {
            line: line.name(),
            nodes: link.ends.map(node),
            radius: link.arc.radius(),
            length: link.arc.length(),
            angle: link.arc.angle(),
            torsion: torsion(net, link.ends),
        })
        .collect()
}

fn torsion(net: &Net, [from, to]: [usize; 2]) -> f64 {
    let e = (net.points[to] - net.points[from]).normalize();
    let [a, b] = [from, to].map(|i| {
        let n = net.normals[i];
        n - e * e.dot(&n)
    });
    e.dot(&a.cross(&b)).atan2(a.dot(&b))
}
