//! The surface that a net is held to instead of its start.

use super::request;
use crate::geometry::mesh::{Face, Mesh, MeshError, MeshIndex};
use crate::geometry::{Axis, BSplineSurface};
use nalgebra::{Point3, Vector3};

/// A target in unit scale, prepared for queries.
#[derive(Debug, Clone)]
pub(super) struct Target {
    index: MeshIndex,
    spline: Option<Spline>,
}

/// A spline with the parameters of the vertices of its mesh.
#[derive(Debug, Clone)]
struct Spline {
    surface: BSplineSurface,
    parameters: Vec<[f64; 2]>,
}

/// The nearest point of a target with the normal there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Foot {
    pub(super) point: Point3<f64>,
    pub(super) normal: Vector3<f64>,
}

/// Why a target is none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Fault {
    /// A face has neither three nor four corners.
    Corners { face: usize, corners: usize },
    /// Vertices and faces make no mesh.
    Mesh(MeshError),
    /// There is no face.
    Empty,
}

/// Quads for each knot span in either direction: a cubic span turns little on
/// a quarter, and Newton's method finds the foot from there.
const CUTS: usize = 4;
/// But no more lines than these.
const MOST_LINES: usize = 200;
/// Newton steps to a foot on a spline; from its mesh three are enough.
const STEPS: usize = 6;

impl Target {
    /// unit = (user − middle) / size.
    ///
    /// # Errors
    /// The first [`Fault`].
    pub(super) fn new(
        target: &request::Target,
        size: f64,
        middle: &Vector3<f64>,
    ) -> Result<Target, Fault> {
        let unit = |p: &Point3<f64>| Point3::from((p.coords - middle) / size);
        match target {
            request::Target::Mesh(mesh) => {
                let vertices = mesh.vertices.iter().map(unit).collect();
                let faces = mesh.faces.iter().enumerate().map(|(face, corners)| {
                    Face::of(corners).ok_or(Fault::Corners {
                        face,
                        corners: corners.len(),
                    })
                });
                let faces = faces.collect::<Result<_, _>>()?;
                let mesh = Mesh::new(vertices, faces).map_err(Fault::Mesh)?;
                Ok(Target {
                    index: MeshIndex::new(&mesh).ok_or(Fault::Empty)?,
                    spline: None,
                })
            }
            request::Target::BSpline(surface) => {
                let points = surface.control_points().iter().map(unit).collect();
                let knots = [Axis::U, Axis::V].map(|axis| surface.knot_vector(axis));
                let weights = surface.weights().map(<[f64]>::to_vec);
                let unit = BSplineSurface::from_knots(knots, points, weights);
                Target::of_spline(unit.map_err(|_| Fault::Empty)?)
            }
        }
    }

    fn of_spline(surface: BSplineSurface) -> Result<Target, Fault> {
        let lines = [Axis::U, Axis::V].map(|axis| {
            let breaks = surface.knot_vector(axis).breakpoints();
            let cuts = CUTS.min(MOST_LINES / breaks.len().max(1)).max(1);
            let spans = breaks.windows(2).flat_map(|w| {
                let (from, width) = (w[0], (w[1] - w[0]) / cuts as f64);
                (0..cuts).map(move |k| from + width * k as f64)
            });
            spans.chain(breaks.last().copied()).collect::<Vec<f64>>()
        });
        let columns = lines[1].len();
        let parameters: Vec<[f64; 2]> = lines[0]
            .iter()
            .flat_map(|u| lines[1].iter().map(move |v| [*u, *v]))
            .collect();
        let vertices = parameters
            .iter()
            .map(|[u, v]| surface.point(*u, *v))
            .collect();
        let corners = (0..parameters.len() - columns).filter(|k| k % columns + 1 < columns);
        let faces = corners.map(|k| Face::Quad([k, k + columns, k + columns + 1, k + 1]));
        let mesh = Mesh::new(vertices, faces.collect()).map_err(Fault::Mesh)?;
        Ok(Target {
            index: MeshIndex::new(&mesh).ok_or(Fault::Empty)?,
            spline: Some(Spline {
                surface,
                parameters,
            }),
        })
    }

    /// The nearest point.
    pub(super) fn foot(&self, query: &Point3<f64>) -> Foot {
        let near = self.index.nearest(query);
        let foot = Foot {
            point: near.point,
            normal: near.normal,
        };
        let Some(spline) = &self.spline else {
            return foot;
        };
        let start: [f64; 2] = std::array::from_fn(|d| {
            let pairs = near.corners.iter().zip(near.shares);
            pairs.map(|(c, s)| spline.parameters[*c][d] * s).sum()
        });
        // Where the spline has no normal, that of its mesh has to do.
        spline.foot(query, start).unwrap_or(foot)
    }
}

impl Spline {
    /// Newton's method for the least distance, within the domain; where that is
    /// not convex, a step to the foot on the tangent plane.
    fn foot(&self, query: &Point3<f64>, start: [f64; 2]) -> Option<Foot> {
        let domain = [Axis::U, Axis::V].map(|axis| self.surface.domain(axis));
        let mut at = start;
        for _ in 0..STEPS {
            let jet = self.surface.derivatives(at[0], at[1]);
            let way = query - jet.point;
            let plane = [
                jet.du.dot(&jet.du),
                jet.du.dot(&jet.dv),
                jet.dv.dot(&jet.dv),
            ];
            let bend = [jet.duu, jet.duv, jet.dvv].map(|d| d.dot(&way));
            let full = [0, 1, 2].map(|k| plane[k] - bend[k]);
            let pull = [way.dot(&jet.du), way.dot(&jet.dv)];
            let step = solve_positive(full, pull).or_else(|| solve_positive(plane, pull))?;
            for d in [0, 1] {
                at[d] = (at[d] + step[d]).clamp(domain[d][0], domain[d][1]);
            }
        }
        let jet = self.surface.derivatives(at[0], at[1]);
        Some(Foot {
            point: jet.point,
            normal: jet.normal()?,
        })
    }
}

/// The solution of a symmetric system of two, its matrix by rows from the
/// diagonal on; `None` unless that is positive definite.
fn solve_positive([e, f, g]: [f64; 3], [a, b]: [f64; 2]) -> Option<[f64; 2]> {
    let determinant = e * g - f * f;
    let is_positive = e > 0.0 && determinant > 0.0 && determinant.is_finite();
    is_positive.then(|| [(g * a - f * b) / determinant, (e * b - f * a) / determinant])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::methods::curvature_net::request::QuadMesh;

    /// A biquadratic hill over [0, 6]².
    fn hill() -> BSplineSurface {
        let points = (0..9).map(|k| {
            let (i, j) = ((k / 3) as f64, (k % 3) as f64);
            Point3::new(3.0 * i, 3.0 * j, if k == 4 { 5.0 } else { 0.4 * i })
        });
        let knots = vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
        let made = BSplineSurface::new([2, 2], [knots.clone(), knots], points.collect(), None);
        made.expect("a surface")
    }

    #[test]
    fn feet_on_a_spline_are_square_to_it() {
        let shift = Vector3::new(1.0, -2.0, 0.5);
        let surface = request::Target::BSpline(Box::new(hill()));
        let target = Target::new(&surface, 2.0, &shift).expect("a target");
        for k in 0..20 {
            let (u, v) = (0.1 + 0.04 * f64::from(k), 0.9 - 0.035 * f64::from(k));
            let jet = hill().derivatives(u, v);
            let above = jet.point + jet.normal().expect("a normal") * 0.3;
            let foot = target.foot(&Point3::from((above.coords - shift) / 2.0));
            let expected = (jet.point.coords - shift) / 2.0;
            assert!((foot.point.coords - expected).norm() < 1e-9, "{k}");
            assert!((foot.normal - jet.normal().expect("a normal")).norm() < 1e-9);
        }
    }

    #[test]
    fn faults_are_told() {
        let mesh = |faces: Vec<Vec<usize>>| {
            let target = request::Target::Mesh(QuadMesh {
                vertices: vec![Point3::origin(); 5],
                faces,
            });
            Target::new(&target, 1.0, &Vector3::zeros()).map(|_| ())
        };
        assert_eq!(mesh(Vec::new()), Err(Fault::Empty));
        let five = mesh(vec![vec![0, 1, 2], vec![0, 1, 2, 3, 4]]);
        assert_eq!(
            five,
            Err(Fault::Corners {
                face: 1,
                corners: 5
            })
        );
        assert!(matches!(mesh(vec![vec![0, 1, 7]]), Err(Fault::Mesh(_))));
    }
}
