//! The mesh of a net of patches: each patch a part, coloured by how far its
//! normals are from those of the smooth surface, or by the turn of its lines.

use super::build::Heading;
use super::{MeshDrawing, Quantity, QuantityKind};
use crate::formats::cyclides::{Lattice, NetDrawing, PatchSheet, Place};
use crate::formats::length_unit::LengthUnit;
use crate::geometry::{Axis, BSplineSurface, SurfaceJet};
use nalgebra::{Matrix2, Point3, Vector2, Vector3};

/// What a net is coloured by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Reference<'a> {
    /// The angle between its normal and that of this smooth surface, patch for
    /// patch the same, at the foot of the perpendicular.
    Smooth(&'a BSplineSurface),
    /// The larger geodesic torsion of its two parameter lines times their
    /// length on the patch: by how much a normal turns about the line, 0 for a
    /// line of curvature.
    Itself,
}

/// Most steps to the foot of a perpendicular; from near by three are enough.
const STEPS: usize = 12;

impl MeshDrawing {
    /// A net, whose lengths are in `units`.
    #[must_use]
    pub fn of_net(net: &NetDrawing, units: LengthUnit, reference: Reference<'_>) -> Self {
        let heading = Heading {
            title: &net.title,
            units,
            verdict: &net.verdict,
        };
        let name = match reference {
            Reference::Smooth(_) => "normal_deviation",
            Reference::Itself => "torsion",
        };
        let mut drawing = heading.begin(Some(Quantity {
            name: name.to_owned(),
            kind: QuantityKind::Degrees,
            limit: None,
        }));
        for sheet in &net.sheets {
            drawing.add_sheet(sheet, reference);
        }
        drawing
    }

    fn add_sheet(&mut self, sheet: &PatchSheet, reference: Reference<'_>) {
        let lattice = Lattice::of(sheet);
        let first = self.vertices.len();
        let values: Vec<f64> = match reference {
            Reference::Smooth(smooth) => {
                let finder = FootFinder::new(smooth);
                (lattice.samples.iter())
                    .map(|s| finder.normal_deviation(&s.place, &s.point, &s.normal))
                    .collect()
            }
            Reference::Itself => (lattice.samples.iter())
                .map(|s| torsion(&s.jet, s.extent).to_degrees())
                .collect(),
        };
        self.vertices
            .extend(lattice.samples.iter().map(|s| s.point));
        self.normals
            .extend(lattice.samples.iter().map(|s| s.normal));
        let columns = sheet.counts[1].max(1);
        for (patch, triangles) in &lattice.patches {
            let [row, column] = [patch / columns, patch % columns];
            let name = format!("{}{row},{column}", sheet.prefix);
            let triangles: Vec<_> = triangles.iter().map(|t| t.map(|i| i + first)).collect();
            self.add_part(&name, &triangles, |vertex| {
                values.get(vertex - first).copied()
            });
        }
        let borders = lattice.borders().into_iter();
        let points = borders.map(|line| line.iter().map(|i| lattice.samples[*i].point).collect());
        self.add_lines(&format!("borders of {}", sheet.name), None, points);
    }
}

/// max(|τ_u| |S_u| Δu, |τ_v| |S_v| Δv) with τ_u = (EM − FL) / (W E) and τ_v =
/// (FN − GM) / (W G), W = |S_u × S_v| (do Carmo, 3-2, exercise 19).
fn torsion(jet: &SurfaceJet, extent: [f64; 2]) -> f64 {
    let across = jet.du.cross(&jet.dv);
    let area = across.norm();
    let normal = across / area;
    let [l, m, n] = [jet.duu, jet.duv, jet.dvv].map(|d| d.dot(&normal));
    let [e, f, g] = [
        jet.du.dot(&jet.du),
        jet.du.dot(&jet.dv),
        jet.dv.dot(&jet.dv),
    ];
    let along_u = (e * m - f * l) / (area * e) * e.sqrt() * extent[0];
    let along_v = (f * n - g * m) / (area * g) * g.sqrt() * extent[1];
    // A pole has no lines that could turn.
    let turn = along_u.abs().max(along_v.abs());
    if turn.is_finite() { turn } else { 0.0 }
}

/// Finds feet on a smooth surface from the place in the net.
struct FootFinder<'a> {
    surface: &'a BSplineSurface,
    knots: [Vec<f64>; 2],
}

impl<'a> FootFinder<'a> {
    fn new(surface: &'a BSplineSurface) -> Self {
        FootFinder {
            surface,
            knots: [Axis::U, Axis::V].map(|axis| surface.knot_vector(axis).breakpoints()),
        }
    }

    /// The angle between the normal and that of the surface at the foot of the
    /// perpendicular, degrees.
    fn normal_deviation(&self, place: &Place, point: &Point3<f64>, normal: &Vector3<f64>) -> f64 {
        let foot = self.foot(self.start(place), point);
        let Some(smooth) = self.surface.normal(foot.x, foot.y) else {
            return 0.0;
        };
        let angle = normal.cross(&smooth).norm().atan2(normal.dot(&smooth));
        angle.to_degrees()
    }

    /// The same share of the same patch.
    fn start(&self, place: &Place) -> Vector2<f64> {
        let along = |k: usize| {
            let knots = &self.knots[k];
            let last = knots.len().saturating_sub(2);
            let from = place.patch[k].min(last);
            knots[from] + place.share[k] * (knots[(from + 1).min(knots.len() - 1)] - knots[from])
        };
        Vector2::new(along(0), along(1))
    }

    /// Newton's method for the nearest place, within the domain; Gauss and
    /// Newton's where the surface is too bent for it.
    fn foot(&self, start: Vector2<f64>, point: &Point3<f64>) -> Vector2<f64> {
        let domains = [Axis::U, Axis::V].map(|axis| self.surface.domain(axis));
        let mut at = start;
        for _ in 0..STEPS {
            let jet = self.surface.derivatives(at.x, at.y);
            let apart = jet.point - point;
            let slope = Vector2::new(apart.dot(&jet.du), apart.dot(&jet.dv));
            let mixed = jet.du.dot(&jet.dv);
            let flat = Matrix2::new(jet.du.dot(&jet.du), mixed, mixed, jet.dv.dot(&jet.dv));
            let twist = apart.dot(&jet.duv);
            let bend = Matrix2::new(apart.dot(&jet.duu), twist, twist, apart.dot(&jet.dvv));
            let step = [flat + bend, flat]
                .into_iter()
                .find_map(|m| Some(-(m.cholesky()?.solve(&slope))));
            let Some(step) = step else { break };
            let before = at;
            at += step;
            at.x = at.x.clamp(domains[0][0], domains[0][1]);
            at.y = at.y.clamp(domains[1][0], domains[1][1]);
            if (at - before).amax() <= 1e-12 * (1.0 + at.amax()) {
                break;
            }
        }
        at
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Parametrization, interpolate_grid};

    /// z = a x² + b y² over a square whose lines are turned by an angle.
    fn saddle(turn: f64) -> BSplineSurface {
        let (sin, cos) = turn.sin_cos();
        let place = |i: u32, j: u32| {
            let [p, q] = [f64::from(i) / 8.0 - 0.5, f64::from(j) / 8.0 - 0.5];
            let [x, y] = [cos * p - sin * q, sin * p + cos * q];
            Point3::new(x, y, 0.3 * x * x - 0.2 * y * y)
        };
        let grid: Vec<_> = (0..9)
            .flat_map(|i| (0..9).map(move |j| place(i, j)))
            .collect();
        interpolate_grid(&grid, [9, 9], [3, 3], Parametrization::Uniform).unwrap()
    }

    #[test]
    fn torsion_is_that_of_euler_and_bonnet() {
        // τ = (κ₂ − κ₁) sin θ cos θ at the middle, κ = 0.6 and −0.4.
        for turn in [0.0, 0.4, std::f64::consts::FRAC_PI_4] {
            let jet = saddle(turn).derivatives(0.5, 0.5);
            let expected = turn.sin() * turn.cos();
            let found = torsion(&jet, [1.0, 1.0]);
            assert!(
                (found - expected).abs() < 1e-3,
                "{turn}: {found} {expected}"
            );
        }
    }

    #[test]
    fn feet_are_found_from_beside() {
        let surface = saddle(0.3);
        let jet = surface.derivatives(0.31, 0.64);
        let point = jet.point + 0.2 * jet.normal().unwrap();
        let foot = FootFinder::new(&surface).foot(Vector2::new(0.4, 0.5), &point);
        assert!((foot - Vector2::new(0.31, 0.64)).norm() < 1e-9, "{foot}");
    }
}
