//! B-splines whose knots go on beyond their domain, as closed surfaces often
//! have them, told with knots that end with it.
//!
//! The same spline: the ends of the domain are inserted as knots until they
//! have full multiplicity, and what lies beyond is dropped (Boehm 1980).

use nalgebra::{Point3, Vector4};

/// Degree, knots and control points of a surface in homogeneous coordinates,
/// a row of control points to each knot of one direction.
struct Net {
    degree: usize,
    knots: Vec<f64>,
    rows: Vec<Vec<Vector4<f64>>>,
}

/// Control points and weights, and the knots that clamp them.
pub(super) struct Clamped {
    pub(super) knots: [Vec<f64>; 2],
    pub(super) poles: Vec<Point3<f64>>,
    pub(super) weights: Option<Vec<f64>>,
}

/// A surface with knots that end with its domain. `None`: they do already, or
/// numbers do not match, which the surface itself will say.
pub(super) fn clamped(
    degrees: [usize; 2],
    knots: &[Vec<f64>; 2],
    poles: &[Point3<f64>],
    weights: Option<&[f64]>,
) -> Option<Clamped> {
    let count = |axis: usize| knots[axis].len().checked_sub(degrees[axis] + 1);
    let counts = [count(0)?, count(1)?];
    let is_clamped = |axis: usize| ends_are_full(degrees[axis], &knots[axis]);
    let fits = counts[0] > degrees[0] && counts[1] > degrees[1];
    let all_there = poles.len() == counts[0] * counts[1];
    let same = weights.is_none_or(|w| w.len() == poles.len() && w.iter().all(|w| *w > 0.0));
    let rises = |axis: usize| {
        let (p, k) = (degrees[axis], &knots[axis]);
        k.is_sorted() && k[p] < k[counts[axis]]
    };
    if !(fits && all_there && same) || (is_clamped(0) && is_clamped(1)) {
        return None;
    }
    if !(rises(0) && rises(1)) {
        return None;
    }
    let weight = |i: usize| weights.map_or(1.0, |w| w[i]);
    let homogeneous = |(i, p): (usize, &Point3<f64>)| (p.coords * weight(i)).push(weight(i));
    let all: Vec<Vector4<f64>> = poles.iter().enumerate().map(homogeneous).collect();
    let rows: Vec<Vec<Vector4<f64>>> = all.chunks(counts[1]).map(<[_]>::to_vec).collect();
    let u = Net {
        degree: degrees[0],
        knots: knots[0].clone(),
        rows,
    };
    let u = u.clamped();
    let v = Net {
        degree: degrees[1],
        knots: knots[1].clone(),
        rows: transposed(&u.rows),
    };
    let v = v.clamped();
    let all = transposed(&v.rows).concat();
    Some(Clamped {
        knots: [u.knots, v.knots],
        poles: all.iter().map(|h| Point3::from(h.xyz() / h.w)).collect(),
        weights: weights.map(|_| all.iter().map(|h| h.w).collect()),
    })
}

/// Whether the first and the last knot have full multiplicity.
fn ends_are_full(degree: usize, knots: &[f64]) -> bool {
    let last = knots.len() - 1;
    knots[0] == knots[degree] && knots[last] == knots[last - degree]
}

fn transposed(rows: &[Vec<Vector4<f64>>]) -> Vec<Vec<Vector4<f64>>> {
    let columns = rows.first().map_or(0, Vec::len);
    let column = |j: usize| rows.iter().map(|row| row[j]).collect();
    (0..columns).map(column).collect()
}

impl Net {
    fn clamped(self) -> Net {
        self.begun_anew().reversed().begun_anew().reversed()
    }

    fn reversed(mut self) -> Net {
        self.knots.reverse();
        self.knots.iter_mut().for_each(|k| *k = -*k);
        self.rows.reverse();
        self
    }

    /// The domain's first knot made full, what lies before it dropped.
    fn begun_anew(mut self) -> Net {
        let degree = self.degree;
        let first = self.knots[degree];
        let begin = self.knots.partition_point(|k| *k < first);
        let mut end = self.knots.partition_point(|k| *k <= first);
        while end - begin < degree {
            self.insert(first, end);
            end += 1;
        }
        let dropped = end - 1 - degree;
        self.rows.drain(..dropped);
        self.knots.drain(..dropped);
        self.knots[0] = first;
        self
    }

    /// Inserts a knot before place `end`, the first of larger ones.
    fn insert(&mut self, knot: f64, end: usize) {
        let (degree, span) = (self.degree, end - 1);
        let copies = end - self.knots.partition_point(|k| *k < knot);
        let (old, knots) = (&self.rows, &self.knots);
        let row = |i: usize| {
            if i + degree <= span {
                return old[i].clone();
            }
            if i > span - copies {
                return old[i - 1].clone();
            }
            let share = (knot - knots[i]) / (knots[i + degree] - knots[i]);
            let blend = |(a, b): (&Vector4<f64>, &Vector4<f64>)| a.lerp(b, share);
            old[i - 1].iter().zip(&old[i]).map(blend).collect()
        };
        let rows = (0..=old.len()).map(row).collect();
        self.rows = rows;
        self.knots.insert(end, knot);
    }
}
