//! Checks of returned patches that share nothing with the method: Bernstein
//! polynomials, circles through points, mirror images, angles.

#![allow(clippy::unwrap_used)] // Helpers of tests: a panic is their failure.

use serde_json::Value;

pub type Vec3 = [f64; 3];

pub fn sub(a: Vec3, b: Vec3) -> Vec3 {
    [0, 1, 2].map(|i| a[i] - b[i])
}
pub fn dot(a: Vec3, b: Vec3) -> f64 {
    (0..3).map(|i| a[i] * b[i]).sum()
}
pub fn norm(a: Vec3) -> f64 {
    dot(a, a).sqrt()
}
pub fn cross(a: Vec3, b: Vec3) -> Vec3 {
    [0, 1, 2].map(|i| a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3])
}
pub fn unit(a: Vec3) -> Vec3 {
    let n = norm(a);
    a.map(|x| x / n)
}
/// Between unit vectors, radians, right down to rounding.
pub fn angle(a: Vec3, b: Vec3) -> f64 {
    norm(cross(a, b)).atan2(dot(a, b))
}

pub fn vec3(v: &Value) -> Vec3 {
    [0, 1, 2].map(|i| v[i].as_f64().unwrap())
}

/// A rational biquadratic patch, control points and weights `[u][v]`.
pub struct Patch {
    points: [[Vec3; 3]; 3],
    weights: [[f64; 3]; 3],
}

impl Patch {
    pub fn of(surface: &Value) -> Self {
        assert_eq!(surface["degree"], serde_json::json!([2, 2]));
        for knots in surface["knots"].as_array().unwrap() {
            assert_eq!(knots, &serde_json::json!([0.0, 0.0, 0.0, 1.0, 1.0, 1.0]));
        }
        let at = |name: &str, i: usize, j: usize| surface[name][i][j].clone();
        let three = [0, 1, 2];
        Patch {
            points: three.map(|i| three.map(|j| vec3(&at("control_points", i, j)))),
            weights: three.map(|i| three.map(|j| at("weights", i, j).as_f64().unwrap())),
        }
    }

    /// Point and unit tangents.
    pub fn at(&self, u: f64, v: f64) -> (Vec3, [Vec3; 2]) {
        let basis = |t: f64| [(1.0 - t) * (1.0 - t), 2.0 * t * (1.0 - t), t * t];
        let slope = |t: f64| [2.0 * t - 2.0, 2.0 - 4.0 * t, 2.0 * t];
        // About a corner, so that no digits are lost to the place.
        let origin = self.points[if u > 0.5 { 2 } else { 0 }][if v > 0.5 { 2 } else { 0 }];
        let sum = |a: [f64; 3], b: [f64; 3]| {
            let mut total = [0.0; 4];
            for (i, a) in a.iter().enumerate() {
                for (j, b) in b.iter().enumerate() {
                    let w = a * b * self.weights[i][j];
                    let p = sub(self.points[i][j], origin);
                    (0..3).for_each(|k| total[k] += w * p[k]);
                    total[3] += w;
                }
            }
            total
        };
        let s = sum(basis(u), basis(v));
        let place = [0, 1, 2].map(|k| s[k] / s[3]);
        let along = |d: [f64; 4]| unit([0, 1, 2].map(|k| d[k] - place[k] * d[3]));
        let tangents = [sum(slope(u), basis(v)), sum(basis(u), slope(v))].map(along);
        ([0, 1, 2].map(|k| place[k] + origin[k]), tangents)
    }

    pub fn normal(&self, u: f64, v: f64) -> Vec3 {
        let [a, b] = self.at(u, v).1;
        unit(cross(a, b))
    }

    /// Along a side: v = 0, v = 1, u = 0, u = 1.
    pub fn side(side: usize, t: f64) -> (f64, f64) {
        [(t, 0.0), (t, 1.0), (0.0, t), (1.0, t)][side]
    }
}

/// |Im| of the cross ratio of four points as quaternions, of unit length: zero
/// if and only if they lie on a circle or a line.
pub fn off_circle(points: [Vec3; 4]) -> f64 {
    let mut product = (1.0, [0.0; 3]);
    for k in 0..4 {
        let e = unit(sub(points[(k + 1) % 4], points[k]));
        let (w, v) = product;
        let turn = cross(v, e);
        product = (-dot(v, e), [0, 1, 2].map(|i| w * e[i] + turn[i]));
    }
    norm(product.1)
}

/// A net of patches with its rows, columns and closed directions.
pub struct Net {
    pub patches: Vec<Patch>,
    pub counts: [usize; 2],
    pub closed: [bool; 2],
}

/// The largest errors of a net.
#[derive(Debug, Default)]
pub struct Errors {
    /// Corners of a patch off their circle.
    pub corners: f64,
    /// Points of a border off the arc through three of its points.
    pub arcs: f64,
    /// Normals and tangents at two ends of a side off each other's mirror image.
    pub mirrors: f64,
    /// Angle between tangent planes along common borders.
    pub planes: f64,
    /// Cosine of the angle between parameter lines, corners and inside.
    pub skew: f64,
}

impl Errors {
    /// All of them together: unlike a maximum it does not lose a NaN.
    pub fn total(&self) -> f64 {
        self.corners + self.arcs + self.mirrors + self.planes + self.skew
    }
}

impl Net {
    pub fn of(result: &Value, prefix: &str) -> Self {
        let specific = &result["method_specific"];
        let closed = ["u", "v"].map(|d| specific["closed"].as_array().unwrap().contains(&d.into()));
        let sizes = ["rows", "columns"].map(|k| specific[k].as_u64().unwrap() as usize);
        let counts = [0, 1].map(|k| sizes[k] - usize::from(!closed[k]));
        let named = |name: &str| {
            let surfaces = result["surfaces"].as_array().unwrap();
            surfaces.iter().find(|s| s["name"] == name).map(Patch::of)
        };
        let names = (0..counts[0]).flat_map(|i| (0..counts[1]).map(move |j| (i, j)));
        let patches = names.map(|(i, j)| named(&format!("{prefix}{i},{j}")).unwrap());
        Net {
            patches: patches.collect(),
            counts,
            closed,
        }
    }

    pub fn patch(&self, i: usize, j: usize) -> &Patch {
        &self.patches[i * self.counts[1] + j]
    }

    pub fn errors(&self) -> Errors {
        let mut errors = Errors::default();
        for i in 0..self.counts[0] {
            for j in 0..self.counts[1] {
                own(self.patch(i, j), &mut errors);
                let next = |k: usize, axis: usize| match k + 1 {
                    n if n < self.counts[axis] => Some(n),
                    _ => self.closed[axis].then_some(0),
                };
                if let Some(i) = next(i, 0) {
                    join(
                        (self.patch(i, j), 2),
                        (self.patch_before(i, j, 0), 3),
                        &mut errors,
                    );
                }
                if let Some(j) = next(j, 1) {
                    join(
                        (self.patch(i, j), 0),
                        (self.patch_before(i, j, 1), 1),
                        &mut errors,
                    );
                }
            }
        }
        errors
    }

    fn patch_before(&self, i: usize, j: usize, axis: usize) -> &Patch {
        let back = |k: usize, axis: usize| (k + self.counts[axis] - 1) % self.counts[axis];
        if axis == 0 {
            self.patch(back(i, 0), j)
        } else {
            self.patch(i, back(j, 1))
        }
    }
}

fn raise(slot: &mut f64, value: f64) {
    // NaN is the largest error.
    if value > *slot || value.is_nan() {
        *slot = value;
    }
}

fn own(patch: &Patch, errors: &mut Errors) {
    let corner = |u, v| patch.at(u, v).0;
    let ring = [
        corner(0.0, 0.0),
        corner(1.0, 0.0),
        corner(1.0, 1.0),
        corner(0.0, 1.0),
    ];
    raise(&mut errors.corners, off_circle(ring));
    for side in 0..4 {
        let at = |t: f64| {
            let (u, v) = Patch::side(side, t);
            patch.at(u, v)
        };
        for t in [0.2, 0.35, 0.7, 0.9] {
            let four = [at(0.0).0, at(0.5).0, at(1.0).0, at(t).0];
            raise(&mut errors.arcs, off_circle(four));
        }
        let ((p, from), (q, to)) = (at(0.0), at(1.0));
        let e = unit(sub(q, p));
        let image = |v: Vec3| [0, 1, 2].map(|k| v[k] - 2.0 * dot(v, e) * e[k]);
        let along = side / 2;
        let normals = [from, to].map(|[a, b]| unit(cross(a, b)));
        raise(
            &mut errors.mirrors,
            norm(sub(image(normals[0]), normals[1])),
        );
        let back = image(from[along]).map(|x| -x);
        raise(&mut errors.mirrors, norm(sub(back, to[along])));
        let across = image(from[1 - along]);
        raise(&mut errors.mirrors, norm(sub(across, to[1 - along])));
    }
    for (u, v) in [
        (0.0, 0.0),
        (1.0, 0.0),
        (0.0, 1.0),
        (1.0, 1.0),
        (0.3, 0.6),
        (0.5, 0.5),
    ] {
        let [a, b] = patch.at(u, v).1;
        raise(&mut errors.skew, dot(a, b).abs());
    }
}

/// Tangent planes at the same places of two patches' common side, the place on
/// the second found by bisection of the distance from the side's start.
fn join((first, side): (&Patch, usize), (second, other): (&Patch, usize), errors: &mut Errors) {
    let at = |patch: &Patch, side: usize, t: f64| {
        let (u, v) = Patch::side(side, t);
        (patch.at(u, v).0, patch.normal(u, v))
    };
    let start = at(first, side, 0.0).0;
    for t in [0.0, 0.25, 0.6, 1.0] {
        let (place, normal) = at(first, side, t);
        let distance = norm(sub(place, start));
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if norm(sub(at(second, other, middle).0, start)) < distance {
                low = middle;
            } else {
                high = middle;
            }
        }
        let (there, beyond) = at(second, other, if t == 1.0 { 1.0 } else { low });
        raise(&mut errors.planes, angle(normal, beyond));
        raise(
            &mut errors.arcs,
            norm(sub(place, there)) / distance.max(norm(sub(at(first, side, 1.0).0, start))),
        );
    }
}
