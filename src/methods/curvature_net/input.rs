//! From the request to a net in unit scale: its middle the origin and its mean
//! edge 1, so that every weight means the same on a dome in millimetres and a
//! deck in feet.

use super::net::Layout;
use super::request::{self, Grid, Input, Options, QuadMesh, Request, USUAL_PATCHES};
use super::target::{Fault, Target};
use crate::geometry::mesh::{Face, Manifold, Mesh, MeshError, MeshFault, QuadGrid, QuadGridFault};
use crate::methods::{FitError, Issue};
use nalgebra::{Point3, Vector3};

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
/// Edges shorter than this share of the mean are mistakes.
const SHORTEST_EDGE: f64 = 1e-6;
/// Least sine of the angle between two sides at a corner: below, two lines of
/// the net fall into one. About half a degree.
const LEAST_SINE: f64 = 0.01;
/// Of a long list of faults the first that many are named.
const NAMED: usize = 20;
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
                Ok(task)
            }
            _ => Err(FitError::Invalid(issues)),
        }
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

/// A net in the user's scale.
struct Read {
    layout: Layout,
    points: Vec<Point3<f64>>,
    given: Vec<usize>,
    /// Where the vertices stand in the request.
    path: [&'static str; 3],
}

fn issue(path: &[&str], code: &'static str, message: String, hint: Option<&str>) -> Issue {
    Issue {
        path: path.iter().map(|p| (*p).to_owned()).collect(),
        code,
        message,
        hint: hint.map(str::to_owned),
    }
}

fn indexed(path: [&str; 3], index: usize, code: &'static str, message: String) -> Issue {
    let mut found = issue(&path, code, message, None);
    found.path.push(index.to_string());
    found
}

const VERTICES: [&str; 3] = ["input", "mesh", "vertices"];
const FACES: [&str; 3] = ["input", "mesh", "faces"];
const POINTS: [&str; 3] = ["input", "grid", "points"];

/// Rows and columns of a mesh, or why it has none.
fn from_mesh(mesh: &QuadMesh) -> Result<Read, Vec<Issue>> {
    let mut issues = Vec::new();
    let mut faces = Vec::with_capacity(mesh.faces.len());
    for (f, corners) in mesh.faces.iter().enumerate() {
        match Face::of(corners) {
            Some(face) if corners.len() == 4 => faces.push(face),
            _ => issues.push(indexed(
                FACES,
                f,
                "not-a-quad",
                format!(
                    "face {f} has {} corners: only quads make rows and columns",
                    corners.len()
                ),
            )),
        }
    }
    issues.truncate(NAMED);
    if !issues.is_empty() {
        return Err(issues);
    }
    let built = Mesh::new(mesh.vertices.clone(), faces).map_err(|e| vec![of_mesh_error(&e)])?;
    let unused = unused_vertices(&built);
    if !unused.is_empty() {
        return Err(unused);
    }
    let surface = Manifold::of(built).map_err(|e| vec![of_mesh_fault(&e)])?;
    let grid = QuadGrid::of(&surface).map_err(|e| of_grid_fault(&e))?;
    Ok(Read {
        layout: Layout {
            rows: grid.rows,
            columns: grid.columns,
            closed: grid.closed,
        },
        points: grid.vertices.iter().map(|v| mesh.vertices[*v]).collect(),
        given: grid.vertices,
        path: VERTICES,
    })
}

fn unused_vertices(mesh: &Mesh) -> Vec<Issue> {
    let mut used = vec![false; mesh.vertices().len()];
    let corners = mesh.faces().iter().flat_map(|f| f.corners());
    corners.for_each(|v| used[*v] = true);
    let unused = used.iter().enumerate().filter(|(_, used)| !**used);
    let told = unused.take(NAMED).map(|(v, _)| {
        let message = format!("vertex {v} belongs to no face");
        indexed(VERTICES, v, "unused-vertex", message)
    });
    told.collect()
}

fn of_mesh_error(error: &MeshError) -> Issue {
    let message = error.to_string();
    match error {
        MeshError::NotFinite { vertex } => indexed(VERTICES, *vertex, "not-finite", message),
        MeshError::OutOfRange { face, .. } => indexed(FACES, *face, "no-such-vertex", message),
        MeshError::RepeatedCorner { face, .. } => indexed(FACES, *face, "degenerate-quad", message),
    }
}

fn of_target_fault(path: [&str; 3], fault: &Fault) -> Issue {
    let in_list = |list: &str, index: usize, code, message: String| {
        let mut found = issue(&path, code, message, None);
        found.path.extend([list.to_owned(), index.to_string()]);
        found
    };
    match fault {
        Fault::Empty => issue(
            &path,
            "no-faces",
            "the target has no faces".to_owned(),
            None,
        ),
        Fault::Corners { face, corners } => {
            let message = format!("face {face} has {corners} corners, not three or four");
            in_list("faces", *face, "wrong-corners", message)
        }
        Fault::Mesh(error) => match error {
            MeshError::NotFinite { vertex } => {
                in_list("vertices", *vertex, "not-finite", error.to_string())
            }
            MeshError::OutOfRange { face, .. } => {
                in_list("faces", *face, "no-such-vertex", error.to_string())
            }
            MeshError::RepeatedCorner { face, .. } => {
                in_list("faces", *face, "repeated-corner", error.to_string())
            }
        },
    }
}

fn of_mesh_fault(fault: &MeshFault) -> Issue {
    let message = fault.to_string();
    match fault {
        MeshFault::NonManifoldEdge { face, .. } => indexed(FACES, *face, "not-a-surface", message),
        MeshFault::NotOrientable { face, .. } => indexed(FACES, *face, "one-sided", message),
        MeshFault::NonManifoldVertex { vertex, .. } => {
            indexed(VERTICES, *vertex, "not-a-surface", message)
        }
        _ => issue(&FACES, "not-a-surface", message, None),
    }
}

fn of_grid_fault(fault: &QuadGridFault) -> Vec<Issue> {
    let at = |v: usize, code| indexed(VERTICES, v, code, String::new());
    let (mut first, hint) = match fault {
        QuadGridFault::NotAQuad { face, .. } => {
            (indexed(FACES, *face, "not-a-quad", String::new()), None)
        }
        QuadGridFault::Parts { face, .. } => (
            indexed(FACES, *face, "several-parts", String::new()),
            Some("send each part as a job of its own"),
        ),
        QuadGridFault::Singular { vertices } => (
            at(vertices[0].0, "singular-vertex"),
            Some("cut the mesh along its lines through these vertices into regular parts"),
        ),
        QuadGridFault::Ragged { vertices } => (
            at(vertices[0].0, "ragged-boundary"),
            Some("end all rows, and all columns, on one line of the net"),
        ),
        QuadGridFault::Loops { starts } => (
            at(starts[0], "several-loops"),
            Some("cut the mesh along its lines into sheets or tubes"),
        ),
        QuadGridFault::Corners { corners, .. } => {
            let first = corners.first().copied();
            let unnamed = issue(&FACES, "wrong-corners", String::new(), None);
            (first.map_or(unnamed, |v| at(v, "wrong-corners")), None)
        }
        QuadGridFault::Spiral { vertex } => (
            at(*vertex, "spiral"),
            Some("cut the mesh along a line of the net"),
        ),
        QuadGridFault::Short { vertex, .. } => (at(*vertex, "short-round"), None),
    };
    first.message = fault.to_string();
    first.hint = hint.map(str::to_owned);
    vec![first]
}

/// The rows of a grid, or what is wrong with them.
fn from_grid(grid: &Grid) -> Result<Read, Vec<Issue>> {
    let mut issues = Vec::new();
    let sides = [("rows", grid.rows), ("columns", grid.columns)];
    for ((name, count), closed) in sides.into_iter().zip(grid.closed) {
        let least = if closed { 3 } else { 2 };
        if count < least {
            let message = format!("the grid has {count} {name}, but {least} are needed");
            issues.push(issue(&["input", "grid", name], "too-small", message, None));
        }
    }
    let wanted = grid.rows.checked_mul(grid.columns);
    if wanted != Some(grid.points.len()) {
        let message = format!(
            "{} rows of {} points are not {} points",
            grid.rows,
            grid.columns,
            grid.points.len()
        );
        issues.push(issue(&POINTS, "wrong-count", message, None));
    }
    for (k, p) in grid.points.iter().enumerate() {
        if p.iter().any(|x| !x.is_finite()) && issues.len() < NAMED {
            let message = format!("point {k} has a coordinate that is not a finite number");
            issues.push(indexed(POINTS, k, "not-finite", message));
        }
    }
    if !issues.is_empty() {
        return Err(issues);
    }
    Ok(Read {
        layout: Layout {
            rows: grid.rows,
            columns: grid.columns,
            closed: grid.closed,
        },
        points: grid.points.clone(),
        given: (0..grid.points.len()).collect(),
        path: POINTS,
    })
}

impl Read {
    fn in_unit_scale(self, levels: Levels, issues: &mut Vec<Issue>) -> Option<Task> {
        let count = self.points.len() as f64;
        let middle = self
            .points
            .iter()
            .fold(Vector3::zeros(), |m, p| m + p.coords / count);
        let edges: Vec<f64> = [0, 1]
            .into_iter()
            .flat_map(|d| self.layout.edges(d))
            .map(|[a, b]| (self.points[b] - self.points[a]).norm())
            .collect();
        let size = edges.iter().map(|e| e / edges.len() as f64).sum::<f64>();
        if !(size > 0.0 && size.is_finite() && middle.iter().all(|x| x.is_finite())) {
            let message = format!("the mean length of an edge is {size}");
            issues.push(issue(&self.path[..2], "no-extent", message, None));
            return None;
        }
        issues.extend(self.degenerate_quads(size));
        let unit = |p: &Point3<f64>| Point3::from((p.coords - middle) / size);
        Some(Task {
            points: self.points.iter().map(unit).collect(),
            middle,
            size,
            layout: self.layout,
            given: self.given,
            levels,
            target: None,
        })
    }

    /// Quads with a side of no length or two sides on one another.
    fn degenerate_quads(&self, size: f64) -> Vec<Issue> {
        let bad = self.layout.patches().filter_map(|(i, j)| {
            let [a, b, d, c] = self.layout.corners(i, j);
            self.fault_of_quad([a, b, c, d], size)
        });
        bad.take(NAMED).collect()
    }

    fn fault_of_quad(&self, ring: [usize; 4], size: f64) -> Option<Issue> {
        let name = ring.map(|k| self.given[k]);
        let quad = format!(
            "the quad of the vertices {}, {}, {}, {}",
            name[0], name[1], name[2], name[3]
        );
        for k in 0..4 {
            let [before, here, after] = [(k + 3) % 4, k, (k + 1) % 4];
            let p = |at: usize| self.points[ring[at]].coords / size;
            let (on, back) = (p(after) - p(here), p(before) - p(here));
            if on.norm() <= SHORTEST_EDGE {
                let message = format!(
                    "{quad} has a side without length, between the vertices {} and {}",
                    name[here], name[after]
                );
                return Some(indexed(self.path, name[here], "degenerate-quad", message));
            }
            let sine = on.cross(&back).norm() / (on.norm() * back.norm());
            if sine.is_nan() || sine < LEAST_SINE {
                let message = format!(
                    "{quad} has collapsed: its sides at vertex {} lie in one line",
                    name[here]
                );
                return Some(indexed(self.path, name[here], "degenerate-quad", message));
            }
        }
        None
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
