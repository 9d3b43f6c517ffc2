//! From the request to a net in unit scale: its middle the origin and its mean
//! edge 1, so that every weight means the same on a dome in millimetres and a
//! deck in feet.

mod faults;
mod read;

use super::lines::through;
use super::net::Layout;
use super::request::{self, Input, Options, Request, USUAL_PATCHES};
use super::target::Target;
use crate::methods::{FitError, Issue};
use faults::{POINTS, VERTICES, indexed, issue, of_target_fault};
use nalgebra::{Point3, Vector3};
use read::{LEAST_SINE, NAMED, Read, from_grid, from_mesh};

/// A request that can be fitted.
#[derive(Debug, Clone)]
pub(super) struct Task {
    /// unit = (user − middle) / size.
    pub(super) middle: Vector3<f64>,
    pub(super) size: f64,
    pub(super) layout: Layout,
    /// The vertices in unit scale, row after row.
    pub(super) points: Vec<Point3<f64>>,
    /// Index in the request of each of them.
    pub(super) given: Vec<usize>,
    /// How often patches are split in four.
    pub(super) levels: Levels,
    /// What the net is held to instead of these vertices.
    pub(super) target: Option<Target>,
}

/// How often patches are split in four.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Levels {
    /// As often as asked.
    Asked(usize),
    /// As often as is usual, and once more where that is not fine enough and
    /// leaves the net small enough.
    Usual { count: usize, may_grow: bool },
}

impl Levels {
    /// The number.
    pub(super) fn count(self) -> usize {
        match self {
            Levels::Asked(count) | Levels::Usual { count, .. } => count,
        }
    }
}

/// More patches than these take minutes and say no more about a skin.
pub const MOST_PATCHES: usize = 16_384;

/// A net is split once more than usual up to so many.
const GROWN_PATCHES: usize = 4096;

/// A single quad split so often has the most patches.
const MOST_LEVELS: usize = 7;

/// A target further away than this, in mean edges, is another place or unit.
const FURTHEST_TARGET: f64 = 5.0;

/// The closeness may be so many times more or less than usual.
const CLOSENESS: f64 = 1e3;

impl Task {
    /// Reads a request.
    ///
    /// # Errors
    /// [`FitError::Invalid`] with every issue found.
    pub(super) fn new(request: &Request) -> Result<Self, FitError> {
        let mut issues = check_options(&request.options);
        let read = match &request.input {
            Input::Mesh(mesh) => from_mesh(mesh),
            Input::Grid(grid) => from_grid(grid),
        };
        let net = match read {
            Ok(net) => net,
            Err(found) => {
                issues.extend(found);
                return Err(FitError::Invalid(issues));
            }
        };
        let levels = levels(&request.options, net.layout, &mut issues);
        let task = net.in_unit_scale(levels, &mut issues);
        let target = request.options.target.as_ref();
        match task {
            Some(mut task) if issues.is_empty() => {
                target.map_or(Ok(()), |target| task.take_target(target))?;
                let closed = task.closed_vertices(&request.input);
                if closed.is_empty() {
                    Ok(task)
                } else {
                    Err(FitError::Invalid(closed))
                }
            }
            _ => Err(FitError::Invalid(issues)),
        }
    }

    /// Vertices at which the two lines through the points run into one.
    fn closed_vertices(&self, input: &Input) -> Vec<Issue> {
        let path = match input {
            Input::Mesh(_) => VERTICES,
            Input::Grid(_) => POINTS,
        };
        let start = through(self.layout, &self.points);
        let sines = start
            .vertices()
            .iter()
            .map(|k| k.du.cross(&k.dv).norm() / (k.du.norm() * k.dv.norm()));
        let closed = sines
            .zip(&self.given)
            .filter(|(sine, _)| sine.is_nan() || *sine < LEAST_SINE);
        let told = closed.take(NAMED).map(|(_, vertex)| {
            let message = format!(
                "at vertex {vertex} the two lines of the net run in one direction, so that the \
                 surface through it has no tangent plane there"
            );
            indexed(path, *vertex, "parallel-lines", message)
        });
        told.collect()
    }

    /// Lays the net onto a target.
    fn take_target(&mut self, target: &request::Target) -> Result<(), FitError> {
        let path = match target {
            request::Target::Mesh(_) => ["options", "target", "mesh"],
            request::Target::BSpline(_) => ["options", "target", "bspline"],
        };
        let refused = |found: Issue| FitError::Invalid(vec![found]);
        let target = Target::new(target, self.size, &self.middle)
            .map_err(|fault| refused(of_target_fault(path, &fault)))?;
        for (point, given) in self.points.iter_mut().zip(&self.given) {
            let foot = target.foot(point).point;
            let distance = (foot - *point).norm();
            if distance > FURTHEST_TARGET {
                let message = format!(
                    "the target is {:.3} away from vertex {given}, which is {distance:.1} mean \
                     edges of the net",
                    distance * self.size
                );
                let hint = Some("give the net and the target in one place and unit");
                return Err(refused(issue(&path, "target-too-far", message, hint)));
            }
            *point = foot;
        }
        let laid = Read {
            layout: self.layout,
            points: self.points.clone(),
            given: self.given.clone(),
            path,
        };
        if let Some(quad) = laid.degenerate_quads(1.0).first() {
            let message = format!("laid onto the target, {}", quad.message);
            return Err(refused(issue(&path, "target-beside-net", message, None)));
        }
        self.target = Some(target);
        Ok(())
    }

    /// A place in the user's scale.
    pub(super) fn to_user(&self, p: &Vector3<f64>) -> Vector3<f64> {
        p * self.size + self.middle
    }
}

fn levels(options: &Options, layout: Layout, issues: &mut Vec<Issue>) -> Levels {
    let [n, m] = layout.patch_counts();
    let patches = n.saturating_mul(m);
    let after = |count: usize| {
        let factor = u32::try_from(2 * count)
            .ok()
            .and_then(|s| 1_usize.checked_shl(s));
        factor.map_or(usize::MAX, |factor| patches.saturating_mul(factor))
    };
    let levels = match options.levels {
        Some(count) => Levels::Asked(count),
        None => {
            let count = (0..).find(|count| after(*count) >= USUAL_PATCHES);
            let count = count.unwrap_or(0);
            let may_grow = after(count + 1) <= GROWN_PATCHES;
            Levels::Usual { count, may_grow }
        }
    };
    if after(levels.count().min(MOST_LEVELS)) > MOST_PATCHES || levels.count() > MOST_LEVELS {
        let message = format!(
            "{patches} quads split {} times are more than the {MOST_PATCHES} patches that a net \
             may have",
            levels.count()
        );
        let path: &[&str] = match options.levels {
            Some(_) => &["options", "levels"],
            None => &["input"],
        };
        issues.push(issue(path, "too-many-patches", message, None));
    }
    levels
}

fn check_options(options: &Options) -> Vec<Issue> {
    let mut issues = Vec::new();
    let closeness = options.closeness;
    if !(1.0 / CLOSENESS..=CLOSENESS).contains(&closeness) {
        let message = format!(
            "closeness is {closeness}, outside {}..{CLOSENESS}",
            1.0 / CLOSENESS
        );
        issues.push(issue(
            &["options", "closeness"],
            "out-of-range",
            message,
            None,
        ));
    }
    for (k, distance) in options.offsets.iter().enumerate() {
        if !distance.is_finite() || *distance == 0.0 {
            let message = format!("offset {k} is {distance}: it must be a number other than 0");
            let mut found = issue(&["options", "offsets"], "out-of-range", message, None);
            found.path.push(k.to_string());
            issues.push(found);
        }
    }
    if let Some(supports) = options.supports
        && (!supports.height.is_finite() || supports.height == 0.0)
    {
        let message = format!(
            "the supports' height is {}: it must be a number other than 0",
            supports.height
        );
        issues.push(issue(
            &["options", "supports", "height"],
            "out-of-range",
            message,
            None,
        ));
    }
    let derived = [
        ("strips", !options.strips.is_empty()),
        ("offsets", !options.offsets.is_empty()),
        ("supports", options.supports.is_some()),
    ];
    for (name, asked) in derived {
        if asked && !options.cyclide {
            let message = format!("{name} are made from the cyclide spline, which is not asked");
            let hint = Some("set cyclide to true");
            issues.push(issue(&["options", name], "needs-cyclide", message, hint));
        }
    }
    issues
}
