//! From the solution in unit scale to the answer in the user's.

use super::fairness::Gauge;
use super::input::Prepared;
use super::outcome::{Fairness, Move, MoveFigures, Outcome, Report, Slip, TradeOff};
use super::request::Request;
use super::solve::{Solved, Traced};
use super::space::Vector;
use crate::geometry::bspline::{BasisTable, Pieces};
use crate::geometry::{BSplineCurve, CurveIndex, Parametrization, interpolate};
use crate::methods::FitError;
use crate::solver::Control;
use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

/// Share of its tolerance from which a point counts as at its limit.
const AT_LIMIT: f64 = 0.999;
/// Rounding of the user's coordinates, as a share of the size: what a locked
/// point may be off.
const ROUNDING: f64 = 1e-9;
/// Points through which a spline shows how the given curve looked.
const MOST_BEFORE: usize = 2000;
/// Points between two looks at the control.
const CHECK_EVERY: usize = 2048;
/// A dual below this share of the greatest holds nothing back.
const IDLE: f64 = 1e-4;

/// The outcome of a solution.
///
/// # Errors
/// When the control says stop, or if the curve is not finite.
pub(super) fn outcome<const D: usize>(
    request: &Request,
    prepared: &Prepared,
    traced: &Traced,
    solved: &Solved<D>,
    control: &dyn Control,
) -> Result<Outcome, FitError> {
    let shape = &solved.shape;
    let broken = |e: crate::geometry::SplineError| FitError::Numerical(e.to_string());
    let unit = shape.space.curve(&shape.x).map_err(broken)?;
    let curve = in_user_scale::<D>(&unit, prepared).map_err(broken)?;
    let plane = (D == 2).then(|| prepared.frame.leave_direction(&Vector3::z()));
    let table = BasisTable::new(curve.knot_vector());
    let gauge = Gauge::new(&curve, &table, plane, traced.closed);
    let moves = moves(request, prepared, solved, &unit, control)?;
    let figures = figures(&moves);
    let within = moves.iter().all(|m| keeps(m, prepared.frame.size));
    let slips = slips(request, prepared, solved);
    let mut outcome = Outcome {
        name: request.name.clone(),
        within_limits: within,
        summary: Vec::new(),
        warnings: prepared.warnings.clone(),
        closed: traced.closed,
        order: order(prepared, solved),
        report: report(request, prepared, solved, &curve),
        move_figures: figures,
        slips,
        before: before(request, prepared, traced, plane),
        after: gauge.fairness(),
        trade_off: trade_off(request, prepared, solved),
        comb: gauge.comb(),
        moves,
        curve,
    };
    outcome.summary = super::sentences::summary(request, &outcome);
    Ok(outcome)
}

fn in_user_scale<const D: usize>(
    unit: &BSplineCurve,
    prepared: &Prepared,
) -> Result<BSplineCurve, crate::geometry::SplineError> {
    let leave = |p: &Point3<f64>| {
        let v: Vector<D> = Vector::from_fn(|i, _| p[i]);
        prepared.frame.leave(&v)
    };
    // Parameters near arc length in the user's unit, from 0.
    let size = prepared.frame.size;
    let start = unit.domain()[0];
    let knots = unit.knots().iter().map(|t| (t - start) * size).collect();
    let points = unit.control_points().iter().map(leave).collect();
    BSplineCurve::new(unit.degree(), knots, points, None)
}

/// Every point of the request with its place on the curve, measured anew on
/// the curve by a search that proves the nearest place.
fn moves<const D: usize>(
    request: &Request,
    prepared: &Prepared,
    solved: &Solved<D>,
    unit: &BSplineCurve,
    control: &dyn Control,
) -> Result<Vec<Move>, FitError> {
    let index = CurveIndex::new(unit);
    let holds = holds_back(solved);
    let curve = solved.shape.space.pieces(&solved.shape.x);
    let chunks: Result<Vec<Vec<Move>>, FitError> = prepared
        .stands_for
        .par_chunks(CHECK_EVERY)
        .enumerate()
        .map(|(chunk, positions)| {
            control.check()?;
            let measure = |(k, position): (usize, &usize)| Move {
                index: chunk * CHECK_EVERY + k,
                given: request.points[chunk * CHECK_EVERY + k],
                ..one_move(prepared, solved, (&index, &curve, &holds), *position)
            };
            Ok(positions.iter().enumerate().map(measure).collect())
        })
        .collect();
    Ok(chunks?.concat())
}

/// The move of the point at a position among those that count.
fn one_move<const D: usize>(
    prepared: &Prepared,
    solved: &Solved<D>,
    (index, curve, holds): (&CurveIndex, &Pieces<D>, &[f64]),
    k: usize,
) -> Move {
    let start = solved.shape.space.domain()[0];
    let size = prepared.frame.size;
    let springs = &solved.springs;
    let u = springs.feet[k];
    let nearest = index.closest_near(&super::space::in_space(&springs.points[k]), u);
    let held = springs.pinned[k] || !springs.is_free();
    let (now, parameter, distance) = if held {
        let own = curve.point(u);
        (own, u, (springs.points[k] - own).norm())
    } else {
        let now = Vector::from_fn(|c, _| nearest.point[c]);
        (now, nearest.parameter, nearest.distance)
    };
    let tolerance = solved.tolerances[k];
    Move {
        index: k,
        given: Point3::origin(),
        now: prepared.frame.leave(&now),
        parameter: (parameter - start) * size,
        distance: distance * size,
        off_curve: nearest.distance * size,
        tolerance: tolerance.is_finite().then_some(tolerance * size),
        holds_back: holds[k] / size.powi(4),
    }
}

/// −∂F/∂ε = 2z/ε of every point, unit scale.
fn holds_back<const D: usize>(solved: &Solved<D>) -> Vec<f64> {
    let count = solved.springs.points.len();
    if solved.duals.is_empty() {
        return vec![0.0; count];
    }
    let bounded = |t: f64| t.is_finite() && t > 0.0;
    let each = solved.duals.iter().zip(&solved.tolerances);
    let raw: Vec<f64> = each
        .map(|(z, t)| if bounded(*t) { 2.0 * z / t } else { 0.0 })
        .collect();
    let most = raw.iter().copied().fold(0.0, f64::max);
    raw.iter()
        .map(|v| if *v > IDLE * most { *v } else { 0.0 })
        .collect()
}

/// Whether a point keeps its tolerance; a locked one to rounding.
fn keeps(m: &Move, size: f64) -> bool {
    m.tolerance
        .is_none_or(|t| m.distance <= t.max(ROUNDING * size))
}

fn figures(moves: &[Move]) -> MoveFigures {
    let worst = moves
        .iter()
        .max_by(|a, b| a.distance.total_cmp(&b.distance));
    let squares: f64 = moves.iter().map(|m| m.distance * m.distance).sum();
    let past = |share: f64| {
        let beyond = |m: &&Move| {
            m.tolerance
                .is_some_and(|t| t > 0.0 && m.distance > share * t)
        };
        moves.iter().filter(beyond).count()
    };
    MoveFigures {
        max: worst.map_or(0.0, |m| m.distance),
        max_index: worst.map_or(0, |m| m.index),
        rms: (squares / moves.len().max(1) as f64).sqrt(),
        at_limit: past(AT_LIMIT),
        past_half: past(0.5),
    }
}

fn order<const D: usize>(prepared: &Prepared, solved: &Solved<D>) -> Vec<usize> {
    let feet = &solved.springs.feet;
    let mut all: Vec<usize> = (0..prepared.stands_for.len()).collect();
    let foot = |i: &usize| feet[prepared.stands_for[*i]];
    all.sort_by(|a, b| foot(a).total_cmp(&foot(b)).then(a.cmp(b)));
    all
}

fn slips<const D: usize>(request: &Request, prepared: &Prepared, solved: &Solved<D>) -> Vec<Slip> {
    let slip = |s: &super::slips::Suspect<D>| {
        let index = prepared.kept[s.index];
        let expected = prepared.frame.leave(&s.expected);
        let given = solved.springs.points[s.index];
        Slip {
            index,
            given: request.points[index],
            expected,
            off: (given - s.expected).norm() * prepared.frame.size,
            deviations: s.deviations,
            chance: s.chance,
            disregarded: request.options.robust,
        }
    };
    solved.suspects.iter().map(slip).collect()
}

fn trade_off<const D: usize>(
    request: &Request,
    prepared: &Prepared,
    solved: &Solved<D>,
) -> Vec<TradeOff> {
    let size = prepared.frame.size;
    let largest = solved.tolerances.iter().filter(|t| t.is_finite());
    let common = request
        .options
        .tolerance
        .unwrap_or_else(|| largest.fold(0.0_f64, |m, t| m.max(*t)) * size);
    let row = |[factor, used, energy, most]: &[f64; 4]| TradeOff {
        tolerance: factor * common,
        reached: *used < 1.0,
        max_move: most * size,
        curvature_variation: energy / size.powi(3),
    };
    solved.trade_off.iter().map(row).collect()
}

fn report<const D: usize>(
    request: &Request,
    prepared: &Prepared,
    solved: &Solved<D>,
    curve: &BSplineCurve,
) -> Report {
    Report {
        control_points: curve.control_points().len(),
        control_points_from: solved.net,
        degree: curve.degree(),
        noise: solved.choice.noise * prepared.frame.size,
        noise_evident: solved.choice.evident,
        degrees_of_freedom: solved.choice.degrees_of_freedom,
        stiffness: solved.choice.stiffness,
        iterations: solved.steps,
        gap: solved.gap,
        tangent_error_deg: tangent_error(request, curve),
        straightness: straightness(prepared, solved, request),
    }
}

fn tangent_error(request: &Request, curve: &BSplineCurve) -> Option<f64> {
    let [a, b] = curve.domain();
    let at = [curve.derivatives(a).d1, curve.derivatives_left(b).d1];
    let wanted = request.options.end_tangents.iter().zip(at);
    wanted
        .filter_map(|(t, d)| t.map(|t| t.angle(&d).to_degrees()))
        .reduce(f64::max)
}

/// The largest distance of a straight stretch from its chord.
fn straightness<const D: usize>(
    prepared: &Prepared,
    solved: &Solved<D>,
    request: &Request,
) -> Option<f64> {
    const PROBES: usize = 64;
    let (space, x) = (&solved.shape.space, &solved.shape.x);
    let bow = |[a, b]: &[usize; 2]| {
        let u = [a, b].map(|i| solved.springs.feet[prepared.stands_for[*i]]);
        let (from, to) = (space.point(x, u[0]), space.point(x, u[1]));
        let along = (to - from).normalize();
        let off = |k: usize| {
            let t = k as f64 / PROBES as f64;
            let v = space.point(x, u[0] + t * (u[1] - u[0])) - from;
            (v - along * along.dot(&v)).norm()
        };
        (0..=PROBES).map(off).fold(0.0, f64::max)
    };
    let all = request.options.straight.iter().map(bow);
    all.reduce(f64::max).map(|v| v * prepared.frame.size)
}

/// Fairness of the spline through the points (or through means of
/// neighbours, if there are many).
fn before(
    request: &Request,
    prepared: &Prepared,
    traced: &Traced,
    plane: Option<Vector3<f64>>,
) -> Option<Fairness> {
    let mut along: Vec<usize> = (0..prepared.kept.len()).collect();
    along.sort_by(|a, b| traced.parameters[*a].total_cmp(&traced.parameters[*b]));
    let flat = |k: &usize| {
        let p = request.points[prepared.kept[*k]];
        if request.dimension == 2 {
            Point3::new(p.x, p.y, 0.0)
        } else {
            p
        }
    };
    let size = along.len().div_ceil(MOST_BEFORE);
    let mut points: Vec<Point3<f64>> = along
        .chunks(size)
        .map(|c| {
            let sum: Vector3<f64> = c.iter().map(|k| flat(k).coords).sum();
            Point3::from(sum / c.len() as f64)
        })
        .collect();
    if traced.closed {
        points.extend(points.first().copied());
    }
    points.dedup();
    let degree = 3.min(points.len().checked_sub(1)?).max(1);
    let curve = interpolate(&points, degree, Parametrization::ChordLength).ok()?;
    let table = BasisTable::new(curve.knot_vector());
    Some(Gauge::new(&curve, &table, plane, traced.closed).fairness())
}
