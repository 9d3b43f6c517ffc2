//! Slips: points that do not fit the fair shape of the others.
//!
//! Up to a few hundred points every point is tried: what would the fit be
//! without it? At a stiffness λ, with residual dᵢ and leverage ℓᵢ = w bᵢᵀ(G +
//! λH)⁻¹bᵢ, the sum Q without point i is Qᵢ = Q − w dᵢ²/(1 − ℓᵢ) (Cook &
//! Weisberg 1982, §2.2, which holds for penalised fits as well). As one slip
//! makes all points look noisy and so hides itself, λ is the likeliest
//! *without* the point. The worst point is tested by F = (w dᵢ²/(1 − ℓᵢ)) /
//! (Qᵢ/ν), its chance multiplied by the number of points and of the λ looked at
//! (Bonferroni); if that is small it is set aside and the rest is looked at again.
//!
//! Points of a bend are not called slips ([`super::bends`]): they come back
//! into the fit, and the others are looked at again.
//!
//! Many points hide nothing: there the spread of the residuals is estimated by
//! its median, which a few per cent of slips do not move, points far outside
//! are set aside, and the rest is fitted anew until nothing changes.

use super::bends::bends;
use super::free::{Shape, settle};
use super::holds::Holds;
use super::space::Vector;
use super::springs::{Springs, across};
use super::stiffness::{Choice, Offsets};
use crate::methods::fairing::student::two_sided;
use crate::solver::{Control, Stop};

/// Points up to which each is tried.
const TRY_EACH: usize = 400;
/// Chance below which a point is called a slip.
const SURE: f64 = 0.01;
/// Most slips, as a share of the points: beyond, the noise is not noise.
const MOST_SHARE: f64 = 0.15;
/// Steps of ln λ at which deletions are compared, from the likeliest.
const LOG_STEPS: [f64; 9] = [-4.0, -2.0, 0.0, 2.0, 4.0, 6.0, 8.0, 10.0, 12.0];
/// Variance of a point about a prediction of it, against that of the noise:
/// its own and, at most about as much, that of the curve.
const PREDICTED: f64 = 2.0;
/// Noise below this is rounding, unit scale.
const LEAST_NOISE: f64 = 1e-9;
/// Rounds of the estimate by medians.
const ROUNDS: usize = 8;
/// A slip must leave the fit without it by this many deviations.
const LEAST_DEVIATIONS: f64 = 3.0;

/// A suspected slip, unit scale.
#[derive(Debug, Clone)]
pub(super) struct Suspect<const D: usize> {
    /// Position among the points.
    pub(super) index: usize,
    /// Where the curve without it would have it.
    pub(super) expected: Vector<D>,
    /// Its distance from there in deviations of the noise.
    pub(super) deviations: f64,
    /// Chance that noise makes the worst of all points this bad.
    pub(super) chance: f64,
}

/// The slips among the points of a free fit.
///
/// # Errors
/// When the control says stop.
pub(super) fn suspects<const D: usize>(
    shape: &Shape<D>,
    springs: &Springs<D>,
    (choice, doubtful): (&Choice, &[usize]),
    control: &dyn Control,
) -> Result<Vec<Suspect<D>>, Stop> {
    /// Times that slips are sought anew with the points of bends back.
    const LOOKS: usize = 4;
    let mut springs = springs.clone();
    for _ in 0..LOOKS {
        let (mut rest, mut others) = (shape.clone(), springs.clone());
        let mut set_aside = set_aside(&mut rest, &mut others, choice, control)?;
        set_aside.extend(still_doubtful(shape, &springs, choice, doubtful));
        if set_aside.is_empty() {
            return Ok(Vec::new());
        }
        others.weights.clone_from(&springs.weights);
        for (i, _) in &set_aside {
            others.weights[*i] = 0.0;
        }
        let settled = settle(&mut rest, &mut others, &mut Holds::none(), control)?;
        let away = others.residuals(&rest.space, &rest.x);
        let indices: Vec<usize> = set_aside.iter().map(|s| s.0).collect();
        let bent = bends(&indices, &others, (&away, rest.space.is_closed()));
        if !bent.contains(&true) {
            return Ok(described(&set_aside, (&rest, &others), settled.noise));
        }
        // Shape: in the fit again, and not asked about any more.
        springs.pin(indices.iter().zip(&bent).filter(|b| *b.1).map(|b| *b.0));
    }
    Ok(Vec::new())
}

/// Points that a fit of the others does not expect, with their chances.
fn set_aside<const D: usize>(
    shape: &mut Shape<D>,
    springs: &mut Springs<D>,
    choice: &Choice,
    control: &dyn Control,
) -> Result<Vec<(usize, f64)>, Stop> {
    let count = springs.weights.iter().filter(|w| **w > 0.0).count();
    if count <= TRY_EACH {
        one_by_one(shape, springs, choice, control)
    } else {
        by_medians(shape, springs, control)
    }
}

/// Of the points that are not in the fit, those that it does not expect.
fn still_doubtful<const D: usize>(
    shape: &Shape<D>,
    springs: &Springs<D>,
    choice: &Choice,
    doubtful: &[usize],
) -> Vec<(usize, f64)> {
    let count = springs.weights.iter().filter(|w| **w > 0.0).count() as f64;
    let freedom = (count - choice.degrees_of_freedom / (D - 1) as f64).max(1.0);
    let chance = |i: usize| {
        // Its distance is all its own, as a prediction's.
        let e = springs.points[i] - shape.space.point(&shape.x, springs.feet[i]);
        let ratio = e.norm_squared() / (D - 1) as f64 / choice.noise.max(LEAST_NOISE).powi(2);
        count * LOG_STEPS.len() as f64 * tail(ratio / PREDICTED, D - 1, freedom)
    };
    let each = doubtful.iter().filter(|i| !springs.pinned[**i]);
    each.map(|i| (*i, chance(*i)))
        .filter(|s| s.1 < SURE)
        .collect()
}

/// The points set aside against the fit without them, the surest first.
fn described<const D: usize>(
    set_aside: &[(usize, f64)],
    (shape, springs): (&Shape<D>, &Springs<D>),
    noise: f64,
) -> Vec<Suspect<D>> {
    let describe = |(index, chance): &(usize, f64)| {
        let expected = shape.space.point(&shape.x, springs.feet[*index]);
        let off = (springs.points[*index] - expected).norm();
        Suspect {
            index: *index,
            expected,
            deviations: off / noise.max(f64::MIN_POSITIVE),
            chance: *chance,
        }
    };
    let all = set_aside.iter().map(describe);
    let mut found: Vec<Suspect<D>> = all.filter(|s| s.deviations > LEAST_DEVIATIONS).collect();
    found.sort_by(|a, b| a.chance.total_cmp(&b.chance).then(a.index.cmp(&b.index)));
    found
}

/// A candidate for deletion: its score without it, F, freedom of the rest.
#[derive(Clone, Copy)]
struct Deletion {
    index: usize,
    score: f64,
    ratio: f64,
    freedom: f64,
}

fn one_by_one<const D: usize>(
    shape: &Shape<D>,
    springs: &mut Springs<D>,
    choice: &Choice,
    control: &dyn Control,
) -> Result<Vec<(usize, f64)>, Stop> {
    let count = springs.weights.iter().filter(|w| **w > 0.0).count();
    let most = ((MOST_SHARE * count as f64) as usize).max(1);
    let mut found = Vec::new();
    while found.len() < most {
        control.check()?;
        let Some(worst) = worst_deletion(shape, springs, choice) else {
            break;
        };
        let looks = (count * LOG_STEPS.len()) as f64;
        let chance = (looks * tail(worst.ratio, D - 1, worst.freedom)).min(1.0);
        if chance >= SURE {
            break;
        }
        springs.weights[worst.index] = 0.0;
        found.push((worst.index, chance));
    }
    Ok(found)
}

/// The point whose deletion, at the stiffness that is likeliest without it,
/// has the greatest F.
fn worst_deletion<const D: usize>(
    shape: &Shape<D>,
    springs: &Springs<D>,
    choice: &Choice,
) -> Option<Deletion> {
    let gram = springs.gram(&shape.space, &shape.x);
    let offsets = Offsets::about(&shape.space, &shape.energy, &gram, &shape.x);
    let grid = LOG_STEPS.map(|step| choice.likeliest + step);
    let table: Vec<Vec<Deletion>> = grid
        .iter()
        .map(|t| deletions(shape, springs, &offsets, *t))
        .collect();
    let worst_of = |row: &Vec<Deletion>| {
        let by = |a: &&Deletion, b: &&Deletion| a.ratio.total_cmp(&b.ratio);
        row.iter().max_by(by).map(|d| d.index)
    };
    let candidates: Vec<usize> = table.iter().filter_map(worst_of).collect();
    candidates
        .into_iter()
        .filter_map(|index| {
            let own = table.iter().flatten().filter(|d| d.index == index);
            own.min_by(|a, b| a.score.total_cmp(&b.score)).copied()
        })
        .max_by(|a, b| a.ratio.total_cmp(&b.ratio))
}

fn deletions<const D: usize>(
    shape: &Shape<D>,
    springs: &Springs<D>,
    offsets: &Offsets<D>,
    log_stiffness: f64,
) -> Vec<Deletion> {
    let Some((h, q, log)) = offsets.solve(log_stiffness.exp()) else {
        return Vec::new();
    };
    let Some(factor) = offsets.factored(log_stiffness.exp()) else {
        return Vec::new();
    };
    let each = (D - 1) as f64;
    let freedom = offsets.freedom() - each;
    let space = &shape.space;
    let deletion = |i: usize| {
        let w = springs.weights[i];
        // What would be at an end or a knuckle without its point nobody knows.
        if w <= 0.0 || freedom < 1.0 || springs.pinned[i] {
            return None;
        }
        let basis = space.basis::<2>(springs.feet[i]);
        let away = springs.points[i] - space.combine(basis.first, basis.values(), &shape.x);
        let along = space.combine(basis.first, basis.derivative(1), &shape.x);
        let d = across(&away, &along) - space.combine(basis.first, basis.values(), &h);
        let mut z = vec![0.0; space.unknowns()];
        for (k, b) in basis.values().iter().enumerate() {
            z[space.unknown(basis.first + k)] += b;
        }
        let row = z.clone();
        factor.solve_in_place(&mut z);
        let leverage = w * row.iter().zip(&z).map(|(a, b)| a * b).sum::<f64>();
        let left = (1.0 - leverage).max(1e-6);
        let gain = w * d.norm_squared() / left;
        let rest = (q - gain).max(1e-3 * q) + offsets.least_sum();
        Some(Deletion {
            index: i,
            score: freedom * rest.ln() + offsets.log_prior(log, log_stiffness) + each * left.ln(),
            ratio: gain / each / (rest / freedom),
            freedom,
        })
    };
    (0..springs.points.len()).filter_map(deletion).collect()
}

fn by_medians<const D: usize>(
    shape: &mut Shape<D>,
    springs: &mut Springs<D>,
    control: &dyn Control,
) -> Result<Vec<(usize, f64)>, Stop> {
    let given = springs.weights.clone();
    let count = given.iter().filter(|w| **w > 0.0).count() as f64;
    let mut found: Vec<(usize, f64)> = Vec::new();
    for _ in 0..ROUNDS {
        control.check()?;
        let residuals = springs.residuals(&shape.space, &shape.x);
        let sizes: Vec<f64> = residuals.iter().map(Vector::norm).collect();
        let noise = spread::<D>(&sizes, &given);
        let chance = |d: f64| count * tail((d / noise).powi(2) / (D - 1) as f64, D - 1, count);
        let next: Vec<(usize, f64)> = (0..sizes.len())
            .filter(|i| given[*i] > 0.0 && !springs.pinned[*i])
            .map(|i| (i, chance(sizes[i])))
            .filter(|(_, chance)| *chance < SURE)
            .collect();
        let same = next.len() == found.len() && next.iter().zip(&found).all(|(a, b)| a.0 == b.0);
        let too_many = next.len() as f64 > MOST_SHARE * count;
        if same || too_many {
            return Ok(if too_many { Vec::new() } else { next });
        }
        found = next;
        springs.weights.clone_from(&given);
        for (i, _) in &found {
            springs.weights[*i] = 0.0;
        }
        settle(shape, springs, &mut Holds::none(), control)?;
    }
    Ok(found)
}

/// σ of one coordinate from the median of the distances: |N(0, 1)| has the
/// median 0.6745, the length of a plane normal vector √(2 ln 2).
pub(super) fn spread<const D: usize>(sizes: &[f64], weights: &[f64]) -> f64 {
    let mut used: Vec<f64> = sizes
        .iter()
        .zip(weights)
        .filter(|(_, w)| **w > 0.0)
        .map(|(s, _)| *s)
        .collect();
    let middle = used.len() / 2;
    let (_, median, _) = used.select_nth_unstable_by(middle, f64::total_cmp);
    let of_unit = if D == 2 {
        0.674_489_75
    } else {
        (2.0 * 2f64.ln()).sqrt()
    };
    (*median / of_unit).max(f64::MIN_POSITIVE)
}

/// P(F ≥ ratio) for `offsets` (1 or 2) and `freedom` degrees of freedom.
fn tail(ratio: f64, offsets: usize, freedom: f64) -> f64 {
    if offsets == 2 {
        return (1.0 + 2.0 * ratio / freedom).powf(-0.5 * freedom);
    }
    two_sided(ratio.sqrt(), freedom)
}

#[cfg(test)]
mod tests {
    use super::tail;

    /// F(2, 10) at 4.10: 0.05; F(1, 9) at 3.250² as t₉, 0.01.
    #[test]
    fn tails_agree_with_tables() {
        assert!((tail(4.103, 2, 10.0) - 0.05).abs() < 1e-3);
        assert!((tail(3.250_f64.powi(2), 1, 9.0) - 0.01).abs() < 1e-3);
    }
}
