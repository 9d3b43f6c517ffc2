//! The levels, one after the other.

use super::calm::calmed;
use super::lead::{self, Side};
use super::model::{Level, Weights};
use super::start;
use crate::methods::curvature_net::diagnose::{BorderFigures, ShapeFigures, UmbilicFigures};
use crate::methods::curvature_net::input::{Levels, Task};
use crate::methods::curvature_net::request::{Options, Umbilics};
use crate::methods::curvature_net::surface::Surface;
use crate::methods::curvature_net::target::Target;
use crate::solver::levenberg_marquardt::{Settings, minimize};
use crate::solver::{Control, NormalEquations, Stop};
use nalgebra::Point3;
use rayon::prelude::*;

/// What the levels lead to, in unit scale.
#[derive(Debug, Clone)]
pub(in super::super) struct Lines {
    /// The start, split like the result.
    pub(in super::super) start: Surface,
    /// What the result was held to: the start, or a calmer one.
    pub(in super::super) held: Surface,
    /// Whether it is a calmer one.
    pub(in super::super) is_calmed: bool,
    /// The result.
    pub(in super::super) surface: Surface,
    /// How often patches were split.
    pub(in super::super) levels: usize,
    /// What every step did.
    pub(in super::super) steps: Vec<Step>,
}

/// One minimisation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// How often patches had been split.
    pub level: usize,
    /// The weight of the torsion.
    pub torsion: f64,
    /// The weight of the bending.
    pub bending: f64,
    /// Iterations of the solver.
    pub iterations: usize,
    /// Whether they ended at a minimum.
    pub converged: bool,
}

/// Weights of the torsion on every level: small ones let the net find its way,
/// large ones leave nothing of the torsion.
const RISE: [f64; 4] = [1.0, 10.0, 100.0, 1000.0];
/// From this level on the way is found, and only the last of them is used.
const FOUND: usize = 2;
/// The weight that ends the last level.
const LAST: f64 = 1e4;
/// And one more where torsion is left in sharp turns that few patches follow.
const FURTHER: f64 = 1e6;
/// Weights of the bending of the way from the start. The first lets through
/// waves that are longer than some five edges of the first net; a net that
/// crumples so, with torsion left in its folds, or that has to change which
/// curvature leads, has to stay smoother.
const BENDING: [f64; 3] = [0.5, 2.0, 8.0];
/// Most iterations of a step: the next weight or level may find the way on.
const ITERATIONS: usize = 40;
/// A step that gains less than this share is over.
const REDUCTION: f64 = 1e-3;
/// Parts of the progress of the tries, of which most nets need one.
const PARTS: [[f64; 2]; 6] = [
    [0.0, 60.0],
    [60.0, 70.0],
    [70.0, 80.0],
    [80.0, 85.0],
    [85.0, 90.0],
    [90.0, 95.0],
];
/// And of a further level.
const LAST_PART: [f64; 2] = [95.0, 100.0];
/// Weights of the third differences with which the points of a net are smoothed
/// that has umbilics as it is: they take a third and two thirds of the noise of
/// independent points.
const CALM: [f64; 2] = [0.3, 3.0];
/// A net whose normals turn by more than this on average, degrees, is another
/// surface: umbilics are not worth that.
const ANOTHER_DEG: f64 = 30.0;
/// And one that turns by so much is as bad as one full of umbilics.
const AS_BAD_DEG: f64 = 20.0;
/// A net with more quads than this tells its shape: it is smoothed only where
/// that leaves one curvature leading, not to make it lead.
const TELLING: usize = 512;

/// Mean and largest |torsion·length|, radians, that a net of lines of curvature
/// may have: a hundredth of Zheng & Bo's mean.
pub const REACHED: [f64; 2] = [1e-6, 2e-5];

/// Lays the net into lines of curvature, level after level.
///
/// # Errors
/// [`Stop`] when the control says so.
pub(in super::super) fn solve(
    task: &Task,
    options: &Options,
    control: &dyn Control,
) -> Result<Lines, Stop> {
    let Options {
        closeness,
        umbilics,
        ..
    } = *options;
    let search = Search {
        task,
        closeness,
        umbilics,
        control,
    };
    let as_given = Plan {
        bending: BENDING[0],
        side: Side::Own,
        calm: None,
    };
    let mut best = search.run(as_given, PARTS[0])?;
    for (plan, part) in search.further(&best).into_iter().zip(&PARTS[1..]) {
        if best.is_clean() {
            break;
        }
        let next = search.run(plan, *part)?;
        best = best.or(next, umbilics);
    }
    if best.missed > 1.0 && matches!(task.levels, Levels::Usual { may_grow: true, .. }) {
        let mut finer = best.lines.clone();
        finer.split(best.run.target);
        best.run.level(&mut finer, true, LAST_PART)?;
        let finer = Try::new(best.run, finer);
        best = best.or(finer, umbilics);
    }
    Ok(best.lines)
}

/// How a net is tried.
#[derive(Debug, Clone, Copy)]
struct Plan {
    /// The weight of the bending of the way.
    bending: f64,
    /// Which curvature shall lead.
    side: Side,
    /// The weight with which the points are smoothed before, if they are.
    calm: Option<f64>,
}

/// The tries of a task.
struct Search<'a> {
    task: &'a Task,
    closeness: f64,
    umbilics: Umbilics,
    control: &'a dyn Control,
}

impl<'a> Search<'a> {
    /// What else there is to try, in turn, after the net as it is given.
    fn further(&self, first: &Try) -> Vec<Plan> {
        let plan = |bending, side, calm| Plan {
            bending,
            side,
            calm,
        };
        let [usual, stiff, stiffest] = BENDING;
        let mut plans = Vec::new();
        if lead::has_no_side(&first.lines.start) {
            plans.push(plan(usual, Side::Minority, None));
        } else if self.umbilics == Umbilics::Avoid {
            plans.push(plan(stiff, Side::Majority, None));
            plans.push(plan(stiffest, Side::Majority, None));
        }
        let side = match self.umbilics {
            Umbilics::Avoid => Side::Majority,
            Umbilics::KeepShape => Side::Own,
        };
        let calmer = CALM.into_iter().filter(|calm| self.is_promising(*calm));
        plans.extend(calmer.map(|calm| plan(stiff, side, Some(calm))));
        plans.push(plan(stiff, Side::Own, None));
        plans
    }

    /// Whether it is worth a try to smooth the points so strongly.
    fn is_promising(&self, calm: f64) -> bool {
        let Task {
            layout,
            points,
            target,
            ..
        } = self.task;
        let is_one_sided =
            || lead::has_one_side(&start::through(*layout, &calmed(*layout, points, calm)));
        target.is_none() && (layout.patches().count() <= TELLING || is_one_sided())
    }

    /// One try.
    fn run(&self, plan: Plan, part: [f64; 2]) -> Result<Try<'a>, Stop> {
        let Task { layout, points, .. } = self.task;
        let run = Run {
            closeness: self.closeness,
            bending: plan.bending,
            side: plan.side,
            target: self.task.target.as_ref(),
            control: self.control,
        };
        let mut lines = Lines::start(self.task);
        if let Some(weight) = plan.calm {
            let calmer = calmed(*layout, points, weight);
            lines.held = start::through(*layout, &calmer);
            lines.surface = lines.held.clone();
            lines.is_calmed = true;
        }
        run.levels(&mut lines, self.task.levels.count(), part)?;
        Ok(Try::new(run, lines))
    }
}

/// A net, and what tells it from others of the same task.
#[derive(Clone)]
struct Try<'a> {
    run: Run<'a>,
    lines: Lines,
    /// By how much [`REACHED`] is missed; at most 1: it is not.
    missed: f64,
    /// Share of the patches with umbilics.
    umbilic: f64,
    /// Mean turn of the normals against the start, degrees.
    turned_deg: f64,
}

impl<'a> Try<'a> {
    fn new(run: Run<'a>, lines: Lines) -> Self {
        let count = lines.surface.layout().patches().count();
        let umbilics = UmbilicFigures::of(&lines.surface).patches.len();
        let shape = ShapeFigures::of(&lines.surface, &lines.start);
        Try {
            missed: lines.missed(),
            umbilic: umbilics as f64 / count.max(1) as f64,
            turned_deg: shape.mean_turn_deg,
            run,
            lines,
        }
    }

    /// Whether there is nothing to better.
    fn is_clean(&self) -> bool {
        self.missed <= 1.0 && self.umbilic == 0.0 && self.turned_deg <= ANOTHER_DEG
    }

    /// The better of two: first that it is the same surface at all, then that
    /// its borders are lines of curvature, then, to avoid umbilics, that it has
    /// none, then few umbilics with the shape kept. This one of equals.
    fn or(self, other: Self, umbilics: Umbilics) -> Self {
        let rank = |t: &Self| {
            let has_umbilics = umbilics == Umbilics::Avoid && t.umbilic > 0.0;
            let left = f64::from(u8::from(has_umbilics)) + t.umbilic + t.turned_deg / AS_BAD_DEG;
            (t.turned_deg > ANOTHER_DEG, t.missed.max(1.0), left)
        };
        if rank(&other) < rank(&self) {
            other
        } else {
            self
        }
    }
}

impl Lines {
    /// Before the first step.
    pub(in super::super) fn start(task: &Task) -> Self {
        let start = start::through(task.layout, &task.points);
        Lines {
            surface: start.clone(),
            held: start.clone(),
            start,
            is_calmed: false,
            levels: 0,
            steps: Vec::new(),
        }
    }

    /// Splits every patch in four, and lays the new start onto the target.
    pub(in super::super) fn split(&mut self, target: Option<&Target>) {
        self.start = self.start.split();
        if let Some(target) = target {
            let feet = self.start.vertices().par_iter();
            let feet: Vec<Point3<f64>> = feet
                .map(|k| target.foot(&Point3::from(k.point)).point)
                .collect();
            let (layout, widths) = (self.start.layout(), self.start.widths().clone());
            self.start = start::with_widths(layout, widths, &feet);
        }
        self.held = if self.is_calmed {
            self.held.split()
        } else {
            self.start.clone()
        };
        self.surface = self.surface.split();
        self.levels += 1;
    }

    /// By how much [`REACHED`] is missed; at most 1: it is not.
    fn missed(&self) -> f64 {
        let [mean, max] = BorderFigures::torsion(&self.surface);
        (mean / REACHED[0]).max(max / REACHED[1])
    }
}

/// What does not change from level to level.
#[derive(Clone, Copy)]
struct Run<'a> {
    closeness: f64,
    bending: f64,
    side: Side,
    target: Option<&'a Target>,
    control: &'a dyn Control,
}

impl Run<'_> {
    fn levels(&self, lines: &mut Lines, last: usize, [from, to]: [f64; 2]) -> Result<(), Stop> {
        // A level costs some four times the one before.
        let cost = |level: usize| 4_f64.powi(i32::try_from(level).unwrap_or(0));
        let all: f64 = (0..=last).map(cost).sum();
        let mut done = 0.0;
        for level in 0..=last {
            if level > 0 {
                lines.split(self.target);
            }
            let at = |done: f64| from + (to - from) * done / all;
            let part = [at(done), at(done + cost(level))];
            self.level(lines, level == last, part)?;
            done += cost(level);
        }
        Ok(())
    }

    fn level(&self, lines: &mut Lines, is_last: bool, [from, to]: [f64; 2]) -> Result<(), Stop> {
        let skipped = if lines.levels < FOUND {
            0
        } else {
            RISE.len() - 1
        };
        let count = RISE.len() - skipped + usize::from(is_last);
        let weights = RISE
            .into_iter()
            .skip(skipped)
            .chain(is_last.then_some(LAST));
        for (at, torsion) in weights.enumerate() {
            let share = at as f64 / count as f64;
            self.control.progress("lines", from + (to - from) * share);
            self.step(lines, torsion)?;
        }
        if is_last && lines.missed() > 1.0 {
            self.step(lines, FURTHER)?;
        }
        Ok(())
    }

    fn step(&self, lines: &mut Lines, torsion: f64) -> Result<(), Stop> {
        let weights = Weights::new(torsion, self.closeness, self.bending);
        let problem = Level::new(&lines.held, &lines.surface, self.target, weights, self.side);
        let mut x = lines.surface.unknowns();
        let settings = Settings {
            iterations: ITERATIONS,
            reduction: REDUCTION,
            damping: 1e-6,
            normal_equations: NormalEquations::Sparse,
            ..Settings::default()
        };
        let report = minimize(&problem, &mut x, &settings, self.control)?;
        lines.surface = lines.surface.with_unknowns(&x);
        lines.steps.push(Step {
            level: lines.levels,
            torsion,
            bending: self.bending,
            iterations: report.iterations,
            converged: report.termination.converged(),
        });
        Ok(())
    }
}
