//! What goes over the wire: requests and answers as serde types that carry
//! their own documentation. The OpenAPI document, the checks of a request and
//! the JSON itself all come from these types.

mod cad;
pub mod cone_spline;
pub mod curvature_net;
pub mod curves;
pub mod diagnostics;
pub mod fairing;
pub mod flat;
pub mod hull_plates;
pub mod index;
pub mod job;
pub mod mesh;
pub mod result;
pub mod surface_input;
pub mod verify;

pub use curves::{Point, Spline, Surface};
pub use job::JobRequest;
pub use result::ResultDocument;
