//! What holds the net: closeness to the start, and the bending of the way from
//! it.
//!
//! Both are integrals over the parameters, so that a level does not change
//! their weight: ∫ |D|² over the vertices, ∫ |D_uu|² + |D_vv|² and ∫ |D_uuv|² +
//! |D_uvv|² over the strips of the borders, exact for the cubics; D = S − S₀.
//! They couple neighbours only, which keeps the normal equations sparse, and
//! vanish on the start: a net that is laid right stays.

use super::edge::{Edge, strip, vector};
use super::model::Weights;
use crate::methods::curvature_net::surface::{Surface, UNKNOWNS, weights};
use crate::methods::curvature_net::target::{Foot, Target};
use crate::solver::Blocks;
use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

/// The start and its numbers.
pub(super) struct Hold<'a> {
    start: &'a Surface,
    target: Option<&'a Target>,
    values: Vec<f64>,
    /// Unit normal and two tangents at every vertex.
    axes: Vec<[Vector3<f64>; 3]>,
    /// The share of the parameters that a vertex stands for.
    areas: Vec<f64>,
}

/// Gauss's two points on [0, 1]: exact for the square of a cubic's second
/// derivative.
const GAUSS: [f64; 2] = [0.211_324_865_405_187_1, 0.788_675_134_594_812_9];

impl<'a> Hold<'a> {
    pub(super) fn new(start: &'a Surface, target: Option<&'a Target>) -> Self {
        let columns = start.layout().columns;
        let axes = start.vertices().iter().map(|k| {
            let normal = k.du.cross(&k.dv).normalize();
            let tangent = k.du.normalize();
            [normal, tangent, normal.cross(&tangent)]
        });
        let area = |v: usize| strip(start, 0, v / columns) * strip(start, 1, v % columns);
        Hold {
            start,
            target,
            values: start.unknowns(),
            axes: axes.collect(),
            areas: (0..start.vertices().len()).map(area).collect(),
        }
    }

    /// The way of every vertex, along the normal of the start and across it,
    /// and the change of its mixed derivative. With a target the first is the
    /// distance from its tangent plane at the nearest point.
    pub(super) fn closeness(&self, x: &[f64], w: &Weights, blocks: &mut Blocks) {
        let feet: Option<Vec<Foot>> = self.target.map(|target| {
            let vertices = 0..self.areas.len();
            let foot = |v| target.foot(&Point3::from(vector(x, v * UNKNOWNS)));
            vertices.into_par_iter().map(foot).collect()
        });
        for (v, (axes, area)) in self.axes.iter().zip(&self.areas).enumerate() {
            let at = v * UNKNOWNS;
            let way = vector(x, at) - vector(&self.values, at);
            let f = w.close * area.sqrt();
            let mut axes = *axes;
            let mut along = axes[0].dot(&way);
            if let Some(feet) = &feet {
                axes[0] = feet[v].normal;
                along = axes[0].dot(&(vector(x, at) - feet[v].point.coords));
            }
            let weighted = [
                axes[0] * f,
                axes[1] * (f * w.sliding),
                axes[2] * (f * w.sliding),
            ];
            let jacobian: [f64; 9] = std::array::from_fn(|k| weighted[k / 3][k % 3]);
            let [_, first, second] = weighted.map(|axis| axis.dot(&way));
            let residuals = [along * f, first, second];
            blocks.push(&residuals, &[at, at + 1, at + 2], &jacobian);
            let at = at + MIXED;
            let change = vector(x, at) - vector(&self.values, at);
            let f = w.bending * area.sqrt();
            for k in 0..3 {
                blocks.push(&[f * change[k]], &[at + k], &[f]);
            }
        }
    }

    /// The bending of the way along every border, of its value and of its slope
    /// across.
    pub(super) fn bending(&self, x: &[f64], edges: &[Edge], w: &Weights, blocks: &mut Blocks) {
        debug_assert_eq!(x.len(), self.start.vertices().len() * UNKNOWNS);
        for edge in edges {
            let f = (0.5 * edge.width * edge.strip).sqrt();
            let shapes = GAUSS.map(|t| weights(t, edge.width, 2));
            for (value, slope, weight) in [(0, 1, w.bending), (2, 3, w.cross_bending)] {
                let places = [
                    edge.place(0, value),
                    edge.place(1, value),
                    edge.place(0, slope),
                    edge.place(1, slope),
                ];
                let jacobian: [f64; 8] = std::array::from_fn(|k| f * weight * shapes[k / 4][k % 4]);
                for k in 0..3 {
                    let columns = places.map(|at| at + k);
                    let row = |g: usize| {
                        let terms = columns.iter().zip(&jacobian[4 * g..]);
                        terms
                            .map(|(c, j)| (x[*c] - self.values[*c]) * j)
                            .sum::<f64>()
                    };
                    blocks.push(&[row(0), row(1)], &columns, &jacobian);
                }
            }
        }
    }
}

/// Place of the mixed derivative among a vertex's unknowns.
const MIXED: usize = 9;
