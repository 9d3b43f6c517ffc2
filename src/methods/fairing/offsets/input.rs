//! The rules of a table.

use super::request::Request;
use crate::methods::Issue;
use crate::methods::fairing::surface::input::issue;

/// Most issues that are listed.
const MOST_ISSUES: usize = 40;
/// Fewest positive half-breadths: a plane has three, and one to have an error.
const FEWEST: usize = 4;

/// Every issue of a request.
pub(super) fn issues(request: &Request) -> Vec<Issue> {
    let mut issues = Vec::new();
    line(("stations", "station"), &request.stations, &mut issues);
    line(
        ("waterlines", "waterline"),
        &request.waterlines,
        &mut issues,
    );
    cells(request, &mut issues);
    options(request, &mut issues);
    issues.truncate(MOST_ISSUES);
    issues
}

fn line((field, word): (&str, &str), places: &[f64], issues: &mut Vec<Issue>) {
    if places.len() < 2 {
        let message = format!("{} {word} is too few: at least 2", places.len());
        issues.push(issue(
            &["input", "offsets", field],
            "too-few",
            message,
            None,
        ));
    }
    for (i, x) in places.iter().enumerate() {
        let path = ["input", "offsets", field, &i.to_string()];
        if !x.is_finite() {
            let message = format!("the place {x} of {word} {i} is not finite");
            issues.push(issue(&path, "not-finite", message, None));
        } else if i > 0 && *x == places[i - 1] {
            let message = format!("{word} {i} repeats the place {x} of the one before");
            issues.push(issue(&path, "repeated", message, None));
        } else if i > 0 && *x < places[i - 1] {
            let message = format!("{word} {i} at {x} lies before the one at {}", places[i - 1]);
            let hint = Some("sort stations and waterlines, and the cells with them");
            issues.push(issue(&path, "unsorted", message, hint));
        }
    }
}

fn cells(request: &Request, issues: &mut Vec<Issue>) {
    let (rows, columns) = (request.stations.len(), request.waterlines.len());
    let given = &request.half_breadths;
    if given.len() != rows {
        let message = format!("{} rows of half-breadths for {rows} stations", given.len());
        issues.push(issue(
            &["input", "offsets", "y"],
            "row-count",
            message,
            None,
        ));
    }
    let mut positive = Vec::new();
    for (i, row) in given.iter().enumerate() {
        if row.len() != columns {
            let message = format!("row {i} has {} cells for {columns} waterlines", row.len());
            let path = ["input", "offsets", "y", &i.to_string()];
            issues.push(issue(&path, "row-length", message, None));
        }
        for (j, y) in row.iter().enumerate() {
            let Some(y) = y else { continue };
            let path = ["input", "offsets", "y", &i.to_string(), &j.to_string()];
            if !y.is_finite() {
                let message = format!("the half-breadth {y} is not finite");
                issues.push(issue(&path, "not-finite", message, None));
            } else if *y < 0.0 {
                let message = format!("the half-breadth {y} is negative");
                issues.push(issue(&path, "negative", message, None));
            } else if *y > 0.0 {
                positive.push([i, j]);
            }
        }
    }
    let lines = |k: usize| {
        let mut all: Vec<usize> = positive.iter().map(|c| c[k]).collect();
        all.sort_unstable();
        all.dedup();
        all.len()
    };
    if issues.is_empty() && (positive.len() < FEWEST || lines(0) < 2 || lines(1) < 2) {
        let message = format!(
            "{} half-breadths above 0 on {} stations and {} waterlines are too few: at least \
             {FEWEST} on 2 and 2",
            positive.len(),
            lines(0),
            lines(1)
        );
        issues.push(issue(&["input", "offsets", "y"], "too-few", message, None));
    }
}

fn options(request: &Request, issues: &mut Vec<Issue>) {
    let o = &request.options;
    let size = [request.stations.len(), request.waterlines.len()];
    if let Some(t) = o.tolerance
        && !(t.is_finite() && t > 0.0)
    {
        let message = format!("the tolerance {t} is not above 0");
        let hint = Some("leave it out to have it estimated, or lock cells that must not change");
        issues.push(issue(
            &["options", "tolerance"],
            "not-positive",
            message,
            hint,
        ));
    }
    for (k, (i, j, t)) in o.cell_tolerances.iter().enumerate() {
        let path = ["options", "cell_tolerances", &k.to_string()];
        if !(t.is_finite() && *t > 0.0) {
            let message = format!("the tolerance {t} of cell ({i}, {j}) is not above 0");
            issues.push(issue(&path, "not-positive", message, None));
        }
        if o.tolerance.is_none() {
            let message = "single tolerances need one for the other cells";
            issues.push(issue(&["options", "tolerance"], "missing", message, None));
        }
        cell_exists([*i, *j], size, (&path, &mut *issues));
    }
    for (k, cell) in o.locked.iter().enumerate() {
        let path = ["options", "locked", &k.to_string()];
        cell_exists(*cell, size, (&path, &mut *issues));
    }
    let families = [
        ("knuckle_stations", &o.knuckle_stations, size[0]),
        ("knuckle_waterlines", &o.knuckle_waterlines, size[1]),
    ];
    for (field, lines, count) in families {
        for (k, line) in lines.iter().enumerate() {
            if *line == 0 || line + 1 >= count {
                let message = format!("line {line} is not an inner one of {count}");
                let path = ["options", field, &k.to_string()];
                issues.push(issue(&path, "no-such-line", message, None));
            }
        }
    }
    for (k, y) in o.buttocks.iter().enumerate() {
        if !(y.is_finite() && *y > 0.0) {
            let message = format!("the buttock at {y} is not above 0");
            let path = ["options", "buttocks", &k.to_string()];
            issues.push(issue(&path, "not-positive", message, None));
        }
    }
    if !(o.light.iter().all(|x| x.is_finite()) && o.light.norm() > 0.0) {
        let message = "the direction of the light has no length";
        issues.push(issue(&["options", "light"], "not-positive", message, None));
    }
}

fn cell_exists([i, j]: [usize; 2], size: [usize; 2], (path, issues): (&[&str], &mut Vec<Issue>)) {
    if i >= size[0] || j >= size[1] {
        let message = format!(
            "cell ({i}, {j}) does not exist: the table has {} stations and {} waterlines",
            size[0], size[1]
        );
        issues.push(issue(path, "no-such-cell", message, None));
    }
}
