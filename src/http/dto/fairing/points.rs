//! Points of two or three coordinates on the wire.

use super::super::curves::coordinate;
use nalgebra::Point3;
use serde::de::{Error, SeqAccess, Visitor};
use serde::ser::SerializeSeq;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::fmt;
use utoipa::openapi::RefOr;
use utoipa::openapi::schema::{ArrayBuilder, Schema};
use utoipa::{PartialSchema, ToSchema};

/// A measured point of the plane or of space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredPoint {
    coordinates: [f64; 3],
    dimension: usize,
}

impl MeasuredPoint {
    /// 2 or 3.
    #[must_use]
    pub fn dimension(&self) -> usize {
        self.dimension
    }
}

impl From<MeasuredPoint> for Point3<f64> {
    /// z is 0 in the plane.
    fn from(p: MeasuredPoint) -> Self {
        Point3::from(p.coordinates)
    }
}

impl Serialize for MeasuredPoint {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut list = serializer.serialize_seq(Some(self.dimension))?;
        for x in &self.coordinates[..self.dimension] {
            list.serialize_element(x)?;
        }
        list.end()
    }
}

impl<'de> Deserialize<'de> for MeasuredPoint {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_seq(Coordinates)
    }
}

struct Coordinates;

impl<'de> Visitor<'de> for Coordinates {
    type Value = MeasuredPoint;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("two or three coordinates")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<MeasuredPoint, A::Error> {
        let (mut coordinates, mut dimension) = ([0.0; 3], 0);
        while let Some(x) = list.next_element()? {
            let slot = coordinates.get_mut(dimension);
            *slot.ok_or_else(|| A::Error::invalid_length(4, &self))? = x;
            dimension += 1;
        }
        if dimension < 2 {
            return Err(A::Error::invalid_length(dimension, &self));
        }
        Ok(MeasuredPoint {
            coordinates,
            dimension,
        })
    }
}

impl PartialSchema for MeasuredPoint {
    fn schema() -> RefOr<Schema> {
        ArrayBuilder::new()
            .items(coordinate())
            .min_items(Some(2))
            .max_items(Some(3))
            .description(Some("x, y, or x, y, z"))
            .examples([serde_json::json!([6.45, 3.2])])
            .into()
    }
}

impl ToSchema for MeasuredPoint {}
