//! Triangles between profile curves, watertight along every shared chine.
//!
//! Two plates meet at a profile, and each brings its own ruling ends there.
//! Meshed one by one they would leave slits. So the vertices of a profile are
//! the *union* of both plates' ruling ends, and either plate is triangulated
//! with all of them: between two neighbouring rulings lies a cell with the
//! rulings as two of its edges, and whatever vertices the neighbours brought
//! in between lie on the other two.
//!
//! Limits: ruling ends are put in order by their distance from the vertex
//! before, which is right as long as a profile does not turn by more than a
//! right angle between two neighbouring ruling ends. Where it does, the mesh
//! stays watertight but may fold there.

use super::plates::{HullDrawing, PlateDrawing, model_size};
use nalgebra::{Point3, Vector3};
use std::collections::BTreeMap;

/// Ruling ends nearer than this share of the model size are one vertex: far
/// above the rounding of an evaluated spline (1e-15), far below the accuracy
/// of a boundary (1e-6).
const WELD: f64 = 1e-9;

/// Triangles of all plates over one list of vertices.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct HullMesh {
    /// Vertices, profile after profile.
    pub vertices: Vec<Point3<f64>>,
    /// The plates in order; the winding is
    /// the same throughout, with the outside of a hull in front when its
    /// profiles run forward, from the deck down, on the side of positive y.
    pub plates: Vec<PlateMesh>,
}

/// The triangles of a plate.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct PlateMesh {
    /// As indices into the vertices of the hull.
    pub triangles: Vec<[usize; 3]>,
    /// The twist at each of its vertices, signed, degrees: that of the ruling
    /// that ends there, and between two rulings by the length of the profile.
    /// Where several rulings end (in the tip of a fan), the largest.
    pub twists: BTreeMap<usize, f64>,
}

/// Meshes a hull. Rulings that are not finite are left out.
pub(super) fn mesh(hull: &HullDrawing) -> HullMesh {
    let weld = WELD * model_size(hull);
    let mut builder = Builder {
        vertices: Vec::new(),
        weld,
    };
    let ends: Vec<Ends> = hull.plates.iter().map(Ends::of).collect();
    let mut from_indices: Vec<Vec<usize>> = vec![Vec::new(); ends.len()];
    let mut to_indices = from_indices.clone();
    for profile in 0..=ends.len() {
        let above = profile.checked_sub(1).map_or(&[][..], |k| &ends[k].to);
        let below = ends.get(profile).map_or(&[][..], |e| &e.from);
        let [of_above, of_below] = builder.profile(above, below);
        if let Some(k) = profile.checked_sub(1) {
            to_indices[k] = of_above;
        }
        if let Some(indices) = from_indices.get_mut(profile) {
            *indices = of_below;
        }
    }
    let canonical = builder.weld_tips(&from_indices, &to_indices);
    let plates = (ends.iter().zip(from_indices.iter().zip(&to_indices)))
        .map(|(ends, (from, to))| builder.strip([from, to], &ends.twists, &canonical))
        .collect();
    HullMesh {
        vertices: builder.vertices,
        plates,
    }
}

/// The two lists of ruling ends of one plate, and the rulings' twists.
struct Ends {
    from: Vec<Point3<f64>>,
    to: Vec<Point3<f64>>,
    twists: Vec<f64>,
}

impl Ends {
    fn of(plate: &PlateDrawing) -> Ends {
        let rulings = || plate.rulings.iter().filter(|r| r.is_finite());
        Ends {
            from: rulings().map(|r| r.from).collect(),
            to: rulings().map(|r| r.to).collect(),
            twists: rulings().map(|r| r.twist_deg).collect(),
        }
    }
}

impl PlateMesh {
    fn note(&mut self, vertex: usize, twist: f64) {
        let known = self.twists.entry(vertex).or_insert(twist);
        if twist.abs() > known.abs() {
            *known = twist;
        }
    }
}

/// Vertices found so far.
struct Builder {
    vertices: Vec<Point3<f64>>,
    /// Distance below which two ruling ends are one vertex.
    weld: f64,
}

impl Builder {
    /// Adds the vertices of one profile in order along it and tells for each
    /// end of either plate which vertex it became (non-decreasing).
    fn profile(&mut self, a: &[Point3<f64>], b: &[Point3<f64>]) -> [Vec<usize>; 2] {
        let mut indices = [Vec::with_capacity(a.len()), Vec::with_capacity(b.len())];
        let first = self.vertices.len();
        while indices[0].len() < a.len() || indices[1].len() < b.len() {
            let heads = [a.get(indices[0].len()), b.get(indices[1].len())];
            let last =
                (self.vertices.len() > first).then(|| self.vertices[self.vertices.len() - 1]);
            let side = match heads {
                [Some(p), Some(q)] => usize::from(!comes_first(p, q, last, [a, b])),
                [Some(_), None] => 0,
                _ => 1,
            };
            let Some(point) = heads[side] else { break };
            let merges = last.is_some_and(|l| (point - l).norm() <= self.weld);
            if !merges {
                self.vertices.push(*point);
            }
            indices[side].push(self.vertices.len() - 1);
        }
        indices
    }

    /// Profiles that meet in a tip bring one vertex each to the same place:
    /// maps every vertex to the first one there. Only ends of one and the same
    /// ruling can meet so.
    fn weld_tips(&self, from: &[Vec<usize>], to: &[Vec<usize>]) -> Vec<usize> {
        let mut canonical: Vec<usize> = (0..self.vertices.len()).collect();
        let pairs = from.iter().zip(to).flat_map(|(f, t)| f.iter().zip(t));
        for (&f, &t) in pairs {
            if (self.vertices[f] - self.vertices[t]).norm() <= self.weld {
                canonical[t] = canonical[f];
            }
        }
        canonical
    }

    /// Triangles of one plate, cell by cell between neighbouring rulings.
    fn strip(&self, [from, to]: [&[usize]; 2], twists: &[f64], canonical: &[usize]) -> PlateMesh {
        let mut triangles = Vec::new();
        let mut plate = PlateMesh::default();
        let rulings = from.windows(2).zip(to.windows(2)).zip(twists.windows(2));
        for ((f, t), twist) in rulings {
            self.cell([f[0], f[1]], [t[0], t[1]], &mut triangles);
            for range in [[f[0], f[1]], [t[0], t[1]]] {
                for (vertex, share) in (range[0]..).zip(self.shares(range)) {
                    let here = twist[0] + share * (twist[1] - twist[0]);
                    plate.note(canonical[vertex], here);
                }
                // A side that stays in one vertex has the later twist too.
                plate.note(canonical[range[1]], twist[1]);
            }
        }
        let welded = triangles.into_iter().map(|t| t.map(|i| canonical[i]));
        plate.triangles = welded
            .filter(|[a, b, c]| a != b && b != c && c != a)
            .collect();
        plate
    }

    /// Triangulates one cell: the vertices `f[0]..=f[1]` of one profile against
    /// `t[0]..=t[1]` of the other, stepping on along the side that lags behind.
    fn cell(&self, f: [usize; 2], t: [usize; 2], triangles: &mut Vec<[usize; 3]>) {
        let shares = [self.shares(f), self.shares(t)];
        let (mut i, mut j) = (0, 0);
        while i + 1 < shares[0].len() || j + 1 < shares[1].len() {
            let next = |side: usize, at: usize| shares[side].get(at + 1).copied();
            let step_on_first = match (next(0, i), next(1, j)) {
                (Some(s), Some(t)) => s <= t,
                (first, _) => first.is_some(),
            };
            if step_on_first {
                triangles.push([f[0] + i, f[0] + i + 1, t[0] + j]);
                i += 1;
            } else {
                triangles.push([f[0] + i, t[0] + j + 1, t[0] + j]);
                j += 1;
            }
        }
    }

    /// Share of the way along the vertices `range[0]..=range[1]`, 0 to 1, for
    /// each of them.
    fn shares(&self, range: [usize; 2]) -> Vec<f64> {
        let points = &self.vertices[range[0]..=range[1]];
        let mut travelled = vec![0.0];
        let mut sum = 0.0;
        for pair in points.windows(2) {
            sum += (pair[1] - pair[0]).norm();
            travelled.push(sum);
        }
        // A single vertex has nowhere to go; its share is 0 whatever the sum.
        let whole = if sum > 0.0 { sum } else { 1.0 };
        travelled.iter().map(|way| way / whole).collect()
    }
}

/// Whether `p`, the next end of list `a`, comes before `q`, the next of `b`:
/// the one nearer to the vertex before, or at the very start the one that lies
/// behind the other in the direction of the curves.
fn comes_first(
    p: &Point3<f64>,
    q: &Point3<f64>,
    last: Option<Point3<f64>>,
    [a, b]: [&[Point3<f64>]; 2],
) -> bool {
    match last {
        Some(last) => (p - last).norm() <= (q - last).norm(),
        None => {
            let direction = heading(a) + heading(b);
            (q - p).dot(&direction) >= 0.0
        }
    }
}

/// Unit vector in which a list of points sets out; zero when it stays put.
fn heading(points: &[Point3<f64>]) -> Vector3<f64> {
    let steps = points.iter().map(|p| p - points[0]);
    steps
        .filter_map(|step| step.try_normalize(0.0))
        .next()
        .unwrap_or_else(Vector3::zeros)
}

#[cfg(test)]
mod tests {
    use super::super::plates::{ProfileLine, RulingLine};
    use super::*;
    use std::collections::HashMap;

    type Curve = fn(f64) -> Point3<f64>;

    fn upper(x: f64) -> Point3<f64> {
        Point3::new(x, 2.0 - x * x / 200.0, 3.0 + 0.1 * x)
    }
    fn chine(x: f64) -> Point3<f64> {
        Point3::new(x, 1.8 - x * x / 150.0, 1.0 + 0.05 * x)
    }
    fn keel(x: f64) -> Point3<f64> {
        Point3::new(x, 0.0, 0.2 * (x / 10.0).powi(2))
    }

    fn plate(from: Curve, to: Curve, at: &[(f64, f64)]) -> PlateDrawing {
        let ruling = |&(s, t): &(f64, f64)| RulingLine {
            u: s,
            from: from(s),
            to: to(t),
            twist_deg: 0.0,
            bend_radius_from: 1.0,
            bend_radius_to: 1.0,
        };
        PlateDrawing {
            name: "p".into(),
            rulings: at.iter().map(ruling).collect(),
            rolls: Vec::new(),
            within_limits: true,
        }
    }

    fn hull(plates: Vec<PlateDrawing>) -> HullDrawing {
        let line = ProfileLine {
            name: "l".into(),
            points: vec![upper(0.0), upper(10.0)],
        };
        HullDrawing {
            title: "t".into(),
            units: "m".into(),
            twist_limit_deg: 6.0,
            plates,
            profiles: vec![line],
            verdict: "v".into(),
            summary: Vec::new(),
        }
    }

    /// How often each directed edge is used.
    fn directed_edges(mesh: &HullMesh) -> HashMap<(usize, usize), usize> {
        let mut count = HashMap::new();
        for [a, b, c] in mesh.plates.iter().flat_map(|p| &p.triangles) {
            for edge in [(*a, *b), (*b, *c), (*c, *a)] {
                *count.entry(edge).or_insert(0) += 1;
            }
        }
        count
    }

    fn assert_sound(mesh: &HullMesh) {
        let edges = directed_edges(mesh);
        assert!(
            edges.values().all(|n| *n == 1),
            "an edge is used twice the same way round"
        );
        for t in mesh.plates.iter().flat_map(|p| &p.triangles) {
            let [a, b, c] = t.map(|i| mesh.vertices[i]);
            assert!(
                (b - a).cross(&(c - a)).norm() > 1e-12,
                "degenerate triangle {t:?}"
            );
        }
    }

    /// Edges with a triangle on one side only, that lie on the chine.
    fn slits(mesh: &HullMesh) -> usize {
        let edges = directed_edges(mesh);
        let on_chine = |i: usize| {
            let p = mesh.vertices[i];
            (p - chine(p.x)).norm() < 1e-9
        };
        edges
            .keys()
            .filter(|(a, b)| on_chine(*a) && on_chine(*b) && !edges.contains_key(&(*b, *a)))
            .count()
    }

    #[test]
    fn different_rulings_share_a_chine_without_slits() {
        let above: Vec<(f64, f64)> = (0..=37)
            .map(|i| f64::from(i) / 3.7)
            .map(|x| (x, x))
            .collect();
        let below: Vec<(f64, f64)> = (0..=53)
            .map(|i| f64::from(i) / 5.3)
            .map(|x| (x * x / 10.0, x))
            .collect();
        let mesh = mesh(&hull(vec![
            plate(upper, chine, &above),
            plate(chine, keel, &below),
        ]));
        assert_sound(&mesh);
        assert_eq!(slits(&mesh), 0);
    }

    #[test]
    fn rulings_are_edges() {
        let at = [(0.0, 0.0), (4.0, 6.0), (10.0, 10.0)];
        let other = [(0.0, 0.0), (5.0, 5.0), (7.0, 5.5), (10.0, 10.0)];
        let hull = hull(vec![plate(upper, chine, &at), plate(chine, keel, &other)]);
        let mesh = mesh(&hull);
        let edges = directed_edges(&mesh);
        let find = |p: Point3<f64>| mesh.vertices.iter().position(|v| (v - p).norm() < 1e-12);
        for ruling in hull.plates.iter().flat_map(|p| &p.rulings) {
            let (a, b) = (find(ruling.from).unwrap(), find(ruling.to).unwrap());
            assert!(edges.contains_key(&(a, b)) || edges.contains_key(&(b, a)));
        }
        assert_sound(&mesh);
    }

    #[test]
    fn fans_give_no_degenerate_triangles() {
        let fan = [
            (0.0, 0.0),
            (0.0, 1.0),
            (0.0, 2.0),
            (5.0, 6.0),
            (8.0, 10.0),
            (10.0, 10.0),
        ];
        let even: Vec<(f64, f64)> = (0..=10).map(f64::from).map(|x| (x, x)).collect();
        let mesh = mesh(&hull(vec![
            plate(upper, chine, &fan),
            plate(chine, keel, &even),
        ]));
        assert_sound(&mesh);
        assert_eq!(slits(&mesh), 0);
    }

    #[test]
    fn profiles_may_meet_in_a_tip() {
        let tip: Curve = |x| if x < 10.0 { upper(x) } else { chine(10.0) };
        let even: Vec<(f64, f64)> = (0..=10).map(f64::from).map(|x| (x, x)).collect();
        let mesh = mesh(&hull(vec![
            plate(tip, chine, &even),
            plate(chine, keel, &even),
        ]));
        assert_sound(&mesh);
        assert_eq!(slits(&mesh), 0);
        assert_eq!(
            mesh.plates[0].triangles.len(),
            19,
            "the last cell is one triangle"
        );
    }

    #[test]
    fn plates_may_overhang_by_different_lengths() {
        let above: Vec<(f64, f64)> = (-1..=11).map(f64::from).map(|x| (x, x)).collect();
        let below: Vec<(f64, f64)> = (-1..=10).map(f64::from).map(|x| (x + 0.5, x)).collect();
        let mesh = mesh(&hull(vec![
            plate(upper, chine, &above),
            plate(chine, keel, &below),
        ]));
        assert_sound(&mesh);
        assert_eq!(
            slits(&mesh),
            2,
            "only the overhang of the upper plate at either end is open"
        );
    }

    #[test]
    fn twists_belong_to_the_plate_and_run_on_between_rulings() {
        let twisted = |twists: [f64; 2], from: Curve, to: Curve| {
            let mut plate = plate(from, to, &[(0.0, 0.0), (10.0, 10.0)]);
            for (ruling, twist) in plate.rulings.iter_mut().zip(twists) {
                ruling.twist_deg = twist;
            }
            plate
        };
        let mut below = twisted([5.0, 5.0], chine, keel);
        let middle = RulingLine {
            from: Point3::from((chine(0.0).coords + chine(10.0).coords) / 2.0),
            to: keel(5.0),
            ..below.rulings[0]
        };
        below.rulings.insert(1, middle);
        let mesh = mesh(&hull(vec![twisted([-1.0, 3.0], upper, chine), below]));
        let at = |plate: usize, p: Point3<f64>| {
            let vertex = mesh.vertices.iter().position(|v| (v - p).norm() < 1e-9);
            mesh.plates[plate].twists[&vertex.unwrap()]
        };
        assert_eq!(at(0, chine(0.0)), -1.0);
        assert_eq!(at(0, chine(10.0)), 3.0);
        assert_eq!(at(1, chine(0.0)), 5.0);
        assert!((at(0, middle.from) - 1.0).abs() < 1e-12, "half way");
    }

    #[test]
    fn nothing_and_nonsense_give_an_empty_mesh() {
        assert!(mesh(&hull(Vec::new())).plates.is_empty());
        let nan: Curve = |_| Point3::new(f64::NAN, 0.0, 0.0);
        let mesh = mesh(&hull(vec![plate(nan, keel, &[(0.0, 0.0), (1.0, 1.0)])]));
        assert_eq!(mesh.plates, [PlateMesh::default()]);
    }
}
