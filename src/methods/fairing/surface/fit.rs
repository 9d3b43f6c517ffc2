//! The fit of one net: stiffness from the data, outliers made light of.

use super::energy::Energy;
use super::feet::Foot;
use super::net::{Net, Sheet};
use super::springs::{Springs, gather};
use super::stiffness::{Chosen, Likelihood, choose, last};
use crate::methods::FitError;
use crate::numerics::EnvelopeMatrix;
use crate::solver::Control;
use nalgebra::Vector3;
use rayon::prelude::*;

/// A sheet with the places of the points on it.
#[derive(Debug, Clone)]
pub(in super::super) struct Fit {
    pub(in super::super) sheet: Sheet,
    pub(in super::super) at: Vec<[f64; 2]>,
    pub(in super::super) lambda: f64,
    /// σ across the sheet, in the frame.
    pub(in super::super) noise: f64,
    /// Springs' weights at the end.
    pub(in super::super) weight: Vec<f64>,
    pub(in super::super) energy: EnvelopeMatrix,
    pub(in super::super) model: Likelihood,
    /// Monomials that the energy leaves free, where they are taken out first.
    pub(in super::super) monomials: Vec<[usize; 2]>,
}

/// Rounds of reweighting; the scale settles in four or five.
const ROUNDS: usize = 6;
/// Residuals of so many σ and more have no weight (Tukey's biweight; 6 keeps
/// 98 % efficiency on clean data).
const CUT: f64 = 6.0;
/// Least scale, as share of the longest side: what is nearer to the sheet is on
/// it, and judged by rounding alone every other point would be an outlier.
const LEAST_SCALE: f64 = 1e-9;
/// Median of |x|/σ for one, two and three normal components.
const MEDIANS: [f64; 3] = [0.674_490, 1.177_410, 1.538_172];

/// What a robust fit knows of its points.
#[derive(Debug, Clone)]
pub(in super::super) struct Robust<const D: usize> {
    pub(in super::super) chosen: Chosen<D>,
    /// Weights with the share that outliers keep.
    pub(in super::super) weight: Vec<f64>,
    /// σ a component from the median residual.
    pub(in super::super) scale: f64,
}

/// Fits with Tukey's weights, scale from the median residual; `near`: a λ to
/// begin with.
///
/// # Errors
/// As [`choose`].
pub(in super::super) fn robust<const D: usize>(
    net: &Net,
    springs: &Springs<D>,
    (energy, model): (&EnvelopeMatrix, Likelihood),
    (near, control): (Option<f64>, &dyn Control),
) -> Result<Robust<D>, FitError> {
    let mut now = springs.clone();
    let mut chosen = choose(&gather(net, &now), energy, model, (near, control))?;
    let mut scale = chosen.noise;
    for _ in 0..ROUNDS {
        let residuals = residuals(net, &now, &chosen.control);
        scale = median_scale(&residuals, D).max(LEAST_SCALE);
        let unit = scale * MEDIANS[D.clamp(1, 3) - 1] / MEDIANS[0];
        for ((w, given), r) in now.weight.iter_mut().zip(&springs.weight).zip(&residuals) {
            let t = (r / (CUT * unit)).min(1.0);
            *w = given * (1.0 - t * t).powi(2);
        }
        chosen = last(&gather(net, &now), (energy, model), chosen.lambda, control)?;
    }
    Ok(Robust {
        chosen,
        weight: now.weight,
        scale,
    })
}

/// Length of each point's residual.
pub(in super::super) fn residuals<const D: usize>(
    net: &Net,
    springs: &Springs<D>,
    control: &[[f64; D]],
) -> Vec<f64> {
    springs
        .at
        .par_iter()
        .zip(&springs.value)
        .with_min_len(512)
        .map(|(at, value)| {
            let place = evaluate(net, control, *at);
            let square = |d: usize| (value[d] - place[d]).powi(2);
            (0..D).map(square).sum::<f64>().sqrt()
        })
        .collect()
}

/// The fields at (u, v).
pub(in super::super) fn evaluate<const D: usize>(
    net: &Net,
    control: &[[f64; D]],
    at: [f64; 2],
) -> [f64; D] {
    let [ju, jv] = net.jets::<1>(at);
    let mut sum = [0.0; D];
    for (a, x) in ju.values().iter().enumerate() {
        for (b, y) in jv.values().iter().enumerate() {
            let c = &control[net.index(ju.first + a, jv.first + b)];
            for d in 0..D {
                sum[d] += x * y * c[d];
            }
        }
    }
    sum
}

/// σ a component from the median length of residuals of `D` components.
pub(in super::super) fn median_scale(lengths: &[f64], components: usize) -> f64 {
    let mut sorted = lengths.to_vec();
    if sorted.is_empty() {
        return 0.0;
    }
    let middle = sorted.len() / 2;
    let (_, median, _) = sorted.select_nth_unstable_by(middle, f64::total_cmp);
    *median / MEDIANS[components.clamp(1, 3) - 1]
}

/// The energy that a task asks for, or the isotropic one of the given order
/// and stretch.
/// Parameters of the paper's run from 0 to 1: its derivatives by u are ours
/// times the length of the domain.
pub(in super::super) fn energy(
    asked: Option<super::request::EnergyWeights>,
    (order, stretch): (usize, f64),
    domain: [[f64; 2]; 2],
) -> Energy {
    let Some(e) = asked else {
        return Energy::isotropic(order, stretch);
    };
    let [a, b] = domain.map(|[low, high]| (high - low).powi(2));
    Energy::of_paper([
        e.alpha11 * a,
        e.alpha22 * b,
        e.beta11 * a * a,
        e.beta12 * a * b,
        e.beta22 * b * b,
    ])
}

/// Places of feet.
pub(in super::super) fn places(feet: &[Foot]) -> Vec<[f64; 2]> {
    feet.iter().map(|f| f.at).collect()
}

/// Springs to points in space.
pub(in super::super) fn springs_to(
    points: &[Vector3<f64>],
    at: &[[f64; 2]],
    weight: &[f64],
) -> Springs<3> {
    Springs {
        at: at.to_vec(),
        value: points.iter().map(|p| [p.x, p.y, p.z]).collect(),
        weight: weight.to_vec(),
    }
}

/// The same springs with the held coordinates at zero: they must not speak
/// of the noise.
pub(in super::super) fn free_only(springs: &Springs<3>, freedom: [bool; 3]) -> Springs<3> {
    let mut masked = springs.clone();
    for value in &mut masked.value {
        for (v, _) in value.iter_mut().zip(freedom).filter(|(_, free)| !free) {
            *v = 0.0;
        }
    }
    masked
}

impl Fit {
    /// Springs to about `most` of the points, as stiff together as all.
    pub(in super::super) fn sampled(&self, points: &[Vector3<f64>], most: usize) -> Springs<3> {
        let stride = points.len().div_ceil(most).max(1);
        let kept: Vec<usize> = (0..points.len()).step_by(stride).collect();
        Springs {
            at: kept.iter().map(|i| self.at[*i]).collect(),
            value: kept.iter().map(|i| points[*i].into()).collect(),
            weight: kept
                .iter()
                .map(|i| self.weight[*i] * stride as f64)
                .collect(),
        }
    }

    /// The sheet of other control points on the same net, its held coordinates
    /// those of this fit.
    pub(in super::super) fn with_held(&self, control: &[[f64; 3]], freedom: [bool; 3]) -> Sheet {
        let mut sheet = Sheet::of_points(&self.sheet.net, control);
        for (p, own) in sheet.control.iter_mut().zip(&self.sheet.control) {
            for d in (0..3).filter(|d| !freedom[*d]) {
                p[d] = own[d];
            }
        }
        sheet
    }
}
