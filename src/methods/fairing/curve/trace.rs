//! Unordered points: their order along a curve, whether it is closed, its
//! ends.
//!
//! 1. Means over the cells of a lattice, cells from fine to coarse.
//! 2. Their minimum spanning tree and the longest path in it. Cells finer
//!    than the noise give a tree full of twigs; the finest lattice whose tree
//!    is a path but for few points is taken.
//! 3. Every point is projected on the path near its cell; a spline through
//!    these parameters is fitted ([`super::free`]), the points are projected
//!    on it, and its arc length gives the parameters of the fit proper.
//!
//! A gap many times the widest expected makes parts, a long twig a branch:
//! both are named, as no single curve goes through such points.

use super::cells::{Cell, cells};
use super::extent::{Lengths, ends};
use super::free::{Shape, first_shape, settle};
use super::holds::Holds;
use super::slips::spread;
use super::solve::Traced;
use super::space::Vector;
use super::springs::Springs;
use super::start::{Breaks, space_for};
use super::tree::Tree;
use crate::methods::{FitError, Issue};
use crate::solver::Control;

/// Cells per side of the points' box, fine to coarse, in powers of √2.
const FINEST: i32 = 18;
const COARSEST: i32 = 4;
/// Most cells: Prim's algorithm is quadratic.
const MOST_CELLS: usize = 2500;
/// Mean number of points a cell must have before its mean says more than a
/// point, unless every point has a cell of its own.
const LEAST_POINTS: f64 = 1.0;
/// The same where slips are expected, whose cells are then almost empty: below
/// the usual number of points by this divisor.
const POINTS_OF_ROBUST: f64 = 6.0;
const LONELY: usize = 5;
/// Share of the points that may hang on twigs.
const TWIGS: f64 = 0.06;
/// A twig this many cells long with this share of the points is a branch.
const BRANCH_CELLS: f64 = 5.0;
const BRANCH_SHARE: f64 = 0.03;
/// The same where there is hardly another twig: no noise made it, and coarser
/// cells would only hide it.
const CLEAR_BRANCH_CELLS: f64 = 3.0;
const CLEAR_BRANCH_SHARE: f64 = 0.012;
/// A gap this many times the widest expected parts the points, if each part
/// has this share of them.
const PARTING_GAP: f64 = 4.0;
const PART_SHARE: f64 = 0.03;
/// The ends of the path of a closed curve are this near, in widest gaps.
const CLOSING_GAP: f64 = 2.5;
/// A path that comes back to its end after this many widest gaps branches
/// there.
const TAIL: f64 = 12.0;
/// Points farther off than this many deviations do not say where the end is.
const FAR: f64 = 5.0;
/// Spans of the first spline.
const FIRST_SPANS: usize = 48;

/// A path through cells.
struct Path<const D: usize> {
    nodes: Vec<Vector<D>>,
    /// For each point its position on the path, as an index of a node.
    near: Vec<usize>,
    side: f64,
    closed: bool,
    /// Points in cells almost empty.
    lonely: Vec<usize>,
    /// Share of the points on twigs.
    twigs: f64,
}

/// Why no single curve goes through the cells; `clear` if noise cannot be the
/// cause.
struct Obstacle {
    issue: Issue,
    clear: bool,
}

/// Orders points.
///
/// # Errors
/// [`FitError::Invalid`] where the points are in parts or branch; when the
/// control says stop.
pub(super) fn trace<const D: usize>(
    points: &[Vector<D>],
    degree: usize,
    (closed, robust): (Option<bool>, bool),
    control: &dyn Control,
) -> Result<Traced, FitError> {
    let path = find_path(points, (closed, robust), control)?;
    let (parameters, domain) = project(points, &path);
    let first = Traced {
        parameters,
        domain,
        closed: path.closed,
        doubtful: path.lonely,
    };
    refine(points, degree, &first, control)
}

fn find_path<const D: usize>(
    points: &[Vector<D>],
    (closed, robust): (Option<bool>, bool),
    control: &dyn Control,
) -> Result<Path<D>, FitError> {
    let mut best: Option<Path<D>> = None;
    let mut complaint = None;
    for power in (COARSEST..=FINEST).rev() {
        control.check()?;
        let side = 2f64.powf(-0.5 * f64::from(power));
        let mut all = cells(points, side);
        let count = all.len();
        let least = if robust {
            POINTS_OF_ROBUST
        } else {
            LEAST_POINTS
        };
        let dense = points.len() as f64 >= least * count as f64;
        if count > MOST_CELLS || !dense {
            continue;
        }
        if count < 4 && best.is_some() {
            break;
        }
        let lonely = if robust {
            take_lonely(&mut all)
        } else {
            Vec::new()
        };
        match through(&all, (points, lonely), side, closed) {
            Ok(path) if path.twigs <= TWIGS => return Ok(path),
            Ok(path) => {
                if best.as_ref().is_none_or(|b| path.twigs < b.twigs) {
                    best = Some(path);
                }
            }
            // Coarser cells would only hide it.
            Err(found) if found.clear => return Err(FitError::Invalid(vec![found.issue])),
            Err(found) => complaint = Some(found.issue),
        }
    }
    match (best, complaint) {
        (Some(path), None) => Ok(path),
        (_, Some(issue)) => Err(FitError::Invalid(vec![issue])),
        (None, None) => Err(FitError::Numerical("no path through the points".into())),
    }
}

/// The path through the cells of one lattice.
fn through<const D: usize>(
    all: &[Cell<D>],
    (points, lonely): (&[Vector<D>], Vec<usize>),
    side: f64,
    closed: Option<bool>,
) -> Result<Path<D>, Obstacle> {
    let count = points.len();
    let means: Vec<Vector<D>> = all.iter().map(|c| c.mean).collect();
    let tree = Tree::spanning(&means);
    let total: f64 = tree.edges().map(|e| e.2).sum();
    // Gaps of points strewn at random are exponential: the widest of n is
    // about ln n times the mean.
    let widest = (total / count as f64 * (count as f64).ln()).max(side);
    let parted = |issue| Obstacle { issue, clear: true };
    check_parts(all, &tree, count, PARTING_GAP * widest).map_err(parted)?;
    let nodes = tree.longest_path();
    let hung = tree.hang_on(&nodes);
    let mut near = vec![0; count];
    let mut twigs = 0;
    for (cell, (at, depth)) in all.iter().zip(&hung) {
        for i in &cell.points {
            near[*i] = *at;
        }
        if *depth > 0.0 {
            twigs += cell.points.len();
        }
    }
    check_branches(all, &hung, (count, twigs), widest)?;
    let path: Vec<Vector<D>> = nodes.iter().map(|k| means[*k]).collect();
    for i in &lonely {
        let distance = |k: &usize| (path[*k] - points[*i]).norm();
        let nearest = (0..path.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)));
        near[*i] = nearest.unwrap_or(0);
    }
    let gap = (path[0] - path[path.len() - 1]).norm();
    let loops = path.len() > 5 && gap <= CLOSING_GAP * widest && gap < 0.2 * total;
    if closed.is_none() && !loops {
        let clear = twigs as f64 <= TWIGS * count as f64;
        let tail = |issue| Obstacle { issue, clear };
        check_tails(all, &nodes, &path, widest).map_err(tail)?;
    }
    Ok(Path {
        lonely,
        near,
        side,
        closed: closed.unwrap_or(loops),
        twigs: twigs as f64 / count as f64,
        nodes: path,
    })
}

/// A twig too long for noise: clearly so where it is almost the only one.
fn check_branches<const D: usize>(
    all: &[Cell<D>],
    hung: &[(usize, f64)],
    (count, twigs): (usize, usize),
    widest: f64,
) -> Result<(), Obstacle> {
    // Points farther from the path than `least`, and all of the twigs that
    // these belong to.
    let beyond = |least: f64| {
        let mut roots: Vec<usize> = hung.iter().filter(|h| h.1 > least).map(|h| h.0).collect();
        roots.dedup();
        roots.sort_unstable();
        let (mut deep, mut whole) = (0, 0);
        for (cell, (at, depth)) in all.iter().zip(hung) {
            if *depth > least {
                deep += cell.points.len();
            }
            if *depth > 0.0 && roots.binary_search(at).is_ok() {
                whole += cell.points.len();
            }
        }
        (deep, whole)
    };
    let share = |points: usize| points as f64 / count as f64;
    let (deep, whole) = beyond(CLEAR_BRANCH_CELLS * widest);
    let clear = share(deep) > CLEAR_BRANCH_SHARE && share(twigs - whole) <= TWIGS;
    let (longer, _) = beyond(BRANCH_CELLS * widest);
    if clear || share(longer) > BRANCH_SHARE {
        let issue = branches(all, hung, whole.max(longer));
        return Err(Obstacle { issue, clear });
    }
    Ok(())
}

/// Removes the cells that hold far fewer points than others, and returns
/// their points.
fn take_lonely<const D: usize>(all: &mut Vec<Cell<D>>) -> Vec<usize> {
    let mut counts: Vec<usize> = all.iter().map(|c| c.points.len()).collect();
    counts.sort_unstable();
    // The points, not the cells, say what is usual: slips have cells of their
    // own.
    let total: usize = counts.iter().sum();
    let mut sum = 0;
    let usual = counts.iter().find(|c| {
        sum += **c;
        2 * sum >= total
    });
    let least = usual.copied().unwrap_or(0) / LONELY;
    let mut lonely = Vec::new();
    all.retain(|c| {
        let stays = c.points.len() > least;
        if !stays {
            lonely.extend_from_slice(&c.points);
        }
        stays
    });
    lonely
}

fn check_parts<const D: usize>(
    all: &[Cell<D>],
    tree: &Tree,
    count: usize,
    gap: f64,
) -> Result<(), Issue> {
    let size = |part: &Vec<usize>| part.iter().map(|k| all[*k].points.len()).sum::<usize>();
    let parts = tree.parts(gap);
    let large: Vec<&Vec<usize>> = parts
        .iter()
        .filter(|p| size(p) as f64 > PART_SHARE * count as f64 && size(p) > 2)
        .collect();
    if large.len() < 2 {
        return Ok(());
    }
    let sizes: Vec<String> = large.iter().map(|p| size(p).to_string()).collect();
    let one = |p: &Vec<usize>| all[p[0]].points[0];
    Err(Issue {
        path: vec!["input".into(), "points".into()],
        code: "several-parts",
        message: format!(
            "the points lie in {} parts of {} points; point {} belongs to one, point {} to another",
            large.len(),
            sizes.join(", "),
            one(large[0]),
            one(large[1])
        ),
        hint: Some("send one curve a request, or the points in their order".into()),
    })
}

/// An end of the path that touches its middle: a loop with a tail.
fn check_tails<const D: usize>(
    all: &[Cell<D>],
    nodes: &[usize],
    path: &[Vector<D>],
    widest: f64,
) -> Result<(), Issue> {
    let last = path.len() - 1;
    for (end, step) in [(0, 1_isize), (last, -1)] {
        let mut along = 0.0;
        let mut at = end as isize;
        while (0..=last as isize).contains(&(at + step)) {
            let next = (at + step) as usize;
            along += (path[next] - path[at as usize]).norm();
            at = next as isize;
            let across = (path[next] - path[end]).norm();
            let inner = next != 0 && next != last;
            if inner && along > TAIL * widest && across < 1.5 * widest {
                let count = nodes.iter().map(|k| all[*k].points.len()).sum();
                let hung: Vec<(usize, f64)> = (0..all.len())
                    .map(|k| (0, f64::from(u8::from(k == nodes[end]))))
                    .collect();
                return Err(branches(all, &hung, count));
            }
        }
    }
    Ok(())
}

fn branches<const D: usize>(all: &[Cell<D>], hung: &[(usize, f64)], count: usize) -> Issue {
    let deepest = hung
        .iter()
        .enumerate()
        .max_by(|a, b| a.1.1.total_cmp(&b.1.1))
        .map_or(0, |(k, _)| k);
    let tip = all[deepest].points[0];
    Issue {
        path: vec!["input".into(), "points".into(), tip.to_string()],
        code: "branch",
        message: format!(
            "the points branch: no single curve passes them; {count} of them, among them point \
             {tip}, lie on a side branch or on a loop with a tail"
        ),
        hint: Some("send one curve a request, or the points in their order".into()),
    }
}

/// A polygon with its lengths.
struct Line<'a, const D: usize> {
    nodes: &'a [Vector<D>],
    length: &'a [f64],
    closed: bool,
}

impl<const D: usize> Line<'_, D> {
    /// Length up to the nearest place to `p` within two sides of node `near`;
    /// beyond the ends of an open line on its last sides.
    fn nearest(&self, p: &Vector<D>, near: usize) -> f64 {
        const REACH: usize = 2;
        let last = self.nodes.len() - 2;
        let mut best = (f64::INFINITY, 0.0);
        for k in near.saturating_sub(REACH)..=(near + REACH).min(last) {
            let from = self.nodes[k];
            let along = self.nodes[k + 1] - from;
            let t = (p - from).dot(&along) / along.norm_squared();
            let ends = [k == 0 && !self.closed, k == last && !self.closed];
            let low = if ends[0] { f64::NEG_INFINITY } else { 0.0 };
            let high = if ends[1] { f64::INFINITY } else { 1.0 };
            let t = t.clamp(low, high);
            let distance = (p - (from + along * t)).norm();
            if distance < best.0 {
                best = (distance, self.length[k] + t * along.norm());
            }
        }
        best.1
    }
}

/// Parameters by projection on the path, near each point's cell; points
/// beyond an end get parameters beyond it.
fn project<const D: usize>(points: &[Vector<D>], path: &Path<D>) -> (Vec<f64>, [f64; 2]) {
    let mut nodes = path.nodes.clone();
    if path.closed {
        nodes.push(path.nodes[0]);
    }
    let mut length = vec![0.0];
    for w in nodes.windows(2) {
        length.push(length[length.len() - 1] + (w[1] - w[0]).norm());
    }
    let total = length[length.len() - 1];
    let line = Line {
        nodes: &nodes,
        length: &length,
        closed: path.closed,
    };
    let each = points.iter().zip(&path.near);
    let mut parameters: Vec<f64> = each.map(|(p, near)| line.nearest(p, *near)).collect();
    if path.closed {
        return (parameters, [0.0, total]);
    }
    // An end cell's mean lies half a cell inside; its points say how far out,
    // slips do not.
    let mut counts = vec![true; points.len()];
    path.lonely.iter().for_each(|i| counts[*i] = false);
    for (u, _) in parameters.iter_mut().zip(&counts).filter(|(_, c)| !**c) {
        *u = u.clamp(0.0, total);
    }
    let low = parameters
        .iter()
        .copied()
        .fold(0.0, f64::min)
        .max(-2.0 * path.side);
    let high = parameters
        .iter()
        .copied()
        .fold(total, f64::max)
        .min(total + 2.0 * path.side);
    for u in &mut parameters {
        *u = (*u - low).clamp(0.0, high - low);
    }
    (parameters, [0.0, high - low])
}

/// A first fit, and from it parameters near arc length.
fn refine<const D: usize>(
    points: &[Vector<D>],
    degree: usize,
    first: &Traced,
    control: &dyn Control,
) -> Result<Traced, FitError> {
    let intervals = if first.closed {
        points.len()
    } else {
        points.len() - 1
    };
    let least = if first.closed { 2 * degree + 2 } else { 1 };
    let spans = FIRST_SPANS.min(intervals).max(least);
    let data = (&first.parameters[..], first.domain, first.closed);
    let space = space_for(degree, data, spans, &Breaks::default())
        .map_err(|e| FitError::Numerical(e.to_string()))?;
    let mut weights = vec![1.0; points.len()];
    first.doubtful.iter().for_each(|i| weights[*i] = 0.0);
    let feet = first.parameters.clone();
    let mut springs = Springs::new(points.to_vec(), weights, feet, Vector::repeat(1.0));
    if !first.closed {
        springs.pin(extremes(&first.parameters, &springs.weights));
    }
    let broken = || FitError::Numerical("the points do not determine a curve".into());
    let mut shape = first_shape(space, &springs, None).ok_or_else(broken)?;
    settle(&mut shape, &mut springs, &mut Holds::none(), control)?;
    Ok(along_arc(first, &shape, springs))
}

/// Parameters by arc length of a first fit, points beyond its ends on the
/// tangents there.
fn along_arc<const D: usize>(first: &Traced, shape: &Shape<D>, mut springs: Springs<D>) -> Traced {
    // The pinned ends were a guess: now every point has a foot.
    springs.pinned.fill(false);
    let [a, b] = shape.space.domain();
    springs.refresh(&shape.space, &shape.x, 0.05 * (b - a));
    let lengths = Lengths::new(shape);
    let mut parameters: Vec<f64> = springs.feet.iter().map(|u| lengths.at(*u)).collect();
    if first.closed {
        let domain = [0.0, lengths.total()];
        return Traced {
            parameters,
            domain,
            closed: true,
            doubtful: first.doubtful.clone(),
        };
    }
    // Beyond the ends on the tangents.
    let residuals = springs.residuals(&shape.space, &shape.x);
    let curve = shape.space.pieces(&shape.x);
    for ((s, u), e) in parameters.iter_mut().zip(&springs.feet).zip(&residuals) {
        if *u <= a || *u >= b {
            let t = curve.jet::<2>(*u)[1];
            *s += e.dot(&t) / t.norm().max(f64::MIN_POSITIVE);
        }
    }
    let sizes: Vec<f64> = residuals.iter().map(Vector::norm).collect();
    let noise = spread::<D>(&sizes, &springs.weights);
    let certain = parameters.iter().zip(&springs.weights).zip(&sizes);
    let kept: Vec<f64> = certain
        .filter(|((_, w), size)| **w > 0.0 && **size < FAR * noise)
        .map(|((s, _), _)| *s)
        .collect();
    let kept = if kept.len() > 1 {
        kept
    } else {
        parameters.clone()
    };
    let domain = ends(&kept, noise);
    for s in &mut parameters {
        *s = s.clamp(domain[0], domain[1]);
    }
    Traced {
        parameters,
        domain,
        closed: false,
        doubtful: first.doubtful.clone(),
    }
}

fn extremes(parameters: &[f64], weights: &[f64]) -> [usize; 2] {
    let by = |a: &usize, b: &usize| parameters[*a].total_cmp(&parameters[*b]);
    let all = || (0..parameters.len()).filter(|i| weights[*i] > 0.0);
    [all().min_by(by).unwrap_or(0), all().max_by(by).unwrap_or(0)]
}
