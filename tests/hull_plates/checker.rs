//! Measures delivered plates by code of its own: de Boor's triangle on raw
//! knots and control points, the angle between end normals, the regression
//! curve from the normals, distances by sampling and Newton steps. Nothing of
//! the method or of `mouldloft::geometry` is called; only plain numbers are
//! read out of its types.
//!
//! Limits: everything is sampled (densely, per knot span), so a maximum may be
//! a little low; distances are exact to rounding at the sampled places.

use mouldloft::geometry::{BSplineCurve, BSplineSurface};
use nalgebra::{Point3, Vector3};

type V = Vector3<f64>;

/// A knot span narrower than this share of the domain holds no shape.
const SLIVER: f64 = 1e-11;

/// A polynomial spline as plain numbers.
#[derive(Debug, Clone)]
pub struct Spline {
    pub degree: usize,
    pub knots: Vec<f64>,
    pub points: Vec<V>,
}

/// A place on a spline: parameter, point, first derivative.
#[derive(Debug, Clone, Copy)]
pub struct Place {
    pub u: f64,
    pub point: V,
    pub d1: V,
}

impl Spline {
    /// Reads a polynomial curve.
    pub fn of(curve: &BSplineCurve) -> Self {
        assert!(curve.weights().is_none(), "delivered curves are polynomial");
        Spline {
            degree: curve.degree(),
            knots: curve.knots().to_vec(),
            points: curve.control_points().iter().map(|p| p.coords).collect(),
        }
    }

    /// The two long edges of a plate, `v = 0` and `v = 1`.
    pub fn edges(surface: &BSplineSurface) -> [Self; 2] {
        assert_eq!(
            surface.degrees(),
            [3, 1],
            "a plate is cubic along, straight across"
        );
        assert!(surface.weights().is_none(), "plates are polynomial");
        assert_eq!(surface.knots()[1], [0.0, 0.0, 1.0, 1.0]);
        [0, 1].map(|side| Spline {
            degree: 3,
            knots: surface.knots()[0].clone(),
            points: surface
                .control_points()
                .iter()
                .skip(side)
                .step_by(2)
                .map(|p| p.coords)
                .collect(),
        })
    }

    /// Cubic through points, chord-length parameters, averaged knots (Zheng &
    /// Bo 2018, eqs. 1 and 2); of lower degree through fewer than four.
    pub fn through(given: &[Point3<f64>]) -> Self {
        let n = given.len();
        let degree = 3.min(n - 1);
        let mut t = vec![0.0];
        for pair in given.windows(2) {
            t.push(t[t.len() - 1] + (pair[1] - pair[0]).norm());
        }
        let total = t[n - 1];
        t.iter_mut().for_each(|v| *v /= total);
        let mut knots = vec![0.0; degree + 1];
        for j in 1..n - degree {
            knots.push(t[j..j + degree].iter().sum::<f64>() / degree as f64);
        }
        knots.extend(vec![1.0; degree + 1]);
        let rows = t.iter().map(|&u| basis_row(&knots, degree, n, u)).collect();
        let right = given.iter().map(|p| p.coords).collect();
        Spline {
            degree,
            knots,
            points: eliminate(rows, right),
        }
    }

    /// Indices k of the spans [knot k, knot k+1] that are not empty but for
    /// rounding; `slivers` counts the others.
    pub fn spans(&self) -> Vec<usize> {
        (self.degree..self.points.len())
            .filter(|&k| self.width(k) > SLIVER)
            .collect()
    }

    /// Spans that are not empty, but by rounding alone.
    pub fn slivers(&self) -> usize {
        (self.degree..self.points.len())
            .filter(|&k| self.width(k) > 0.0 && self.width(k) <= SLIVER)
            .count()
    }

    /// Width of span `k` as share of the domain.
    fn width(&self, k: usize) -> f64 {
        let domain = self.knots[self.points.len()] - self.knots[self.degree];
        (self.knots[k + 1] - self.knots[k]) / domain
    }

    /// De Boor's triangle in span `k`; `u` may be either end of it.
    pub fn at_in(&self, k: usize, u: f64) -> Place {
        let p = self.degree;
        let mut d: Vec<V> = self.points[k - p..=k].to_vec();
        let mut d1 = V::zeros();
        for level in 1..=p {
            if level == p {
                d1 = (d[p] - d[p - 1]) * (p as f64 / (self.knots[k + 1] - self.knots[k]));
            }
            for j in (level..=p).rev() {
                let (low, high) = (self.knots[j + k - p], self.knots[j + 1 + k - level]);
                let a = (u - low) / (high - low);
                d[j] = d[j - 1] * (1.0 - a) + d[j] * a;
            }
        }
        Place { u, point: d[p], d1 }
    }

    /// The place at `u`, right-sided at knots.
    pub fn at(&self, u: f64) -> Place {
        let last = self.points.len();
        let mut k = self
            .knots
            .partition_point(|&t| t <= u)
            .saturating_sub(1)
            .clamp(self.degree, last - 1);
        while k > self.degree && self.width(k) <= SLIVER {
            k -= 1;
        }
        self.at_in(k, u)
    }

    /// `per_span` + 1 places in every span, both ends included.
    pub fn sample(&self, per_span: usize) -> Vec<Place> {
        let mut out = Vec::new();
        for k in self.spans() {
            let (a, b) = (self.knots[k], self.knots[k + 1]);
            for i in 0..=per_span {
                out.push(self.at_in(k, a + (b - a) * i as f64 / per_span as f64));
            }
        }
        out
    }

    pub fn start(&self) -> V {
        self.points[0]
    }

    pub fn end(&self) -> V {
        self.points[self.points.len() - 1]
    }
}

/// Cox and de Boor's recursion, one row of the interpolation matrix.
fn basis_row(knots: &[f64], degree: usize, n: usize, u: f64) -> Vec<f64> {
    fn cox(t: &[f64], i: usize, p: usize, u: f64) -> f64 {
        if p == 0 {
            return f64::from(u8::from(t[i] <= u && u < t[i + 1]));
        }
        let part = |from: f64, width: f64, next: usize| {
            if width > 0.0 {
                from / width * cox(t, next, p - 1, u)
            } else {
                0.0
            }
        };
        part(u - t[i], t[i + p] - t[i], i) + part(t[i + p + 1] - u, t[i + p + 1] - t[i + 1], i + 1)
    }
    if u >= 1.0 {
        return (0..n).map(|i| f64::from(u8::from(i + 1 == n))).collect();
    }
    (0..n).map(|i| cox(knots, i, degree, u)).collect()
}

/// Gauss with row pivoting.
fn eliminate(mut a: Vec<Vec<f64>>, mut x: Vec<V>) -> Vec<V> {
    let n = a.len();
    for c in 0..n {
        let pivot = (c..n)
            .max_by(|&i, &j| a[i][c].abs().total_cmp(&a[j][c].abs()))
            .unwrap();
        a.swap(c, pivot);
        x.swap(c, pivot);
        for r in c + 1..n {
            let f = a[r][c] / a[c][c];
            if f != 0.0 {
                let upper = a[c].clone();
                a[r].iter_mut().zip(&upper).for_each(|(v, w)| *v -= f * w);
                let xc = x[c];
                x[r] -= xc * f;
            }
        }
    }
    for c in (0..n).rev() {
        for k in c + 1..n {
            let xk = x[k];
            x[c] -= xk * a[c][k];
        }
        x[c] /= a[c][c];
    }
    x
}

/// Distances from many places to one curve.
pub struct Nearest<'a> {
    curve: &'a Spline,
    samples: Vec<Place>,
    /// Slower than this, the curve stands.
    still: f64,
}

impl<'a> Nearest<'a> {
    pub fn new(curve: &'a Spline) -> Self {
        let per_span = (2000 / curve.spans().len()).clamp(4, 64);
        let samples = curve.sample(per_span);
        let fastest = samples.iter().map(|s| s.d1.norm()).fold(0.0, f64::max);
        Nearest {
            curve,
            samples,
            still: STANDS * fastest,
        }
    }

    /// Parameters two different samples before and behind sample `i`: where
    /// the curve stands still, many samples are one place.
    fn around(&self, i: usize) -> (f64, f64) {
        let here = &self.samples[i];
        let apart = 1e-12 * (self.curve.end() - self.curve.start()).norm();
        let moves = |s: &&Place| s.d1.norm() > self.still && (s.point - here.point).norm() > apart;
        let before = self.samples[..i].iter().rev().filter(moves).nth(1);
        let behind = self.samples[i..].iter().filter(moves).nth(1);
        let ends = [&self.samples[0], &self.samples[self.samples.len() - 1]];
        (before.unwrap_or(ends[0]).u, behind.unwrap_or(ends[1]).u)
    }

    /// The distance to the nearest place of the curve, and its parameter.
    pub fn to(&self, p: &V) -> (f64, f64) {
        let best = |v: &Place| (v.point - p).norm_squared();
        let (i, _) = self
            .samples
            .iter()
            .enumerate()
            .map(|(i, s)| (i, best(s)))
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .unwrap();
        let (low, high) = self.around(i);
        let mut found = (best(&self.samples[i]), self.samples[i].u);
        for start in [low, self.samples[i].u, high] {
            let mut place = self.curve.at(start);
            for _ in 0..12 {
                if best(&place) < found.0 {
                    found = (best(&place), place.u);
                }
                let speed = place.d1.norm_squared();
                if speed == 0.0 {
                    break;
                }
                let u = place.u + (p - place.point).dot(&place.d1) / speed;
                place = self.curve.at(u.clamp(low, high));
            }
        }
        (found.0.sqrt(), found.1)
    }
}

/// How far `from` leaves `to`: largest distance and its mean along `from`.
pub fn leaves(from: &Spline, to: &Spline) -> (f64, f64) {
    let nearest = Nearest::new(to);
    let per_span = (1500 / from.spans().len()).clamp(3, 120);
    let places = from.sample(per_span);
    let distances: Vec<f64> = places.iter().map(|s| nearest.to(&s.point).0).collect();
    let (mut sum, mut length) = (0.0, 0.0);
    for (d, s) in distances.windows(2).zip(places.windows(2)) {
        let step = (s[1].point - s[0].point).norm();
        sum += 0.5 * (d[0] + d[1]) * step;
        length += step;
    }
    (distances.iter().copied().fold(0.0, f64::max), sum / length)
}

/// What the checker finds on one plate. Angles in degrees.
#[derive(Debug, Clone)]
pub struct Found {
    pub twist_max: f64,
    pub twist_at: f64,
    /// Weighted by area; fans count with none.
    pub twist_mean: f64,
    pub area: f64,
    /// Outside the fans, in ruling lengths.
    pub clearance: f64,
    pub clearance_at: f64,
    /// Rulings with opposed end normals, and steps along an edge that turn back.
    pub crossings: usize,
    /// Share of an edge, percent, that is swept while the other stands:
    /// at the plate's start, at its end, anywhere else.
    pub fans: [f64; 3],
    /// Parameter ranges of those.
    pub fan_ranges: Vec<[f64; 2]>,
    /// Smallest |bend radius| across the rulings outside the fans.
    pub bend_radius: f64,
}

/// Below this share of an edge's greatest speed it stands still.
const STANDS: f64 = 1e-7;
/// Rulings shorter than this share of the longest have no direction.
const SHORT: f64 = 1e-4;
/// Rulings looked at in each knot span.
const PER_SPAN: usize = 24;

/// Measures one plate.
pub fn measure(surface: &BSplineSurface) -> Found {
    let [first, second] = Spline::edges(surface);
    let (a, b) = (first.sample(PER_SPAN), second.sample(PER_SPAN));
    let speed = |s: &[Place]| s.iter().map(|p| p.d1.norm()).fold(0.0, f64::max);
    let stand = [STANDS * speed(&a), STANDS * speed(&b)];
    let longest = a
        .iter()
        .zip(&b)
        .map(|(a, b)| (b.point - a.point).norm())
        .fold(0.0, f64::max);
    let mut found = Found {
        twist_max: 0.0,
        twist_at: 0.0,
        twist_mean: 0.0,
        area: 0.0,
        clearance: f64::INFINITY,
        clearance_at: 0.0,
        crossings: turns_back(&a, stand[0]) + turns_back(&b, stand[1]),
        fans: [0.0; 3],
        fan_ranges: Vec::new(),
        bend_radius: f64::INFINITY,
    };
    let mut weighted = 0.0;
    for (sa, sb) in a.chunks(PER_SPAN + 1).zip(b.chunks(PER_SPAN + 1)) {
        let middle = PER_SPAN / 2;
        let fan = sa[middle].d1.norm() <= stand[0] || sb[middle].d1.norm() <= stand[1];
        if fan {
            match found.fan_ranges.last_mut() {
                Some(last) if sa[0].u - last[1] <= SLIVER => last[1] = sa[PER_SPAN].u,
                _ => found.fan_ranges.push([sa[0].u, sa[PER_SPAN].u]),
            }
        }
        for (i, (p, q)) in sa.iter().zip(sb).enumerate() {
            if (q.point - p.point).norm() <= SHORT * longest {
                continue;
            }
            let ends = i == 0 || i == PER_SPAN;
            let step = (sa[PER_SPAN].u - sa[0].u) / PER_SPAN as f64 * if ends { 0.5 } else { 1.0 };
            let ruling = Ruling::new(p, q);
            let area = ruling.area() * step;
            found.area += area;
            if !fan {
                weighted += ruling.twist() * area;
                found.look_at(&ruling, p.u);
            }
        }
        if !fan {
            found.bend(sa, sb);
        }
    }
    found.twist_mean = weighted / found.area;
    found.fans = fan_shares(&first, &second, &found.fan_ranges);
    found
}

/// One ruling: its vector and the normals at its ends.
struct Ruling {
    n1: V,
    n2: V,
}

impl Ruling {
    fn new(p: &Place, q: &Place) -> Self {
        let l = q.point - p.point;
        Ruling {
            n1: l.cross(&p.d1),
            n2: l.cross(&q.d1),
        }
    }

    /// Zheng & Bo 2018, eq. 3, in degrees.
    fn twist(&self) -> f64 {
        self.n1
            .cross(&self.n2)
            .norm()
            .atan2(self.n1.dot(&self.n2))
            .to_degrees()
    }

    /// Area per unit of u, by Simpson's rule.
    fn area(&self) -> f64 {
        (self.n1.norm() + 2.0 * (self.n1 + self.n2).norm() + self.n2.norm()) / 6.0
    }

    /// How far from the ruling's ends, in its lengths, the regression curve
    /// passes: where the normal, of lengths |n1| and |n2| at the ends and
    /// linear between, vanishes; 0 where that is between them.
    fn clearance(&self) -> f64 {
        let (a, b) = (self.n1.norm(), self.n2.norm());
        if self.n1.dot(&self.n2) <= 0.0 {
            return 0.0;
        }
        if a == b {
            f64::INFINITY
        } else {
            a.min(b) / (a - b).abs()
        }
    }
}

impl Found {
    fn look_at(&mut self, ruling: &Ruling, u: f64) {
        if ruling.twist() > self.twist_max {
            (self.twist_max, self.twist_at) = (ruling.twist(), u);
        }
        if ruling.clearance() < self.clearance {
            (self.clearance, self.clearance_at) = (ruling.clearance(), u);
        }
        self.crossings += usize::from(ruling.n1.dot(&ruling.n2) <= 0.0);
    }

    /// Bend radius from how the unit normal turns from ruling to ruling: the
    /// distance walked across the rulings over the angle turned. Degenerate
    /// places are skipped.
    fn bend(&mut self, a: &[Place], b: &[Place]) {
        for i in 0..a.len() - 1 {
            let normal = |p: &Place, q: &Place, v: f64| {
                let l = q.point - p.point;
                l.cross(&(p.d1 * (1.0 - v) + q.d1 * v)).try_normalize(0.0)
            };
            for v in [0.0, 0.5, 1.0] {
                let (Some(m), Some(n)) = (normal(&a[i], &b[i], v), normal(&a[i + 1], &b[i + 1], v))
                else {
                    continue;
                };
                let at = |k: usize| a[k].point * (1.0 - v) + b[k].point * v;
                let l = (b[i].point - a[i].point + b[i + 1].point - a[i + 1].point).normalize();
                let step = at(i + 1) - at(i);
                let across = (step - l * step.dot(&l)).norm();
                let angle = m.cross(&n).norm().atan2(m.dot(&n));
                if across > 0.0 && angle > 1e-9 {
                    self.bend_radius = self.bend_radius.min(across / angle);
                }
            }
        }
    }
}

/// Steps of an edge that turn by more than a right angle, or leave no doubt
/// that the edge runs back over itself.
fn turns_back(places: &[Place], stand: f64) -> usize {
    let moving: Vec<V> = places
        .iter()
        .filter(|p| p.d1.norm() > stand)
        .map(|p| p.d1.normalize())
        .collect();
    moving.windows(2).filter(|w| w[0].dot(&w[1]) < 0.0).count()
}

/// Shares of the swept edges, percent: start, end, elsewhere.
fn fan_shares(first: &Spline, second: &Spline, ranges: &[[f64; 2]]) -> [f64; 3] {
    let length = |s: &Spline, range: [f64; 2]| {
        let places = s.sample(PER_SPAN);
        places
            .windows(2)
            .filter(|w| w[0].u >= range[0] && w[1].u <= range[1])
            .map(|w| (w[1].point - w[0].point).norm())
            .sum::<f64>()
    };
    let domain = [first.knots[0], first.knots[first.knots.len() - 1]];
    let whole = [length(first, domain), length(second, domain)];
    let mut shares = [0.0_f64; 3];
    for &run in ranges {
        let share = (length(first, run) / whole[0]).max(length(second, run) / whole[1]);
        let which = if run[0] - domain[0] <= SLIVER {
            0
        } else if domain[1] - run[1] <= SLIVER {
            1
        } else {
            2
        };
        shares[which] = shares[which].max(100.0 * share);
    }
    shares
}

#[test]
fn the_checker_evaluates_and_interpolates() {
    // A cubic Bézier by its Bernstein form.
    let points = [
        V::new(0., 0., 0.),
        V::new(1., 2., 0.),
        V::new(3., 2., 1.),
        V::new(4., 0., 5.),
    ];
    let bezier = Spline {
        degree: 3,
        knots: vec![0., 0., 0., 0., 1., 1., 1., 1.],
        points: points.to_vec(),
    };
    let (t, s) = (0.3_f64, 0.7_f64);
    let expected = points[0] * s.powi(3)
        + points[1] * 3. * t * s * s
        + points[2] * 3. * t * t * s
        + points[3] * t.powi(3);
    let tangent = (points[1] - points[0]) * 3. * s * s
        + (points[2] - points[1]) * 6. * t * s
        + (points[3] - points[2]) * 3. * t * t;
    let place = bezier.at(t);
    assert!((place.point - expected).norm() < 1e-14 && (place.d1 - tangent).norm() < 1e-13);

    let given: Vec<Point3<f64>> = (0..9)
        .map(|i| f64::from(i))
        .map(|x| Point3::new(x, x.sin(), 0.1 * x * x))
        .collect();
    let curve = Spline::through(&given);
    let nearest = Nearest::new(&curve);
    for p in &given {
        assert!(nearest.to(&p.coords).0 < 1e-12);
    }
    assert!((leaves(&curve, &curve)).0 < 1e-12);
}

#[test]
fn the_checker_sees_a_twist_of_45_degrees() {
    // The hyperbolic paraboloid z = xy over the unit square, ruled along y.
    let line = |z: f64, y: f64| {
        (0..4)
            .map(|i| f64::from(i) / 3.0)
            .map(move |x| Point3::new(x, y, z * x))
            .collect::<Vec<_>>()
    };
    let (low, high) = (line(0.0, 0.0), line(1.0, 1.0));
    let points = low
        .into_iter()
        .zip(high)
        .flat_map(|(a, b)| [a, b])
        .collect();
    let knots = [vec![0., 0., 0., 0., 1., 1., 1., 1.], vec![0., 0., 1., 1.]];
    let surface = BSplineSurface::new([3, 1], knots, points, None).unwrap();
    let found = measure(&surface);
    assert!((found.twist_max - 45.0).abs() < 1e-9, "{found:?}");
    assert!(found.twist_at == 0.0 && found.crossings == 0);
    let least = 1.0 / (2.0_f64.sqrt() - 1.0);
    assert!(
        (found.clearance - least).abs() < 1e-9,
        "speeds 1 and √2 at x = 0: {found:?}"
    );
}
