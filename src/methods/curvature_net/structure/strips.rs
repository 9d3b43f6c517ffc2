//! Conical strips along the lines of the net.

use super::flat::{Piece, SAMPLES, Sheet, unroll};
use super::line::{Line, Link, lines};
use crate::geometry::{Axis, CircularArc, CyclidePatch};
use crate::methods::curvature_net::net::Net;
use crate::methods::curvature_net::request::Direction;
use crate::numerics::sinc;
use nalgebra::{Point3, Vector3};

/// The developable that touches the surface along one line.
#[derive(Debug, Clone, PartialEq)]
pub struct Strip {
    /// "u3": along the fourth line of direction u.
    pub name: String,
    /// Direction of the line.
    pub direction: Direction,
    /// Number of the line.
    pub line: usize,
    /// One piece an arc, in order.
    pub cones: Vec<Cone>,
    /// Its flat patterns.
    pub sheets: Vec<Sheet>,
}

/// What a piece of a strip is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ConeKind {
    /// A cone of revolution.
    Cone,
    /// A cylinder of revolution.
    Cylinder,
    /// A plane.
    Plane,
}

/// A piece of a strip, from vertex to vertex.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cone {
    /// What it is, to a millionth of a radian across the strip.
    pub kind: ConeKind,
    /// The vertices of its arc.
    pub ends: [usize; 2],
    /// The arc in which it touches the surface.
    pub arc: CircularArc,
    /// The unit ruling at the arc's start, to the left of the arc.
    pub ruling: Vector3<f64>,
    /// 1 / signed distance of the apex along that ruling; 0 for a cylinder.
    pub bend: f64,
    /// The arc's curvature along the surface normal; 0 for a plane.
    pub normal_curvature: f64,
    /// Ends of the rulings at 0 … [`SAMPLES`] equal shares of the arc: left,
    /// then right.
    pub edges: [[Point3<f64>; SAMPLES + 1]; 2],
}

impl Cone {
    /// Its apex; none for a cylinder.
    #[must_use]
    pub fn apex(&self) -> Option<Point3<f64>> {
        let apex = self.arc.start() + self.ruling / self.bend;
        apex.iter().all(|x| x.is_finite()).then_some(apex)
    }

    /// Half the angle at its apex, radians: 0 for a cylinder, π/2 for a plane.
    #[must_use]
    pub fn half_angle(&self) -> f64 {
        self.bend.abs().atan2(self.normal_curvature.abs())
    }
}

/// The strips along all lines of a direction; `patches` are those of the net,
/// row after row, none for quads that have no patch.
#[must_use]
pub fn strips(net: &Net, patches: &[Option<CyclidePatch>], direction: Direction) -> Vec<Strip> {
    let strip = |line: Line| {
        let cones: Vec<Cone> = line
            .links(net)
            .map(|link| cone(net, patches, line, &link))
            .collect();
        let pieces: Vec<Piece> = cones.iter().map(piece).collect();
        Strip {
            name: line.name(),
            direction,
            line: line.number,
            sheets: unroll(&pieces),
            cones,
        }
    };
    lines(net.layout(), direction).map(strip).collect()
}

/// A piece whose rulings and normals turn by less than this is what it seems.
const FLAT: f64 = 1e-6;

fn cone(net: &Net, patches: &[Option<CyclidePatch>], line: Line, link: &Link) -> Cone {
    let start = link.ends[0];
    let curvature = link.arc.curvature_vector();
    let ruling = line.left(net, start);
    let (bend, normal_curvature) = (curvature.dot(&ruling), curvature.dot(&net.normals[start]));
    let edges = beside(net, line, link.position).map(|side| {
        let patch = side.and_then(|(index, side)| Some((patches[index].as_ref()?, side)));
        edge(patch, line.direction, &link.arc)
    });
    let length = link.arc.length();
    let kind = match [bend, normal_curvature].map(|k| (k * length).abs() < FLAT) {
        [_, true] => ConeKind::Plane,
        [true, false] => ConeKind::Cylinder,
        [false, false] => ConeKind::Cone,
    };
    Cone {
        kind,
        ends: link.ends,
        arc: link.arc,
        ruling,
        bend,
        normal_curvature,
        edges,
    }
}

/// The patches left and right of a line's arc, with the side that it is to
/// them.
fn beside(net: &Net, line: Line, position: usize) -> [Option<(usize, usize)>; 2] {
    let layout = net.layout();
    let counts = layout.patch_counts();
    let across = 1 - line.axis();
    let count = counts[across];
    let after = (line.number < count).then_some(line.number);
    let before = match line.number {
        0 => net.closed[across].then(|| count - 1),
        number => Some(number - 1),
    };
    let patch = |number: usize| match line.direction {
        Direction::U => position * counts[1] + number,
        Direction::V => number * counts[1] + position,
    };
    match line.direction {
        Direction::U => [after.map(|n| (patch(n), 0)), before.map(|n| (patch(n), 1))],
        Direction::V => [before.map(|n| (patch(n), 3)), after.map(|n| (patch(n), 2))],
    }
}

/// Where the rulings on one side end.
fn edge(
    patch: Option<(&CyclidePatch, usize)>,
    direction: Direction,
    arc: &CircularArc,
) -> [Point3<f64>; SAMPLES + 1] {
    std::array::from_fn(|k| {
        let share = k as f64 / SAMPLES as f64;
        let Some((patch, side)) = patch else {
            return arc.point(share);
        };
        let [u, v] = patch.on_side(side, rational(arc, share));
        match direction {
            Direction::U => patch.tangents_meet(Axis::U, u),
            Direction::V => patch.tangents_meet(Axis::V, v),
        }
    })
}

/// The parameter of an arc as a rational quadratic with end weights 1 at a
/// share of its length: tan φ = x sin h / (1 − x + x cos h) for the angle φ
/// between chord and tangent, h for the whole arc.
fn rational(arc: &CircularArc, share: f64) -> f64 {
    let half = 0.5 * arc.angle();
    let [done, left] = [share, 1.0 - share].map(|s| s * sinc(s * half));
    done / (done + left)
}

fn piece(cone: &Cone) -> Piece {
    let reach = |edge: &[Point3<f64>; SAMPLES + 1]| {
        std::array::from_fn(|k| (edge[k] - cone.arc.point(k as f64 / SAMPLES as f64)).norm())
    };
    Piece {
        length: cone.arc.length(),
        bend: cone.bend,
        reach: [reach(&cone.edges[0]), reach(&cone.edges[1])],
    }
}
