//! Cones of revolution, cylinders and planes as the trace of a moving frame.
//!
//! A [`Frame`] is a point p, a unit ruling r and a unit normal n; t = n × r. It
//! moves with constant strain (g, k) so that
//!
//! p′ = t, r′ = g t, t′ = −g r + k n, n′ = −k t.
//!
//! Its rulings p + λ r then sweep a cone of revolution with the apex p − r/g, the
//! axis direction k r + g n, and the angle atan |g/k| between the two; for
//! g = 0 a cylinder of radius 1/|k|, for k = 0 a plane. With W = √(g² + k²) the
//! frame turns by W about the axis per unit of s, and by g in the flat, where
//! bending does not count. No formula here divides by g, k or W.
//!
//! Limits: everything near a frame only; a point's foot is looked for on the
//! nappe that holds the frame, within half a turn either way.

mod foot;
mod frame;

pub use foot::{Foot, FootDerivatives};
pub use frame::{Frame, Strain, Twist};
