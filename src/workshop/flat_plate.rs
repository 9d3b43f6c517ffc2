//! A plate as it is cut and rolled.

use super::development::{Development, FlatLine, breaks, size};
use super::hull_frame::{HullFrame, Side};
use super::neutral_surface;
use super::outline::{self, Edge, OutlineCorner, least_rectangle, polygon};
use super::overlap;
use super::refold::{self, Bend};
use super::stations;
use super::strain;
use crate::geometry::RuledSurface;
use nalgebra::{Point2, Vector2};

/// Steps of the net in which strains are measured, at least.
const STRAIN_STEPS: usize = 512;
/// Steps of the net in which stations are traced, at least.
const STATION_STEPS: usize = 256;
/// Station marks leave the station by no more than this share of the size.
const MARK_TOLERANCE: f64 = 1e-5;
/// A plate with less area than this share of its size squared is a line.
const NO_AREA: f64 = 1e-12;
/// A base line shorter than this share of the size gives no direction.
const NO_BASE: f64 = 1e-6;
/// How much finer than the table of rulings the pattern is rolled up: once as
/// the table has it, and twice to tell what is the table's coarseness.
const REFINEMENTS: [usize; 3] = [1, 2, 4];

/// A plate as it is cut and rolled. Lengths in the surface's unit.
#[derive(Debug, Clone, PartialEq)]
pub struct FlatPlate {
    /// The side that lies up.
    pub side: Side,
    /// The pattern: one piece, or several where it would lie on itself.
    pub pieces: Vec<FlatPiece>,
    /// What was measured.
    pub figures: FlatFigures,
}

/// A piece of a flat pattern. Its base line is the x axis; stations ascend to
/// the right where the boundaries do.
#[derive(Debug, Clone, PartialEq)]
pub struct FlatPiece {
    /// The rulings, in the order of the boundaries. Neighbouring pieces share
    /// the one where the pattern is cut.
    pub rulings: Vec<FlatRuling>,
    /// Closed: along the first boundary, the last ruling, back along the second
    /// boundary, the first ruling.
    pub outline: Vec<OutlineCorner>,
    /// A straight line to measure from, corner to corner.
    pub base_line: [Point2<f64>; 2],
    /// The boundary along which the base line runs: 0 or 1.
    pub base_boundary: usize,
    /// Stations.
    pub stations: Vec<StationMark>,
    /// Area.
    pub area: f64,
    /// Longer and shorter side of the least rectangle to cut it from.
    pub sheet: [f64; 2],
}

/// A ruling of a flat pattern.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlatRuling {
    /// Its index in the list of rulings.
    pub index: usize,
    /// End on the first boundary.
    pub from: Point2<f64>,
    /// End on the second boundary.
    pub to: Point2<f64>,
    /// Its length.
    pub length: f64,
    /// Angle from the base line, degrees, counter-clockwise.
    pub angle_deg: f64,
    /// Angle by which the plate bends from here to the next ruling, degrees,
    /// positive where it comes up; creases at this ruling included. 0 for the
    /// last.
    pub bend_deg: f64,
    /// Strain that the twist leaves in the middle of the ruling, θ²/8 for equal
    /// ends, percent.
    pub strain_percent: f64,
}

/// Where a station crosses a piece.
#[derive(Debug, Clone, PartialEq)]
pub struct StationMark {
    /// Its coordinate.
    pub at: f64,
    /// The line.
    pub line: Vec<Point2<f64>>,
}

/// The flat pattern against the plate. Strains in percent of the length on the
/// plate, without sign.
#[derive(Debug, Clone, PartialEq)]
pub struct FlatFigures {
    /// Area of the plate.
    pub surface_area: f64,
    /// Area of the pattern.
    pub flat_area: f64,
    /// Lengths of the two boundaries on the plate.
    pub boundary_lengths: [f64; 2],
    /// Largest along the boundaries, measured.
    pub boundary_strain_percent: f64,
    /// Largest along the rulings, measured.
    pub ruling_strain_percent: f64,
    /// Largest across the rulings, at the quarters, measured.
    pub middle_strain_percent: f64,
    /// Largest along the diagonals of small fields, measured.
    pub diagonal_strain_percent: f64,
    /// Largest of the rulings' `strain_percent`.
    pub twist_strain_percent: f64,
    /// Sum of all bends, degrees, without sign.
    pub bend_deg: f64,
    /// The pattern bent along its rulings alone: number of rulings, and the
    /// largest distance from the plate; the first as the rulings are listed.
    pub refolds: Vec<(usize, f64)>,
}

/// Flattens a plate. `rulings` are the parameters of the rulings to list,
/// increasing, from end to end. `None` where there is nothing of finite area to
/// flatten, or no two rulings to flatten it between.
#[must_use]
pub fn flatten(plate: &RuledSurface, rulings: &[f64], hull: &HullFrame) -> Option<FlatPlate> {
    if rulings.len() < 2 {
        return None;
    }
    let development = Development::new(plate)?;
    let fields = development.fields(STRAIN_STEPS);
    let surface_area = strain::surface_area(&development, &fields);
    if surface_area.is_nan() || surface_area <= NO_AREA * size(plate) * size(plate) {
        return None;
    }
    let (side, from_normal) = hull.side(plate, &breaks(plate));
    let job = Job {
        development: &development,
        rulings,
        lines: rulings.iter().map(|u| development.ruling(*u)).collect(),
        bends: rulings.iter().map(|u| Bend::at(plate, *u)).collect(),
        edges: [false, true].map(|second| Edge::new(&development, second, size(plate))),
        stations: marks(&development, hull),
        from_normal,
        size: size(plate),
    };
    let pieces: Vec<FlatPiece> = (overlap::pieces(&job.lines, job.size).into_iter())
        .map(|range| job.piece(range))
        .collect();
    let figures = job.figures(&pieces, &fields, surface_area);
    Some(FlatPlate {
        side,
        pieces,
        figures,
    })
}

/// Which face of a plate a surface is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Face {
    /// The one that lies up in the pattern: the inside, where the plate has one.
    Up,
    /// Neither: it is the middle.
    Middle,
    /// The other.
    Down,
}

/// Flattens a plate of a thickness by its middle, which bending neither
/// stretches nor shortens; the surface is one of its faces. `None` where
/// [`flatten`] has none, and for a surface with creases, at which the middle
/// gapes.
#[must_use]
pub fn flatten_thick(
    plate: &RuledSurface,
    rulings: &[f64],
    hull: &HullFrame,
    thickness: f64,
    face: Face,
) -> Option<FlatPlate> {
    let (_, from_normal) = hull.side(plate, &breaks(plate));
    let up = if from_normal { 0.5 } else { -0.5 };
    let shift = match face {
        Face::Up => -up * thickness,
        Face::Middle => 0.0,
        Face::Down => up * thickness,
    };
    flatten(&neutral_surface::offset(plate, shift)?, rulings, hull)
}

/// Stations as chains of parameters.
fn marks(development: &Development<'_>, hull: &HullFrame) -> Vec<(f64, Vec<Vector2<f64>>)> {
    let fields = development.fields(STATION_STEPS);
    let net = stations::Net::new(development.surface(), &fields, hull.axis());
    let stations = hull.stations().iter();
    stations
        .flat_map(|at| {
            let chains = net.crossing(*at);
            chains.into_iter().map(|chain| (*at, chain))
        })
        .collect()
}

struct Job<'a> {
    development: &'a Development<'a>,
    rulings: &'a [f64],
    lines: Vec<FlatLine>,
    bends: Vec<Bend>,
    edges: [Edge<'a>; 2],
    stations: Vec<(f64, Vec<Vector2<f64>>)>,
    /// Whether the plate is seen from the side of its normal.
    from_normal: bool,
    size: f64,
}

/// A way of laying a piece down.
struct Placement {
    origin: Point2<f64>,
    right: Vector2<f64>,
    up: Vector2<f64>,
    mirrored: bool,
}

impl Placement {
    fn point(&self, p: &Point2<f64>) -> Point2<f64> {
        let arm = p - self.origin;
        // Zero, not minus zero, for those who read it.
        Point2::new(arm.dot(&self.right) + 0.0, arm.dot(&self.up) + 0.0)
    }

    fn corner(&self, corner: &OutlineCorner) -> OutlineCorner {
        let turn = if self.mirrored { -1.0 } else { 1.0 };
        OutlineCorner {
            at: self.point(&corner.at),
            bulge: turn * corner.bulge,
        }
    }
}

impl Job<'_> {
    fn piece(&self, [first, last]: [usize; 2]) -> FlatPiece {
        let (placement, base_boundary) = self.placement([first, last]);
        let range = [self.rulings[first], self.rulings[last]];
        let outline: Vec<OutlineCorner> = (self.outline(range).iter())
            .map(|c| placement.corner(c))
            .collect();
        let rulings: Vec<FlatRuling> = (first..=last).map(|i| self.ruling(i, &placement)).collect();
        let base = |r: &FlatRuling| [r.from, r.to][base_boundary];
        let around = polygon(&outline);
        FlatPiece {
            base_line: [base(&rulings[0]), base(&rulings[rulings.len() - 1])],
            base_boundary,
            rulings,
            stations: self.stations_within(range, &placement),
            area: outline::area(&outline),
            sheet: least_rectangle(&around),
            outline,
        }
    }

    /// The lower boundary lies along the x axis, corner to corner; where its
    /// corners are one, the other boundary.
    fn placement(&self, [first, last]: [usize; 2]) -> (Placement, usize) {
        let ends = [&self.lines[first], &self.lines[last]];
        let corners = |k: usize| ends.map(|l| [l.from, l.to][k]);
        let lower = usize::from(!self.from_normal);
        let is_long = |k: &usize| {
            let [a, b] = corners(*k);
            (b - a).norm() > NO_BASE * self.size
        };
        let boundary = [lower, 1 - lower].into_iter().find(is_long);
        let [a, b] = corners(boundary.unwrap_or(lower));
        let right = (b - a).try_normalize(0.0).unwrap_or_else(Vector2::x);
        let up = Vector2::new(-right.y, right.x);
        let placement = Placement {
            origin: a,
            right,
            up: if self.from_normal { up } else { -up },
            mirrored: !self.from_normal,
        };
        (placement, boundary.unwrap_or(lower))
    }

    fn outline(&self, range: [f64; 2]) -> Vec<OutlineCorner> {
        let [first, second] = &self.edges;
        let mut corners = first.trace(range);
        let back = second.trace(range);
        // Backwards, an arc begins where it ended, and turns the other way.
        let bulges = back.iter().rev().skip(1).map(|c| -c.bulge);
        let bulges = bulges.chain([0.0]);
        corners.extend(
            back.iter()
                .rev()
                .zip(bulges)
                .map(|(c, bulge)| OutlineCorner { at: c.at, bulge }),
        );
        outline::without_repeats(corners, self.size)
    }

    fn ruling(&self, i: usize, placement: &Placement) -> FlatRuling {
        let line = &self.lines[i];
        let (from, to) = (placement.point(&line.from), placement.point(&line.to));
        let (x, y) = (
            line.direction.dot(&placement.right),
            line.direction.dot(&placement.up),
        );
        let bend = self.bends.get(i + 1).map_or(0.0, |next| {
            refold::crease(&self.bends[i]) + refold::turn(&self.bends[i], next)
        });
        // Towards the normal, the plate turns left-handed about its rulings.
        let up = if placement.mirrored { bend } else { -bend };
        let jet = self.development.surface().ruling(self.rulings[i]);
        FlatRuling {
            index: i,
            from,
            to,
            length: (to - from).norm(),
            angle_deg: y.atan2(x).to_degrees(),
            bend_deg: up.to_degrees(),
            strain_percent: 100.0 * strain::across(&jet),
        }
    }

    fn stations_within(&self, [from, to]: [f64; 2], placement: &Placement) -> Vec<StationMark> {
        let mut marks = Vec::new();
        for (at, chain) in &self.stations {
            let inside = |p: &Vector2<f64>| p.x >= from && p.x <= to;
            for run in chain.chunk_by(|a, b| inside(a) && inside(b)) {
                if run.len() < 2 {
                    continue;
                }
                let line: Vec<Point2<f64>> = (run.iter())
                    .map(|p| placement.point(&self.development.point(p.x, p.y)))
                    .collect();
                marks.push(StationMark {
                    at: *at,
                    line: stations::simplified(&line, MARK_TOLERANCE * self.size),
                });
            }
        }
        marks
    }

    fn figures(&self, pieces: &[FlatPiece], fields: &[f64], surface_area: f64) -> FlatFigures {
        let measured = strain::measure(self.development, fields, self.size);
        let surface = self.development.surface();
        let strains = fields.iter().map(|u| strain::across(&surface.ruling(*u)));
        let percent = |share: f64| 100.0 * share;
        let bends = pieces.iter().flat_map(|p| &p.rulings);
        FlatFigures {
            surface_area,
            flat_area: pieces.iter().map(|p| p.area).sum(),
            boundary_lengths: self.edges.each_ref().map(Edge::length),
            boundary_strain_percent: percent(measured.edges),
            ruling_strain_percent: percent(measured.rulings),
            middle_strain_percent: percent(measured.middle),
            diagonal_strain_percent: percent(measured.diagonals),
            twist_strain_percent: percent(strains.fold(0.0, f64::max)),
            bend_deg: bends.map(|r| r.bend_deg.abs()).sum(),
            refolds: REFINEMENTS.map(|n| self.refold(n)).to_vec(),
        }
    }

    /// The pattern rolled up by `finer` times as many rulings.
    fn refold(&self, finer: usize) -> (usize, f64) {
        let mut places: Vec<f64> = (self.rulings.windows(2))
            .flat_map(|w| {
                let step = (w[1] - w[0]) / finer as f64;
                (0..finer).map(move |i| w[0] + step * i as f64)
            })
            .collect();
        places.extend(self.rulings.last());
        let surface = self.development.surface();
        let lines: Vec<FlatLine> = (places.iter().map(|u| self.development.ruling(*u))).collect();
        let bends: Vec<Bend> = places.iter().map(|u| Bend::at(surface, *u)).collect();
        (places.len(), refold::deviation(&lines, &bends))
    }
}
