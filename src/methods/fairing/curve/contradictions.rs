//! Wishes that no curve can meet together, found before the fit.

use super::checks::Complaints;
use super::input::Prepared;
use super::request::Request;
use nalgebra::{Point3, Vector3};

/// Points farther from a line than this share of their size are not on it.
const ON_LINE: f64 = 1e-9;
/// An end tangent may differ from a straight stretch by this angle.
const SAME_DIRECTION_DEG: f64 = 1e-6;

/// Adds what contradicts itself.
pub(super) fn check_contradictions(
    request: &Request,
    prepared: &Prepared,
    issues: &mut Complaints,
) {
    closed_line(request, prepared, issues);
    for (k, stretch) in request.options.straight.iter().enumerate() {
        locked_off_line(request, prepared, (k, *stretch), issues);
        ends_of(request, prepared, *stretch, issues);
    }
}

/// A point as far as it counts.
fn place(request: &Request, i: usize) -> Point3<f64> {
    let p = request.points[i];
    if request.dimension == 2 {
        Point3::new(p.x, p.y, 0.0)
    } else {
        p
    }
}

fn is_locked(request: &Request, i: usize) -> bool {
    let o = &request.options;
    let own = o.tolerances.get(i).copied().or(o.tolerance);
    o.locked.contains(&i) || own == Some(0.0)
}

fn off_line(p: &Point3<f64>, from: &Point3<f64>, along: &Vector3<f64>) -> f64 {
    let v = p - from;
    (v - along * along.dot(&v)).norm()
}

/// A closed curve through points of one line would double back on itself.
fn closed_line(request: &Request, prepared: &Prepared, issues: &mut Complaints) {
    if prepared.closed != Some(true) {
        return;
    }
    let first = place(request, prepared.kept[0]);
    let away = |i: &usize| (place(request, *i) - first).norm();
    let by = |a: &&usize, b: &&usize| away(a).total_cmp(&away(b));
    let Some(far) = prepared.kept.iter().max_by(by) else {
        return;
    };
    let Some(along) = (place(request, *far) - first).try_normalize(0.0) else {
        return;
    };
    let most = ON_LINE * prepared.frame.size;
    let all_on_it = prepared
        .kept
        .iter()
        .all(|i| off_line(&place(request, *i), &first, &along) <= most);
    if all_on_it {
        let message = format!(
            "all {} points lie on one line; a closed curve needs points beside it",
            prepared.kept.len()
        );
        let hint = Some("say closed: false, or leave out the repeated last point");
        issues.add(&["input", "points"], "collinear", message, hint);
    }
}

/// Three locked points of a straight stretch must lie on one line.
fn locked_off_line(
    request: &Request,
    prepared: &Prepared,
    (k, [a, b]): (usize, [usize; 2]),
    issues: &mut Complaints,
) {
    let locked: Vec<usize> = (a..=b).filter(|i| is_locked(request, *i)).collect();
    let (Some(first), Some(last)) = (locked.first(), locked.last()) else {
        return;
    };
    let from = place(request, *first);
    let Some(along) = (place(request, *last) - from).try_normalize(0.0) else {
        return;
    };
    let off = |i: &usize| off_line(&place(request, *i), &from, &along);
    let worst = locked.iter().max_by(|i, j| off(i).total_cmp(&off(j)));
    if let Some(i) = worst.filter(|i| off(i) > ON_LINE * prepared.frame.size) {
        let message = format!(
            "the stretch from point {a} to point {b} shall be straight, but its locked points \
             are not in line: point {i} is {:.4e} off the line through points {first} and {last}",
            off(i)
        );
        let hint = Some("unlock one of them, give it a tolerance, or end the stretch there");
        let at = k.to_string();
        issues.add(
            &["options", "straight", &at],
            "contradiction",
            message,
            hint,
        );
    }
}

/// At an end inside a straight stretch the curvature is 0, and the tangent
/// that of the stretch.
fn ends_of(request: &Request, prepared: &Prepared, [a, b]: [usize; 2], issues: &mut Complaints) {
    let o = &request.options;
    let last = prepared.kept.len() - 1;
    let reaches = [prepared.stands_for[a] == 0, prepared.stands_for[b] == last];
    for (end, reached) in reaches.into_iter().enumerate() {
        let at = end.to_string();
        if let Some(c) = o.end_curvatures[end].filter(|c| reached && *c != 0.0) {
            let message = format!(
                "the curvature {c} is asked at an end of the straight stretch from point {a} to \
                 point {b}, where it is 0"
            );
            let hint = Some("leave one of the two out");
            issues.add(
                &["options", "end_curvatures", &at],
                "contradiction",
                message,
                hint,
            );
        }
        let both = is_locked(request, a) && is_locked(request, b);
        if let Some(t) = o.end_tangents[end].filter(|_| reached && both) {
            let chord = place(request, b) - place(request, a);
            let turn = t.angle(&chord).to_degrees();
            if turn > SAME_DIRECTION_DEG {
                let message = format!(
                    "the end tangent is asked {turn:.3}° off the straight stretch from point {a} \
                     to point {b}, both locked"
                );
                let hint = Some("leave the tangent out, or unlock one of the points");
                issues.add(
                    &["options", "end_tangents", &at],
                    "contradiction",
                    message,
                    hint,
                );
            }
        }
    }
}
