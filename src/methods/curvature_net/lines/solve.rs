//! The levels, one after the other.

use super::model::{Level, Weights};
use super::start;
use crate::methods::curvature_net::diagnose::BorderFigures;
use crate::methods::curvature_net::input::{Levels, Task};
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
/// Weights of the bending of the way from the start, tried in turn. The first
/// lets through waves that are longer than some five edges of the first net;
/// a net that crumples so, with torsion left in its folds, has to stay smoother.
const BENDING: [f64; 2] = [0.5, 2.0];
/// Most iterations of a step: the next weight or level may find the way on.
const ITERATIONS: usize = 40;
/// A step that gains less than this share is over.
const REDUCTION: f64 = 1e-3;
/// Parts of the progress that the tries and a further level have.
const PARTS: [[f64; 2]; 3] = [[0.0, 60.0], [60.0, 85.0], [85.0, 100.0]];

/// Mean and largest |torsion·length|, radians, that a net of lines of curvature
/// may have: a hundredth of Zheng & Bo's mean.
pub const REACHED: [f64; 2] = [1e-6, 2e-5];

/// Lays the net into lines of curvature, level after level.
///
/// # Errors
/// [`Stop`] when the control says so.
pub(in super::super) fn solve(
    task: &Task,
    closeness: f64,
    control: &dyn Control,
) -> Result<Lines, Stop> {
    let mut best: Option<(f64, Lines, Run)> = None;
    for (bending, part) in BENDING.into_iter().zip(PARTS) {
        let run = Run {
            closeness,
            bending,
            target: task.target.as_ref(),
            control,
        };
        let lines = run.levels(task, part)?;
        let missed = lines.missed();
        if best.as_ref().is_none_or(|(least, ..)| missed < *least) {
            best = Some((missed, lines, run));
        }
        if missed <= 1.0 {
            break;
        }
    }
    let Some((missed, lines, run)) = best else {
        return Err(Stop::Cancelled);
    };
    if missed > 1.0 && matches!(task.levels, Levels::Usual { may_grow: true, .. }) {
        let mut finer = lines.clone();
        finer.split(run.target);
        run.level(&mut finer, true, PARTS[2])?;
        if finer.missed() < missed {
            return Ok(finer);
        }
    }
    Ok(lines)
}

impl Lines {
    /// Before the first step.
    pub(in super::super) fn start(task: &Task) -> Self {
        let start = start::through(task.layout, &task.points);
        Lines {
            surface: start.clone(),
            start,
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
struct Run<'a> {
    closeness: f64,
    bending: f64,
    target: Option<&'a Target>,
    control: &'a dyn Control,
}

impl Run<'_> {
    fn levels(&self, task: &Task, [from, to]: [f64; 2]) -> Result<Lines, Stop> {
        let mut lines = Lines::start(task);
        let last = task.levels.count();
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
            self.level(&mut lines, level == last, part)?;
            done += cost(level);
        }
        Ok(lines)
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
        let problem = Level::new(&lines.start, &lines.surface, self.target, weights);
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
