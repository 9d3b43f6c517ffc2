//! From a target to the answer: the stages in order.

use super::count;
use super::engine::{Effort, Fitted};
use super::floor::floor;
use super::ladder::Ladder;
use super::minimax::{EIGHTH, exchanged};
use super::outcome::{ErrorPoint, Floor, Outcome, Report};
use super::report;
use super::request::{Goal, MOST_PIECES, Norm, Options, Request};
use super::robust::{cleaned, shares};
use super::segments::Segments;
use super::simplify::{near, simplified};
use super::strip::{Strip, oriented};
use super::target::Target;
use crate::methods::{Control, FitError};

/// So many patches more are tried where a chain cannot be rolled.
const MORE: usize = 4;
/// Share by which a simpler chain may be worse without being so.
const ROUNDING: f64 = 1e-9;
/// From the fit to a part of the points to that to all of them.
const AGAIN: Effort = Effort {
    iterations: 8,
    reduction: 1e-4,
    ..Effort::FULL
};
/// Numbers of patches beyond the chosen one in the error curve.
const BEYOND: usize = 2;
/// Distances so many times those of the best developable are not its noise.
const SHAPE: f64 = 2.0;
/// To be worth larger squares the largest distance must fall to this share.
const LOWER: f64 = 0.8;

/// Fits patches to a strip that is made ready.
///
/// # Errors
/// [`FitError::Stopped`] when the control says so, [`FitError::Numerical`]
/// where the rulings of the target span no strip.
pub fn fit_target(
    request: &Request,
    target: &Target,
    control: &dyn Control,
) -> Result<Outcome, FitError> {
    let target = oriented(target);
    let mut strip = Strip::new(&target)
        .ok_or_else(|| FitError::Numerical("the rulings span no strip".to_owned()))?;
    control.progress("developing", 10.0);
    let mut best = floor(&strip.sample, &strip.start, &strip.sample_homes, control)?;
    if request.options.robust {
        let start = (&strip.start, strip.sample_homes.as_slice());
        best = cleaned(&mut strip.sample, best, start, control)?;
    }
    control.progress("dividing", 20.0);
    let most = match request.options.goal {
        Goal::Pieces(k) => (k + BEYOND).min(MOST_PIECES),
        Goal::Tolerance(_) | Goal::Noise => MOST_PIECES,
    };
    let segments = Segments::new(&best, most, control)?;
    control.progress("fitting", 40.0);
    let free = free(&request.options);
    let mut ladder = Ladder::new((&strip.sample, &segments), free, control);
    let mut stage = Stage {
        options: &request.options,
        strip: &strip,
        floor: &best,
        norm: norm(&request.options),
    };
    let choice = stage.choose(&mut ladder)?;
    control.progress("measuring", 90.0);
    let deliver = |ladder: &Ladder, choice: Choice| {
        report::outcome(request, &target, stage.finish(ladder, choice)?)
    };
    let rolled = |outcome: &Result<Outcome, FitError>| match outcome {
        Ok(outcome) => can_be_rolled(outcome),
        Err(FitError::Numerical(_)) => false,
        Err(FitError::Invalid(_) | FitError::Stopped(_)) => true,
    };
    let first = deliver(&ladder, choice.clone());
    if rolled(&first) {
        return first;
    }
    for other in stage.others(&mut ladder, &choice)? {
        let outcome = deliver(&ladder, other);
        if rolled(&outcome) {
            return outcome;
        }
    }
    Err(unrollable(choice.fitted.chain.len()))
}

/// Whether neighbours meet where their sheets say: not where a ruling passes
/// an apex, or so near to one that its cone is lost in rounding.
pub(super) fn can_be_rolled(outcome: &Outcome) -> bool {
    /// Far above rounding, far below what a yard sees; radians, and a share of
    /// the model's size.
    const MEETS: f64 = 1e-10;
    let meets = |j: &super::outcome::Join| {
        j.gap <= MEETS * outcome.model_size && j.angle_deg.to_radians() <= MEETS
    };
    outcome.joins.iter().all(meets)
}

/// What is said when nothing that could be rolled was found.
fn unrollable(patches: usize) -> FitError {
    FitError::Numerical(format!(
        "no chain of {patches} patches that could be rolled was found; ask for another number of \
         patches, or divide the strip"
    ))
}

/// Whether patches may have a g and a k.
fn free(options: &Options) -> [bool; 2] {
    let classes = options.classes;
    [classes.cones, classes.cones || classes.cylinders]
}

/// The chain that was chosen.
#[derive(Debug, Clone)]
struct Choice {
    fitted: Fitted,
    /// Whether the tolerance is kept or could be.
    reachable: bool,
}

/// What is made small at first.
fn norm(options: &Options) -> Norm {
    let by_goal = match options.goal {
        Goal::Tolerance(_) => Norm::Minimax,
        Goal::Pieces(_) | Goal::Noise => Norm::LeastSquares,
    };
    options.norm.unwrap_or(by_goal)
}

/// What the last stages share.
struct Stage<'a> {
    options: &'a Options,
    strip: &'a Strip,
    floor: &'a Fitted,
    norm: Norm,
}

impl Stage<'_> {
    /// The chain that was asked for, with its neighbours in the ladder.
    fn choose(&mut self, ladder: &mut Ladder) -> Result<Choice, FitError> {
        let norm = self.norm;
        let count = match self.options.goal {
            Goal::Pieces(k) => k.min(ladder.most()),
            Goal::Noise => count::for_noise(ladder)?,
            Goal::Tolerance(tolerance) => {
                let tolerance = tolerance * self.strip.scale;
                count::for_tolerance(ladder, tolerance, norm, self.floor.max())?
            }
        };
        let around: Vec<usize> = (1..=(count + BEYOND).min(ladder.most())).collect();
        ladder.solve(&around)?;
        ladder.improve(count)?;
        let mut fitted = count::best(ladder, count, norm, 0.0)?;
        if self.is_by_shape(ladder, &fitted) {
            let lower = count::best(ladder, count, Norm::EighthPowers, 0.0)?;
            let [before, after] = [&fitted, &lower].map(|f| f.max_held(ladder.sample));
            if after < LOWER * before && lower.worth(ladder.sample).is_finite() {
                (fitted, self.norm) = (lower, Norm::EighthPowers);
            }
        }
        if self.options.simplify {
            let limit = self.limit(&fitted);
            fitted = simplified(ladder, fitted, (self.options.classes, self.norm), limit)?;
        }
        let fitted = self.near(ladder, fitted)?;
        Ok(self.judged(fitted))
    }

    /// Whether nobody said what is to be small and the distances come from too
    /// few patches for the shape, not from noise, over which squares are right.
    fn is_by_shape(&self, ladder: &Ladder, fitted: &Fitted) -> bool {
        let options = self.options;
        let open = matches!(options.goal, Goal::Pieces(_)) && options.norm.is_none();
        let least = self.floor.rms(ladder.sample);
        open && fitted.rms(ladder.sample) > SHAPE * least
    }

    /// Chains to turn to when the chosen one cannot be rolled: other minima of
    /// as many patches or, where their number was not asked for, other numbers.
    fn others(&self, ladder: &mut Ladder, choice: &Choice) -> Result<Vec<Choice>, FitError> {
        let count = choice.fitted.chain.len();
        let rung = ladder.rung(count)?;
        let mut found: Vec<Fitted> = std::iter::once(rung.fitted).chain(rung.others).collect();
        if self.norm == Norm::Minimax {
            // What lies lowest comes first; what cannot be rolled so may be as
            // it was.
            let freedom = ladder.freedom(count);
            let lower = |f: &Fitted| count::lowered(ladder, f, &freedom, 0.0);
            let mut low = found.iter().map(lower).collect::<Result<Vec<_>, _>>()?;
            low.sort_by(|a, b| a.max().total_cmp(&b.max()));
            found.splice(..0, low);
        }
        if !matches!(self.options.goal, Goal::Pieces(_)) {
            let more = count + 1..=(count + MORE).min(ladder.most());
            for patches in more.chain((1..count).rev()) {
                found.push(count::best(ladder, patches, self.norm, 0.0)?);
            }
        }
        let mut choices = Vec::with_capacity(found.len());
        for fitted in found {
            choices.push(self.judged(self.near(ladder, fitted)?));
        }
        Ok(choices)
    }

    /// A chain with whether it keeps the tolerance.
    fn judged(&self, fitted: Fitted) -> Choice {
        let reachable = match self.options.goal {
            Goal::Tolerance(tolerance) => fitted.max() <= tolerance * self.strip.scale,
            Goal::Pieces(_) | Goal::Noise => true,
        };
        Choice { fitted, reachable }
    }

    /// A chain without apices far away.
    fn near(&self, ladder: &Ladder, fitted: Fitted) -> Result<Fitted, FitError> {
        let limit = fitted.max() * (1.0 + ROUNDING);
        let shape = (ladder.sample, ladder.free);
        let wishes = (self.options.classes, self.norm);
        Ok(near(fitted, shape, wishes, limit, ladder.control)?)
    }

    /// What a simpler chain must keep.
    fn limit(&self, fitted: &Fitted) -> f64 {
        let asked = match self.options.goal {
            Goal::Tolerance(tolerance) => tolerance * self.strip.scale,
            Goal::Pieces(_) | Goal::Noise => fitted.max(),
        };
        asked.max(fitted.max() * (1.0 + ROUNDING))
    }

    /// The chain against all points, in the unit of the request.
    fn finish(&self, ladder: &Ladder, choice: Choice) -> Result<report::Fitted, FitError> {
        let strip = self.strip;
        let last = match strip.is_thinned() {
            true => self.with_all_points(ladder, &choice.fitted)?,
            false => choice.fitted,
        };
        let length = 1.0 / strip.scale;
        let error_curve: Vec<ErrorPoint> = ladder
            .solved()
            .filter(|(_, rung)| rung.fitted.worth(ladder.sample).is_finite())
            .map(|(patches, rung)| {
                let [max, mean, rms] = ladder
                    .sample
                    .figures(&rung.fitted.distances)
                    .map(|d| d * length);
                ErrorPoint {
                    patches,
                    max,
                    mean,
                    rms,
                }
            })
            .collect();
        Ok(report::Fitted {
            chain: strip.restored(&last.chain),
            floor: self.lowest(&error_curve, &last),
            error_curve,
            reachable: choice.reachable,
            report: Report {
                pieces_from: match self.options.goal {
                    Goal::Pieces(_) => "asked",
                    Goal::Tolerance(_) => "the tolerance",
                    Goal::Noise => "the noise",
                },
                norm: match self.norm {
                    Norm::LeastSquares => "least_squares",
                    Norm::EighthPowers => "eighth_powers",
                    Norm::Minimax => "minimax",
                },
                noise: (self.options.goal == Goal::Noise).then(|| self.noise(&last)),
                outliers: self.outliers(&last),
                iterations: last.iterations,
                termination: last.termination,
            },
        })
    }

    /// The chain fitted again to all points, each patch with what it kept.
    fn with_all_points(&self, ladder: &Ladder, fitted: &Fitted) -> Result<Fitted, FitError> {
        let all = &self.strip.all;
        let mut freedom = ladder.freedom(fitted.chain.len());
        for (free, strain) in freedom.strains.iter_mut().zip(&fitted.chain.strains) {
            free[0] &= strain.g != 0.0;
            free[1] &= strain.k != 0.0;
        }
        if self.norm == Norm::Minimax && !self.options.robust {
            let kept = &self.strip.kept;
            return Ok(exchanged(fitted, (all, kept), &freedom, ladder.control)?);
        }
        let start = Fitted::settle_anew(all, &fitted.chain);
        let mut weights = all.weights.clone();
        if self.options.robust {
            let kept = shares(&start.distances);
            weights.iter_mut().zip(kept).for_each(|(w, s)| *w *= s);
        }
        let again = Effort {
            power: (self.norm == Norm::EighthPowers).then_some(EIGHTH),
            ..AGAIN
        };
        Ok(start.weighted(all, &weights, (&freedom, again), ladder.control)?)
    }

    /// Standard deviation of the points that count.
    fn noise(&self, last: &Fitted) -> f64 {
        let sample = match last.distances.len() == self.strip.sample.points.len() {
            true => &self.strip.sample,
            false => &self.strip.all,
        };
        last.rms(sample) / self.strip.scale
    }

    /// Points that had no hold on the shape.
    fn outliers(&self, last: &Fitted) -> Vec<usize> {
        if !self.options.robust {
            return Vec::new();
        }
        let all = Fitted::settle_anew(&self.strip.all, &last.chain);
        let shares = shares(&all.distances);
        (0..shares.len()).filter(|i| shares[*i] == 0.0).collect()
    }

    /// The best of the fine chain and of all others.
    fn lowest(&self, curve: &[ErrorPoint], last: &Fitted) -> Floor {
        let [max, mean, rms] = self.strip.sample.figures(&self.floor.distances);
        let max = max.min(last.max());
        let length = 1.0 / self.strip.scale;
        let least = |fine: f64, of: fn(&ErrorPoint) -> f64| {
            curve.iter().map(of).fold(fine * length, f64::min)
        };
        Floor {
            max: least(max, |p| p.max),
            mean: least(mean, |p| p.mean),
            rms: least(rms, |p| p.rms),
            patches: self.floor.chain.len(),
        }
    }
}
