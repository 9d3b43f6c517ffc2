//! The result of `fairing` on the wire.

use super::super::curves::{NamedCurve, Point, Surface, finite};
use super::super::index::IndexPair;
use super::super::job::{FairingJob, FairingMethod};
use super::super::result::{Contents, result_of_a_method};
use super::table::OffsetsResult;
use super::{FairingDiagnostics, FairingOptions, OffsetTable};
use crate::methods::fairing::{Outcome, Request, curve, offsets, surface};
use nalgebra::Point3;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

result_of_a_method!(
    FairingResult,
    FairingJob,
    FairingMethod,
    FairingSpecific,
    FairingDiagnostics,
    about = "The result of a `fairing` job. Lengths in `units`.",
    verdict = "Whether every point keeps its tolerance.",
    summary = "Sentences, the verdict first.",
    surfaces = "The fair surface; none for a curve. Control points indexed `[u][v]`.",
    curves = "The fair curve; for a table of offsets its stations, waterlines and\nbuttocks; none for a surface.",
    diagnostics = "All figures, measured on the delivered shape.",
);

/// What was faired.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum FairedKind {
    /// A curve.
    Curve,
    /// A surface.
    Surface,
    /// A table of offsets.
    Offsets,
}

/// What only `fairing` gives. What goes with one kind is null for the others.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct FairingSpecific {
    /// What was faired.
    pub kind: FairedKind,
    /// The options as they were understood, defaults filled in.
    pub options: FairingOptions,
    /// Coordinates of the points: 2 or 3.
    pub dimension: usize,
    /// Whether the curve is closed.
    pub closed: Option<bool>,
    /// Order of the points along the curve, where it was to be found.
    pub order: Option<Vec<usize>>,
    /// How many points were measured.
    pub points: usize,
    /// Every point and where it is now, by index; of more than 20,000 points
    /// those 20,000 that moved most. Empty for a table, which tells by cell.
    pub moves: Vec<MoveResult>,
    /// Points that look mis-typed or mis-measured, the surest first.
    pub slips: Vec<SlipResult>,
    /// What other tolerances, or other stiffnesses, would give.
    pub trade_off: Vec<TradeOffResult>,
    /// The curvature along the curve.
    pub comb: Option<Vec<ToothResult>>,
    /// Where a surface has data, in (u, v).
    pub outline: Option<OutlineResult>,
    /// Data for an isophote plot of a surface.
    pub isophotes: Option<IsophotesResult>,
    /// The faired table of offsets.
    pub table: Option<OffsetsResult>,
}

/// A point and what became of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct MoveResult {
    /// Index of the point; of a grid row · columns + column.
    pub index: usize,
    /// As given.
    pub given: Point,
    /// Where it is now.
    pub now: Point,
    /// Parameter of that place on the curve, or u and v.
    pub at: Vec<f64>,
    /// Distance between the two; of a surface positive where the given point
    /// lies on the side of u × v.
    pub distance: f64,
    /// Its tolerance.
    pub tolerance: Option<f64>,
    /// What this point holds the shape back, 0 where it has room: by how much
    /// ∫ κ′² ds of a curve would fall per unit of more tolerance; its share
    /// of all the pull on a surface, percent.
    pub holds_back: f64,
}

/// A point that does not fit its neighbours.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct SlipResult {
    /// Index of the point.
    pub index: usize,
    /// Row and column of a grid; station and waterline of a table.
    pub cell: Option<IndexPair>,
    /// As given.
    pub given: Point,
    /// Where the fair shape that was fitted without it has it.
    pub expected: Point,
    /// Distance between the two.
    pub off: f64,
    /// The same in standard deviations of the noise.
    pub deviations: f64,
    /// Probability that noise alone makes the worst of all points this bad.
    pub chance: f64,
    /// Whether the shape disregards it (`robust`).
    pub disregarded: bool,
}

/// What another tolerance or stiffness would give.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct TradeOffResult {
    /// The tolerance (curves).
    pub tolerance: Option<f64>,
    /// The stiffness, in unit scale (surfaces).
    pub stiffness: Option<f64>,
    /// Whether a shape within the tolerance was found.
    pub reached: bool,
    /// Largest move.
    pub move_max: f64,
    /// ∫ κ′² ds of a curve, the energy of a surface.
    pub energy: f64,
}

/// One tooth of the curvature comb.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ToothResult {
    /// Arc length from the start.
    pub s: f64,
    /// Parameter.
    pub u: f64,
    /// The point.
    pub point: Point,
    /// Unit normal: to the left in the plane, towards the centre of curvature
    /// in space.
    pub normal: Point,
    /// Curvature, 1/length; signed in the plane.
    pub curvature: f64,
    /// Torsion, 1/length.
    pub torsion: f64,
}

/// The region of a surface that has data, in (u, v).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct OutlineResult {
    /// Closed polyline, anticlockwise, first point not repeated.
    #[schema(value_type = Vec<Vec<f64>>)]
    pub outer: Vec<[f64; 2]>,
    /// Closed polylines, clockwise.
    #[schema(value_type = Vec<Vec<Vec<f64>>>)]
    pub holes: Vec<Vec<[f64; 2]>>,
}

/// n·l on a grid of parameters.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct IsophotesResult {
    /// Unit vector to the light.
    pub light: Point,
    /// Parameters of the samples in u.
    pub u: Vec<f64>,
    /// Parameters of the samples in v.
    pub v: Vec<f64>,
    /// n·l, v fastest; null outside the outline.
    pub values: Vec<Option<f64>>,
}

/// Most moves that a result lists.
const MOST_MOVES: usize = 20_000;

impl FairingResult {
    /// The result of a job out of its request and the method's outcome.
    #[must_use]
    pub fn new(
        job: &FairingJob,
        request: &Request,
        outcome: &Outcome,
        input_sha256: String,
    ) -> Self {
        let name = job.input.name.as_deref().unwrap_or("fair");
        let (within_limits, summary, warnings) = words(outcome);
        let (surfaces, curves, method_specific) = match (request, outcome) {
            (_, Outcome::Curve(o)) => of_curve(o, name, job),
            (Request::Surface(r), Outcome::Surface(o)) => of_surface(o, name, job, r),
            (_, Outcome::Surface(o)) => of_surface_alone(o, name, job),
            (_, Outcome::Offsets(o)) => of_offsets(o, name, job),
        };
        let contents = Contents {
            within_limits,
            summary,
            warnings,
            surfaces,
            curves,
            method_specific,
            diagnostics: outcome.into(),
        };
        Self::of(job, input_sha256, contents)
    }
}

/// Whether all tolerances are kept, the summary, the warnings.
pub(in crate::http) fn words(outcome: &Outcome) -> (bool, Vec<String>, Vec<String>) {
    match outcome {
        Outcome::Curve(o) => (o.within_limits, o.summary.clone(), o.warnings.clone()),
        Outcome::Surface(o) => (o.within_tolerance, o.summary.clone(), o.warnings.clone()),
        Outcome::Offsets(o) => {
            // The surface's own warnings are among the notes.
            (
                o.surface.within_tolerance,
                o.summary.clone(),
                o.notes.clone(),
            )
        }
    }
}

type Parts = (Vec<Surface>, Vec<NamedCurve>, FairingSpecific);

fn specific(kind: FairedKind, job: &FairingJob) -> FairingSpecific {
    FairingSpecific {
        kind,
        options: job.options.clone(),
        dimension: 3,
        closed: None,
        order: None,
        points: 0,
        moves: Vec::new(),
        slips: Vec::new(),
        trade_off: Vec::new(),
        comb: None,
        outline: None,
        isophotes: None,
        table: None,
    }
}

fn of_curve(o: &curve::Outcome, name: &str, job: &FairingJob) -> Parts {
    let points = job.input.points.as_deref().unwrap_or_default();
    let specific = FairingSpecific {
        dimension: points.first().map_or(3, |p| p.dimension()),
        closed: Some(o.closed),
        order: (!job.input.ordered).then(|| o.order.clone()),
        points: o.moves.len(),
        moves: listed(o.moves.iter().map(Into::into).collect()),
        slips: o.slips.iter().map(Into::into).collect(),
        trade_off: o.trade_off.iter().map(Into::into).collect(),
        comb: Some(o.comb.iter().map(Into::into).collect()),
        ..specific(FairedKind::Curve, job)
    };
    (
        Vec::new(),
        vec![NamedCurve::new(name, "fair_curve", &o.curve)],
        specific,
    )
}

fn of_surface_alone(o: &surface::Outcome, name: &str, job: &FairingJob) -> Parts {
    let specific = FairingSpecific {
        points: o.moves.len(),
        trade_off: o.trade_off.iter().map(Into::into).collect(),
        outline: Some(OutlineResult {
            outer: o.outline.outer.clone(),
            holes: o.outline.holes.clone(),
        }),
        isophotes: Some((&o.isophotes).into()),
        ..specific(FairedKind::Surface, job)
    };
    (
        vec![Surface::new(name, "fair_surface", &o.surface)],
        Vec::new(),
        specific,
    )
}

fn of_surface(
    o: &surface::Outcome,
    name: &str,
    job: &FairingJob,
    request: &surface::Request,
) -> Parts {
    use surface::request::{Points, Tolerance};
    let given = |i: usize| -> Option<Point3<f64>> {
        match &request.points {
            Points::Scattered(points) => points.get(i).copied(),
            Points::Grid(rows) => {
                let columns = rows.first().map_or(1, Vec::len).max(1);
                *rows.get(i / columns)?.get(i % columns)?
            }
        }
    };
    let tolerance = |i: usize| match &request.options.tolerance {
        None => None,
        Some(Tolerance::Same(t)) => Some(*t),
        Some(Tolerance::Each(each)) => each.get(i).copied(),
    };
    let mut pulls = std::collections::HashMap::new();
    pulls.extend(o.active.iter().map(|a| (a.index, a.pull_percent.abs())));
    let moves = o.moves.iter().map(|m| MoveResult {
        index: m.index,
        given: given(m.index).unwrap_or(m.now).into(),
        now: m.now.into(),
        at: m.at.to_vec(),
        distance: m.distance,
        tolerance: tolerance(m.index),
        holds_back: pulls.get(&m.index).copied().unwrap_or(0.0),
    });
    let moves = listed(moves.collect());
    let (surfaces, curves, specific) = of_surface_alone(o, name, job);
    let robust = job.options.robust;
    let slips = o.slips.iter().map(|s| SlipResult {
        index: s.index,
        cell: s.cell.map(IndexPair::from),
        given: s.given.into(),
        expected: s.expected.into(),
        off: s.off,
        deviations: s.sigmas,
        chance: 1.0 - s.confidence,
        disregarded: robust,
    });
    let specific = FairingSpecific {
        moves,
        slips: slips.collect(),
        ..specific
    };
    (surfaces, curves, specific)
}

fn of_offsets(o: &offsets::Outcome, name: &str, job: &FairingJob) -> Parts {
    let (surfaces, _, found) = of_surface_alone(&o.surface, name, job);
    let given = job.input.offsets.as_ref();
    let (stations, waterlines) = given.map_or((&[][..], &[][..]), |t| {
        (t.stations.as_slice(), t.waterlines.as_slice())
    });
    let robust = job.options.robust;
    let slips = o.slips.iter().map(|s| {
        let place = |y: f64| Point([stations[s.station], y, waterlines[s.waterline]]);
        SlipResult {
            index: s.station * waterlines.len() + s.waterline,
            cell: Some([s.station, s.waterline].into()),
            given: place(s.given),
            expected: place(s.expected),
            off: (s.given - s.expected).abs(),
            deviations: s.sigmas,
            chance: 1.0 - s.confidence,
            disregarded: robust,
        }
    });
    let mut curves = Vec::new();
    let names = |names: fn(&OffsetTable) -> &Option<Vec<String>>| {
        given.and_then(|t| names(t).as_deref()).unwrap_or_default()
    };
    let families = [
        (
            "x",
            "station",
            stations,
            &o.stations,
            names(|t| &t.station_names),
        ),
        (
            "z",
            "waterline",
            waterlines,
            &o.waterlines,
            names(|t| &t.waterline_names),
        ),
    ];
    for (axis, role, places, pieces, names) in families {
        for (i, (place, pieces)) in places.iter().zip(pieces).enumerate() {
            let name = match names.get(i) {
                Some(name) => format!("{name} ({axis} = {place})"),
                None => format!("{axis} = {place}"),
            };
            curves.extend(pieces.iter().map(|c| NamedCurve::new(&name, role, c)));
        }
    }
    for buttock in &o.buttocks {
        let named = |c| NamedCurve::new(&format!("y = {}", buttock.y), "buttock", c);
        curves.extend(buttock.curves.iter().map(named));
    }
    let specific = FairingSpecific {
        kind: FairedKind::Offsets,
        slips: slips.collect(),
        table: given.map(|table| OffsetsResult::new(o, table, job.input.table_layout)),
        ..found
    };
    (surfaces, curves, specific)
}

/// The moves that are listed: the largest where there are too many.
fn listed(mut moves: Vec<MoveResult>) -> Vec<MoveResult> {
    if moves.len() > MOST_MOVES {
        moves.sort_by(|a, b| b.distance.abs().total_cmp(&a.distance.abs()));
        moves.truncate(MOST_MOVES);
        moves.sort_by_key(|m| m.index);
    }
    moves
}

impl From<&curve::outcome::Move> for MoveResult {
    fn from(m: &curve::outcome::Move) -> Self {
        MoveResult {
            index: m.index,
            given: m.given.into(),
            now: m.now.into(),
            at: vec![m.parameter],
            distance: m.distance,
            tolerance: m.tolerance,
            holds_back: m.holds_back,
        }
    }
}

impl From<&curve::outcome::Slip> for SlipResult {
    fn from(s: &curve::outcome::Slip) -> Self {
        SlipResult {
            index: s.index,
            cell: None,
            given: s.given.into(),
            expected: s.expected.into(),
            off: s.off,
            deviations: s.deviations,
            chance: s.chance,
            disregarded: s.disregarded,
        }
    }
}

impl From<&curve::outcome::TradeOff> for TradeOffResult {
    fn from(t: &curve::outcome::TradeOff) -> Self {
        TradeOffResult {
            tolerance: Some(t.tolerance),
            stiffness: None,
            reached: t.reached,
            move_max: t.max_move,
            energy: t.curvature_variation,
        }
    }
}

impl From<&surface::outcome::TradeOff> for TradeOffResult {
    fn from(t: &surface::outcome::TradeOff) -> Self {
        TradeOffResult {
            tolerance: None,
            stiffness: finite(t.stiffness),
            reached: true,
            move_max: t.move_max,
            energy: t.energy,
        }
    }
}

impl From<&curve::outcome::CombTooth> for ToothResult {
    fn from(t: &curve::outcome::CombTooth) -> Self {
        ToothResult {
            s: t.s,
            u: t.u,
            point: t.point.into(),
            normal: Point(t.normal.into()),
            curvature: t.curvature,
            torsion: t.torsion,
        }
    }
}

impl From<&surface::outcome::Isophotes> for IsophotesResult {
    fn from(i: &surface::outcome::Isophotes) -> Self {
        IsophotesResult {
            light: Point(i.light.into()),
            u: i.u.clone(),
            v: i.v.clone(),
            values: i.values.clone(),
        }
    }
}
