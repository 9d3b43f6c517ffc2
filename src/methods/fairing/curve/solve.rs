//! From a task to a fair curve: start, free fit, net, slips, tolerances.

use super::energy::Quadratic;
use super::free::{HELD, Shape, first_shape, settle};
use super::holds::{Condition, Holds};
use super::input::{Task, degree_of};
use super::net::{FIRST_SPANS, MOST_SPANS, misses_shape};
use super::request::{Options, Request};
use super::slips::{Suspect, suspects};
use super::space::Vector;
use super::springs::Springs;
use super::start::{Breaks, space_for};
use super::stiffness::Choice;
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
#[derive(Clone)]
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

/// ∫ |r‴|² du.
const PLAIN: Quadratic = [0.0, 0.0, 1.0];
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

    pub(super) fn most_spans(&self) -> usize {
        let least = if self.traced.closed {
            2 * self.degree() + 2
        } else {
            1
        };
        self.intervals().clamp(least, MOST_SPANS)
    }

    pub(super) fn degree(&self) -> usize {
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

    pub(super) fn breaks(&self) -> Breaks {
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

    pub(super) fn holds(&self, shape: &Shape<D>, held: &[usize]) -> Holds<D> {
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
}
