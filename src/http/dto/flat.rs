//! Points of flat patterns on the wire.

use serde::{Deserialize, Serialize};
use utoipa::openapi::RefOr;
use utoipa::openapi::schema::{ArrayBuilder, ObjectBuilder, Schema, SchemaType, Type};
use utoipa::{PartialSchema, ToSchema};

/// A point of the plane as two coordinates.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct FlatPoint(pub [f64; 2]);

impl PartialSchema for FlatPoint {
    fn schema() -> RefOr<Schema> {
        let number = ObjectBuilder::new().schema_type(SchemaType::Type(Type::Number));
        ArrayBuilder::new()
            .items(number)
            .min_items(Some(2))
            .max_items(Some(2))
            .description(Some("x, y"))
            .into()
    }
}

impl ToSchema for FlatPoint {}

impl From<nalgebra::Point2<f64>> for FlatPoint {
    fn from(p: nalgebra::Point2<f64>) -> Self {
        FlatPoint([p.x, p.y])
    }
}

impl From<FlatPoint> for nalgebra::Point2<f64> {
    fn from(p: FlatPoint) -> Self {
        nalgebra::Point2::new(p.0[0], p.0[1])
    }
}
