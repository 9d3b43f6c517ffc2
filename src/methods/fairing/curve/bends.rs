//! What looks like a slip and is shape. Slips stand alone; a bend that the
//! curve does not follow, such as a nose or the ending of a waterline, puts a
//! run of neighbours off, each about as much as the next. And points that lie
//! exactly in one line do not all err alike: they mark an edge, a flat or the
//! zeros beyond the end of a waterline.

use super::space::Vector;
use super::springs::Springs;

/// Points in a row that make a run.
const RUN: usize = 3;
/// Points next to an end, and how many of them make a bend: it has one side
/// only there.
const NEXT_TO_END: usize = 4;
const BEND_AT_END: usize = 2;
/// Neighbours of a bend differ by at most this share of the larger; slips that
/// happen to be neighbours have nothing to do with one another.
const FOLLOWS: f64 = 0.75;
/// Points are in line if they are off by no more than this share of their
/// distance: rounding.
const IN_LINE: f64 = 1e-12;

/// For each of the points found, whether it is part of a bend or of a row in
/// line. `away`: how far each point is from where the others have it.
pub(super) fn bends<const D: usize>(
    found: &[usize],
    springs: &Springs<D>,
    (away, closed): (&[Vector<D>], bool),
) -> Vec<bool> {
    let n = springs.feet.len();
    let mut along: Vec<usize> = (0..n).collect();
    along.sort_by(|a, b| springs.feet[*a].total_cmp(&springs.feet[*b]).then(a.cmp(b)));
    let mut off = vec![false; n];
    found.iter().for_each(|i| off[*i] = true);
    let mut bent = vec![false; n];
    for run in along.chunk_by(|a, b| off[*a] == off[*b]) {
        if off[run[0]] && longest(run, away) >= RUN {
            run.iter().for_each(|i| bent[*i] = true);
        }
    }
    let few = NEXT_TO_END.min(n);
    for end in [&along[..few], &along[n - few..]] {
        let there = end.iter().filter(|i| off[**i]).count();
        if !closed && there >= BEND_AT_END {
            end.iter().for_each(|i| bent[*i] = true);
        }
    }
    for row in along.windows(RUN) {
        if row.iter().any(|i| off[*i]) && in_line(row, &springs.points) {
            row.iter().for_each(|i| bent[*i] = true);
        }
    }
    found.iter().map(|i| bent[*i]).collect()
}

/// Points of the longest part of a run that follow on one another.
fn longest<const D: usize>(run: &[usize], away: &[Vector<D>]) -> usize {
    let follows = |a: &usize, b: &usize| {
        let [a, b] = [away[*a], away[*b]];
        (a - b).norm() <= FOLLOWS * a.norm().max(b.norm())
    };
    run.chunk_by(follows).map(<[usize]>::len).max().unwrap_or(0)
}

fn in_line<const D: usize>(row: &[usize], points: &[Vector<D>]) -> bool {
    let (a, b, c) = (points[row[0]], points[row[1]], points[row[2]]);
    let (ab, ac) = (b - a, c - a);
    let off = ab - ac * (ab.dot(&ac) / ac.norm_squared().max(f64::MIN_POSITIVE));
    off.norm() <= IN_LINE * ac.norm()
}
