//! The paper's objective (sec. 2.3) with its analytic gradient:
//!
//! ```text
//! F = F_dist + λ F_fair + γ F_develop + β F_regular
//! F_dist    = Σᵢ α |X − D(u)|² + (1−α) |(X − D(u)) − ((X − D(u))·T) T|²
//! F_fair    = ω (∫|D₁′|² + ∫|D₂′|²) + ∫|D₁″|² + ∫|D₂″|²
//! F_develop = Σⱼ (L·N)² + (D₁′·N)² + (D₂′·N)²
//! F_regular = Σⱼ (|N|² − 1)²
//! ```
//!
//! Unknowns: the control points of D₁, those of D₂, one normal N for each
//! sampled ruling. Tangents in F_develop are the derivatives D′, so that every
//! term is linear in the control points, as the paper says of its eq. 5. Foot
//! parameters u, unit tangents T and α = |cos∠(X − F, T)| are constants of one
//! iteration, renewed after each accepted step.

use super::feet;
use crate::geometry::bspline::{BasisJet, basis_jet};
use crate::geometry::{BSplineCurve, Knots, SplineError};
use crate::numerics::GaussLegendre;
use crate::solver::lbfgs;
use nalgebra::{Point3, Vector3};

/// Factors of the terms of F (unit scale).
#[derive(Debug, Clone, Copy)]
pub(super) struct Weights {
    /// λ.
    pub(super) fair: f64,
    /// ω.
    pub(super) stretch: f64,
    /// γ.
    pub(super) develop: f64,
    /// β.
    pub(super) regular: f64,
}

/// Below this distance a data point lies on its foot and the angle between the
/// two has no meaning.
const ON_FOOT: f64 = 1e-14;
/// |D″|² of a cubic is of degree 2, |D′|² of degree 4: three nodes are exact.
const NODES: usize = 3;

type Basis = BasisJet<3>;

/// A data point with its foot.
#[derive(Debug, Clone, Copy)]
struct Target {
    point: Point3<f64>,
    curve: usize,
    u: f64,
    basis: Basis,
    tangent: Vector3<f64>,
    alpha: f64,
}

/// F for one plate.
pub(super) struct Objective {
    knots: Knots,
    weights: Weights,
    rulings: Vec<Basis>,
    quadrature: Vec<(Basis, f64)>,
    targets: Vec<Target>,
}

/// x as vectors: control points of D₁, of D₂, normals.
fn vector(x: &[f64], i: usize) -> Vector3<f64> {
    Vector3::new(x[3 * i], x[3 * i + 1], x[3 * i + 2])
}

fn add(gradient: &mut [f64], i: usize, v: &Vector3<f64>) {
    for k in 0..3 {
        gradient[3 * i + k] += v[k];
    }
}

impl Objective {
    /// F with the first feet of the data points of D₁ and D₂.
    pub(super) fn new(
        curves: &[BSplineCurve; 2],
        points: &[Vec<Point3<f64>>; 2],
        rulings: &[f64],
        weights: Weights,
    ) -> Self {
        let knots = curves[0].knot_vector().clone();
        let rule = GaussLegendre::new(NODES);
        let spans = knots.breakpoints();
        let quadrature = spans
            .windows(2)
            .flat_map(|w| rule.on(w[0], w[1]).collect::<Vec<_>>())
            .map(|(u, weight)| (basis_jet(&knots, u), weight))
            .collect();
        let mut targets = Vec::new();
        for (curve, points) in points.iter().enumerate() {
            for (point, u) in points.iter().zip(feet::first(&curves[curve], points)) {
                let basis = basis_jet(&knots, u);
                let (point, tangent) = (*point, Vector3::zeros());
                targets.push(Target {
                    point,
                    curve,
                    u,
                    basis,
                    tangent,
                    alpha: 0.0,
                });
            }
        }
        let rulings = rulings.iter().map(|u| basis_jet(&knots, *u)).collect();
        let mut objective = Objective {
            knots,
            weights,
            rulings,
            quadrature,
            targets,
        };
        objective.renew(curves);
        objective
    }

    /// Unknowns from curves and normals.
    pub(super) fn gather(curves: &[BSplineCurve; 2], normals: &[Vector3<f64>]) -> Vec<f64> {
        let control = curves
            .iter()
            .flat_map(|c| c.control_points().iter().map(|p| p.coords));
        control
            .chain(normals.iter().copied())
            .flat_map(|v| [v.x, v.y, v.z])
            .collect()
    }

    /// D₁ and D₂.
    pub(super) fn curves(&self, x: &[f64]) -> Result<[BSplineCurve; 2], SplineError> {
        let n = self.knots.control_count();
        let curve = |first: usize| {
            let control = (first..first + n)
                .map(|i| Point3::from(vector(x, i)))
                .collect();
            BSplineCurve::from_knots(self.knots.clone(), control, None)
        };
        Ok([curve(0)?, curve(n)?])
    }

    /// New feet, tangents and α on the curves.
    fn renew(&mut self, curves: &[BSplineCurve; 2]) {
        for target in &mut self.targets {
            let curve = &curves[target.curve];
            target.u = feet::near(curve, &target.point, target.u);
            target.basis = basis_jet(&self.knots, target.u);
            let jet = curve.derivatives(target.u);
            target.tangent = jet.d1.try_normalize(0.0).unwrap_or_else(Vector3::zeros);
            let off = target.point - jet.point;
            let distance = off.norm();
            target.alpha = if distance < ON_FOOT {
                0.0
            } else {
                (off.dot(&target.tangent) / distance).abs().min(1.0)
            };
        }
    }

    /// Value of curve `curve`'s `order`-th derivative.
    fn at(&self, x: &[f64], curve: usize, basis: &Basis, order: usize) -> Vector3<f64> {
        let first = curve * self.knots.control_count() + basis.first;
        let values = basis.derivative(order).iter().enumerate();
        values.fold(Vector3::zeros(), |sum, (k, b)| {
            sum + vector(x, first + k) * *b
        })
    }

    /// Chain rule: dF = g · d(order-th derivative of the curve).
    fn spread(
        &self,
        gradient: &mut [f64],
        (curve, order): (usize, usize),
        basis: &Basis,
        g: &Vector3<f64>,
    ) {
        let first = curve * self.knots.control_count() + basis.first;
        for (k, b) in basis.derivative(order).iter().enumerate() {
            add(gradient, first + k, &(g * *b));
        }
    }

    fn distance(&self, x: &[f64], gradient: &mut [f64]) -> f64 {
        let mut value = 0.0;
        for t in &self.targets {
            let off = t.point.coords - self.at(x, t.curve, &t.basis, 0);
            let along = t.tangent * off.dot(&t.tangent);
            let across = off - along;
            value += t.alpha * off.norm_squared() + (1.0 - t.alpha) * across.norm_squared();
            let g = (off * t.alpha + across * (1.0 - t.alpha)) * -2.0;
            self.spread(gradient, (t.curve, 0), &t.basis, &g);
        }
        value
    }

    fn fairness(&self, x: &[f64], gradient: &mut [f64]) -> f64 {
        let Weights { fair, stretch, .. } = self.weights;
        let mut value = 0.0;
        for (basis, weight) in &self.quadrature {
            for curve in 0..2 {
                for (order, factor) in [(1, stretch), (2, 1.0)] {
                    let d = self.at(x, curve, basis, order);
                    let w = fair * factor * weight;
                    value += w * d.norm_squared();
                    self.spread(gradient, (curve, order), basis, &(d * (2.0 * w)));
                }
            }
        }
        value
    }

    fn developability(&self, x: &[f64], gradient: &mut [f64]) -> f64 {
        let Weights {
            develop, regular, ..
        } = self.weights;
        let first = 2 * self.knots.control_count();
        let mut value = 0.0;
        for (j, basis) in self.rulings.iter().enumerate() {
            let n = vector(x, first + j);
            let l = self.at(x, 1, basis, 0) - self.at(x, 0, basis, 0);
            let (t1, t2) = (self.at(x, 0, basis, 1), self.at(x, 1, basis, 1));
            let (ln, n1, n2) = (l.dot(&n), t1.dot(&n), t2.dot(&n));
            let unit = n.norm_squared() - 1.0;
            value += develop * (ln * ln + n1 * n1 + n2 * n2) + regular * unit * unit;
            let d = 2.0 * develop;
            self.spread(gradient, (0, 0), basis, &(n * (-d * ln)));
            self.spread(gradient, (1, 0), basis, &(n * (d * ln)));
            self.spread(gradient, (0, 1), basis, &(n * (d * n1)));
            self.spread(gradient, (1, 1), basis, &(n * (d * n2)));
            let g = (l * ln + t1 * n1 + t2 * n2) * d + n * (4.0 * regular * unit);
            add(gradient, first + j, &g);
        }
        value
    }
}

impl lbfgs::Objective for Objective {
    fn evaluate(&self, x: &[f64], gradient: &mut [f64]) -> f64 {
        gradient.fill(0.0);
        self.distance(x, gradient) + self.fairness(x, gradient) + self.developability(x, gradient)
    }

    fn accepted(&mut self, x: &[f64]) -> bool {
        match self.curves(x) {
            Ok(curves) => self.renew(&curves),
            // Control points that are not finite: the next value says so.
            Err(_) => return false,
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Parametrization, interpolate};
    use crate::solver::lbfgs::Objective as _;

    fn bent(z: f64) -> BSplineCurve {
        let points: Vec<_> = (0..9)
            .map(|i| {
                let x = f64::from(i) / 8.0;
                Point3::new(x, z * (1.0 + x * x), z + 0.2 * (3.0 * x + z).sin())
            })
            .collect();
        interpolate(&points, 3, Parametrization::Uniform).expect("distinct points")
    }

    #[test]
    fn gradient_agrees_with_central_differences() {
        let curves = [bent(0.1), bent(0.4)];
        // Points off the curve, one beyond each end so that α is not zero.
        let data = |c: &BSplineCurve| -> Vec<_> {
            [
                (-0.1, 0.0),
                (0.0, 0.3),
                (0.02, 0.5),
                (0.0, 0.9),
                (0.15, 1.0),
            ]
            .map(|(off, u)| c.point(u) + Vector3::new(off, 0.03, -0.02))
            .to_vec()
        };
        let points = [data(&curves[0]), data(&curves[1])];
        let rulings: Vec<f64> = (0..7).map(|i| f64::from(i) / 6.0).collect();
        let weights = Weights {
            fair: 0.3,
            stretch: 0.7,
            develop: 0.5,
            regular: 0.9,
        };
        let objective = Objective::new(&curves, &points, &rulings, weights);
        assert!(objective.targets.iter().any(|t| t.alpha > 0.5));
        assert!(objective.targets.iter().any(|t| t.alpha < 1e-6));
        let normals = vec![Vector3::new(0.3, 0.8, -0.4); rulings.len()];
        let x = Objective::gather(&curves, &normals);
        let mut gradient = vec![0.0; x.len()];
        objective.evaluate(&x, &mut gradient);
        let value = |i: usize, h: f64| {
            let mut y = x.clone();
            y[i] += h;
            objective.evaluate(&y, &mut vec![0.0; x.len()])
        };
        for (i, analytic) in gradient.iter().enumerate() {
            let h = 1e-5;
            let numerical = (value(i, h) - value(i, -h)) / (2.0 * h);
            let error = (analytic - numerical).abs() / (1.0 + numerical.abs());
            assert!(error < 1e-7, "unknown {i}: {analytic} against {numerical}");
        }
    }

    #[test]
    fn a_tangent_move_of_a_point_costs_nothing_but_at_an_end() {
        let curves = [bent(0.1), bent(0.4)];
        let on = curves[0].derivatives(0.5);
        let end = curves[0].derivatives(1.0);
        let points = [vec![on.point, end.point + end.d1 * 0.1], Vec::new()];
        let weights = Weights {
            fair: 0.0,
            stretch: 0.0,
            develop: 0.0,
            regular: 0.0,
        };
        let objective = Objective::new(&curves, &points, &[], weights);
        let x = Objective::gather(&curves, &[]);
        let value = objective.evaluate(&x, &mut vec![0.0; x.len()]);
        let expected = (end.d1 * 0.1).norm_squared();
        assert!(
            (value - expected).abs() < 1e-12,
            "{value} against {expected}"
        );
    }
}
