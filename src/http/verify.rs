//! Measuring surfaces, whoever made them.

use super::Api;
use super::dto::curves::finite;
use super::dto::verify::{
    DirectionWord, EdgeName, EdgeWord, FlatFigures, JoinFigures, RuledFigures, SurfaceFigures,
    TargetFigures, Verification, VerifyRequest, usual_name,
};
use super::extract::{self, Asked, Owner, Parameters, is_json, media_type, whole_body, wrong_type};
use super::methods::rule_of;
use super::openapi::{RawBytes, Verifying};
use super::problem::{ApiError, Code, FieldError, Success};
use super::respond;
use super::schema_check::Rule;
use super::strict_json;
use crate::formats::step_in;
use crate::geometry::{Axis, BSplineSurface, BoundingBox, RuledSurface, Tolerance};
use crate::methods::diagnostics::joins::{self, Edge, Join, Side};
use crate::methods::diagnostics::{ruling, shape, strays};
use crate::workshop::{HullFrame, flatten};
use axum::extract::{FromRequest, Request};
use axum::response::Response;
use bytes::Bytes;
use std::sync::LazyLock;
use tokio::sync::Semaphore;
use utoipa::IntoParams;

/// The largest twist when nothing is said, degrees.
const USUAL_TWIST_DEG: f64 = 6.0;
/// The join tolerance when nothing is said, of the longest side of all.
const USUAL_TOLERANCE: f64 = 1e-4;
/// Rulings along which a pattern is bent.
const RULINGS: u32 = 120;

static RULE: LazyLock<Result<Rule, String>> = LazyLock::new(rule_of::<VerifyRequest>);

/// One at a time: fits come first.
static TURN: Semaphore = Semaphore::const_new(1);

/// Surfaces to be measured, as they came.
#[derive(Debug, Clone)]
pub(super) enum Given {
    /// As JSON.
    Json(Bytes),
    /// As a STEP file.
    Step(Bytes),
}

/// Media types under which STEP files travel.
const STEP: [&str; 4] = [
    "model/step",
    "application/step",
    "application/p21",
    "application/x-step",
];

impl FromRequest<Api> for Given {
    type Rejection = ApiError;

    async fn from_request(request: Request, api: &Api) -> Result<Self, ApiError> {
        let kind = media_type(request.headers());
        let wrap = if is_json(&kind) {
            Given::Json
        } else if STEP.contains(&kind.as_str()) {
            Given::Step
        } else {
            return Err(wrong_type(
                request.headers(),
                &["application/json", STEP[0]],
            ));
        };
        whole_body(request, api).await.map(wrap)
    }
}

/// What is asked, where a STEP file cannot say it.
#[derive(Debug, Clone, Copy, IntoParams)]
#[into_params(parameter_in = Query)]
pub(super) struct VerifyQuery {
    /// The largest twist that a ruled surface may have, degrees; goes before
    /// that of the body.
    #[param(nullable = false, exclusive_minimum = 0, maximum = 45)]
    max_twist_deg: Option<f64>,
    /// Edges no further apart are joined; a length, goes before that of the
    /// body.
    #[param(nullable = false, exclusive_minimum = 0)]
    join_tolerance: Option<f64>,
}

impl Parameters for VerifyQuery {
    const KNOWN: &'static [&'static str] = &["max_twist_deg", "join_tolerance"];

    fn read(given: &mut extract::Given) -> Self {
        VerifyQuery {
            max_twist_deg: given.positive("max_twist_deg", 45.0),
            join_tolerance: given.positive("join_tolerance", f64::MAX),
        }
    }
}

/// Measure surfaces
///
/// An independent diagnosis of surfaces from here or anywhere: curvature of
/// each; twist and what flattening does to those that are ruled; gaps and angles
/// where edges meet; distances of points from the edges. The `surfaces` of a
/// result can be sent as they are, or a STEP file, of which the B-spline
/// surfaces are measured whole.
#[utoipa::path(
    post, path = "/v1/verify", tag = "checks", operation_id = "verify",
    params(VerifyQuery),
    request_body(description = "The surfaces",
        content((VerifyRequest = "application/json"), (inline(RawBytes) = "model/step"))),
    responses(
        (status = 200, description = "What was measured", body = Verification),
        Verifying,
    ),
)]
pub(super) async fn verify(
    _owner: Owner,
    Asked(query): Asked<VerifyQuery>,
    given: Given,
) -> Result<Response, ApiError> {
    let turn = TURN.acquire().await.map_err(|e| ApiError::internal(&e))?;
    // The turn ends with the work, also where the asker has gone.
    let work = move || {
        let _turn = turn;
        let (mut request, warnings) = match given {
            Given::Json(body) => (read(&body)?, Vec::new()),
            Given::Step(body) => read_step(&body)?,
        };
        request.max_twist_deg = query.max_twist_deg.or(request.max_twist_deg);
        request.join_tolerance = query.join_tolerance.or(request.join_tolerance);
        let surfaces = request.surfaces().map_err(refused)?;
        Ok::<_, ApiError>(measure(&request, &surfaces, warnings))
    };
    match tokio::task::spawn_blocking(work).await {
        Ok(measured) => Ok(respond::json(Success::Here, &measured?)),
        Err(lost) => Err(ApiError::internal(&lost)),
    }
}

fn refused(faults: Vec<FieldError>) -> ApiError {
    ApiError::at(Code::InvalidSurfaces, faults)
}

/// The surfaces of a STEP file, and what is not measured of it.
fn read_step(body: &Bytes) -> Result<(VerifyRequest, Vec<String>), ApiError> {
    let step = step_in::read(body).map_err(|e| {
        let fault = FieldError::new(e.pointer(), "step", e.to_string());
        refused(vec![fault.hint(e.hint())])
    })?;
    let trimmed = step
        .surfaces
        .iter()
        .enumerate()
        .filter(|(_, s)| s.is_trimmed);
    let mut warnings: Vec<String> = trimmed
        .map(|(i, s)| {
            let name = s.name.clone().unwrap_or_else(|| usual_name(i));
            format!("{name}: its face is only a part of the surface, which is measured whole")
        })
        .collect();
    warnings.extend(step.left_out.iter().map(|(kind, count)| {
        format!("faces on {kind} are not measured, only those on B-spline surfaces: {count}")
    }));
    if step.is_assembly {
        warnings.push(
            "parts are placed by transformations, which are not followed: joins between parts \
             are not found"
                .to_owned(),
        );
    }
    let request = VerifyRequest::of_step(step).map_err(refused)?;
    Ok((request, warnings))
}

fn read(body: &Bytes) -> Result<VerifyRequest, ApiError> {
    let value = strict_json::parse(body).map_err(|e| ApiError::at(Code::Syntax, vec![e]))?;
    let rule = RULE.as_ref().map_err(|e| ApiError::internal(e))?;
    let faults = rule.faults(&value);
    if !faults.is_empty() {
        return Err(refused(faults));
    }
    // The schema has passed, so this would be a gap between schema and type.
    serde_json::from_value(value)
        .map_err(|e| refused(vec![FieldError::new("", "invalid", e.to_string())]))
}

fn measure(
    request: &VerifyRequest,
    surfaces: &[BSplineSurface],
    warnings: Vec<String>,
) -> Verification {
    let limit = request.max_twist_deg.unwrap_or(USUAL_TWIST_DEG);
    let figures: Vec<SurfaceFigures> = (surfaces.iter().enumerate())
        .map(|(i, s)| surface_figures(request.name(i), s, limit))
        .collect();
    let tolerance = tolerance(request, surfaces);
    let edges = tolerance.map_or_else(Vec::new, |t| joins::edges(surfaces, t));
    let found = tolerance.map_or_else(Vec::new, |t| joins::joins(&edges, t));
    let open = tolerance.map_or_else(Vec::new, |t| joins::open(&edges, &found, t));
    let mut verification = Verification {
        units: request.units,
        summary: Vec::new(),
        warnings,
        surfaces: figures,
        joins: found.iter().map(|j| join_figures(j, &edges)).collect(),
        open_edges: (open.into_iter())
            .map(|k| EdgeName {
                surface: edges[k].surface,
                edge: edges[k].side.into(),
            })
            .collect(),
        target: target_figures(request, &edges),
    };
    verification.summary = summary(&verification, limit);
    verification
}

/// `None` for surfaces without size, which have no edges.
fn tolerance(request: &VerifyRequest, surfaces: &[BSplineSurface]) -> Option<Tolerance> {
    let boxes = surfaces.iter().map(BSplineSurface::bounding_box);
    let size = boxes
        .reduce(|a, b: BoundingBox| a.union(&b))?
        .longest_side();
    match request.join_tolerance {
        Some(length) => Tolerance::absolute(length),
        None => Tolerance::relative(USUAL_TOLERANCE, size),
    }
}

fn surface_figures(name: String, surface: &BSplineSurface, limit: f64) -> SurfaceFigures {
    let s = shape::measure(surface);
    let ruled = ruling::as_ruled(surface);
    SurfaceFigures {
        name,
        area: s.area,
        gaussian_curvature_max: s.gaussian_max,
        gaussian_curvature_max_at: s.gaussian_max_at.into(),
        total_curvature: s.total_curvature,
        least_radius: finite(s.least_radius),
        singular_places: s.singular,
        ruled: ruled.map(|(axis, ruled)| ruled_figures(axis, &ruled, limit)),
    }
}

fn ruled_figures(axis: Axis, surface: &RuledSurface, limit: f64) -> RuledFigures {
    let r = ruling::measure(surface);
    RuledFigures {
        along: match axis {
            Axis::U => DirectionWord::U,
            Axis::V => DirectionWord::V,
        },
        within_limits: r.twist_max.to_degrees() <= limit && r.folds == 0,
        twist_max_deg: r.twist_max.to_degrees(),
        twist_max_parameter: r.twist_max_u,
        twist_max_at: r.twist_max_at.into(),
        twist_mean_deg: r.twist_mean.to_degrees(),
        regression_clearance: finite(r.clearance),
        folds: r.folds,
        min_bend_radius: finite(r.bend_radius),
        flat: flat_figures(surface),
    }
}

fn flat_figures(surface: &RuledSurface) -> Option<FlatFigures> {
    let [start, end] = surface.domain();
    let at = |i: u32| start + (end - start) * f64::from(i) / f64::from(RULINGS);
    let rulings: Vec<f64> = (0..RULINGS).map(at).chain([end]).collect();
    let frame = HullFrame::around(std::slice::from_ref(surface))?;
    let flat = flatten(surface, &rulings, &frame)?;
    Some(FlatFigures {
        area: flat.figures.flat_area,
        pieces: flat.pieces.len(),
        sheets: flat.pieces.iter().map(|p| p.sheet).collect(),
        strain: (&flat.figures).into(),
        refolds: flat.figures.refolds.iter().map(Into::into).collect(),
    })
}

fn join_figures(join: &Join, edges: &[Edge<'_>]) -> JoinFigures {
    JoinFigures {
        surfaces: join.edges.map(|e| edges[e].surface).into(),
        edges: join.edges.map(|e| edges[e].side.into()),
        length: join.length,
        gap: join.gap,
        knuckle_max_deg: join.knuckle_max.to_degrees(),
        knuckle_mean_deg: join.knuckle_mean.to_degrees(),
    }
}

fn target_figures(request: &VerifyRequest, edges: &[Edge<'_>]) -> Vec<TargetFigures> {
    let figures = |target: &super::dto::verify::VerifyTarget| {
        let strays = strays::measure(&target.points(), edges);
        TargetFigures {
            name: target.name.clone(),
            distance_max: strays.map(|s| s.max),
            distance_max_index: strays.map(|s| s.max_index),
            distance_mean: strays.map(|s| s.mean),
        }
    };
    request.target.iter().map(figures).collect()
}

/// What the figures come to.
fn summary(v: &Verification, limit: f64) -> Vec<String> {
    let units = v.units;
    let mut sentences: Vec<String> = v.surfaces.iter().map(|s| sentence(s, limit)).collect();
    if !v.joins.is_empty() {
        let most = |figure: fn(&JoinFigures) -> f64| v.joins.iter().map(figure).fold(0.0, f64::max);
        sentences.push(format!(
            "Joins: {}, the widest gap {:.3e} {units}, the sharpest knuckle {:.3}°; open edges: {}.",
            v.joins.len(),
            most(|j| j.gap),
            most(|j| j.knuckle_max_deg),
            v.open_edges.len()
        ));
    }
    let targets = v.target.iter().filter_map(|t| Some((t, t.distance_max?)));
    sentences.extend(targets.map(|(t, distance)| {
        format!(
            "{}: no point is further than {distance:.3e} {units} from an edge.",
            t.name
        )
    }));
    sentences
}

fn sentence(s: &SurfaceFigures, limit: f64) -> String {
    let Some(r) = &s.ruled else {
        return format!(
            "{}: not linear in u or v; its total curvature is {:.3e} (0 for a developable surface).",
            s.name, s.total_curvature
        );
    };
    let verdict = match (r.within_limits, r.folds) {
        (true, _) => "within",
        (false, 0) => "above",
        (false, _) => "it folds back on itself; ",
    };
    format!(
        "{}: twist at most {:.3}° (mean {:.3}°), {verdict} the limit of {limit}°.",
        s.name, r.twist_max_deg, r.twist_mean_deg
    )
}

impl From<Side> for EdgeWord {
    fn from(side: Side) -> Self {
        match side {
            Side::V0 => EdgeWord::V0,
            Side::V1 => EdgeWord::V1,
            Side::U0 => EdgeWord::U0,
            Side::U1 => EdgeWord::U1,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_published_schema_compiles_to_a_rule() {
        assert!(RULE.is_ok(), "{:?}", RULE.as_ref().err());
    }
}
