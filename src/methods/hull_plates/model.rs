//! The least-squares problem behind every plate: unknowns, residuals and
//! their analytic Jacobian.
//!
//! Unknowns are, for every plate, the coefficients of its path q(w) (see
//! [`super::path`]) and, where the boundaries are free, for every profile the
//! displacement coefficients (see [`super::movable`]); a chine that bounds two
//! plates is moved once, for both. Residuals at every sampled ruling:
//!
//! ```text
//! ω·θ                       twist in the mean
//! f·q″                      fair spacing of the rulings
//! W·(±θ − τ)   one-sided    ceiling of the twist: a minimax while τ shrinks
//! C·(±m − M)   one-sided    m = φ − ½, clearance of the regression curve
//! ```
//!
//! where φ = h₁/(h₁ + h₂) is the first end's share of the crossing speeds, so
//! that |m| ≤ M = ½ (ρ − 1)/(ρ + 1) keeps their ratio within 1/ρ..ρ; unlike
//! the ratio, φ stays smooth when a trial step runs backwards for a moment.
//! And, where boundaries are free, μⱼ·|dⱼ| (least moves) and κ·(dⱼ₋₁ − 2dⱼ +
//! dⱼ₊₁) (fair moves) for every displacement coefficient.

use super::field::SHORTEST_RULING;
use super::movable::{Displacement, Movable, MovedJet};
use super::path::{PathPoint, PathShape};
use super::profile::Profile;
use super::task::{EndSpeeds, Pins};
use super::twist::{RulingGradient, Twist, log_speed_ratio, twist};
use crate::solver::{Blocks, LeastSquares};
use nalgebra::Vector3;

/// How much each kind of residual counts. Angles in radians, lengths in unit
/// scale; weights of samples are divided by their number.
#[derive(Debug, Clone)]
pub(super) struct Weights {
    /// τ and W.
    pub(super) ceiling: f64,
    pub(super) ceiling_weight: f64,
    /// ω.
    pub(super) twist: f64,
    /// Largest |φ − ½| and C.
    pub(super) share: f64,
    pub(super) clearance: f64,
    /// f.
    pub(super) spacing: f64,
    /// Largest |q| at the ends.
    pub(super) end_limit: f64,
    /// κ.
    pub(super) move_fairness: f64,
}

/// A plate as the model is given it.
#[derive(Debug, Clone)]
pub(super) struct PlateSpec {
    /// Indices of its profiles.
    pub(super) profiles: [usize; 2],
    pub(super) shape: PathShape,
    /// Rulings that the path must pass: (s, t).
    pub(super) pins: Pins,
    pub(super) speeds: EndSpeeds,
    /// Ends at which the profiles meet: no fans there.
    pub(super) tips: [bool; 2],
}

/// One plate of the model.
#[derive(Debug)]
pub(super) struct PlateModel {
    /// Indices of its profiles.
    pub(super) profiles: [usize; 2],
    pub(super) shape: PathShape,
    /// Rulings that the path must pass: (s, t).
    pub(super) pins: Pins,
    pub(super) speeds: EndSpeeds,
    tips: [bool; 2],
    /// By how much the bound on |φ − ½| is tightened; see [`Model::tighten`].
    tightening: f64,
    /// Positions of the path's unknowns among all unknowns.
    unknowns: Vec<usize>,
}

/// All plates that are solved together.
#[derive(Debug)]
pub(super) struct Model<'a> {
    pub(super) profiles: &'a [Profile],
    pub(super) plates: Vec<PlateModel>,
    /// Freedom of each profile; empty where boundaries are exact.
    pub(super) movables: Vec<Movable>,
    pub(super) weights: Weights,
    /// μⱼ of each profile's displacement coefficients.
    pub(super) move_weights: Vec<Vec<f64>>,
    /// Positions of each profile's displacement unknowns among all unknowns.
    moved: Vec<Vec<usize>>,
    dimension: usize,
}

/// Fans are held below this share of their limit, and how strongly.
const END_MARGIN: f64 = 0.9995;
const END_WEIGHT: f64 = 100.0;
/// How strongly a pinned ruling is held, against angles of about 1e-2.
const PIN_WEIGHT: f64 = 1e3;

impl<'a> Model<'a> {
    /// Lays the unknowns out along the hull, so that the normal matrix has a
    /// narrow envelope: paths and moves by their place, the paths' ends (which
    /// every sample of a plate feels) last. `place(profile, s)` tells where
    /// along the paths a point of a profile is used.
    pub(super) fn new(
        profiles: &'a [Profile],
        plates: Vec<PlateSpec>,
        movables: Vec<Movable>,
        place: &dyn Fn(usize, f64) -> f64,
        weights: Weights,
    ) -> Self {
        let mut places: Vec<(f64, usize, usize)> = Vec::new();
        for (p, PlateSpec { shape, .. }) in plates.iter().enumerate() {
            let greville = shape.greville();
            let last = greville.len() - 1;
            places.extend(greville.iter().enumerate().map(|(j, w)| {
                let end = j == 0 || j == last;
                (if end { f64::INFINITY } else { *w }, p, j)
            }));
        }
        for (k, movable) in movables.iter().enumerate() {
            let stations = movable.stations().iter().enumerate();
            places.extend(stations.map(|(j, s)| (place(k, *s), plates.len() + k, j)));
        }
        // Ties keep their order: the layout is the same on every machine.
        places.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut positions: Vec<Vec<usize>> = vec![Vec::new(); plates.len() + movables.len()];
        for (p, PlateSpec { shape, .. }) in plates.iter().enumerate() {
            positions[p] = vec![0; shape.unknowns()];
        }
        for (k, movable) in movables.iter().enumerate() {
            positions[plates.len() + k] = vec![0; movable.unknowns()];
        }
        for (position, (_, owner, j)) in places.iter().enumerate() {
            positions[*owner][*j] = position;
        }
        let moved = positions.split_off(plates.len());
        let plates = plates
            .into_iter()
            .zip(positions)
            .map(
                |(
                    PlateSpec {
                        profiles,
                        shape,
                        pins,
                        speeds,
                        tips,
                    },
                    unknowns,
                )| PlateModel {
                    profiles,
                    shape,
                    pins,
                    speeds,
                    tips,
                    tightening: 0.0,
                    unknowns,
                },
            )
            .collect();
        let move_weights = movables.iter().map(|m| vec![0.0; m.count()]).collect();
        Model {
            profiles,
            plates,
            movables,
            weights,
            move_weights,
            moved,
            dimension: places.len(),
        }
    }

    /// Unknowns from the paths' and the displacements' own.
    pub(super) fn gather(&self, paths: &[Vec<f64>], moves: &[Vec<f64>]) -> Vec<f64> {
        let mut x = vec![0.0; self.dimension];
        let owners = self.plates.iter().map(|p| &p.unknowns).zip(paths);
        for (positions, values) in owners.chain(self.moved.iter().zip(moves)) {
            for (position, value) in positions.iter().zip(values) {
                x[*position] = *value;
            }
        }
        x
    }

    /// A plate's path unknowns out of all.
    pub(super) fn path_of(&self, x: &[f64], plate: usize) -> Vec<f64> {
        self.plates[plate].unknowns.iter().map(|i| x[*i]).collect()
    }

    /// A profile's displacement unknowns out of all.
    pub(super) fn moves_of(&self, x: &[f64], profile: usize) -> Vec<f64> {
        self.moved[profile].iter().map(|i| x[*i]).collect()
    }

    /// Displacement coefficients of every profile.
    pub(super) fn displacements(&self, x: &[f64]) -> Vec<Displacement> {
        (0..self.movables.len())
            .map(|k| self.movables[k].displacement(&self.moves_of(x, k)))
            .collect()
    }

    fn end_jet(&self, profile: usize, d: &[Displacement], s: f64) -> MovedJet {
        match self.movables.get(profile) {
            Some(movable) => movable.at(&self.profiles[profile], &d[profile], s),
            None => MovedJet::fixed(self.profiles[profile].at(s)),
        }
    }

    fn ruling(&self, plate: usize, path: PathPoint, d: &[Displacement]) -> Ruling {
        let plate = &self.plates[plate];
        let first = self.end_jet(plate.profiles[0], d, path.s);
        let second = self.end_jet(plate.profiles[1], d, path.t);
        Ruling {
            path,
            first,
            second,
        }
    }
}

/// A sampled ruling.
struct Ruling {
    path: PathPoint,
    first: MovedJet,
    second: MovedJet,
}

/// A figure of a ruling with what it depends on.
struct Figure {
    value: f64,
    gradient: RulingGradient,
    /// Direct dependence on ds/dw and dt/dw.
    speeds: [f64; 2],
}

/// Twist and share of the crossing speeds.
const FIGURES: usize = 2;

impl Ruling {
    /// θ and φ − ½; `None` for a ruling without length.
    fn figures(&self, bound: EndSpeeds) -> Option<[Figure; FIGURES]> {
        let l = self.second.jet.point - self.first.jet.point;
        if l.norm() < SHORTEST_RULING {
            return None;
        }
        let (t1, t2) = (&self.first.jet.d1, &self.second.jet.d1);
        let Twist { angle, gradient } = twist(&l, t1, t2);
        let turn = Figure {
            value: angle,
            gradient,
            speeds: [0.0; 2],
        };
        let ratio = match bound {
            EndSpeeds::AcrossTheRuling => log_speed_ratio(&l, t1, t2),
            EndSpeeds::AlongTheCurves => (0.0, RulingGradient::zero()),
        };
        Some([turn, self.share(&ratio)])
    }

    /// φ − ½, φ = h₁ds / (h₁ds + h₂dt), from ln(h₁/h₂).
    fn share(&self, (log_ratio, gradient): &(f64, RulingGradient)) -> Figure {
        let (ratio, ds, dt) = (log_ratio.exp(), self.path.ds, self.path.dt);
        let sum = ratio * ds + dt;
        let share = ratio * ds / sum;
        Figure {
            value: share - 0.5,
            gradient: gradient.scaled(share * (1.0 - share)),
            speeds: [ratio * dt / (sum * sum), -ratio * ds / (sum * sum)],
        }
    }
}

impl LeastSquares for Model<'_> {
    fn dimension(&self) -> usize {
        self.dimension
    }

    fn evaluate(&self, x: &[f64], blocks: &mut Blocks) {
        let displacements = self.displacements(x);
        for p in 0..self.plates.len() {
            let y = self.path_of(x, p);
            for i in 0..self.plates[p].shape.stations().len() {
                let path = self.plates[p].shape.at_sample(&y, i);
                let ruling = self.ruling(p, path, &displacements);
                self.push_ruling((p, i), &y, (&ruling, &displacements), blocks);
            }
            self.push_spacing(p, &y, blocks);
            self.push_ends(p, &y, blocks);
            self.push_pins(p, &y, blocks);
        }
        for (k, d) in displacements.iter().enumerate() {
            self.push_moves(k, d, blocks);
        }
    }
}

impl Model<'_> {
    fn push_ruling(
        &self,
        (plate, sample): (usize, usize),
        y: &[f64],
        (ruling, displacements): (&Ruling, &[Displacement]),
        blocks: &mut Blocks,
    ) {
        let Some(figures) = ruling.figures(self.plates[plate].speeds) else {
            blocks.push_mixed(&[0.0; ROWS], ORDINARY, &[], &[]);
            return;
        };
        let w = &self.weights;
        let scale = (self.plates[plate].shape.stations().len() as f64)
            .sqrt()
            .recip();
        let (ceiling, bound) = (w.ceiling, w.share - self.plates[plate].tightening);
        let [turn, share] = [figures[0].value, figures[1].value];
        let share = if share.abs() > BACKWARDS {
            f64::NAN
        } else {
            share
        };
        let [mean, top, narrow] = [
            scale * w.twist,
            scale * w.ceiling_weight,
            scale * w.clearance,
        ];
        let values = [
            mean * turn,
            top * (turn - ceiling),
            top * (-turn - ceiling),
            narrow * (share - bound),
            narrow * (-share - bound),
        ];
        let factors = [(0, mean), (0, top), (0, -top), (1, narrow), (1, -narrow)];
        let (mut columns, mut entries) = (Columns::default(), Vec::new());
        if blocks.wants_jacobian() {
            self.path_columns(plate, sample, y, (ruling, &figures), &mut columns);
            self.move_columns(plate, (ruling, &figures), displacements, &mut columns);
            for (figure, factor) in factors {
                entries.extend(
                    columns.entries[..columns.count]
                        .iter()
                        .map(|e| factor * e[figure]),
                );
            }
        }
        blocks.push_mixed(
            &values,
            ORDINARY,
            &columns.unknowns[..columns.count],
            &entries,
        );
    }

    /// f·q″ at every sample: linear in the path's own coefficients.
    fn push_spacing(&self, plate: usize, y: &[f64], blocks: &mut Blocks) {
        let plate = &self.plates[plate];
        let count = plate.shape.stations().len();
        let weight = self.weights.spacing / (count as f64).sqrt();
        for sample in 0..count {
            let bend = plate.shape.at_sample(y, sample).bend;
            let basis = plate.shape.basis(sample);
            let acting = basis.first..basis.first + basis.values().len();
            let columns: Vec<usize> = acting.map(|j| plate.unknowns[j]).collect();
            let jacobian: Vec<f64> = basis.derivative(2).iter().map(|b| weight * b).collect();
            blocks.push(&[weight * bend], &columns, &jacobian);
        }
    }

    fn path_columns(
        &self,
        plate: usize,
        sample: usize,
        y: &[f64],
        (ruling, figures): (&Ruling, &[Figure; FIGURES]),
        columns: &mut Columns,
    ) {
        let plate = &self.plates[plate];
        let (basis, effect) = (plate.shape.basis(sample), plate.shape.end_effect(y, sample));
        let last = y.len() - 1;
        let (first, second) = (&ruling.first.jet, &ruling.second.jet);
        let by_s = figures
            .each_ref()
            .map(|f| f.gradient.by_first.dot(&first.d2) - f.gradient.by_ruling.dot(&first.d1));
        let by_t = figures
            .each_ref()
            .map(|f| f.gradient.by_second.dot(&second.d2) + f.gradient.by_ruling.dot(&second.d1));
        for k in 0..basis.values().len() {
            let j = basis.first + k;
            let [b0, b1] = [0, 1].map(|order| 0.5 * basis.derivative(order)[k]);
            columns.put(plate.unknowns[j], |f| {
                (by_t[f] - by_s[f]) * b0 + (figures[f].speeds[1] - figures[f].speeds[0]) * b1
            });
        }
        for (end, j) in [0, last].into_iter().enumerate() {
            let (progress, speed) = (0.5 * effect.progress[end], 0.5 * effect.speed[end]);
            columns.put(plate.unknowns[j], |f| {
                (by_s[f] + by_t[f]) * progress
                    + (figures[f].speeds[0] + figures[f].speeds[1]) * speed
            });
        }
    }

    fn move_columns(
        &self,
        plate: usize,
        (ruling, figures): (&Ruling, &[Figure; FIGURES]),
        displacements: &[Displacement],
        columns: &mut Columns,
    ) {
        let ends = [(&ruling.first, -1.0), (&ruling.second, 1.0)];
        for (side, (end, sign)) in ends.into_iter().enumerate() {
            let profile = self.plates[plate].profiles[side];
            let Some(displacement) = displacements.get(profile) else {
                continue;
            };
            for k in 0..end.values.len() {
                let (value, slope) = (sign * end.values[k], end.slopes[k]);
                let by_move = figures.each_ref().map(|f| {
                    let by_tangent = if side == 0 {
                        &f.gradient.by_first
                    } else {
                        &f.gradient.by_second
                    };
                    f.gradient.by_ruling * value + by_tangent * slope
                });
                for (unknown, direction) in displacement.derivatives(end.first + k) {
                    columns.put(self.moved[profile][*unknown], |f| by_move[f].dot(direction));
                }
            }
        }
    }

    /// ±q − limit at both ends, one-sided: the largest fans.
    fn push_ends(&self, plate: usize, y: &[f64], blocks: &mut Blocks) {
        let plate = &self.plates[plate];
        let weight = END_WEIGHT;
        for (j, tip) in [0, y.len() - 1].into_iter().zip(plate.tips) {
            let limit = if tip { 0.0 } else { self.weights.end_limit };
            let held = END_MARGIN * limit;
            let values = if y[j].abs() > limit && !tip {
                // Outside the domain: the bound is hard, the penalty before
                // it only keeps steps from running into it.
                [f64::NAN; 2]
            } else {
                [weight * (y[j] - held), weight * (-y[j] - held)]
            };
            blocks.push_mixed(&values, 0, &[plate.unknowns[j]], &[weight, -weight]);
        }
    }

    fn push_pins(&self, plate: usize, y: &[f64], blocks: &mut Blocks) {
        let plate = &self.plates[plate];
        for &(s, t) in &plate.pins {
            let (miss, gradient) = plate.shape.miss(y, s, t);
            let columns: Vec<usize> = gradient.iter().map(|(j, _)| plate.unknowns[*j]).collect();
            let jacobian: Vec<f64> = gradient.iter().map(|(_, g)| PIN_WEIGHT * g).collect();
            blocks.push(&[PIN_WEIGHT * miss], &columns, &jacobian);
        }
    }

    /// Least and fair moves of one profile.
    fn push_moves(&self, k: usize, displacement: &Displacement, blocks: &mut Blocks) {
        let d = &displacement.coefficients;
        let mut push = |terms: &[(usize, f64)]| {
            let sum: Vector3<f64> = terms.iter().map(|(j, c)| d[*j] * *c).sum();
            let (mut columns, mut entries) = (Vec::new(), [Vec::new(), Vec::new(), Vec::new()]);
            for (j, c) in terms {
                for (unknown, direction) in displacement.derivatives(*j) {
                    columns.push(self.moved[k][*unknown]);
                    entries
                        .iter_mut()
                        .enumerate()
                        .for_each(|(i, e)| e.push(c * direction[i]));
                }
            }
            if !columns.is_empty() {
                blocks.push(sum.as_slice(), &columns, &entries.concat());
            }
        };
        for (j, weight) in self.move_weights[k].iter().enumerate() {
            push(&[(j, *weight)]);
        }
        let fair = self.weights.move_fairness;
        for j in 1..d.len() - 1 {
            push(&[(j - 1, fair), (j, -2.0 * fair), (j + 1, fair)]);
        }
    }
}

/// Beyond this |φ − ½| one end of the rulings runs backwards by more than a
/// trial step may, between which a penalty can mediate: outside the domain.
const BACKWARDS: f64 = 0.55;
/// Residuals at a ruling, the first of them ordinary, the others one-sided.
const ROWS: usize = 5;
const ORDINARY: usize = 1;
/// Unknowns that a ruling can depend on: four coefficients and two ends of its
/// path, four coefficients with two directions on each of its profiles.
const WIDEST: usize = 22;

/// Derivatives of the figures by the unknowns that a ruling depends on.
struct Columns {
    count: usize,
    unknowns: [usize; WIDEST],
    entries: [[f64; FIGURES]; WIDEST],
}

impl Default for Columns {
    fn default() -> Self {
        Columns {
            count: 0,
            unknowns: [0; WIDEST],
            entries: [[0.0; FIGURES]; WIDEST],
        }
    }
}

impl Columns {
    fn put(&mut self, unknown: usize, entry: impl Fn(usize) -> f64) {
        self.unknowns[self.count] = unknown;
        self.entries[self.count] = std::array::from_fn(entry);
        self.count += 1;
    }
}

mod look;

#[cfg(test)]
mod tests;
