//! The levels, one after the other.

use super::model::{Level, Weights};
use super::start;
use crate::methods::curvature_net::input::Task;
use crate::methods::curvature_net::surface::Surface;
use crate::solver::levenberg_marquardt::{Settings, minimize};
use crate::solver::{Control, NormalEquations, Stop};

/// What the levels lead to, in unit scale.
#[derive(Debug, Clone)]
pub(in super::super) struct Lines {
    /// The start, split like the result.
    pub(in super::super) start: Surface,
    /// The result.
    pub(in super::super) surface: Surface,
    /// What every step did.
    pub(in super::super) steps: Vec<Step>,
}

/// One minimisation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// How often patches had been split.
    pub level: usize,
    /// The weight of the torsion.
    pub weight: f64,
    /// Iterations of the solver.
    pub iterations: usize,
    /// Whether they ended at a minimum.
    pub converged: bool,
}

/// Weights of the torsion on every level: small ones let the net find its way,
/// large ones leave nothing of the torsion.
const RISE: [f64; 4] = [1.0, 10.0, 100.0, 1000.0];
/// Most iterations of a step: the next weight or level may find the way on.
const ITERATIONS: usize = 40;
/// A step that gains less than this share is over; the last gains more digits.
const REDUCTION: [f64; 2] = [1e-3, 1e-7];

/// Lays the net into lines of curvature, level after level.
///
/// # Errors
/// [`Stop`] when the control says so.
pub(in super::super) fn solve(
    task: &Task,
    closeness: f64,
    control: &dyn Control,
) -> Result<Lines, Stop> {
    let start = start::through(task.layout, &task.points);
    let mut lines = Lines {
        surface: start.clone(),
        start,
        steps: Vec::new(),
    };
    let last = task.levels;
    let cost = |level: usize| 4_f64.powi(i32::try_from(level).unwrap_or(0));
    let all: f64 = (0..=last).map(cost).sum();
    let mut done = 0.0;
    for level in 0..=last {
        if level > 0 {
            lines.start = lines.start.split();
            lines.surface = lines.surface.split();
        }
        for (at, weight) in RISE.into_iter().enumerate() {
            let share = done + cost(level) * at as f64 / RISE.len() as f64;
            control.progress("lines", 100.0 * share / all);
            let is_last = level == last && at + 1 == RISE.len();
            lines.step(level, weight, (closeness, is_last), control)?;
        }
        done += cost(level);
    }
    Ok(lines)
}

impl Lines {
    fn step(
        &mut self,
        level: usize,
        weight: f64,
        (closeness, is_last): (f64, bool),
        control: &dyn Control,
    ) -> Result<(), Stop> {
        let problem = Level::new(&self.start, Weights::new(weight, closeness));
        let mut x = self.surface.unknowns();
        let settings = Settings {
            iterations: ITERATIONS,
            reduction: REDUCTION[usize::from(is_last)],
            damping: 1e-6,
            normal_equations: NormalEquations::Sparse,
            ..Settings::default()
        };
        let report = minimize(&problem, &mut x, &settings, control)?;
        self.surface = self.surface.with_unknowns(&x);
        self.steps.push(Step {
            level,
            weight,
            iterations: report.iterations,
            converged: report.termination.converged(),
        });
        Ok(())
    }
}
