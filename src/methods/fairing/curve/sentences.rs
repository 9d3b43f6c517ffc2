//! The outcome in sentences: the verdict first.

use super::outcome::Outcome;
use super::request::{Request, Solver};
use crate::methods::words::short;

/// The summary of an outcome.
pub(super) fn summary(request: &Request, o: &Outcome) -> Vec<String> {
    let mut all = vec![verdict(request, o)];
    all.push(format!(
        "∫κ′² ds is {}{}; {} extrema of curvature, {} inflections.",
        short(o.after.curvature_variation),
        o.before.map_or(String::new(), |b| format!(
            " against {} of the spline through the points",
            short(b.curvature_variation)
        )),
        o.after.extrema,
        o.after.inflections
    ));
    if o.report.noise > 0.0 && request.options.solver == Solver::Own {
        all.push(if o.report.noise_evident {
            format!(
                "The points scatter by {} (standard deviation).",
                short(o.report.noise)
            )
        } else {
            format!(
                "The points are too few to tell noise from shape; it is at most about {}.",
                short(o.report.noise)
            )
        });
    }
    all.extend(doubts(o));
    all.push(format!(
        "Degree {}, {} control points ({}).",
        o.report.degree, o.report.control_points, o.report.control_points_from
    ));
    all.extend(o.slips.iter().take(5).map(|s| {
        format!(
            "Point {} looks like a slip: it is {} off, {:.1} deviations; the fair shape has it at \
             ({}, {}, {}).{}",
            s.index,
            short(s.off),
            s.deviations,
            short(s.expected.x),
            short(s.expected.y),
            short(s.expected.z),
            if s.disregarded {
                " It is disregarded."
            } else {
                ""
            }
        )
    }));
    if o.slips.len() > 5 {
        all.push(format!(
            "{} more points look like slips.",
            o.slips.len() - 5
        ));
    }
    all
}

/// Gap above which a curve is not said to be the fairest.
const DOUBTFUL_GAP: f64 = 0.01;
/// Tolerances below so many deviations leave no room for a fair curve: of a
/// few hundred points several are farther off.
const TIGHT: f64 = 2.5;

/// What an outcome within its tolerances still lacks.
fn doubts(o: &Outcome) -> Vec<String> {
    let mut doubts = Vec::new();
    let tightest = o.moves.iter().filter_map(|m| m.tolerance);
    let tightest = tightest.filter(|t| *t > 0.0).fold(f64::INFINITY, f64::min);
    if o.report.noise_evident && tightest < TIGHT * o.report.noise {
        doubts.push(format!(
            "A tolerance of {} is less than {TIGHT} times the scatter of the points: the curve \
             has to follow their errors and is rougher for it.",
            short(tightest)
        ));
    }
    if let Some(gap) = o.report.gap.filter(|g| *g > DOUBTFUL_GAP) {
        doubts.push(format!(
            "There may be a fairer curve within the tolerances: the search ended with a gap of \
             {:.0} %.",
            100.0 * gap
        ));
    }
    doubts
}

fn verdict(request: &Request, o: &Outcome) -> String {
    let f = &o.move_figures;
    let name = if request.name.is_empty() {
        "The curve"
    } else {
        &request.name
    };
    let asked = request.options.tolerance.is_some() || !request.options.tolerances.is_empty();
    if !asked {
        return format!(
            "{name}: {} points, largest move {} at point {}, {} rms.",
            o.moves.len(),
            short(f.max),
            f.max_index,
            short(f.rms)
        );
    }
    if o.within_limits {
        format!(
            "{name}: every one of {} points keeps its tolerance; largest move {} at point {}, {} \
             points at their limit.",
            o.moves.len(),
            short(f.max),
            f.max_index,
            f.at_limit
        )
    } else {
        let over = |m: &&super::outcome::Move| m.tolerance.is_some_and(|t| m.distance > t);
        format!(
            "{name}: {} of {} points are beyond their tolerance, point {} by most ({}); a larger \
             tolerance, more control points or a correction is needed.",
            o.moves.iter().filter(over).count(),
            o.moves.len(),
            f.max_index,
            short(f.max)
        )
    }
}
