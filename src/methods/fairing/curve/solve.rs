//! From a task to a fair curve: start, free fit, net, slips, tolerances.

use super::energy::{Energy, Quadratic};
use super::free::{HELD, Shape, first_shape, settle, soft_shape};
use super::holds::{Condition, Holds};
use super::input::{Task, degree_of};
use super::net::{FIRST_SPANS, MOST_SPANS, misses_shape, split, transfer};
use super::request::{Options, Request};
use super::slips::{Suspect, suspects};
use super::space::Vector;
use super::springs::{Gram, Springs};
use super::start::{Breaks, space_for};
use super::stiffness::{Choice, Offsets};
use super::within::{Bounds, Terms, enter, fairest};
use crate::methods::FitError;
use crate::solver::{Control, Stop};

/// Points with their parameters along a first curve.
#[derive(Debug, Clone)]
pub(super) struct Traced {
    /// A parameter for each point.
    pub(super) parameters: Vec<f64>,
    /// First and last parameter.
    pub(super) domain: [f64; 2],
    /// Whether the curve is closed.
    pub(super) closed: bool,
    /// Points that the first look takes for slips.
    pub(super) doubtful: Vec<usize>,
}

/// A fair curve with all that is known about it, in unit scale.
#[derive(Debug, Clone)]
pub(super) struct Solved<const D: usize> {
    /// The curve.
    pub(super) shape: Shape<D>,
    /// The points with their feet.
    pub(super) springs: Springs<D>,
    /// Noise and stiffness of the fit without tolerances.
    pub(super) choice: Choice,
    /// Multiplier of each point's bound; empty without tolerances.
    pub(super) duals: Vec<f64>,
    /// Duality gap.
    pub(super) gap: Option<f64>,
    /// Steps of the last solver.
    pub(super) steps: usize,
    /// Why the control points are as many as they are.
    pub(super) net: &'static str,
    /// Points that look like slips.
    pub(super) suspects: Vec<Suspect<D>>,
    /// Largest share of a tolerance in use; 0 without.
    pub(super) used: f64,
    /// Tolerances as used: infinite for disregarded points.
    pub(super) tolerances: Vec<f64>,
    /// Tolerance factor, largest share used, energy, largest move.
    pub(super) trade_off: Vec<[f64; 4]>,
}

/// The state that the stages share.
pub(super) struct Bench<'a, const D: usize> {
    pub(super) task: &'a Task<D>,
    pub(super) traced: &'a Traced,
    pub(super) options: &'a Options,
    pub(super) control: &'a dyn Control,
    pub(super) quadratic: Option<Quadratic>,
}

/// Solves a task with this crate's own solver.
///
/// # Errors
/// When the control says stop, or where a system cannot be solved.
pub(super) fn solve<const D: usize>(
    request: &Request,
    task: &Task<D>,
    traced: &Traced,
    control: &dyn Control,
) -> Result<Solved<D>, FitError> {
    let bench = Bench {
        task,
        traced,
        options: &request.options,
        control,
        quadratic: request
            .options
            .energy
            .map(|e| [e.tension, e.bending, e.jerk]),
    };
    let (mut fit, suspects) = bench.free()?;
    let mut tolerances = task.tolerances.clone();
    if request.options.robust {
        for s in &suspects {
            tolerances[s.index] = f64::INFINITY;
        }
    } else if !suspects.is_empty() {
        // The slips are told but hold the curve as all points do.
        let spans = fit.shape.space.spans().len();
        fit = bench.fit_with(spans, fit.net, &[])?;
    }
    control.progress("fairing", 60.0);
    let mut solved = Solved {
        choice: fit.choice,
        duals: Vec::new(),
        gap: None,
        steps: 0,
        net: fit.net,
        suspects,
        used: 0.0,
        trade_off: Vec::new(),
        shape: fit.shape.clone(),
        springs: fit.springs.clone(),
        tolerances,
    };
    if task.has_tolerance() {
        bench.within(fit, &mut solved)?;
    }
    Ok(solved)
}

/// A free fit.
pub(super) struct Free<const D: usize> {
    pub(super) shape: Shape<D>,
    pub(super) springs: Springs<D>,
    pub(super) holds: Holds<D>,
    pub(super) choice: Choice,
    pub(super) net: &'static str,
}

/// The points of slips, sorted.
fn indices<const D: usize>(found: &[Suspect<D>]) -> Vec<usize> {
    let mut all: Vec<usize> = found.iter().map(|s| s.index).collect();
    all.sort_unstable();
    all
}

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

/// ∫ |r‴|² du.
const PLAIN: Quadratic = [0.0, 0.0, 1.0];
/// Share of the tolerances from which the walk to the fairest can begin.
const NEAR_ENOUGH: f64 = 0.97;
/// Share beyond which a point asks for a richer spline.
const BEYOND: f64 = 0.98;
/// Prices of slack, in energies of the first curve: the dearer, the rougher
/// the curve may become to enter the bounds.
const PRICES: [f64; 3] = [1e1, 1e3, 1e6];

impl<const D: usize> Free<D> {
    fn terms<'a>(&'a self, bounds: Bounds<'a, D>) -> Terms<'a, D> {
        Terms {
            space: &self.shape.space,
            energy: &self.shape.energy,
            holds: &self.holds,
            bounds,
        }
    }
}

impl<const D: usize> Bench<'_, D> {
    /// The fit without tolerances and without slips, with as many spans as the
    /// shape needs. Slips first, as they look like shape to a rich spline.
    fn free(&self) -> Result<(Free<D>, Vec<Suspect<D>>), FitError> {
        /// Times that slips are sought anew without those found.
        const LOOKS: usize = 4;
        let most = self.most_spans();
        let (mut spans, mut net) = match self.asked_spans() {
            Some(n) => (n, "asked"),
            None if most <= FIRST_SPANS || 4 * self.held().len() > FIRST_SPANS => {
                (most, "one a point")
            }
            None => (FIRST_SPANS, "enough for the shape"),
        };
        let mut without = self.traced.doubtful.clone();
        let mut fit = self.fit_with(spans, net, &without)?;
        let mut found = self.suspects(&fit, &without)?;
        for _ in 0..LOOKS {
            let next = indices(&found);
            if next == without {
                break;
            }
            without = next;
            fit = self.fit_with(spans, net, &without)?;
            found = self.suspects(&fit, &without)?;
        }
        while net != "asked" && spans < most && self.is_poor(&fit) {
            spans = (2 * spans).min(most);
            if spans == most {
                net = "one a point";
            }
            fit = self.fit_with(spans, net, &without)?;
            found = self.suspects(&fit, &without)?;
        }
        Ok((fit, found))
    }

    fn suspects(&self, fit: &Free<D>, without: &[usize]) -> Result<Vec<Suspect<D>>, Stop> {
        suspects(
            &fit.shape,
            &fit.springs,
            (&fit.choice, without),
            self.control,
        )
    }

    fn is_poor(&self, fit: &Free<D>) -> bool {
        let residuals = fit.springs.residuals(&fit.shape.space, &fit.shape.x);
        fit.choice.noise > 0.0 && misses_shape(&fit.shape.space, &fit.springs, &residuals)
    }

    fn intervals(&self) -> usize {
        let n = self.task.points.len();
        if self.traced.closed { n } else { n - 1 }
    }

    fn most_spans(&self) -> usize {
        let least = if self.traced.closed {
            2 * self.degree() + 2
        } else {
            1
        };
        self.intervals().clamp(least, MOST_SPANS)
    }

    fn degree(&self) -> usize {
        degree_of(self.options)
    }

    fn asked_spans(&self) -> Option<usize> {
        let degree = self.degree();
        self.options.control_points.map(|n| {
            if self.traced.closed {
                // A clamped closed curve has degree more control points than
                // the closed polygon.
                n.saturating_sub(degree).max(2 * degree + 2)
            } else {
                n.saturating_sub(degree).max(1)
            }
        })
    }

    /// The free fit in a space of `spans` spans.
    fn fit_with(
        &self,
        spans: usize,
        net: &'static str,
        without: &[usize],
    ) -> Result<Free<D>, FitError> {
        /// What may be left of the holds before the energy is held unfit.
        const FAR: f64 = 1e-7;
        let (fit, unheld) = self.fit_by(spans, (net, without), self.quadratic)?;
        if self.quadratic.is_some() || unheld <= FAR {
            return Ok(fit);
        }
        // Held points so rough that ∫ κ′² ds finds no way to them: the
        // quadratic energy always does.
        Ok(self.fit_by(spans, (net, without), Some(PLAIN))?.0)
    }

    fn fit_by(
        &self,
        spans: usize,
        (net, without): (&'static str, &[usize]),
        quadratic: Option<Quadratic>,
    ) -> Result<(Free<D>, f64), FitError> {
        /// Rounds of the multipliers beyond those of the fit.
        const MORE_ROUNDS: usize = 30;
        let t = self.traced;
        let data = (&t.parameters[..], t.domain, t.closed);
        let space = space_for(self.degree(), data, spans, &self.breaks())
            .map_err(|e| FitError::Numerical(e.to_string()))?;
        let mut springs = self.springs(without);
        let broken = || FitError::Numerical("the points do not determine a curve".into());
        let mut shape = first_shape(space, &springs, quadratic).ok_or_else(broken)?;
        let held = self.held();
        let mut holds = self.holds(&shape, &held);
        for i in &held {
            springs.weights[*i] = 0.0;
        }
        if 2 * held.len() >= springs.points.len() {
            // Interpolation: parameters stay, so that knots and points keep
            // interlacing (Schoenberg–Whitney).
            springs.pin(held.iter().copied());
        }
        springs.held = held;
        let choice = settle(&mut shape, &mut springs, &mut holds, self.control)?;
        for _ in 0..MORE_ROUNDS {
            if holds.residual(&shape.space, &shape.x) <= HELD {
                break;
            }
            self.control.check()?;
            let gram = springs.gram(&shape.space, &shape.x);
            shape.balance(&gram, &holds, choice.stiffness);
            holds.tighten(&shape.space, &shape.x);
        }
        if !shape.x.iter().all(|v| v.iter().all(|c| c.is_finite())) {
            return Err(broken());
        }
        let unheld = holds.residual(&shape.space, &shape.x);
        let fit = Free {
            shape,
            springs,
            holds,
            choice,
            net,
        };
        Ok((fit, unheld))
    }

    fn springs(&self, without: &[usize]) -> Springs<D> {
        let mut springs = Springs::new(
            self.task.points.clone(),
            self.task.weights.clone(),
            self.traced.parameters.clone(),
            self.task.metric,
        );
        for i in without {
            springs.weights[*i] = 0.0;
        }
        springs.pin(self.ends(without));
        springs.pin(self.task.knuckles.iter().copied());
        for [a, b] in &self.task.straight {
            springs.pin([*a, *b]);
        }
        springs
    }

    /// The points at the two ends of an open curve.
    fn ends(&self, without: &[usize]) -> Vec<usize> {
        if self.traced.closed {
            return Vec::new();
        }
        let u = &self.traced.parameters;
        let by = |a: &usize, b: &usize| u[*a].total_cmp(&u[*b]);
        let mut out = vec![false; u.len()];
        without.iter().for_each(|i| out[*i] = true);
        let all = || (0..u.len()).filter(|i| !out[*i]);
        all()
            .min_by(by)
            .into_iter()
            .chain(all().max_by(by))
            .collect()
    }

    /// Points that must stay.
    fn held(&self) -> Vec<usize> {
        (0..self.task.points.len())
            .filter(|i| self.task.tolerances[*i] == 0.0)
            .collect()
    }

    fn breaks(&self) -> Breaks {
        let u = &self.traced.parameters;
        let [a, b] = self.traced.domain;
        let inside = |t: &f64| *t > a && *t < b;
        Breaks {
            corners: self
                .task
                .knuckles
                .iter()
                .map(|i| u[*i])
                .filter(inside)
                .collect(),
            joints: self
                .task
                .straight
                .iter()
                .flatten()
                .map(|i| u[*i])
                .filter(inside)
                .collect(),
        }
    }

    fn holds(&self, shape: &Shape<D>, held: &[usize]) -> Holds<D> {
        let mut holds = Holds::none();
        let (t, u) = (self.task, &self.traced.parameters);
        for i in held {
            let place = Condition::Place(t.points[*i], Vector::repeat(1.0));
            holds.push(u[*i], place, true);
        }
        for k in 0..2 {
            let end = self.traced.domain[k];
            if let Some(direction) = t.tangents[k] {
                holds.push(end, Condition::Direction(direction), false);
            }
            if let Some(curvature) = t.curvatures[k] {
                holds.push(end, Condition::Curvature(curvature), false);
            }
        }
        if t.metric.iter().any(|m| *m != 1.0) {
            // Ends have no foot to find: they keep the coordinates that are
            // not free.
            for i in self
                .ends(&self.traced.doubtful)
                .into_iter()
                .filter(|i| !held.contains(i))
            {
                holds.push(u[i], Condition::Place(t.points[i], t.metric), false);
            }
        }
        for [a, b] in &t.straight {
            holds.straighten(&shape.energy.nodes, [u[*a], u[*b]]);
        }
        holds
    }

    /// The fairest curve within the tolerances, in a richer space if need be.
    fn within(&self, mut fit: Free<D>, solved: &mut Solved<D>) -> Result<(), FitError> {
        /// Times that spans may be halved where the bounds ask for it.
        const MOST_SPLITS: usize = 10;
        let limits = limits(&solved.tolerances);
        let mut used = self.approach(&mut fit, &limits)?;
        if used >= 1.0 && fit.net != "asked" {
            let mut near = self.rough(&fit)?;
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
        self.trade_off(fit, solved)
    }

    /// The other end from which to enter the bounds: the curve of ∫ |r‴|² du
    /// nearly through the points, instead of the stiffest they allow.
    fn rough(&self, fit: &Free<D>) -> Result<Free<D>, FitError> {
        let spans = self.most_spans().max(fit.shape.space.spans().len());
        let t = self.traced;
        let data = (&t.parameters[..], t.domain, t.closed);
        let space = space_for(self.degree(), data, spans.min(MOST_SPANS), &self.breaks())
            .map_err(|e| FitError::Numerical(e.to_string()))?;
        let mut springs = fit.springs.clone();
        springs.feet.clone_from(&t.parameters);
        let broken = || FitError::Numerical("the points do not determine a curve".into());
        let shape = soft_shape(space, &springs, self.quadratic).ok_or_else(broken)?;
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
        let energy = Energy::new(&space, fit.shape.energy.quadratic);
        fit.shape = Shape { space, x, energy };
        fit.shape.relieve();
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
        for price in PRICES {
            let bounds = Bounds {
                tolerance: tolerances,
                others: &lazy,
            };
            let terms = fit.terms(bounds);
            let (mut x, mut springs) = (fit.shape.x.clone(), fit.springs.clone());
            let entered = enter(&terms, &mut springs, &mut x, price, self.control)?;
            (fit.shape.x, fit.springs) = (x, springs);
            if entered.slack < 0.0 {
                break;
            }
        }
        Ok(worst(&fit.shape, &fit.springs, tolerances))
    }

    /// The interior point walk, with the multipliers of the holds around it.
    fn walk(&self, fit: &mut Free<D>, tolerances: &[f64]) -> Result<super::within::Fairest, Stop> {
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
            let bounds = Bounds {
                tolerance: tolerances,
                others: &lazy,
            };
            let (mut x, mut springs) = (fit.shape.x.clone(), fit.springs.clone());
            let walked = fairest(&fit.terms(bounds), &mut springs, &mut x, self.control)?;
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
    fn walk_with_feet(
        &self,
        fit: &mut Free<D>,
        tolerances: &[f64],
    ) -> Result<super::within::Fairest, Stop> {
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

    /// What other tolerances would give, each from the last.
    fn trade_off(&self, mut fit: Free<D>, solved: &mut Solved<D>) -> Result<(), FitError> {
        /// Factors of the tolerances, from the feasible side.
        const FACTORS: [f64; 4] = [4.0, 2.0, 0.5, 0.25];
        /// Points beyond which the table would cost more than the fit.
        const MOST_POINTS: usize = 20_000;
        let row = |factor: f64, used: f64, shape: &Shape<D>, springs: &Springs<D>| {
            let energy = shape.energy.cost(&shape.space, &shape.x)[0];
            let residuals = springs.residuals(&shape.space, &shape.x);
            let most = residuals.iter().map(Vector::norm).fold(0.0, f64::max);
            [factor, used, energy, most]
        };
        let own = row(1.0, solved.used, &solved.shape, &solved.springs);
        solved.trade_off.push(own);
        if self.task.points.len() <= MOST_POINTS {
            for factor in FACTORS {
                let own = limits(&solved.tolerances);
                let tolerances: Vec<f64> = own.iter().map(|t| t * factor).collect();
                let used = self.approach(&mut fit, &tolerances)?;
                if used >= 1.0 {
                    solved
                        .trade_off
                        .push(row(factor, used, &fit.shape, &fit.springs));
                    continue;
                }
                let kept = (fit.shape.clone(), fit.springs.clone(), fit.holds.clone());
                self.walk(&mut fit, &tolerances)?;
                let used = worst(&fit.shape, &fit.springs, &tolerances);
                solved
                    .trade_off
                    .push(row(factor, used, &fit.shape, &fit.springs));
                (fit.shape, fit.springs, fit.holds) = kept;
            }
        }
        solved.trade_off.sort_by(|a, b| a[0].total_cmp(&b[0]));
        Ok(())
    }
}
