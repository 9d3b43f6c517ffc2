//! The least-squares problem of one level.

use super::edge::{COLUMNS, Edge, edges, vector};
use super::hold::Hold;
use super::lead::{Lead, Side};
use crate::methods::curvature_net::surface::{Surface, UNKNOWNS};
use crate::methods::curvature_net::target::Target;
use crate::solver::{Blocks, LeastSquares};
use rayon::prelude::*;

/// Weights of the residuals, lengths in mean edges of the first net.
#[derive(Debug, Clone, Copy)]
pub(super) struct Weights {
    /// Of torsion (per radian) and squareness.
    pub(super) torsion: f64,
    /// Of the way of a vertex.
    pub(super) close: f64,
    /// Of its part along the start's tangent plane, relative to that.
    pub(super) sliding: f64,
    /// Of the bending of the way.
    pub(super) bending: f64,
    /// Of the bending of its slope across a line.
    pub(super) cross_bending: f64,
}

/// A net that slides within the surface keeps its shape, but leaves its seams.
const SLIDING: f64 = 0.5;

impl Weights {
    /// For a torsion's weight, the user's closeness and a bending's weight
    /// relative to it.
    pub(super) fn new(torsion: f64, closeness: f64, bending: f64) -> Self {
        Weights {
            torsion,
            close: closeness,
            sliding: SLIDING,
            bending: bending * closeness,
            cross_bending: bending * closeness,
        }
    }
}

/// Places of a border where its torsion is a residual: those of Lobatto's rule
/// with six, which leave the least between them. With five, of which there are
/// 11 residuals with the squareness for each 12 unknowns, twice as much is left
/// where few patches follow a sharp turn; with three there are ripples.
const PLACES: [f64; 6] = [
    0.0,
    0.117_472_338_035_267_7,
    0.357_384_241_759_677_5,
    0.642_615_758_240_322_5,
    0.882_527_661_964_732_3,
    1.0,
];

/// One level: the surface is near the start, its lines are lines of curvature.
pub(super) struct Level<'a> {
    weights: Weights,
    vertices: usize,
    edges: Vec<Edge>,
    hold: Hold<'a>,
    lead: Lead,
}

impl<'a> Level<'a> {
    pub(super) fn new(
        start: &'a Surface,
        now: &Surface,
        target: Option<&'a Target>,
        weights: Weights,
        side: Side,
    ) -> Self {
        Level {
            weights,
            vertices: start.vertices().len(),
            edges: edges(start),
            hold: Hold::new(start, target),
            lead: Lead::new(start, now, side),
        }
    }

    /// Torsions of a border with their derivatives, where these are wanted.
    fn torsions(&self, edge: &Edge, x: &[f64], wants_jacobian: bool) -> Torsions {
        let mut jacobian = Vec::new();
        let residuals = PLACES.map(|t| {
            let torsion = edge.jet(x, t).torsion();
            if wants_jacobian {
                jacobian.extend(edge.row(t, &torsion, self.weights.torsion));
            }
            torsion.value * self.weights.torsion
        });
        Torsions {
            residuals,
            jacobian,
        }
    }

    /// The cosine between the lines at every vertex.
    fn squareness(&self, x: &[f64], blocks: &mut Blocks) {
        let f = self.weights.torsion;
        for v in 0..self.vertices {
            let at = v * UNKNOWNS + 3;
            let (a, b) = (vector(x, at), vector(x, at + 3));
            let (length_a, length_b) = (a.norm(), b.norm());
            let cosine = a.dot(&b) / (length_a * length_b);
            let by_a = (b / length_b - a * (cosine / length_a)) * (f / length_a);
            let by_b = (a / length_a - b * (cosine / length_b)) * (f / length_b);
            let columns: [usize; 6] = std::array::from_fn(|k| at + k);
            let jacobian: [f64; 6] =
                std::array::from_fn(|k| if k < 3 { by_a[k] } else { by_b[k - 3] });
            blocks.push(&[f * cosine], &columns, &jacobian);
        }
    }
}

struct Torsions {
    residuals: [f64; PLACES.len()],
    jacobian: Vec<f64>,
}

/// Borders that one thread takes at least.
const BATCH: usize = 64;

impl LeastSquares for Level<'_> {
    fn dimension(&self) -> usize {
        self.vertices * UNKNOWNS
    }

    fn evaluate(&self, x: &[f64], blocks: &mut Blocks) {
        let wants_jacobian = blocks.wants_jacobian();
        let torsions: Vec<Torsions> = self
            .edges
            .par_iter()
            .with_min_len(BATCH)
            .map(|edge| self.torsions(edge, x, wants_jacobian))
            .collect();
        for (edge, found) in self.edges.iter().zip(&torsions) {
            let columns: [usize; COLUMNS] = edge.columns();
            blocks.push(&found.residuals, &columns, &found.jacobian);
        }
        self.squareness(x, blocks);
        self.lead.residuals(x, blocks);
        self.hold.closeness(x, &self.weights, blocks);
        self.hold.bending(x, &self.edges, &self.weights, blocks);
    }
}

#[cfg(test)]
mod tests {
    use super::super::start::through;
    use super::*;
    use crate::geometry::BSplineSurface;
    use crate::methods::curvature_net::net::Layout;
    use crate::methods::curvature_net::request;
    use crate::solver::derivative_check::worst_disagreement;
    use nalgebra::Point3;

    fn wavy(closed: [bool; 2]) -> Surface {
        let layout = Layout {
            rows: 4,
            columns: 3,
            closed,
        };
        let points: Vec<_> = (0..12)
            .map(|k| {
                let (i, j) = ((k / 3) as f64, (k % 3) as f64);
                let height = 0.3 * (i * 1.3).sin() + 0.2 * (i * j + 0.4).cos();
                Point3::new(i + 0.1 * j, j - 0.05 * i * j, height)
            })
            .collect();
        through(layout, &points)
    }

    #[test]
    fn derivatives_agree_with_differences() {
        for closed in [[false, false], [true, false]] {
            let start = wavy(closed);
            let x: Vec<f64> = (start.unknowns().iter().enumerate())
                .map(|(k, x)| x + 0.2 * (k as f64 * 1.7).sin())
                .collect();
            let now = start.with_unknowns(&x);
            let problem = Level::new(&start, &now, None, Weights::new(2.0, 1.5, 0.7), Side::Own);
            assert!(problem.lead.count() > 5);
            let worst = worst_disagreement(&problem, &x, 1e-6);
            assert!(worst.relative < 1e-6, "{worst:?}");
        }
    }

    #[test]
    fn derivatives_agree_with_a_target() {
        let start = wavy([false, false]);
        let knots = vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
        let hill = (0..9).map(|k| {
            let height = if k == 4 { 1.5 } else { 0.1 };
            Point3::new(
                -1.0 + 3.0 * (k / 3) as f64,
                -1.0 + 2.0 * (k % 3) as f64,
                height,
            )
        });
        let spline = BSplineSurface::new([2, 2], [knots.clone(), knots], hill.collect(), None);
        let spline = request::Target::BSpline(Box::new(spline.expect("a surface")));
        let target = Target::new(&spline, 1.0, &nalgebra::Vector3::zeros()).expect("a target");
        let problem = Level::new(
            &start,
            &start,
            Some(&target),
            Weights::new(2.0, 1.5, 0.7),
            Side::Own,
        );
        let worst = worst_disagreement(&problem, &start.unknowns(), 1e-6);
        assert!(worst.relative < 1e-6, "{worst:?}");
    }

    #[test]
    fn a_split_changes_no_torsion() {
        let start = wavy([false, false]);
        let split = start.split();
        let (x, y) = (start.unknowns(), split.unknowns());
        let (coarse, fine) = (edges(&start), edges(&split));
        // Half a border has half the length.
        let whole = coarse[1].jet(&x, 0.25).torsion().value;
        let at = fine
            .iter()
            .find(|e| e.direction == 0 && e.ends[0] == 2 * (coarse[1].ends[0] % 3));
        let half = at.map(|e| e.jet(&y, 0.5).torsion().value);
        assert!((half.unwrap_or(f64::NAN) - 0.5 * whole).abs() < 1e-12);
    }
}
