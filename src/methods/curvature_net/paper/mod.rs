//! The paper's own formulation, kept for comparison (Zheng & Bo 2019).
//!
//! Bézier patches, and F = w₁ F_curv + w₂ F_smooth + w₃ F_fair + w₄ F_dist over
//! their control points (eq. 2) by Gauss–Newton, alternating with midpoint
//! subdivision:
//!
//! * F_curv = Σ det(c′, N, N′)² at K + 1 places of both sides of every border
//!   (eq. 1), divided by |N|² |c′|: as it stands it is least where the control
//!   points fall together, and the weights depend on the unit;
//! * F_smooth = Σ ‖P₋ − 2P + P₊‖² of the control points across the borders;
//! * F_fair = Σ ‖v_{i−1} − 2v_i + v_{i+1}‖² of vertices along the lines;
//! * F_dist = Σ ‖v − v₀‖², v₀ where the level started.
//!
//! The result is handed on as the C¹ surface with the patches' mean derivatives
//! at the vertices; torsion and angles between normals are those of the patches.

mod net;

use super::diagnose::{At, BorderFigures, PLACES};
use super::input::Task;
use super::lines::{Lines, Step};
use crate::solver::levenberg_marquardt::{Settings, minimize};
use crate::solver::{Blocks, Control, LeastSquares, NormalEquations, Stop};
use nalgebra::{Point3, Vector3};
use net::{BezierNet, Side};

/// w₁ … w₄ of the paper.
const WEIGHTS: [f64; 4] = [0.1, 0.1, 0.001, 0.1];
/// Places of a border, K = 4.
const SAMPLES: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];
/// Most iterations of a level.
const ITERATIONS: usize = 40;
/// A level that gains less than this share is over.
const REDUCTION: f64 = 1e-4;

/// What the paper's way leads to.
pub(super) struct PaperNet {
    /// Start, C¹ surface and steps.
    pub(super) lines: Lines,
    bezier: BezierNet,
}

/// Fits as the paper does.
///
/// # Errors
/// [`Stop`] when the control says so.
pub(super) fn solve(task: &Task, control: &dyn Control) -> Result<PaperNet, Stop> {
    let mut bezier = BezierNet::new(task.layout, &task.points);
    let mut lines = Lines::start(task);
    let last = task.levels.count();
    for level in 0..=last {
        control.progress("lines", 100.0 * level as f64 / (last + 1) as f64);
        if level > 0 {
            bezier = bezier.split();
            lines.split(None);
        }
        let step = optimise(&mut bezier, level, control)?;
        lines.steps.push(step);
    }
    lines.surface = bezier.smooth();
    Ok(PaperNet { lines, bezier })
}

fn optimise(bezier: &mut BezierNet, level: usize, control: &dyn Control) -> Result<Step, Stop> {
    let problem = Problem::new(bezier);
    let mut x: Vec<f64> = bezier.points.iter().flat_map(|p| [p.x, p.y, p.z]).collect();
    let settings = Settings {
        iterations: ITERATIONS,
        reduction: REDUCTION,
        damping: 1e-6,
        normal_equations: NormalEquations::Sparse,
        ..Settings::default()
    };
    let report = minimize(&problem, &mut x, &settings, control)?;
    for (p, x) in bezier.points.iter_mut().zip(x.chunks_exact(3)) {
        *p = Vector3::new(x[0], x[1], x[2]);
    }
    Ok(Step {
        level,
        torsion: WEIGHTS[0],
        bending: WEIGHTS[2],
        iterations: report.iterations,
        converged: report.termination.converged(),
    })
}

/// The paper's objective on one level.
struct Problem {
    sides: Vec<Side>,
    /// Across the borders, along the lines.
    triples: [Vec<[usize; 3]>; 2],
    vertices: Vec<(usize, Vector3<f64>)>,
    dimension: usize,
}

impl Problem {
    fn new(bezier: &BezierNet) -> Self {
        let vertices = (0..bezier.layout.vertex_count()).map(|v| bezier.vertex(v));
        Problem {
            sides: bezier.sides(),
            triples: bezier.triples(),
            vertices: vertices.map(|k| (k, bezier.points[k])).collect(),
            dimension: 3 * bezier.points.len(),
        }
    }
}

fn point(x: &[f64], k: usize) -> Vector3<f64> {
    Vector3::new(x[3 * k], x[3 * k + 1], x[3 * k + 2])
}

impl LeastSquares for Problem {
    fn dimension(&self) -> usize {
        self.dimension
    }

    fn evaluate(&self, x: &[f64], blocks: &mut Blocks) {
        let f = WEIGHTS[0].sqrt();
        for side in &self.sides {
            let mut jacobian = Vec::new();
            let residuals = SAMPLES.map(|t| {
                let found = side.jet(|k| point(x, k), t).torsion();
                if blocks.wants_jacobian() {
                    jacobian.extend(Side::row(t, &found.by).map(|j| j * f));
                }
                found.value * f
            });
            let control = |k: usize| {
                if k < 4 {
                    side.on[k]
                } else {
                    side.beside[k - 4]
                }
            };
            let columns: [usize; 24] = std::array::from_fn(|c| 3 * control(c / 3) + c % 3);
            blocks.push(&residuals, &columns, &jacobian);
        }
        for (triples, weight) in self.triples.iter().zip([WEIGHTS[1], WEIGHTS[2]]) {
            let f = weight.sqrt();
            for [a, b, c] in triples {
                let bend = (point(x, *a) - point(x, *b) * 2.0 + point(x, *c)) * f;
                for k in 0..3 {
                    let columns = [3 * a + k, 3 * b + k, 3 * c + k];
                    blocks.push(&[bend[k]], &columns, &[f, -2.0 * f, f]);
                }
            }
        }
        let f = WEIGHTS[3].sqrt();
        for (k, start) in &self.vertices {
            let way = (point(x, *k) - start) * f;
            for axis in 0..3 {
                blocks.push(&[way[axis]], &[3 * k + axis], &[f]);
            }
        }
    }
}

impl PaperNet {
    /// The figures of the patches themselves instead of those of the C¹
    /// surface.
    pub(super) fn correct(&self, figures: &mut BorderFigures) {
        let sides = self.bezier.sides();
        let mut sum = 0.0;
        let mut worst = (0.0, Point3::origin());
        for side in &sides {
            for t in PLACES {
                let jet = side.jet(|k| self.bezier.points[k], t);
                let value = jet.torsion().value.abs();
                sum += value / (sides.len() * PLACES.len()) as f64;
                if value > worst.0 {
                    worst = (value, Point3::from(self.bezier.points[side.on[0]]));
                }
            }
        }
        figures.mean_torsion = sum;
        figures.max_torsion = At {
            value: worst.0,
            point: worst.1,
            ..figures.max_torsion
        };
        figures.max_normal_jump = self.largest_jump(&sides);
    }

    /// The largest angle between the normals of both sides of a border.
    fn largest_jump(&self, sides: &[Side]) -> f64 {
        let normal = |side: &Side, t: f64| {
            let jet = side.jet(|k| self.bezier.points[k], t);
            jet.along.cross(&jet.across)
        };
        let pairs = sides.windows(2).filter(|pair| pair[0].on == pair[1].on);
        let jumps = pairs.flat_map(|pair| {
            PLACES.map(|t| {
                let (a, b) = (normal(&pair[0], t), -normal(&pair[1], t));
                a.cross(&b).norm().atan2(a.dot(&b))
            })
        });
        jumps.fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::methods::curvature_net::net::Layout;
    use crate::solver::derivative_check::worst_disagreement;

    fn wavy(closed: [bool; 2]) -> BezierNet {
        let layout = Layout {
            rows: 3,
            columns: 3,
            closed,
        };
        let points: Vec<_> = (0..9)
            .map(|k| {
                let (i, j) = ((k / 3) as f64, (k % 3) as f64);
                Point3::new(i + 0.1 * j, j, 0.4 * (i * 1.3 + j).sin())
            })
            .collect();
        let mut net = BezierNet::new(layout, &points);
        for (k, p) in net.points.iter_mut().enumerate() {
            p.z += 0.1 * (k as f64 * 1.9).cos();
        }
        net
    }

    #[test]
    fn derivatives_agree_with_differences() {
        for closed in [[false, false], [false, true]] {
            let net = wavy(closed);
            let x: Vec<f64> = net.points.iter().flat_map(|p| [p.x, p.y, p.z]).collect();
            let worst = worst_disagreement(&Problem::new(&net), &x, 1e-6);
            assert!(worst.relative < 1e-7, "{worst:?}");
        }
    }

    #[test]
    fn splitting_keeps_the_borders() {
        let net = wavy([false, true]);
        let fine = net.split();
        assert_eq!(fine.layout, net.layout.split());
        let (a, b) = (net.sides()[0], fine.sides()[0]);
        let whole = a.jet(|k| net.points[k], 0.25);
        let half = b.jet(|k| fine.points[k], 0.5);
        assert!((whole.along * 0.5 - half.along).norm() < 1e-13);
        assert!((whole.across * 0.5 - half.across).norm() < 1e-13);
    }
}
