//! A flat map made as rigid as it can be (Sorkine & Alexa 2007; Liu et al.
//! 2008): every node turns its neighbourhood, laid out in its tangent plane,
//! as the map says, and the map then follows all neighbourhoods,
//!
//! `min Σᵢ Σⱼ |qⱼ − qᵢ − Rᵢ eᵢⱼ|²`, first over the turns Rᵢ, then over qᵢ.
//!
//! Shortest paths go round holes and along zigzags: a map of path lengths is
//! bent there. Neighbourhoods know of neither.

use super::voxels::Nodes;
use crate::numerics::EnvelopeMatrix;
use nalgebra::Vector3;

/// Rounds: the turns settle far below the noise of the nodes in some twenty,
/// around large holes in some forty.
const ROUNDS: usize = 40;
/// Weight of the last map, which holds the middle of the plane in its place.
const HOLD: f64 = 1e-7;

/// One directed link: to which node, and where it lies in the tangent plane.
type Link = (usize, [f64; 2]);

/// The map improved; as it was where a system has no solution.
pub(super) fn relaxed(nodes: &Nodes, map: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    let mut layout = layout(nodes);
    if mirrored(&layout, &map) {
        for link in layout.iter_mut().flatten() {
            link.1[1] = -link.1[1];
        }
    }
    let Ok(factor) = laplacian(&layout).factor() else {
        return map;
    };
    let mut now = map;
    for _ in 0..ROUNDS {
        let turns = turns(&layout, &now);
        let [mut x, mut y] = [0, 1].map(|k| now.iter().map(|q| HOLD * q[k]).collect::<Vec<_>>());
        for (i, links) in layout.iter().enumerate() {
            let [c, s] = turns[i];
            for (j, e) in links {
                let d = [c * e[0] - s * e[1], s * e[0] + c * e[1]];
                for (sum, d) in [(&mut x, d[0]), (&mut y, d[1])] {
                    sum[*j] += d;
                    sum[i] -= d;
                }
            }
        }
        factor.solve_in_place(&mut x);
        factor.solve_in_place(&mut y);
        now = x.into_iter().zip(y).map(|(x, y)| [x, y]).collect();
    }
    now
}

/// Neighbours of each node in its tangent plane, at their true distances.
fn layout(nodes: &Nodes) -> Vec<Vec<Link>> {
    let around = |i: usize| {
        let normal = nodes.normal[i];
        let axis = Vector3::from_fn(|k, _| if k == normal.iamin() { 1.0 } else { 0.0 });
        let first = normal.cross(&axis).normalize();
        let second = normal.cross(&first);
        let link = |j: &usize| {
            let d = nodes.place[*j] - nodes.place[i];
            let flat = [d.dot(&first), d.dot(&second)];
            let length = flat[0].hypot(flat[1]);
            let scale = if length > 0.0 { d.norm() / length } else { 0.0 };
            (*j, flat.map(|x| scale * x))
        };
        nodes.near[i].iter().map(link).collect()
    };
    (0..nodes.place.len()).map(around).collect()
}

/// Cross and dot products of the links with the map, summed.
fn products(links: &[Link], i: usize, map: &[[f64; 2]]) -> [f64; 2] {
    links.iter().fold([0.0; 2], |[dot, cross], (j, e)| {
        let d = [map[*j][0] - map[i][0], map[*j][1] - map[i][1]];
        [
            dot + e[0] * d[0] + e[1] * d[1],
            cross + e[0] * d[1] - e[1] * d[0],
        ]
    })
}

/// Whether most neighbourhoods lie in the map from behind: no turn fits them
/// as well as one of their mirror images.
fn mirrored(layout: &[Vec<Link>], map: &[[f64; 2]]) -> bool {
    let flipped =
        |links: &[Link]| -> Vec<Link> { links.iter().map(|(j, e)| (*j, [e[0], -e[1]])).collect() };
    let behind = layout.iter().enumerate().filter(|(i, links)| {
        let fit = |links: &[Link]| {
            let [dot, cross] = products(links, *i, map);
            dot.hypot(cross)
        };
        fit(&flipped(links)) > fit(links)
    });
    2 * behind.count() > layout.len()
}

/// Cosine and sine of the best turn of each neighbourhood.
fn turns(layout: &[Vec<Link>], map: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let turn = |(i, links): (usize, &Vec<Link>)| {
        let [dot, cross] = products(links, i, map);
        let length = dot.hypot(cross);
        if length > 0.0 {
            [dot / length, cross / length]
        } else {
            [1.0, 0.0]
        }
    };
    layout.iter().enumerate().map(turn).collect()
}

/// The normal equations for one coordinate.
fn laplacian(layout: &[Vec<Link>]) -> EnvelopeMatrix {
    let first = |(i, links): (usize, &Vec<Link>)| links.iter().map(|l| l.0).fold(i, usize::min);
    let mut matrix = EnvelopeMatrix::new(layout.iter().enumerate().map(first).collect());
    for (i, links) in layout.iter().enumerate() {
        matrix.add_to_diagonal(i, HOLD);
        for (j, _) in links {
            matrix.add_to_diagonal(i, 1.0);
            matrix.add_to_diagonal(*j, 1.0);
            matrix.add(i.max(*j), i.min(*j), -1.0);
        }
    }
    matrix
}
