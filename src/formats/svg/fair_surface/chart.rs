//! From the surface to the sheet of paper: by its best plane, or by its
//! parameters where that folds.

use super::super::canvas::Spot;
use super::super::panel::Panel;
use crate::formats::fair_surface::FairSurfaceDrawing;
use crate::formats::fair_surface::outline::Outline;
use crate::geometry::{Axis, BSplineSurface};
use nalgebra::{Matrix3, Point3, SymmetricEigen, Vector3};

/// Places per direction that the sheet is judged by.
const PROBES: usize = 32;
/// A normal this near to an axis (cosine; 25°) makes the coordinate plane the
/// best one, for people know where that is.
const NEAR_AXIS: f64 = 0.9;
/// Names of the coordinates.
const AXES: [&str; 3] = ["x", "y", "z"];

/// How places of the surface get two coordinates.
pub(super) struct Chart<'a> {
    surface: &'a BSplineSurface,
    plane: Plane,
    /// Places all over the surface, where the search for a foot begins.
    known: Vec<([f64; 2], Point3<f64>)>,
    /// Least and greatest of both coordinates within the outline.
    pub ranges: [[f64; 2]; 2],
}

/// The two ways.
enum Plane {
    /// Along two unit vectors in space.
    Seen {
        right: Vector3<f64>,
        up: Vector3<f64>,
    },
    /// The parameters, each times a length so that the sheet keeps its shape.
    Parameters([f64; 2]),
}

impl<'a> Chart<'a> {
    /// The best way for the part of the surface within the outline.
    pub fn of(drawing: &'a FairSurfaceDrawing, outline: &Outline) -> Self {
        let surface = &drawing.surface;
        let probes: Vec<[f64; 2]> = probes(surface)
            .into_iter()
            .filter(|p| outline.contains(*p))
            .collect();
        let mut chart = Chart {
            surface,
            plane: Plane::Parameters(sizes(surface)),
            known: Vec::new(),
            ranges: [[0.0, 1.0]; 2],
        };
        match best_plane(surface, &probes) {
            Some(plane) => chart.plane = plane,
            None => {
                let known = |p: [f64; 2]| (p, surface.point(p[0], p[1]));
                chart.known = self::probes(surface).into_iter().map(known).collect();
            }
        }
        let corners = outline.rings.iter().flat_map(|ring| chart.dense(ring));
        let places: Vec<[f64; 2]> = corners.chain(probes).map(|p| chart.place(p)).collect();
        chart.ranges = [0, 1].map(|i| {
            let values = places.iter().map(|p| p[i]).filter(|c| c.is_finite());
            let none = [f64::INFINITY, f64::NEG_INFINITY];
            let range = values.fold(none, |r, c| [r[0].min(c), r[1].max(c)]);
            if range[0] <= range[1] {
                range
            } else {
                [0.0, 1.0]
            }
        });
        chart
    }

    /// The two coordinates of a place given by its parameters.
    pub fn place(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        match &self.plane {
            Plane::Seen { right, up } => {
                let p = self.surface.point(u, v).coords;
                [p.dot(right), p.dot(up)]
            }
            Plane::Parameters(sizes) => {
                let low = [Axis::U, Axis::V].map(|axis| self.surface.domain(axis)[0]);
                [(u - low[0]) * sizes[0], (v - low[1]) * sizes[1]]
            }
        }
    }

    /// The coordinates of a place in space on (or near) the surface.
    pub fn place_in_space(&self, point: &Point3<f64>) -> [f64; 2] {
        match &self.plane {
            Plane::Seen { right, up } => [point.coords.dot(right), point.coords.dot(up)],
            Plane::Parameters(_) => self.place(self.foot(point)),
        }
    }

    /// The parameters of the place of the surface nearest to a point: the nearest
    /// probe, then Gauss–Newton.
    fn foot(&self, point: &Point3<f64>) -> [f64; 2] {
        const STEPS: usize = 6;
        let surface = self.surface;
        let distance = |p: &[f64; 2]| (surface.point(p[0], p[1]) - point).norm_squared();
        let squared = |(_, p): &&([f64; 2], Point3<f64>)| (p - point).norm_squared();
        let near = self
            .known
            .iter()
            .min_by(|a, b| squared(a).total_cmp(&squared(b)));
        let mut at = near.map_or([0.0; 2], |(parameters, _)| *parameters);
        for _ in 0..STEPS {
            let jet = surface.derivatives(at[0], at[1]);
            let gap = point - jet.point;
            let [e, f, g] = [
                jet.du.dot(&jet.du),
                jet.du.dot(&jet.dv),
                jet.dv.dot(&jet.dv),
            ];
            let [a, b] = [gap.dot(&jet.du), gap.dot(&jet.dv)];
            let area = e * g - f * f;
            let next = [
                at[0] + (a * g - b * f) / area,
                at[1] + (b * e - a * f) / area,
            ];
            let [us, vs] = [Axis::U, Axis::V].map(|axis| surface.domain(axis));
            let next = [next[0].clamp(us[0], us[1]), next[1].clamp(vs[0], vs[1])];
            // Also where the surface has no area and the step is no number.
            let nearer = distance(&next) < distance(&at);
            if !nearer {
                break;
            }
            at = next;
        }
        at
    }

    /// A ring on the page.
    pub fn ring(&self, ring: &[[f64; 2]], panel: &Panel) -> Vec<Spot> {
        let dense = self.dense(ring);
        dense.map(|p| panel.map(self.place(p))).collect()
    }

    /// A closed ring with places between its corners, for its edges are not
    /// straight on the page.
    fn dense<'b>(&self, ring: &'b [[f64; 2]]) -> impl Iterator<Item = [f64; 2]> + use<'b> {
        /// Places on the whole ring at least.
        const LEAST: usize = 400;
        let each = (LEAST / ring.len().max(1)).max(1);
        let next = ring.iter().cycle().skip(1);
        ring.iter().zip(next).flat_map(move |(a, b)| {
            let at = move |k: usize| {
                let t = k as f64 / each as f64;
                [a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t]
            };
            (0..each).map(at)
        })
    }

    /// Whether lengths on the page are lengths of the sheet.
    pub fn is_true_to_scale(&self) -> bool {
        matches!(self.plane, Plane::Seen { .. })
    }

    /// What the two coordinates are.
    pub fn name(&self, units: &str) -> String {
        match &self.plane {
            Plane::Parameters(_) => format!("developed along u and v, about {units}"),
            Plane::Seen { right, up } => match [axis_of(right), axis_of(up)] {
                [Some(a), Some(b)] => format!("{}–{}, {units}", AXES[a], AXES[b]),
                _ => format!("seen square to the sheet, {units}"),
            },
        }
    }
}

/// The coordinate that a unit vector runs along.
fn axis_of(v: &Vector3<f64>) -> Option<usize> {
    (0..3).find(|i| v[*i] == 1.0)
}

/// Parameters over the domain.
fn probes(surface: &BSplineSurface) -> Vec<[f64; 2]> {
    let [us, vs] = [Axis::U, Axis::V].map(|axis| surface.domain(axis));
    let at = |d: [f64; 2], k: usize| d[0] + (d[1] - d[0]) * ((k as f64 + 0.5) / PROBES as f64);
    (0..PROBES)
        .flat_map(|i| (0..PROBES).map(move |j| (i, j)))
        .map(|(i, j)| [at(us, i), at(vs, j)])
        .collect()
}

/// Mean length of the surface per unit of u and v.
fn sizes(surface: &BSplineSurface) -> [f64; 2] {
    let probes = probes(surface);
    let mut sums = [0.0; 2];
    for [u, v] in &probes {
        let jet = surface.derivatives(*u, *v);
        sums[0] += jet.du.norm() / probes.len() as f64;
        sums[1] += jet.dv.norm() / probes.len() as f64;
    }
    sums.map(|s| if s > 0.0 && s.is_finite() { s } else { 1.0 })
}

/// The plane of least squares through the probes, unless the surface turns
/// its other side to it somewhere.
fn best_plane(surface: &BSplineSurface, probes: &[[f64; 2]]) -> Option<Plane> {
    let points: Vec<Vector3<f64>> = probes
        .iter()
        .map(|[u, v]| surface.point(*u, *v).coords)
        .collect();
    let mean = points.iter().sum::<Vector3<f64>>() / points.len() as f64;
    let spread: Matrix3<f64> = points
        .iter()
        .map(|p| (p - mean) * (p - mean).transpose())
        .sum();
    if !spread.iter().all(|c| c.is_finite()) || points.is_empty() {
        return None;
    }
    let eigen = SymmetricEigen::new(spread);
    let least = eigen.eigenvalues.imin();
    let normal: Vector3<f64> = eigen.eigenvectors.column(least).into_owned();
    let normal = match (0..3).find(|i| normal[*i].abs() > NEAR_AXIS) {
        Some(i) if faces(surface, probes, &axis(i)) => axis(i),
        _ if faces(surface, probes, &normal) => normal,
        _ => return None,
    };
    Some(upright(&normal))
}

fn axis(i: usize) -> Vector3<f64> {
    let mut v = Vector3::zeros();
    v[i] = 1.0;
    v
}

/// Whether the surface shows one side only, seen along a direction.
fn faces(surface: &BSplineSurface, probes: &[[f64; 2]], direction: &Vector3<f64>) -> bool {
    let normals = probes.iter().filter_map(|[u, v]| surface.normal(*u, *v));
    let (mut front, mut back) = (false, false);
    for normal in normals {
        front |= normal.dot(direction) > 0.0;
        back |= normal.dot(direction) < 0.0;
    }
    front != back
}

/// Right and up square to a direction, with z upwards or, seen from above,
/// x to the right.
fn upright(normal: &Vector3<f64>) -> Plane {
    let square = |v: Vector3<f64>| (v - normal * normal.dot(&v)).try_normalize(1e-9);
    let is_flat = normal.z.abs() > NEAR_AXIS;
    let (first, other) = if is_flat {
        (Vector3::x(), Vector3::y())
    } else {
        (Vector3::z(), Vector3::x())
    };
    let main = square(first).unwrap_or(other);
    let cross = main.cross(normal);
    let cross = if cross.dot(&other) < 0.0 || (cross.dot(&other) == 0.0 && cross.sum() < 0.0) {
        -cross
    } else {
        cross
    };
    if is_flat {
        Plane::Seen {
            right: main,
            up: cross,
        }
    } else {
        Plane::Seen {
            right: cross,
            up: main,
        }
    }
}
