//! The approximating plate (sec. 2.3.3): what is asked of the minimisation,
//! and the choices that the paper leaves open.

use super::broken;
use super::objective::{Objective, Weights};
use crate::geometry::BSplineCurve;
use crate::methods::{Control, FitError};
use crate::solver::{Report, lbfgs};
use nalgebra::{Point3, Vector3};

/// K + 1, rulings at even parameters: about three for every knot span of D₁
/// and D₂, so that no span escapes between two of them.
const RULINGS: usize = 100;

/// λ, ω, γ, β, found by a search over decades on the three plates of the UBC
/// trawler (unit scale), judged by the twist of the interpolated plates.
///
/// * λ: with 1e-8 the feet bunch and interpolating plates fold (twists above
///   90°); with 1e-5 D₁ and D₂ cut the bends of the profiles by 0.3 % of the
///   model and more, and interpolation brings the twist back.
/// * ω = 1: first and second derivatives count alike; ∫|D″|² dominates
///   wherever a curve bends.
/// * γ: at 1e-4 the rulings hardly leave the greedy start; from 1e-2 on the
///   fold at the trawler's bow is cheaper than the distances that avoid it.
/// * β = γ keeps the normals' lengths without slowing the iteration.
const WEIGHTS: Weights = Weights {
    fair: 1e-6,
    stretch: 1.0,
    develop: 1e-3,
    regular: 1e-3,
};

/// The feet are renewed in every iteration, as the paper says, and convergence
/// is slow: control points and normals hang on each other through products of
/// small weights. The trawler's plates use all of these.
const ITERATIONS: usize = 2500;
/// Reductions below this, ten times in a row, end the iteration earlier.
const REDUCTION: f64 = 1e-9;
const GRADIENT: f64 = 1e-10;
const MEMORY: usize = 20;

/// Below this a normal is not one: the ruling runs along the curve, or both
/// ends fall together in a tip.
const NO_NORMAL: f64 = 1e-12;
/// Two unit normals whose sum is shorter than this point against each other.
const OPPOSED: f64 = 1e-6;

/// D₁ and D₂ near the data points, as developable as F makes them.
pub(super) fn optimise(
    curves: &[BSplineCurve; 2],
    points: &[Vec<Point3<f64>>; 2],
    control: &dyn Control,
) -> Result<([BSplineCurve; 2], Report), FitError> {
    let places: Vec<f64> = (0..RULINGS)
        .map(|i| i as f64 / (RULINGS - 1) as f64)
        .collect();
    let mut objective = Objective::new(curves, points, &places, WEIGHTS);
    let mut x = Objective::gather(curves, &normals(curves, &places));
    let settings = lbfgs::Settings {
        iterations: ITERATIONS,
        gradient: GRADIENT,
        reduction: REDUCTION,
        memory: MEMORY,
    };
    let report = lbfgs::minimize(&mut objective, &mut x, &settings, control)?;
    Ok((objective.curves(&x).map_err(broken)?, report))
}

/// Means of the unit normals at the two ends of each ruling, of unit length;
/// the neighbour's where a ruling has none.
fn normals(curves: &[BSplineCurve; 2], places: &[f64]) -> Vec<Vector3<f64>> {
    let unit = |v: Vector3<f64>| v.try_normalize(NO_NORMAL).unwrap_or_else(Vector3::zeros);
    let mut last = Vector3::z();
    let normal = |u: &f64| {
        let (a, b) = (curves[0].derivatives(*u), curves[1].derivatives(*u));
        let l = b.point - a.point;
        let sum = unit(l.cross(&a.d1)) + unit(l.cross(&b.d1));
        last = sum.try_normalize(OPPOSED).unwrap_or(last);
        last
    };
    places.iter().map(normal).collect()
}
