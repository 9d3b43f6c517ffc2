//! The first parameters of ordered points and the knots that go with them.

use super::space::{Space, Vector};
use crate::geometry::SplineError;

/// Points are averaged to about this many groups before lengths are measured.
const GROUPS: usize = 256;
/// The polygon of the points may be this much longer than that of the groups
/// before its length is held for noise.
const STEADY: f64 = 1.1;
/// Knots nearer than this share of the curve count as one.
const SAME_KNOT: f64 = 1e-7;

/// Parameters for the points in their order, and the domain: near arc length,
/// in the unit of the points.
///
/// Chord lengths, unless the points lie so dense that a chord measures noise:
/// then chords of means of consecutive points, with the points of a group
/// spread evenly.
pub(super) fn ordered_parameters<const D: usize>(
    points: &[Vector<D>],
    closed: bool,
) -> (Vec<f64>, [f64; 2]) {
    let own: Vec<f64> = chords(points);
    let size = points.len().div_ceil(GROUPS);
    let groups: Vec<Vector<D>> = points
        .chunks(size)
        .map(|g| g.iter().sum::<Vector<D>>() / g.len() as f64)
        .collect();
    let steady = |own: &[f64], coarse: &[f64]| last(own) <= STEADY * last(coarse);
    let coarse = chords(&groups);
    if size == 1 || steady(&own, &coarse) {
        let closing = if closed {
            (points[0] - points[points.len() - 1]).norm()
        } else {
            0.0
        };
        let end = last(&own) + closing;
        return (own, [0.0, end]);
    }
    // The centre of group k has index k·size + (size − 1)/2.
    let half = 0.5 * (size as f64 - 1.0);
    let at = |i: usize| {
        let place = (i as f64 - half) / size as f64;
        let k = (place.max(0.0) as usize).min(coarse.len() - 2);
        coarse[k] + (place - k as f64) * (coarse[k + 1] - coarse[k])
    };
    let begin = at(0);
    let parameters: Vec<f64> = (0..points.len()).map(|i| at(i) - begin).collect();
    let closing = if closed {
        (groups[0] - groups[groups.len() - 1]).norm() / size as f64
    } else {
        0.0
    };
    let end = last(&parameters) + closing;
    (parameters, [0.0, end])
}

/// Points that stand out from their neighbours so much that chords through
/// them would mislead: the loftsman's check by differences. Each point is
/// compared with the cubic through the two before and the two after it, on
/// even parameters; one that is off by many medians, and by more than its
/// neighbours, stands out; at the ends from the cubics of the inner ones. Only a suspicion: the fit decides.
pub(super) fn standing_out<const D: usize>(points: &[Vector<D>], closed: bool) -> Vec<usize> {
    /// Medians of the differences beyond which a point stands out.
    const MANY: f64 = 8.0;
    /// Noise of the inner difference, √(1 + 34/36), against that of the
    /// cubics next to an end, √(1 + 53/16), and at it, √70.
    const NEXT_TO_END: f64 = 0.67;
    const END: f64 = 0.167;
    /// Fewer points show no difference from their neighbours.
    const LEAST: usize = 9;
    let n = points.len();
    if n < LEAST {
        return Vec::new();
    }
    let at = |i: isize| points[i.rem_euclid(n as isize) as usize];
    let difference = |i: usize| {
        let k = i as isize;
        let inner = closed || (i >= 2 && i + 2 < n);
        // Inwards from an end.
        let way = if i < n / 2 { 1 } else { -1 };
        let (expected, along, share) = if inner {
            let between = (at(k - 1) + at(k + 1)) * 4.0 - at(k - 2) - at(k + 2);
            (between / 6.0, at(k + 1) - at(k - 1), 1.0)
        } else if i == 1 || i + 2 == n {
            let beyond = at(k + way) * 6.0 - at(k + 2 * way) * 4.0 + at(k + 3 * way);
            (
                (beyond + at(k - way)) / 4.0,
                at(k + way) - at(k - way),
                NEXT_TO_END,
            )
        } else {
            let inside = (at(k + way) + at(k + 3 * way)) * 4.0;
            let expected = inside - at(k + 2 * way) * 6.0 - at(k + 4 * way);
            (expected, at(k + way) - at(k + 2 * way), END)
        };
        let off = at(k) - expected;
        // Uneven spacing shows along the curve, a slip across it too; but an
        // end that folds back is one.
        if !inner && (at(k) - at(k + way)).dot(&(at(k + way) - at(k + 2 * way))) < 0.0 {
            return share * off.norm();
        }
        let q = along.norm_squared().max(f64::MIN_POSITIVE);
        share * (off - along * (along.dot(&off) / q)).norm()
    };
    let all: Vec<f64> = (0..n).map(difference).collect();
    let mut sorted: Vec<f64> = all.iter().copied().filter(|d| *d > 0.0).collect();
    if sorted.is_empty() {
        return Vec::new();
    }
    let middle = sorted.len() / 2;
    let median = *sorted.select_nth_unstable_by(middle, f64::total_cmp).1;
    let greatest = |i: usize| {
        let low = i.saturating_sub(2);
        all[low..(i + 3).min(n)].iter().all(|d| *d <= all[i])
    };
    (0..n)
        .filter(|i| all[*i] > MANY * median && greatest(*i))
        .collect()
}

/// [`ordered_parameters`] of the points but for some, which get the middle
/// between their neighbours.
pub(super) fn parameters_without<const D: usize>(
    points: &[Vector<D>],
    closed: bool,
    without: &[usize],
) -> (Vec<f64>, [f64; 2]) {
    let mut out = vec![false; points.len()];
    without.iter().for_each(|i| out[*i] = true);
    let kept: Vec<usize> = (0..points.len()).filter(|i| !out[*i]).collect();
    let places: Vec<Vector<D>> = kept.iter().map(|i| points[*i]).collect();
    let (u, domain) = ordered_parameters(&places, closed);
    let mut all = vec![0.0; points.len()];
    for (k, i) in kept.iter().enumerate() {
        all[*i] = u[k];
        let next = u.get(k + 1).copied().unwrap_or(domain[1]);
        let end = kept.get(k + 1).copied().unwrap_or(points.len());
        for (step, j) in (*i + 1..end).enumerate() {
            let share = (step + 1) as f64 / (end - i) as f64;
            all[j] = u[k] + share * (next - u[k]);
        }
    }
    (all, domain)
}

fn chords<const D: usize>(points: &[Vector<D>]) -> Vec<f64> {
    let mut sum = 0.0;
    let mut out = Vec::with_capacity(points.len());
    out.push(0.0);
    for w in points.windows(2) {
        sum += (w[1] - w[0]).norm();
        out.push(sum);
    }
    out
}

fn last(values: &[f64]) -> f64 {
    values.last().copied().unwrap_or(0.0)
}

/// Knots where the data are: `spans` spans with equally many points each;
/// `corners` are parameters of knuckles, where the curve is only continuous.
///
/// # Errors
/// As [`Space::open`].
pub(super) fn space_for(
    degree: usize,
    (parameters, domain, closed): (&[f64], [f64; 2], bool),
    spans: usize,
    breaks: &Breaks,
) -> Result<Space, SplineError> {
    let mut sorted = parameters.to_vec();
    sorted.sort_by(f64::total_cmp);
    let intervals = if closed {
        sorted.len()
    } else {
        sorted.len() - 1
    };
    let at = |place: f64| {
        let k = (place as usize).min(sorted.len() - 1);
        let next = sorted.get(k + 1).copied().unwrap_or(domain[1]);
        sorted[k] + (place - k as f64) * (next - sorted[k])
    };
    let even = (1..spans).map(|k| at(k as f64 * intervals as f64 / spans as f64));
    let inner = with_breaks(even.collect(), domain, breaks, degree);
    if closed {
        Space::closed(degree, domain, &inner)
    } else {
        Space::open(degree, domain, &inner)
    }
}

/// Parameters at which the knots are prescribed.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Breaks {
    /// Knuckles: the curve is only continuous there.
    pub(super) corners: Vec<f64>,
    /// Ends of straight stretches: a simple knot.
    pub(super) joints: Vec<f64>,
}

fn with_breaks(even: Vec<f64>, domain: [f64; 2], breaks: &Breaks, degree: usize) -> Vec<f64> {
    let close = SAME_KNOT * (domain[1] - domain[0]);
    let forced = |t: f64| {
        let all = breaks.corners.iter().chain(&breaks.joints);
        all.clone().any(|b| (t - b).abs() <= close)
    };
    let mut inner: Vec<f64> = even.into_iter().filter(|t| !forced(*t)).collect();
    for joint in &breaks.joints {
        let on_corner = breaks.corners.iter().any(|c| (c - joint).abs() <= close);
        if !on_corner {
            inner.push(*joint);
        }
    }
    inner.sort_by(f64::total_cmp);
    let mut kept: Vec<f64> = Vec::with_capacity(inner.len());
    for t in inner {
        let before = kept.last().copied().unwrap_or(domain[0]);
        if t - before > close && domain[1] - t > close {
            kept.push(t);
        }
    }
    for corner in &breaks.corners {
        kept.extend(std::iter::repeat_n(*corner, degree));
    }
    kept.sort_by(f64::total_cmp);
    kept
}
