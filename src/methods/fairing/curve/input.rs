//! From the request to points in unit scale: the longest side of their box is
//! 1 and its middle the origin, so that every constant means the same on a
//! kayak in millimetres and a tanker in feet. Points of space that lie in one
//! plane are fitted in that plane.

use super::checks::{Complaints, check_indices, check_kept, check_options, check_points};
use super::contradictions::check_contradictions;
use super::request::{Options, Request, Solver};
use super::space::Vector;
use crate::methods::FitError;
use nalgebra::{Point3, Vector3};

/// Points this near to a plane, as a share of the size, lie in it.
const COPLANAR: f64 = 1e-9;
/// Neighbours nearer than this share of the size are one point.
const REPEATED: f64 = 1e-12;
/// Chords that meet at the seam of a loop at a greater angle make a corner.
const SEAM_CORNER_DEG: f64 = 60.0;
/// Tolerances below this share of the size are 0: rounding.
const EXACT: f64 = 1e-9;

/// A Cartesian frame with a scale.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Frame {
    middle: Vector3<f64>,
    axes: [Vector3<f64>; 3],
    /// Length of 1 in the user's unit.
    pub(super) size: f64,
}

impl Frame {
    /// A point in unit scale.
    pub(super) fn enter<const D: usize>(&self, p: &Point3<f64>) -> Vector<D> {
        self.enter_direction(&((p.coords - self.middle) / self.size))
    }

    /// A direction, turned only.
    pub(super) fn enter_direction<const D: usize>(&self, v: &Vector3<f64>) -> Vector<D> {
        Vector::from_fn(|i, _| self.axes[i].dot(v))
    }

    /// A point of unit scale in the user's.
    pub(super) fn leave<const D: usize>(&self, v: &Vector<D>) -> Point3<f64> {
        let turned: Vector3<f64> = (0..D).map(|i| self.axes[i] * v[i]).sum();
        Point3::from(turned * self.size + self.middle)
    }

    /// A direction of unit scale in the user's frame.
    pub(super) fn leave_direction(&self, v: &Vector3<f64>) -> Vector3<f64> {
        (0..3).map(|i| self.axes[i] * v[i]).sum()
    }
}

/// What the frame of a request is: its dimension and whether it is turned.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Prepared {
    /// The frame.
    pub(super) frame: Frame,
    /// 2 or 3 after finding planes.
    pub(super) dimension: usize,
    /// Indices of the points that count, in their order.
    pub(super) kept: Vec<usize>,
    /// For every point of the request, the position in `kept` that stands for
    /// it.
    pub(super) stands_for: Vec<usize>,
    /// Whether the curve is closed, where that is known.
    pub(super) closed: Option<bool>,
    /// What the user should know.
    pub(super) warnings: Vec<String>,
}

/// A task in unit scale.
#[derive(Debug, Clone)]
pub(super) struct Task<const D: usize> {
    /// Points.
    pub(super) points: Vec<Vector<D>>,
    /// Tolerances; infinite where there is none, 0 where the point is locked.
    pub(super) tolerances: Vec<f64>,
    /// Relative weights of the springs.
    pub(super) weights: Vec<f64>,
    /// 1 for axes in which feet must agree with their points.
    pub(super) metric: Vector<D>,
    /// Positions of knuckles.
    pub(super) knuckles: Vec<usize>,
    /// Straight stretches, by position.
    pub(super) straight: Vec<[usize; 2]>,
    /// Unit tangents at the ends.
    pub(super) tangents: [Option<Vector<D>>; 2],
    /// Curvatures at the ends.
    pub(super) curvatures: [Option<f64>; 2],
}

impl<const D: usize> Task<D> {
    /// The task of a prepared request.
    pub(super) fn new(request: &Request, prepared: &Prepared) -> Self {
        let o = &request.options;
        let frame = &prepared.frame;
        let at = |i: &usize| prepared.stands_for[*i];
        let tolerance = |i: usize| {
            if o.locked.contains(&i) {
                return 0.0;
            }
            let own = o.tolerances.get(i).copied().or(o.tolerance);
            match own.map(|t| t / frame.size) {
                Some(t) if t <= EXACT => 0.0,
                Some(t) => t,
                None => f64::INFINITY,
            }
        };
        let unit = |v: Vector3<f64>| frame.enter_direction::<D>(&v).normalize();
        let mut free = [true; 3];
        free.copy_from_slice(&o.freedom);
        let metric = if free.iter().take(request.dimension).all(|f| *f) {
            Vector::repeat(1.0)
        } else {
            // The plane of a plane curve is then parallel to the axes.
            let fixed = Vector3::from_fn(|i, _| f64::from(u8::from(!free[i])));
            Vector::from_fn(|i, _| frame.axes[i].abs().dot(&fixed))
        };
        Task {
            points: prepared
                .kept
                .iter()
                .map(|i| frame.enter(&request.points[*i]))
                .collect(),
            tolerances: prepared.kept.iter().map(|i| tolerance(*i)).collect(),
            weights: prepared
                .kept
                .iter()
                .map(|i| o.stiffness.get(*i).copied().unwrap_or(1.0))
                .collect(),
            metric,
            knuckles: sorted(o.knuckles.iter().map(at)),
            straight: o.straight.iter().map(|[a, b]| [at(a), at(b)]).collect(),
            tangents: o.end_tangents.map(|t| t.map(unit)),
            curvatures: o.end_curvatures.map(|k| k.map(|k| k * frame.size)),
        }
    }

    /// Whether any point has a tolerance that is not 0.
    pub(super) fn has_tolerance(&self) -> bool {
        self.tolerances.iter().any(|t| t.is_finite() && *t > 0.0)
    }
}

fn sorted(values: impl Iterator<Item = usize>) -> Vec<usize> {
    let mut all: Vec<usize> = values.collect();
    all.sort_unstable();
    all.dedup();
    all
}

/// The degree asked, or the solver's own.
pub(super) fn degree_of(options: &Options) -> usize {
    options.degree.unwrap_or(match options.solver {
        Solver::Own => 5,
        Solver::Paper => 3,
    })
}

/// Reads a request.
///
/// # Errors
/// [`FitError::Invalid`] with every issue found.
pub(super) fn prepare(request: &Request) -> Result<Prepared, FitError> {
    let mut issues = Complaints(Vec::new());
    check_points(request, &mut issues);
    check_options(request, &mut issues);
    check_indices(request, &mut issues);
    if !issues.0.is_empty() {
        return Err(FitError::Invalid(issues.0));
    }
    let (frame, dimension) = frame_of(request);
    let mut prepared = Prepared {
        frame,
        dimension,
        kept: Vec::new(),
        stands_for: Vec::with_capacity(request.points.len()),
        closed: request.closed.or(request.ordered.then_some(false)),
        warnings: Vec::new(),
    };
    merge_repeated(request, &mut prepared);
    if prepared.kept.len() < 2 {
        issues.add(
            &["input", "points"],
            "too-few-points",
            format!(
                "{} point(s) given, all equal; a curve needs two",
                request.points.len()
            ),
            None,
        );
        return Err(FitError::Invalid(issues.0));
    }
    check_kept(request, &prepared, &mut issues);
    check_contradictions(request, &prepared, &mut issues);
    if issues.0.is_empty() {
        Ok(prepared)
    } else {
        Err(FitError::Invalid(issues.0))
    }
}

/// The frame of the points' box, turned into their plane if they have one.
fn frame_of(request: &Request) -> (Frame, usize) {
    let flat = |p: &Point3<f64>| match request.dimension {
        2 => Vector3::new(p.x, p.y, 0.0),
        _ => p.coords,
    };
    let (mut low, mut high) = (
        Vector3::repeat(f64::INFINITY),
        Vector3::repeat(f64::NEG_INFINITY),
    );
    for p in &request.points {
        low = low.inf(&flat(p));
        high = high.sup(&flat(p));
    }
    let size = (high - low).max();
    let frame = Frame {
        middle: 0.5 * (low + high),
        axes: [Vector3::x(), Vector3::y(), Vector3::z()],
        size: if size > 0.0 { size } else { 1.0 },
    };
    if request.dimension == 2 {
        return (frame, 2);
    }
    match plane_axes(request, &frame) {
        Some((axes, shift)) => {
            let middle = frame.middle + shift * frame.size;
            (
                Frame {
                    axes,
                    middle,
                    ..frame
                },
                2,
            )
        }
        None => (frame, 3),
    }
}

/// Axes of the plane that holds all points and end tangents; parallel to the
/// user's axes where the plane is, and only then if points are not free in
/// all directions. Also the way into the plane from the frame's middle, in
/// unit scale.
fn plane_axes(request: &Request, frame: &Frame) -> Option<([Vector3<f64>; 3], Vector3<f64>)> {
    let o = &request.options;
    let mut spread = nalgebra::Matrix3::zeros();
    let unit: Vec<Vector3<f64>> = request
        .points
        .iter()
        .map(|p| (p.coords - frame.middle) / frame.size)
        .collect();
    let mean = unit.iter().sum::<Vector3<f64>>() / unit.len() as f64;
    for v in &unit {
        spread += (v - mean) * (v - mean).transpose();
    }
    let eigen = spread.symmetric_eigen();
    let thinnest = eigen.eigenvalues.imin();
    let normal: Vector3<f64> = eigen.eigenvectors.column(thinnest).into();
    let flat = |n: &Vector3<f64>| {
        unit.iter().all(|v| n.dot(&(v - mean)).abs() <= COPLANAR)
            && o.end_tangents
                .iter()
                .flatten()
                .all(|t| n.dot(&t.normalize()).abs() <= COPLANAR)
    };
    let (x, y, z) = (Vector3::x(), Vector3::y(), Vector3::z());
    // The user's own planes first, so that signs of curvature mean the same.
    for axes in [[x, y, z], [x, z, -y], [y, z, x]] {
        if flat(&axes[2]) {
            return Some((axes, axes[2] * axes[2].dot(&mean)));
        }
    }
    if !flat(&normal) || !o.freedom.iter().all(|f| *f) {
        return None;
    }
    let other = if normal.x.abs() < 0.8 { x } else { y };
    let first = (other - normal * normal.dot(&other)).normalize();
    Some((
        [first, normal.cross(&first), normal],
        normal * normal.dot(&mean),
    ))
}

/// Drops points that repeat their forerunner, and the last one of a closed
/// curve that repeats the first.
fn merge_repeated(request: &Request, prepared: &mut Prepared) {
    let near = REPEATED * prepared.frame.size;
    let place = |i: usize| {
        let p = request.points[i];
        if request.dimension == 2 {
            Point3::new(p.x, p.y, 0.0)
        } else {
            p
        }
    };
    let mut repeated = Vec::new();
    for i in 0..request.points.len() {
        match prepared.kept.last() {
            Some(last) if request.ordered && (place(i) - place(*last)).norm() <= near => {
                repeated.push(i);
            }
            _ => prepared.kept.push(i),
        }
        prepared.stands_for.push(prepared.kept.len() - 1);
    }
    if let Some(first) = repeated.first() {
        prepared.warnings.push(format!(
            "/input/points/{first} repeats the point before it{}; such points count once.",
            if repeated.len() > 1 {
                format!(" (as do {} more)", repeated.len() - 1)
            } else {
                String::new()
            }
        ));
    }
    let count = prepared.kept.len();
    let ends_meet =
        count > 3 && (place(prepared.kept[0]) - place(prepared.kept[count - 1])).norm() <= near;
    if !request.ordered || !ends_meet || request.closed == Some(false) {
        return;
    }
    if request.closed.is_none() {
        let chord = |a: usize, b: usize| place(prepared.kept[b]) - place(prepared.kept[a]);
        let turn = chord(0, 1).angle(&chord(count - 2, count - 1)).to_degrees();
        if turn > SEAM_CORNER_DEG {
            prepared.warnings.push(format!(
                "The last point repeats the first and the curve turns by {turn:.0}° there: it is \
                 taken as open, with its ends in one corner; say closed: true to round it."
            ));
            return;
        }
        prepared.closed = Some(true);
        prepared.warnings.push(
            "The last point repeats the first: the curve is taken as closed and smooth there; \
             say closed: false to keep a corner."
                .into(),
        );
    }
    prepared.kept.pop();
    for slot in &mut prepared.stands_for {
        if *slot == count - 1 {
            *slot = 0;
        }
    }
}
