//! The best rulings between two curves as they are: from the best grid path
//! to a smooth path, then a smooth minimax of the twist.

use super::field::TwistField;
use super::model::{Model, PlateSpec, Weights};
use super::path::PathShape;
use super::profile::{Profile, even_shares, turning};
use super::search::{self, Bounds, GridPath};
use super::task::{EndSpeeds, Limits, Pins};
use crate::methods::FitError;
use crate::solver::levenberg_marquardt::{self as lm, Settings};
use crate::solver::{Control, NormalEquations, Report};

/// A plate's rulings as a smooth path, with the grid's certificate.
#[derive(Debug, Clone)]
pub(super) struct Rulings {
    pub(super) shape: PathShape,
    /// Unknowns of the path.
    pub(super) y: Vec<f64>,
    /// Largest |θ| at the samples, radians.
    pub(super) twist_max: f64,
    /// Iterations of all stages, and how the last one ended.
    pub(super) iterations: usize,
    pub(super) last: Option<Report>,
    /// Ends at which the two profiles meet in a point and run out together.
    pub(super) tips: [bool; 2],
    /// Which speeds were bounded in the end.
    pub(super) speeds: EndSpeeds,
}

/// Nodes per curve of the grid that finds the first path.
const SEARCH_NODES: usize = 129;
/// Nodes per curve of the grid that certifies the bound.
pub(super) const CERTIFICATE_NODES: usize = 241;
/// Knot spans of a path, and samples in each.
const SPANS: usize = 64;
const SAMPLES_PER_SPAN: usize = 5;

/// Weights of the smooth problem; see [`super::model`]. The ceiling counts so
/// much more than the mean that it acts as a bound to a few per cent; the
/// spacing only decides where the twist does not.
const CEILING_WEIGHT: f64 = 60.0;
const CLEARANCE_WEIGHT: f64 = 30.0;
const SPACING_WEIGHT: f64 = 2e-5;
/// The clearance is asked with this much to spare, since its bound is soft.
const CLEARANCE_MARGIN: f64 = 0.98;
/// Ceilings that are tried: the first just below the grid's bottleneck; below
/// a ceiling that was met the next; between one that was not and the twist
/// reached, the middle; until that gap is closed.
const CEILINGS: usize = 7;
const CEILING_START: f64 = 0.98;
const CEILING_STEP: f64 = 0.7;
const CEILING_GAP: f64 = 0.01;
/// Twist below which lowering the ceiling gains nothing, radians.
pub(super) const GOOD_ENOUGH: f64 = 1e-5;

pub(super) fn weights(limits: &Limits) -> Weights {
    Weights {
        ceiling: 0.0,
        ceiling_weight: 0.0,
        twist: 1.0,
        share: {
            let ratio = 1.0 + (limits.speed_ratio - 1.0) * CLEARANCE_MARGIN;
            0.5 * (ratio - 1.0) / (ratio + 1.0)
        },
        clearance: CLEARANCE_WEIGHT,
        spacing: SPACING_WEIGHT,
        end_limit: limits.end_limit,
        move_fairness: 0.0,
    }
}

/// At which ends two profiles meet in a point: there both run out together,
/// and no fan is wanted.
pub(super) fn tips([a, b]: [&Profile; 2]) -> [bool; 2] {
    [0.0, 1.0].map(|s| (a.at(s).point - b.at(s).point).norm() < MEETING)
}

/// Ends nearer than this (unit scale) are one point.
const MEETING: f64 = 1e-6;

/// Makes a path end exactly in its tips.
pub(super) fn end_at_tips(y: &mut [f64], tips: [bool; 2]) {
    let last = y.len() - 1;
    for (j, tip) in [0, last].into_iter().zip(tips) {
        if tip {
            y[j] = 0.0;
        }
    }
}

/// The twist field of two profiles with `nodes` per curve.
pub(super) fn field(profiles: [&Profile; 2], nodes: usize) -> TwistField {
    let [first, second] = profiles.map(|profile| {
        (0..nodes)
            .map(|i| profile.at(i as f64 / (nodes - 1) as f64))
            .collect::<Vec<_>>()
    });
    TwistField::new(&first, &second)
}

/// Search bounds for a grid of `nodes` per curve.
pub(super) fn bounds(
    tips: [bool; 2],
    limits: &Limits,
    pins: &Pins,
    speeds: EndSpeeds,
    nodes: usize,
) -> Bounds {
    let cells = (nodes - 1) as f64;
    let fan = (limits.end_limit * cells + 1e-9).floor() as usize;
    Bounds {
        fans: tips.map(|tip| if tip { 0 } else { fan }),
        speed_ratio: limits.speed_ratio,
        speeds,
        pins: pins.iter().map(|(s, t)| (s * cells, t * cells)).collect(),
    }
}

/// The best rulings of one plate. The regression curve is kept outside; where
/// that alone costs much twist against a bound on the speeds along the curves,
/// that bound is used instead. Where the curves meet in a tip both run out
/// together; a fan from the tip, which is a sliver between a curve and its
/// chord, is used only where that costs much twist.
///
/// # Errors
/// [`FitError::Stopped`], or [`FitError::Numerical`] when the pins leave no
/// monotone set of rulings.
pub(super) fn solve(
    profiles: &[Profile],
    pair: [usize; 2],
    limits: &Limits,
    pins: &Pins,
    control: &dyn Control,
) -> Result<Rulings, FitError> {
    let search = Search {
        field: field(pair.map(|k| &profiles[k]), SEARCH_NODES),
        profiles,
        pair,
        limits,
        pins,
    };
    let tips = tips(pair.map(|k| &profiles[k]));
    let held = search.with_tips(tips, control)?;
    let open = [false; 2];
    let reachable = |t| search.bottleneck(t, EndSpeeds::AlongTheCurves);
    if tips == open || !held.as_ref().is_none_or(|h| h.is_dear(reachable(open))) {
        return held.ok_or_else(no_rulings);
    }
    better(held, search.with_tips(open, control)?).ok_or_else(no_rulings)
}

/// The search for one plate's rulings.
struct Search<'a> {
    field: TwistField,
    profiles: &'a [Profile],
    pair: [usize; 2],
    limits: &'a Limits,
    pins: &'a Pins,
}

impl Search<'_> {
    fn bounds(&self, tips: [bool; 2], speeds: EndSpeeds) -> Bounds {
        bounds(tips, self.limits, self.pins, speeds, SEARCH_NODES)
    }

    fn bottleneck(&self, tips: [bool; 2], speeds: EndSpeeds) -> Option<f64> {
        search::bottleneck(&self.field, &self.bounds(tips, speeds), f64::INFINITY)
    }

    /// The better kind of bound on the speeds.
    fn with_tips(
        &self,
        tips: [bool; 2],
        control: &dyn Control,
    ) -> Result<Option<Rulings>, FitError> {
        let reachable = self.bottleneck(tips, EndSpeeds::AlongTheCurves);
        let attempt = |speeds| -> Result<Option<Rulings>, FitError> {
            let Some(mut path) = search::best_path(&self.field, &self.bounds(tips, speeds)) else {
                return Ok(None);
            };
            path.bottleneck = path.bottleneck.min(reachable.unwrap_or(f64::INFINITY));
            control.check()?;
            let ends = (self.pins, speeds, tips);
            smooth(
                self.profiles,
                self.pair,
                self.limits,
                ends,
                (&path, control),
            )
            .map(Some)
        };
        let clear = attempt(EndSpeeds::AcrossTheRuling)?;
        if clear
            .as_ref()
            .is_some_and(|found| !found.is_dear(reachable))
        {
            return Ok(clear);
        }
        Ok(better(clear, attempt(EndSpeeds::AlongTheCurves)?))
    }
}

/// The rulings with less twist; the first where they are equal.
fn better(a: Option<Rulings>, b: Option<Rulings>) -> Option<Rulings> {
    match (a, b) {
        (Some(a), Some(b)) => Some(if a.twist_max <= b.twist_max { a } else { b }),
        (a, b) => a.or(b),
    }
}

impl Rulings {
    /// Whether what is reachable otherwise has much less twist.
    fn is_dear(&self, reachable: Option<f64>) -> bool {
        reachable.is_some_and(|r| self.twist_max > (r * DEAR_FACTOR).max(r + DEAR_ANGLE))
    }
}

fn no_rulings() -> FitError {
    FitError::Numerical("no monotone set of rulings joins the two profiles".into())
}

/// A wish is dear when it costs more twist than this factor and this angle
/// (radians).
const DEAR_FACTOR: f64 = 1.08;
const DEAR_ANGLE: f64 = 0.0028;

/// A smooth minimax from a grid path.
fn smooth(
    profiles: &[Profile],
    pair: [usize; 2],
    limits: &Limits,
    (pins, speeds, tips): (&Pins, EndSpeeds, [bool; 2]),
    (path, control): (&GridPath, &dyn Control),
) -> Result<Rulings, FitError> {
    let lead = Lead::new(path);
    let sharp = PathShape::new(&lead.breaks(pair.map(|k| &profiles[k])), SAMPLES_PER_SPAN)
        .map_err(|e| FitError::Numerical(e.to_string()))?;
    let from_grid = sharp.unknowns_from(|w| lead.at(w).1);
    let shape = sharp.rounded(ROUNDING);
    let spec = PlateSpec {
        profiles: pair,
        shape,
        pins: pins.clone(),
        speeds,
        tips,
    };
    let mut model = Model::new(profiles, vec![spec], Vec::new(), &|_, s| s, weights(limits));
    let mut fit = Minimax {
        x: model.gather(&[from_grid], &[]),
        twist_max: 0.0,
        iterations: 0,
        last: None,
    };
    fit.run(&mut model, path.bottleneck, control)?;
    for _ in 0..EXCHANGES {
        let known = PEAK * model.twist_max(&fit.x, 0).max(model.weights.ceiling);
        let peaks = model.peaks_between(&fit.x, 0, known);
        if peaks.is_empty() {
            break;
        }
        model.plates[0].shape = model.plates[0].shape.with_more(&peaks);
        fit.attempt(&model, control, true)?;
    }
    let mut y = model.path_of(&fit.x, 0);
    end_at_tips(&mut y, tips);
    Ok(Rulings {
        y,
        tips,
        shape: model.plates.swap_remove(0).shape,
        twist_max: fit.twist_max,
        iterations: fit.iterations,
        last: fit.last,
        speeds,
    })
}

/// Rounds of adding samples where a plate is worst between them.
const EXCHANGES: usize = 3;
/// A peak of twist is above the largest sample by this factor.
const PEAK: f64 = 1.003;
/// Rounding of a path's corners, as arc-length fraction; see [`PathShape`].
const ROUNDING: f64 = 1e-3;

/// A grid path as a polyline of (p, q).
struct Lead(Vec<(f64, f64)>);

impl Lead {
    fn new(path: &GridPath) -> Self {
        let cells = (SEARCH_NODES - 1) as f64;
        Lead(
            path.nodes
                .iter()
                .map(|(i, j)| ((i + j) / cells, (j - i) / cells))
                .collect(),
        )
    }

    /// (p, q) at `w`, with p linear in w.
    fn at(&self, w: f64) -> (f64, f64) {
        let nodes = &self.0;
        let (p0, p1) = (nodes[0].0, nodes[nodes.len() - 1].0);
        let p = p0 + (p1 - p0) * w;
        let k = nodes
            .partition_point(|n| n.0 <= p)
            .clamp(1, nodes.len() - 1);
        let ((pa, qa), (pb, qb)) = (nodes[k - 1], nodes[k]);
        (p, qa + (qb - qa) * ((p - pa) / (pb - pa)).clamp(0.0, 1.0))
    }

    /// Knots for the smooth path: half of them even, half where the curves
    /// turn, so that a sharp forefoot is resolved as well as a flat run.
    fn breaks(&self, profiles: [&Profile; 2]) -> Vec<f64> {
        let tangents = |w: f64| {
            let (p, q) = self.at(w);
            [
                profiles[0].at(0.5 * (p - q)).d1,
                profiles[1].at(0.5 * (p + q)).d1,
            ]
        };
        even_shares(&turning(PROBES, tangents), SPANS)
    }
}

/// Steps along a path in which its turning is measured.
const PROBES: usize = 512;

/// The state of a minimax run.
struct Minimax {
    x: Vec<f64>,
    twist_max: f64,
    iterations: usize,
    last: Option<Report>,
}

impl Minimax {
    /// Mean square first, then ceilings by bisection between nothing and the
    /// twist reached.
    fn run(
        &mut self,
        model: &mut Model<'_>,
        bottleneck: f64,
        control: &dyn Control,
    ) -> Result<(), FitError> {
        self.twist_max = largest_twist(model, &self.x);
        model.weights.ceiling_weight = CEILING_WEIGHT;
        let (mut low, mut ceiling) = (0.0, CEILING_START * bottleneck);
        for round in 0..CEILINGS {
            model.weights.ceiling = ceiling;
            self.attempt(model, control, round == 0)?;
            let met = self.twist_max <= ceiling * (1.0 + CEILING_GAP);
            if self.twist_max <= GOOD_ENOUGH || (met && low > 0.0) {
                break;
            }
            if met {
                ceiling = CEILING_STEP * self.twist_max;
            } else {
                low = ceiling;
                ceiling = 0.5 * (low + self.twist_max);
                if self.twist_max <= (1.0 + CEILING_GAP) * low {
                    break;
                }
            }
        }
        Ok(())
    }

    /// One least-squares run from the best point; kept if it lowers the
    /// largest twist, or in any case when `always`.
    fn attempt(
        &mut self,
        model: &Model<'_>,
        control: &dyn Control,
        always: bool,
    ) -> Result<(), FitError> {
        let mut x = self.x.clone();
        let settings = Settings {
            iterations: 30,
            reduction: 1e-3,
            normal_equations: NormalEquations::Envelope,
            ..Settings::default()
        };
        let report = lm::minimize(model, &mut x, &settings, control)?;
        self.iterations += report.iterations;
        self.last = Some(report);
        let twist = largest_twist(model, &x);
        if always || twist < self.twist_max {
            self.x = x;
            self.twist_max = twist;
        }
        Ok(())
    }
}

/// Largest |θ| at any sample of any plate.
pub(super) fn largest_twist(model: &Model<'_>, x: &[f64]) -> f64 {
    (0..model.plates.len())
        .map(|p| model.twist_max(x, p))
        .fold(0.0, f64::max)
}
