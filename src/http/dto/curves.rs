//! Points, curves and surfaces on the wire. Lengths are in the job's unit.

use super::job::Units;
use crate::geometry::{BSplineCurve, BSplineSurface};
use crate::http::problem::{ApiError, FieldError};
use nalgebra::Point3;
use serde::{Deserialize, Serialize};
use utoipa::openapi::schema::{ArrayBuilder, ObjectBuilder, Schema, Type};
use utoipa::openapi::{RefOr, schema::SchemaType};
use utoipa::{PartialSchema, ToSchema};

/// The largest coordinate in the smallest unit: 1e6 m in millimetres. The
/// bound for the job's own unit is checked with the unit known.
const LARGEST_COORDINATE: f64 = 1e9;

/// The schema of one coordinate.
pub(super) fn coordinate() -> ObjectBuilder {
    ObjectBuilder::new()
        .schema_type(SchemaType::Type(Type::Number))
        .minimum(Some(-LARGEST_COORDINATE))
        .maximum(Some(LARGEST_COORDINATE))
}

/// A point as three coordinates.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Point(pub [f64; 3]);

impl PartialSchema for Point {
    /// utoipa gives `[f64; 3]` no counts, so that two coordinates would pass.
    fn schema() -> RefOr<Schema> {
        ArrayBuilder::new()
            .items(coordinate())
            .min_items(Some(3))
            .max_items(Some(3))
            .description(Some("x, y, z"))
            .examples([serde_json::json!([7.0, 11.48, 11.91])])
            .into()
    }
}

impl ToSchema for Point {}

impl From<Point3<f64>> for Point {
    fn from(p: Point3<f64>) -> Self {
        Point([p.x, p.y, p.z])
    }
}

impl From<Point> for Point3<f64> {
    fn from(p: Point) -> Self {
        Point3::new(p.0[0], p.0[1], p.0[2])
    }
}

/// A B-spline curve, rational when it has weights.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Spline {
    /// Polynomial degree.
    #[schema(minimum = 1, maximum = 9, value_type = u32)]
    #[serde(deserialize_with = "whole")]
    pub degree: usize,
    /// Knots, non-decreasing, multiplicities written out: control points +
    /// degree + 1 of them.
    #[schema(min_items = 4, max_items = 1_000_000)]
    pub knots: Vec<f64>,
    /// Control points.
    #[schema(min_items = 2, max_items = 1_000_000)]
    pub control_points: Vec<Point>,
    /// One positive weight a control point; none for a polynomial curve.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub weights: Option<Vec<f64>>,
}

/// JSON knows no integers, so `3.0` is one.
fn whole<'de, D: serde::Deserializer<'de>>(reader: D) -> Result<usize, D::Error> {
    use serde::de::Error;
    let x = f64::deserialize(reader)?;
    // Far above any degree or index, and exact in f64.
    const LARGEST: f64 = 1e9;
    if x.fract() == 0.0 && (0.0..=LARGEST).contains(&x) {
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        return Ok(x as usize);
    }
    Err(D::Error::custom("not a whole number"))
}

/// `None` for an infinite (or undefined) figure, which JSON cannot say.
#[must_use]
pub(in crate::http) fn finite(x: f64) -> Option<f64> {
    x.is_finite().then_some(x)
}

/// Coordinates stay below this, in metres: larger ones are a slip of the unit.
const LARGEST_COORDINATE_M: f64 = 1e6;

/// Adds a fault for every coordinate that is beyond the limit in its unit.
pub(super) fn check_points(points: &[Point], at: &str, units: Units, faults: &mut Vec<FieldError>) {
    let limit = LARGEST_COORDINATE_M / units.metres();
    for (i, point) in points.iter().enumerate() {
        for (axis, x) in point.0.iter().enumerate().filter(|(_, x)| x.abs() >= limit) {
            let message = format!(
                "{x:e} {units} is {:e} m, beyond the limit of 1e6 m",
                x * units.metres()
            );
            faults.push(
                FieldError::new(format!("{at}/{i}/{axis}"), "out-of-range", message)
                    .hint("is \"units\" right?"),
            );
        }
    }
}

/// See [`whole`]; for the other DTOs.
pub(super) fn whole_number<'de, D: serde::Deserializer<'de>>(reader: D) -> Result<usize, D::Error> {
    whole(reader)
}

impl From<&BSplineCurve> for Spline {
    fn from(curve: &BSplineCurve) -> Self {
        Spline {
            degree: curve.degree(),
            knots: curve.knots().to_vec(),
            control_points: curve.control_points().iter().map(|p| (*p).into()).collect(),
            weights: curve.weights().map(<[f64]>::to_vec),
        }
    }
}

/// A named curve of a result.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct NamedCurve {
    /// The user's name for it.
    pub name: String,
    /// What it is: `profile` for a boundary that plates share.
    #[schema(examples("profile"))]
    pub role: String,
    /// Polynomial degree.
    #[schema(minimum = 1)]
    pub degree: usize,
    /// Knots, multiplicities written out.
    pub knots: Vec<f64>,
    /// Control points.
    pub control_points: Vec<Point>,
    /// Weights of a rational curve.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub weights: Option<Vec<f64>>,
}

impl NamedCurve {
    /// A curve with its name and role.
    #[must_use]
    pub fn new(name: &str, role: &str, curve: &BSplineCurve) -> Self {
        let Spline {
            degree,
            knots,
            control_points,
            weights,
        } = curve.into();
        NamedCurve {
            name: name.into(),
            role: role.into(),
            degree,
            knots,
            control_points,
            weights,
        }
    }

    /// The curve itself.
    ///
    /// # Errors
    /// A stored curve that is none, a fault of ours.
    pub(super) fn spline(&self) -> Result<BSplineCurve, ApiError> {
        let points = self.control_points.iter().map(|p| (*p).into()).collect();
        BSplineCurve::new(
            self.degree,
            self.knots.clone(),
            points,
            self.weights.clone(),
        )
        .map_err(|e| ApiError::internal(&e))
    }
}

/// A named tensor-product B-spline surface of a result.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Surface {
    /// Its name.
    #[schema(examples("main_deck – upper_chine"))]
    pub name: String,
    /// What it is: `plate`.
    #[schema(examples("plate"))]
    pub role: String,
    /// Degrees in u and v; a plate has `[3, 1]`.
    #[schema(min_items = 2, max_items = 2, value_type = Vec<u32>)]
    pub degree: [usize; 2],
    /// Knots in u and in v, multiplicities written out.
    #[schema(min_items = 2, max_items = 2, value_type = Vec<Vec<f64>>)]
    pub knots: [Vec<f64>; 2],
    /// Control points, indexed `[u][v]`.
    pub control_points: Vec<Vec<Point>>,
    /// Weights of a rational surface, indexed `[u][v]`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub weights: Option<Vec<Vec<f64>>>,
}

impl Surface {
    /// A surface with its name and role.
    #[must_use]
    pub fn new(name: &str, role: &str, surface: &BSplineSurface) -> Self {
        // A surface has at least two control points a direction; one keeps
        // `chunks` from panicking on a malformed one.
        let columns = surface.counts()[1].max(1);
        let points: Vec<Point> = surface
            .control_points()
            .iter()
            .map(|p| (*p).into())
            .collect();
        Surface {
            name: name.into(),
            role: role.into(),
            degree: surface.degrees(),
            knots: surface.knots().clone(),
            control_points: points.chunks(columns).map(<[Point]>::to_vec).collect(),
            weights: surface
                .weights()
                .map(|w| w.chunks(columns).map(<[f64]>::to_vec).collect()),
        }
    }

    /// The surface itself.
    ///
    /// # Errors
    /// A stored surface that is none, a fault of ours.
    pub(super) fn tensor(&self) -> Result<BSplineSurface, ApiError> {
        let points = self.control_points.iter().flatten();
        let weights = self.weights.as_ref().map(|rows| rows.concat());
        BSplineSurface::new(
            self.degree,
            self.knots.clone(),
            points.map(|p| (*p).into()).collect(),
            weights,
        )
        .map_err(|e| ApiError::internal(&e))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::MAX_DEGREE;

    #[test]
    fn the_published_degree_is_what_the_splines_can() {
        let schema = serde_json::to_value(Spline::schema()).unwrap();
        assert_eq!(schema["properties"]["degree"]["maximum"], MAX_DEGREE);
    }
}
