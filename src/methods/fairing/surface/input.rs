//! From the request to a task, or to the issues that say where it is wrong.

use super::request::{Options, Points, Request, Solver, Tolerance};
use super::task::{Frame, LOCKED, Layout, Task};
use crate::methods::Issue;
use nalgebra::{Matrix3, Point3, Vector3};

/// Fewest points of a scattered sheet: a thin plate needs three that are not
/// in line, and one to have an error at all.
const FEWEST: usize = 4;
/// Points that differ by less than this share of their distance from the
/// origin are equal as far as numbers can tell.
const ROUNDING: f64 = 1e-13;
/// Points whose box is thinner than this share of its length lie in a line.
const THIN: f64 = 1e-7;
/// Most issues of one kind that are listed.
const MOST_ISSUES: usize = 20;
/// The paper's stiffness of border springs (§3, last paragraph but one).
const PAPER_BORDER: f64 = 100.0;
/// Fewest and most control points in one direction that can be asked for.
const CONTROL_POINTS: [usize; 2] = [4, 160];

/// Every issue of a request.
pub(super) fn issues(request: &Request) -> Vec<Issue> {
    match read(request) {
        Ok(_) => Vec::new(),
        Err(issues) => issues,
    }
}

/// An issue at a path below the job.
pub(in super::super) fn issue(
    path: &[&str],
    code: &'static str,
    message: impl Into<String>,
    hint: Option<&str>,
) -> Issue {
    Issue {
        path: path.iter().map(|s| (*s).to_owned()).collect(),
        code,
        message: message.into(),
        hint: hint.map(str::to_owned),
    }
}

/// A task.
///
/// # Errors
/// All issues found.
pub(in super::super) fn read(request: &Request) -> Result<Task, Vec<Issue>> {
    let mut issues = Vec::new();
    let (given, layout) = present(&request.points, &mut issues);
    options(request, &mut issues);
    if !issues.is_empty() {
        return Err(issues);
    }
    let place = match &request.points {
        Points::Grid(_) => ["input", "grid"],
        Points::Scattered(_) => ["input", "points"],
    };
    let frame = frame(&given).ok_or_else(|| {
        let message = format!("all {} points are equal", given.len());
        vec![issue(&place, "no-extent", message, None)]
    })?;
    let points: Vec<Vector3<f64>> = given.iter().map(|(_, p)| frame.to_unit(p)).collect();
    if in_line(&points) {
        let message = "the points lie in a line: they say nothing of a surface";
        let hint = Some("fair them as a curve, or give points beside the line");
        return Err(vec![issue(&place, "collinear", message, hint)]);
    }
    let index: Vec<usize> = given.iter().map(|(i, _)| *i).collect();
    Ok(task(request, (frame, layout), (index, points)))
}

fn task(
    request: &Request,
    (frame, layout): (Frame, Layout),
    (index, points): (Vec<usize>, Vec<Vector3<f64>>),
) -> Task {
    let o = &request.options;
    let total = index.last().map_or(0, |i| i + 1).max(index.len());
    let mut is_locked = vec![false; total];
    for i in &o.locked {
        if let Some(slot) = is_locked.get_mut(*i) {
            *slot = true;
        }
    }
    let locked: Vec<bool> = index.iter().map(|i| is_locked[*i]).collect();
    let any_locked = locked.iter().any(|l| *l);
    let bound = |i: usize| match &o.tolerance {
        Some(Tolerance::Same(t)) => t / frame.size,
        Some(Tolerance::Each(t)) => t[i] / frame.size,
        None => f64::INFINITY,
    };
    let tolerance = (o.tolerance.is_some() || any_locked).then(|| {
        let one = |(i, l): (&usize, &bool)| if *l { LOCKED } else { bound(*i) };
        index.iter().zip(&locked).map(one).collect()
    });
    let border = border_factor(o, &layout);
    let own = |k: usize| o.stiffness.as_ref().map_or(1.0, |s| s[index[k]]);
    let weight = (0..index.len()).map(|k| own(k) * border(k)).collect();
    drop(border);
    Task {
        weight,
        frame,
        tolerance,
        locked,
        freedom: o.freedom,
        energy: o.energy,
        control_points: o.control_points,
        knuckles: o.knuckles.clone().map(|mut lines| {
            lines.sort_unstable();
            lines.dedup();
            lines
        }),
        cut: o.cut.map(|p| frame.to_unit(&p)),
        robust: o.robust,
        light: o.light.normalize(),
        warnings: Vec::new(),
        layout,
        index,
        points,
    }
}

/// Factor of a present point's spring.
fn border_factor<'a>(o: &Options, layout: &'a Layout) -> impl Fn(usize) -> f64 + 'a {
    let factor = o.boundary_factor.unwrap_or(match o.solver {
        Solver::Paper => PAPER_BORDER,
        Solver::Own => 1.0,
    });
    move |k| match layout {
        Layout::Scattered => 1.0,
        Layout::Grid { cell, size } => {
            let edge = (0..2).any(|a| cell[k][a] == 0 || cell[k][a] + 1 == size[a]);
            if edge { factor } else { 1.0 }
        }
    }
}

/// The present points with their indices.
fn present(points: &Points, issues: &mut Vec<Issue>) -> (Vec<(usize, Point3<f64>)>, Layout) {
    match points {
        Points::Scattered(list) => {
            if list.len() < FEWEST {
                let message = format!("{} points are too few: at least {FEWEST}", list.len());
                issues.push(issue(&["input", "points"], "too-few-points", message, None));
            }
            for (i, p) in list.iter().enumerate() {
                if !finite(p) && issues.len() < MOST_ISSUES {
                    let path = ["input", "points", &i.to_string()];
                    issues.push(not_finite(&path, p));
                }
            }
            (
                list.iter().copied().enumerate().collect(),
                Layout::Scattered,
            )
        }
        Points::Grid(rows) => grid(rows, issues),
    }
}

fn grid(
    rows: &[Vec<Option<Point3<f64>>>],
    issues: &mut Vec<Issue>,
) -> (Vec<(usize, Point3<f64>)>, Layout) {
    let columns = rows.first().map_or(0, Vec::len);
    let size = [rows.len(), columns];
    if rows.len() < 2 || columns < 2 {
        let message = format!(
            "{} rows of {columns} points are no grid: at least 2 × 2",
            rows.len()
        );
        let hint = Some("fair a single row as a curve");
        issues.push(issue(&["input", "grid"], "too-few-points", message, hint));
    }
    let (mut given, mut cell) = (Vec::new(), Vec::new());
    for (r, row) in rows.iter().enumerate() {
        if row.len() != columns {
            let message = format!("row {r} has {} points, the first row {columns}", row.len());
            let path = ["input", "grid", &r.to_string()];
            issues.push(issue(&path, "row-length", message, None));
        }
        for (c, p) in row.iter().enumerate() {
            let Some(p) = p else { continue };
            if !finite(p) && issues.len() < MOST_ISSUES {
                let path = ["input", "grid", &r.to_string(), &c.to_string()];
                issues.push(not_finite(&path, p));
            }
            given.push((r * columns + c, *p));
            cell.push([r, c]);
        }
    }
    for k in 0..2 {
        let mut lines: Vec<usize> = cell.iter().map(|c| c[k]).collect();
        lines.sort_unstable();
        lines.dedup();
        if lines.len() < 2 && size[0] >= 2 && columns >= 2 {
            let word = ["row", "column"][k];
            let message = format!("only {} {word} of the grid has points", lines.len());
            issues.push(issue(&["input", "grid"], "too-few-points", message, None));
        }
    }
    if given.len() < FEWEST && issues.is_empty() {
        let message = format!("{} points are too few: at least {FEWEST}", given.len());
        issues.push(issue(&["input", "grid"], "too-few-points", message, None));
    }
    (given, Layout::Grid { cell, size })
}

fn finite(p: &Point3<f64>) -> bool {
    p.iter().all(|x| x.is_finite())
}

fn not_finite(path: &[&str], p: &Point3<f64>) -> Issue {
    let message = format!("the point ({}, {}, {}) is not finite", p.x, p.y, p.z);
    issue(path, "not-finite", message, None)
}

fn options(request: &Request, issues: &mut Vec<Issue>) {
    let o = &request.options;
    let count = match &request.points {
        Points::Grid(rows) => rows.len() * rows.first().map_or(0, Vec::len),
        Points::Scattered(list) => list.len(),
    };
    tolerance(o, count, issues);
    if let Some(list) = &o.stiffness {
        positive_list(("stiffness", "stiffness"), list, count, issues);
    }
    for (k, i) in o.locked.iter().enumerate() {
        if *i >= count {
            let message = format!("point {i} does not exist: there are {count}");
            let path = ["options", "locked", &k.to_string()];
            issues.push(issue(&path, "no-such-point", message, None));
        }
    }
    freedom(request, issues);
    knuckles(request, issues);
    shape(o, issues);
    if !(o.light.iter().all(|x| x.is_finite()) && o.light.norm() > 0.0) {
        let message = "the direction of the light has no length";
        issues.push(issue(&["options", "light"], "not-positive", message, None));
    }
}

/// Energy, border and control points.
fn shape(o: &Options, issues: &mut Vec<Issue>) {
    if let Some(e) = &o.energy {
        let all = [e.alpha11, e.alpha22, e.beta11, e.beta12, e.beta22];
        let ok = all.iter().all(|w| w.is_finite() && *w >= 0.0);
        // Both second derivatives or both first ones: else lines cost nothing.
        let holds = (e.alpha11 > 0.0 && e.alpha22 > 0.0) || (e.beta11 > 0.0 && e.beta22 > 0.0);
        if !ok || !holds {
            let message = "energy weights are at least 0, and alpha11 and alpha22 or beta11 and \
                           beta22 above 0";
            issues.push(issue(&["options", "energy"], "bad-energy", message, None));
        }
    }
    if let Some(b) = o.boundary_factor
        && !(b.is_finite() && b > 0.0)
    {
        let message = format!("the boundary stiffness factor {b} is not above 0");
        issues.push(issue(
            &["options", "boundary_factor"],
            "not-positive",
            message,
            None,
        ));
    }
    if let Some(n) = o.control_points
        && n.iter()
            .any(|n| !(CONTROL_POINTS[0]..=CONTROL_POINTS[1]).contains(n))
    {
        let [low, high] = CONTROL_POINTS;
        let message = format!(
            "{} × {} control points: each number is from {low} to {high}",
            n[0], n[1]
        );
        issues.push(issue(
            &["options", "control_points"],
            "out-of-range",
            message,
            None,
        ));
    }
}

fn tolerance(o: &Options, count: usize, issues: &mut Vec<Issue>) {
    match &o.tolerance {
        Some(Tolerance::Same(t)) if !(t.is_finite() && *t > 0.0) => {
            let message = format!("the tolerance {t} is not above 0");
            let hint = Some("leave it out to have it estimated, or lock points that must not move");
            issues.push(issue(
                &["options", "tolerance"],
                "not-positive",
                message,
                hint,
            ));
        }
        Some(Tolerance::Each(list)) => {
            positive_list(("tolerance", "tolerance"), list, count, issues);
        }
        _ => {
            if o.solver == Solver::Paper && o.tolerance.is_none() {
                let message = "the paper's loop needs a tolerance to raise its springs to";
                issues.push(issue(&["options", "tolerance"], "missing", message, None));
            }
        }
    }
}

fn positive_list((field, what): (&str, &str), list: &[f64], count: usize, issues: &mut Vec<Issue>) {
    if list.len() != count {
        let message = format!("{} values of {what} for {count} points", list.len());
        issues.push(issue(&["options", field], "wrong-count", message, None));
    }
    for (i, t) in list.iter().enumerate() {
        if !(t.is_finite() && *t > 0.0) && issues.len() < MOST_ISSUES {
            let message = format!("the {what} {t} of point {i} is not above 0");
            let path = ["options", field, &i.to_string()];
            issues.push(issue(&path, "not-positive", message, None));
        }
    }
}

/// Knuckles go with grids, and lie between the first and the last line.
fn knuckles(request: &Request, issues: &mut Vec<Issue>) {
    let size = match &request.points {
        Points::Grid(rows) => [rows.len(), rows.first().map_or(0, Vec::len)],
        Points::Scattered(_) => [0, 0],
    };
    let words = ["row", "column"];
    for (k, lines) in request.options.knuckles.iter().enumerate() {
        for (i, line) in lines.iter().enumerate() {
            if *line == 0 || line + 1 >= size[k] {
                let word = words[k];
                let message = match &request.points {
                    Points::Scattered(_) => "scattered points have no lines to be knuckles".into(),
                    Points::Grid(_) => format!("{word} {line} is not an inner one of {}", size[k]),
                };
                let path = ["options", KNUCKLES[k], &i.to_string()];
                issues.push(issue(&path, "no-such-line", message, None));
            }
        }
    }
}

/// What the lists of knuckles are called where they are given.
const KNUCKLES: [&str; 2] = ["knuckle_rows", "knuckle_columns"];

fn freedom(request: &Request, issues: &mut Vec<Issue>) {
    if request.options.freedom == [false; 3] {
        let message = "no axis is free: points could not move at all";
        issues.push(issue(&["options", "freedom"], "bad-freedom", message, None));
    }
    if let Some(place) = &request.options.cut {
        let path = ["options", "cut"];
        if !finite(place) {
            issues.push(not_finite(&path, place));
        }
        if matches!(request.points, Points::Grid(_)) {
            let message = "a grid is not cut: its rows and columns say where it ends";
            issues.push(issue(&path, "unexpected", message, None));
        }
    }
}

/// The frame of the points; `None` if they have no extent.
fn frame(points: &[(usize, Point3<f64>)]) -> Option<Frame> {
    let (mut low, mut high) = (points.first()?.1, points.first()?.1);
    for (_, p) in points {
        low = low.inf(p);
        high = high.sup(p);
    }
    let size = (high - low).max();
    let far = low.coords.abs().max().max(high.coords.abs().max());
    (size > ROUNDING * far && size > 0.0 && size.is_finite()).then(|| Frame {
        middle: low + 0.5 * (high - low),
        size,
        axes: Matrix3::identity(),
    })
}

/// Whether all points lie in a line, by their second moments.
fn in_line(points: &[Vector3<f64>]) -> bool {
    let mean = points.iter().sum::<Vector3<f64>>() / points.len() as f64;
    let mut moments = Matrix3::zeros();
    for p in points {
        let d = p - mean;
        moments += d * d.transpose();
    }
    let mut values: Vec<f64> = moments.symmetric_eigenvalues().iter().copied().collect();
    values.sort_by(f64::total_cmp);
    values[1] <= THIN * THIN * values[2]
}
