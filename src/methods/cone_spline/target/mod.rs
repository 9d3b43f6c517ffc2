//! A strip made ready for fitting: from a mesh or a ruled surface to two long
//! sides, two ends and a first guess of the rulings.
//!
//! 1. The mesh is one piece of surface without creases, its faces turned the
//!    way that most of its area is; anything else is refused with its place
//!    (`reading`, `crease`). A ring is cut along the shortest way across
//!    (`cut`).
//! 2. On the outline the four corners are where its direction *within the
//!    surface* turns most, seen over a part of the strip's width, so that
//!    neither noise nor a sharp bend makes corners (`outline`, `corners`).
//! 3. Stations of the two long sides are paired by the shortest monotone path
//!    over (i, j), its cost the twist of the ruling: with tangents s, t of the
//!    sides at its ends and direction r, `|r×s/|r×s| − r×t/|r×t||²`, and a
//!    share of how the normals of the mesh lie to it (`pairing`). Of the two
//!    ways to take sides and ends the short way across counts, unless the
//!    rulings of the long one are much nearer to the mesh.
//!
//! Nothing depends on the order of vertices and faces, on the pose, or on
//! which side the faces look to, except the names of sides and ends where a
//! strip is its own mirror image.
//!
//! # Limits
//! A strip has four corners, or fewer where it runs out in a point. The cut of
//! a ring follows edges of the mesh.

mod corners;
mod crease;
mod cut;
mod outline;
mod pairing;
mod reading;
mod ruled;
#[cfg(test)]
mod tests;

use super::request::{Input, Request};
use crate::geometry::Manifold;
use crate::methods::{Control, FitError, Issue};
use nalgebra::Point3;
use outline::Outline;

/// A strip with its corners found: two long sides, two short ends, and a first
/// guess of its rulings. Lengths in the unit of the request.
///
/// With t from the start to the finish and r from side 0 to side 1, r × t is
/// the side that the triangles look to.
#[derive(Debug, Clone, PartialEq)]
pub struct Target {
    /// All vertices of the mesh, in the order of the request; those that the
    /// cut of a ring doubles once more at the end.
    pub points: Vec<Point3<f64>>,
    /// Area of each vertex: a third of its triangles.
    pub weights: Vec<f64>,
    /// Consistently oriented; the normals of the strip follow from it.
    pub triangles: Vec<[usize; 3]>,
    /// The two long sides, both from the start end to the finish end.
    pub sides: [Vec<Point3<f64>>; 2],
    /// The short sides at start and finish, from side 0 to side 1. With the
    /// long sides they close the outline; at least two points each.
    pub ends: [Vec<Point3<f64>>; 2],
    /// About 40 rulings from side 0 to side 1, monotone along both, the first
    /// and the last near the ends.
    pub rulings: Vec<[Point3<f64>; 2]>,
    /// What the user should know about the input.
    pub warnings: Vec<String>,
    /// Whether it was a ring before it was cut.
    pub closed: bool,
}

impl Target {
    /// Reads the strip of a request.
    ///
    /// # Errors
    /// [`FitError::Invalid`] with what keeps the input from being a strip, and
    /// where; [`FitError::Stopped`].
    pub fn of(request: &Request, control: &dyn Control) -> Result<Target, FitError> {
        control.check()?;
        let strip = match &request.input {
            Input::Mesh { vertices, faces } => {
                reading::strip(vertices, faces, request.options.cut.as_ref())
            }
            Input::Ruled(surface) => ruled::strip(surface),
        };
        let strip = strip.map_err(FitError::Invalid)?;
        control.check()?;
        let target = strip
            .target()
            .map_err(|issue| FitError::Invalid(vec![issue]));
        control.check()?;
        target
    }
}

/// One piece of surface with one outline.
#[derive(Debug)]
struct Strip {
    surface: Manifold,
    /// Vertices of the outline at the four corners, where they are known: the
    /// first two bound an end.
    corners: Option<[usize; 4]>,
    warnings: Vec<String>,
    closed: bool,
    /// Where the user wrote the shape.
    place: &'static str,
}

impl Strip {
    fn target(self) -> Result<Target, Issue> {
        let outline = Outline::of(&self.surface);
        let mut warnings = self.warnings;
        let mesh = self.surface.mesh();
        let paired = match self.corners {
            Some(corners) => pairing::pair(&outline, outline.indices_of(corners)),
            None => {
                let found = corners::find(&outline, &self.surface)
                    .map_err(|fault| fault.issue(self.place))?;
                warnings.extend(found.warnings);
                let [a, b, c, d] = found.corners;
                pairing::best(&outline, [[a, b, c, d], [b, c, d, a]], mesh.vertices())
            }
        };
        Ok(Target {
            points: mesh.vertices().to_vec(),
            weights: mesh.vertex_areas(),
            triangles: mesh.triangles().into_iter().map(|(t, _)| t).collect(),
            sides: paired.sides,
            ends: paired.ends,
            rulings: paired.rulings,
            warnings,
            closed: self.closed,
        })
    }
}

/// An issue of the input, `place` below it, `/` between the parts.
fn issue(place: &str, code: &'static str, message: String, hint: Option<&str>) -> Issue {
    let path = std::iter::once("input").chain(place.split('/').filter(|p| !p.is_empty()));
    Issue {
        path: path.map(str::to_owned).collect(),
        code,
        message,
        hint: hint.map(str::to_owned),
    }
}

/// A place for people.
fn at(p: &Point3<f64>) -> String {
    format!("({:.6}, {:.6}, {:.6})", p.x, p.y, p.z)
}
