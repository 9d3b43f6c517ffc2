//! Slips: points that do not fit the fair shape of the others.
//!
//! Up to a few hundred points every point is tried: what would the fit be
//! without it? At a stiffness λ, with residual dᵢ and leverage ℓᵢ = w bᵢᵀ(G +
//! λH)⁻¹bᵢ, the sum Q without point i is Qᵢ = Q − w dᵢ²/(1 − ℓᵢ) (Cook &
//! Weisberg 1982, §2.2, which holds for penalised fits as well). As one slip
//! makes all points look noisy and so hides itself, λ is the likeliest
//! *without* the point. The worst point is tested by F = (w dᵢ²/(1 − ℓᵢ)) /
//! (Qᵢ/ν), its chance multiplied by the number of points (Bonferroni); if
//! that is small it is set aside and the rest is looked at again.
//!
//! Slips stand alone. A run of neighbours that are all off, each about as much
//! as the next, is a bend that the curve does not follow, and is not called
//! slips.
//!
//! Many points hide nothing: there the spread of the residuals is estimated by
//! its median, which a few per cent of slips do not move, points far outside
//! are set aside, and the rest is fitted anew until nothing changes.

use super::free::{Shape, settle};
use super::holds::Holds;
use super::space::Vector;
use super::springs::{Springs, across};
use super::stiffness::{Choice, Offsets};
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
    let (mut shape, mut springs) = (shape.clone(), springs.clone());
    let given = springs.weights.clone();
    let count = given.iter().filter(|w| **w > 0.0).count();
    let mut set_aside = if count <= TRY_EACH {
        one_by_one(&shape, &mut springs, choice, control)?
    } else {
        by_medians(&mut shape, &mut springs, control)?
    };
    for i in doubtful {
        // Not in the fit: its distance is all its own, as a prediction's.
        let e = springs.points[*i] - shape.space.point(&shape.x, springs.feet[*i]);
        let ratio = e.norm_squared() / (D - 1) as f64 / choice.noise.max(LEAST_NOISE).powi(2);
        let freedom = (count as f64 - choice.degrees_of_freedom / (D - 1) as f64).max(1.0);
        let chance = count as f64 * tail(ratio / PREDICTED, D - 1, freedom);
        if chance < SURE {
            set_aside.push((*i, chance));
        }
    }
    if set_aside.is_empty() {
        return Ok(Vec::new());
    }
    let residuals = springs.residuals(&shape.space, &shape.x);
    let set_aside = alone(set_aside, &springs, &residuals);
    if set_aside.is_empty() {
        return Ok(Vec::new());
    }
    for (w, given) in springs.weights.iter_mut().zip(&given) {
        *w = *given;
    }
    for (i, _) in &set_aside {
        springs.weights[*i] = 0.0;
    }
    let rest = settle(&mut shape, &mut springs, &mut Holds::none(), control)?;
    let noise = rest.noise.max(f64::MIN_POSITIVE);
    let mut found: Vec<Suspect<D>> = set_aside
        .into_iter()
        .map(|(index, chance)| {
            let expected = shape.space.point(&shape.x, springs.feet[index]);
            let deviations = (springs.points[index] - expected).norm() / noise;
            Suspect {
                index,
                expected,
                deviations,
                chance,
            }
        })
        .filter(|s| s.deviations > LEAST_DEVIATIONS)
        .collect();
    found.sort_by(|a, b| a.chance.total_cmp(&b.chance).then(a.index.cmp(&b.index)));
    Ok(found)
}

/// Of points set aside, those that are not part of a bend: a run along the
/// curve whose distances follow on one another.
fn alone<const D: usize>(
    found: Vec<(usize, f64)>,
    springs: &Springs<D>,
    residuals: &[Vector<D>],
) -> Vec<(usize, f64)> {
    /// Points in a row that make a run.
    const RUN: usize = 3;
    /// Neighbours of a bend differ by at most this share of the larger; slips
    /// that happen to be neighbours have nothing to do with one another.
    const FOLLOWS: f64 = 0.5;
    let mut along: Vec<usize> = (0..springs.feet.len()).collect();
    along.sort_by(|a, b| springs.feet[*a].total_cmp(&springs.feet[*b]).then(a.cmp(b)));
    let mut off = vec![false; along.len()];
    found.iter().for_each(|(i, _)| off[*i] = true);
    let mut kept = vec![false; along.len()];
    let follows = |pair: &[usize]| {
        let [a, b] = [residuals[pair[0]], residuals[pair[1]]];
        (a - b).norm() <= FOLLOWS * a.norm().max(b.norm())
    };
    for run in along.chunk_by(|a, b| off[*a] == off[*b]) {
        if off[run[0]] && (run.len() < RUN || !run.windows(2).all(follows)) {
            run.iter().for_each(|i| kept[*i] = true);
        }
    }
    found.into_iter().filter(|(i, _)| kept[*i]).collect()
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
        let chance = (count as f64 * tail(worst.ratio, D - 1, worst.freedom)).min(1.0);
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
    // Student's t as a normal deviate (Wallace 1959), and the bound of
    // Abramowitz & Stegun 7.1.13 for the normal tail, sharp at both ends.
    let z = (8.0 * freedom + 1.0) / (8.0 * freedom + 3.0)
        * (freedom * (ratio / freedom).ln_1p()).sqrt();
    let x = z / std::f64::consts::SQRT_2;
    let pi = std::f64::consts::PI;
    2.0 / pi.sqrt() * (-x * x).exp() / (x + (x * x + 4.0 / pi).sqrt())
}

#[cfg(test)]
mod tests {
    use super::tail;

    /// Tables: t₉(3.250) two-sided 0.01, t₃₀(2.042) 0.05, z 1.96 0.05.
    #[test]
    fn tails_agree_with_tables() {
        for (t, freedom, want) in [
            (3.250_f64, 9.0, 0.01),
            (2.042, 30.0, 0.05),
            (1.96, 1e6, 0.05),
        ] {
            let got = tail(t * t, 1, freedom);
            assert!((got / want - 1.0).abs() < 0.08, "{got} for {want}");
        }
        // F(2, 10) at 4.10: 0.05.
        assert!((tail(4.103, 2, 10.0) - 0.05).abs() < 1e-3);
    }
}
