//! Tensor-product surfaces as they are posted.

use super::curves::{Point, check_points};
use super::index::Index;
use super::job::Units;
use crate::geometry::BSplineSurface;
use crate::http::problem::FieldError;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// A tensor-product B-spline surface, rational when it has weights.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct SurfaceInput {
    /// Degrees in u and v.
    #[schema(min_items = 2, max_items = 2, value_type = Vec<Index>)]
    pub degree: [Index; 2],
    /// Knots in u and in v, multiplicities written out.
    #[schema(min_items = 2, max_items = 2, value_type = Vec<Vec<f64>>)]
    pub knots: [Vec<f64>; 2],
    /// Control points, indexed `[u][v]`.
    #[schema(min_items = 2, max_items = 10_000)]
    pub control_points: Vec<Vec<Point>>,
    /// Positive weights, indexed `[u][v]`; none for a polynomial surface.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub weights: Option<Vec<Vec<f64>>>,
}

impl SurfaceInput {
    /// The surface; none where something is wrong with it, which is told with
    /// its JSON pointer below `at`.
    pub fn to_surface(
        &self,
        at: &str,
        units: Units,
        faults: &mut Vec<FieldError>,
    ) -> Option<BSplineSurface> {
        let before = faults.len();
        let columns = self.control_points.first().map_or(0, Vec::len);
        for (i, row) in self.control_points.iter().enumerate() {
            check_points(row, &format!("{at}/control_points/{i}"), units, faults);
            if row.len() != columns {
                let message = format!("this row has {} points, the first {columns}", row.len());
                let place = format!("{at}/control_points/{i}");
                faults.push(FieldError::new(place, "ragged", message));
            }
        }
        if faults.len() > before {
            return None;
        }
        let weights = self.weights.as_ref().map(|rows| rows.concat());
        let points = self.control_points.iter().flatten().map(|p| (*p).into());
        let degrees = self.degree.map(|d| d.0);
        let read = BSplineSurface::new(degrees, self.knots.clone(), points.collect(), weights);
        read.map_err(|error| faults.push(FieldError::new(at, "not-a-spline", error.to_string())))
            .ok()
    }
}
