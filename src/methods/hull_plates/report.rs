//! From solved plates to the outcome: surfaces in the user's scale, figures,
//! verdicts and the sentences that say them.

use super::deliver::{Boundary as Edge, Corners, FanRange, Loft, loft};
use super::diagnose::{Measured, measure, table};
use super::exact::{self, CERTIFICATE_NODES, Rulings};
use super::input::Task;
use super::outcome::{
    Deviation, Fan, MovedPoint, Outcome, OutcomeProfile, Plate, PlateDiagnostics, Termination,
};
use super::path::PathShape;
use super::request::{Boundary, Options, Request, Solver};
use super::search;
use super::task::EndSpeeds;
use super::twist::twist_angle;
use crate::geometry::{
    BSplineCurve, CurveIndex, RuledSurface, Tolerance, directed_distance_between,
};
use crate::methods::{Control, FitError};
use crate::solver::Report;
use rayon::prelude::*;

/// A solved hull in unit scale.
#[derive(Debug)]
pub(super) struct Solved {
    pub(super) plates: Vec<SolvedPlate>,
    /// The boundary curves, moved or not.
    pub(super) curves: Vec<BSplineCurve>,
    /// Whether any curve was moved.
    pub(super) moved: bool,
}

/// One solved plate.
#[derive(Debug)]
pub(super) struct SolvedPlate {
    pub(super) shape: SolvedShape,
    /// Iterations of all stages, and how the last one ended.
    pub(super) iterations: usize,
    pub(super) last: Option<Report>,
    /// Which speeds of the rulings' ends were bounded.
    pub(super) speeds: EndSpeeds,
    /// Largest |θ| with the boundaries left alone, radians, where known: the
    /// certificate need not look above it.
    pub(super) exact_twist: f64,
}

/// What a plate is made from.
#[derive(Debug)]
pub(super) enum SolvedShape {
    /// A path between the boundary curves, and its unknowns.
    Path(PathShape, Vec<f64>),
    /// Two boundaries of its own (the paper's solver).
    Loft(Loft),
}

impl SolvedPlate {
    pub(super) fn along(rulings: Rulings) -> Self {
        SolvedPlate {
            shape: SolvedShape::Path(rulings.shape, rulings.y),
            iterations: rulings.iterations,
            last: rulings.last,
            speeds: rulings.speeds,
            exact_twist: rulings.twist_max,
        }
    }
}

/// Moves below this share of the model are none: the promise of `exact`.
const MOVED: f64 = 1e-6;
/// Deviations are certified to this share of the model.
const RESOLUTION: f64 = 1e-7;

/// Builds the outcome.
pub(super) fn outcome(
    request: &Request,
    task: &Task,
    solved: &Solved,
    control: &dyn Control,
) -> Result<Outcome, FitError> {
    control.progress("writing", 70.0);
    let lofts = (0..solved.plates.len())
        .into_par_iter()
        .map(|i| {
            control.check()?;
            loft_of(task, solved, i)
        })
        .collect::<Result<Vec<_>, FitError>>()?;
    control.progress("measuring", 80.0);
    let plates = lofts
        .par_iter()
        .enumerate()
        .map(|(i, loft)| {
            control.check()?;
            plate(request, task, solved, (i, loft))
        })
        .collect::<Result<Vec<_>, FitError>>()?;
    let profiles = (0..solved.curves.len())
        .into_par_iter()
        .map(|k| {
            control.check()?;
            profile(request, task, solved, (k, &lofts))
        })
        .collect::<Result<Vec<_>, FitError>>()?;
    let within_limits = plates.iter().all(|p| p.within_limits);
    let mut outcome = Outcome {
        within_limits,
        summary: Vec::new(),
        warnings: task.warnings.clone(),
        model_size: task.size,
        profiles,
        plates,
    };
    outcome.summary = summary(&request.options, &outcome, solved.moved);
    control.progress("done", 100.0);
    Ok(outcome)
}

fn loft_of(task: &Task, solved: &Solved, i: usize) -> Result<Loft, FitError> {
    let edges = [i, i + 1].map(|k| Edge {
        profile: &task.profiles[k],
        curve: &solved.curves[k],
    });
    let corners = match task.longest_extension {
        None => Corners::Fans,
        Some(longest) => Corners::Extensions { longest },
    };
    match &solved.plates[i].shape {
        SolvedShape::Path(shape, y) => loft([&edges[0], &edges[1]], shape, y, corners),
        SolvedShape::Loft(loft) => Ok(loft.clone()),
    }
}

/// A curve in the user's scale.
fn to_user(task: &Task, curve: &BSplineCurve) -> Result<BSplineCurve, FitError> {
    let points = curve
        .control_points()
        .iter()
        .map(|p| task.to_user(p))
        .collect();
    BSplineCurve::new(curve.degree(), curve.knots().to_vec(), points, None)
        .map_err(|e| FitError::Numerical(e.to_string()))
}

fn plate(
    request: &Request,
    task: &Task,
    solved: &Solved,
    (i, loft): (usize, &Loft),
) -> Result<Plate, FitError> {
    let numerical = |e: crate::geometry::SplineError| FitError::Numerical(e.to_string());
    let ruled = RuledSurface::new(to_user(task, &loft.first)?, to_user(task, &loft.second)?)
        .map_err(numerical)?;
    let measured = measure(&ruled, &loft.fans);
    let fans: Vec<Fan> = loft.fans.iter().map(fan).collect();
    let diagnostics = diagnostics(request, task, (i, solved), (&measured, loft));
    let options = &request.options;
    let name = format!(
        "{} – {}",
        request.profiles[i].name,
        request.profiles[i + 1].name
    );
    let faults = faults(
        options,
        &diagnostics,
        (solved.moved, solved.plates[i].speeds),
    );
    let mut extensions = [0.0; 4];
    for f in &loft.fans {
        let corner = 2 * usize::from(!f.apex_on_first) + usize::from(!f.at_start);
        extensions[corner] = f.extension * task.size;
    }
    Ok(Plate {
        sentence: sentence(
            options,
            (i, &name),
            &diagnostics,
            (&faults, solved.plates[i].speeds),
        ),
        name,
        surface: ruled.to_bspline().map_err(numerical)?,
        within_limits: faults.is_empty(),
        rulings: table(&ruled, &loft.fans),
        fans,
        extensions,
        diagnostics,
    })
}

fn fan(f: &FanRange) -> Fan {
    Fan {
        at_start: f.at_start,
        apex_on_first: f.apex_on_first,
        swept_percent: 100.0 * f.swept,
        u_range: f.range,
    }
}

fn diagnostics(
    request: &Request,
    task: &Task,
    (i, solved): (usize, &Solved),
    (m, loft): (&Measured, &Loft),
) -> PlateDiagnostics {
    let rulings = &solved.plates[i];
    let mut fan_percent = [0.0_f64; 2];
    for f in &loft.fans {
        fan_percent[usize::from(f.apex_on_first)] += 100.0 * f.swept;
    }
    let extension = loft.fans.iter().map(|f| f.extension).fold(0.0, f64::max);
    PlateDiagnostics {
        twist_max_deg: m.twist_max.to_degrees(),
        twist_max_u: m.twist_max_u,
        twist_max_at: m.twist_max_at,
        twist_mean_deg: m.twist_mean.to_degrees(),
        twist_p95_deg: m.twist_p95.to_degrees(),
        corner_warp_deg: corner_warp(&solved.curves[i], &solved.curves[i + 1]),
        bottleneck_deg: certificate(task, solved, i).to_degrees(),
        bottleneck_grid: CERTIFICATE_NODES,
        regression_clearance: m.clearance,
        crossing_rulings: m.crossing,
        min_bend_radius: m.bend_radius,
        min_bend_radius_u: m.bend_radius_u,
        bend_strain_percent: request.options.thickness.map(|t| 50.0 * t / m.bend_radius),
        fan_percent,
        extension_percent: 100.0 * extension,
        membrane_strain_percent: 100.0 * m.twist_max * m.twist_max / 8.0,
        gaussian_curvature_max: m.gaussian_max,
        area: m.area,
        pinned_deviation: pinned_deviation(task, solved, i),
        termination: Termination {
            iterations: rulings.iterations,
            reason: rulings
                .last
                .map_or("not-needed", |r| r.termination.as_str()),
        },
    }
}

fn corner_warp(first: &BSplineCurve, second: &BSplineCurve) -> [f64; 2] {
    let at = |u: usize| {
        let (a, b) = (
            first.derivatives(first.domain()[u]),
            second.derivatives(second.domain()[u]),
        );
        twist_angle(&(b.point - a.point), &a.d1, &b.d1)
            .abs()
            .to_degrees()
    };
    [at(0), at(1)]
}

/// The bounded discrete optimum on a fine grid, for the profiles as given; the
/// least demanding bounds, so that it holds for whatever was chosen.
fn certificate(task: &Task, solved: &Solved, i: usize) -> f64 {
    let pair = [&task.profiles[i], &task.profiles[i + 1]];
    let field = exact::field(pair, CERTIFICATE_NODES);
    let speeds = EndSpeeds::AlongTheCurves;
    let bounds = exact::bounds(
        [false; 2],
        &task.limits,
        &task.pins[i],
        speeds,
        CERTIFICATE_NODES,
    );
    // A little room: the grid's nodes are not the path's samples.
    let known = solved.plates[i].exact_twist * 1.05 + 1e-3;
    search::bottleneck(&field, &bounds, known)
        .or_else(|| search::bottleneck(&field, &bounds, f64::INFINITY))
        .unwrap_or(f64::NAN)
}

fn pinned_deviation(task: &Task, solved: &Solved, i: usize) -> Option<f64> {
    let SolvedShape::Path(shape, y) = &solved.plates[i].shape else {
        return None;
    };
    let shape = shape.clone().rounded(0.0);
    let off = |&(s, t): &(f64, f64)| {
        let (miss, _) = shape.miss(y, s, t);
        miss.abs() * task.profiles[i].length().max(task.profiles[i + 1].length()) * task.size
    };
    task.pins[i].iter().map(off).reduce(f64::max)
}

fn profile(
    request: &Request,
    task: &Task,
    solved: &Solved,
    (k, lofts): (usize, &[Loft]),
) -> Result<OutcomeProfile, FitError> {
    let resolution = Tolerance::absolute(RESOLUTION)
        .ok_or_else(|| FitError::Numerical("no resolution".into()))?;
    let given = CurveIndex::new(&task.profiles[k].curve);
    let edges = [
        k.checked_sub(1).map(|i| &lofts[i].second),
        lofts.get(k).map(|l| &l.first),
    ];
    let mut deviation = Deviation {
        points_max: 0.0,
        curve_max: 0.0,
        curve_mean: 0.0,
        curve_rms: 0.0,
    };
    let mut moved_points = Vec::new();
    for edge in edges.into_iter().flatten() {
        let index = CurveIndex::new(edge);
        let distance = directed_distance_between(&given, &index, resolution);
        deviation.curve_max = deviation.curve_max.max(distance.max * task.size);
        deviation.curve_mean = deviation.curve_mean.max(distance.mean * task.size);
        deviation.curve_rms = deviation.curve_rms.max(distance.rms * task.size);
        moved_points.clear();
        for (index_given, point) in &task.given[k] {
            let foot = index.closest(point);
            deviation.points_max = deviation.points_max.max(foot.distance * task.size);
            if foot.distance > MOVED {
                moved_points.push(MovedPoint {
                    index: *index_given,
                    given: task.to_user(point),
                    now: task.to_user(&foot.point),
                    distance: foot.distance * task.size,
                });
            }
        }
    }
    Ok(OutcomeProfile {
        name: request.profiles[k].name.clone(),
        curve: to_user(task, &solved.curves[k])?,
        deviation,
        moved_points,
    })
}

/// The clearance is held at samples; between them this share of it is enough.
const CLEARANCE_ROOM: f64 = 0.97;

/// The limits that a plate breaks, each as the end of a sentence.
fn faults(
    options: &Options,
    d: &PlateDiagnostics,
    (moved, speeds): (bool, EndSpeeds),
) -> Vec<String> {
    let mut faults = Vec::new();
    if d.twist_max_deg > options.max_twist_deg {
        let excess = if moved {
            "the boundary moved as far as was allowed: allow more or divide the plate".into()
        } else if d.bottleneck_deg > options.max_twist_deg {
            format!(
                "no set of rulings between these two curves stays within it (at least {}): \
                 allow the boundary to move (mode \"tolerance\" or \"auto\") or divide the plate",
                degrees(d.bottleneck_deg)
            )
        } else {
            "another fan or clearance limit may meet it".into()
        };
        faults.push(format!("the twist is above the limit; {excess}"));
    }
    if d.crossing_rulings > 0 {
        faults.push(format!(
            "rulings cross at {} place(s): the plate would fold",
            d.crossing_rulings
        ));
    }
    let may_move = moved || matches!(options.boundary, Boundary::Tolerance(_));
    let asked = options.clearance_percent(may_move) / 100.0;
    // The paper's solver knows no such bound.
    let bounded = speeds == EndSpeeds::AcrossTheRuling && options.solver == Solver::Own;
    if bounded && d.regression_clearance < CLEARANCE_ROOM * asked {
        faults.push(format!(
            "the edge of regression comes within {:.3} ruling lengths, less than {asked:.3}",
            d.regression_clearance
        ));
    }
    if let Some(least) = options.min_bend_radius
        && d.min_bend_radius < least
    {
        faults.push(format!(
            "it bends to a radius of {:.4}, less than {least}, at u = {:.3}",
            d.min_bend_radius, d.min_bend_radius_u
        ));
    }
    faults
}

fn degrees(angle: f64) -> String {
    if angle >= 0.1 {
        format!("{angle:.2}°")
    } else {
        format!("{angle:.4}°")
    }
}

fn sentence(
    options: &Options,
    (i, name): (usize, &str),
    d: &PlateDiagnostics,
    (faults, speeds): (&[String], EndSpeeds),
) -> String {
    let place = d.twist_max_at;
    let mut text = format!(
        "Plate {} ({name}): worst twist {} at x = {:.4}, limit {}",
        i + 1,
        degrees(d.twist_max_deg),
        place.x,
        degrees(options.max_twist_deg)
    );
    for fault in faults {
        text.push_str("; ");
        text.push_str(fault);
    }
    if speeds == EndSpeeds::AlongTheCurves {
        text.push_str(&format!(
            "; where rulings run along a curve the regression curve comes within {:.3} ruling lengths",
            d.regression_clearance
        ));
    }
    text.push('.');
    text
}

fn summary(options: &Options, outcome: &Outcome, moved: bool) -> Vec<String> {
    let verdict = if outcome.within_limits {
        "within limits"
    } else {
        "outside limits"
    };
    let largest = outcome
        .profiles
        .iter()
        .map(|p| p.deviation.curve_max)
        .fold(0.0, f64::max);
    let boundary = if moved {
        format!(
            "profiles moved by at most {:.4} ({:.4} % of the longest side)",
            largest,
            100.0 * largest / outcome.model_size
        )
    } else {
        "no profile changed".into()
    };
    let good = outcome.plates.iter().filter(|p| p.within_limits).count();
    let mut sentences = vec![format!(
        "{good} of {} plates {} the twist limit of {}, {boundary}: {verdict}.",
        outcome.plates.len(),
        if good == 1 { "keeps" } else { "keep" },
        degrees(options.max_twist_deg)
    )];
    sentences.extend(outcome.plates.iter().map(|p| p.sentence.clone()));
    sentences
}
