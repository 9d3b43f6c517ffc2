//! From a target to the answer: the stages in order.

use super::count::{self, Choice};
use super::engine::{Effort, Fitted};
use super::floor::floor;
use super::ladder::Ladder;
use super::outcome::{ErrorPoint, Floor, Outcome, Report};
use super::report;
use super::request::{Goal, MOST_PIECES, Norm, Options, Request};
use super::robust::{cleaned, shares};
use super::segments::Segments;
use super::simplify::simplified;
use super::strip::{Strip, oriented};
use super::target::Target;
use crate::methods::{Control, FitError};

/// So many patches more are tried where a chain cannot be rolled.
const MORE: usize = 4;
/// Share by which a simpler chain may be worse without being so.
const ROUNDING: f64 = 1e-9;
/// Numbers of patches beyond the chosen one in the error curve.
const BEYOND: usize = 2;

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
        best = cleaned(&mut strip.sample, best, control)?;
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
    let stage = Stage {
        options: &request.options,
        strip: &strip,
        floor: &best,
    };
    let choice = stage.choose(&mut ladder)?;
    control.progress("measuring", 90.0);
    let deliver = |ladder: &Ladder, choice: Choice| {
        report::outcome(request, &target, stage.finish(ladder, choice)?)
    };
    let first = deliver(&ladder, choice.clone());
    if first.as_ref().is_ok_and(can_be_rolled) {
        return first;
    }
    for other in stage.others(&mut ladder, &choice)? {
        let outcome = deliver(&ladder, other);
        if outcome.as_ref().is_ok_and(can_be_rolled) {
            return outcome;
        }
    }
    doubtful(first, choice.fitted.chain.len())
}

/// Whether neighbours meet where their sheets say: not where a ruling passes
/// an apex.
pub(super) fn can_be_rolled(outcome: &Outcome) -> bool {
    /// Far above rounding, far below what a yard sees.
    const MEETS: f64 = 1e-6;
    let meets = |j: &super::outcome::Join| {
        j.gap <= MEETS * outcome.model_size && j.angle_deg.to_radians() <= MEETS
    };
    outcome.joins.iter().all(meets)
}

/// What is said when nothing that could be rolled was found.
pub(super) fn doubtful(
    outcome: Result<Outcome, FitError>,
    patches: usize,
) -> Result<Outcome, FitError> {
    match outcome {
        Ok(mut outcome) => {
            outcome.within_limits = false;
            outcome.warnings.push(
                "A joint runs past the apex of its patch: these patches cannot be rolled as they \
                 are. Ask for another number of patches, or divide the strip."
                    .to_owned(),
            );
            Ok(outcome)
        }
        Err(FitError::Numerical(_)) => Err(FitError::Numerical(format!(
            "no chain of {patches} patches that could be rolled was found; ask for another number \
             of patches, or divide the strip"
        ))),
        Err(other) => Err(other),
    }
}

/// Whether patches may have a g and a k.
fn free(options: &Options) -> [bool; 2] {
    let classes = options.classes;
    [classes.cones, classes.cones || classes.cylinders]
}

/// What the last stages share.
struct Stage<'a> {
    options: &'a Options,
    strip: &'a Strip,
    floor: &'a Fitted,
}

impl Stage<'_> {
    fn norm(&self) -> Norm {
        let by_goal = match self.options.goal {
            Goal::Tolerance(_) => Norm::Minimax,
            Goal::Pieces(_) | Goal::Noise => Norm::LeastSquares,
        };
        self.options.norm.unwrap_or(by_goal)
    }

    /// The chain that was asked for, with its neighbours in the ladder.
    fn choose(&self, ladder: &mut Ladder) -> Result<Choice, FitError> {
        let norm = self.norm();
        let (count, reachable) = match self.options.goal {
            Goal::Pieces(k) => (k.min(ladder.most()), true),
            Goal::Noise => (count::for_noise(ladder)?, true),
            Goal::Tolerance(tolerance) => {
                let tolerance = tolerance * self.strip.scale;
                let choice = count::for_tolerance(ladder, tolerance, norm, self.floor.max())?;
                (choice.fitted.chain.len(), choice.reachable)
            }
        };
        let around: Vec<usize> = (1..=(count + BEYOND).min(ladder.most())).collect();
        ladder.solve(&around)?;
        ladder.improve(count)?;
        let mut fitted = count::best(ladder, count, norm, 0.0)?;
        if self.options.simplify {
            let limit = match self.options.goal {
                Goal::Tolerance(tolerance) => tolerance * self.strip.scale,
                Goal::Pieces(_) | Goal::Noise => fitted.max(),
            };
            let limit = limit.max(fitted.max() * (1.0 + ROUNDING));
            let wishes = (self.options.classes, norm);
            fitted = simplified(ladder, fitted, wishes, limit)?;
        }
        Ok(Choice { fitted, reachable })
    }

    /// Chains to turn to when the chosen one cannot be rolled: other minima of
    /// as many patches or, for a tolerance, more patches.
    fn others(&self, ladder: &mut Ladder, choice: &Choice) -> Result<Vec<Choice>, FitError> {
        let count = choice.fitted.chain.len();
        let with = |fitted| Choice {
            fitted,
            reachable: choice.reachable,
        };
        let rung = ladder.rung(count)?;
        let mut others: Vec<Choice> = std::iter::once(rung.fitted)
            .chain(rung.others)
            .map(with)
            .collect();
        if let Goal::Tolerance(tolerance) = self.options.goal {
            let enough = tolerance * self.strip.scale;
            for more in count + 1..=(count + MORE).min(ladder.most()) {
                others.push(with(count::best(ladder, more, self.norm(), enough)?));
            }
            for fewer in (1..count).rev() {
                others.push(with(count::best(ladder, fewer, self.norm(), enough)?));
            }
        }
        Ok(others)
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
                norm: match self.norm() {
                    Norm::LeastSquares => "least_squares",
                    Norm::Minimax => "minimax",
                },
                noise: (self.options.goal == Goal::Noise).then(|| self.noise(&last)),
                outliers: self.outliers(&last),
                iterations: last.iterations,
                termination: last.termination,
            },
        })
    }

    /// The chain fitted again to all points, each with what it kept.
    fn with_all_points(&self, ladder: &Ladder, fitted: &Fitted) -> Result<Fitted, FitError> {
        let all = &self.strip.all;
        let mut freedom = ladder.freedom(fitted.chain.len());
        for (free, strain) in freedom.strains.iter_mut().zip(&fitted.chain.strains) {
            free[0] &= strain.g != 0.0;
            free[1] &= strain.k != 0.0;
        }
        let start = Fitted::settle_anew(all, &fitted.chain);
        let mut weights = all.weights.clone();
        if self.options.robust {
            let kept = shares(&start.distances);
            weights.iter_mut().zip(kept).for_each(|(w, s)| *w *= s);
        }
        Ok(start.weighted(all, &weights, (&freedom, Effort::FULL), ladder.control)?)
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
