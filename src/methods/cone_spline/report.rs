//! From a fitted chain to the answer: everything is measured anew on what is
//! handed out, then said in sentences.

use super::chain::Chain;
use super::distances;
use super::outcome::{Distance, ErrorPoint, Floor, Kind, Outcome, Patch, Report};
use super::request::{Goal, Request};
use super::sheet;
use super::target::Target;
use crate::geometry::mesh::MeshIndex;
use crate::geometry::{BoundingBox, Face, Mesh};
use crate::methods::FitError;
use crate::methods::words::short;

/// What the fit hands over, in the unit of the request.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Fitted {
    /// The patches.
    pub chain: Chain,
    /// What other numbers of patches would give.
    pub error_curve: Vec<ErrorPoint>,
    /// The best developable surface found, which more patches can hardly beat.
    pub floor: Floor,
    /// `false`: the tolerance lies below what patches can reach.
    pub reachable: bool,
    /// How the fit came about.
    pub report: Report,
}

/// Measures a fitted chain against the strip and writes the answer.
///
/// # Errors
/// [`FitError::Numerical`] when a patch is no surface.
pub(super) fn outcome(
    request: &Request,
    target: &Target,
    fitted: Fitted,
) -> Result<Outcome, FitError> {
    let homes = distances::homes(&fitted.chain, &target.points);
    let fits = distances::fits(&homes, &target.weights, fitted.chain.len());
    let thickness = request.options.thickness;
    let mut sheets = sheet::sheets(&fitted.chain, target, &fits, thickness)
        .map_err(|e| FitError::Numerical(format!("a patch is no surface: {e}")))?;
    let triangles = index(target)?;
    for patch in &mut sheets.patches {
        patch.grid.distances = distances::carried(&triangles, &homes, &patch.grid.points);
    }
    let mut outcome = Outcome {
        within_limits: false,
        summary: Vec::new(),
        warnings: target.warnings.clone(),
        model_size: BoundingBox::of(&target.points).map_or(0.0, |b| b.longest_side()),
        patches: sheets.patches,
        rulings: sheets.rulings,
        joins: sheets.joins,
        pattern: sheets.pattern,
        error_curve: fitted.error_curve,
        to_surface: distances::to_surface(target, &homes),
        to_mesh: distances::to_mesh(&triangles, &sheets.samples),
        vertex_distances: homes.iter().map(|h| h.distance).collect(),
        floor: fitted.floor,
        reachable: fitted.reachable,
        report: fitted.report,
    };
    outcome.within_limits = broken(request, &outcome).is_empty();
    outcome.summary = summary(request, &outcome);
    Ok(outcome)
}

/// The strip's triangles for queries.
fn index(target: &Target) -> Result<MeshIndex, FitError> {
    let faces = target
        .triangles
        .iter()
        .filter_map(|t| Face::of(t))
        .collect();
    Mesh::new(target.points.clone(), faces)
        .ok()
        .and_then(|mesh| MeshIndex::new(&mesh))
        .ok_or_else(|| FitError::Numerical("the strip has no triangles".to_owned()))
}

/// What is not kept of what was asked.
fn broken(request: &Request, outcome: &Outcome) -> Vec<String> {
    let mut broken = Vec::new();
    if let Goal::Tolerance(tolerance) = request.options.goal
        && outcome.to_surface.max > tolerance
    {
        broken.push(format!(
            "a vertex is {} away, the tolerance is {}",
            short(outcome.to_surface.max),
            short(tolerance)
        ));
    }
    if let Some(least) = request.options.min_bend_radius
        && let Some(tightest) = tightest(&outcome.patches)
        && tightest.min_bend_radius < least
    {
        broken.push(format!(
            "patch {} bends to a radius of {}, the rolls do {}",
            tightest.name,
            short(tightest.min_bend_radius),
            short(least)
        ));
    }
    broken
}

fn tightest(patches: &[Patch]) -> Option<&Patch> {
    (patches.iter()).min_by(|a, b| a.min_bend_radius.total_cmp(&b.min_bend_radius))
}

fn summary(request: &Request, outcome: &Outcome) -> Vec<String> {
    let mut sentences = vec![verdict(request, outcome), reach(outcome)];
    if !outcome.reachable {
        sentences.push(unreachable(outcome));
    } else {
        sentences.push(format!(
            "The best developable surface that was found strays by {} (mean {}): with more patches \
             hardly less can be had.",
            short(outcome.floor.max),
            short(outcome.floor.mean)
        ));
    }
    sentences.extend(bending(outcome));
    sentences.extend(joins(outcome));
    sentences.extend(pattern(outcome));
    let outliers = outcome.report.outliers.len();
    if outliers > 0 {
        sentences.push(format!(
            "{outliers} vertices are so far off that they had no hold on the shape; see \
             method_specific.outliers."
        ));
    }
    sentences
}

fn verdict(request: &Request, outcome: &Outcome) -> String {
    let what = format!("{} for {}", kinds(&outcome.patches), request.name);
    let broken = broken(request, outcome);
    match request.options.goal {
        _ if !broken.is_empty() => format!("{what}, but not as asked: {}.", broken.join("; ")),
        Goal::Tolerance(tolerance) => format!(
            "{what}, within {} of every vertex; {} were allowed.",
            short(outcome.to_surface.max),
            short(tolerance)
        ),
        Goal::Pieces(_) | Goal::Noise => format!(
            "{what}, within {} of every vertex.",
            short(outcome.to_surface.max)
        ),
    }
}

/// "4 patches (3 cones, 1 plane)".
fn kinds(patches: &[Patch]) -> String {
    let count = |kind: Kind| patches.iter().filter(|p| p.kind == kind).count();
    let words: Vec<String> = [Kind::Cone, Kind::Cylinder, Kind::Plane]
        .into_iter()
        .filter(|k| count(*k) > 0)
        .map(|k| plural(count(k), k.as_str()))
        .collect();
    format!("{} ({})", plural(patches.len(), "patch"), words.join(", "))
}

fn plural(count: usize, word: &str) -> String {
    let ending = match (count, word.ends_with("ch")) {
        (1, _) => "",
        (_, true) => "es",
        (_, false) => "s",
    };
    format!("{count} {word}{ending}")
}

fn reach(outcome: &Outcome) -> String {
    let there = &outcome.to_surface;
    let vertex = there
        .vertex
        .map_or_else(String::new, |v| format!(" at vertex {v}"));
    format!(
        "Vertices stray by {} on average and by {} at most{vertex}, near {}; the patches stray \
         from the triangles by {} at most, near {}.",
        short(there.mean),
        short(there.max),
        place(there),
        short(outcome.to_mesh.max),
        place(&outcome.to_mesh)
    )
}

fn unreachable(outcome: &Outcome) -> String {
    format!(
        "No cones, cylinders and planes in one strip were found that keep the tolerance: the best \
         developable surface found strays by {} at most and {} on average. Allow more, or divide \
         the strip lengthwise.",
        short(outcome.floor.max),
        short(outcome.floor.mean)
    )
}

fn bending(outcome: &Outcome) -> Option<String> {
    let tightest = tightest(&outcome.patches).filter(|p| p.min_bend_radius.is_finite())?;
    let strain = tightest
        .bend_strain_percent
        .map_or_else(String::new, |strain| {
            format!(", which strains its surface by {strain:.2} %")
        });
    Some(format!(
        "Patch {} is bent hardest, to a radius of {}{strain}.",
        tightest.name,
        short(tightest.min_bend_radius)
    ))
}

fn joins(outcome: &Outcome) -> Option<String> {
    let largest =
        |f: fn(&super::outcome::Join) -> f64| outcome.joins.iter().map(f).fold(0.0, f64::max);
    (!outcome.joins.is_empty()).then(|| {
        format!(
            "Neighbours share a ruling and the tangent plane along it: gap {:.0e}, angle {:.0e}°.",
            largest(|j| j.gap),
            largest(|j| j.angle_deg)
        )
    })
}

fn pattern(outcome: &Outcome) -> Option<String> {
    let cuts: Vec<String> = (outcome.pattern.iter().skip(1))
        .map(|piece| piece.patches[0].to_string())
        .collect();
    (!cuts.is_empty()).then(|| {
        format!(
            "In one piece the flat pattern would lie on itself; it is cut at ruling {}.",
            cuts.join(" and ")
        )
    })
}

fn place(distance: &Distance) -> String {
    let [x, y, z] = distance.at.coords.into();
    format!("({}, {}, {})", short(x), short(y), short(z))
}
