//! The boundary modes: exact, within a tolerance, or the least change that
//! meets the twist limit.

use super::deliver::Loft;
use super::exact::{self, Rulings};
use super::input::Task;
use super::paper;
use super::relaxed;
use super::report::{Solved, SolvedPlate, SolvedShape};
use super::request::{Boundary, Request, Solver};
use super::task::{EndSpeeds, Limits};
use crate::geometry::BSplineCurve;
use crate::methods::{Control, FitError};
use rayon::prelude::*;

/// Of a tolerance, what the splines' own accuracy keeps for itself (unit scale).
const SPARE: f64 = 2e-8;
/// Twist that a tolerance is used for, degrees: below it a plate is as good as
/// developable and moving its boundary further buys nothing.
const GOOD_TWIST_DEG: f64 = 0.02;
/// `auto` aims this far below the limit.
const AUTO_MARGIN: f64 = 0.95;
/// `auto` moves a profile by at most this share of the model.
const AUTO_LARGEST: f64 = 0.005;
/// Tolerances tried by `auto`, from this share of the model up, each twice the
/// one before; then bisected.
const AUTO_SMALLEST: f64 = AUTO_LARGEST / 128.0;
const AUTO_BISECTIONS: usize = 3;
/// A twist above this many targets is tried again from smaller tolerances:
/// a local optimum of a looser one must not be worse than theirs.
const POOR: f64 = 6.0;
const SMALLER: [f64; 2] = [0.7, 0.5];

/// Solves the request's mode.
pub(super) fn solve(
    request: &Request,
    task: &Task,
    control: &dyn Control,
) -> Result<Solved, FitError> {
    if request.options.solver == Solver::Paper {
        return by_the_paper(request, task, control);
    }
    let plates = exact_plates(task, &task.limits, control)?;
    control.progress("fitting", 40.0);
    let limit = request.options.max_twist_deg.to_radians();
    match request.options.boundary {
        Boundary::Exact => Ok(unmoved(task, plates)),
        Boundary::Tolerance(value) => {
            let target = GOOD_TWIST_DEG.to_radians().min(limit * AUTO_MARGIN);
            let tolerance = value / task.size - SPARE;
            let mut best = within(task, &plates, (tolerance, target), control)?;
            for share in SMALLER {
                let twist = best.as_ref().map_or(f64::INFINITY, |(_, twist)| *twist);
                if twist <= POOR * target {
                    break;
                }
                let again = within(task, &plates, (share * tolerance, target), control)?;
                best = again.filter(|(_, other)| *other < twist).or(best);
            }
            Ok(best.map_or_else(|| unmoved(task, plates), |(solved, _)| solved))
        }
        Boundary::Auto => auto(task, plates, limit, control),
    }
}

fn exact_plates(
    task: &Task,
    limits: &Limits,
    control: &dyn Control,
) -> Result<Vec<Rulings>, FitError> {
    (0..task.profiles.len() - 1)
        .into_par_iter()
        .map(|i| exact::solve(&task.profiles, [i, i + 1], limits, &task.pins[i], control))
        .collect()
}

fn unmoved(task: &Task, plates: Vec<Rulings>) -> Solved {
    Solved {
        curves: task.profiles.iter().map(|p| p.curve.clone()).collect(),
        plates: plates.into_iter().map(SolvedPlate::along).collect(),
        moved: false,
    }
}

/// The paper's plates, each with boundaries of its own.
fn by_the_paper(request: &Request, task: &Task, control: &dyn Control) -> Result<Solved, FitError> {
    let threshold = match request.options.boundary {
        Boundary::Exact | Boundary::Auto => None,
        Boundary::Tolerance(value) => Some(value / task.size),
    };
    let given: Vec<Vec<_>> = task
        .given
        .iter()
        .map(|g| g.iter().map(|(_, p)| *p).collect())
        .collect();
    let plate = |i: usize| -> Result<SolvedPlate, FitError> {
        let settings = paper::Settings {
            given: [&given[i], &given[i + 1]],
            threshold,
            twist_limit: request.options.max_twist_deg.to_radians(),
            extension: paper::EXTENSION,
        };
        let plate = paper::solve(&task.profiles, [i, i + 1], &settings, control)?;
        Ok(SolvedPlate {
            shape: SolvedShape::Loft(Loft {
                first: plate.first,
                second: plate.second,
                fans: Vec::new(),
            }),
            iterations: plate.iterations,
            last: Some(plate.report),
            speeds: EndSpeeds::AcrossTheRuling,
            exact_twist: f64::INFINITY,
        })
    };
    Ok(Solved {
        plates: (0..task.profiles.len() - 1)
            .into_par_iter()
            .map(plate)
            .collect::<Result<_, _>>()?,
        curves: task.profiles.iter().map(|p| p.curve.clone()).collect(),
        moved: threshold.is_some(),
    })
}

/// A fit with moved boundaries and its largest twist; `None` where moving them does not help.
fn within(
    task: &Task,
    exact: &[Rulings],
    (tolerance, target): (f64, f64),
    control: &dyn Control,
) -> Result<Option<(Solved, f64)>, FitError> {
    let worst = |twists: &mut dyn Iterator<Item = f64>| twists.fold(0.0, f64::max);
    let exact_worst = worst(&mut exact.iter().map(|p| p.twist_max));
    if tolerance <= 0.0 || exact_worst <= target {
        return Ok(None);
    }
    let relaxed = relaxed::solve(
        &relaxed::Task {
            profiles: &task.profiles,
            limits: task.moved_limits,
            pins: &task.pins,
            centreline: task.centreline,
            target,
        },
        exact,
        tolerance,
        control,
    )?;
    if relaxed.twist_max >= exact_worst {
        return Ok(None);
    }
    let curves: Vec<BSplineCurve> = relaxed
        .movables
        .iter()
        .zip(&task.profiles)
        .zip(&relaxed.displacements)
        .map(|((movable, profile), d)| movable.moved_curve(profile, d))
        .collect::<Result<_, _>>()
        .map_err(|e| FitError::Numerical(e.to_string()))?;
    let plates = exact
        .iter()
        .zip(relaxed.paths)
        .map(|(rulings, y)| SolvedPlate {
            shape: SolvedShape::Path(rulings.shape.clone(), y),
            iterations: rulings.iterations + relaxed.iterations,
            last: relaxed.last,
            speeds: rulings.speeds,
            exact_twist: rulings.twist_max,
        })
        .collect();
    Ok(Some((
        Solved {
            plates,
            curves,
            moved: true,
        },
        relaxed.twist_max,
    )))
}

/// Exact where that meets the limit, else the least tolerance that does.
fn auto(
    task: &Task,
    exact: Vec<Rulings>,
    limit: f64,
    control: &dyn Control,
) -> Result<Solved, FitError> {
    if exact.iter().all(|p| p.twist_max <= limit) {
        return Ok(unmoved(task, exact));
    }
    let start = exact_plates(task, &task.moved_limits, control)?;
    // Aimed at the limit itself the fit moves least, but from far away it may
    // not get there where one that is aimed at no twist at all does.
    let targets = [limit * AUTO_MARGIN, GOOD_TWIST_DEG.to_radians()];
    let meets = |tolerance: f64| -> Result<Option<Solved>, FitError> {
        for target in targets {
            let found = within(task, &start, (tolerance, target), control)?;
            if let Some((solved, twist)) = found
                && twist <= limit
            {
                return Ok(Some(solved));
            }
        }
        Ok(None)
    };
    let (mut low, mut high) = (0.0, AUTO_SMALLEST);
    let mut best = loop {
        if let Some(found) = meets(high)? {
            break found;
        }
        if high >= AUTO_LARGEST {
            return Ok(unmoved(task, exact));
        }
        (low, high) = (high, 2.0 * high);
    };
    for _ in 0..AUTO_BISECTIONS {
        let middle = 0.5 * (low + high);
        match meets(middle)? {
            Some(found) => (best, high) = (found, middle),
            None => low = middle,
        }
    }
    Ok(best)
}
