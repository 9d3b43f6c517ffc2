//! What only `curvature_net` gives: the net, its proof, strips, supports,
//! offsets, the bill.

use super::super::curves::{Point, finite};
use super::super::flat::FlatPoint;
use super::super::index::IndexPair;
use super::{CurvatureNetOptions, DirectionWord};
use crate::methods::curvature_net::cyclide::Certificate;
use crate::methods::curvature_net::structure::{
    Cone, ConeKind, Member, Offset, Sheet, Strip, Support,
};
use nalgebra::{Point3, Vector3};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// What only `curvature_net` gives. Lengths in the job's unit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CurvatureNetSpecific {
    /// The options as they were understood, defaults filled in.
    pub options: CurvatureNetOptions,
    /// Rows of vertices; u runs from row to row.
    pub rows: usize,
    /// Vertices in a row; v runs along a row.
    pub columns: usize,
    /// Directions in which the net closes; the first row or column is not
    /// repeated.
    pub closed: Vec<DirectionWord>,
    /// The vertices, row after row, with what may be shown in colour there.
    pub vertices: Vec<VertexResult>,
    /// The proof of each cyclide patch, row after row; null where there is no
    /// patch. Empty without a cyclide spline.
    pub certificates: Vec<Option<CertificateResult>>,
    /// Conical strips.
    pub strips: Vec<StripResult>,
    /// Supports.
    pub supports: Vec<SupportResult>,
    /// Offsets.
    pub offsets: Vec<OffsetResult>,
    /// The bill of quantities: every arc of the net.
    pub members: Vec<MemberResult>,
}

/// A vertex of the net.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct VertexResult {
    /// Where it is.
    pub point: Point,
    /// Unit normal, u × v.
    pub normal: Point,
    /// Unit tangents along u and v.
    #[schema(min_items = 2, max_items = 2, value_type = Vec<Point>)]
    pub tangents: [Point; 2],
    /// Curvatures of the smooth surface along u and v, 1/length, positive
    /// where it bends towards the normal.
    #[schema(min_items = 2, max_items = 2, value_type = Vec<f64>)]
    pub curvatures: [f64; 2],
    /// Largest |geodesic torsion · length| of the smooth surface's borders
    /// that end here, radians.
    pub torsion: f64,
    /// How far the cyclide spline is from the smooth surface's vertex.
    pub moved: f64,
    /// By how much its normal is turned, degrees.
    pub turned_deg: f64,
}

/// Residuals that prove a patch to be one of a Dupin cyclide, joined to its
/// neighbours. All without unit or in radians.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CertificateResult {
    /// Frames at two ends of a side against each other's mirror image.
    pub mirror: f64,
    /// Cosine of the angle between the tangents in a corner.
    pub orthogonality: f64,
    /// Angle between tangent planes along common sides, radians.
    pub tangency: f64,
    /// |Im(e₁e₂e₃e₄)| of the unit sides as quaternions: 0 on a circle.
    pub circularity: f64,
    /// Real part of the quaternionic patch: 0 for a cyclide.
    pub reality: f64,
}

/// A conical strip: the developable that touches the surface along a line.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct StripResult {
    /// Its line: `u3` is the fourth along u.
    pub name: String,
    /// Its pieces in order, one an arc.
    pub cones: Vec<ConeResult>,
    /// Its flat patterns.
    pub sheets: Vec<SheetResult>,
}

/// A piece of a conical strip.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ConeResult {
    /// What it is.
    pub kind: ConeWord,
    /// Indices of the vertices of its arc.
    pub ends: IndexPair,
    /// The apex; null for a cylinder.
    pub apex: Option<Point>,
    /// The unit axis; null for a plane without one.
    pub axis: Option<Point>,
    /// Angle between axis and rulings, degrees: 0 for a cylinder, 90 for a
    /// plane.
    pub half_angle_deg: f64,
}

/// What a piece of a strip is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum ConeWord {
    /// A cone of revolution.
    Cone,
    /// A cylinder of revolution.
    Cylinder,
    /// A plane.
    Plane,
}

/// A flat pattern in one piece. Edges have nine points from vertex to vertex,
/// both counted; the ruling of a vertex joins the same places of both edges.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct SheetResult {
    /// The vertex along the line at which it begins.
    pub first: usize,
    /// The line itself.
    pub line: Vec<FlatPoint>,
    /// The edge to its left.
    pub left: Vec<FlatPoint>,
    /// The edge to its right.
    pub right: Vec<FlatPoint>,
}

/// A support: the strip of normals that stands on a line.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct SupportResult {
    /// Its line.
    pub name: String,
    /// Arcs along which the strip folds over itself.
    pub folded: Vec<usize>,
    /// Its flat patterns; the line's left is the side of the normals.
    pub sheets: Vec<SheetResult>,
}

/// An offset; its patches are among the surfaces.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct OffsetResult {
    /// The distance along the normals.
    pub distance: f64,
    /// Patches that reach a focal point within the distance: they are left
    /// out.
    pub focal: Vec<FocalResult>,
}

/// A patch whose offset would fold over itself.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct FocalResult {
    /// Row and column.
    pub patch: IndexPair,
    /// Least radius of curvature on the offset's side.
    pub radius: f64,
}

/// An arc of the net.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct MemberResult {
    /// Its line.
    pub line: String,
    /// Row and column of the node where it begins.
    pub from: IndexPair,
    /// Row and column of the node where it ends.
    pub to: IndexPair,
    /// Radius; null for a straight one.
    pub radius: Option<f64>,
    /// Length.
    pub length: f64,
    /// Angle, degrees.
    pub angle_deg: f64,
    /// Angle between the nodes' normals about the chord, degrees.
    pub torsion_deg: f64,
}

/// A vector on the wire.
pub(super) fn vector(v: &Vector3<f64>) -> Point {
    Point::from(Point3::from(*v))
}

impl From<&Certificate> for CertificateResult {
    fn from(c: &Certificate) -> Self {
        CertificateResult {
            mirror: c.mirror,
            orthogonality: c.orthogonality,
            tangency: c.tangency,
            circularity: c.circularity,
            reality: c.reality,
        }
    }
}

impl From<&Strip> for StripResult {
    fn from(strip: &Strip) -> Self {
        StripResult {
            name: strip.name.clone(),
            cones: strip.cones.iter().map(Into::into).collect(),
            sheets: strip.sheets.iter().map(Into::into).collect(),
        }
    }
}

impl From<&Cone> for ConeResult {
    fn from(cone: &Cone) -> Self {
        ConeResult {
            kind: match cone.kind {
                ConeKind::Cone => ConeWord::Cone,
                ConeKind::Cylinder => ConeWord::Cylinder,
                ConeKind::Plane => ConeWord::Plane,
            },
            ends: cone.ends.into(),
            apex: cone.apex().map(Into::into),
            axis: cone.arc.axis().map(|a| vector(&a)),
            half_angle_deg: cone.half_angle().to_degrees(),
        }
    }
}

impl From<&Sheet> for SheetResult {
    fn from(sheet: &Sheet) -> Self {
        let edge = |points: &[nalgebra::Point2<f64>]| points.iter().map(|p| (*p).into()).collect();
        SheetResult {
            first: sheet.first,
            line: edge(&sheet.line),
            left: edge(&sheet.left),
            right: edge(&sheet.right),
        }
    }
}

impl From<&Support> for SupportResult {
    fn from(support: &Support) -> Self {
        SupportResult {
            name: support.name.clone(),
            folded: support.folded.clone(),
            sheets: support.sheets.iter().map(Into::into).collect(),
        }
    }
}

impl From<&Offset> for OffsetResult {
    fn from(offset: &Offset) -> Self {
        let focal = offset.focal.iter().map(|(patch, radius)| FocalResult {
            patch: (*patch).into(),
            radius: *radius,
        });
        OffsetResult {
            distance: offset.distance,
            focal: focal.collect(),
        }
    }
}

impl From<&Member> for MemberResult {
    fn from(member: &Member) -> Self {
        MemberResult {
            line: member.line.clone(),
            from: member.nodes[0].into(),
            to: member.nodes[1].into(),
            radius: finite(member.radius),
            length: member.length,
            angle_deg: member.angle.to_degrees(),
            torsion_deg: member.torsion.to_degrees(),
        }
    }
}
