//! The fairest curve within the tolerances: entering them, the walk, a richer
//! spline where no curve of the present one is within, and what other
//! tolerances would give.

use super::energy::Energy;
use super::free::{FIRST_ENERGY, HELD, Shape, soft_shape};
use super::holds::Holds;
use super::members::{self, Programme};
use super::net::{MOST_SPANS, split, transfer};
use super::solve::{Bench, Free, Solved};
use super::space::{Space, Vector};
use super::springs::{Gram, Springs};
use super::start::space_for;
use super::stiffness::Offsets;
use super::within::{Bounds, Fairest, Terms, currency, enter, fairest};
use crate::methods::FitError;
use crate::solver::{Control, Stop};

/// Share of the tolerances from which the walk to the fairest can begin.
const NEAR_ENOUGH: f64 = 0.97;
/// Share beyond which a point asks for a richer spline.
const BEYOND: f64 = 0.98;
/// Prices of slack, in energies of the first curve: the dearer, the rougher
/// the curve may become to enter the bounds.
const PRICES: [f64; 3] = [1e1, 1e3, 1e6];

/// The bounds of a walk: held points have a hold instead.
fn limits(tolerances: &[f64]) -> Vec<f64> {
    let limit = |t: &f64| if *t > 0.0 { *t } else { f64::INFINITY };
    tolerances.iter().map(limit).collect()
}

/// The largest share of a tolerance that a point uses.
pub(super) fn worst<const D: usize>(
    shape: &Shape<D>,
    springs: &Springs<D>,
    tolerances: &[f64],
) -> f64 {
    springs
        .residuals(&shape.space, &shape.x)
        .iter()
        .zip(tolerances)
        .filter(|(_, t)| t.is_finite() && **t > 0.0)
        .map(|(e, t)| e.norm() / t)
        .fold(0.0, f64::max)
}

/// The walk to the fairest curve, for any of the points.
struct Walk<'a, const D: usize> {
    space: &'a Space,
    energy: &'a Energy,
    holds: &'a Holds<D>,
    lazy: &'a Gram<D>,
    control: &'a dyn Control,
}

/// The way into the bounds, at a price of slack.
struct WayIn<'a, const D: usize> {
    walk: Walk<'a, D>,
    price: f64,
}

impl<'a, const D: usize> Walk<'a, D> {
    fn terms(&self, tolerance: &'a [f64]) -> Terms<'a, D> {
        Terms {
            space: self.space,
            energy: self.energy,
            holds: self.holds,
            bounds: Bounds {
                tolerance,
                others: self.lazy,
            },
        }
    }
}

impl<const D: usize> Programme<D> for Walk<'_, D> {
    const GOES_ON: bool = false;

    fn solve(
        &self,
        springs: &mut Springs<D>,
        tolerances: &[f64],
        x: &mut Vec<Vector<D>>,
    ) -> Result<Fairest, Stop> {
        fairest(&self.terms(tolerances), springs, x, self.control)
    }
}

impl<const D: usize> Programme<D> for WayIn<'_, D> {
    const GOES_ON: bool = true;

    fn solve(
        &self,
        springs: &mut Springs<D>,
        tolerances: &[f64],
        x: &mut Vec<Vector<D>>,
    ) -> Result<Fairest, Stop> {
        let terms = self.walk.terms(tolerances);
        enter(&terms, springs, x, self.price, self.walk.control)
    }
}

impl<const D: usize> Bench<'_, D> {
    /// The fairest curve within the tolerances, in a richer space if need be.
    pub(super) fn within(&self, mut fit: Free<D>, solved: &mut Solved<D>) -> Result<(), FitError> {
        /// Times that spans may be halved where the bounds ask for it.
        const MOST_SPLITS: usize = 10;
        let limits = limits(&solved.tolerances);
        let free = fit.clone();
        let mut used = self.approach(&mut fit, &limits)?;
        // Ever more spans at the feet of the fit, in the end at the places that
        // the points have by themselves.
        let first = fit.shape.space.spans().len();
        let most = self.most_spans().max(first);
        let doubled = std::iter::successors(Some(2 * first), |n| (*n < most).then_some(2 * n));
        let own = self.traced.parameters.clone();
        let tries = doubled
            .map(|n| (n.min(most), fit.springs.feet.clone()))
            .chain([(most, own)]);
        for (spans, feet) in tries.collect::<Vec<_>>() {
            if used < 1.0 || fit.net == "asked" {
                break;
            }
            let mut near = self.rough(&fit, spans, feet)?;
            let other = self.approach(&mut near, &limits)?;
            if other < used {
                (fit, used) = (near, other);
            }
        }
        for _ in 0..MOST_SPLITS {
            // Beyond a span a point no spline helps, only another tolerance.
            let full = fit.shape.space.unknowns() > self.most_spans() + self.degree();
            if used < 1.0 || full || fit.net == "asked" || !self.enrich(&mut fit, &limits) {
                break;
            }
            used = self.approach(&mut fit, &limits)?;
        }
        solved.net = fit.net;
        if used >= 1.0 {
            solved.used = used;
            solved.shape = fit.shape;
            solved.springs = fit.springs;
            return Ok(());
        }
        let inner = (fit.shape.clone(), fit.springs.clone(), fit.holds.clone());
        let best = self.walk_with_feet(&mut fit, &limits)?;
        solved.duals = best.duals;
        solved.gap = Some(best.gap);
        solved.steps = best.steps;
        solved.used = worst(&fit.shape, &fit.springs, &limits);
        solved.shape = fit.shape.clone();
        solved.springs = fit.springs.clone();
        (fit.shape, fit.springs, fit.holds) = inner;
        self.trade_off([&free, &fit], solved)
    }

    /// The other end from which to enter the bounds: the curve of ∫ |r‴|² du
    /// nearly through the points, instead of the stiffest they allow.
    fn rough(&self, fit: &Free<D>, spans: usize, feet: Vec<f64>) -> Result<Free<D>, FitError> {
        let t = self.traced;
        let data = (&t.parameters[..], t.domain, t.closed);
        let space = space_for(self.degree(), data, spans.min(MOST_SPANS), &self.breaks())
            .map_err(|e| FitError::Numerical(e.to_string()))?;
        let mut springs = fit.springs.clone();
        springs.feet = feet;
        let broken = || FitError::Numerical("the points do not determine a curve".into());
        let mut shape = soft_shape(space, &springs, self.quadratic).ok_or_else(broken)?;
        // The curvature of a curve through the points is mostly noise.
        shape.energy.relieve_as(&fit.shape.energy);
        let mut holds = self.holds(&shape, &springs.held);
        holds.follow(springs.held_feet());
        Ok(Free {
            shape,
            springs,
            holds,
            choice: fit.choice,
            net: "the tolerance",
        })
    }

    /// Halves the spans at points that are beyond their tolerance.
    fn enrich(&self, fit: &mut Free<D>, tolerances: &[f64]) -> bool {
        let shape = &fit.shape;
        let residuals = fit.springs.residuals(&shape.space, &shape.x);
        let beyond = residuals.iter().zip(tolerances).zip(&fit.springs.feet);
        let at: Vec<f64> = beyond
            .filter(|((e, t), _)| t.is_finite() && e.norm() > BEYOND * **t)
            .map(|(_, u)| *u)
            .collect();
        let Some(space) = split(&shape.space, &at) else {
            return false;
        };
        let Some(x) = transfer(&shape.space, &shape.x, &space) else {
            return false;
        };
        let mut energy = Energy::new(&space, fit.shape.energy.quadratic);
        energy.relieve_as(&fit.shape.energy);
        fit.shape = Shape { space, x, energy };
        fit.net = "the tolerance";
        fit.holds.unstraighten();
        for [a, b] in &self.task.straight {
            let u = &self.traced.parameters;
            fit.holds
                .straighten(&fit.shape.energy.nodes, [u[*a], u[*b]]);
        }
        true
    }

    /// Brings every point within its tolerance, if the spline can; returns
    /// the largest share of a tolerance in use.
    fn approach(&self, fit: &mut Free<D>, tolerances: &[f64]) -> Result<f64, Stop> {
        let used = worst(&fit.shape, &fit.springs, tolerances);
        if used <= NEAR_ENOUGH {
            return Ok(used);
        }
        let gram = fit.springs.gram(&fit.shape.space, &fit.shape.x);
        let offsets = Offsets::about(&fit.shape.space, &fit.shape.energy, &gram, &fit.shape.x);
        fit.holds
            .weigh(&fit.shape.space, 1.0, &offsets.stiffnesses());
        let lazy = self.lazy(fit, tolerances);
        // The way in is convex with the quadratic energy; ∫ κ′² would lead
        // into cusps, which are as good a way in as any to it.
        let own = fit.shape.energy.quadratic;
        fit.shape.energy.quadratic = own.or(Some(FIRST_ENERGY));
        let currency = currency(&fit.shape.space, &fit.shape.energy, &fit.shape.x);
        let mut entered_at = Ok(0.0);
        for price in PRICES {
            let (mut x, mut springs) = (fit.shape.x.clone(), fit.springs.clone());
            let way_in = WayIn {
                walk: self.walk_of(fit, &fit.shape.energy, &lazy),
                price: price * currency,
            };
            let bounds = (&mut springs, tolerances);
            let entered = members::solve(&way_in, &fit.shape.space, bounds, &mut x);
            (fit.shape.x, fit.springs) = (x, springs);
            entered_at = entered.map(|e| e.slack);
            if !matches!(entered_at, Ok(slack) if slack >= 0.0) {
                break;
            }
        }
        fit.shape.energy.quadratic = own;
        entered_at?;
        Ok(worst(&fit.shape, &fit.springs, tolerances))
    }

    fn walk_of<'b>(
        &'b self,
        fit: &'b Free<D>,
        energy: &'b Energy,
        lazy: &'b Gram<D>,
    ) -> Walk<'b, D> {
        Walk {
            space: &fit.shape.space,
            energy,
            holds: &fit.holds,
            lazy,
            control: self.control,
        }
    }

    /// The interior point walk, with the multipliers of the holds around it.
    fn walk(&self, fit: &mut Free<D>, tolerances: &[f64]) -> Result<Fairest, Stop> {
        /// Rounds for the multipliers.
        const ROUNDS: usize = 6;
        let gram = fit.springs.gram(&fit.shape.space, &fit.shape.x);
        let offsets = Offsets::about(&fit.shape.space, &fit.shape.energy, &gram, &fit.shape.x);
        fit.holds
            .weigh(&fit.shape.space, 1.0, &offsets.stiffnesses());
        let lazy = self.lazy(fit, tolerances);
        let mut result = None;
        for _ in 0..ROUNDS {
            fit.holds.follow(fit.springs.held_feet());
            let (mut x, mut springs) = (fit.shape.x.clone(), fit.springs.clone());
            let space = &fit.shape.space;
            let far = fit.net == "the tolerance" && fit.shape.energy.quadratic.is_none();
            if result.is_none() && far {
                // Downhill from far on the convex side first: ∫ κ′² has cusps
                // to fall into.
                let mut convex = fit.shape.energy.clone();
                convex.quadratic = Some(FIRST_ENERGY);
                let downhill = self.walk_of(fit, &convex, &lazy);
                members::solve(&downhill, space, (&mut springs, tolerances), &mut x)?;
            }
            let walk = self.walk_of(fit, &fit.shape.energy, &lazy);
            let walked = members::solve(&walk, space, (&mut springs, tolerances), &mut x)?;
            (fit.shape.x, fit.springs) = (x, springs);
            result = Some(walked);
            if fit.holds.tighten(&fit.shape.space, &fit.shape.x) <= HELD {
                break;
            }
        }
        Ok(result.expect("there is at least one round"))
    }

    /// The walk where points are free in some axes only: their feet cannot
    /// wait to the end, and where one ends beyond its limit the limit is drawn
    /// in by that and the walk taken up again.
    fn walk_with_feet(&self, fit: &mut Free<D>, tolerances: &[f64]) -> Result<Fairest, Stop> {
        /// Times that limits are drawn in.
        const ROUNDS: usize = 8;
        /// What a limit keeps beyond what is needed.
        const SPARE: f64 = 0.995;
        let mut drawn_in = tolerances.to_vec();
        let mut best = self.walk(fit, tolerances)?;
        if fit.springs.is_free() {
            return Ok(best);
        }
        let [a, b] = fit.shape.space.domain();
        for _ in 0..ROUNDS {
            fit.springs
                .refresh(&fit.shape.space, &fit.shape.x, 0.1 * (b - a));
            if worst(&fit.shape, &fit.springs, tolerances) <= 1.0 {
                break;
            }
            let residuals = fit.springs.residuals(&fit.shape.space, &fit.shape.x);
            for ((own, e), t) in drawn_in.iter_mut().zip(&residuals).zip(tolerances) {
                if e.norm() > *t {
                    *own *= SPARE * t / e.norm();
                }
            }
            if self.approach(fit, &drawn_in)? < 1.0 {
                best = self.walk(fit, &drawn_in)?;
            }
        }
        Ok(best)
    }

    /// Springs so weak that they choose only among equally fair curves.
    fn lazy(&self, fit: &Free<D>, tolerances: &[f64]) -> Gram<D> {
        /// Their energy where every point is at its limit, as a share of the
        /// curve's.
        const LAZY: f64 = 1e-3;
        let energy = fit.shape.energy.cost(&fit.shape.space, &fit.shape.x)[0];
        let least = super::within::no_energy(&fit.shape.space);
        let mut springs = fit.springs.clone();
        let bounded = tolerances
            .iter()
            .filter(|t| t.is_finite() && **t > 0.0)
            .count();
        let share = LAZY * energy.max(least) / bounded.max(1) as f64;
        for (w, t) in springs.weights.iter_mut().zip(tolerances) {
            *w = if t.is_finite() && *t > 0.0 {
                share / (t * t)
            } else {
                0.0
            };
        }
        springs.gram(&fit.shape.space, &fit.shape.x)
    }

    /// What other tolerances would give: from the free fit, or, where that
    /// finds no way in, from where the walk began.
    fn trade_off(&self, starts: [&Free<D>; 2], solved: &mut Solved<D>) -> Result<(), FitError> {
        /// Factors of the tolerances.
        const FACTORS: [f64; 4] = [4.0, 2.0, 0.5, 0.25];
        /// Points beyond which the table would cost more than the fit.
        const MOST_POINTS: usize = 20_000;
        let own = trade_off_row(1.0, solved.used, &solved.shape, &solved.springs);
        solved.trade_off.push(own);
        if self.task.points.len() <= MOST_POINTS {
            for factor in FACTORS {
                let own = limits(&solved.tolerances);
                let tolerances: Vec<f64> = own.iter().map(|t| t * factor).collect();
                let mut fit = starts[0].clone();
                let mut used = self.approach(&mut fit, &tolerances)?;
                if used >= 1.0 && starts[1].shape.space != starts[0].shape.space {
                    fit = starts[1].clone();
                    used = self.approach(&mut fit, &tolerances)?;
                }
                if used < 1.0 {
                    self.walk(&mut fit, &tolerances)?;
                    used = worst(&fit.shape, &fit.springs, &tolerances);
                }
                let row = trade_off_row(factor, used, &fit.shape, &fit.springs);
                solved.trade_off.push(row);
            }
        }
        solved.trade_off.sort_by(|a, b| a[0].total_cmp(&b[0]));
        Ok(())
    }
}

/// Factor, share used, ∫ κ′² ds, largest move.
fn trade_off_row<const D: usize>(
    factor: f64,
    used: f64,
    shape: &Shape<D>,
    springs: &Springs<D>,
) -> [f64; 4] {
    // As it is measured, without weights along the curve.
    let energy = Energy::new(&shape.space, None).cost(&shape.space, &shape.x)[0];
    let residuals = springs.residuals(&shape.space, &shape.x);
    let most = residuals.iter().map(Vector::norm).fold(0.0, f64::max);
    [factor, used, energy, most]
}
