//! The paper's objective (eq. 5) with its gradient:
//!
//! ```text
//! F = F_appro + λ₃ Σ (F_angle + β F_d1 + β F_d2) + λ₄ Σ F_smooth
//! F_appro = Σ_M ((p − π)·N)² + λ₁ Σ_∂M |(p − χ) − ((p − χ)·T) T|² + λ₂ ∫ |a″|² + |b″|²
//! ```
//!
//! Unknowns: the control points of a and of b, then M, V, θ, d of each region.
//! Feet π, χ and the directions N, T are constants of one iteration, renewed
//! after each accepted step. Σ_∂M runs over all four sides: the short ones are
//! held to the first and the last ruling, or nothing would keep the strip from
//! shrinking along itself.

use super::cone::{Cone, NUMBERS};
use super::constraint::{Line, conical, smooth};
use super::feet::{self, Grid};
use super::ruled::Ruled;
use crate::geometry::bspline::{BasisJet, basis_jet};
use crate::geometry::{BSplineCurve, Knots, SplineError};
use crate::numerics::GaussLegendre;
use crate::solver::lbfgs;
use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

/// λ₁ and λ₂ of the paper.
const BORDER: f64 = 10.0;
const FAIR: f64 = 1e-5;
/// |a″|² of a cubic is of degree 2.
const NODES: usize = 2;
/// Rulings of a region that are to lie on its cone; those of its joints are
/// the first and the last.
const RULINGS: usize = 16;

/// What a point is held to.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Held {
    /// The surface: along its normal.
    Surface,
    /// A boundary curve: across its tangent.
    Side(usize),
    /// The first or the last ruling: across it.
    End,
}

/// A point of the strip with its foot.
#[derive(Debug, Clone, Copy)]
struct Datum {
    point: Point3<f64>,
    weight: f64,
    held: Held,
    u: f64,
    v: f64,
    basis: BasisJet<1>,
    /// N or T.
    direction: Vector3<f64>,
}

/// The strip's points in unit scale.
#[derive(Debug, Clone, Copy)]
pub(super) struct Data<'a> {
    pub(super) points: &'a [Point3<f64>],
    /// One each, about 1.
    pub(super) weights: &'a [f64],
    pub(super) sides: [&'a [Point3<f64>]; 2],
    pub(super) ends: [&'a [Point3<f64>]; 2],
}

/// F.
pub(super) struct Objective {
    knots: Knots,
    data: Vec<Datum>,
    /// Rulings of each region.
    rulings: Vec<Vec<BasisJet<1>>>,
    quadrature: Vec<(BasisJet<3>, f64)>,
    /// λ₃ = λ₄.
    pub(super) weight: f64,
}

fn vector(x: &[f64], i: usize) -> Vector3<f64> {
    Vector3::new(x[3 * i], x[3 * i + 1], x[3 * i + 2])
}

fn add(gradient: &mut [f64], i: usize, v: &Vector3<f64>) {
    for k in 0..3 {
        gradient[3 * i + k] += v[k];
    }
}

impl Objective {
    /// F with the first feet on a surface with a region between each two
    /// neighbouring breaks.
    pub(super) fn new(surface: &Ruled, breaks: &[f64], data: Data<'_>, weight: f64) -> Self {
        let knots = surface.sides[0].knot_vector().clone();
        let region = |w: &[f64]| {
            let at = |i: usize| w[0] + (w[1] - w[0]) * i as f64 / (RULINGS - 1) as f64;
            (0..RULINGS).map(|i| basis_jet(&knots, at(i))).collect()
        };
        let rule = GaussLegendre::new(NODES);
        let quadrature = (knots.breakpoints().windows(2))
            .flat_map(|w| rule.on(w[0], w[1]).collect::<Vec<_>>())
            .map(|(u, weight)| (basis_jet(&knots, u), weight))
            .collect();
        let mut objective = Objective {
            data: first_feet(surface, breaks.len() - 1, data),
            rulings: breaks.windows(2).map(region).collect(),
            quadrature,
            weight,
            knots,
        };
        objective.renew(surface);
        objective
    }

    /// Unknowns of a surface and cones.
    pub(super) fn gather(surface: &Ruled, cones: &[Cone]) -> Vec<f64> {
        let control = surface.sides.iter().flat_map(BSplineCurve::control_points);
        control
            .flat_map(|p| [p.x, p.y, p.z])
            .chain(cones.iter().flat_map(Cone::numbers))
            .collect()
    }

    /// The surface of unknowns.
    pub(super) fn surface(&self, x: &[f64]) -> Result<Ruled, SplineError> {
        let n = self.knots.control_count();
        let side = |k: usize| {
            let control = (k * n..(k + 1) * n).map(|i| Point3::from(vector(x, i)));
            BSplineCurve::from_knots(self.knots.clone(), control.collect(), None)
        };
        Ok(Ruled {
            sides: [side(0)?, side(1)?],
        })
    }

    /// The cones of unknowns.
    pub(super) fn cones(&self, x: &[f64]) -> Vec<Cone> {
        x[self.first_cone()..]
            .chunks(NUMBERS)
            .map(Cone::of)
            .collect()
    }

    /// Where the cones begin among the unknowns.
    fn first_cone(&self) -> usize {
        6 * self.knots.control_count()
    }

    /// New feet and directions.
    fn renew(&mut self, surface: &Ruled) {
        let knots = &self.knots;
        self.data.par_iter_mut().for_each(|datum| {
            let point = &datum.point;
            match datum.held {
                Held::Surface => {
                    [datum.u, datum.v] = feet::on_surface(surface, point, [datum.u, datum.v]);
                    let jet = surface.jet(datum.u, datum.v);
                    let normal = jet.u.cross(&jet.v).try_normalize(0.0);
                    datum.direction = normal.unwrap_or_else(Vector3::zeros);
                }
                Held::Side(side) => {
                    let curve = &surface.sides[side];
                    datum.u = feet::on_curve(curve, point, datum.u);
                    let tangent = curve.derivatives(datum.u).d1.try_normalize(0.0);
                    datum.direction = tangent.unwrap_or_else(Vector3::zeros);
                }
                Held::End => {
                    let ruling = surface.ruling(datum.u);
                    datum.v = feet::share(ruling, point);
                    let along = (ruling[1] - ruling[0]).try_normalize(0.0);
                    datum.direction = along.unwrap_or_else(Vector3::zeros);
                }
            }
            datum.basis = basis_jet(knots, datum.u);
        });
    }

    /// Both ends of a ruling, or of its derivative.
    fn ends<const ROWS: usize>(
        &self,
        x: &[f64],
        basis: &BasisJet<ROWS>,
        order: usize,
    ) -> [Vector3<f64>; 2] {
        let n = self.knots.control_count();
        [0, n].map(|side| {
            let values = basis.derivative(order).iter().enumerate();
            values.fold(Vector3::zeros(), |sum, (k, b)| {
                sum + vector(x, side + basis.first + k) * *b
            })
        })
    }

    /// Chain rule from the ends to the control points.
    fn spread<const ROWS: usize>(
        &self,
        gradient: &mut [f64],
        (basis, order): (&BasisJet<ROWS>, usize),
        by_ends: &[Vector3<f64>; 2],
    ) {
        let n = self.knots.control_count();
        for (side, g) in [0, n].into_iter().zip(by_ends) {
            for (k, b) in basis.derivative(order).iter().enumerate() {
                add(gradient, side + basis.first + k, &(g * *b));
            }
        }
    }

    fn distance(&self, x: &[f64], gradient: &mut [f64]) -> f64 {
        let mut value = 0.0;
        for datum in &self.data {
            let [a, b] = self.ends(x, &datum.basis, 0);
            let off = datum.point.coords - a - (b - a) * datum.v;
            let along = datum.direction * off.dot(&datum.direction);
            let counted = match datum.held {
                Held::Surface => along,
                Held::Side(_) | Held::End => off - along,
            };
            value += datum.weight * counted.norm_squared();
            let g = counted * (-2.0 * datum.weight);
            let by_ends = [g * (1.0 - datum.v), g * datum.v];
            self.spread(gradient, (&datum.basis, 0), &by_ends);
        }
        value
    }

    fn fairness(&self, x: &[f64], gradient: &mut [f64]) -> f64 {
        let mut value = 0.0;
        for (basis, weight) in &self.quadrature {
            let bends = self.ends(x, basis, 2);
            let w = FAIR * weight;
            value += w * (bends[0].norm_squared() + bends[1].norm_squared());
            self.spread(gradient, (basis, 2), &bends.map(|d| d * (2.0 * w)));
        }
        value
    }

    /// Σ (F_angle + β F_d1 + β F_d2) + Σ F_smooth; the gradient times λ₃ = λ₄
    /// is added.
    fn constraints(&self, x: &[f64], gradient: &mut [f64]) -> f64 {
        let (cones, first) = (self.cones(x), self.first_cone());
        let line = |basis: &BasisJet<1>| Line::new(self.ends(x, basis, 0).map(Point3::from));
        let mut value = 0.0;
        for (i, rulings) in self.rulings.iter().enumerate() {
            let range = first + i * NUMBERS..first + (i + 1) * NUMBERS;
            for basis in rulings {
                let mut by_ends = [Vector3::zeros(); 2];
                let by_cone = &mut gradient[range.clone()];
                value += conical(&line(basis), &cones[i], self.weight, &mut by_ends, by_cone);
                self.spread(gradient, (basis, 0), &by_ends);
            }
        }
        for (i, pair) in cones.windows(2).enumerate() {
            // Right-sided at the joint, which is the same: a and b are continuous.
            let basis = &self.rulings[i + 1][0];
            let mut by_ends = [Vector3::zeros(); 2];
            let by_cones = &mut gradient[first + i * NUMBERS..first + (i + 2) * NUMBERS];
            let pair = [&pair[0], &pair[1]];
            value += smooth(&line(basis), pair, self.weight, &mut by_ends, by_cones);
            self.spread(gradient, (basis, 0), &by_ends);
        }
        value
    }

    /// What is left of the constraints, without their weight.
    pub(super) fn broken(&self, x: &[f64]) -> f64 {
        self.constraints(x, &mut vec![0.0; x.len()])
    }
}

impl lbfgs::Objective for Objective {
    fn evaluate(&self, x: &[f64], gradient: &mut [f64]) -> f64 {
        gradient.fill(0.0);
        self.distance(x, gradient)
            + self.fairness(x, gradient)
            + self.weight * self.constraints(x, gradient)
    }

    fn accepted(&mut self, x: &[f64]) -> bool {
        match self.surface(x) {
            Ok(surface) => self.renew(&surface),
            // Control points that are not finite: the next value says so.
            Err(_) => return false,
        }
        true
    }
}

/// All points with the feet that are found by looking at the whole surface.
fn first_feet(surface: &Ruled, regions: usize, data: Data<'_>) -> Vec<Datum> {
    let grid = Grid::new(surface, regions);
    let knots = surface.sides[0].knot_vector();
    let datum = |point: &Point3<f64>, weight: f64, held: Held, [u, v]: [f64; 2]| Datum {
        point: *point,
        weight,
        held,
        u,
        v,
        basis: basis_jet(knots, u),
        direction: Vector3::zeros(),
    };
    let mut all: Vec<Datum> = (data.points.par_iter().zip(data.weights))
        .map(|(p, w)| datum(p, *w, Held::Surface, grid.on_surface(p)))
        .collect();
    for (k, side) in data.sides.into_iter().enumerate() {
        let place = |p: &Point3<f64>| [grid.on_side(k, p), k as f64];
        all.extend(
            side.iter()
                .map(|p| datum(p, BORDER, Held::Side(k), place(p))),
        );
    }
    for (u, end) in [0.0, 1.0].into_iter().zip(data.ends) {
        all.extend(end.iter().map(|p| datum(p, BORDER, Held::End, [u, 0.5])));
    }
    all
}
