//! The verdict, and the sentences that say it.

use super::Smooth;
use super::diagnose::{At, Smoothed, TargetFigures};
use super::lines::REACHED;
use super::outcome::{Cyclides, Outcome};
use super::reasons::{Crossing, Moved};

/// Tangent planes of neighbours that differ by more than this, radians, do not
/// come of residuals: the patches are exact, but one lies upside down.
const FOLDED: f64 = 1.0;

/// Whether everything is as asked.
pub(super) fn within_limits(smooth: &Smooth, cyclides: Option<&Cyclides>) -> bool {
    let built = cyclides.is_none_or(|c| {
        c.figures.is_proved()
            && c.offsets.iter().all(|o| o.focal.is_empty())
            && c.supports.iter().all(|s| s.folded.is_empty())
    });
    is_net_of_curvature_lines(smooth) && smooth.umbilics.patches.is_empty() && built
}

fn is_net_of_curvature_lines(smooth: &Smooth) -> bool {
    let borders = &smooth.borders;
    borders.mean_torsion <= REACHED[0] && borders.max_torsion.value <= REACHED[1]
}

/// All sentences.
pub(super) fn summary(outcome: &Outcome) -> Vec<String> {
    let smooth = &outcome.smooth;
    let mut sentences = vec![
        verdict(outcome),
        borders(smooth),
        umbilics(smooth),
        shape(smooth),
    ];
    sentences.extend(smooth.smoothed.as_ref().map(smoothed));
    sentences.extend(smooth.target.as_ref().map(target));
    if let Some(cyclides) = &outcome.cyclides {
        sentences.push(spline(cyclides));
        sentences.extend(cyclides.offsets.iter().map(offset));
        sentences.extend(strips(cyclides));
        sentences.extend(supports(cyclides));
        sentences.push(bill(cyclides));
    }
    sentences
}

fn verdict(outcome: &Outcome) -> String {
    let [rows, columns] = outcome.net.layout().patch_counts();
    let what = format!("{rows} × {columns} patches");
    match &outcome.cyclides {
        Some(c) if outcome.within_limits => format!(
            "{what} of Dupin cyclides, exact to {:.0e}: every border is a circular arc and a line \
             of curvature.",
            c.figures.worst.worst().max(c.figures.closure)
        ),
        None if outcome.within_limits => {
            format!("{what} whose borders are lines of curvature.")
        }
        _ => format!(
            "{what}, but not all as asked: {}.",
            reasons(outcome).join("; ")
        ),
    }
}

fn reasons(outcome: &Outcome) -> Vec<String> {
    let smooth = &outcome.smooth;
    let mut reasons = Vec::new();
    if !is_net_of_curvature_lines(smooth) {
        reasons.push("the borders of the smooth surface are not lines of curvature".to_owned());
    }
    if !smooth.umbilics.patches.is_empty() {
        reasons.push("the net has umbilics".to_owned());
    }
    if let Some(cyclides) = &outcome.cyclides {
        let figures = &cyclides.figures;
        if figures.missing > 0 {
            reasons.push(format!("{} quads have no cyclide patch", figures.missing));
        } else if figures.worst.tangency > FOLDED {
            let [i, j] = figures.worst_patch;
            reasons.push(format!(
                "the net folds over itself at the patch in row {i}, column {j}"
            ));
        } else if !figures.is_proved() {
            reasons.push("the cyclide spline is not exact".to_owned());
        }
        if cyclides.offsets.iter().any(|o| !o.focal.is_empty()) {
            reasons.push("an offset reaches focal points".to_owned());
        }
        if cyclides.supports.iter().any(|s| !s.folded.is_empty()) {
            reasons.push("supports fold over themselves".to_owned());
        }
    }
    reasons
}

/// "row 3.5, column 2 (x 1.2, y 0, z 4)".
fn place(at: &At) -> String {
    let [row, column] = at.place.map(short);
    let [x, y, z] = [at.point.x, at.point.y, at.point.z].map(short);
    format!("row {row}, column {column} (x {x}, y {y}, z {z})")
}

/// A number with as many digits as are worth reading.
fn short(x: f64) -> String {
    let digits = format!("{x:.3}");
    digits
        .trim_end_matches('0')
        .trim_end_matches('.')
        .to_owned()
}

fn borders(smooth: &Smooth) -> String {
    let b = &smooth.borders;
    let goal = if is_net_of_curvature_lines(smooth) {
        ""
    } else {
        ", more than 1e-6 and 2e-5"
    };
    format!(
        "Smooth surface: |torsion · length| of the borders is {:.1e} rad on average and {:.1e} at \
         most, at {}{goal}.",
        b.mean_torsion,
        b.max_torsion.value,
        place(&b.max_torsion)
    )
}

fn umbilics(smooth: &Smooth) -> String {
    let u = &smooth.umbilics;
    let nearest = format!(
        "the two curvatures come nearest at {}, where they differ by {:.2} % of the mean \
         difference",
        place(&u.least_difference),
        100.0 * u.least_difference.value
    );
    match u.patches.first() {
        None if u.flat > 0 => format!(
            "No umbilic; {} patches are flat, in which every direction is one of curvature.",
            u.flat
        ),
        None => format!("No umbilic; {nearest}."),
        Some([i, j]) => format!(
            "Umbilics in {} patches, the first in row {i}, column {j}; {nearest}. There the \
             direction of the lines is not told by the surface.{}",
            u.patches.len(),
            smooth.crossing.as_ref().map_or_else(String::new, crossing)
        ),
    }
}

fn crossing(c: &Crossing) -> String {
    format!(
        " The start asks for them: at {} its lines along u are bent more, by {}, at {} those along \
         v, by {}, and somewhere between the two are equal.",
        place(&c.u),
        short(c.u.value),
        place(&c.v),
        short(c.v.value)
    )
}

fn shape(smooth: &Smooth) -> String {
    let s = &smooth.shape;
    format!(
        "Against the start vertices moved by {:.2} edges on average and {:.2} at most, at {}; \
         normals turned by {:.2}° and {:.2}°, at {}{}.",
        s.mean_move,
        s.max_move.value,
        place(&s.max_move),
        s.mean_turn_deg,
        s.max_turn_deg.value,
        place(&s.max_turn_deg),
        why(&smooth.moved)
    )
}

/// So many vertices are named in a sentence.
const NAMED: usize = 3;

/// Which vertices went furthest, and what about the start asked for it.
fn why(moved: &[Moved]) -> String {
    let one = |m: &Moved| {
        format!(
            "vertex {} (row {}, column {}) by {:.2} edges and {:.1}°: {}",
            m.vertex, m.place[0], m.place[1], m.moved, m.turned_deg, m.why
        )
    };
    let named: Vec<String> = moved.iter().take(NAMED).map(one).collect();
    if named.is_empty() {
        String::new()
    } else {
        format!("; furthest went {}", named.join("; "))
    }
}

fn smoothed(s: &Smoothed) -> String {
    format!(
        "The given points were smoothed before, by {:.2e} on average and {:.2e} at most, at {}: as \
         they were given the net had umbilics.",
        s.mean,
        s.max.value,
        place(&s.max)
    )
}

fn target(t: &TargetFigures) -> String {
    format!(
        "From the target vertices are {:.2e} away on average and {:.2e} at most, at {}.",
        t.mean_distance,
        t.max_distance.value,
        place(&t.max_distance)
    )
}

fn spline(cyclides: &Cyclides) -> String {
    let f = &cyclides.figures;
    let [row, column] = f.moved.at;
    format!(
        "Cyclide spline: circles {:.0e}, mirrors {:.0e}, tangent planes {:.0e} rad, closure {:.0e}; \
         its vertices are {:.4} edges on average and {:.4} at most from the smooth surface's (row \
         {row}, column {column}), its normals turned by {:.3}° and {:.3}°.",
        f.worst.circularity,
        f.worst.mirror,
        f.worst.tangency,
        f.closure,
        f.moved.mean / f.mean_edge,
        f.moved.max / f.mean_edge,
        f.turned.mean.to_degrees(),
        f.turned.max.to_degrees()
    )
}

fn offset(offset: &super::structure::Offset) -> String {
    match offset.focal.first() {
        None => format!("Offset {}: exact, the same frames.", short(offset.distance)),
        Some(([i, j], radius)) => format!(
            "Offset {}: {} patches reach a focal point and are left out, the first in row {i}, \
             column {j}, where the radius of curvature is {}.",
            short(offset.distance),
            offset.focal.len(),
            short(*radius)
        ),
    }
}

fn strips(cyclides: &Cyclides) -> Option<String> {
    let count = cyclides.strips.len();
    let sheets: usize = cyclides.strips.iter().map(|s| s.sheets.len()).sum();
    (count > 0).then(|| {
        let cut = cut_words(count, sheets);
        format!("{count} conical strips, {sheets} flat patterns{cut}.")
    })
}

fn cut_words(count: usize, sheets: usize) -> &'static str {
    if sheets > count {
        "; those that would overlap themselves are cut along a ruling"
    } else {
        ""
    }
}

fn supports(cyclides: &Cyclides) -> Option<String> {
    let all = &cyclides.supports;
    let sheets: usize = all.iter().map(|s| s.sheets.len()).sum();
    let folded: Vec<&str> = (all.iter())
        .filter(|s| !s.folded.is_empty())
        .map(|s| s.name.as_str())
        .collect();
    let cut = cut_words(all.len(), sheets);
    match (all.len(), folded.first()) {
        (0, _) => None,
        (count, None) => Some(format!("{count} supports, {sheets} flat patterns{cut}.")),
        (count, Some(first)) => Some(format!(
            "{count} supports, {sheets} flat patterns{cut}; {} of them fold over themselves, the \
             first on line {first}: they are higher than a radius of curvature.",
            folded.len()
        )),
    }
}

fn bill(cyclides: &Cyclides) -> String {
    let length: f64 = cyclides.members.iter().map(|m| m.length).sum();
    let radii = cyclides.members.iter().map(|m| m.radius);
    let least = radii.fold(f64::INFINITY, f64::min);
    format!(
        "{} arcs, {} long together, of radius {} and more.",
        cyclides.members.len(),
        short(length),
        short(least)
    )
}
