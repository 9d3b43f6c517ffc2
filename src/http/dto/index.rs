//! Indices and counts on the wire.

use serde::{Deserialize, Deserializer, Serialize};
use utoipa::openapi::RefOr;
use utoipa::openapi::schema::{ArrayBuilder, ObjectBuilder, Schema, SchemaType, Type};
use utoipa::{PartialSchema, ToSchema};

/// An index or a count. JSON knows no integers, so `3.0` is one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(transparent)]
pub struct Index(pub usize);

impl<'de> Deserialize<'de> for Index {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        super::curves::whole_number(deserializer).map(Index)
    }
}

/// The largest index: of a million points.
const LARGEST_INDEX: f64 = 999_999.0;

/// The schema of one index.
pub(super) fn index() -> ObjectBuilder {
    ObjectBuilder::new()
        .schema_type(SchemaType::Type(Type::Integer))
        .minimum(Some(0.0))
        .maximum(Some(LARGEST_INDEX))
}

impl PartialSchema for Index {
    fn schema() -> RefOr<Schema> {
        index().into()
    }
}

impl ToSchema for Index {}

/// Two indices or counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct IndexPair(pub [Index; 2]);

impl IndexPair {
    /// Both numbers.
    #[must_use]
    pub fn numbers(self) -> [usize; 2] {
        self.0.map(|i| i.0)
    }
}

impl From<[usize; 2]> for IndexPair {
    fn from(numbers: [usize; 2]) -> Self {
        IndexPair(numbers.map(Index))
    }
}

impl PartialSchema for IndexPair {
    fn schema() -> RefOr<Schema> {
        ArrayBuilder::new()
            .items(index())
            .min_items(Some(2))
            .max_items(Some(2))
            .into()
    }
}

impl ToSchema for IndexPair {}
