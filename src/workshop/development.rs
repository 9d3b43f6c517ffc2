//! The development of a ruled surface into the plane.
//!
//! With the ruling's unit direction ℓ and length L, write the boundaries'
//! derivatives as `Dᵢ′ = fᵢ ℓ + …` with the part across the ruling of size
//! `hᵢ = |ℓ × Dᵢ′|`. The flat pattern is the ruled strip with the same `fᵢ`,
//! `hᵢ` and `L`:
//!
//! ```text
//! e′ = τ e⊥,            τ = (h₂ − h₁)/L
//! d₁′ = f₁ e + h₁ e⊥,   d₂ = d₁ + L e
//! ```
//!
//! whence `d₂′ = f₂ e + h₂ e⊥`. Both boundaries therefore keep their arc length,
//! every ruling its length and its angles to both boundaries, whatever the
//! surface. In between, the speed across the ruling is `(1−v) h₁ + v h₂` in the
//! plane and `|(1−v) n₁ + v n₂|` on the surface, where the vectors `nᵢ` have the
//! lengths `hᵢ` and the angle θ, the twist, between them. Nothing else of the
//! metric differs, so the only strain is across the rulings: none at the ends
//! and, for equal ends, `cos(θ/2) − 1 ≈ −θ²/8` in the middle. For θ = 0 it is
//! the development in the strict sense, an isometry.
//!
//! The two rates are integrated as Legendre series on cells that are halved
//! until their tails vanish in rounding.

use crate::geometry::{RuledSurface, RulingJet};
use crate::numerics::legendre::{LegendreRule, LegendreSeries, ORDER};
use nalgebra::{Point2, Vector2, Vector3};
use std::f64::consts::FRAC_PI_2;

/// Tails below this are rounding: radians, or shares of the surface's size.
const TAIL: f64 = 1e-13;
/// Halvings of a knot span at the most; a cell that small adds nothing.
const MAX_HALVINGS: usize = 20;
/// Rulings shorter than this share of the size have no direction of their own.
const NO_LENGTH: f64 = 1e-13;

/// A ruled surface with its flat pattern, seen from the side of `Su × Sv`: it
/// runs to the right, its first ruling points up.
#[derive(Debug, Clone)]
pub(super) struct Development<'a> {
    surface: &'a RuledSurface,
    cells: Vec<Cell>,
}

/// A ruling in the plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct FlatLine {
    /// End on the first boundary.
    pub from: Point2<f64>,
    /// End on the second boundary.
    pub to: Point2<f64>,
    /// Unit direction, also where the ruling has no length.
    pub direction: Vector2<f64>,
}

#[derive(Debug, Clone)]
struct Cell {
    u: f64,
    half: f64,
    /// Angle of the ruling from the x axis.
    angle: LegendreSeries,
    /// The first boundary.
    place: [LegendreSeries; 2],
}

impl<'a> Development<'a> {
    /// Develops a surface; `None` where it has no finite size.
    pub fn new(surface: &'a RuledSurface) -> Option<Self> {
        let size = size(surface);
        if !(size.is_finite() && size > 0.0) {
            return None;
        }
        let mut builder = Builder {
            surface,
            size,
            rule: LegendreRule::new(),
            cells: Vec::new(),
            angle: FRAC_PI_2,
            place: Point2::origin(),
        };
        for span in breaks(surface).windows(2) {
            builder.add(span[0], span[1], MAX_HALVINGS);
        }
        let finite = builder.place.iter().all(|x| x.is_finite()) && builder.angle.is_finite();
        finite.then_some(Development {
            surface,
            cells: builder.cells,
        })
    }

    /// The surface.
    pub fn surface(&self) -> &'a RuledSurface {
        self.surface
    }

    /// The ruling at `u` in the plane.
    pub fn ruling(&self, u: f64) -> FlatLine {
        let index = self.cells.partition_point(|c| c.u <= u).max(1) - 1;
        let cell = &self.cells[index];
        let x = ((u - cell.u) / cell.half - 1.0).clamp(-1.0, 1.0);
        let angle = cell.angle.at(x);
        let direction = Vector2::new(angle.cos(), angle.sin());
        let from = Point2::new(cell.place[0].at(x), cell.place[1].at(x));
        let length = (self.surface.second().point(u) - self.surface.first().point(u)).norm();
        FlatLine {
            from,
            to: from + direction * length,
            direction,
        }
    }

    /// The point (u, v) in the plane.
    pub fn point(&self, u: f64, v: f64) -> Point2<f64> {
        let line = self.ruling(u);
        line.from + (line.to - line.from) * v
    }

    /// Values of `u` from end to end: every knot, and at least `fields` steps.
    pub fn fields(&self, fields: usize) -> Vec<f64> {
        let breaks = breaks(self.surface);
        let per_span = fields.div_ceil(breaks.len().max(2) - 1);
        let mut all: Vec<f64> = (breaks.windows(2))
            .flat_map(|w| {
                let step = (w[1] - w[0]) / per_span as f64;
                (0..per_span).map(move |i| w[0] + step * i as f64)
            })
            .collect();
        all.extend(breaks.last());
        all
    }
}

/// All distinct knots of both boundaries, the ends included.
pub(super) fn breaks(surface: &RuledSurface) -> Vec<f64> {
    let mut knots = surface.first().knot_vector().breakpoints();
    knots.extend(surface.second().knot_vector().breakpoints());
    knots.sort_by(f64::total_cmp);
    knots.dedup();
    knots
}

/// The diagonal of the box around the control points.
pub(super) fn size(surface: &RuledSurface) -> f64 {
    let boxes = surface.first().bounding_box();
    let boxes = boxes.union(&surface.second().bounding_box());
    boxes.diagonal()
}

struct Builder<'a> {
    surface: &'a RuledSurface,
    size: f64,
    rule: LegendreRule,
    cells: Vec<Cell>,
    /// Where the pattern has come to.
    angle: f64,
    place: Point2<f64>,
}

impl Builder<'_> {
    /// Adds the cells of a piece without inner knots.
    fn add(&mut self, from: f64, to: f64, halvings: usize) {
        let half = 0.5 * (to - from);
        let middle = from + half;
        let rates = self.rule.nodes().map(|x| {
            let jet = self.surface.ruling(from + half * (1.0 + x));
            self.rates(&jet).map(|r| r * half)
        });
        let turn = self.rule.series(&rates.map(|r| r[0]));
        let angle = turn.integral(self.angle);
        let mut steps = [[0.0; ORDER]; 2];
        for (i, x) in self.rule.nodes().iter().enumerate() {
            let (sin, cos) = angle.at(*x).sin_cos();
            let [_, along, across] = rates[i];
            steps[0][i] = along * cos + across * sin;
            steps[1][i] = along * sin - across * cos;
        }
        let steps = steps.map(|s| self.rule.series(&s));
        let rough = turn.tail() > TAIL || steps.iter().any(|s| s.tail() > TAIL * self.size);
        if rough && halvings > 0 && middle > from && middle < to {
            self.add(from, middle, halvings - 1);
            self.add(middle, to, halvings - 1);
            return;
        }
        let place = [0, 1].map(|k| steps[k].integral(self.place[k]));
        self.angle = angle.at(1.0);
        self.place = Point2::new(place[0].at(1.0), place[1].at(1.0));
        self.cells.push(Cell {
            u: from,
            half,
            angle,
            place,
        });
    }

    /// The rate of the ruling's angle, and of the first boundary along and
    /// across the ruling. The pattern runs to the right of the rulings, so the
    /// angle falls where the second boundary is the faster.
    fn rates(&self, jet: &RulingJet) -> [f64; 3] {
        let ruling = jet.direction();
        let length = ruling.norm();
        if length <= NO_LENGTH * self.size {
            // Where the boundaries meet, the ruling has the direction in which
            // they part.
            let apart = jet.second.d1 - jet.first.d1;
            let direction = apart.try_normalize(0.0).unwrap_or_else(Vector3::zeros);
            let across = direction.cross(&jet.first.d1).norm();
            return [0.0, jet.first.d1.dot(&direction), across];
        }
        let direction = ruling / length;
        let [h1, h2] = [jet.first.d1, jet.second.d1].map(|d| direction.cross(&d).norm());
        [(h1 - h2) / length, jet.first.d1.dot(&direction), h1]
    }
}
